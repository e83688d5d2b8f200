#ifndef TEST_RNEARUN_H
#define TEST_RNEARUN_H
/* What the parts of test_rnearun share. */

#include <check.h>

#define ROBOTS TEST_DIR "/robots/"
#define IIWA ROBOTS "iiwa14.urdf"

/* The command. */
extern const char *rnearun;

/* A script of the shell, with $1 rnearun and $2 a URDF: its status, and `part` in what it says. */
void run_shell(int status, const char *part, const char *script, const char *urdf);

/* How many files there are whose names begin so. */
int count_files(const char *begins);

/* Files larger than memory, interruptions, full disks. */
TCase *case_limits(void);

#endif
