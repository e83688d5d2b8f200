/* rnearun eval: torques for arrays on disk, a slice of the batch at a time. */
#define _POSIX_C_SOURCE 200809L
#include "run_eval.h"
#include "command.h"
#include "npy.h"
#include "pending.h"
#include "progress.h"
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const char HELP[] =
	"usage: rnearun eval ROBOT.urdf --in STATES.npy --out TAU.npy [options]\n"
	"       rnearun eval ROBOT.urdf --q Q.npy --qd QD.npy --qdd QDD.npy --out TAU.npy [options]\n"
	"\n"
	"Torques tau = ID(q, qd, qdd) for arrays on disk, as numpy.save writes them: float32 or float64, samples along the\n"
	"first axis. Arrays are read in slices; memory does not grow with them. One input, and --out, may be - for standard\n"
	"input and output; else TAU.npy appears when it is complete.\n"
	"\n"
	"  --in FILE                  rows of q, qd, qdd after one another: nq + 2 nv columns\n"
	"  --q FILE --qd FILE --qdd FILE\n"
	"                             the same in three arrays, of nq, nv and nv columns\n"
	"  -o, --out FILE             the torques: nv columns\n"
	"  --precision f32|f64|mixed|f32x2\n"
	"                             of the computation and of FILE (default: f64 if an input is, else f32); mixed: FILE\n"
	"                             is f32, the arithmetic f64; f32x2: FILE is f64, the arithmetic pairs of f32\n"
	"  --slice N                  samples read, computed and written at a time (default: 64 MiB of them)\n"
	COMMAND_HELP
	"\n"
	"exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is\n";

enum { KEY_IN = COMMAND_OWN, KEY_Q, KEY_QD, KEY_QDD, KEY_SLICE };

static const struct option OPTIONS[] = {
	{"in", required_argument, NULL, KEY_IN}, {"q", required_argument, NULL, KEY_Q},
	{"qd", required_argument, NULL, KEY_QD}, {"qdd", required_argument, NULL, KEY_QDD},
	{"out", required_argument, NULL, 'o'}, {"slice", required_argument, NULL, KEY_SLICE}, COMMAND_OPTIONS,
	{NULL, 0, NULL, 0}};

enum { Q, QD, QDD, TAU, ARRAYS, INPUTS = TAU };
enum { SLICE_BYTES = 64 << 20, SLICE_LIMIT = 1 << 30 };

static const char *const ARRAY_NAMES[ARRAYS] = {"q", "qd", "qdd", "tau"};

struct eval {
	struct command command;
	const char *in, *parts[INPUTS], *out; /* names of files, as the command line has them */
	size_t slice;                         /* samples; 0 until it is known */
	struct npy files[INPUTS];             /* file_count of them: one, or one for each input */
	size_t file_count;
	struct rnea_robot *robot;
	enum rnea_scalar scalar;              /* of the arrays below, and of the output */
	size_t rows[ARRAYS];
	void *arrays[ARRAYS], *arguments[ARRAYS]; /* a slice each; the same in the order of rnea_info() */
	FILE *sink;
	struct pending pending;
	struct rneagen_error error;
};

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
	if (!*word)
		return option_refuse(name, "the name of a file is empty");
	if (key == 'o')
		v->out = word;
	else if (key == KEY_IN)
		v->in = word;
	else
		v->parts[key - KEY_Q] = word;
	return 0;
}

/* One array or three, and somewhere to write. */
static int check_words(const struct eval *v)
{
	const char *name = v->command.name;
	int given = 0, pipes = v->in && !strcmp(v->in, "-");

	for (int i = 0; i < INPUTS; i++) {
		given += v->parts[i] != NULL;
		pipes += v->parts[i] && !strcmp(v->parts[i], "-");
	}
	pipes += !strcmp(v->command.urdf, "-");
	if (v->in && given)
		return option_refuse(name, "--in takes all of q, qd and qdd from one file; leave out --q, --qd and --qdd");
	for (int i = 0; i < INPUTS; i++)
		if (!v->in && !v->parts[i])
			return option_refuse(name, given ? "--%s is missing" : "no input named: --in FILE, or --q, --qd and --qdd",
				ARRAY_NAMES[i]);
	if (!v->out)
		return option_refuse(name, "no output named: --out FILE");
	return pipes > 1 ? option_refuse(name, "standard input, -, can be read once") : -1;
}

/* The output takes the place of no input; NULL is none. */
static int check_same(const struct eval *v, const char *input)
{
	struct stat a, b;

	if (!input || stat(input, &a) || stat(v->out, &b) || !S_ISREG(a.st_mode) || a.st_dev != b.st_dev ||
		a.st_ino != b.st_ino)
		return -1;
	return option_refuse(v->command.name, "--out %s is the input %s; name another file", v->out, input);
}

static int check_output(const struct eval *v)
{
	const char *const inputs[] = {v->command.urdf, v->in, v->parts[Q], v->parts[QD], v->parts[QDD]};
	int status = -1;

	for (size_t i = 0; i < sizeof inputs / sizeof *inputs && status < 0; i++)
		status = check_same(v, inputs[i]);
	return status;
}

/* All of the shape but the columns. */
static int same_samples(const struct npy *a, const struct npy *b)
{
	return a->shape.dimensions == b->shape.dimensions &&
		!memcmp(a->shape.size, b->shape.size, (a->shape.dimensions - 1) * sizeof *a->shape.size);
}

/* Open what is to be read; computed is in double precision if one of the arrays is. */
static enum rneagen_code open_inputs(struct eval *v)
{
	struct rneagen_error *e = &v->error;
	int wide = 0;

	for (int i = 0; i < (v->in ? 1 : INPUTS); i++) {
		struct npy *n = &v->files[v->file_count];
		char text[64], first[64];

		if (npy_open(n, v->in ? v->in : v->parts[i], e))
			return e->code;
		v->file_count++;
		wide |= n->scalar == RNEA_F64;
		if (same_samples(n, v->files))
			continue;
		npy_shape_text(&n->shape, text, sizeof text);
		npy_shape_text(&v->files->shape, first, sizeof first);
		return error_set(e, RNEAGEN_READ, "%s: shape %s, other samples than %s, shape %s", n->path, text,
			v->files->path, first);
	}
	if (v->command.generate.precision == RNEAGEN_PRECISION_DEFAULT)
		v->command.generate.precision = wide ? RNEAGEN_F64 : RNEAGEN_F32;
	return RNEAGEN_OK;
}

/* What the robot takes, and where it comes in the order of its arguments. */
static enum rneagen_code bind_arrays(struct eval *v)
{
	const struct rnea_info *info = rnea_info(v->robot);

	for (int i = 0; i < ARRAYS; i++) {
		int at = rnea_bind(v->robot, ARRAY_NAMES[i]);

		if (at < 0 || at >= ARRAYS || info->input_count + info->output_count != ARRAYS)
			return error_set(&v->error, RNEAGEN_UNSUPPORTED, "%s: does not take q, qd, qdd and give tau", info->name);
		v->rows[i] = info->arguments[at].rows;
		v->scalar = info->arguments[at].scalar; /* the same for all */
	}
	return RNEAGEN_OK;
}

static enum rneagen_code check_columns(struct eval *v)
{
	const char *robot = rnea_info(v->robot)->name;
	size_t nq = v->rows[Q], nv = v->rows[QD];

	if (v->in && v->files->columns != nq + 2 * nv)
		return error_set(&v->error, RNEAGEN_READ, "%s: %zu columns, %s needs nq + 2 nv = %zu + %zu = %zu", v->files->path,
			v->files->columns, robot, nq, 2 * nv, nq + 2 * nv);
	for (size_t i = 0; i < v->file_count && !v->in; i++)
		if (v->files[i].columns != v->rows[i])
			return error_set(&v->error, RNEAGEN_READ, "%s: %zu columns, %s needs %s = %zu for %s", v->files[i].path,
				v->files[i].columns, robot, i == Q ? "nq" : "nv", v->rows[i], ARRAY_NAMES[i]);
	return RNEAGEN_OK;
}

/* Arrays for one slice. */
static enum rneagen_code make_arrays(struct eval *v)
{
	size_t size = v->scalar == RNEA_F32 ? sizeof(float) : sizeof(double), rows = 0;

	for (int i = 0; i < ARRAYS; i++)
		rows += v->rows[i];
	if (!v->slice)
		v->slice = SLICE_BYTES / (rows * size) ? SLICE_BYTES / (rows * size) : 1;
	if (v->slice > v->files->samples)
		v->slice = v->files->samples ? (size_t)v->files->samples : 1;
	for (int i = 0; i < ARRAYS; i++) {
		if (v->slice > SIZE_MAX / 2 / size / v->rows[i] || !(v->arrays[i] = malloc(v->slice * size * v->rows[i])))
			return error_set(&v->error, RNEAGEN_MEMORY, "no memory for slices of %zu samples; choose a smaller --slice",
				v->slice);
		v->arguments[rnea_bind(v->robot, ARRAY_NAMES[i])] = v->arrays[i];
	}
	return RNEAGEN_OK;
}

static enum rneagen_code open_output(struct eval *v)
{
	if (!strcmp(v->out, "-")) {
		v->sink = stdout;
		return RNEAGEN_OK;
	}
	pending_open(&v->pending, v->out, &v->error);
	v->sink = v->pending.f;
	return v->error.code;
}

static enum rneagen_code fail_output(struct eval *v)
{
	return pending_fail(v->sink == stdout ? "standard output" : v->out, &v->error);
}

static enum rneagen_code read_slice(struct eval *v, size_t count)
{
	size_t nq = v->rows[Q], nv = v->rows[QD];
	struct npy_part parts[INPUTS] = {{0, nq, v->arrays[Q]}, {nq, nv, v->arrays[QD]}, {nq + nv, nv, v->arrays[QDD]}};

	if (v->in)
		return npy_read(v->files, count, v->scalar, parts, INPUTS, &v->error);
	for (int i = 0; i < INPUTS; i++) {
		parts[i].first = 0;
		if (npy_read(&v->files[i], count, v->scalar, &parts[i], 1, &v->error))
			return v->error.code;
	}
	return RNEAGEN_OK;
}

static enum rneagen_code do_slice(struct eval *v, size_t count)
{
	size_t size = v->scalar == RNEA_F32 ? sizeof(float) : sizeof(double);
	struct rnea_error error;

	if (read_slice(v, count))
		return v->error.code;
	if (rnea_run(v->robot, v->arguments, count, &error))
		return error_set(&v->error, RNEAGEN_UNSUPPORTED, "%s", error.message);
	if (fwrite(v->arrays[TAU], size * v->rows[TAU], count, v->sink) != count)
		return fail_output(v);
	return RNEAGEN_OK;
}

static enum rneagen_code do_all(struct eval *v)
{
	struct npy_shape shape = v->files->shape;
	uint64_t samples = v->files->samples;
	struct progress progress;

	shape.size[shape.dimensions - 1] = v->rows[TAU];
	npy_put_header(v->sink, v->scalar, &shape);
	progress_start(&progress, v->command.name, "samples", samples, v->command.quiet);
	for (uint64_t done = 0; done < samples;) {
		size_t count = samples - done < v->slice ? (size_t)(samples - done) : v->slice;

		if (do_slice(v, count))
			break;
		done += count;
		progress_show(&progress, done);
	}
	progress_end(&progress);
	return v->error.code;
}

static enum rneagen_code finish_output(struct eval *v)
{
	if (v->sink == stdout)
		return fflush(stdout) || ferror(stdout) ? fail_output(v) : RNEAGEN_OK;
	if (!pending_close(&v->pending, &v->error))
		pending_publish(&v->pending, &v->error);
	return v->error.code;
}

static int evaluate(struct eval *v)
{
	int status;

	if (open_inputs(v) || open_output(v))
		return command_fail(&v->command, v->error.message);
	status = command_open(&v->command, &v->robot);
	if (status)
		return status;
	if (bind_arrays(v) || check_columns(v) || make_arrays(v) || do_all(v) || finish_output(v))
		return command_fail(&v->command, v->error.message);
	return 0;
}

static void release(struct eval *v)
{
	pending_drop(&v->pending);
	rnea_close(v->robot);
	for (size_t i = 0; i < v->file_count; i++)
		npy_close(&v->files[i]);
	for (int i = 0; i < ARRAYS; i++)
		free(v->arrays[i]);
}

int run_eval(int argc, char **argv)
{
	static const struct command_kind kind = {"rnearun eval", HELP, OPTIONS, ":o:", take};
	struct eval v = {0};
	int status = command_parse(&v.command, &kind, &v, argc, argv);

	if (status < 0)
		status = check_words(&v);
	if (status < 0)
		status = check_output(&v);
	if (status < 0) {
		status = evaluate(&v);
		release(&v);
	}
	option_free(&v.command.generate);
	return status;
}
