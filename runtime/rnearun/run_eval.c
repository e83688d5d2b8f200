/* rnearun eval: torques, or what else a scene asks for, for arrays on disk, a slice of the batch at a time. */
#define _POSIX_C_SOURCE 200809L
#include "rnearun/run_eval.h"
#include "rnearun/command.h"
#include "rnearun/eval_arrays.h"
#include "base/number.h"
#include "rnearun/progress.h"
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
	COMMAND_HELP
	"\n"
	"exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is\n";

enum { KEY_IN = COMMAND_OWN, KEY_Q, KEY_QD, KEY_QDD, KEY_INPUT, KEY_OUTPUT, KEY_SLICE };

static const struct option OPTIONS[] = {
	{"in", required_argument, NULL, KEY_IN}, {"q", required_argument, NULL, KEY_Q},
	{"qd", required_argument, NULL, KEY_QD}, {"qdd", required_argument, NULL, KEY_QDD},
	{"input", required_argument, NULL, KEY_INPUT}, {"output", required_argument, NULL, KEY_OUTPUT},
	{"out", required_argument, NULL, 'o'}, {"slice", required_argument, NULL, KEY_SLICE}, COMMAND_OPTIONS,
	{NULL, 0, NULL, 0}};

enum { Q, QD, QDD, PARTS };
enum { SLICE_LIMIT = 1 << 30 };

static const char *const PART_NAMES[PARTS] = {"q", "qd", "qdd"};

/* NAME=FILE, as the command line has them. */
struct words {
	const char *list[DAG_ARGUMENTS];
	size_t count;
};

struct eval {
	struct command command;
	const char *parts[PARTS]; /* names of files */
	struct words inputs, outputs;
	struct file_content urdf;
	struct analysis analysis;
	struct signature signature;
	struct eval_arrays arrays;
	struct rnea_robot *robot;
	struct rneagen_error error;
};

/* ---- the command line ---- */

static int take_pair(struct words *w, const char *name, const char *option, const char *word)
{
	const char *at = strchr(word, '=');

	if (!at || at == word || !at[1])
		return option_refuse(name, "--%s takes NAME=FILE, not '%s'", option, word);
	if (w->count == DAG_ARGUMENTS)
		return option_refuse(name, "--%s: more than %d arrays", option, DAG_ARGUMENTS);
	w->list[w->count++] = word;
	return 0;
}

static int take(void *own, const char *name, int key, const char *word)
{
	struct eval *v = own;
	unsigned long long n = 0;
	int bad;

	if (key == KEY_SLICE) {
		bad = command_number(name, "slice", word, 1, SLICE_LIMIT, &n);
		v->arrays.slice = (size_t)n;
		return bad;
	}
	if (key == KEY_INPUT || key == KEY_OUTPUT)
		return take_pair(key == KEY_INPUT ? &v->inputs : &v->outputs, name, key == KEY_INPUT ? "input" : "output", word);
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

/* A file that is read; NULL is none. */
static int note_input(struct eval *v, const char *what, const char *path)
{
	return path ? command_note(&v->command, &v->command.read, what, path) : -1;
}

/* One that is written: its name does not promise what is not in it. */
static int note_output(struct eval *v, const char *what, const char *path)
{
	static const char *const others[] = {".npz", ".csv", ".tsv", ".txt", ".json", ".mat", ".h5", ".hdf5", NULL};

	if (path && file_has_suffix(path, others))
		return option_refuse(v->command.name, "%s %s: arrays are written as .npy; name a file that ends so", what, path);
	return path ? command_note(&v->command, &v->command.written, what, path) : -1;
}

/* What can be said before the robot is known. */
static int check_words(struct eval *v)
{
	const char *name = v->command.name;
	int given = 0, status;

	for (int i = 0; i < PARTS; i++)
		given += v->parts[i] != NULL;
	if (v->arrays.in && given)
		return option_refuse(name, "--in takes all of q, qd and qdd from one file; leave out --q, --qd and --qdd");
	if (!v->arrays.in && !given && !v->inputs.count && !v->command.generate.scene)
		return option_refuse(name, "no input named: --in FILE, or --q, --qd and --qdd");
	for (int i = 0; i < PARTS; i++)
		if (given && !v->parts[i] && !v->inputs.count && !v->command.generate.scene)
			return option_refuse(name, "--%s is missing", PART_NAMES[i]);
	if (!v->arrays.out && !v->outputs.count)
		return option_refuse(name, "no output named: --out FILE");
	status = note_output(v, "--out", v->arrays.out);
	if (status < 0)
		status = note_input(v, "--in", v->arrays.in);
	for (int i = 0; i < PARTS && status < 0; i++)
		status = note_input(v, PART_NAMES[i], v->parts[i]);
	return status < 0 ? command_check_files(&v->command) : status;
}

/* ---- which array is which file ---- */

/* A name may have a = in it, as may a file's: the first that leaves the name of an array. */
static int name_pair(struct eval *v, const char *word, int is_output)
{
	const char *option = is_output ? "output" : "input", *meant;
	int i = -1;
	char *stem;

	for (const char *at = word; i < 0 && (at = strchr(at, '=')) != NULL; at++)
		if ((i = signature_find(&v->signature, word, (size_t)(at - word), is_output)) >= 0) {
			if (v->arrays.paths[i])
				return option_refuse(v->command.name, "--%s %s: '%s' has a file already", option, word,
					v->signature.arrays[i].word);
			v->arrays.paths[i] = at + 1;
		}
	if (i >= 0 && !*v->arrays.paths[i])
		return option_refuse(v->command.name, "the name of a file is empty");
	if (i >= 0)
		return is_output ? note_output(v, "--output", v->arrays.paths[i]) : note_input(v, "--input", v->arrays.paths[i]);
	stem = arena_string(v->analysis.arena, word, strcspn(word, "="));
	meant = stem ? signature_nearest(&v->signature, stem, is_output) : NULL;
	return option_refuse(v->command.name, "--%s %s: '%s' is no %s of this scene%s%s%s", option, word, stem ? stem : "", option,
		meant ? "; did you mean '" : "", meant ? meant : "", meant ? "'?" : "");
}

/* Paths for arrays, or the exit status and a message. */
static int name_files(struct eval *v)
{
	int status = -1;

	for (size_t i = 0; i < PARTS; i++) {
		int at = signature_find(&v->signature, PART_NAMES[i], strlen(PART_NAMES[i]), 0);

		if (v->parts[i] && at < 0)
			return option_refuse(v->command.name, "--%s: the scene has no input %s; leave it out", PART_NAMES[i], PART_NAMES[i]);
		if (v->parts[i])
			v->arrays.paths[at] = v->parts[i];
	}
	for (size_t i = 0; i < v->inputs.count && status < 0; i++)
		status = name_pair(v, v->inputs.list[i], 0);
	for (size_t i = 0; i < v->outputs.count && status < 0; i++)
		status = name_pair(v, v->outputs.list[i], 1);
	return status;
}

/* Does it have an option of its own? */
static int is_state(enum role role)
{
	return role == ROLE_JOINT_POSITION || role == ROLE_JOINT_VELOCITY || role == ROLE_JOINT_ACCELERATION;
}

/* What must have a file has one; what has none, and need not, is told. */
static int check_inputs(const struct eval *v)
{
	const struct eval_arrays *a = &v->arrays;
	int joined = 0;

	for (size_t i = 0; i < v->signature.count; i++) {
		const struct signature_array *s = &v->signature.arrays[i];

		joined += eval_is_joined(a, i);
		if (s->is_output || a->paths[i] || eval_is_joined(a, i))
			continue;
		if (!s->has_default)
			return option_refuse(
				v->command.name, is_state(s->role) ? "--%s is missing" : "--input %s=FILE is missing", s->word);
		if (v->command.quiet)
			continue;
		fprintf(stderr, "%s: %s: no file named:", v->command.name, s->word);
		for (size_t r = 0; r < (s->nominal ? s->rows : 1); r++)
			fprintf(stderr, " %s", number_plain(s->nominal ? (double)s->nominal[r] : 0).s);
		fputs(s->nominal ? ", as the URDF has it\n" : "\n", stderr);
	}
	if (a->in && !joined)
		return option_refuse(v->command.name, "--in %s: every input of samples has a file of its own, or there is none", a->in);
	return -1;
}

/* ---- the run ---- */

static int analyse(struct eval *v)
{
	int status = command_analyse(&v->command, &v->urdf, &v->analysis);

	if (status)
		return status;
	if (!signature_of(&v->signature, &v->analysis))
		return command_fail(&v->command, "out of memory");
	v->arrays.s = &v->signature;
	status = name_files(v);
	if (status < 0)
		status = check_inputs(v);
	return status < 0 ? command_check_files(&v->command) : status;
}

static enum rneagen_code do_slice(struct eval *v, size_t count)
{
	struct rnea_error error;

	if (eval_read(&v->arrays, count, &v->error))
		return v->error.code;
	if (rnea_run(v->robot, v->arrays.data, count, &error))
		return error_set(&v->error, RNEAGEN_UNSUPPORTED, "%s", error.message);
	return eval_write(&v->arrays, count, &v->error);
}

static enum rneagen_code do_all(struct eval *v)
{
	uint64_t samples = eval_samples(&v->arrays);
	struct progress progress;

	eval_put_headers(&v->arrays);
	progress_start(&progress, v->command.name, "samples", samples, v->command.quiet);
	for (uint64_t done = 0; done < samples;) {
		size_t count = samples - done < v->arrays.slice ? (size_t)(samples - done) : v->arrays.slice;

		if (do_slice(v, count))
			break;
		done += count;
		progress_show(&progress, done, "");
	}
	progress_end(&progress);
	return v->error.code;
}

/* Computed is in double precision if one of the arrays is. */
static enum rneagen_code open_files(struct eval *v)
{
	int is_wide;

	if (eval_open_inputs(&v->arrays, &is_wide, &v->error))
		return v->error.code;
	if (v->command.generate.precision == RNEAGEN_PRECISION_DEFAULT)
		v->command.generate.precision = is_wide ? RNEAGEN_F64 : RNEAGEN_F32;
	return eval_open_outputs(&v->arrays, &v->error);
}

static int evaluate(struct eval *v)
{
	struct eval_arrays *a = &v->arrays;
	struct rneagen_error *e = &v->error;
	const struct rnea_info *info;
	int status = analyse(v);

	if (status >= 0)
		return status;
	if (open_files(v))
		return command_fail(&v->command, e->message);
	status = command_open(&v->command, &v->urdf, &v->robot);
	if (status)
		return status;
	info = rnea_info(v->robot);
	a->scalar = info->precision;
	if (!signature_fits(&v->analysis.dag, info))
		error_set(e, RNEAGEN_UNSUPPORTED, "%s: takes other arrays than its analysis", info->name);
	if (e->code || eval_check_shapes(a, info->name, e) || eval_make(a, e) || do_all(v) || eval_finish(a, e))
		return command_fail(&v->command, e->message);
	return 0;
}

static void release(struct eval *v)
{
	eval_close(&v->arrays);
	rnea_close(v->robot);
	analysis_free(&v->analysis);
	free(v->urdf.bytes);
}

int run_eval(int argc, char **argv)
{
	static const struct command_kind kind = {"rnearun eval", HELP, OPTIONS, ":o:", take};
	struct eval v = {0};
	int status = command_parse(&v.command, &kind, &v, argc, argv);

	if (status < 0)
		status = check_words(&v);
	if (status < 0) {
		status = evaluate(&v);
		release(&v);
	}
	command_free(&v.command);
	return status;
}
