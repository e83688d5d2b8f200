#define _POSIX_C_SOURCE 200809L
#include "prove/prove_errors.h"
#include "core/seconds.h"
#include "prove/rounding.h"
#include <stdlib.h>

/* As many at once as a proof has precisions, each with its share of the time. */
static int find_all(double *bounds, const struct relaxed *r, const struct box *b, const struct eval_model *models, int count,
	const struct effort *x, double seconds)
{
	int groups = (count + PROVE_PRECISIONS - 1) / PROVE_PRECISIONS;

	for (int first = 0; first < count; first += PROVE_PRECISIONS) {
		int some = count - first < PROVE_PRECISIONS ? count - first : PROVE_PRECISIONS;
		struct prove_row *rows = calloc(r->text->dag.output_count + 1, sizeof *rows);
		int done = rows && rounding_find(rows, r, b, models + first, some, x, seconds / groups);

		for (size_t i = 0; done && i < r->text->dag.output_count; i++)
			for (int k = 0; k < some; k++)
				bounds[i * (size_t)count + (size_t)(first + k)] = rows[i].error_bound[k];
		free(rows);
		if (!done)
			return 0;
	}
	return 1;
}

enum rneagen_code prove_errors(double *bounds, const struct analysis *a, const struct eval_model *models, int count,
	unsigned threads, double seconds, struct rneagen_error *e)
{
	struct arena arena;
	struct box box;
	struct relaxed relaxed;
	struct field *fields;
	struct effort x = {.deadline = seconds_now() + 1.2 * seconds};

	arena_init(&arena, NULL);
	if (!box_make(&box, a, &arena, e) && !relax(&relaxed, a, box.rows, &arena, e) &&
		field_split(&fields, &relaxed, &arena, e) >= 0) {
		x.workers = workers_open(threads);
		x.threads = x.workers ? workers_limit(x.workers) : 0;
		if (!x.workers || !find_all(bounds, &relaxed, &box, models, count, &x, seconds))
			error_memory(e);
	}
	workers_close(x.workers);
	arena_free(&arena);
	return e->code;
}
