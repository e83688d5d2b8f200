/* pipe2 and posix_spawn_file_actions_addclosefrom_np */
#define _GNU_SOURCE
#include "core/child.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined __GLIBC_PREREQ
#if __GLIBC_PREREQ(2, 34)
#define CLOSES_REST
#endif
#endif

enum { POLL_MILLISECONDS = 50, LEASH = STDERR_FILENO + 1 };

/* ---- starting ---- */

/* Whether one of `variables` is named like `entry`, "NAME=value". */
static int is_replaced(const char *entry, const char *const *variables)
{
	size_t length = strcspn(entry, "=");

	for (; *variables; variables++)
		if (strncmp(entry, *variables, length) == 0 && (*variables)[length] == '=')
			return 1;
	return 0;
}

/* An array for execve; its strings are not copies. */
static char **environment(const char *const *variables)
{
	size_t n = 0, count = 0;
	const char **made;

	while (environ && environ[n])
		n++;
	while (variables[count])
		count++;
	if (!(made = calloc(n + count + 1, sizeof *made)))
		return NULL;
	memcpy(made, variables, count * sizeof *made);
	for (size_t i = 0; i < n; i++)
		if (!is_replaced(environ[i], variables))
			made[count++] = environ[i];
	return (char **)made;
}

/* Standard input is empty; the others are `out`, which may itself be one of the three, and is written over last. `leash`
   is beyond its place, or -1. */
static int set_files(posix_spawn_file_actions_t *files, int out, int leash)
{
	int e = posix_spawn_file_actions_adddup2(files, out, STDOUT_FILENO);

	if (!e)
		e = posix_spawn_file_actions_adddup2(files, STDOUT_FILENO, STDERR_FILENO);
	if (!e)
		e = posix_spawn_file_actions_addopen(files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
	if (!e && leash >= 0)
		e = posix_spawn_file_actions_adddup2(files, leash, LEASH);
#if defined CLOSES_REST
	if (!e)
		e = posix_spawn_file_actions_addclosefrom_np(files, leash < 0 ? LEASH : LEASH + 1);
#endif
	return e;
}

/* A signal that this process ignores or blocks would be ignored or blocked by the compiler too. With what it starts it is a
   group of processes, which can be killed together. */
static int set_signals(posix_spawnattr_t *attributes)
{
	sigset_t all, none;
	int e;

	sigfillset(&all);
	sigdelset(&all, SIGKILL);
	sigdelset(&all, SIGSTOP);
	sigemptyset(&none);
	e = posix_spawnattr_setflags(attributes,
		POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
	if (!e)
		e = posix_spawnattr_setsigdefault(attributes, &all);
	return e ? e : posix_spawnattr_setsigmask(attributes, &none);
}

static int spawn(pid_t *pid, const char *path, const char *const *argv, char **env, int out, int leash)
{
	posix_spawn_file_actions_t files;
	posix_spawnattr_t attributes;
	int e = posix_spawn_file_actions_init(&files);

	if (e)
		return e;
	if ((e = posix_spawnattr_init(&attributes)) == 0) {
		e = set_files(&files, out, leash);
		if (!e)
			e = set_signals(&attributes);
		if (!e)
			e = posix_spawn(pid, path, &files, &attributes, (char *const *)argv, env);
		posix_spawnattr_destroy(&attributes);
	}
	posix_spawn_file_actions_destroy(&files);
	return e;
}

/* ---- ending with this process ---- */

/* A pipe that nobody writes to. The child and all that it starts have its end ends[0], this process alone has the other. When
   that is closed, as this process ends in whatever way, the kernel sends SIGIO to the owner of ends[0], the child's group,
   which ends it. PR_SET_PDEATHSIG would end a compiler's driver alone, and not the program that compiles for it. Without a
   pipe, -1, the child goes on to its end. */
static void make_leash(int *ends)
{
	int low;

	if (pipe2(ends, O_CLOEXEC) != 0)
		ends[0] = ends[1] = -1;
	low = ends[0];
	ends[0] = fcntl(low, F_DUPFD_CLOEXEC, LEASH + 1);
	if (low >= 0)
		close(low);
}

/* The group is known when it runs already: a process that is killed before this leaves it. */
static void hold_leash(const int *ends, pid_t group)
{
	if (fcntl(ends[0], F_SETOWN, -group) == 0)
		fcntl(ends[0], F_SETFL, O_ASYNC);
}

/* What the child left running stays. */
static void drop_leash(const int *ends)
{
	fcntl(ends[0], F_SETFL, 0);
	for (int i = 0; i < 2; i++)
		if (ends[i] >= 0)
			close(ends[i]);
}

/* ---- listening ---- */

/* Whether the child has ended. Where children are reaped elsewhere, by a handler or as SIGCHLD is ignored, its status
   is lost. */
static int has_ended(pid_t pid, int options, struct child *end)
{
	int status;
	pid_t got;

	do
		got = waitpid(pid, &status, options);
	while (got < 0 && errno == EINTR);
	if (got == 0)
		return 0;
	end->signal = got == pid && WIFSIGNALED(status) ? WTERMSIG(status) : 0;
	end->status = got == pid && WIFEXITED(status) ? WEXITSTATUS(status) : CHILD_UNKNOWN;
	return 1;
}

/* One read; what is beyond the limit is read, so that the child does not have to wait, and dropped. 0 at the end. */
static int read_some(int in, char *output, size_t *size)
{
	char dropped[4096];
	size_t room = CHILD_OUTPUT_LIMIT - *size;
	ssize_t n;

	do
		n = room ? read(in, output + *size, room) : read(in, dropped, sizeof dropped);
	while (n < 0 && errno == EINTR);
	if (n > 0 && room)
		*size += (size_t)n;
	return n > 0;
}

/* Until nobody can write any more, or the child has ended and what it left running has nothing to say. */
static void listen_to(pid_t pid, int in, const struct child_stop *stop, struct child *end)
{
	struct pollfd ready = {.fd = in, .events = POLLIN};
	size_t size = 0;
	int n, ended = 0;

	do {
		n = poll(&ready, 1, POLL_MILLISECONDS);
		if (n <= 0 && !ended && stop && stop->ask && stop->ask(stop->context))
			kill(-pid, SIGKILL);
		if (n == 0 && !ended)
			ended = has_ended(pid, WNOHANG, end);
		else if (n == 0)
			break;
	} while (n <= 0 || read_some(in, end->output, &size));
	if (!ended)
		has_ended(pid, 0, end);
	for (size_t i = 0; i < size; i++)
		if (!end->output[i])
			end->output[i] = ' ';
	end->output[size] = '\0';
}

static int run(const char *path, const char *const *argv, char **env, const struct child_stop *stop, struct child *end)
{
	int ends[2], leash[2], e;
	pid_t pid;

	if (pipe2(ends, O_CLOEXEC) != 0)
		return errno;
	make_leash(leash);
	e = spawn(&pid, path, argv, env, ends[1], leash[0]);
	close(ends[1]);
	if (!e) {
		hold_leash(leash, pid);
		listen_to(pid, ends[0], stop, end);
	}
	drop_leash(leash);
	close(ends[0]);
	return e;
}

int child_run(const char *path, const char *const *argv, const char *const *variables, const struct child_stop *stop,
	struct child *end)
{
	char **env = environment(variables);
	int e = ENOMEM;

	memset(end, 0, sizeof *end);
	/* memory is taken before the program starts: afterwards nothing may keep this from waiting for it */
	if (env && (end->output = malloc(CHILD_OUTPUT_LIMIT + 1)) != NULL)
		e = run(path, argv, env, stop, end);
	free(env);
	if (e) {
		free(end->output);
		end->output = NULL;
	}
	return e;
}
