#ifndef TESTS_PROCESS_H
#define TESTS_PROCESS_H
/* Other programs, run without a shell. */

struct process {
	int status;   /* exit status, 128 + n after signal n, 127 where there is no such program */
	char *output; /* what it wrote to either stream, NUL-terminated */
};

/* Run argv[0], found along PATH, to its end; the caller gives the result to process_free. */
struct process process_run(const char *const *argv);
void process_free(struct process *p);

/* Does `program --version` succeed? */
int process_exists(const char *program);

#endif
