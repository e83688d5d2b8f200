/* The plan of slices: each sample is in one slice of one track, slices are no longer than asked, tracks have about as
   much to do; also where numbers have 64 bits. It would catch a sample that is left out at the end, and a product that
   overflows. */
#include "eval/slices.h"
#include "support/rng.h"
#include "support/suite.h"
#include <stdio.h>
#include <time.h>

enum { SAMPLES = 4000, TRIALS = 1000 };

/* Is every sample taken once, in slices of at most `most`? */
static int covers(const struct slices *s, size_t most)
{
	unsigned char seen[SAMPLES] = {0};
	int good = 1;

	for (uint64_t track = 0; track < s->tracks; track++)
		for (uint64_t at = slices_begin(s, track); at < s->end; at = slices_next(s, at)) {
			size_t count = slices_count(s, at);

			good &= count >= 1 && count <= most && at + count <= s->end;
			for (size_t i = 0; good && i < count; i++)
				seen[at + i]++;
		}
	for (uint64_t i = 0; i < s->end; i++)
		good &= seen[i] == (i >= s->first);
	return good;
}

START_TEST(test_covers)
{
	uint64_t seed = (uint64_t)time(NULL);
	struct rng r = rng_seed(seed);

	printf("seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < TRIALS; i++) {
		uint64_t end = (uint64_t)rng_below(&r, SAMPLES + 1), first = (uint64_t)rng_below(&r, (int)end + 1);
		size_t most = 1 + (size_t)rng_below(&r, 300), size = rng_chance(&r, 0.5) ? most : 0;
		struct slices s = slices_plan(first, end, 1 + (uint64_t)rng_below(&r, 20), size, most);

		ck_assert_msg(covers(&s, most), "%llu to %llu by %llu tracks, slices of %zu of at most %zu",
			(unsigned long long)first, (unsigned long long)end, (unsigned long long)s.tracks, s.size, most);
	}
}
END_TEST

/* Where the size is not given every track has a slice in each round, but for rounding: no track has more than its share. */
START_TEST(test_balance)
{
	for (uint64_t tracks = 1; tracks < 9; tracks++)
		for (uint64_t samples = tracks; samples < 700; samples += 1 + samples / 10) {
			struct slices s = slices_plan(0, samples, tracks, 0, 50);
			uint64_t slices = samples / s.size + (samples % s.size != 0),
				rounds = (samples + 50 * tracks - 1) / (50 * tracks);

			ck_assert_uint_le(slices, rounds * tracks);
			ck_assert_uint_ge(s.size * rounds * tracks, samples);
		}
}
END_TEST

/* 2^60 samples from 2^59 on, 4096 tracks: the first and the last slices. */
START_TEST(test_wide)
{
	uint64_t end = UINT64_C(1) << 60, first = UINT64_C(1) << 59;
	struct slices s = slices_plan(first, end, 4096, 1 << 30, 1);
	uint64_t last = slices_begin(&s, 4095), stride = UINT64_C(4096) << 30;

	ck_assert_uint_eq(last, first + (UINT64_C(4095) << 30));
	ck_assert_uint_eq(slices_next(&s, last), last + stride);
	ck_assert_uint_eq(slices_next(&s, end - stride + 1), end);
	ck_assert_uint_eq(slices_next(&s, end - 1), end);
	ck_assert_uint_eq(slices_count(&s, end - 1), 1);
	ck_assert_uint_eq(slices_plan(0, end, 3, 0, 1 << 20).size, 1 << 20);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("slices");
	TCase *c = tcase_create("slices");

	tcase_add_test(c, test_covers);
	tcase_add_test(c, test_balance);
	tcase_add_test(c, test_wide);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
