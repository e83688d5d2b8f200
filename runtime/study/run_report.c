/* rnearun report: every variant of a robot, its speed and its error. */
#define _POSIX_C_SOURCE 200809L
#include "study/run_report.h"
#include "study/plot.h"
#include "tell/scene_put.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char HELP[] =
	"usage: rnearun report ROBOT.urdf [options]\n"
	"\n"
	"Measures every variant of the robot's inverse dynamics on this machine: how long a sample takes, and how far its\n"
	"torques are off. With a scene, all inputs that it makes are drawn, errors are of the output array that is furthest\n"
	"off in each sample, and 'model' is what constants that it changes (--snap-angle, --round-constants, --drop-below)\n"
	"change in the outputs. 'bound' is of the distance from what the URDF's decimals give in exact arithmetic, angles\n"
	"within 5e-15 rad of a right one and constants that are zero, or equal, but for rounding in extended precision taken to be so.\n"
	"\n"
	"  --format table|json|csv    of what is printed (default: table)\n"
	"  --plot FILE                draw speed against error, as SVG, by gnuplot\n"
	"  --batch N,N,...            samples of one launch (default 1,1024,1048576)\n"
	STUDY_HELP COMMAND_HELP_MODEL
	"\n"
	"exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is\n";

enum { KEY_FORMAT = STUDY_OWN, KEY_PLOT };
enum { FORMAT_TABLE, FORMAT_JSON, FORMAT_CSV };

static const struct option OPTIONS[] = {STUDY_OPTIONS, {"format", required_argument, NULL, KEY_FORMAT},
	{"plot", required_argument, NULL, KEY_PLOT}, COMMAND_OPTIONS, {NULL, 0, NULL, 0}};

struct reporting {
	struct command command;
	struct study_options options;
	int format;
	const char *plot;
	struct study study;
	struct study_row *rows, *each; /* of this rank, then of all together; of each where there are several */
	struct arena arena; /* of the command line */
	struct text words;
};

static int take(void *own, const char *name, int key, const char *word)
{
	static const struct option_choice formats[] = {
		{"table", FORMAT_TABLE}, {"json", FORMAT_JSON}, {"csv", FORMAT_CSV}, {NULL, 0}};
	static const char *const pictures[] = {".png", ".pdf", ".eps", ".ps", ".jpg", ".jpeg", ".gif", ".webp", NULL};
	struct reporting *r = own;

	if (key == KEY_FORMAT)
		return option_choose(name, "format", word, formats, &r->format);
	if (key != KEY_PLOT)
		return study_take(&r->options, name, key, word);
	r->plot = word;
	if (file_has_suffix(word, pictures))
		return option_refuse(name, "--plot %s: the picture is SVG; name a file that ends in .svg", word);
	return *word ? 0 : option_refuse(name, "the name of a file is empty");
}

/* -1, or the exit status and the message of what has failed. */
static int tell(const struct reporting *r)
{
	return r->study.error.code ? command_fail(&r->command, r->study.error.message) : -1;
}

/* Rows of one variant, one for each batch; ranks begin each at the same time. -1, or the exit status of all ranks. */
static int measure_variant(struct reporting *r, int variant)
{
	struct study *s = &r->study;
	struct study_row *row = &r->rows[variant * r->options.batch_count];
	struct study_row built = s->variants[variant];
	struct rnea_robot *robot = NULL;
	int status;

	if (!study_bound(s, &built))
		study_build(s, &built, &robot);
	status = ranks_agree(r->command.ranks, tell(r));
	for (int i = 0; i < r->options.batch_count && status < 0; i++) {
		row[i] = built;
		study_time(s, robot, &row[i], r->options.batches[i]);
		status = ranks_agree(r->command.ranks, tell(r));
	}
	rnea_close(robot);
	return status;
}

/* All ranks have the same variants, or a message. */
static int check_variants(struct reporting *r)
{
	uint64_t count = (uint64_t)r->study.variant_count;

	if (ranks_tell(r->command.ranks, count) != count)
		error_set(&r->study.error, RNEAGEN_UNSUPPORTED,
			"this machine has other backends, or other variants, than the first rank's; name what all have by --backend and --trig");
	return tell(r);
}

/* Rows for all variants: -1, or the exit status and a message. */
static int measure(struct reporting *r)
{
	struct study *s = &r->study;
	size_t count = (size_t)s->variant_count * (size_t)r->options.batch_count + 1;
	int status = ranks_agree(r->command.ranks, check_variants(r));

	r->rows = calloc(count, sizeof *r->rows);
	r->each = calloc(count * r->command.ranks->count, sizeof *r->each);
	if (!r->rows || !r->each)
		error_memory(&s->error);
	if (status < 0)
		status = ranks_agree(r->command.ranks, tell(r));
	for (int i = 0; i < s->variant_count && status < 0; i++) {
		study_show(s, i, &s->variants[i]);
		status = measure_variant(r, i);
	}
	progress_end(&s->progress);
	return status;
}

/* What several ranks do together, at the same time; of errors the largest. `step` rows lie between those of two ranks. */
static void sum_up(struct study_row *sum, const struct study_row *each, size_t ranks, size_t step)
{
	double speed = 0, best = 0, floor = 0, squares = 0;

	*sum = *each;
	for (size_t k = 0; k < ranks; k++) {
		const struct study_row *row = &each[k * step];

		speed += 1 / row->ns;
		best += 1 / row->least;
		floor += 1 / (row->floor_ratio * row->ns);
		squares += row->errors.rms * row->errors.rms / (double)ranks;
		sum->spread = fmax(sum->spread, row->spread);
		sum->errors.max = fmax(sum->errors.max, row->errors.max);
		sum->errors.terms = fmax(sum->errors.terms, row->errors.terms);
		sum->compile_ms = fmax(sum->compile_ms, row->compile_ms);
	}
	sum->ns = 1 / speed;
	sum->least = 1 / best;
	sum->floor_ratio = speed / floor;
	sum->errors.rms = sqrt(squares);
}

static void gather(struct reporting *r, struct report *report)
{
	struct ranks *ranks = r->command.ranks;

	if (ranks->count < 2)
		return;
	ranks_gather(ranks, r->rows, report->count * sizeof *r->rows, r->each);
	for (size_t i = 0; i < report->count; i++)
		sum_up(&r->rows[i], &r->each[i], ranks->count, report->count);
	report->each = r->each;
	report->ranks = ranks->count;
}

/* The command line as it was given, for a shell: getopt_long will change the order of its words. */
static void put_command(struct reporting *r, int argc, char **argv)
{
	arena_init(&r->arena, NULL);
	text_init(&r->words, &r->arena);
	text_put(&r->words, "rnearun");
	for (int i = 0; i < argc; i++) {
		text_putc(&r->words, ' ');
		text_put_shell(&r->words, argv[i]);
	}
}

/* The scene as options of the command line. */
static const char *scene_of(struct reporting *r)
{
	struct text t;

	text_init(&t, r->study.analysis.arena);
	scene_put_options(&r->study.analysis.scene, " ", &t);
	return t.length ? text_string(&t) + 1 : "";
}

static int print(struct reporting *r, const struct report *report)
{
	struct text json;

	text_init(&json, r->study.analysis.arena);
	if (r->format == FORMAT_JSON) {
		report_put_json(report, &json);
		if (json.failed)
			return command_fail(&r->command, "out of memory");
		fputs(text_string(&json), stdout);
	} else if (r->format == FORMAT_CSV) {
		report_put_csv(report, stdout);
	} else {
		report_put_table(report, stdout);
	}
	return command_flush(&r->command);
}

static int report(struct reporting *r)
{
	struct report report = {.study = &r->study};
	time_t now = time(NULL);
	struct tm utc;
	int status = study_open(&r->study, &r->command, &r->options);

	if (!status && !r->study.variant_count)
		status = command_fail(&r->command, "no backend is there");
	status = ranks_agree(r->command.ranks, status ? status : -1);
	if (status < 0)
		status = measure(r);
	if (status >= 0)
		return status;
	report.command = text_string(&r->words);
	report.scene = scene_of(r);
	report.rows = r->rows;
	report.count = (size_t)r->study.variant_count * (size_t)r->options.batch_count;
	gather(r, &report);
	if (r->command.ranks->index)
		return 0;
	strftime(report.date, sizeof report.date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
	status = print(r, &report);
	if (!status && r->plot && plot_write(&report, r->plot, &r->study.error))
		status = command_fail(&r->command, r->study.error.message);
	return status;
}

/* The report and the picture take no place of what is read. */
static int check_files(struct reporting *r)
{
	struct command *c = &r->command;
	int status = command_note(c, &c->written, "", "-");

	if (status < 0 && r->plot)
		status = command_note(c, &c->written, "--plot", r->plot);
	return status < 0 ? command_check_files(c) : status;
}

int run_report(struct ranks *ranks, int argc, char **argv)
{
	static const struct command_kind kind = {"rnearun report", HELP, OPTIONS, ":", take};
	struct reporting r = {.options = study_options_default()};
	int status;

	r.options.compiles_anew = 1; /* its time is reported */
	r.options.batches[0] = 1;
	r.options.batches[1] = 1024;
	r.options.batches[2] = 1048576;
	r.options.batch_count = 3;
	put_command(&r, argc, argv);
	status = command_parse(&r.command, &kind, &r, ranks, argc, argv);
	if (status < 0)
		status = check_files(&r);
	status = ranks_agree(ranks, status);
	command_share(&r.command);
	if (status < 0) {
		status = report(&r);
		study_close(&r.study);
	}
	command_free(&r.command);
	arena_free(&r.arena);
	free(r.rows);
	free(r.each);
	return status;
}
