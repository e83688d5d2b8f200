#ifndef READ_H
#define READ_H
/* Files of robots, as text or read by the front end, and the listing of directories. */

#include "urdf/robot.h"

/* The whole file, NUL-terminated; the caller frees it. NULL if it cannot be read. */
char *read_file(const char *path, size_t *length);

/* The same of DIRECTORY/NAME, and of tests/robots/NAME.urdf. They abort the test if it cannot be read. */
char *read_text(const char *directory, const char *name, size_t *length);
char *robot_text(const char *name);

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

/* Call f for every *.urdf in the folder, in byte order; returns how many there were. */
int for_each_urdf(const char *folder, void (*f)(const char *path, const char *name, void *context), void *context);

#endif
