/* rnearun over files that are large, interrupted, and where the disk is full. */
#define _DEFAULT_SOURCE
#include "test_rnearun.h"
#include "states_file.h"
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* Peak memory in KiB of rnearun over IN, and of its children. */
static long peak(const char *in)
{
	struct rusage usage;
	int status;
	pid_t pid = fork();

	ck_assert_int_ge(pid, 0);
	if (!pid) {
		execl(rnearun, rnearun, "eval", IIWA, "--in", in, "--out", "out.npy", "--slice", "5000", "--backend",
			"cpu", NULL);
		_exit(127);
	}
	ck_assert_int_eq(wait4(pid, &status, 0, &usage), pid);
	ck_assert_int_eq(status, 0);
	return usage.ru_maxrss;
}

/* 400 MB of states take no more memory than 2 MB of them. */
START_TEST(test_memory)
{
	struct stat st;
	long small, large;

	file_put_sparse("small.npy", 10000, 21);
	file_put_sparse("large.npy", 2400000, 21);
	/* the first run may need a compiler, the second takes what it made */
	peak("small.npy");
	small = peak("small.npy");
	large = peak("large.npy");
	ck_assert_msg(large < small + 20000, "%ld KiB, then %ld", small, large);
	ck_assert_int_eq(stat("out.npy", &st), 0);
	ck_assert_int_eq(st.st_size, 128 + 2400000L * 7 * 8);
	unlink("out.npy");
}
END_TEST

/* The size of the output that is pending; 0 if there is none. */
static off_t pending_size(void)
{
	DIR *d = opendir(".");
	off_t size = 0;
	struct stat st;

	for (struct dirent *f; (f = readdir(d)) != NULL;)
		if (!strncmp(f->d_name, "out.npy.", 8) && !stat(f->d_name, &st))
			size = st.st_size;
	closedir(d);
	return size;
}

/* Write the beginning of a file into a pipe until some torques are out: all that runs other programs, which may hold
   signals back, is over. The pipe stays open, so that its reader has more to wait for. */
static int feed(const char *path, const char *pipe, pid_t pid)
{
	int in = open(path, O_RDONLY | O_CLOEXEC), out = open(pipe, O_WRONLY | O_CLOEXEC);
	char bytes[4096];

	ck_assert(in >= 0 && out >= 0);
	while (!pending_size()) {
		ck_assert_int_eq(read(in, bytes, sizeof bytes), sizeof bytes);
		ck_assert_int_eq(write(out, bytes, sizeof bytes), sizeof bytes);
		ck_assert_int_eq(waitpid(pid, NULL, WNOHANG), 0);
	}
	close(in);
	return out;
}

/* The states come through a pipe that never ends, so that the signal finds the command at work, however slow the test is. */
START_TEST(test_interrupted)
{
	static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU};
	int status, out;
	pid_t pid;

	file_put_sparse("large.npy", 2400000, 21);
	ck_assert_int_eq(mkfifo("pipe.npy", 0600), 0);
	pid = fork();
	ck_assert_int_ge(pid, 0);
	if (!pid) {
		/* who runs the test may ignore it */
		signal(numbers[_i], SIG_DFL);
		execl(rnearun, rnearun, "eval", IIWA, "--in", "pipe.npy", "--out", "out.npy", "--slice", "1", NULL);
		_exit(127);
	}
	signal(SIGPIPE, SIG_IGN); /* of a command that has ended, writing says so */
	out = feed("large.npy", "pipe.npy", pid);
	ck_assert_int_eq(kill(pid, numbers[_i]), 0);
	ck_assert_int_eq(waitpid(pid, &status, 0), pid);
	ck_assert(WIFSIGNALED(status) && WTERMSIG(status) == numbers[_i]);
	ck_assert_int_eq(count_files("out.npy"), 0);
	close(out);
	unlink("pipe.npy");
}
END_TEST

/* A compiler that takes long, and leaves a file in TMPDIR; it ends when that folder is gone. */
static void put_compiler(void)
{
	FILE *f = fopen("slow_cc", "w");

	ck_assert_ptr_nonnull(f);
	fputs("#!/bin/sh\n"
	      "[ \"$1\" != --version ] || exit 0\n"
	      ": >\"$TMPDIR/part.s\" && : >started\n"
	      "for i in $(seq 200); do [ ! -d \"$TMPDIR\" ] || sleep 0.1; done\n",
		f);
	ck_assert_int_eq(fclose(f), 0);
	ck_assert_int_eq(chmod("slow_cc", 0700), 0);
}

/* What the library has made for a compiler is gone too. */
START_TEST(test_compiler_interrupted)
{
	static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
	int status;
	pid_t pid;

	put_compiler();
	file_put_sparse("small.npy", 10, 21);
	pid = fork();
	ck_assert_int_ge(pid, 0);
	if (!pid) {
		signal(numbers[_i], SIG_DFL);
		setenv("RNEA_CC", "./slow_cc", 1);
		setenv("RNEA_CACHE", "", 1);
		setenv("TMPDIR", realpath(".", NULL), 1);
		execl(rnearun, rnearun, "eval", IIWA, "--in", "small.npy", "--out", "/dev/null", "--backend", "cpu", NULL);
		_exit(127);
	}
	while (!count_files("started") && !waitpid(pid, NULL, WNOHANG))
		usleep(10000);
	ck_assert_int_eq(count_files("rnea-"), 1);
	ck_assert_int_eq(kill(pid, numbers[_i]), 0);
	ck_assert_int_eq(waitpid(pid, &status, 0), pid);
	ck_assert(WIFSIGNALED(status) && WTERMSIG(status) == numbers[_i]);
	ck_assert_int_eq(count_files("rnea-"), 0);
	unlink("started");
	unlink("slow_cc");
}
END_TEST

/* A limit on the length of files stands for a full disk; what was there before stays. */
START_TEST(test_full)
{
	struct stat st;

	file_put_sparse("large.npy", 200000, 21);
	file_put_sparse("out.npy", 1, 1);
	run_shell(1, "out.npy: cannot be written: File too large",
		"ulimit -f 16000 && exec \"$1\" eval \"$2\" --in large.npy --out out.npy --backend cpu", IIWA);
	ck_assert_int_eq(count_files("out.npy"), 1);
	ck_assert_int_eq(stat("out.npy", &st), 0);
	ck_assert_int_eq(st.st_size, 136);
	unlink("out.npy");
}
END_TEST

TCase *case_limits(void)
{
	TCase *c = tcase_create("limits");

	tcase_set_timeout(c, 120);
	tcase_add_test(c, test_memory);
	tcase_add_loop_test(c, test_interrupted, 0, 5);
	tcase_add_loop_test(c, test_compiler_interrupted, 0, 3);
	tcase_add_test(c, test_full);
	return c;
}
