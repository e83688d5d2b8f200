#define _POSIX_C_SOURCE 200809L
#include "eval/resume.h"
#include "cli/files.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The first line; then the number, of one width, so that it can be written anew where it stands. */
#define FIRST "rnearun eval --resume: samples that are complete\n"
#define NUMBER "%020" PRIu64 "\n"

enum { NUMBER_AT = sizeof FIRST - 1, NUMBER_SIZE = 21, LINES_AT = NUMBER_AT + NUMBER_SIZE };

enum rneagen_code eval_resume_open(struct eval_resume *r, struct eval_arrays *a, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	struct text path;

	eval_sinks(a, sinks);
	*r = (struct eval_resume){.fd = -1};
	arena_init(&r->arena, NULL);
	text_init(&path, &r->arena);
	text_printf(&path, "%s.resume", sinks[0]->path);
	text_init(&r->made_of, &r->arena);
	r->path = text_string(&path);
	return path.failed ? error_memory(e) : RNEAGEN_OK;
}

/* The bytes of an output's PATH.part; -1: there is none. */
static int64_t part_size(const char *path, struct arena *arena)
{
	struct text part;
	struct stat st;

	text_init(&part, arena);
	text_printf(&part, "%s.part", path);
	return part.failed || lstat(text_string(&part), &st) || !S_ISREG(st.st_mode) ? -1 : (int64_t)st.st_size;
}

int eval_resume_is_there(struct eval_resume *r, struct eval_arrays *a)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);
	int all = access(r->path, F_OK) == 0;

	for (size_t i = 0; i < count; i++)
		all &= part_size(sinks[i]->path, &r->arena) >= 0;
	return all;
}

/* ---- what a run is ---- */

/* FNV-1a */
static uint64_t hash(uint64_t h, const char *bytes, size_t length)
{
	for (size_t i = 0; i < length; i++)
		h = (h ^ (unsigned char)bytes[i]) * UINT64_C(0x100000001b3);
	return h;
}

static enum rneagen_code describe_input(struct eval_resume *r, const char *word, const char *path, struct rneagen_error *e)
{
	struct stat st;

	if (stat(path, &st))
		return error_set(e, RNEAGEN_READ, "%s: cannot be read: %s", path, strerror(errno));
	text_printf(&r->made_of, "input %s: %s, %" PRIu64 " bytes, changed %" PRIu64 ".%09ld\n", word, path, (uint64_t)st.st_size,
		(uint64_t)st.st_mtim.tv_sec, st.st_mtim.tv_nsec);
	return RNEAGEN_OK;
}

enum rneagen_code eval_resume_describe(
	struct eval_resume *r, struct eval_arrays *a, const char *urdf, size_t length, const char *text, struct rneagen_error *e)
{
	uint64_t h = hash(hash(UINT64_C(0xcbf29ce484222325), urdf, length), text, strlen(text));
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	text_printf(&r->made_of, "version " RNEAGEN_VERSION "\nrobot and scene %016" PRIx64 "\nsamples %" PRIu64 "\n",
		h, eval_samples(a));
	if (a->in)
		describe_input(r, "--in", a->in, e);
	for (size_t i = 0; i < a->s->count && !e->code; i++)
		if (!a->s->arrays[i].is_output && a->paths[i])
			describe_input(r, a->s->arrays[i].word, a->paths[i], e);
	for (size_t i = 0; i < count; i++)
		text_printf(&r->made_of, "output %s: %zu rows of %zu bytes\n", sinks[i]->path, sinks[i]->rows,
			eval_scalar_size(a));
	if (!text_string(&r->made_of) || r->made_of.failed)
		error_memory(e);
	return e->code;
}

/* ---- reading ---- */

/* The first line in which two texts differ. */
static enum rneagen_code refuse(const struct eval_resume *r, const char *was, struct rneagen_error *e)
{
	const char *is = text_string(&r->made_of), *a = is, *b = was;

	for (; *is && *is == *was; is++, was++)
		if (*is == '\n') {
			a = is + 1;
			b = was + 1;
		}
	return error_set(e, RNEAGEN_READ, "%s: was begun with '%.*s', and this run has '%.*s'; to begin anew remove %s", r->path,
		(int)strcspn(b, "\n"), b, (int)strcspn(a, "\n"), a, r->path);
}

/* Are the samples there that are said to be? */
static enum rneagen_code check_parts(struct eval_resume *r, struct eval_arrays *a, struct rneagen_error *e)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(a, sinks);

	for (size_t i = 0; i < count; i++)
		if (r->done && (uint64_t)part_size(sinks[i]->path, &r->arena) < eval_bytes(a, sinks[i], r->done))
			return error_set(e, RNEAGEN_READ,
				"%s: %s.part is shorter than the %" PRIu64
				" samples that it is to have; to begin anew remove %s",
				r->path, sinks[i]->path, r->done, r->path);
	return RNEAGEN_OK;
}

enum rneagen_code eval_resume_read(struct eval_resume *r, struct eval_arrays *a, struct rneagen_error *e)
{
	struct file_content c = {0};
	const char *was = NULL;
	int scanned = 0;

	if (file_read(r->path, &c, e))
		return e->code;
	if (!(was = arena_string(&r->arena, c.bytes ? c.bytes : "", c.length))) {
		free(c.bytes);
		return error_memory(e);
	}
	if (c.length > LINES_AT && !memcmp(was, FIRST, NUMBER_AT))
		sscanf(was + NUMBER_AT, "%20" SCNu64 "%n", &r->done, &scanned);
	if (scanned != NUMBER_SIZE - 1 || r->done > eval_samples(a))
		error_set(e, RNEAGEN_READ, "%s: is damaged; to begin anew remove it", r->path);
	else if (strcmp(was + LINES_AT, text_string(&r->made_of)))
		refuse(r, was + LINES_AT, e);
	else if (!check_parts(r, a, e) && (r->fd = open(r->path, O_WRONLY | O_CLOEXEC)) < 0)
		pending_fail(r->path, e);
	free(c.bytes);
	return e->code;
}

/* ---- writing ---- */

enum rneagen_code eval_resume_begin(struct eval_resume *r, struct rneagen_error *e)
{
	struct pending p;

	if (pending_open(&p, r->path, e))
		return e->code;
	fprintf(p.f, FIRST NUMBER "%s", (uint64_t)0, text_string(&r->made_of));
	if (!pending_close(&p, e) && !pending_publish(&p, e) && (r->fd = open(r->path, O_WRONLY | O_CLOEXEC)) < 0)
		pending_fail(r->path, e);
	return e->code;
}

enum rneagen_code eval_resume_record(struct eval_resume *r, uint64_t done, struct rneagen_error *e)
{
	char text[NUMBER_SIZE + 1];

	snprintf(text, sizeof text, NUMBER, done);
	if (pwrite(r->fd, text, NUMBER_SIZE, NUMBER_AT) != NUMBER_SIZE || fdatasync(r->fd))
		return pending_fail(r->path, e);
	return RNEAGEN_OK;
}

void eval_resume_remove(const struct eval_resume *r)
{
	unlink(r->path);
}

enum rneagen_code eval_resume_clear(const struct eval_resume *r, struct rneagen_error *e)
{
	char begin[NUMBER_AT];
	FILE *f = fopen(r->path, "rb");
	int is_ours;

	if (!f)
		return errno == ENOENT ? RNEAGEN_OK : pending_fail(r->path, e);
	is_ours = fread(begin, 1, sizeof begin, f) == sizeof begin && !memcmp(begin, FIRST, sizeof begin);
	fclose(f);
	if (!is_ours)
		return error_set(e, RNEAGEN_WRITE, "%s: stands where --resume keeps its place, and is no such file; move it", r->path);
	eval_resume_remove(r);
	return RNEAGEN_OK;
}

void eval_resume_close(struct eval_resume *r)
{
	if (r->fd >= 0)
		close(r->fd);
	r->fd = -1;
	arena_free(&r->arena);
}
