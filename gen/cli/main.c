/* The command `rneagen`: options in, files out. */
#define _POSIX_C_SOURCE 200809L
#include "cli/files.h"
#include "cli/options.h"
#include "cli/pending.h"
#include "cli/waiting.h"
#include "emit/target_type.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char COMMAND[] = "rneagen";

static const char HELP[] =
	"usage: rneagen ROBOT.urdf [-o FILE] [options]\n"
	"\n"
	"Write straight-line CUDA C or C for the inverse dynamics tau = ID(q, qd, qdd) of one robot.\n"
	"ROBOT.urdf may be - for standard input; without -o the text goes to standard output.\n"
	"\n"
	"  -o, --output FILE          .cu, .c (with the .h that declares it beside it), .h, .hh, .hpp, .hxx or .cuh;\n"
	"                             others need --target\n"
	"  --target cuda|c|header     kernels, C functions, or inline functions to embed (default: by FILE's suffix; cuda for\n"
	"                             standard output, devices and pipes)\n"
	"  --precision f32|f64|mixed|f32x2\n"
	"                             default f32 for cuda and header, f64 for c; mixed: f32 in memory, f64 in arithmetic;\n"
	"                             f32x2: f64 in memory, pairs of floats in arithmetic, for GPUs whose f64 is slow\n"
	"  --layout soa|aos           batches as [row][sample] (default) or [sample][row]\n"
	"  --trig accurate|bounded|fast\n"
	"                             sine and cosine for any finite argument (default), for a stated domain (default where\n"
	"                             --range states one for every angle), or in hardware\n"
	"  --parts N|auto             target cuda: matrices of --want in N parts of the grid; auto, the default: as few as the\n"
	"                             registers and the instruction cache have room for\n"
	"  --segments N|auto|whole    functions of batches and kernels in stretches of at most N operations, each for several samples\n"
	"                             before the next; auto, the default: where that is faster or compiles faster\n"
	"  --limbs N|auto|none        target cuda: also a kernel for small batches, in which N warps, 2 to 16, share out each sample;\n"
	"                             auto, the default: where that is faster\n"
	"  --base fixed|floating      floating: q starts with x y z qx qy qz qw, qd and tau with six rows\n"
	"  --gravity X,Y,Z            m/s^2 in the world (default 0,0,-9.81)\n"
	"  --mimic honour|independent followers have no entry in q (default), or are joints of their own\n"
	"  --strict                   the same bits from every compiler, CPU and GPU\n"
	"  --bounded, --bounded=running\n"
	"                             target c: also a function that bounds how far each output is from what the URDF's decimals\n"
	"                             give in exact arithmetic, where angles within 5e-15 rad of a right one are right, and\n"
	"                             constants that are zero, or equal, but for the rounding of the file's numbers, or of\n"
	"                             extended precision (1e-19 of their terms), are so;\n"
	"                             running: bounds that are less close, in a fifteenth of the time\n"
	"  --only rnea|fd|kin         the main function alone: without its halves fpass and bpass and, for target c, without the\n"
	"                             functions that take batches\n"
	"  --order J1,J2,...          rows of q by joint name (default: depth-first, children by name)\n"
	OPTIONS_SCENE_HELP
	"  --name NAME                prefix of every function (default: the robot's name)\n"
	"  --info, --info=json        tell about the robot instead of writing the text (with -o: besides)\n"
	"  --dot                      print the tree as a graph for Graphviz, with masses and rows in q (with -o: besides)\n"
	"  --dump robot|scene|tree|params|request|dag|plan|parts|segments|limbs|kernels|passes\n"
	"                             print what a pass of the pipeline has made instead; passes: their list\n"
	"  --quiet                    neither progress nor warnings\n"
	"  --help, --version\n"
	"\n"
	"exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is\n";

enum info_mode { INFO_NONE, INFO_TABLE, INFO_JSON, INFO_DOT };

struct command {
	struct rneagen_options options;
	const char *input, *output;
	int has_target, is_text_printed, quiet; /* is_text_printed: -o - */
	enum info_mode info;
	struct file_names read;
};

enum { KEY_NAME = OPTION_OWN, KEY_INFO, KEY_DOT, KEY_BOUNDED, KEY_ONLY, KEY_QUIET };

static const struct option OPTIONS[] = {
	OPTIONS_TEXT, OPTIONS_MODEL, {"output", required_argument, NULL, 'o'},
	{"name", required_argument, NULL, KEY_NAME}, {"info", optional_argument, NULL, KEY_INFO},
	{"dot", no_argument, NULL, KEY_DOT}, {"bounded", optional_argument, NULL, KEY_BOUNDED},
	{"only", required_argument, NULL, KEY_ONLY}, {"quiet", no_argument, NULL, KEY_QUIET},
	{"help", no_argument, NULL, OPTION_HELP}, {"version", no_argument, NULL, OPTION_VERSION}, {NULL, 0, NULL, 0}};

#define ONLY_CHOICE(upper, word) {word, RNEAGEN_ONLY_##upper},
static const struct option_choice ONLY[] = {RNEAGEN_ONLY_WORDS(ONLY_CHOICE) {NULL, 0}};
#undef ONLY_CHOICE

/* --info, in either form, and --dot share standard output. */
static int set_info(struct command *c, enum info_mode info)
{
	if (c->info != INFO_NONE && c->info != info)
		return option_refuse(COMMAND, "%s both print to standard output; take one",
			c->info == INFO_DOT || info == INFO_DOT ? "--info and --dot" : "--info and --info=json");
	c->info = info;
	return 0;
}

/* Of two outputs one would be lost. */
static int set_output(struct command *c, const char *word)
{
	const char *before = c->is_text_printed ? "-" : c->output;

	if (!*word)
		return option_refuse(COMMAND, "-o takes the name of a file, not an empty word");
	if (before && strcmp(before, word))
		return option_refuse(COMMAND, "-o %s and -o %s: a run writes one text; take one", before, word);
	c->output = strcmp(word, "-") ? word : NULL;
	c->is_text_printed = !c->output;
	return 0;
}

static int set_dump(struct command *c, const char *word)
{
	enum rneagen_dump before = c->options.dump;
	int bad = option_generate(COMMAND, &c->options, OPTION_DUMP, word);

	if (!bad && before != RNEAGEN_DUMP_NONE && before != c->options.dump)
		return option_refuse(COMMAND, "--dump prints what one pass has made; take one");
	return bad;
}

static int fail(const struct rneagen_error *e)
{
	fprintf(stderr, "%s: %s\n", COMMAND, e->message);
	return 1 + option_at_fault(e->code);
}

static int parse_option(struct command *c, int key, const char *word)
{
	const char *file = option_file(key, word);
	struct rneagen_error e = {0};

	if (file && file_note(&c->read, "", file, &e))
		return fail(&e);
	switch (key) {
	case 'o':
		return set_output(c, word);
	case OPTION_DUMP:
		return set_dump(c, word);
	case KEY_NAME:
		c->options.name = word;
		return 0;
	case KEY_INFO:
		if (word && strcmp(word, "json"))
			return option_refuse(COMMAND, "--info takes nothing, or =json, not '%s'", word);
		return set_info(c, word ? INFO_JSON : INFO_TABLE);
	case KEY_BOUNDED:
		if (word && strcmp(word, "running"))
			return option_refuse(COMMAND, "--bounded takes nothing, or =running, not '%s'", word);
		c->options.bounded = word ? RNEAGEN_BOUNDS_RUNNING : RNEAGEN_BOUNDS_CLOSE;
		return 0;
	case KEY_ONLY:
		return option_choose(COMMAND, "only", word, ONLY, &c->options.only);
	case KEY_DOT:
		return set_info(c, INFO_DOT);
	case KEY_QUIET:
		c->quiet = 1;
		return 0;
	default:
		c->has_target |= key == OPTION_TARGET;
		return option_generate(COMMAND, &c->options, key, word);
	}
}

/* What a text is for shows in its name, unless --target says it. */
static int target_from_suffix(struct command *c)
{
	if (c->has_target || !c->output || pending_is_in_place(c->output))
		return -1;
	for (int i = 0; i < RNEAGEN_TARGET_COUNT; i++)
		if (file_has_suffix(c->output, target_type_of((enum rneagen_target)i)->suffixes)) {
			c->options.target = (enum rneagen_target)i;
			return -1;
		}
	return option_refuse(COMMAND,
		"-o %s: no text has this suffix: take .cu for CUDA kernels, .c for C functions, .h, .hh, .hpp, .hxx or .cuh "
		"for inline functions, or say --target cuda, c or header", c->output);
}

/* What goes to standard output goes there alone. Returns -1 to go on, or the exit status. */
static int check_printed(const struct command *c)
{
	int is_dumped = c->options.dump != RNEAGEN_DUMP_NONE;

	if (c->output && is_dumped)
		return option_refuse(COMMAND, "--dump prints to standard output and goes without -o");
	if (c->info != INFO_NONE && (c->is_text_printed || is_dumped))
		return option_refuse(COMMAND, "%s and %s both print to standard output; take one", c->is_text_printed ? "-o -" : "--dump",
			c->info == INFO_DOT ? "--dot" : "--info");
	return -1;
}

/* Returns -1 to go on, or the exit status. */
static int parse_command(struct command *c, int argc, char **argv)
{
	int key;

	while ((key = getopt_long(argc, argv, ":o:h", OPTIONS, NULL)) != -1) {
		int bad;

		if (key == OPTION_HELP || key == 'h' || key == OPTION_VERSION)
			return file_put_stdout(key != OPTION_VERSION ? HELP : "rneagen " RNEAGEN_VERSION "\n") ? 1 : 0;
		if (key == ':' || key == '?')
			return option_refuse_key(COMMAND, key, argv[optind - 1], OPTIONS);
		bad = parse_option(c, key, optarg);
		if (bad)
			return bad;
	}
	if (optind == argc)
		return option_refuse(COMMAND, "no URDF named");
	if (optind + 1 < argc)
		return option_refuse(COMMAND, "one URDF at a time: '%s', '%s'", argv[optind], argv[optind + 1]);
	c->input = argv[optind];
	if (!*c->input)
		return option_refuse(COMMAND, "the name of the URDF is empty");
	c->options.file = strcmp(c->input, "-") ? c->input : "<stdin>";
	return check_printed(c);
}

/* Nothing that is written takes the place of what is read, nor of something else that is written. Returns -1 to go on, or
   the exit status. */
static int check_files(struct command *c)
{
	struct file_names written = {0};
	struct rneagen_error e = {0};
	int status = -1;

	file_note(&c->read, "", c->input, &e);
	if (c->output)
		file_note(&written, "-o", c->output, &e);
	if (!c->output || c->info != INFO_NONE)
		file_note(&written, "", "-", &e);
	if (!e.code && !file_check(&c->read, &written, &e))
		status = target_from_suffix(c);
	if (!e.code && status < 0 && c->output && target_type_of(c->options.target)->declarations &&
		!file_note_header(&written, c->output, &e))
		file_check(&c->read, &written, &e);
	file_forget(&written);
	return e.code ? fail(&e) : status;
}

/* What goes to files, and to standard output, where nothing is told meanwhile: it may be the same terminal. */
static int write_results(const struct command *c, const struct rneagen_result *r, struct waiting *w, struct rneagen_error *e)
{
	int bad;

	if (c->output && !pending_is_in_place(c->output)) /* who pages through a pipe is not disturbed */
		waiting_for(w, "writing");
	bad = c->output && file_write_pair(c->output, r->source, r->header, e);
	waiting_for(w, NULL);
	if (bad)
		return 1;
	if (r->dump)
		return file_put_stdout_error(r->dump, e) != RNEAGEN_OK;
	if (c->info == INFO_NONE)
		return !c->output && file_put_stdout_error(r->source, e);
	if (c->info == INFO_DOT)
		return file_put_stdout_error(r->dot, e) != RNEAGEN_OK;
	return file_put_stdout_error(c->info == INFO_JSON ? r->info_json : r->info, e) != RNEAGEN_OK;
}

static int run(const struct command *c)
{
	static const unsigned told[] = {[INFO_NONE] = 0, [INFO_TABLE] = RNEAGEN_TELL_INFO, [INFO_JSON] = RNEAGEN_TELL_JSON,
		[INFO_DOT] = RNEAGEN_TELL_DOT};
	struct rneagen_options o = c->options;
	struct rneagen_error e = {0};
	struct rneagen_result r;
	struct file_content urdf = {0};
	struct waiting waiting;
	int bad;

	o.tell = told[c->info];
	o.progress = waiting_for;
	o.progress_context = &waiting;
	if (file_read(c->input, &urdf, &e))
		return fail(&e);
	waiting_begin(&waiting, COMMAND, c->quiet);
	bad = rneagen_generate(urdf.bytes, urdf.length, &o, &r, &e);
	waiting_for(&waiting, NULL);
	if (!bad) {
		for (size_t i = 0; i < r.warning_count && !c->quiet && (c->info == INFO_NONE || c->info == INFO_DOT); i++)
			fprintf(stderr, "rneagen: warning: %s\n", r.warnings[i]);
		bad = write_results(c, &r, &waiting, &e);
		rneagen_result_free(&r);
	}
	waiting_end(&waiting);
	free(urdf.bytes);
	return bad ? fail(&e) : 0;
}

int main(int argc, char **argv)
{
	struct command c = {.options = rneagen_options_default()};
	int status;

	/* a file that grows too large is an error like any other */
	signal(SIGXFSZ, SIG_IGN);
	status = parse_command(&c, argc, argv);
	if (status < 0)
		status = check_files(&c);
	if (status < 0)
		status = run(&c);
	option_free(&c.options);
	file_forget(&c.read);
	return status;
}
