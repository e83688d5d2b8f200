#ifndef READ_H
#define READ_H
/* For tests of the front end: a robot read from a file or a string, and the listing of directories. */

#include "urdf/robot.h"

struct read {
	struct arena arena;
	struct robot robot;
	struct rneagen_error error;
};

/* Read from memory; `file` is the name in messages. read_free afterwards in every case. */
void read_memory(struct read *r, const char *xml, size_t length, const char *file);

/* Read DIRECTORY/NAME; the name in messages is NAME. Aborts the test if there is no such file. */
void read_robot(struct read *r, const char *directory, const char *name);

void read_free(struct read *r);

/* Names of the files *.urdf in a directory, sorted; a NULL ends them. names_free afterwards. */
char **names_list(const char *directory, int *count);
void names_free(char **names);

#endif
