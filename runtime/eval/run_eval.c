/* rnearun eval: torques, or what else a scene asks for, for arrays on disk, a slice of the batch at a time. */
#define _POSIX_C_SOURCE 200809L
#include "eval/run_eval.h"
#include "eval/crew.h"
#include "eval/eval.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
	"usage: rnearun eval ROBOT.urdf --in STATES.npy --out TAU.npy [options]\n"
	"       rnearun eval ROBOT.urdf --q Q.npy --qd QD.npy --qdd QDD.npy --out TAU.npy [options]\n"
	"\n"
	"Torques tau = ID(q, qd, qdd) for arrays on disk, as numpy.save writes them: float32 or float64, samples along the\n"
	"first axis. Arrays are read in slices; memory does not grow with them. One input, and one output, may be - for\n"
	"standard input and output; else TAU.npy appears when it is complete. Where a scene (--fold, --free, --want, --fext)\n"
	"makes other inputs and outputs, rneagen --info lists them; they are named by the scene's words.\n"
	"mpirun -n N rnearun-mpi eval ... has N ranks of MPI share the samples.\n"
	"\n"
	"  --in FILE                  rows of q, qd, qdd after one another: nq + 2 nv columns; of a scene, those of all\n"
	"                             inputs of samples that no other option names\n"
	"  --q FILE --qd FILE --qdd FILE\n"
	"                             the same in three arrays, of nq, nv and nv columns\n"
	"  --input NAME=FILE          any input; the same numbers for all samples have the shape (rows,). What the scene\n"
	"                             frees may be left out: the URDF's value, 0 for payloads and external forces\n"
	"  -o, --out FILE             the torques: nv columns; of a scene, all outputs after one another\n"
	"  --output NAME=FILE         one output alone\n"
	"  --precision f32|f64|mixed|f32x2\n"
	"                             of the computation and of FILE (default: f64 if an input is, else f32); mixed: FILE\n"
	"                             is f32, the arithmetic f64; f32x2: FILE is f64, the arithmetic pairs of f32\n"
	"  --slice N                  samples read, computed and written at a time (default: 64 MiB of them)\n"
	"  --device all|N,N,...       which GPUs take slices side by side (default 0)\n"
	"  --resume                   go on where a run that ended early has come to; such a run leaves FILE.part, and how\n"
	"                             much of it is complete in FILE.resume\n"
	COMMAND_HELP
	"\n"
	"exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is\n";

enum { KEY_IN = COMMAND_OWN, KEY_Q, KEY_QD, KEY_QDD, KEY_INPUT, KEY_OUTPUT, KEY_SLICE, KEY_DEVICES, KEY_RESUME };

static const struct option OPTIONS[] = {
	{"in", required_argument, NULL, KEY_IN}, {"q", required_argument, NULL, KEY_Q},
	{"qd", required_argument, NULL, KEY_QD}, {"qdd", required_argument, NULL, KEY_QDD},
	{"input", required_argument, NULL, KEY_INPUT}, {"output", required_argument, NULL, KEY_OUTPUT},
	{"out", required_argument, NULL, 'o'}, {"slice", required_argument, NULL, KEY_SLICE},
	{"device", required_argument, NULL, KEY_DEVICES}, {"resume", no_argument, NULL, KEY_RESUME}, COMMAND_OPTIONS,
	{NULL, 0, NULL, 0}};

enum { SLICE_LIMIT = 1 << 30 };

/* ---- the command line ---- */

static int take(void *own, const char *name, int key, const char *word)
{
	struct eval *v = own;
	unsigned long long n = 0;
	int bad;

	if (key == KEY_SLICE) {
		bad = command_number(name, "slice", word, 1, SLICE_LIMIT, &n);
		v->slice = (size_t)n;
		return bad;
	}
	if (key == KEY_DEVICES)
		return eval_devices_take(&v->devices, name, word);
	if (key == KEY_RESUME) {
		v->resumes = 1;
		return 0;
	}
	if (key == KEY_INPUT || key == KEY_OUTPUT)
		return eval_take_pair(key == KEY_INPUT ? &v->inputs : &v->outputs, name,
			key == KEY_INPUT ? "input" : "output", word);
	if (!*word)
		return option_refuse(name, "the name of a file is empty");
	if (key == 'o')
		v->arrays.out = word;
	else if (key == KEY_IN)
		v->arrays.in = word;
	else
		v->parts[key - KEY_Q] = word;
	return 0;
}

/* What can be said before the robot is known. */
static int check_words(struct eval *v)
{
	const char *name = v->command.name;
	int given = 0, status;

	for (int i = 0; i < EVAL_PARTS; i++)
		given += v->parts[i] != NULL;
	if (v->arrays.in && given)
		return option_refuse(name, "--in takes all of q, qd and qdd from one file; leave out --q, --qd and --qdd");
	if (!v->arrays.in && !given && !v->inputs.count && !v->command.generate.scene)
		return option_refuse(name, "no input named: --in FILE, or --q, --qd and --qdd");
	for (int i = 0; i < EVAL_PARTS; i++)
		if (given && !v->parts[i] && !v->inputs.count && !v->command.generate.scene)
			return option_refuse(name, "--%s is missing", EVAL_PART_NAMES[i]);
	if (!v->arrays.out && !v->outputs.count)
		return option_refuse(name, "no output named: --out FILE");
	status = eval_note_output(v, "--out", v->arrays.out);
	if (status < 0)
		status = eval_note_input(v, "--in", v->arrays.in);
	for (int i = 0; i < EVAL_PARTS && status < 0; i++)
		status = eval_note_input(v, EVAL_PART_NAMES[i], v->parts[i]);
	return status < 0 ? command_check_files(&v->command) : status;
}

/* ---- the steps ---- */

/* -1, or the exit status and the message of what has failed. */
static int tell(const struct eval *v)
{
	return v->error.code ? command_fail(&v->command, v->error.message) + option_at_fault(v->error.code) : -1;
}

static int analyse(struct eval *v)
{
	int status = command_analyse(&v->command, &v->urdf, &v->analysis);

	if (status)
		return status;
	if (!signature_of(&v->signature, &v->analysis))
		return command_fail(&v->command, "out of memory");
	v->arrays.s = &v->signature;
	status = eval_name_files(v);
	if (status < 0)
		status = eval_check_inputs(v);
	eval_name_sinks(&v->arrays, v->analysis.arena);
	if (status < 0)
		status = eval_note_parts(v);
	return status < 0 ? command_check_files(&v->command) : status;
}

/* Computed is in double precision if one of the arrays is. */
static int open_inputs(struct eval *v)
{
	int is_wide;

	if (!eval_open_inputs(&v->arrays, &is_wide, &v->error) && v->command.generate.precision == RNEAGEN_PRECISION_DEFAULT)
		v->command.generate.precision = is_wide ? RNEAGEN_F64 : RNEAGEN_F32;
	if (!v->error.code && (v->command.ranks->are_shared || v->resumes))
		eval_check_places(&v->arrays, &v->error);
	return tell(v);
}

/* In the first rank. What an earlier run has left is either gone on with, or taken away with its side file. */
static int open_outputs(struct eval *v)
{
	enum eval_begin begin = EVAL_ALONE;

	if (v->command.ranks->index)
		return -1;
	if (v->command.ranks->are_shared || v->resumes) {
		if (eval_resume_open(&v->resume, &v->arrays, &v->error))
			return tell(v);
		v->goes_on = v->resumes && eval_resume_is_there(&v->resume, &v->arrays);
		if (!v->goes_on && eval_resume_clear(&v->resume, &v->error))
			return tell(v);
		begin = v->goes_on ? EVAL_GO_ON : EVAL_PART;
	}
	eval_open_outputs(&v->arrays, begin, &v->error);
	return tell(v);
}

static int open_robot(struct eval *v)
{
	int status = command_generate(&v->command, &v->urdf, &v->text);

	v->command.open.device = v->devices.list[0];
	return status ? status : command_open(&v->command, v->text.source, &v->robot);
}

/* A GPU that is named must be there. */
static void check_devices(struct eval *v)
{
	const struct eval_devices *d = &v->devices;

	if (rnea_build(v->robot)->backend != RNEA_BACKEND_HOST || !d->is_named || v->command.open.backend == RNEA_BACKEND_HOST)
		return;
	if (!d->are_all)
		error_set(&v->error, RNEAGEN_UNSUPPORTED, "--device %d: there is no GPU here that it could be; without --device the "
			"processor computes", d->list[0]);
	else if (!v->command.quiet)
		fprintf(stderr, "%s: --device all: there is no GPU here: the processor computes\n", v->command.name);
}

/* What one rank of a machine has compiled the others find in the cache. */
static int load(struct eval *v)
{
	struct ranks *r = v->command.ranks;
	const struct rnea_info *info;
	int status;

	command_share(&v->command);
	eval_devices_choose(&v->devices, v->command.open.backend, r);
	if (r->local)
		ranks_meet(r);
	status = open_robot(v);
	if (!r->local)
		ranks_meet(r);
	if (status)
		return status;
	info = rnea_info(v->robot);
	v->arrays.scalar = info->precision;
	if (!signature_fits(&v->analysis.dag, info))
		error_set(&v->error, RNEAGEN_UNSUPPORTED, "%s: takes other arrays than its analysis", info->name);
	else
		eval_check_shapes(&v->arrays, info->name, &v->error);
	if (!v->error.code)
		check_devices(v);
	if (rnea_build(v->robot)->backend == RNEA_BACKEND_HOST)
		v->devices.count = 1;
	if (!v->error.code && v->devices.count > 1)
		eval_check_places(&v->arrays, &v->error);
	return tell(v);
}

/* The side file says what is complete already; or there is one from now on. */
static enum rneagen_code resume(struct eval *v)
{
	struct eval_resume *r = &v->resume;
	struct rneagen_error *e = &v->error;

	if (!v->resumes || v->command.ranks->index)
		return RNEAGEN_OK;
	if (eval_resume_describe(r, &v->arrays, v->urdf.bytes, v->urdf.length, v->text.source, e) ||
		(v->goes_on && eval_resume_read(r, &v->arrays, e)))
		return e->code;
	if (v->goes_on && !v->command.quiet)
		fprintf(stderr, "%s: goes on after %" PRIu64 " of %" PRIu64 " samples\n", v->command.name, r->done,
			eval_samples(&v->arrays));
	return RNEAGEN_OK;
}

static int put_headers(struct eval *v)
{
	if (resume(v) || eval_put_headers(&v->arrays, &v->error))
		return tell(v);
	if (v->resumes && !v->goes_on && !v->command.ranks->index && eval_resume_begin(&v->resume, &v->error))
		return tell(v);
	if (v->resumes)
		eval_keep(&v->arrays);
	return -1;
}

static int join_outputs(struct eval *v)
{
	eval_join_outputs(&v->arrays, v->command.ranks, v->resumes, &v->error);
	return tell(v);
}

static void show(void *own, uint64_t done)
{
	struct eval *v = own;

	progress_show(&v->progress, done, "");
}

static void record(void *own, uint64_t whole)
{
	struct eval *v = own;

	eval_resume_record(&v->resume, whole, &v->error);
}

static int compute(struct eval *v)
{
	struct ranks *r = v->command.ranks;
	uint64_t samples = eval_samples(&v->arrays), first = ranks_tell(r, v->resume.done);
	struct eval_crew crew = {.arrays = &v->arrays, .ranks = r, .robot = v->robot, .text = v->text.source,
		.open = v->command.open, .devices = v->devices.list, .count = v->devices.count, .first = first,
		.samples = samples, .slice = v->slice, .show = show, .record = v->resumes ? record : NULL, .own = v};

	progress_start(&v->progress, v->command.name, "samples", samples - first, v->command.quiet || r->index);
	eval_crew_run(&crew, &v->error);
	progress_end(&v->progress);
	return tell(v);
}

static int leave(struct eval *v)
{
	eval_leave(&v->arrays, &v->error);
	return tell(v);
}

static int finish(struct eval *v)
{
	if (v->command.ranks->index)
		return -1;
	if (!eval_finish(&v->arrays, &v->error) && v->resumes)
		eval_resume_remove(&v->resume);
	return tell(v);
}

/* ---- the run ---- */

/* All ranks go from step to step together, so that one which fails ends all. */
static int evaluate(struct eval *v)
{
	static int (*const steps[])(struct eval *) = {
		analyse, open_inputs, open_outputs, load, put_headers, join_outputs, compute, leave, finish};
	int status = -1;

	for (size_t i = 0; i < sizeof steps / sizeof *steps && status < 0; i++)
		status = ranks_agree(v->command.ranks, steps[i](v));
	return status < 0 ? 0 : status;
}

static void release(struct eval *v)
{
	eval_close(&v->arrays);
	if (v->resume.path)
		eval_resume_close(&v->resume);
	rnea_close(v->robot);
	rneagen_result_free(&v->text);
	analysis_free(&v->analysis);
	free(v->urdf.bytes);
}

int run_eval(struct ranks *ranks, int argc, char **argv)
{
	static const struct command_kind kind = {"rnearun eval", HELP, OPTIONS, ":o:", take};
	struct eval v = {0};
	int status = command_parse(&v.command, &kind, &v, ranks, argc, argv);

	if (status < 0)
		status = check_words(&v);
	status = ranks_agree(ranks, status);
	if (status < 0) {
		status = evaluate(&v);
		release(&v);
	}
	command_free(&v.command);
	return status;
}
