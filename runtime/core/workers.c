/* sched_getaffinity, CPU_COUNT */
#define _GNU_SOURCE
#include "core/workers.h"
#include <fenv.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

/* A job, on the stack of the thread that has it done. */
struct job {
	workers_piece *piece;
	void *context;
	size_t count;
	atomic_size_t next;  /* piece that nobody has taken */
	fenv_t environment;  /* of the caller's arithmetic */
	unsigned room;	     /* workers that may still join; the rest is under the lock, as this is */
	unsigned inside;     /* workers that are at it */
	struct job *after;   /* in the queue of jobs with room */
};

struct workers {
	pthread_mutex_t lock;
	pthread_cond_t more, less; /* there is a job with room, or the end has come; the last worker has left a job */
	struct job *queue;
	pthread_t *threads;
	unsigned limit, started; /* with one caller; without */
	int ending;
	pid_t process; /* that opened this */
};

/* ---- jobs ---- */

static void take_pieces(struct job *j)
{
	for (size_t i; (i = atomic_fetch_add_explicit(&j->next, 1, memory_order_relaxed)) < j->count;)
		j->piece(j->context, i);
}

static void append(struct workers *w, struct job *j)
{
	struct job **at = &w->queue;

	while (*at)
		at = &(*at)->after;
	*at = j;
}

/* Nobody is to join any more. */
static void take_out(struct workers *w, const struct job *j)
{
	struct job **at = &w->queue;

	while (*at && *at != j)
		at = &(*at)->after;
	if (*at)
		*at = j->after;
}

/* ---- workers ---- */

/* Two at most: who joins wakes two others, so that a hundred are up after seven times the time that one takes, the caller
   does not spend it, and few are woken for what is soon done. */
static void wake(struct workers *w, unsigned room)
{
	for (unsigned i = 0; i < 2 && i < room; i++)
		pthread_cond_signal(&w->more);
}

/* Take part in the first job that has room. Under the lock, but for the work. */
static void help(struct workers *w)
{
	struct job *j = w->queue;
	unsigned room;

	j->inside++;
	if (--j->room == 0)
		take_out(w, j);
	room = w->queue ? w->queue->room : 0;
	pthread_mutex_unlock(&w->lock);
	wake(w, room);
	fesetenv(&j->environment);
	take_pieces(j);
	pthread_mutex_lock(&w->lock);
	take_out(w, j);
	if (--j->inside == 0)
		pthread_cond_broadcast(&w->less);
}

static void *work(void *argument)
{
	struct workers *w = argument;

	pthread_mutex_lock(&w->lock);
	while (!w->ending)
		if (w->queue)
			help(w);
		else
			pthread_cond_wait(&w->more, &w->lock);
	pthread_mutex_unlock(&w->lock);
	return NULL;
}

/* Signals are for the program's own threads. As many as can be had. */
static void start(struct workers *w, unsigned wanted)
{
	sigset_t all, before;

	if (w->started >= wanted)
		return;
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	while (w->started < wanted && pthread_create(&w->threads[w->started], NULL, work, w) == 0)
		w->started++;
	pthread_sigmask(SIG_SETMASK, &before, NULL);
}

/* ---- the caller ---- */

static unsigned count_processors(void)
{
	long online = sysconf(_SC_NPROCESSORS_ONLN);
	cpu_set_t set;

	if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0)
		return (unsigned)CPU_COUNT(&set);
	return online > 0 ? (unsigned)online : 1; /* more than the set has room for */
}

/* More threads than a few for each processor serve nobody. */
static unsigned choose_limit(unsigned wanted)
{
	unsigned processors = count_processors();

	if (!wanted)
		return processors;
	return wanted / 4 < processors ? wanted : 4 * processors;
}

struct workers *workers_open(unsigned threads)
{
	struct workers *w = calloc(1, sizeof *w);

	if (!w)
		return NULL;
	w->limit = choose_limit(threads);
	w->process = getpid();
	if ((w->threads = calloc(w->limit, sizeof *w->threads)) == NULL) {
		free(w);
		return NULL;
	}
	pthread_mutex_init(&w->lock, NULL);
	pthread_cond_init(&w->more, NULL);
	pthread_cond_init(&w->less, NULL);
	return w;
}

static void end(struct workers *w)
{
	pthread_mutex_lock(&w->lock);
	w->ending = 1;
	pthread_cond_broadcast(&w->more);
	pthread_mutex_unlock(&w->lock);
	for (unsigned i = 0; i < w->started; i++)
		pthread_join(w->threads[i], NULL);
	pthread_mutex_destroy(&w->lock);
	pthread_cond_destroy(&w->more);
	pthread_cond_destroy(&w->less);
}

void workers_close(struct workers *w)
{
	if (!w)
		return;
	if (w->process == getpid())
		end(w);
	free(w->threads);
	free(w);
}

unsigned workers_limit(const struct workers *w)
{
	return w->limit;
}

/* How many workers may help. */
static unsigned count_helpers(const struct workers *w, unsigned threads, size_t count)
{
	unsigned most = threads < w->limit ? threads : w->limit;

	if (count < most)
		most = (unsigned)count;
	return most > 1 && w->process == getpid() ? most - 1 : 0;
}

void workers_run(struct workers *w, unsigned threads, workers_piece *piece, void *context, size_t count)
{
	unsigned room = count_helpers(w, threads, count);
	struct job j = {.piece = piece, .context = context, .count = count, .room = room};
	int state;

	atomic_init(&j.next, 0);
	if (!room) {
		take_pieces(&j);
		return;
	}
	fegetenv(&j.environment);
	pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &state);
	pthread_mutex_lock(&w->lock);
	start(w, room);
	append(w, &j);
	pthread_mutex_unlock(&w->lock);
	wake(w, room);
	take_pieces(&j);
	pthread_mutex_lock(&w->lock);
	take_out(w, &j);
	while (j.inside)
		pthread_cond_wait(&w->less, &w->lock);
	pthread_mutex_unlock(&w->lock);
	pthread_setcancelstate(state, NULL);
}
