#ifndef RUNTIME_COMMAND_H
#define RUNTIME_COMMAND_H
/* What the subcommands of rnearun share: the options that say which robot runs where, and how they end. */

#include "passes/analysis.h"
#include "cli/files.h"
#include "cli/options.h"
#include "ranks/ranks.h"
#include "rnea.h"

/* Filled by command_parse. */
struct command {
	const char *name;                /* "rnearun eval" */
	const char *urdf;
	struct rneagen_options generate; /* precision: default unless it was asked for; layout: aos */
	struct rnea_options open;
	int quiet, has_device;           /* as --device says */
	struct ranks *ranks;             /* that run it; messages name the one at fault where there are several */
	struct file_names read, written; /* the URDF and what options read; what the subcommand notes */
};

enum { COMMAND_BACKEND = OPTION_OWN, COMMAND_DEVICE, COMMAND_THREADS, COMMAND_QUIET, COMMAND_OWN };

/* Rows for getopt_long that every subcommand begins with; its own have values from COMMAND_OWN on. */
#define COMMAND_MODEL_OPTIONS                                                                                          \
	OPTIONS_MODEL, {"threads", required_argument, NULL, COMMAND_THREADS}, {"quiet", no_argument, NULL, COMMAND_QUIET}, \
	{"help", no_argument, NULL, OPTION_HELP}

/* And of those that run texts. */
#define COMMAND_OPTIONS                                                                                                \
	COMMAND_MODEL_OPTIONS, {"backend", required_argument, NULL, COMMAND_BACKEND},                                  \
	{"device", required_argument, NULL, COMMAND_DEVICE}

/* Their lines of --help. */
#define COMMAND_HELP                                                                                                   \
	"  --backend cpu|cuda|any     any (default): a GPU where there is one, else the processor\n"                   \
	"  --trig accurate|bounded|fast\n"                                                                             \
	COMMAND_HELP_MODEL

/* The same without what a subcommand may have options of its own for, as all have for --device. */
#define COMMAND_HELP_MODEL                                                                                             \
	"  --threads N                of the processor (default: all)\n"                                               \
	"  --strict                   the same bits from every compiler, CPU and GPU\n"                                \
	"  --base fixed|floating      floating: q starts with x y z qx qy qz qw, qd and tau with six rows\n"           \
	"  --gravity X,Y,Z            m/s^2 in the world (default 0,0,-9.81)\n"                                        \
	"  --mimic honour|independent followers have no entry in q (default), or are joints of their own\n"            \
	"  --order J1,J2,...          rows of q by joint name (default: depth-first, children by name)\n"              \
	OPTIONS_SCENE_HELP                                                                                             \
	"  --quiet                    neither progress nor warnings\n"                                              \
	"  --help\n"

/* A subcommand. `take` is given its own options and 'o' (with the name if they are wrong): 0, or 2 and a message. */
struct command_kind {
	const char *name, *help;
	const struct option *options; /* COMMAND_OPTIONS and its own */
	const char *letters;          /* as for getopt, begins with ':' */
	int (*take)(void *own, const char *name, int key, const char *word);
};

/* Read a whole command line; `own` is handed to kind->take. Returns -1 to go on, or the exit status. */
int command_parse(
	struct command *c, const struct command_kind *kind, void *own, struct ranks *ranks, int argc, char **argv);

/* Of ranks of MPI, where the command line says nothing of it, each takes its share of the processors, and the GPU of
   its number. */
void command_share(struct command *c);

/* Do the files that are noted all have places of their own, are they such as ranks can read, and can they be written? -1 to go
   on, or the exit status and a message. */
int command_check_files(const struct command *c);

/* Note a file: -1, or the exit status and a message. */
int command_note(const struct command *c, struct file_names *names, const char *what, const char *path);

void command_free(struct command *c);

/* A whole number from `least` to `most`; 2 and a message if it is none. */
int command_number(const char *name, const char *option, const char *word, unsigned long long least,
	unsigned long long most, unsigned long long *value);

/* Read the URDF, and analyse the robot in the command's scene. On failure prints a message and returns the exit status, 1 or
   2. The caller frees urdf->bytes, and gives *a to analysis_free, in either case. */
int command_analyse(const struct command *c, struct file_content *urdf, struct analysis *a);

/* Generate the text (not by rnea_open_urdf: that has no warnings to show, and cannot tell whether an option or the robot is at
   fault); open it. On failure print a message and return the exit status, 1 or 2. The caller frees the text in any case. */
int command_generate(const struct command *c, const struct file_content *urdf, struct rneagen_result *text);
int command_open(const struct command *c, const char *text, struct rnea_robot **robot);

/* "NAME: MESSAGE" on standard error, of several ranks "NAME: rank N: MESSAGE"; returns the exit status 1. */
int command_fail(const struct command *c, const char *message);

/* All that was printed is written: 0, or the exit status and a message that says why it is not. */
int command_flush(const struct command *c);

#endif
