/* Which variants there are: what the options ask for, where texts that are the same code are one. */
#include "emit/emit.h"
#include "study/study.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void study_same(const struct study_row *row, const char *between, char *text, size_t size)
{
	size_t used = 0;

	*text = '\0';
	for (unsigned t = 0; t < STUDY_TRIGS && used < size; t++)
		if (row->same >> t & 1)
			used += (size_t)snprintf(text + used, size - used, "%s%s", used ? between : "",
				emit_trig_name((enum rneagen_trig)t));
}

void study_name(const struct study_row *row, char *text, size_t size)
{
	snprintf(text, size, "%s %s %s %s", study_backend_name(row->backend), emit_precision_name(row->precision),
		emit_trig_name(row->trig), emit_layout_name(row->layout));
}

/* ---- texts ---- */

/* Those of one backend and precision, by the places of trigonometry and layout in the options. */
struct texts {
	struct rneagen_result of[STUDY_TRIGS][STUDY_LAYOUTS];
	int row[STUDY_TRIGS][STUDY_LAYOUTS]; /* of the variant that a text belongs to */
};

/* What stands behind the comment at the head, which has the command line. */
static const char *past_head(const char *source)
{
	const char *end = strstr(source, "*/");

	return end ? end : source;
}

/* Is the code the same? The table's line that names the trigonometry may differ. */
static int is_same(const char *a, const char *b)
{
	static const char line[] = "\n\t\"trig ";
	const char *x = strstr(a = past_head(a), line), *y = strstr(b = past_head(b), line);

	if (!x || !y || x - a != y - b || memcmp(a, b, (size_t)(x - a)) != 0)
		return 0;
	return !strcmp(x + strcspn(x + 1, "\n"), y + strcspn(y + 1, "\n"));
}

/* The first text of an earlier trigonometry that is the same; -1: none is. */
static int find_same(const struct texts *t, int trig, int layout)
{
	for (int i = 0; i < trig; i++)
		if (is_same(t->of[i][layout].source, t->of[trig][layout].source))
			return i;
	return -1;
}

/* ---- variants ---- */

static enum rneagen_code plan_text(struct study *s, struct texts *t, int trig, int layout, const struct study_row *row)
{
	struct rneagen_options g = study_generate(s, row);
	int same;

	study_show(s, 0, row);
	if (rneagen_generate(s->urdf.bytes, s->urdf.length, &g, &t->of[trig][layout], &s->error))
		return s->error.code;
	same = find_same(t, trig, layout);
	t->row[trig][layout] = same < 0 ? s->variant_count : t->row[same][layout];
	if (same < 0)
		s->variants[s->variant_count++] = *row;
	else
		s->variants[t->row[same][layout]].same |= 1u << row->trig;
	return RNEAGEN_OK;
}

static enum rneagen_code plan_precision(struct study *s, enum rnea_backend backend, enum rneagen_precision precision)
{
	const struct study_options *o = s->options;
	int layouts = o->layouts.count, count = o->trigs.count * layouts;
	struct texts *t = calloc(1, sizeof *t);

	if (!t)
		return error_memory(&s->error);
	for (int i = 0; i < count && !s->error.code; i++) {
		struct study_row row = {.backend = backend, .precision = precision};

		row.trig = (enum rneagen_trig)o->trigs.values[i / layouts];
		row.layout = (enum rneagen_layout)o->layouts.values[i % layouts];
		plan_text(s, t, i / layouts, i % layouts, &row);
	}
	for (int i = 0; i < count; i++)
		rneagen_result_free(&t->of[i / layouts][i % layouts]);
	free(t);
	return s->error.code;
}

/* Pairs of floats are for GPUs with few units for doubles: on a processor they take long to compile and to run. */
static int is_left_out(const struct study *s, enum rnea_backend backend, enum rneagen_precision precision)
{
	return backend == RNEA_BACKEND_HOST && precision == RNEAGEN_F32X2 && !s->options->precision_asked;
}

enum rneagen_code study_plan(struct study *s)
{
	const struct study_options *o = s->options;
	int precisions = o->precisions.count;

	s->variants = calloc((size_t)(s->backend_count * precisions) * STUDY_TRIGS * STUDY_LAYOUTS + 1, sizeof *s->variants);
	if (!s->variants)
		return error_memory(&s->error);
	for (int i = 0; i < s->backend_count * precisions && !s->error.code; i++) {
		enum rnea_backend backend = s->backends[i / precisions].backend;
		enum rneagen_precision precision = (enum rneagen_precision)o->precisions.values[i % precisions];

		if (!is_left_out(s, backend, precision))
			plan_precision(s, backend, precision);
	}
	return s->error.code;
}
