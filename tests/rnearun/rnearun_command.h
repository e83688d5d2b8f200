#ifndef TESTS_RNEARUN_COMMAND_H
#define TESTS_RNEARUN_COMMAND_H
/* rnearun as the tests of the command run it, in a folder of their own. */

#include "support/suite.h"

#define ROBOTS TEST_DIR "/robots/"
#define IIWA ROBOTS "iiwa14.urdf"

/* The command. */
extern const char *rnearun;

/* rnearun eval WORDS...: its status, and `part` in what it says; "": nothing of samples or missing files. */
void run_eval(int status, const char *part, const char *const *words);
#define RUN(status, part, ...) run_eval(status, part, (const char *const[]){__VA_ARGS__, NULL})

/* A script of the shell, with $1 rnearun and $2 a URDF: its status, and `part` in what it says. */
void run_shell(int status, const char *part, const char *script, const char *urdf);

/* How many files there are whose names begin so. */
int count_files(const char *begins);

/* Run the suite in a folder of this name and six more characters, which holds the cache and goes again; returns the exit
   status. */
int run_in_folder(Suite *suite, const char *name);

#endif
