/* rnearun choose: the fastest variant that is close enough. */
#define _POSIX_C_SOURCE 200809L
#include "study/run_choose.h"
#include "study/choice.h"
#include "emit/emit.h"
#include "base/identifier.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
	"usage: rnearun choose ROBOT.urdf --max-error E [options]\n"
	"\n"
	"Picks the fastest variant of the robot's inverse dynamics on this machine whose error, ||tau - ref|| / ||ref||, stays\n"
	"under E in all samples, by the bound of the rounding errors, those of the URDF's decimals included, which holds for every\n"
	"compiler, and as measured; says why, and prints the rneagen command for it. Where another --trig is as fast, within the\n"
	"spread of the times, accurate comes before bounded, and bounded before fast.\n"
	"\n"
	"  --max-error E              such as 1e-6\n"
	"  --measured                 judge by the measured errors alone: bounds are often ten times as large\n"
	"  --proved                   judge by errors that no state within the limits of the joints and the ranges exceeds, over the\n"
	"                             largest ||ref|| of the samples; what has no limit needs a --range, as in rnearun prove\n"
	"  --seconds S                for that proof (default 30)\n"
	"  --batch N                  samples of one launch, for the time (default 65536)\n"
	STUDY_HELP COMMAND_HELP_MODEL
	"\n"
	"exit status: 0 done, 1 no variant is close enough, or the robot or a file is at fault, 2 the command line is at fault\n";

enum { KEY_MAX_ERROR = STUDY_OWN, KEY_MEASURED, KEY_PROVED, KEY_SECONDS };

static const struct option OPTIONS[] = {STUDY_OPTIONS, {"max-error", required_argument, NULL, KEY_MAX_ERROR},
	{"measured", no_argument, NULL, KEY_MEASURED}, {"proved", no_argument, NULL, KEY_PROVED},
	{"seconds", required_argument, NULL, KEY_SECONDS}, COMMAND_OPTIONS, {NULL, 0, NULL, 0}};

/* Every variant that is close enough is timed so often, in turns with the others. */
enum { ROUNDS = 3 };

struct choosing {
	struct command command;
	struct study_options options;
	double max_error; /* 0: not given */
	int measured, proved;
	double seconds; /* for the proof; 0: not given */
	struct study study;
	struct candidate *candidates;
	int count;
};

static int take(void *own, const char *name, int key, const char *word)
{
	struct choosing *c = own;

	if (key == KEY_MEASURED)
		c->measured = 1;
	else if (key == KEY_PROVED)
		c->proved = 1;
	else if (key == KEY_SECONDS)
		return study_number(name, "seconds", word, &c->seconds);
	else
		return key == KEY_MAX_ERROR ? study_number(name, "max-error", word, &c->max_error)
					    : study_take(&c->options, name, key, word);
	return 0;
}

/* ---- examining ---- */

/* By measured errors. */
static void weigh(const struct choosing *c, struct candidate *v)
{
	if ((v->verdict = choice_by_error(&v->row, c->max_error)) == VERDICT_CLOSE)
		return;
	rnea_close(v->robot);
	v->robot = NULL;
}

/* The bound is known without compiling anything: what it rules out is not measured. */
static enum rneagen_code examine(struct choosing *c, struct candidate *v)
{
	struct study *s = &c->study;

	v->row.errors.max = (double)NAN;
	if (study_bound(s, &v->row))
		return s->error.code;
	if (c->proved && (v->verdict = choice_by_proof(&v->row, c->max_error)) != VERDICT_CLOSE)
		return RNEAGEN_OK;
	if (!c->measured && !c->proved && (v->verdict = choice_by_bound(&v->row, c->max_error)) != VERDICT_CLOSE)
		return RNEAGEN_OK;
	if (!study_build(s, &v->row, &v->robot))
		weigh(c, v);
	return s->error.code;
}

/* Of all rounds the least time: what else the machine does only adds. */
static enum rneagen_code time_once(struct choosing *c, struct candidate *v, int round)
{
	double least = v->row.least;

	study_show(&c->study, c->count + round, &v->row);
	if (study_time(&c->study, v->robot, &v->row, c->options.batches[0]))
		return c->study.error.code;
	v->slowest = fmax(v->slowest, v->row.ns);
	if (round)
		v->row.least = fmin(v->row.least, least);
	weigh(c, v); /* the timed launch was judged too */
	return RNEAGEN_OK;
}

static int examine_all(struct choosing *c)
{
	struct study *s = &c->study;

	c->candidates = calloc((size_t)s->variant_count + 1, sizeof *c->candidates);
	if (!c->candidates)
		return command_fail(&c->command, "out of memory");
	study_show(s, 0, s->variants);
	if (c->proved && study_prove(s, c->seconds > 0 ? c->seconds : 30)) {
		progress_end(&s->progress);
		command_fail(&c->command, s->error.message);
		return 1 + option_at_fault(s->error.code);
	}
	s->progress.unit = "steps";
	s->progress.total = (uint64_t)(s->variant_count + ROUNDS);
	for (; c->count < s->variant_count && !s->error.code; c->count++) {
		c->candidates[c->count].row = s->variants[c->count];
		study_show(s, c->count, &s->variants[c->count]);
		examine(c, &c->candidates[c->count]);
	}
	for (int i = 0; i < ROUNDS * c->count && !s->error.code; i++)
		if (c->candidates[i % c->count].robot)
			time_once(c, &c->candidates[i % c->count], i / c->count);
	progress_end(&s->progress);
	return s->error.code ? command_fail(&c->command, s->error.message) : 0;
}

/* ---- saying ---- */

static void say_rejected(const struct choosing *c, const struct candidate *v)
{
	const struct study_row *r = &v->row;

	switch (v->verdict) {
	case VERDICT_NO_BOUND:
		printf("rejected: no bound of its error is known; not measured");
		break;
	case VERDICT_OVER_BOUND:
		printf("rejected by its bound, %.1e, over %.1e; not measured", r->bound_max, c->max_error);
		break;
	case VERDICT_NO_PROOF:
		printf("rejected: no bound of its error is proved, and rnearun prove says why; not measured");
		break;
	case VERDICT_OVER_PROOF:
		printf("rejected by its proved bound, %.1e, over %.1e; not measured", r->proved, c->max_error);
		break;
	case VERDICT_NO_ERROR:
		printf("rejected: its error is not known, for all that it is compared with is 0");
		break;
	default:
		printf("rejected by its measured error, %.1e, over %.1e", r->errors.max, c->max_error);
	}
}

static void say_time(const struct choosing *c, const struct candidate *v, const struct candidate *best,
	const struct candidate *fastest)
{
	const struct study_row *r = &v->row;
	int tied = v != fastest && choice_is_tied(v, fastest);

	printf("%s: %.2f times the least time%s, error %.1e, bound %.1e",
		v == best	       ? "chosen"
		: tied || v == fastest ? "tied"
				       : "slower",
		r->least / fastest->row.least, tied ? ", within the spread" : "", r->errors.max, r->bound_max);
	if (c->proved)
		printf(", proved %.1e", r->proved);
	if (v == best && tied)
		printf("; %s comes before %s", emit_trig_name(r->trig), emit_trig_name(fastest->row.trig));
}

static void say(const struct choosing *c, const struct candidate *v, const struct candidate *best,
	const struct candidate *fastest)
{
	char name[64], same[32];

	study_name(&v->row, name, sizeof name);
	study_same(&v->row, ", ", same, sizeof same);
	printf("%-24s ", name);
	if (v->robot)
		say_time(c, v, best, fastest);
	else
		say_rejected(c, v);
	printf(*same ? "; the same code: %s\n" : "\n", same);
}

/* Where a bound rejected something. */
static void say_measured(const struct choosing *c)
{
	int found = 0;

	for (int i = 0; i < c->count; i++)
		found |= c->candidates[i].verdict == VERDICT_OVER_BOUND || c->candidates[i].verdict == VERDICT_NO_BOUND;
	if (found)
		puts("Bounds hold for every compiler, measured errors for this one: --measured judges by these alone.");
}

static void put_command(const struct choosing *c, const struct study_row *r, const char *name, struct text *out)
{
	struct rneagen_options o = study_generate(&c->study, r);
	const struct analysis *a = &c->study.analysis;
	struct adjust adjust = a->adjust;

	adjust.has_angles = adjust.has_angles && r->trig == RNEAGEN_BOUNDED;
	text_printf(out, "rneagen %s", text_before_file(c->command.urdf));
	text_put_shell(out, c->command.urdf);
	emit_options(&o, out);
	if (o.order) {
		text_put(out, " --order ");
		text_put_shell(out, o.order);
	}
	for (int i = 0; i < a->scene.line_count; i++)
		if (adjust_matters(&adjust, &a->scene, i)) {
			text_putc(out, ' ');
			scene_put_option(&a->scene.lines[i], out);
		}
	text_printf(out, " -o %s_rnea.%s\n", name, o.target == RNEAGEN_TARGET_CUDA ? "cu" : "c");
}

/* What a variant is judged by. */
static double measure_of(const struct choosing *c, const struct candidate *v)
{
	return c->measured ? v->row.errors.max : c->proved ? v->row.proved : v->row.bound_max;
}

/* None is close enough: the closest is named. */
static int refuse(const struct choosing *c)
{
	const char *what = c->measured ? "error" : c->proved ? "proved bound" : "bound", *more = c->measured ? ""
		: "; --measured judges by measured errors alone";
	const struct candidate *best = NULL;
	char text[256], name[64];

	for (int i = 0; i < c->count; i++)
		if (!best || measure_of(c, &c->candidates[i]) < measure_of(c, best) || isnan(measure_of(c, best)))
			best = &c->candidates[i];
	if (!best)
		return command_fail(&c->command, "no backend is there");
	study_name(&best->row, name, sizeof name);
	if (isnan(measure_of(c, best)))
		snprintf(text, sizeof text, "no variant has a known %s%s", what, more);
	else
		snprintf(text, sizeof text, "the %s of every variant is over %.1e; the least is %.1e, of %s%s",
			what, c->max_error, measure_of(c, best), name, more);
	return command_fail(&c->command, text);
}

static int print(struct choosing *c)
{
	const struct candidate *fastest = choice_fastest(c->candidates, c->count), *best = choice_best(c->candidates, c->count);
	const char *name = identifier_from(c->study.analysis.robot.name, c->study.analysis.arena);
	struct text command;

	if (!best)
		return refuse(c);
	text_init(&command, c->study.analysis.arena);
	put_command(c, &best->row, name ? name : "", &command);
	if (!name || command.failed)
		return command_fail(&c->command, "out of memory");
	say(c, best, best, fastest);
	for (int i = 0; i < c->count; i++)
		if (&c->candidates[i] != best)
			say(c, &c->candidates[i], best, fastest);
	say_measured(c);
	if (c->proved)
		puts("Proved bounds hold for every state within the limits of the joints and the ranges, over the largest ||ref|| of "
			"the samples.");
	fputs(text_string(&command), stdout);
	return command_flush(&c->command);
}

static int choose(struct choosing *c)
{
	int status = study_open(&c->study, &c->command, &c->options);

	if (!status)
		status = examine_all(c);
	if (!status)
		status = print(c);
	for (int i = 0; i < c->count; i++)
		rnea_close(c->candidates[i].robot);
	study_close(&c->study);
	free(c->candidates);
	return status;
}

int run_choose(struct ranks *ranks, int argc, char **argv)
{
	static const struct command_kind kind = {"rnearun choose", HELP, OPTIONS, ":", take};
	struct choosing c = {.options = study_options_default()};
	int status;

	c.options.batches[0] = 65536;
	c.options.batch_count = 1;
	status = command_parse(&c.command, &kind, &c, ranks, argc, argv);
	if (status < 0 && c.max_error == 0)
		status = option_refuse(c.command.name, "no error named: --max-error E");
	if (status < 0 && c.proved && c.measured)
		status = option_refuse(c.command.name, "--proved and --measured exclude each other");
	if (status < 0 && c.seconds > 0 && !c.proved)
		status = option_refuse(c.command.name, "--seconds is for the proof: take --proved, or leave it out");
	if (status < 0 && c.options.batch_count != 1)
		status = option_refuse(c.command.name, "--batch takes one number here");
	if (status < 0)
		status = command_note(&c.command, &c.command.written, "", "-");
	if (status < 0)
		status = command_check_files(&c.command);
	command_share(&c.command);
	if (status < 0)
		status = ranks->index ? 0 : choose(&c); /* for others to wait is all that is of use */
	command_free(&c.command);
	return status;
}
