#define _POSIX_C_SOURCE 200809L
#include "support/process.h"
#include <check.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static char *read_all(int fd)
{
	size_t size = 0, capacity = 4096;
	char *s = malloc(capacity);
	ssize_t n;

	ck_assert_ptr_nonnull(s);
	while ((n = read(fd, s + size, capacity - size - 1)) > 0) {
		size += (size_t)n;
		if (capacity - size < 2) {
			capacity *= 2;
			s = realloc(s, capacity);
			ck_assert_ptr_nonnull(s);
		}
	}
	s[size] = '\0';
	return s;
}

static _Noreturn void become(const char *const *argv, int out)
{
	char *copy[64];
	int n = 0;

	for (; argv[n] && n < 63; n++)
		copy[n] = strdup(argv[n]);
	copy[n] = NULL;
	dup2(out, STDOUT_FILENO);
	dup2(out, STDERR_FILENO);
	close(out);
	execvp(copy[0], copy);
	_exit(127);
}

struct process process_run(const char *const *argv)
{
	struct process p = {0};
	int ends[2], status;
	pid_t pid;

	ck_assert_int_eq(pipe(ends), 0);
	pid = fork();
	ck_assert_int_ge(pid, 0);
	if (!pid) {
		close(ends[0]);
		become(argv, ends[1]);
	}
	close(ends[1]);
	p.output = read_all(ends[0]);
	close(ends[0]);
	ck_assert_int_eq(waitpid(pid, &status, 0), pid);
	p.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
	return p;
}

void process_free(struct process *p)
{
	free(p->output);
	p->output = NULL;
}

int process_exists(const char *program)
{
	const char *const argv[] = {program, "--version", NULL};
	struct process p = process_run(argv);

	process_free(&p);
	return p.status == 0;
}
