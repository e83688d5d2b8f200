/* Scenes drawn by a grammar, as the fuzzer draws them (scene_trial.h): most are accepted, with every word among them, and
   generated to the end; the command at the head of every other text makes the same text again. */
#include "support/rng.h"
#include "scene/scene.h"
#include "fuzzing/scene_trial.h"
#include "support/suite.h"
#include <stdio.h>
#include <string.h>

enum { TRIALS = 500, BYTES = 160 };

/* Is the word at the beginning of a line, as a file or the command writes it? */
static int has_word(const char *scene, const char *word)
{
	size_t n = strlen(word);

	for (const char *s = scene; s; s = strchr(s, '\n')) {
		s += *s == '\n';
		s += strncmp(s, "--", 2) ? 0 : 2;
		if (!strncmp(s, word, n) && (!s[n] || strchr(" \t\r\n", s[n])))
			return 1;
	}
	return 0;
}

START_TEST(drawn)
{
	const uint64_t seed = 20261203;
	int accepted[2] = {0}, count[2] = {0}, words[SCENE_KEY_COUNT] = {0}, wordy = 0;
	struct rng rng = rng_seed(seed);

	scene_trial_open();
	for (int k = 0; k < TRIALS; k++) {
		struct trial_result t;
		uint8_t bytes[BYTES];

		for (int i = 0; i < BYTES; i++)
			bytes[i] = (uint8_t)rng_below(&rng, 256);
		scene_trial(bytes, sizeof bytes, &t);
		count[t.garbled]++;
		accepted[t.garbled] += t.outcome == TRIAL_ACCEPTED;
		if (t.outcome == TRIAL_ACCEPTED)
			for (int key = 0; key < SCENE_KEY_COUNT; key++)
				words[key] += has_word(t.scene, scene_word((enum scene_key)key));
	}
	scene_trial_close();
	for (int key = 0; key < SCENE_KEY_COUNT; key++)
		wordy += words[key] > 0;
	printf("seed %llu: %d of %d scenes accepted, %d of %d that were garbled; %d of %d words\n", (unsigned long long)seed,
		accepted[0], count[0], accepted[1], count[1], wordy, SCENE_KEY_COUNT);
	ck_assert_int_gt(accepted[0] * 4, count[0] * 3);
	ck_assert_int_lt(accepted[1], count[1]);
	ck_assert_int_eq(wordy, SCENE_KEY_COUNT);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("scenes drawn");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "drawn", drawn, 1, 300);
	return suite_run(suite);
}
