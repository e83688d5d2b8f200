/* Compilers that are not there, fail, die, chatter and lie. */
#define _GNU_SOURCE
#include "test_runtime_host.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

START_TEST(none)
{
	char part[400];

	setenv("PATH", inside("tmp"), 1);
	snprintf(part, sizeof part, "no C compiler: tried cc, gcc, clang in PATH (%s); RNEA_CC names another",
		inside("tmp"));
	assert_fails(RNEA_NO_COMPILER, part);
	setenv("RNEA_CC", "mycc", 1);
	snprintf(part, sizeof part, "RNEA_CC names \"mycc\", which is not a program in PATH (%s)", inside("tmp"));
	assert_fails(RNEA_NO_COMPILER, part);
}
END_TEST

START_TEST(chosen)
{
	char path[6000];

	setenv("RNEA_CC", inside("missing"), 1);
	assert_fails(RNEA_NO_COMPILER, "missing (from RNEA_CC): No such file or directory");
	setenv("RNEA_CC", inside("tmp"), 1);
	assert_fails(RNEA_NO_COMPILER, "tmp (from RNEA_CC): Is a directory");
	write_file(inside("text"), "", 0600);
	setenv("RNEA_CC", inside("text"), 1);
	assert_fails(RNEA_NO_COMPILER, "text (from RNEA_CC): Permission denied");
	memset(path, 'x', sizeof path);
	path[0] = '/';
	path[sizeof path - 1] = '\0';
	setenv("RNEA_CC", path, 1);
	assert_fails(RNEA_NO_COMPILER, "no C compiler: /xxx");
	setenv("RNEA_CC", "/dev/null", 1);
	assert_fails(RNEA_NO_COMPILER, "Permission denied");
	setenv("RNEA_CC", "cc -m64", 1);
	assert_fails(RNEA_NO_COMPILER, "RNEA_CC names \"cc -m64\", which is not a program in PATH");
}
END_TEST

/* The first of cc, gcc and clang. */
START_TEST(found)
{
	struct host h;

	setenv("PATH", inside(""), 1);
	use_script("clang", "PATH=/usr/bin:/bin exec cc \"$@\"\n");
	unsetenv("RNEA_CC");
	h = open_pendulum();
	ck_assert_ptr_nonnull(strstr(h.compiler, "/clang)"));
	host_close(&h);
	use_script("gcc", "PATH=/usr/bin:/bin exec cc \"$@\"\n");
	unsetenv("RNEA_CC");
	h = open_pendulum();
	ck_assert_ptr_nonnull(strstr(h.compiler, "/gcc)"));
	host_close(&h);
	setenv("RNEA_CC", "clang", 1);
	h = open_pendulum();
	ck_assert_ptr_nonnull(strstr(h.compiler, "/clang)"));
	host_close(&h);
	setenv("RNEA_CC", "", 1); /* empty is as good as not set */
	h = open_pendulum();
	ck_assert_ptr_nonnull(strstr(h.compiler, "/gcc)"));
	host_close(&h);
}
END_TEST

START_TEST(not_a_program)
{
	write_file(inside("empty"), "", 0700);
	setenv("RNEA_CC", inside("empty"), 1);
	assert_fails(RNEA_COMPILER, "empty: cannot be run: Exec format error");
	write_file(inside("plain"), "touch \"${0%/*}/ran\"\n", 0700); /* no shell is asked to try */
	setenv("RNEA_CC", inside("plain"), 1);
	assert_fails(RNEA_COMPILER, "plain: cannot be run: Exec format error");
	ck_assert_int_ne(access(inside("ran"), F_OK), 0);
	write_file(inside("orphan"), "#!/no/such/interpreter\n", 0700);
	setenv("RNEA_CC", inside("orphan"), 1);
	assert_fails(RNEA_COMPILER, "orphan: cannot be run: No such file or directory");
}
END_TEST

START_TEST(fails)
{
	assert_script_fails("kill -9 $$\n", RNEA_COMPILER, "compiler: killed by signal 9 while it compiled text.c");
	assert_script_fails("kill -SEGV $$\n", RNEA_COMPILER, "killed by signal 11");
	assert_script_fails("echo working\necho 'x: error: no more'\necho '  3 | y'\nexit 1\n", RNEA_COMPILE,
		"compiler: x: error: no more: y");
	assert_script_fails("echo nonsense >&2\nexit 3\n", RNEA_COMPILE, "text.c: exit status 3: nonsense");
	assert_script_fails("exit 4\n", RNEA_COMPILE, "text.c: exit status 4");
	assert_script_fails(
		"exit 0\n", RNEA_COMPILER, "without an error and without an object for text.c: No such file");
}
END_TEST

/* The object that these write is the argument after -o. */
#define WITH_OBJECT "while [ \"$1\" != -o ]; do shift; done\n"

START_TEST(lies)
{
	assert_script_fails(WITH_OBJECT ": >\"$2\"\n", RNEA_COMPILER, "without an object for text.c: it is empty");
	assert_script_fails(
		WITH_OBJECT "mkdir \"$2\"\n", RNEA_COMPILER, "without an object for text.c: Invalid argument");
	assert_script_fails(
		WITH_OBJECT "mkfifo \"$2\"\n", RNEA_COMPILER, "without an object for text.c: Invalid argument");
	assert_script_fails(WITH_OBJECT "echo junk >\"$2\"\n", RNEA_COMPILER, "the compiled text cannot be loaded: ");
	assert_script_fails(WITH_OBJECT "cp \"$0\" \"$2\"\nmkdir -p \"$TMPDIR/a/b\"\nln -s / \"$TMPDIR/a/root\"\n",
		RNEA_COMPILER, "the compiled text cannot be loaded: ");
}
END_TEST

START_TEST(chatters)
{
	struct host h;
	int held;

	use_script("compiler", "head -c 100000000 /dev/zero\nexec cc \"$@\"\n");
	h = open_pendulum();
	assert_torques(&h, 0.5, 9.81);
	host_close(&h);
	/* what it leaves running holds the pipe, and nobody waits for that, nor ends it: this test lets it go */
	ck_assert_int_eq(mkfifo(inside("held"), 0600), 0);
	ck_assert_int_ge(held = open(inside("held"), O_RDWR | O_CLOEXEC), 0);
	use_script("compiler", "case $* in *--version*) exit 1 ;; esac\n"
		"(read line <\"${0%/*}/held\"; : >\"${0%/*}/went\") &\nexec cc \"$@\"\n");
	h = open_pendulum();
	host_close(&h);
	ck_assert_int_eq(write(held, "go\n", 3), 3);
	for (int i = 0; i < 2000 && access(inside("went"), F_OK) != 0; i++)
		usleep(10000);
	ck_assert_int_eq(access(inside("went"), F_OK), 0);
	close(held);
}
END_TEST

/* A program that is killed takes the compiler along, and what that has started: both hold a pipe, which ends then. The compiler
   waits before it says that it is at work: the program is to have come from starting it (hold_leash of child.c). */
START_TEST(orphaned)
{
	struct pollfd ready = {.events = POLLIN};
	char said[100];
	pid_t pid;

	ck_assert_int_eq(mkfifo(inside("held"), 0600), 0);
	ck_assert_int_ge(ready.fd = open(inside("held"), O_RDONLY | O_NONBLOCK | O_CLOEXEC), 0);
	use_script("compiler", "case $* in *--version*) exit 1 ;; esac\n"
		"exec 9>\"${0%/*}/held\"\nsleep 100 &\nsleep 2\necho at work >&9\nwait\n");
	ck_assert_int_ge(pid = fork(), 0);
	if (!pid) {
		fail_pendulum();
		_exit(0);
	}
	ck_assert_int_eq(poll(&ready, 1, 20000), 1);
	ck_assert_int_gt(read(ready.fd, said, sizeof said), 0);
	kill(pid, SIGKILL);
	ck_assert_int_eq(waitpid(pid, NULL, 0), pid);
	ck_assert_msg(poll(&ready, 1, 20000) == 1, "it goes on");
	ck_assert_int_eq(read(ready.fd, said, sizeof said), 0);
	close(ready.fd);
	ck_assert_int_eq(system("rm -r \"$TMPDIR\"/rnea-*"), 0); /* nobody was left to do that */
}
END_TEST

/* The compiler has nothing to read, no descriptor but one that ends it with this process, no signal blocked or ignored, and
   speaks English. */
START_TEST(surroundings)
{
	FILE *f = fopen(inside("held"), "wb"); /* not close-on-exec */
	sigset_t all;
	struct host h;
	int ends[2];

	ck_assert_ptr_nonnull(f);
	ck_assert_int_eq(pipe(ends), 0); /* somebody has typed something */
	ck_assert_int_eq(write(ends[1], "typed\n", 6), 6);
	dup2(ends[0], STDIN_FILENO);
	close(ends[0]);
	close(ends[1]);
	setenv("LC_ALL", "de_DE.UTF-8", 1);
	setenv("RNEA_TEST_VARIABLE", "kept", 1);
	signal(SIGPIPE, SIG_IGN);
	sigfillset(&all);
	sigprocmask(SIG_BLOCK, &all, NULL);
	use_script("compiler",
		"case $* in *--version*) exit 1 ;; esac\n"
		"{ cat; ls /proc/$$/fd; echo $LC_ALL $RNEA_TEST_VARIABLE; grep -E 'Sig(Blk|Ign)' /proc/self/status; "
		"} >\"${0%/*}/seen\"\nexec cc \"$@\"\n");
	h = open_pendulum();
	sigemptyset(&all);
	sigprocmask(SIG_SETMASK, &all, NULL);
	ck_assert_str_eq(h.compiler, inside("compiler")); /* it does not tell its version */
	host_close(&h);
	fclose(f);
	f = fopen(inside("seen"), "rb");
	char seen[1000] = "", *at;
	ck_assert_uint_gt(fread(seen, 1, sizeof seen - 1, f), 0);
	fclose(f);
	/* 10 and 11, or 255: the script itself; 3: see child.c */
	ck_assert_msg(strncmp(seen, "0\n1\n", 4) == 0, "%s", seen);
	ck_assert_msg(strstr(seen, "\nC kept\n") != NULL, "%s", seen);
#if defined __GLIBC__
	ck_assert_msg((at = strstr(seen, "\n3\nC")) != NULL && at - seen <= 11, "%s", seen);
#endif
	ck_assert_msg(strstr(seen, "SigBlk:\t0000000000000000") != NULL, "%s", seen);
	ck_assert_msg((at = strstr(seen, "SigIgn:")) != NULL, "%s", seen);
	ck_assert_msg((strtoull(at + 7, NULL, 16) & 0x7fffffff) == 0, "%s", seen); /* beyond: the C library's own */
}
END_TEST

START_TEST(without_native)
{
	struct host h;

	use_script("compiler",
		"case $* in *-march=native*) echo \"error: bad value 'native' for '-march='\"; exit 1 ;; esac\n"
		"exec cc \"$@\"\n");
	h = open_pendulum();
	assert_torques(&h, 0.5, 9.81);
	host_close(&h);
	assert_script_fails(
		"echo 'x: error: I do not know -march at all'\nexit 1\n", RNEA_COMPILE, "I do not know -march");
}
END_TEST

START_TEST(text_at_fault)
{
	char *text = pendulum_with("0.5f, qdd", "0.5f, nothing");
	static const char *const options[] = {"-DX=1", "-no-such-option"};
	struct host_request r = pendulum_request(text);
	struct rnea_error e;
	char log[4000], little[10] = "xxxxxxxxx";

	r.log = log;
	r.log_size = sizeof log;
	e = fail_open(&r);
	assert_error(&e, RNEA_COMPILE, "text.c:36:");
	assert_error(&e, RNEA_COMPILE, "error: ");
	assert_error(&e, RNEA_COMPILE, ": tau[k] = fmaf(0.5f, nothing[k]");
	ck_assert_ptr_nonnull(strstr(log, "text.c:36:"));
	ck_assert_ptr_null(strstr(log, sandbox));
	r.log = little;
	r.log_size = sizeof little;
	fail_open(&r);
	ck_assert_uint_eq(strlen(little), sizeof little - 1);
	free(text);
	r = pendulum_request("#error \"no\"\n");
	e = fail_open(&r);
	assert_error(&e, RNEA_COMPILE, "text.c:1:2: error: #error");
	r.options = options;
	r.option_count = 2;
	e = fail_open(&r);
	assert_error(&e, RNEA_COMPILE, "no-such-option");
}
END_TEST

/* Where there is no folder of the user's the files go to /tmp, and none stays: other programs' are there as well. */
START_TEST(no_room)
{
	const char *const folders[] = {inside("missing"), "tmp" /* not absolute */, NULL};
	struct host h;

	for (int i = 0; i < 3; i++) {
		if (folders[i])
			setenv("TMPDIR", folders[i], 1);
		else
			unsetenv("TMPDIR");
		h = open_pendulum();
		host_close(&h);
		ck_assert_msg(strncmp(made.last, "/tmp/rnea-", 10) == 0, "%s", made.last);
		ck_assert_int_ne(access(made.last, F_OK), 0);
		ck_assert_int_eq(made.folders, i + 1);
	}
	faults.no_folder = EROFS;
	assert_fails(RNEA_COMPILER,
		"no folder for the compiler's files in TMPDIR or /tmp: Read-only file system; TMPDIR names another");
}
END_TEST

/* A disk that takes less and less. */
START_TEST(full_disk)
{
	struct rlimit limit = {100, RLIM_INFINITY};
	struct rnea_error e;

	signal(SIGXFSZ, SIG_IGN);
	setrlimit(RLIMIT_FSIZE, &limit);
	e = fail_pendulum();
	assert_error(&e, RNEA_COMPILER, "text.c: cannot be written: File too large; TMPDIR names another folder");
	limit.rlim_cur = 6000; /* the text, and not the object */
	setrlimit(RLIMIT_FSIZE, &limit);
	e = fail_pendulum();
	ck_assert(e.code == RNEA_COMPILE || e.code == RNEA_COMPILER);
	ck_assert_ptr_nonnull(strstr(e.message, "cc"));
}
END_TEST

static void reap_all(int signal_number)
{
	int status, saved = errno;

	(void)signal_number;
	while (waitpid(-1, &status, WNOHANG) > 0)
		;
	errno = saved;
}

/* Programs that reap children elsewhere, or not at all: the status is lost, the object tells. */
START_TEST(reaped_elsewhere)
{
	struct sigaction action = {.sa_handler = SIG_IGN};
	struct host h;

	for (int i = 0; i < 2; i++) {
		sigaction(SIGCHLD, &action, NULL);
		unsetenv("RNEA_CC");
		h = open_pendulum();
		assert_torques(&h, 0.5, 9.81);
		host_close(&h);
		assert_script_fails("echo 'x: error: no'\nexit 1\n", RNEA_COMPILE, "compiler: x: error: no");
		assert_script_fails("echo 'bad'\nexit 1\n", RNEA_COMPILE, ": bad");
		action.sa_handler = reap_all; /* interrupts every call */
	}
}
END_TEST

/* Descriptors 0, 1 and 2 may be anything, or closed. */
START_TEST(standard_streams_closed)
{
	int status;
	pid_t pid;

	fflush(NULL);
	for (int mask = 1; mask < 8; mask++) {
		if ((pid = fork()) == 0) {
			char *text = pendulum_with("", "");
			struct host_request r = pendulum_request(text);
			struct rnea_error e = {0};
			struct host h;

			for (int fd = 0; fd < 3; fd++)
				if (mask >> fd & 1)
					close(fd);
			status = host_open(&h, &r, &e) != RNEA_OK;
			use_script("compiler", "echo 'x: error: seen'\nexit 1\n");
			status |= host_open(&h, &r, &e) != RNEA_COMPILE || !strstr(e.message, "x: error: seen");
			_exit(status);
		}
		ck_assert_int_eq(waitpid(pid, &status, 0), pid);
		ck_assert_msg(status == 0, "closed: %d", mask);
	}
}
END_TEST

Suite *suite_host_compiler(void)
{
	Suite *s = suite_create("host: compiler");
	TCase *t = tcase_create("host: compiler");

	tcase_add_checked_fixture(t, sandbox_make, sandbox_remove);
	tcase_set_timeout(t, 60);
	tcase_add_test(t, none);
	tcase_add_test(t, chosen);
	tcase_add_test(t, found);
	tcase_add_test(t, not_a_program);
	tcase_add_test(t, fails);
	tcase_add_test(t, lies);
	tcase_add_test(t, chatters);
	tcase_add_test(t, orphaned);
	tcase_add_test(t, surroundings);
	tcase_add_test(t, without_native);
	tcase_add_test(t, text_at_fault);
	tcase_add_test(t, no_room);
	tcase_add_test(t, full_disk);
	tcase_add_test(t, reaped_elsewhere);
	tcase_add_test(t, standard_streams_closed);
	suite_add_tcase(s, t);
	return s;
}
