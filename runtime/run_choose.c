/* rnearun choose: the fastest variant that is close enough. */
#define _POSIX_C_SOURCE 200809L
#include "run_choose.h"
#include "emit.h"
#include "identifier.h"
#include "progress.h"
#include "scene_put.h"
#include "study.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
	"usage: rnearun choose ROBOT.urdf --max-error E [options]\n"
	"\n"
	"Picks the fastest variant of the robot's inverse dynamics on this machine whose error, ||tau - ref|| / ||ref||, stays\n"
	"under E in all samples, both as measured and by the bound of the rounding errors; says why, and prints the rneagen\n"
	"command for it.\n"
	"\n"
	"  --max-error E              such as 1e-6\n"
	"  --batch N                  samples of one launch, for the time (default 65536)\n"
	STUDY_HELP COMMAND_HELP_MODEL
	"\n"
	"exit status: 0 done, 1 no variant is close enough, or the robot or a file is at fault, 2 the command line is at fault\n";

enum { KEY_MAX_ERROR = STUDY_OWN };

static const struct option OPTIONS[] = {STUDY_OPTIONS, {"max-error", required_argument, NULL, KEY_MAX_ERROR},
	COMMAND_OPTIONS, {NULL, 0, NULL, 0}};

struct candidate {
	struct study_row row;
	int fits;
	char why[96]; /* it does not */
};

struct choosing {
	struct command command;
	struct study_options options;
	double max_error; /* 0: not given */
	struct study study;
	struct candidate *candidates;
	int count;
};

static int take(void *own, const char *name, int key, const char *word)
{
	struct choosing *c = own;

	return key == KEY_MAX_ERROR ? study_number(name, "max-error", word, &c->max_error)
				    : study_take(&c->options, name, key, word);
}

/* The bound is known without compiling anything: what it rules out is not measured. */
static enum rneagen_code examine(struct choosing *c, struct candidate *v, struct study_backend *b)
{
	if (study_bound(&c->study, &v->row))
		return c->study.error.code;
	v->row.errors.max = (double)NAN;
	if (isnan(v->row.bound_max))
		snprintf(v->why, sizeof v->why, "no bound of its error is known");
	else if (!(v->row.bound_max <= c->max_error))
		snprintf(v->why, sizeof v->why, "its bound %.1e is over %.1e", v->row.bound_max, c->max_error);
	else if (!study_measure(&c->study, b, &v->row) && !(v->row.errors.max <= c->max_error))
		snprintf(v->why, sizeof v->why, "its error %.1e is over %.1e", v->row.errors.max, c->max_error);
	v->fits = !*v->why;
	return c->study.error.code;
}

static int examine_all(struct choosing *c)
{
	struct progress progress;

	c->count = study_variants(&c->study);
	c->candidates = calloc((size_t)c->count + 1, sizeof *c->candidates);
	if (!c->candidates)
		return command_fail(&c->command, "out of memory");
	progress_start(&progress, c->command.name, "variants", (uint64_t)c->count, c->command.quiet);
	for (int i = 0; i < c->count && !c->study.error.code; i++) {
		struct study_backend *b = study_variant(&c->study, i, &c->candidates[i].row);

		examine(c, &c->candidates[i], b);
		progress_show(&progress, (uint64_t)i + 1);
	}
	progress_end(&progress);
	return c->study.error.code ? command_fail(&c->command, c->study.error.message) : 0;
}

/* ---- saying ---- */

static void name_variant(const struct study_row *r, char *text, size_t size)
{
	snprintf(text, size, "%s %s %s %s", study_backend_name(r->backend), emit_precision_name(r->precision),
		emit_trig_name(r->trig), emit_layout_name(r->layout));
}

static void say(const struct candidate *v, const struct candidate *best)
{
	char name[64];

	name_variant(&v->row, name, sizeof name);
	printf("%-24s ", name);
	if (!v->fits)
		printf("rejected: %s\n", v->why);
	else
		printf("%s: %.2f times the time, error %.1e, bound %.1e\n", v == best ? "chosen" : "slower", v->row.ns / best->row.ns,
			v->row.errors.max, v->row.bound_max);
}

static void put_command(const struct choosing *c, const struct study_row *r, const char *name, struct text *out)
{
	struct rneagen_options o = c->command.generate;
	const struct tree *t = &c->study.analysis.tree;

	o.target = r->backend == RNEA_BACKEND_CUDA ? RNEAGEN_TARGET_CUDA : RNEAGEN_TARGET_C;
	o.precision = r->precision;
	o.trig = r->trig;
	o.layout = r->layout;
	text_put(out, "rneagen ");
	text_put_shell(out, c->command.urdf);
	emit_options(&o, out);
	if (o.order) {
		text_put(out, " --order ");
		text_put_shell(out, o.order);
	}
	for (int i = 0; i < t->scene.line_count; i++)
		if (scene_put_matters(t, i)) {
			text_putc(out, ' ');
			scene_put_option(&t->scene.lines[i], out);
		}
	text_printf(out, " -o %s_rnea.%s\n", name, o.target == RNEAGEN_TARGET_CUDA ? "cu" : "c");
}

static const struct candidate *find_fastest(const struct choosing *c)
{
	const struct candidate *best = NULL;

	for (int i = 0; i < c->count; i++)
		if (c->candidates[i].fits && (!best || c->candidates[i].row.ns < best->row.ns))
			best = &c->candidates[i];
	return best;
}

/* None fits: the one with the least bound is named. */
static int refuse(const struct choosing *c)
{
	const struct candidate *best = NULL;
	char text[256], name[64];

	for (int i = 0; i < c->count; i++)
		if (!best || c->candidates[i].row.bound_max < best->row.bound_max || isnan(best->row.bound_max))
			best = &c->candidates[i];
	if (!best)
		return command_fail(&c->command, "no backend is there");
	name_variant(&best->row, name, sizeof name);
	snprintf(text, sizeof text, "no variant stays under %.1e; the best there is, %s, has the bound %.1e", c->max_error, name,
		best->row.bound_max);
	return command_fail(&c->command, text);
}

static int print(struct choosing *c)
{
	const struct candidate *best = find_fastest(c);
	const char *name = identifier_from(c->study.analysis.robot.name, &c->study.analysis.arena);
	struct text command;

	if (!best)
		return refuse(c);
	text_init(&command, &c->study.analysis.arena);
	put_command(c, &best->row, name ? name : "", &command);
	if (!name || command.failed)
		return command_fail(&c->command, "out of memory");
	say(best, best);
	for (int i = 0; i < c->count; i++)
		if (&c->candidates[i] != best)
			say(&c->candidates[i], best);
	fputs(text_string(&command), stdout);
	if (fflush(stdout) || ferror(stdout))
		return command_fail(&c->command, "standard output: cannot be written");
	return 0;
}

static int choose(struct choosing *c)
{
	int status = study_open(&c->study, &c->command, &c->options);

	if (!status)
		status = examine_all(c);
	if (!status)
		status = print(c);
	study_close(&c->study);
	free(c->candidates);
	return status;
}

int run_choose(int argc, char **argv)
{
	static const struct command_kind kind = {"rnearun choose", HELP, OPTIONS, ":", take};
	struct choosing c = {.options = study_options_default()};
	int status;

	c.options.batches[0] = 65536;
	c.options.batch_count = 1;
	status = command_parse(&c.command, &kind, &c, argc, argv);
	if (status < 0 && c.max_error == 0)
		status = option_refuse(c.command.name, "no error named: --max-error E");
	if (status < 0 && c.options.batch_count != 1)
		status = option_refuse(c.command.name, "--batch takes one number here");
	if (status < 0)
		status = command_note(&c.command, &c.command.written, "", "-");
	if (status < 0)
		status = command_check_files(&c.command);
	if (status < 0)
		status = choose(&c);
	command_free(&c.command);
	return status;
}
