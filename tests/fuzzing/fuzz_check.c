#define _POSIX_C_SOURCE 200809L
#include "fuzz_check.h"
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void *ration_alloc(void *context, size_t size)
{
	struct ration *r = context;
	void *p = r->left ? malloc(size) : NULL;

	r->left -= r->left > 0;
	r->out += p != NULL;
	return p;
}

static void ration_release(void *context, void *block)
{
	struct ration *r = context;

	r->out -= block != NULL;
	free(block);
}

struct rneagen_allocator ration_allocator(struct ration *r)
{
	return (struct rneagen_allocator){ration_alloc, ration_release, r};
}

void require(int holds, const char *what, const struct rneagen_error *e)
{
	if (holds)
		return;
	fprintf(stderr, "%s; code %d, message \"%s\"\n", what, (int)e->code, e->message);
	abort();
}

static int is_line(const char *s)
{
	for (; *s; s++)
		if ((unsigned char)*s < 0x20 || *s == 0x7f)
			return 0;
	return 1;
}

/* Printable ASCII: whatever a name holds, the text does not. */
static int is_plain(const char *s)
{
	for (; s && *s; s++)
		if ((*s < 0x20 || *s >= 0x7f) && *s != '\n' && *s != '\t')
			return 0;
	return 1;
}

void check_result(const struct rneagen_options *o, const struct rneagen_result *r, const struct rneagen_error *e)
{
	static const struct rneagen_result empty;

	if (e->code) {
		require(!memcmp(r, &empty, sizeof empty), "a failure leaves a result", e);
		require(e->code < RNEAGEN_ERROR_COUNT && *e->message, "a failure without a message", e);
		require(is_line(e->message), "a message of more than one line", e);
		return;
	}
	require(!*e->message, "a success with a message", e);
	require(r->name && r->info && r->info_json && r->dot, "a success without its texts", e);
	require(!r->dump == (o->dump == RNEAGEN_DUMP_NONE), "a dump where one is asked for", e);
	require(!r->source == (r->dump != NULL), "a source, or a dump", e);
	require(!r->source || strstr(r->source, r->name) != NULL, "a source without its name", e);
	require(!r->header == (r->dump || o->target != RNEAGEN_TARGET_C), "a header for C, and only for C", e);
	require(is_plain(r->source) && is_plain(r->header), "a text with other characters than printable ASCII", e);
	for (size_t i = 0; i < r->warning_count; i++)
		require(*r->warnings[i] && is_line(r->warnings[i]), "a warning of more than one line", e);
}

/* ---- counts ---- */

static unsigned long executions, accepted;

static void add_counts(void)
{
	const char *path = getenv("FUZZ_COUNTS");
	int fd = path && executions ? open(path, O_WRONLY | O_APPEND | O_CREAT, 0666) : -1;

	if (fd < 0)
		return;
	dprintf(fd, "%lu %lu\n", executions, accepted);
	close(fd);
	executions = accepted = 0;
}

void count_execution(int is_accepted)
{
	static int is_told;

	if (!is_told)
		atexit(add_counts);
	is_told = 1;
	executions++;
	accepted += is_accepted != 0;
	if (executions == 1000)
		add_counts();
}
