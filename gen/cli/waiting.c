#define _POSIX_C_SOURCE 200809L
#include "cli/waiting.h"
#include <signal.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static double seconds(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void clear(struct waiting *w)
{
	if (w->is_terminal && w->is_shown) {
		fputs("\r\033[K", stderr);
		fflush(stderr);
	}
	w->is_shown = 0;
}

static void show(struct waiting *w, double passed)
{
	const long s = (long)passed;

	fprintf(stderr, w->is_terminal ? "\r\033[K%s: %ld:%02ld, %s" : "%s: %ld:%02ld, %s\n", w->command, s / 60, s % 60, w->doing);
	fflush(stderr);
	w->is_shown = 1;
}

static void *tell(void *context)
{
	struct waiting *w = context;
	const double start = seconds();
	double next = start + (w->is_terminal ? 2 : 5);

	pthread_mutex_lock(&w->mutex);
	while (!w->is_over) {
		const time_t whole = (time_t)next;
		const struct timespec until = {.tv_sec = whole, .tv_nsec = (long)(1e9 * (next - (double)whole))};
		double now;

		pthread_cond_timedwait(&w->over, &w->mutex, &until);
		now = seconds();
		if (w->is_over || now < next)
			continue;
		if (w->doing)
			show(w, now - start);
		next = now + (w->is_terminal ? 1 : now - start < 50 ? 5 : (now - start) / 10);
	}
	pthread_mutex_unlock(&w->mutex);
	return NULL;
}

void waiting_begin(struct waiting *w, const char *command, int quiet)
{
	pthread_condattr_t clock;
	sigset_t all, before;

	*w = (struct waiting){.command = command, .doing = "the URDF", .is_terminal = isatty(STDERR_FILENO)};
	if (quiet)
		return;
	pthread_condattr_init(&clock);
	pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
	pthread_mutex_init(&w->mutex, NULL);
	pthread_cond_init(&w->over, &clock);
	pthread_condattr_destroy(&clock);
	sigfillset(&all); /* who writes files blocks signals in one thread; this one would take them */
	pthread_sigmask(SIG_SETMASK, &all, &before);
	w->is_begun = !pthread_create(&w->thread, NULL, tell, w);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void waiting_for(void *context, const char *doing)
{
	struct waiting *w = context;

	if (!w->is_begun)
		return;
	pthread_mutex_lock(&w->mutex);
	w->doing = doing;
	if (!doing)
		clear(w);
	pthread_mutex_unlock(&w->mutex);
}

void waiting_end(struct waiting *w)
{
	if (!w->is_begun)
		return;
	pthread_mutex_lock(&w->mutex);
	w->is_over = 1;
	pthread_cond_signal(&w->over);
	pthread_mutex_unlock(&w->mutex);
	pthread_join(w->thread, NULL);
	pthread_cond_destroy(&w->over);
	pthread_mutex_destroy(&w->mutex);
	clear(w);
	w->is_begun = 0;
}
