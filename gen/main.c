/* The command `rneagen`: options in, files out. */
#define _POSIX_C_SOURCE 200809L
#include "files.h"
#include "rneagen.h"
#include <getopt.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char HELP[] =
	"usage: rneagen ROBOT.urdf [-o FILE] [options]\n"
	"\n"
	"Write straight-line CUDA C or C for the inverse dynamics tau = ID(q, qd, qdd) of one robot.\n"
	"ROBOT.urdf may be - for standard input; without -o the text goes to standard output.\n"
	"\n"
	"  -o, --output FILE          .cu, .c (with the .h that declares it beside it), .h or .cuh\n"
	"  --target cuda|c|header     kernels, C functions, or inline functions to embed (default: by FILE's suffix, else cuda)\n"
	"  --precision f32|f64        default f32 for cuda and header, f64 for c\n"
	"  --layout soa|aos           batches as [row][sample] (default) or [sample][row]\n"
	"  --trig accurate|bounded|fast\n"
	"                             sine and cosine for any finite argument (default), for a stated domain, or in hardware\n"
	"  --base fixed|floating      floating: q starts with x y z qx qy qz qw, qd and tau with six rows\n"
	"  --gravity X,Y,Z            m/s^2 in the world (default 0,0,-9.81)\n"
	"  --mimic honour|independent followers have no entry in q (default), or are joints of their own\n"
	"  --order J1,J2,...          rows of q by joint name (default: depth-first, children by name)\n"
	"  --name NAME                prefix of every function (default: the robot's name)\n"
	"  --info, --info=json        tell about the robot instead of writing the text (with -o: besides)\n"
	"  --dot                      print the tree as a graph for Graphviz, with masses and rows in q (with -o: besides)\n"
	"  --dump robot|tree|dag|plan print a stage of the pipeline instead\n"
	"  --help, --version\n"
	"\n"
	"exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is\n";

enum info_mode { INFO_NONE, INFO_TABLE, INFO_JSON, INFO_DOT };

struct command {
	struct rneagen_options options;
	const char *input, *output;
	int has_target;
	enum info_mode info;
};

struct choice {
	const char *name;
	int value;
};

static int fail_usage(const char *fmt, const char *a, const char *b)
{
	fputs("rneagen: ", stderr);
	fprintf(stderr, fmt, a, b);
	fputs("; see rneagen --help\n", stderr);
	return 2;
}

/* The value that a word stands for; 2 and a message if it stands for none. */
static int choose(const char *option, const char *word, const struct choice *choices, int *value)
{
	char known[128] = "";

	for (const struct choice *c = choices; c->name; c++) {
		if (!strcmp(word, c->name)) {
			*value = c->value;
			return 0;
		}
		strncat(known, *known ? "|" : "", sizeof known - strlen(known) - 1);
		strncat(known, c->name, sizeof known - strlen(known) - 1);
	}
	fprintf(stderr, "rneagen: --%s takes %s, not '%s'; see rneagen --help\n", option, known, word);
	return 2;
}

static int parse_gravity(const char *word, double gravity[3])
{
	const char *s = word;

	for (int i = 0; i < 3; i++) {
		char *end;

		gravity[i] = strtod(s, &end);
		if (end == s || *end != (i < 2 ? ',' : '\0') || !(gravity[i] - gravity[i] == 0))
			return fail_usage("--gravity takes three finite numbers X,Y,Z, not '%s'%s", word, "");
		s = end + 1;
	}
	return 0;
}

enum option_key { KEY_TARGET = 256, KEY_PRECISION, KEY_LAYOUT, KEY_TRIG, KEY_BASE, KEY_MIMIC, KEY_DUMP, KEY_GRAVITY,
	KEY_ORDER, KEY_NAME, KEY_INFO, KEY_DOT, KEY_HELP, KEY_VERSION };

static const struct option OPTIONS[] = {
	{"output", required_argument, NULL, 'o'}, {"target", required_argument, NULL, KEY_TARGET},
	{"precision", required_argument, NULL, KEY_PRECISION}, {"layout", required_argument, NULL, KEY_LAYOUT},
	{"trig", required_argument, NULL, KEY_TRIG}, {"base", required_argument, NULL, KEY_BASE},
	{"mimic", required_argument, NULL, KEY_MIMIC}, {"dump", required_argument, NULL, KEY_DUMP},
	{"gravity", required_argument, NULL, KEY_GRAVITY}, {"order", required_argument, NULL, KEY_ORDER},
	{"name", required_argument, NULL, KEY_NAME}, {"info", optional_argument, NULL, KEY_INFO},
	{"dot", no_argument, NULL, KEY_DOT}, {"help", no_argument, NULL, KEY_HELP},
	{"version", no_argument, NULL, KEY_VERSION}, {NULL, 0, NULL, 0}};

/* Options that take one word of a few; -1: not one of them. */
static int parse_choice(struct command *c, int key, const char *word)
{
	static const struct choice choices[][5] = {
		{{"cuda", RNEAGEN_TARGET_CUDA}, {"c", RNEAGEN_TARGET_C}, {"header", RNEAGEN_TARGET_HEADER}},
		{{"f32", RNEAGEN_F32}, {"f64", RNEAGEN_F64}},
		{{"soa", RNEAGEN_SOA}, {"aos", RNEAGEN_AOS}},
		{{"accurate", RNEAGEN_ACCURATE}, {"bounded", RNEAGEN_BOUNDED}, {"fast", RNEAGEN_FAST}},
		{{"fixed", RNEAGEN_FIXED}, {"floating", RNEAGEN_FLOATING}},
		{{"honour", RNEAGEN_MIMIC_HONOUR}, {"independent", RNEAGEN_MIMIC_INDEPENDENT}},
		{{"robot", RNEAGEN_DUMP_ROBOT}, {"tree", RNEAGEN_DUMP_TREE}, {"dag", RNEAGEN_DUMP_DAG}, {"plan", RNEAGEN_DUMP_PLAN}},
	};
	int value = 0, bad;

	if (key < KEY_TARGET || key > KEY_DUMP)
		return -1;
	bad = choose(OPTIONS[1 + key - KEY_TARGET].name, word, choices[key - KEY_TARGET], &value);
	if (bad)
		return bad;
	switch (key) {
	case KEY_TARGET:
		c->has_target = 1;
		c->options.target = (enum rneagen_target)value;
		break;
	case KEY_PRECISION:
		c->options.precision = (enum rneagen_precision)value;
		break;
	case KEY_LAYOUT:
		c->options.layout = (enum rneagen_layout)value;
		break;
	case KEY_TRIG:
		c->options.trig = (enum rneagen_trig)value;
		break;
	case KEY_BASE:
		c->options.base = (enum rneagen_base)value;
		break;
	case KEY_MIMIC:
		c->options.mimic = (enum rneagen_mimic)value;
		break;
	default:
		c->options.dump = (enum rneagen_dump)value;
	}
	return 0;
}

/* --info and --dot share standard output. */
static int set_info(struct command *c, enum info_mode info)
{
	if (c->info != INFO_NONE && (c->info == INFO_DOT) != (info == INFO_DOT))
		return fail_usage("--info and --dot both print to standard output; take one%s%s", "", "");
	c->info = info;
	return 0;
}

static int parse_option(struct command *c, int key, const char *word)
{
	switch (key) {
	case 'o':
		c->output = word;
		return *word ? 0 : fail_usage("-o takes the name of a file, not an empty word%s%s", "", "");
	case KEY_GRAVITY:
		return parse_gravity(word, c->options.gravity);
	case KEY_ORDER:
		c->options.order = word;
		return 0;
	case KEY_NAME:
		c->options.name = word;
		return 0;
	case KEY_INFO:
		if (word && strcmp(word, "json"))
			return fail_usage("--info takes nothing, or =json, not '%s'%s", word, "");
		return set_info(c, word ? INFO_JSON : INFO_TABLE);
	case KEY_DOT:
		return set_info(c, INFO_DOT);
	default:
		return parse_choice(c, key, word);
	}
}

static int has_suffix(const char *s, const char *suffix)
{
	size_t n = strlen(s), m = strlen(suffix);

	return n > m && !strcmp(s + n - m, suffix);
}

static void target_from_suffix(struct command *c)
{
	if (c->has_target || !c->output)
		return;
	if (has_suffix(c->output, ".c"))
		c->options.target = RNEAGEN_TARGET_C;
	else if (has_suffix(c->output, ".h") || has_suffix(c->output, ".cuh"))
		c->options.target = RNEAGEN_TARGET_HEADER;
}

/* Returns -1 to go on, or the exit status. */
static int parse_command(struct command *c, int argc, char **argv)
{
	int key;

	while ((key = getopt_long(argc, argv, ":o:", OPTIONS, NULL)) != -1) {
		int bad;

		if (key == KEY_HELP || key == KEY_VERSION)
			return file_put_stdout(key == KEY_HELP ? HELP : "rneagen " RNEAGEN_VERSION "\n") ? 1 : 0;
		if (key == ':')
			return fail_usage("option '%s' needs a value%s", argv[optind - 1], "");
		if (key == '?')
			return fail_usage("option '%s' is not known%s", argv[optind - 1], "");
		bad = parse_option(c, key, optarg);
		if (bad)
			return bad;
	}
	if (optind == argc)
		return fail_usage("no URDF named%s%s", "", "");
	if (optind + 1 < argc)
		return fail_usage("one URDF at a time: '%s', '%s'", argv[optind], argv[optind + 1]);
	c->input = argv[optind];
	if (!*c->input)
		return fail_usage("the name of the URDF is empty%s%s", "", "");
	if (c->output && c->options.dump != RNEAGEN_DUMP_NONE)
		return fail_usage("--dump prints to standard output and goes without -o%s%s", "", "");
	c->options.file = strcmp(c->input, "-") ? c->input : "<stdin>";
	target_from_suffix(c);
	return -1;
}

/* What goes to standard output, what to files. */
static int write_results(const struct command *c, const struct rneagen_result *r, struct rneagen_error *e)
{
	if (c->output && file_write_pair(c->output, r->source, r->header, e))
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
	struct rneagen_error e = {0};
	struct rneagen_result r;
	struct file_content urdf = {0};
	int bad;

	bad = file_read(c->input, &urdf, &e) || rneagen_generate(urdf.bytes, urdf.length, &c->options, &r, &e);
	if (!bad) {
		for (size_t i = 0; i < r.warning_count && (c->info == INFO_NONE || c->info == INFO_DOT); i++)
			fprintf(stderr, "rneagen: warning: %s\n", r.warnings[i]);
		bad = write_results(c, &r, &e);
		rneagen_result_free(&r);
	}
	if (bad)
		fprintf(stderr, "rneagen: %s\n", e.message);
	free(urdf.bytes);
	return bad ? (e.code == RNEAGEN_USAGE || e.code == RNEAGEN_NAME ? 2 : 1) : 0;
}

int main(int argc, char **argv)
{
	struct command c = {.options = rneagen_options_default()};
	int status = parse_command(&c, argc, argv);

	return status >= 0 ? status : run(&c);
}
