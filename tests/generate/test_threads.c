/* Eight threads generate at the same time, from good and from bad files with different options; each result is the one
   that a single thread gets. Worth most under the thread sanitizer (preset tsan). */
#define _POSIX_C_SOURCE 200809L
#include "cli/files.h"
#include "support/exhaustive.h"
#include "support/read.h"
#include "rneagen.h"
#include "support/suite.h"
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THREADS = 8 };
#define CALLS (exhaustive() || sanitized() ? 100 : 41) /* of each */

/* One call, and what a single thread got from it. */
struct job {
	struct file_content urdf;
	struct rneagen_options options;
	enum rneagen_code code;
	struct rneagen_result result;
	struct rneagen_error error;
};

static struct job *good, *bad;
static int good_count, bad_count;

/* One after the other: all targets, precisions, layouts, bases and dumps. */
static struct rneagen_options options_of(int index, const char *file)
{
	struct rneagen_options o = rneagen_options_default();

	o.target = (enum rneagen_target)(index % 3);
	o.precision = (enum rneagen_precision)(index / 3 % 4);
	o.trig = (enum rneagen_trig)(index / 2 % 3);
	o.layout = (enum rneagen_layout)(index % 2);
	o.base = (enum rneagen_base)(index / 2 % 2);
	o.dump = (enum rneagen_dump)(index % 7 < 5 ? 0 : 1 + index / 7 % RNEAGEN_DUMP_PASSES);
	o.file = file;
	o.tell = RNEAGEN_TELL_ALL;
	return o;
}

static struct job *read_jobs(const char *directory, char **names, int count)
{
	struct job *jobs = calloc((size_t)count, sizeof *jobs);

	ck_assert_ptr_nonnull(jobs);
	for (int i = 0; i < count; i++) {
		struct job *j = &jobs[i];
		char path[1024];

		snprintf(path, sizeof path, "%s/%s", directory, names[i]);
		ck_assert_msg(file_read(path, &j->urdf, &j->error) == RNEAGEN_OK, "%s", j->error.message);
		j->options = options_of(i, names[i]);
		j->code = rneagen_generate(j->urdf.bytes, j->urdf.length, &j->options, &j->result, &j->error);
	}
	return jobs;
}

static void free_jobs(struct job *jobs, int count)
{
	for (int i = 0; i < count; i++) {
		if (jobs[i].code == RNEAGEN_OK)
			rneagen_result_free(&jobs[i].result);
		free(jobs[i].urdf.bytes);
	}
	free(jobs);
}

static int differ(const char *a, const char *b)
{
	return (a && b) ? strcmp(a, b) != 0 : a != b;
}

static int results_differ(const struct rneagen_result *a, const struct rneagen_result *b)
{
	if (a->warning_count != b->warning_count)
		return 1;
	for (size_t i = 0; i < a->warning_count; i++)
		if (differ(a->warnings[i], b->warnings[i]))
			return 1;
	return differ(a->name, b->name) || differ(a->source, b->source) || differ(a->header, b->header) ||
	       differ(a->info, b->info) || differ(a->info_json, b->info_json) || differ(a->dot, b->dot) ||
	       differ(a->dump, b->dump);
}

/* 1 if the call gives anything else than it gave before. */
static int repeat(const struct job *j)
{
	struct rneagen_result r;
	struct rneagen_error e;
	int wrong;

	if (rneagen_generate(j->urdf.bytes, j->urdf.length, &j->options, &r, &e) != j->code)
		wrong = 1;
	else
		wrong = differ(e.message, j->error.message) || results_differ(&r, &j->result);
	if (e.code == RNEAGEN_OK)
		rneagen_result_free(&r);
	return wrong;
}

struct worker {
	pthread_t thread;
	int number, wrong;
};

static void *work(void *argument)
{
	struct worker *w = argument;

	for (int i = 0; i < CALLS; i++) {
		int k = w->number * CALLS + i;

		w->wrong += repeat(i % 2 ? &bad[k % bad_count] : &good[k % good_count]);
	}
	return NULL;
}

START_TEST(threads_get_what_one_gets)
{
	char **good_names = names_list(TEST_DIR "/robots", &good_count),
	     **bad_names = names_list(TEST_DIR "/bad", &bad_count);
	struct worker workers[THREADS];

	good = read_jobs(TEST_DIR "/robots", good_names, good_count);
	bad = read_jobs(TEST_DIR "/bad", bad_names, bad_count);
	for (int t = 0; t < THREADS; t++) {
		workers[t] = (struct worker){.number = t};
		ck_assert_int_eq(pthread_create(&workers[t].thread, NULL, work, &workers[t]), 0);
	}
	for (int t = 0; t < THREADS; t++) {
		pthread_join(workers[t].thread, NULL);
		ck_assert_msg(
			workers[t].wrong == 0, "thread %d: %d of %d results differ", t, workers[t].wrong, (int)CALLS);
	}
	free_jobs(good, good_count);
	free_jobs(bad, bad_count);
	names_free(good_names);
	names_free(bad_names);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("threads");
	TCase *tc = tcase_create("generate");

	tcase_set_timeout(tc, 500);
	tcase_add_test(tc, threads_get_what_one_gets);
	suite_add_tcase(suite, tc);
	return suite_run(suite);
}
