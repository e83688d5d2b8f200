/* rnearun prove: what holds for every state within the limits. */
#define _POSIX_C_SOURCE 200809L
#include "proved/run_prove.h"
#include "proved/envelope.h"
#include "proved/write_certificate.h"
#include "core/seconds.h"
#include "steps/cuts.h"
#include "rnearun/command.h"
#include "rnearun/gnuplot.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
	"usage: rnearun prove ROBOT.urdf --range qdd=-20,20 [options]\n"
	"\n"
	"Proves, for all states within the limits of the joints and the ranges given, from where to where each torque goes, and\n"
	"how far rounding takes a text off in each precision. Beside it stands what a search over the same states finds. What\n"
	"has no limit in the URDF needs a --range.\n"
	"\n"
	"  --range NAME=LO,HI         of q, qd, qdd, q.JOINT, qd.JOINT, qdd.JOINT or another input of the scene\n"
	"  --seconds S                for proof and search together (default 60)\n"
	"  --format text|json         (default text)\n"
	"  --envelope FILE            for sizing actuators, as CSV: the range of each joint's torque beside its limit of effort\n"
	"  --picture FILE             the same drawn, as SVG, by gnuplot\n"
	"  --certificate FILE         bounds and the steps that they follow from, for rnearun check-certificate; it takes a third of\n"
	"                             the time\n"
	"  --precision f32|f64|mixed|f32x2\n"
	"                             several, by commas (default f32,f64)\n"
	"  --trig accurate|bounded|fast\n"
	COMMAND_HELP_MODEL
	"\n"
	"exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is, or a range is missing\n";

enum { KEY_PRECISION = COMMAND_OWN, KEY_SECONDS, KEY_FORMAT, KEY_ENVELOPE, KEY_PICTURE, KEY_CERTIFICATE };
enum format { FORMAT_TEXT, FORMAT_JSON };

static const struct option OPTIONS[] = {{"precision", required_argument, NULL, KEY_PRECISION},
	{"seconds", required_argument, NULL, KEY_SECONDS}, {"format", required_argument, NULL, KEY_FORMAT},
	{"envelope", required_argument, NULL, KEY_ENVELOPE}, {"picture", required_argument, NULL, KEY_PICTURE},
	{"certificate", required_argument, NULL, KEY_CERTIFICATE},
	COMMAND_MODEL_OPTIONS, {NULL, 0, NULL, 0}};

struct proving {
	struct command command;
	struct prove_options options;
	int format;
	const char *envelope, *picture, *certificate; /* files; NULL: not asked for */
	struct file_content urdf;
	struct analysis analysis, stated;
	struct arena arena;
};

static int take_precision(struct proving *p, const char *name, const char *word)
{
	struct rneagen_options o = {0};
	int bad = option_generate(name, &o, OPTION_PRECISION, word);

	for (int i = 0; i < p->options.precision_count; i++)
		if (p->options.precisions[i] == o.precision)
			return bad;
	if (!bad && p->options.precision_count < PROVE_PRECISIONS)
		p->options.precisions[p->options.precision_count++] = o.precision;
	return bad;
}

static int take_precisions(struct proving *p, const char *name, const char *words)
{
	char word[32];
	int bad = 0;

	p->options.precision_count = 0;
	for (;;) {
		size_t n = strcspn(words, ",");

		snprintf(word, sizeof word, "%.*s", (int)(n < sizeof word ? n : sizeof word - 1), words);
		bad = take_precision(p, name, word);
		if (bad || !words[n])
			return bad;
		words += n + 1;
	}
}

static int take_file(struct proving *p, const char *name, int key, const char *word)
{
	static const char *const svg[] = {".svg", NULL};

	if (!strcmp(word, "-"))
		return option_refuse(name, "--%s takes the name of a file; standard output has the rows",
			key == KEY_PICTURE ? "picture" : "envelope");
	if (key == KEY_PICTURE && !file_has_suffix(word, svg))
		return option_refuse(name, "--picture %s: the picture is SVG; name a file that ends in .svg", word);
	*(key == KEY_PICTURE ? &p->picture : &p->envelope) = word;
	return 0;
}

static int take(void *own, const char *name, int key, const char *word)
{
	static const struct option_choice formats[] = {{"text", FORMAT_TEXT}, {"json", FORMAT_JSON}, {NULL, 0}};
	struct proving *p = own;
	char *end;

	if (key == KEY_PRECISION)
		return take_precisions(p, name, word);
	if (key == KEY_CERTIFICATE)
		p->certificate = word;
	if (key == KEY_CERTIFICATE)
		return *word && strcmp(word, "-") ? 0 : option_refuse(name, "--certificate takes the name of a file");
	if (key == KEY_FORMAT)
		return option_choose(name, "format", word, formats, &p->format);
	if (key == KEY_ENVELOPE || key == KEY_PICTURE)
		return take_file(p, name, key, word);
	p->options.seconds = strtod(word, &end);
	if (end == word || *end || !(p->options.seconds > 0) || p->options.seconds > 1e6)
		return option_refuse(name, "--seconds takes a positive number up to 1e6, not '%s'", word);
	return 0;
}

static int fail(const struct proving *p, const struct rneagen_error *e)
{
	command_fail(&p->command, e->message);
	return 1 + option_at_fault(e->code);
}

/* Files first: what fails there leaves nothing on standard output. */
static enum rneagen_code write_envelope(const struct proving *p, const struct envelope *x, struct arena *a,
	struct rneagen_error *e)
{
	struct text csv;

	text_init(&csv, a);
	envelope_put_csv(x, &csv);
	if (csv.failed)
		return error_memory(e);
	if (p->picture && envelope_draw(x, p->picture, e))
		return e->code;
	return p->envelope ? file_write_pair(p->envelope, text_string(&csv), NULL, e) : RNEAGEN_OK;
}

static int print(const struct proving *p, const struct proved *x)
{
	struct arena arena;
	struct text out;
	struct envelope envelope;
	struct rneagen_error e = {0};
	int status = 0;

	arena_init(&arena, NULL);
	text_init(&out, &arena);
	out.failed = !envelope_list(&envelope, x, &arena);
	if (p->format == FORMAT_JSON)
		rows_put_json(x, &out);
	else
		rows_put_table(x, &out);
	if (p->format != FORMAT_JSON && !out.failed)
		envelope_put_limits(&envelope, &out);
	if (!out.failed && write_envelope(p, &envelope, &arena, &e))
		status = fail(p, &e);
	else if (out.failed)
		status = command_fail(&p->command, "out of memory");
	else {
		fputs(text_string(&out), stdout);
		status = command_flush(&p->command);
	}
	arena_free(&arena);
	return status;
}

/* A certificate takes a share of the time. */
#define SHARE_CERTIFICATE 0.33

/* The same outputs by the URDF's constants, where the text has others and leaves nothing out. */
static const struct analysis *stated_of(struct proving *p, struct rneagen_error *e)
{
	struct analysis *x = &p->stated;

	if (!p->analysis.params.is_base || p->analysis.adjust.prune != 0)
		return NULL;
	analysis_copy(x, &p->analysis, &p->arena, e);
	x->tree = x->stated;
	x->params = (struct params_choice){0};
	return analysis_run(x, PASS_REQUEST_RESOLVE, PASS_DAG_FUSE) ? NULL : x;
}

static void prove_and_certify(struct proving *p, struct proof *proof, const struct box *box, struct progress *progress,
	struct rneagen_error *e)
{
	struct prove_options o = p->options;
	struct record record;
	int position = dag_find_role(&p->analysis.dag, ROLE_JOINT_POSITION, 0);

	if (!p->certificate) { /* which tells of one DAG, the text's */
		o.stated = stated_of(p, e);
		if (!e->code)
			prove(proof, &p->analysis, box, &o, progress, e);
		return;
	}
	if (!record_make(&record, p->analysis.dag.output_count, position < 0 ? 0 : p->analysis.dag.arguments[position].rows))
		error_memory(e);
	o.record = &record;
	o.seconds *= 1 - SHARE_CERTIFICATE;
	if (!e->code && !prove(proof, &p->analysis, box, &o, progress, e))
		write_certificate(p->certificate, proof, &p->analysis, &o, SHARE_CERTIFICATE * p->options.seconds, e);
	record_free(&record);
}

static int prove_robot(struct proving *p)
{
	struct rneagen_error e = {0};
	struct box box;
	struct proof proof = {0};
	struct progress progress;
	int status;

	if ((p->envelope || p->picture) && !envelope_is_there(&p->analysis.dag))
		error_set(&e, RNEAGEN_USAGE, "--envelope and --picture: no output is a torque: --want tau, gravity or bias");
	if (!e.code && p->picture)
		gnuplot_check("--picture", &e);
	if (e.code || box_make(&box, &p->analysis, &p->arena, &e))
		return fail(p, &e);
	progress_start(&progress, p->command.name, "seconds", (uint64_t)ceil(p->options.seconds), p->command.quiet);
	prove_and_certify(p, &proof, &box, &progress, &e);
	progress_end(&progress);
	status = e.code ? fail(p, &e) : print(p, &(struct proved){&p->analysis, &box, &p->options, &proof});
	free(proof.rows);
	return status;
}

static int run(struct proving *p)
{
	int status = command_analyse(&p->command, &p->urdf, &p->analysis);

	arena_init(&p->arena, NULL);
	if (!status) {
		status = prove_robot(p);
		analysis_free(&p->analysis);
	}
	arena_free(&p->arena);
	free(p->urdf.bytes);
	return status;
}

int run_prove(struct ranks *ranks, int argc, char **argv)
{
	static const struct command_kind kind = {"rnearun prove", HELP, OPTIONS, ":", take};
	struct proving p = {.options = {.precisions = {RNEAGEN_F32, RNEAGEN_F64}, .precision_count = 2, .seconds = 60,
		.start = seconds_now()}};
	int status = command_parse(&p.command, &kind, &p, ranks, argc, argv);

	if (status < 0)
		status = command_note(&p.command, &p.command.written, "", "-");
	if (status < 0 && p.envelope)
		status = command_note(&p.command, &p.command.written, "--envelope", p.envelope);
	if (status < 0 && p.picture)
		status = command_note(&p.command, &p.command.written, "--picture", p.picture);
	if (status < 0 && p.certificate)
		status = command_note(&p.command, &p.command.written, "--certificate", p.certificate);
	if (status < 0)
		status = command_check_files(&p.command);
	if (status < 0) {
		p.options.threads = p.command.open.threads;
		status = ranks->index ? 0 : run(&p); /* for others to wait is all that is of use */
	}
	command_free(&p.command);
	return status;
}
