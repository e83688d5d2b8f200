#include "host/compiler.h"
#include "core/child.h"
#include "core/log.h"
#include "core/scratch.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Sums are rounded as the text has them: without extensions gcc contracts nothing, and clang nothing across statements.
   The object's own functions are not to be replaced by those of a program that was linked with the same text. gcc
   spends most of its time on a humanoid combining instructions by threes and fours, to no gain in speed: by twos it
   takes half as long. clang does not know that parameter, and is not to warn of it. */
static const char *const before[] = {"-std=c11", "-O3", "-fPIC", "-shared", "-fvisibility=default", "-Wl,-Bsymbolic",
	"--param=max-combine-insns=2", "-Wno-unused-command-line-argument"};
static const char native[] = "-march=native";

enum { BEFORE = sizeof before / sizeof *before, FIXED = BEFORE + 9 /* and a NULL */, NAME_LENGTH = 300 };

/* One attempt. */
struct attempt {
	const struct compiler *compiler;
	const struct compiler_request *request;
	struct scratch folder;
	char source[1100], object[1100], variable[1100], path[5 + COMPILER_PATH_SIZE]; /* variable, path: of the environment */
	char name[NAME_LENGTH + 1];
};

/* The text's name for a message, which is one line and has to hold what is wrong, too: the end of a long one. */
static void name_text(struct attempt *a)
{
	size_t length = strlen(a->request->file);

	snprintf(a->name, sizeof a->name, "%s", a->request->file + (length > NAME_LENGTH ? length - NAME_LENGTH : 0));
	for (char *s = a->name; *s; s++)
		if ((unsigned char)*s < 0x20)
			*s = ' ';
}

static enum rnea_code cannot_run(const struct attempt *a, int why, struct rnea_error *e)
{
	if (why == ENOMEM)
		return rnea_error_memory(e);
	return rnea_error_set(e, RNEA_COMPILER, "%s: cannot be run: %s", a->compiler->path, strerror(why));
}

/* ---- one run ---- */

static enum rnea_code run(const struct attempt *a, int is_native, struct child *end, struct rnea_error *e)
{
	const struct compiler_request *r = a->request;
	const char **argv = calloc(r->option_count + FIXED, sizeof *argv);
	/* what a compiler that is killed leaves behind is removed with the folder */
	const char *const variables[] = {"LC_ALL=C", a->variable, getenv("PATH") ? NULL : a->path, NULL};
	size_t n = 0;
	int why;

	if (!argv)
		return rnea_error_memory(e);
	argv[n++] = a->compiler->path;
	for (size_t i = 0; i < BEFORE; i++)
		argv[n++] = before[i];
	if (is_native)
		argv[n++] = native;
	for (size_t i = 0; i < r->option_count; i++)
		argv[n++] = r->options[i];
	argv[n++] = "-o";
	argv[n++] = a->object;
	argv[n++] = "-xc";
	argv[n++] = a->source;
	argv[n++] = "-xnone";
	argv[n] = "-lm";
	why = child_run(a->compiler->path, argv, variables, &r->stop, end);
	free(argv);
	return why ? cannot_run(a, why, e) : RNEA_OK;
}

/* A compiler without -march=native names the option. */
static int lacks_native(const struct child *end)
{
	return end->status != 0 && !end->signal && strstr(end->output, "-march") != NULL;
}

static enum rnea_code run_twice(const struct attempt *a, struct child *end, struct rnea_error *e)
{
	if (run(a, 1, end, e) || !lacks_native(end))
		return e->code;
	free(end->output);
	end->output = NULL;
	return run(a, 0, end, e);
}

/* ---- what came of it ---- */

/* Whether an error is of a compiler that does not find its assembler or linker, as gcc and clang put it. */
static int lacks_parts(const struct log_error *found)
{
	static const char *const words[] = {"cannot execute", "cannot find 'ld'", "unable to execute command"};

	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		const char *at = strstr(found->line, words[i]);

		if (at && at < found->line + found->line_length)
			return 1;
	}
	return 0;
}

static enum rnea_code compile_error(const struct attempt *a, const struct child *end, struct rnea_error *e)
{
	const char *path = a->compiler->path, *file = a->name;
	char standard[COMPILER_PATH_SIZE];
	struct log_error found;
	char *log;

	if (end->signal)
		return rnea_error_set(
			e, RNEA_COMPILER, "%s: killed by signal %d while it compiled %s", path, end->signal, file);
	if (!(log = log_replace(end->output, a->source, file)))
		return rnea_error_memory(e);
	if (log_find_error(log, &found) && lacks_parts(&found))
		rnea_error_set(e, RNEA_COMPILER, "%s: %.*s; it looks in PATH (%s)", path, (int)found.line_length, found.line,
			compiler_path(standard));
	else if (found.line)
		rnea_error_set(e, RNEA_COMPILE, "%s: %.*s%s%.*s", path, (int)found.line_length, found.line,
			found.quoted_length ? ": " : "", (int)found.quoted_length, found.quoted);
	else if (end->status == CHILD_UNKNOWN)
		rnea_error_set(e, RNEA_COMPILE, "%s: %s: failed%s%s", path, file, *log ? ": " : "", log);
	else
		rnea_error_set(
			e, RNEA_COMPILE, "%s: %s: exit status %d%s%s", path, file, end->status, *log ? ": " : "", log);
	free(log);
	return e->code;
}

static enum rnea_code keep_log(const struct attempt *a, const struct child *end, struct rnea_error *e)
{
	const struct compiler_request *r = a->request;
	char *log;

	if (!r->log || !r->log_size)
		return RNEA_OK;
	if (!(log = log_replace(end->output, a->source, r->file)))
		return rnea_error_memory(e);
	snprintf(r->log, r->log_size, "%s", log);
	free(log);
	return RNEA_OK;
}

/* Where the status is not known the object tells: linkers write an object's head last, or rename the whole. */
static enum rnea_code take_object(
	const struct attempt *a, const struct child *end, char **object, size_t *size, struct rnea_error *e)
{
	int why;

	if (end->signal || (end->status != 0 && end->status != CHILD_UNKNOWN))
		return compile_error(a, end, e);
	why = scratch_read(a->object, object, size);
	if (why == ENOENT && end->status == CHILD_UNKNOWN)
		return compile_error(a, end, e);
	if (why == ENOMEM)
		return rnea_error_memory(e);
	if (why || !*size)
		return rnea_error_set(e, RNEA_COMPILER, "%s: ended without an error and without an object for %s: %s",
			a->compiler->path, a->name, why ? strerror(why) : "it is empty");
	return RNEA_OK;
}

static enum rnea_code compile(struct attempt *a, char **object, size_t *size, struct rnea_error *e)
{
	struct child end = {0};
	int why;

	name_text(a);
	snprintf(a->source, sizeof a->source, "%s/text.c", a->folder.folder);
	snprintf(a->object, sizeof a->object, "%s/text.so", a->folder.folder);
	snprintf(a->variable, sizeof a->variable, "TMPDIR=%s", a->folder.folder);
	snprintf(a->path, sizeof a->path, "PATH=");
	compiler_path(a->path + strlen(a->path));
	if ((why = scratch_write(a->source, a->request->source, strlen(a->request->source))) != 0)
		return rnea_error_set(e, RNEA_COMPILER, "%s: cannot be written: %s; TMPDIR names another folder",
			a->source, strerror(why));
	if (!run_twice(a, &end, e) && !keep_log(a, &end, e))
		take_object(a, &end, object, size, e);
	free(end.output);
	return e->code;
}

enum rnea_code compiler_run(
	const struct compiler *c, const struct compiler_request *r, char **object, size_t *size, struct rnea_error *e)
{
	struct attempt a = {.compiler = c, .request = r};
	int why = scratch_make(&a.folder);

	*object = NULL;
	*size = 0;
	if (why)
		return rnea_error_set(e, RNEA_COMPILER,
			"no folder for the compiler's files in TMPDIR or /tmp: %s; TMPDIR names another",
			strerror(why));
	compile(&a, object, size, e);
	scratch_remove(&a.folder);
	if (e->code) {
		free(*object);
		*object = NULL;
		*size = 0;
	}
	return e->code;
}

void compiler_describe(const struct compiler *c, char *text, size_t size)
{
	const char *const argv[] = {c->path, "--version", NULL}, *const variables[] = {"LC_ALL=C", NULL};
	struct child end;

	snprintf(text, size, "%s", c->path);
	if (child_run(c->path, argv, variables, NULL, &end) != 0)
		return;
	end.output[strcspn(end.output, "\r\n")] = '\0';
	if (end.status == 0 && end.output[0])
		snprintf(text, size, "%.200s (%s)", end.output, c->path);
	free(end.output);
}
