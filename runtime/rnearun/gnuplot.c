#include "rnearun/gnuplot.h"
#include "cli/files.h"
#include "cli/pending.h"
#include "core/child.h"
#include "core/scratch.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Found along PATH by env, without a shell. */
static enum rneagen_code run(const char *option, const char *flag, const char *script, struct rneagen_error *e)
{
	const char *const argv[] = {"env", "gnuplot", flag, script, NULL}, *const none[] = {NULL};
	struct child end;

	if (child_run("/usr/bin/env", argv, none, NULL, &end))
		return error_set(e, RNEAGEN_UNSUPPORTED, "%s: /usr/bin/env cannot be run", option);
	if (end.status == 127)
		error_set(e, RNEAGEN_UNSUPPORTED, "%s: gnuplot is not installed: there is none in PATH", option);
	else if (end.status || end.signal)
		error_set(e, RNEAGEN_UNSUPPORTED, "%s: gnuplot fails: %.400s", option, end.output);
	free(end.output);
	return e->code;
}

enum rneagen_code gnuplot_check(const char *option, struct rneagen_error *e)
{
	return run(option, "--version", NULL, e);
}

static enum rneagen_code put_script(const char *path, const char *svg, void (*put)(const void *, FILE *), const void *context,
	struct rneagen_error *e)
{
	FILE *f = fopen(path, "w");

	if (!f)
		return pending_fail(path, e);
	fprintf(f, "set output '");
	for (const char *c = svg; *c; c++)
		fputs(*c == '\'' ? "''" : (char[]){*c, '\0'}, f);
	fprintf(f, "'\n");
	put(context, f);
	return fclose(f) ? pending_fail(path, e) : RNEAGEN_OK;
}

static enum rneagen_code publish(const char *svg, const char *path, struct rneagen_error *e)
{
	struct file_content picture = {0};
	struct pending out = {0};

	if (file_read(svg, &picture, e) || pending_open(&out, path, e)) {
		free(picture.bytes);
		return e->code;
	}
	if (fwrite(picture.bytes, 1, picture.length, out.f) != picture.length)
		pending_fail(path, e);
	if (!e->code && !pending_close(&out, e))
		pending_publish(&out, e);
	pending_drop(&out);
	free(picture.bytes);
	return e->code;
}

/* In a folder of its own, which goes again; with gnuplot's own settings, not the user's. */
enum rneagen_code gnuplot_draw(const char *option, const char *path, void (*put)(const void *context, FILE *f),
	const void *context, struct rneagen_error *e)
{
	struct scratch s;
	char script[sizeof s.folder + 16], svg[sizeof s.folder + 16];
	int why = scratch_make(&s);

	if (why)
		return error_set(e, RNEAGEN_WRITE, "%s: no folder can be made below TMPDIR or /tmp: %s", option, strerror(why));
	snprintf(script, sizeof script, "%s/plot.gp", s.folder);
	snprintf(svg, sizeof svg, "%s/plot.svg", s.folder);
	if (!put_script(script, svg, put, context, e) && !run(option, "-d", script, e))
		publish(svg, path, e);
	scratch_remove(&s);
	return e->code;
}

void gnuplot_put_name(FILE *f, const char *name)
{
	for (; *name; name++)
		fputc(isalnum((unsigned char)*name) || strchr(" .-_", *name) ? *name : ' ', f);
}
