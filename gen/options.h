#ifndef RNEAGEN_OPTIONS_H
#define RNEAGEN_OPTIONS_H
/* What the command lines of all commands share: how options that say what to generate are read, and how what is wrong
   is told. */

#include "rneagen.h"
#include <getopt.h>

/* What getopt_long returns. A command's own options follow from OPTION_OWN on. */
enum option_key { OPTION_TARGET = 256, OPTION_PRECISION, OPTION_LAYOUT, OPTION_TRIG, OPTION_BASE, OPTION_MIMIC,
	OPTION_DUMP, OPTION_GRAVITY, OPTION_ORDER, OPTION_STRICT, OPTION_HELP, OPTION_VERSION, OPTION_OWN = 512 };

/* Rows for getopt_long: what torques are wanted, whatever text they come from. */
#define OPTIONS_MODEL                                                                                                  \
	{"precision", required_argument, NULL, OPTION_PRECISION}, {"trig", required_argument, NULL, OPTION_TRIG},      \
	{"base", required_argument, NULL, OPTION_BASE}, {"gravity", required_argument, NULL, OPTION_GRAVITY},          \
	{"mimic", required_argument, NULL, OPTION_MIMIC}, {"order", required_argument, NULL, OPTION_ORDER},            \
	{"strict", no_argument, NULL, OPTION_STRICT}

/* Rows for getopt_long: what kind of text. */
#define OPTIONS_TEXT                                                                                                   \
	{"target", required_argument, NULL, OPTION_TARGET}, {"layout", required_argument, NULL, OPTION_LAYOUT},        \
	{"dump", required_argument, NULL, OPTION_DUMP}

struct option_choice {
	const char *name; /* NULL ends a list */
	int value;
};

/* Print "COMMAND: what is wrong; see COMMAND --help" to standard error; returns 2, the exit status. */
int option_refuse(const char *command, const char *fmt, ...) RNEAGEN_PRINTF(2, 3);

/* The value that a word stands for; 2 and a message if it stands for none. */
int option_choose(const char *command, const char *option, const char *word, const struct option_choice *choices,
	int *value);

/* Take an option of OPTIONS_MODEL or OPTIONS_TEXT: 0; 2 and a message; -1 if `key` is not one of them. */
int option_generate(const char *command, struct rneagen_options *o, int key, const char *word);

/* The message for what getopt_long returned as ':' or '?' in an optstring that begins with ':'; returns 2. */
int option_refuse_key(const char *command, int key, const char *word);

#endif
