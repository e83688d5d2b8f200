/* Threads that share a job. Where a test wants several at once, each piece waits until so many pieces are under way: then
   it is known that they came, however slow the machine is. */
#define _GNU_SOURCE
#include "test_runtime_host.h"
#include <errno.h>
#include <fenv.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PIECES = 1000, TEAM = 3 };

/* What became of each piece of a job. */
struct seen {
	atomic_int times[PIECES];
	pthread_t thread[PIECES];
	int rounding[PIECES], interruptible[PIECES];
	atomic_int inside, most; /* pieces under way: now, and ever */
	int wait_for;		 /* so many have to be under way at once before any ends; 0: none */
};

static void look(void *job, size_t piece)
{
	struct seen *s = job;
	sigset_t blocked;
	int now = ++s->inside, most = s->most;

	while (most < now && !atomic_compare_exchange_weak(&s->most, &most, now))
		;
	while (s->most < s->wait_for)
		sched_yield();
	pthread_sigmask(SIG_SETMASK, NULL, &blocked);
	s->times[piece]++;
	s->thread[piece] = pthread_self();
	s->rounding[piece] = fegetround();
	s->interruptible[piece] = !sigismember(&blocked, SIGINT);
	s->inside--;
}

static void assert_once(const struct seen *s, size_t count)
{
	for (size_t i = 0; i < PIECES; i++)
		ck_assert_msg(s->times[i] == (i < count), "piece %zu of %zu: %d times", i, count, s->times[i]);
}

/* By other threads than the caller's. */
static size_t count_helped(const struct seen *s, size_t count)
{
	size_t n = 0;

	for (size_t i = 0; i < count; i++)
		n += !pthread_equal(s->thread[i], pthread_self());
	return n;
}

START_TEST(each_piece_once)
{
	static const size_t counts[] = {0, 1, 2, 3, 7, 64, PIECES};
	static const unsigned threads[] = {0, 1, 2, 3, 100};
	struct workers *w = workers_open(TEAM);

	ck_assert_uint_eq(workers_limit(w), TEAM);
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
		for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
			struct seen s = {.wait_for = 0};

			workers_run(w, threads[t], look, &s, counts[c]);
			assert_once(&s, counts[c]);
			ck_assert_int_le(s.most, threads[t] < TEAM ? (int)threads[t] + !threads[t] : TEAM);
			if (threads[t] < 2 || counts[c] < 2)
				ck_assert_uint_eq(count_helped(&s, counts[c]), 0);
		}
	workers_close(w);
	ck_assert_int_eq(faults.started, TEAM - 1);
	ck_assert_int_eq(faults.joined, TEAM - 1);
}
END_TEST

/* Catches workers that do not come, that compute otherwise than the caller does now, or that take its signals; a job for
   which nobody comes would not end. */
START_TEST(workers_come)
{
	static const int modes[] = {FE_TONEAREST, FE_DOWNWARD};
	struct workers *w = workers_open(TEAM);

	for (int i = 0; i < 50; i++) {
		struct seen s = {.wait_for = TEAM};

		fesetround(modes[i % 2]);
		workers_run(w, TEAM, look, &s, 20);
		fesetround(FE_TONEAREST);
		assert_once(&s, 20);
		ck_assert_int_eq(s.most, TEAM);
		ck_assert_uint_ge(count_helped(&s, 20), TEAM - 1);
		for (int k = 0; k < 20; k++) {
			ck_assert_int_eq(s.rounding[k], modes[i % 2]);
			ck_assert_int_eq(s.interruptible[k], pthread_equal(s.thread[k], pthread_self()) != 0);
		}
		ck_assert_int_eq(faults.started, TEAM - 1);
	}
	workers_close(w);
}
END_TEST

static atomic_int held, released;

/* Does not end before it is let go. */
static void hold(void *job, size_t piece)
{
	(void)job, (void)piece;
	held++;
	while (!released)
		sched_yield();
}

static void *run_held(void *w)
{
	workers_run(w, 2, hold, NULL, 20);
	return NULL;
}

/* Catches a worker that joins a job which has as many threads as it may have: two hold on to theirs, so that another job
   needs the third. */
START_TEST(fewer_than_there_are)
{
	struct workers *w = workers_open(TEAM);
	struct seen all = {.wait_for = TEAM}, two = {.wait_for = 2};
	pthread_t other;

	workers_run(w, TEAM, look, &all, 20);
	ck_assert_int_eq(pthread_create(&other, NULL, run_held, w), 0);
	while (held < 2)
		sched_yield();
	workers_run(w, TEAM, look, &two, 20);
	assert_once(&two, 20);
	ck_assert_int_eq(two.most, 2);
	ck_assert_int_eq(held, 2);
	released = 1;
	pthread_join(other, NULL);
	workers_close(w);
}
END_TEST

START_TEST(no_thread_can_be_started)
{
	struct workers *w = workers_open(TEAM);
	struct seen s = {.wait_for = 0}, later = {.wait_for = TEAM};

	faults.no_thread = EAGAIN;
	workers_run(w, TEAM, look, &s, PIECES);
	assert_once(&s, PIECES);
	ck_assert_uint_eq(count_helped(&s, PIECES), 0);
	faults.no_thread = 0;
	workers_run(w, TEAM, look, &later, 20);
	assert_once(&later, 20);
	workers_close(w);
	ck_assert_int_eq(faults.joined, TEAM - 1);
}
END_TEST

START_TEST(no_memory)
{
	struct workers *w;

	faults.allocations = _i;
	w = workers_open(TEAM);
	faults.allocations = -1;
	ck_assert_msg((w == NULL) == faults.allocation_failed, "allocation %d", _i);
	workers_close(w);
}
END_TEST

/* A forked process has none of the threads, and does the whole alone; the first goes on as before. */
START_TEST(forked)
{
	struct workers *w = workers_open(TEAM);
	struct seen before = {.wait_for = TEAM}, after = {.wait_for = TEAM};
	int status;
	pid_t pid;

	workers_run(w, TEAM, look, &before, 20);
	if ((pid = fork()) == 0) {
		static struct seen s;

		workers_run(w, TEAM, look, &s, PIECES);
		status = count_helped(&s, PIECES) != 0 || s.most != 1;
		for (int i = 0; i < PIECES; i++)
			status |= s.times[i] != 1;
		workers_close(w);
		_exit(status);
	}
	ck_assert_int_eq(waitpid(pid, &status, 0), pid);
	ck_assert_int_eq(status, 0);
	workers_run(w, TEAM, look, &after, 20);
	assert_once(&after, 20);
	workers_close(w);
}
END_TEST

struct caller {
	struct workers *w;
	int bad;
};

static void *run_often(void *argument)
{
	struct caller *c = argument;

	for (int i = 0; i < 300; i++) {
		struct seen s = {.wait_for = 0};
		size_t count = (size_t)(i % 50);

		workers_run(c->w, 1 + (unsigned)i % (TEAM + 1), look, &s, count);
		for (size_t k = 0; k < PIECES; k++)
			c->bad += s.times[k] != (k < count);
	}
	return NULL;
}

/* Several callers share the workers. */
START_TEST(several_callers)
{
	struct caller callers[6];
	pthread_t threads[6];
	struct workers *w = workers_open(TEAM);

	for (int i = 0; i < 6; i++) {
		callers[i] = (struct caller){w, 0};
		ck_assert_int_eq(pthread_create(&threads[i], NULL, run_often, &callers[i]), 0);
	}
	for (int i = 0; i < 6; i++) {
		pthread_join(threads[i], NULL);
		ck_assert_int_eq(callers[i].bad, 0);
	}
	workers_close(w);
	ck_assert_int_le(faults.started, 6 + TEAM - 1);
	ck_assert_int_eq(faults.started, faults.joined);
}
END_TEST

static pthread_mutex_t both = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t arrived = PTHREAD_COND_INITIALIZER;
static int callers_inside;

/* Ends when two callers are at their jobs. */
static void meet(void *job, size_t piece)
{
	(void)job, (void)piece;
	pthread_mutex_lock(&both);
	callers_inside++;
	pthread_cond_broadcast(&arrived);
	while (callers_inside < 2)
		pthread_cond_wait(&arrived, &both);
	pthread_mutex_unlock(&both);
}

static void *run_meeting(void *w)
{
	workers_run(w, 1, meet, NULL, 1);
	return NULL;
}

/* Catches a caller that waits until another's job is done. */
START_TEST(callers_do_not_wait)
{
	struct workers *w = workers_open(TEAM);
	pthread_t other;

	ck_assert_int_eq(pthread_create(&other, NULL, run_meeting, w), 0);
	workers_run(w, 1, meet, NULL, 1);
	pthread_join(other, NULL);
	workers_close(w);
}
END_TEST

Suite *suite_workers(void)
{
	Suite *s = suite_create("workers");
	TCase *t = tcase_create("workers");

	tcase_set_timeout(t, 300);
	tcase_add_test(t, each_piece_once);
	tcase_add_test(t, workers_come);
	tcase_add_test(t, fewer_than_there_are);
	tcase_add_test(t, no_thread_can_be_started);
	tcase_add_loop_test(t, no_memory, 0, 3);
	tcase_add_test(t, forked);
	tcase_add_test(t, several_callers);
	tcase_add_test(t, callers_do_not_wait);
	suite_add_tcase(s, t);
	return s;
}
