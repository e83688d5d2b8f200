#define _POSIX_C_SOURCE 200809L /* uname */
#include "evaluator/backend.h"
#include "core/info_table.h"
#include "core/workers.h"
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

struct state {
	struct rnea_evaluator evaluator;
	struct workers *workers;
	struct utsname machine;
};

/* Samples that a thread takes at a time: a sample takes some microseconds. */
enum { PIECE = 32 };

struct batch {
	const struct state *state;
	void *const *arrays;
	size_t count;
	atomic_int failed;
};

static void forget(struct state *s)
{
	workers_close(s->workers);
	free(s);
}

static void evaluator_close(void *state)
{
	struct state *s = state;

	if (s->evaluator.close)
		s->evaluator.close(s->evaluator.context);
	forget(s);
}

/* ---- the table ---- */

/* The character that a string literal has at *s, which moves on. */
static char next_character(const char **s)
{
	char c = *(*s)++;

	if (c != '\\' || !**s)
		return c;
	c = *(*s)++;
	return c == 'n' ? '\n' : c == 't' ? '\t' : c;
}

/* NAME_info out of the text: adjacent string literals up to a semicolon. NULL when memory runs out; malloc'ed. */
static char *read_table(const struct source *source, size_t *length)
{
	char marker[SOURCE_SYMBOL_SIZE + 16], *table = malloc(strlen(source->text) + 1);
	const char *s;

	*length = 0;
	snprintf(marker, sizeof marker, "%s_info[] =", source->name);
	s = strstr(source->text, marker);
	while (table && s && *s && *s != ';')
		if (*s++ == '"') {
			while (*s && *s != '"')
				table[(*length)++] = next_character(&s);
			s += *s == '"';
		}
	return table;
}

static enum rnea_code read_info(const struct source *source, struct rnea_info *info, struct rnea_error *e)
{
	size_t length;
	char *table = read_table(source, &length);

	if (!table)
		return rnea_error_memory(e);
	if (!rnea_info_read(table, length, source->name, info, e))
		info->function_count = 1;
	free(table);
	return e->code;
}

/* ---- opening and running ---- */

static enum rnea_code evaluator_open(void **state, const struct backend_request *r, struct rnea_info *info,
	struct rnea_build *build, int *absent, struct rnea_error *e)
{
	struct state *s = calloc(1, sizeof *s);

	*absent = 0;
	if (!s)
		return rnea_error_memory(e);
	s->evaluator = *r->evaluator;
	if (!(s->workers = workers_open(r->options->threads)))
		rnea_error_memory(e);
	if (e->code || read_info(r->source, info, e)) {
		forget(s);
		return e->code;
	}
	if (uname(&s->machine) < 0)
		snprintf(s->machine.machine, sizeof s->machine.machine, "host");
	*state = s;
	*build = (struct rnea_build){.backend = RNEA_BACKEND_EVALUATOR,
		.device = s->machine.machine,
		.compiler = "",
		.target = "expressions",
		.threads = workers_limit(s->workers)};
	return RNEA_OK;
}

static void run_piece(void *batch, size_t i)
{
	struct batch *b = batch;
	const struct rnea_evaluator *v = &b->state->evaluator;
	size_t first = i * PIECE, end = b->count - first < PIECE ? b->count : first + PIECE;

	if (!v->evaluate(v->context, b->arrays, b->count, first, end))
		atomic_store(&b->failed, 1);
}

static enum rnea_code evaluator_run(const void *state, void *const *arrays, size_t count, struct rnea_error *e)
{
	const struct state *s = state;
	struct batch b = {.state = s, .arrays = arrays, .count = count};

	workers_run(s->workers, workers_limit(s->workers), run_piece, &b, count / PIECE + (count % PIECE != 0));
	return atomic_load(&b.failed) ? rnea_error_memory(e) : RNEA_OK;
}

static enum rnea_code evaluator_launch(
	const void *state, size_t function, void *const *arrays, size_t count, void *stream, struct rnea_error *e)
{
	(void)function, (void)stream;
	return evaluator_run(state, arrays, count, e);
}

const struct backend backend_evaluator = {.name = RNEA_BACKEND_EVALUATOR,
	.symbols = "evaluator",
	.open = evaluator_open,
	.close = evaluator_close,
	.launch = evaluator_launch,
	.run = evaluator_run};
