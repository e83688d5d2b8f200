/* rnearun eval: which array is which file, by the words of the command line. */
#include "eval/eval.h"
#include "base/number.h"
#include <stdio.h>
#include <string.h>

const char *const EVAL_PART_NAMES[EVAL_PARTS] = {"q", "qd", "qdd"};

/* ---- words ---- */

int eval_take_pair(struct eval_words *w, const char *name, const char *option, const char *word)
{
	const char *at = strchr(word, '=');

	if (!at || at == word || !at[1])
		return option_refuse(name, "--%s takes NAME=FILE, not '%s'", option, word);
	if (w->count == DAG_ARGUMENTS)
		return option_refuse(name, "--%s: more than %d arrays", option, DAG_ARGUMENTS);
	w->list[w->count++] = word;
	return 0;
}

/* A file that is read; NULL is none. */
int eval_note_input(struct eval *v, const char *what, const char *path)
{
	if (path && v->resumes && !strcmp(path, "-"))
		return option_refuse(v->command.name, "%s -: --resume needs inputs that can be read again; name a file", what);
	return path ? command_note(&v->command, &v->command.read, what, path) : -1;
}

/* One that is written: its name does not promise what is not in it. */
int eval_note_output(struct eval *v, const char *what, const char *path)
{
	static const char *const others[] = {".npz", ".csv", ".tsv", ".txt", ".json", ".mat", ".h5", ".hdf5", NULL};

	if (path && v->command.ranks->are_shared && !strcmp(path, "-"))
		return option_refuse(v->command.name, "%s -: ranks write at their places in a file; name one", what);
	if (path && file_has_suffix(path, others))
		return option_refuse(v->command.name, "%s %s: arrays are written as .npy; name a file that ends so", what, path);
	return path ? command_note(&v->command, &v->command.written, what, path) : -1;
}

/* What stands beside outputs until they are complete is written too: it is no input, and no other output. */
static int note_beside(struct eval *v, const char *path, const char *suffix)
{
	struct text name;
	struct arena a;
	int status;

	arena_init(&a, NULL);
	text_init(&name, &a);
	text_printf(&name, "%s%s", path, suffix);
	status = name.failed ? command_fail(&v->command, "out of memory")
			     : command_note(&v->command, &v->command.written, v->resumes ? "--resume's" : "the ranks'", text_string(&name));
	arena_free(&a);
	return status;
}

int eval_note_parts(struct eval *v)
{
	struct eval_sink *sinks[DAG_ARGUMENTS + 1];
	size_t count = eval_sinks(&v->arrays, sinks);
	int status = -1;

	if (!v->command.ranks->are_shared && !v->resumes)
		return -1;
	for (size_t i = 0; i < count && status < 0; i++)
		status = note_beside(v, sinks[i]->path, ".part");
	return status < 0 && count ? note_beside(v, sinks[0]->path, ".resume") : status;
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
		return is_output ? eval_note_output(v, "--output", v->arrays.paths[i])
			: eval_note_input(v, "--input", v->arrays.paths[i]);
	stem = arena_string(v->analysis.arena, word, strcspn(word, "="));
	meant = stem ? signature_nearest(&v->signature, stem, is_output) : NULL;
	return option_refuse(v->command.name, "--%s %s: '%s' is no %s of this scene%s%s%s", option, word,
		stem ? stem : "", option, meant ? "; did you mean '" : "", meant ? meant : "", meant ? "'?" : "");
}

/* Paths for arrays, or the exit status and a message. */
int eval_name_files(struct eval *v)
{
	int status = -1;

	for (size_t i = 0; i < EVAL_PARTS; i++) {
		int at = signature_find(&v->signature, EVAL_PART_NAMES[i], strlen(EVAL_PART_NAMES[i]), 0);

		if (v->parts[i] && at < 0)
			return option_refuse(v->command.name, "--%s: the scene has no input %s; leave it out", EVAL_PART_NAMES[i],
				EVAL_PART_NAMES[i]);
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
int eval_check_inputs(const struct eval *v)
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
		return option_refuse(v->command.name,
			"--in %s: no input of samples is left for it: each has a file of its own, or the scene has none; leave out --in",
			a->in);
	return -1;
}
