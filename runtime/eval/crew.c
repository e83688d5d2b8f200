#define _POSIX_C_SOURCE 200809L
#include "eval/crew.h"
#include "core/seconds.h"
#include "eval/slices.h"
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

/* Nanoseconds between two looks at how far all are; seconds between two records, and how much longer than writing one took. */
enum { LOOK = 50000000, RECORD_RATIO = 10 };
#define RECORD 1.0

/* A track and its thread; what changes is under the crew's lock. */
struct runner {
	struct crew *crew;
	struct eval_track track;
	struct rneagen_error error;
	pthread_t thread;
	size_t number;      /* among those of this rank */
	uint64_t next;      /* the first sample of the slice that is under way; at the end the number of samples */
	uint64_t done;      /* samples */
	int is_started, has_ended;
};

struct crew {
	const struct eval_crew *c;
	struct runner *runners;
	size_t count;  /* of them: c->count, or 0 where there is no memory for them */
	uint64_t track; /* the first of this rank */
	struct slices slices;
	pthread_mutex_t lock;
	pthread_cond_t ended; /* a track has */
	int stops;
	double recorded, took; /* when a record was begun, and how long it took */
};

/* What each rank tells the others. */
struct pulse {
	uint64_t done, whole, busy; /* samples; those that are all written; tracks */
	uint64_t failed, syncs;     /* 1: it has; the first rank wants what is written to be on the disk */
};

_Static_assert(sizeof(struct pulse) <= RANKS_ROOM, "ranks have room for it");

/* ---- tracks ---- */

static enum rneagen_code open_track(struct runner *h)
{
	const struct crew *w = h->crew;
	struct rnea_options o = w->c->open;
	struct rnea_error error;

	h->track.robot = w->c->robot;
	o.device = w->c->devices[h->number];
	if (h->number && rnea_open(w->c->text, strlen(w->c->text), &o, &h->track.robot, &error))
		return error_set(&h->error, RNEAGEN_UNSUPPORTED, "%s", error.message);
	return eval_track_open(&h->track, w->c->arrays, w->slices.size, &h->error);
}

/* Is there another slice, now that `count` samples of the one before are done? */
static int go_on(struct runner *h, size_t count)
{
	struct crew *w = h->crew;
	int more;

	pthread_mutex_lock(&w->lock);
	if (count) {
		h->done += count;
		h->next = slices_next(&w->slices, h->next);
	}
	more = !w->stops && h->next < w->slices.end;
	pthread_mutex_unlock(&w->lock);
	return more;
}

static void *work(void *argument)
{
	struct runner *h = argument;
	struct crew *w = h->crew;
	size_t count = 0;

	if (go_on(h, 0) && !open_track(h))
		while (go_on(h, count)) {
			count = slices_count(&w->slices, h->next);
			if (eval_track_do(&h->track, h->next, count, &h->error))
				break;
		}
	pthread_mutex_lock(&w->lock);
	h->has_ended = 1;
	pthread_cond_signal(&w->ended);
	pthread_mutex_unlock(&w->lock);
	return NULL;
}

/* Signals are for the thread of the command. */
static void start(struct crew *w)
{
	sigset_t all, before;

	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	for (size_t i = 0; i < w->count; i++) {
		struct runner *h = &w->runners[i];

		h->crew = w;
		h->number = i;
		h->next = slices_begin(&w->slices, w->track + i);
		h->is_started = pthread_create(&h->thread, NULL, work, h) == 0;
		if (!h->is_started) {
			error_set(&h->error, RNEAGEN_MEMORY, "no thread for device %d", w->c->devices[i]);
			h->has_ended = 1;
		}
	}
	pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static void end(struct crew *w)
{
	pthread_mutex_lock(&w->lock);
	w->stops = 1;
	pthread_mutex_unlock(&w->lock);
	for (size_t i = 0; i < w->count; i++) {
		struct runner *h = &w->runners[i];

		if (h->is_started)
			pthread_join(h->thread, NULL);
		if (i)
			rnea_close(h->track.robot);
		eval_track_close(&h->track);
	}
}

/* ---- the command's own thread ---- */

/* Till a track of this rank ends, or it is time to look. */
static void wait_a_while(struct crew *w)
{
	struct timespec till;
	size_t ended = 0;

	clock_gettime(CLOCK_MONOTONIC, &till);
	till.tv_nsec += LOOK;
	till.tv_sec += till.tv_nsec / 1000000000;
	till.tv_nsec %= 1000000000;
	pthread_mutex_lock(&w->lock);
	for (size_t i = 0; i < w->count; i++)
		ended += (size_t)w->runners[i].has_ended;
	if (ended < w->count)
		pthread_cond_timedwait(&w->ended, &w->lock, &till);
	pthread_mutex_unlock(&w->lock);
}

static struct pulse look(struct crew *w, const struct rneagen_error *e)
{
	struct pulse p = {.whole = w->count ? w->c->samples : w->c->first, .failed = e->code != RNEAGEN_OK};

	pthread_mutex_lock(&w->lock);
	for (size_t i = 0; i < w->count; i++) {
		const struct runner *h = &w->runners[i];

		p.done += h->done;
		p.busy += !h->has_ended;
		p.failed |= h->has_ended && h->error.code;
		p.whole = h->next < p.whole ? h->next : p.whole;
	}
	pthread_mutex_unlock(&w->lock);
	return p;
}

/* What all ranks are at; in `syncs` what the first one wants. */
static struct pulse look_at_all(struct crew *w, struct pulse mine)
{
	const struct pulse *all = w->c->ranks->room;
	struct pulse sum = {.whole = UINT64_MAX};

	ranks_gather(w->c->ranks, &mine, sizeof mine, w->c->ranks->room);
	for (size_t i = 0; i < w->c->ranks->count; i++) {
		sum.done += all[i].done;
		sum.busy += all[i].busy;
		sum.failed |= all[i].failed;
		sum.whole = all[i].whole < sum.whole ? all[i].whole : sum.whole;
	}
	sum.syncs = all[0].syncs;
	return sum;
}

/* A record is of what all had written at the look before the last: since then each has brought its own to the disk. */
static void record(struct crew *w, const struct pulse *before)
{
	if (!before->syncs || w->c->ranks->index)
		return;
	w->c->record(w->c->own, before->whole);
	w->took = seconds_now() - w->recorded;
}

static int is_time_to_record(struct crew *w)
{
	double now = seconds_now(), since = now - w->recorded;

	if (!w->c->record || w->c->ranks->index || since < RECORD || since < RECORD_RATIO * w->took)
		return 0;
	w->recorded = now;
	return 1;
}

static struct pulse watch(struct crew *w, struct rneagen_error *e)
{
	struct pulse sum = {0}, before;

	w->recorded = seconds_now();
	do {
		struct pulse mine;

		wait_a_while(w);
		mine = look(w, e);
		mine.syncs = (uint64_t)is_time_to_record(w);
		before = sum;
		sum = look_at_all(w, mine);
		if (!sum.failed)
			record(w, &before);
		if (sum.syncs)
			eval_sync(w->c->arrays, e);
		if (!w->c->ranks->index)
			w->c->show(w->c->own, sum.done);
	} while (sum.busy && !sum.failed);
	return sum;
}

/* What is complete when a run ends early, where that is of use. */
static void record_end(struct crew *w, struct rneagen_error *e)
{
	struct rneagen_error synced = {0};
	struct pulse last;
	int records = w->c->record != NULL;

	if (!ranks_tell(w->c->ranks, (uint64_t)records))
		return;
	last = look(w, e);
	eval_sync(w->c->arrays, &synced);
	last.failed = synced.code != RNEAGEN_OK;
	last = look_at_all(w, last);
	if (!last.failed && !w->c->ranks->index)
		w->c->record(w->c->own, last.whole);
}

/* Number the tracks of all ranks; plan their slices. */
static void plan(struct crew *w)
{
	const uint64_t *all = w->c->ranks->room;
	uint64_t mine = w->count, tracks = 0;

	ranks_gather(w->c->ranks, &mine, sizeof mine, w->c->ranks->room);
	for (size_t i = 0; i < w->c->ranks->count; i++) {
		w->track += i < w->c->ranks->index ? all[i] : 0;
		tracks += all[i];
	}
	w->slices = slices_plan(w->c->first, w->c->samples, tracks ? tracks : 1, w->c->slice, eval_track_slice(w->c->arrays));
}

/* A rank that fails here goes on without tracks: the others wait to hear of it. */
static void make(struct crew *w, struct rneagen_error *e)
{
	pthread_condattr_t monotonic;

	pthread_mutex_init(&w->lock, NULL);
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&w->ended, &monotonic);
	pthread_condattr_destroy(&monotonic);
	w->runners = calloc(w->c->count, sizeof *w->runners);
	w->count = w->runners ? w->c->count : 0;
	if (!w->runners)
		error_memory(e);
}

int eval_crew_run(struct eval_crew *c, struct rneagen_error *e)
{
	struct crew w = {.c = c};
	struct pulse sum;

	make(&w, e);
	plan(&w);
	start(&w);
	sum = watch(&w, e);
	end(&w);
	if (sum.failed)
		record_end(&w, e);
	for (size_t i = 0; i < w.count; i++)
		if (w.runners[i].error.code)
			error_set(e, w.runners[i].error.code, "%s", w.runners[i].error.message);
	pthread_cond_destroy(&w.ended);
	pthread_mutex_destroy(&w.lock);
	free(w.runners);
	return !sum.failed;
}
