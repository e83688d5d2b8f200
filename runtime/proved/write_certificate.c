#include "proved/write_certificate.h"
#include "certify/certificate.h"
#include "cli/files.h"
#include <string.h>

static void take_bounds(struct proved_bound *to, const struct prove_row *row)
{
	to->low = row->low;
	to->high = row->high;
	memcpy(to->errors, row->error_bound, sizeof to->errors);
}

enum rneagen_code write_certificate(const char *path, const struct proof *p, const struct analysis *a,
	const struct prove_options *o, double seconds, struct rneagen_error *e)
{
	struct certificate c = {.a = a, .precisions = o->precisions, .precision_count = o->precision_count};
	struct proved_bound *proved;
	struct arena arena;
	struct text text;

	arena_init(&arena, NULL);
	text_init(&text, &arena);
	proved = arena_alloc(&arena, a->dag.output_count, sizeof *proved);
	for (size_t i = 0; proved && i < a->dag.output_count; i++)
		take_bounds(&proved[i], &p->rows[i]);
	if (!proved)
		error_memory(e);
	else if (!certificate_make(&c, o->record, proved, seconds, o->threads, &arena, e)) {
		certificate_put(&c, &text);
		if (text.failed)
			error_memory(e);
		else
			file_write_pair(path, text_string(&text), NULL, e);
	}
	certificate_free(&c);
	arena_free(&arena);
	return e->code;
}
