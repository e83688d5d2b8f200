#include "base/arena.h"
#include "base/error.h"
#include "support/suite.h"
#include "base/text.h"
#include "test_escape.h"
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- error ---- */

START_TEST(every_code_has_a_text)
{
	for (int i = 0; i < RNEAGEN_ERROR_COUNT; i++) {
		ck_assert_uint_gt(strlen(rneagen_code_text((enum rneagen_code)i)), 0);
		for (int k = 0; k < i; k++)
			ck_assert_str_ne(
				rneagen_code_text((enum rneagen_code)i), rneagen_code_text((enum rneagen_code)k));
	}
	ck_assert_str_eq(rneagen_code_text(RNEAGEN_ERROR_COUNT), "unknown error");
	ck_assert_str_eq(rneagen_code_text((enum rneagen_code) - 1), "unknown error");
}
END_TEST

START_TEST(first_error_is_kept)
{
	struct rneagen_error e = {0};

	ck_assert_int_eq(error_set(&e, RNEAGEN_TREE, "link '%s': %d", "a\nb\x7f\t", 3), RNEAGEN_TREE);
	ck_assert_str_eq(e.message, "link 'a?b?\?': 3");
	ck_assert_int_eq(error_set(&e, RNEAGEN_XML, "later"), RNEAGEN_TREE);
	ck_assert_int_eq(error_memory(&e), RNEAGEN_TREE);
	ck_assert_str_eq(e.message, "link 'a?b?\?': 3");
}
END_TEST

START_TEST(long_message_is_cut)
{
	static char longer[2 * sizeof((struct rneagen_error *)0)->message];
	struct rneagen_error e = {0};

	memset(longer, 'x', sizeof longer - 1);
	error_set(&e, RNEAGEN_NAME, "%s", longer);
	ck_assert_uint_eq(strlen(e.message), sizeof e.message - 1);
}
END_TEST

/* What is wrong stands at the end, behind a name that may be long; characters stay whole. */
START_TEST(long_name_leaves_the_reason)
{
	struct rneagen_error e;
	char name[5000];

	for (int n = 700; n < 780; n++) {
		e.code = RNEAGEN_OK;
		for (int i = 0; i < n; i += 2)
			memcpy(name + i, "\xc3\xa4", 3);
		error_set(&e, RNEAGEN_READ, "x%s: cannot be read: File name too long", name);
		ck_assert_ptr_nonnull(strstr(e.message, "\xa4: cannot be read: File name too long"));
		/* half a character before the gap, or after it */
		ck_assert_ptr_null(strstr(e.message, "\xc3 "));
		ck_assert_ptr_null(strstr(e.message, " \xa4"));
		ck_assert_uint_lt(strlen(e.message), sizeof e.message);
	}
}
END_TEST

/* ---- arena ---- */

/* An allocator that gives `left` blocks of sane size and then none, and counts what is out. */
struct ration {
	int left, out;
};

static void *ration_alloc(void *context, size_t size)
{
	struct ration *r = context;
	void *p = r->left-- > 0 && size < SIZE_MAX / 4 ? malloc(size) : NULL;

	r->out += p != NULL;
	return p;
}

static void ration_release(void *context, void *block)
{
	((struct ration *)context)->out--;
	free(block);
}

static void arena_rationed(struct arena *a, struct ration *r, int left)
{
	*r = (struct ration){.left = left};
	arena_init(a, &(struct rneagen_allocator){ration_alloc, ration_release, r});
}

START_TEST(arena_gives_zeroed_aligned_memory)
{
	static const size_t sizes[] = {0, 1, 15, 16, 17, 1000, 65535, 65536, 1000000};
	struct ration ration;
	struct arena a;

	arena_rationed(&a, &ration, INT_MAX);
	for (int round = 0; round < 20; round++)
		for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
			unsigned char *p = arena_alloc(&a, sizes[i], 1);

			ck_assert_ptr_nonnull(p);
			ck_assert_uint_eq((uintptr_t)p % _Alignof(max_align_t), 0);
			ck_assert(!sizes[i] || (p[0] == 0 && !memcmp(p, p + 1, sizes[i] - 1)));
			memset(p, 0xff, sizes[i]);
		}
	ck_assert_int_eq(a.failed, 0);
	arena_free(&a);
	ck_assert_int_eq(ration.out, 0);
}
END_TEST

START_TEST(arena_refuses_what_size_t_cannot_hold)
{
	static const size_t requests[][2] = {{SIZE_MAX, 1}, {1, SIZE_MAX}, {SIZE_MAX / 2, 3}, {SIZE_MAX - 15, 1},
		{SIZE_MAX - 40, 1}, {SIZE_MAX, SIZE_MAX}};

	for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
		struct ration ration;
		struct arena a;

		arena_rationed(&a, &ration, INT_MAX);
		ck_assert_ptr_null(arena_alloc(&a, requests[i][0], requests[i][1]));
		ck_assert_int_eq(a.failed, 1);
		ck_assert_ptr_nonnull(arena_alloc(&a, 1, 1)); /* the arena is still good; the failure stays */
		ck_assert_int_eq(a.failed, 1);
		arena_free(&a);
	}
}
END_TEST

START_TEST(arena_strings)
{
	struct arena a;

	arena_init(&a, NULL);
	ck_assert_str_eq(arena_string(&a, "abcdef", 3), "abc");
	ck_assert_str_eq(arena_string(&a, "", 0), "");
	arena_free(&a);
}
END_TEST

START_TEST(arena_arrays_grow)
{
	struct arena a;
	size_t capacity = 0;
	int *v = NULL;

	arena_init(&a, NULL);
	for (int i = 0; i < 10000; i++) {
		v = arena_grow(&a, v, (size_t)i, &capacity, sizeof *v);
		ck_assert_ptr_nonnull(v);
		ck_assert_uint_gt(capacity, (size_t)i);
		v[i] = i;
	}
	for (int i = 0; i < 10000; i++)
		ck_assert_int_eq(v[i], i);
	arena_free(&a);
}
END_TEST

/* What grows gives back what it leaves; so does what is released, where it has a block of its own. */
START_TEST(arena_gives_back)
{
	struct ration ration;
	struct arena a;
	size_t capacity = 0;
	char(*v)[100000] = NULL, *small, *large[3];

	arena_rationed(&a, &ration, INT_MAX);
	small = arena_string(&a, "small", 5);
	for (size_t i = 0; i < 100; i++) {
		v = arena_grow(&a, v, i, &capacity, sizeof *v);
		memset(v[i], (int)i, sizeof *v);
	}
	ck_assert_int_eq(ration.out, 2);
	for (int i = 0; i < 100; i++)
		ck_assert(v[i][0] == (char)i && v[i][99999] == (char)i);
	for (int i = 0; i < 3; i++)
		large[i] = arena_take(&a, 1, 100000);
	arena_release(&a, NULL);
	arena_release(&a, small); /* shares its block */
	ck_assert_str_eq(small, "small");
	arena_release(&a, large[1]); /* neither the first nor the last block */
	arena_release(&a, large[2]);
	ck_assert_int_eq(ration.out, 3);
	memset(large[0], 'x', 100000);
	ck_assert_ptr_nonnull(arena_alloc(&a, 1, 16));
	ck_assert_int_eq(large[0][99999], 'x');
	arena_release(&a, v);
	arena_release(&a, large[0]);
	ck_assert(!a.failed);
	arena_free(&a);
	ck_assert_int_eq(ration.out, 0);
}
END_TEST

/* And small ones between them go on in the block that they share. */
START_TEST(large_ones_part_no_small_ones)
{
	struct ration ration;
	struct arena a;
	void *large[1000];

	arena_rationed(&a, &ration, INT_MAX);
	for (int i = 0; i < 1000; i++) {
		large[i] = arena_take(&a, 1, 70000);
		ck_assert_ptr_nonnull(arena_alloc(&a, 1, 16));
	}
	ck_assert_int_eq(ration.out, 1001);
	for (int i = 0; i < 1000; i++) {
		arena_release(&a, large[i]);
		ck_assert_ptr_nonnull(arena_alloc(&a, 1, 16));
	}
	ck_assert_int_eq(ration.out, 1);
	arena_free(&a);
	ck_assert_int_eq(ration.out, 0);
}
END_TEST

START_TEST(failed_growth_keeps_the_array)
{
	struct ration ration;
	struct arena a;
	size_t capacity = 0, count = 0;
	char(*v)[1000] = NULL, (*wider)[1000];

	arena_rationed(&a, &ration, 2);
	while ((wider = arena_grow(&a, v, count, &capacity, sizeof *v))) {
		v = wider;
		memset(v[count++], 'v', sizeof *v);
	}
	ck_assert_int_eq(a.failed, 1);
	ck_assert_uint_eq(count, capacity);
	ck_assert_uint_gt(count, 0);
	for (size_t i = 0; i < count; i++)
		ck_assert_int_eq(v[i][999], 'v');
	arena_free(&a);
	ck_assert_int_eq(ration.out, 0);
}
END_TEST

/* ---- text ---- */

START_TEST(text_grows)
{
	struct arena a;
	struct text t;

	arena_init(&a, NULL);
	text_init(&t, &a);
	ck_assert_str_eq(text_string(&t), "");
	for (int i = 0; i < 5000; i++) {
		text_put(&t, "ab");
		text_putc(&t, 'c');
		text_putn(&t, "defg", 1);
		text_printf(&t, "%04d", i);
	}
	ck_assert_uint_eq(t.length, 5000 * 8);
	ck_assert_uint_eq(strlen(text_string(&t)), t.length);
	ck_assert_int_eq(strncmp(text_string(&t), "abcd0000abcd0001", 16), 0);
	ck_assert_str_eq(text_string(&t) + 4999 * 8, "abcd4999");
	ck_assert_int_eq(t.failed, 0);
	arena_free(&a);
}
END_TEST

/* Cleared, it is empty, and begins again in the room it has. */
START_TEST(text_clears)
{
	struct arena a;
	struct text t;
	const char *s;

	arena_init(&a, NULL);
	text_init(&t, &a);
	text_clear(&t);
	ck_assert_str_eq(text_string(&t), "");
	text_printf(&t, "%s %d", "some", 7);
	s = text_string(&t);
	text_clear(&t);
	ck_assert_str_eq(text_string(&t), "");
	text_printf(&t, "%s", "other");
	ck_assert_ptr_eq(text_string(&t), s);
	ck_assert_str_eq(s, "other");
	arena_free(&a);
}
END_TEST

/* Into what room there is, and beyond it by as little as the NUL. */
START_TEST(text_prints_at_any_length)
{
	static char s[600];

	for (int first = 0; first < 520; first++) {
		struct arena a;
		struct text t;

		arena_init(&a, NULL);
		text_init(&t, &a);
		text_printf(&t, "%*s", first, "");
		text_printf(&t, "%s%d", "ab", 1234);
		snprintf(s, sizeof s, "%*sab1234", first, "");
		ck_assert_str_eq(text_string(&t), s);
		ck_assert_uint_eq(t.length, strlen(s));
		arena_free(&a);
	}
}
END_TEST

/* However long the first append, no byte is lost where the text moves, and the NUL has its place. */
START_TEST(text_grows_at_any_length)
{
	static char s[520];

	memset(s, 'x', sizeof s);
	for (size_t first = 0; first < sizeof s; first++) {
		struct arena a;
		struct text t;
		int room = 1;

		arena_init(&a, NULL);
		text_init(&t, &a);
		text_putn(&t, s, first);
		while (t.length < 1030) {
			text_putc(&t, 'y');
			room &= t.length < t.capacity;
		}
		ck_assert(room);
		ck_assert_uint_eq(strlen(text_string(&t)), 1030);
		ck_assert_uint_eq(strspn(text_string(&t), "x"), first);
		arena_free(&a);
	}
}
END_TEST

/* The k-th block is refused, for every k until all are given. */
START_TEST(text_failure_is_sticky)
{
	int k = 0, failed = 1;

	for (; failed; k++) {
		struct ration ration;
		struct arena a;
		struct text t;
		size_t before;

		arena_rationed(&a, &ration, k);
		text_init(&t, &a);
		for (int i = 0; i < 100000; i++)
			text_printf(&t, "%d ", i);
		failed = t.failed;
		ck_assert_int_eq(failed, a.failed);
		before = t.length;
		text_put(&t, "more");
		ck_assert_uint_eq(t.length, failed ? before : before + 4);
		ck_assert_uint_eq(strlen(text_string(&t)), t.length);
		arena_free(&a);
		ck_assert_int_eq(ration.out, 0);
	}
	ck_assert_int_ge(k, 4);
}
END_TEST

static Suite *text_suite(void)
{
	Suite *suite = suite_create("error, arena, text");
	TCase *tc = tcase_create("units");

	tcase_set_timeout(tc, 60);
	tcase_add_test(tc, every_code_has_a_text);
	tcase_add_test(tc, first_error_is_kept);
	tcase_add_test(tc, long_message_is_cut);
	tcase_add_test(tc, long_name_leaves_the_reason);
	tcase_add_test(tc, arena_gives_zeroed_aligned_memory);
	tcase_add_test(tc, arena_refuses_what_size_t_cannot_hold);
	tcase_add_test(tc, arena_strings);
	tcase_add_test(tc, arena_arrays_grow);
	tcase_add_test(tc, arena_gives_back);
	tcase_add_test(tc, large_ones_part_no_small_ones);
	tcase_add_test(tc, failed_growth_keeps_the_array);
	tcase_add_test(tc, text_grows);
	tcase_add_test(tc, text_clears);
	tcase_add_test(tc, text_prints_at_any_length);
	tcase_add_test(tc, text_grows_at_any_length);
	tcase_add_test(tc, text_failure_is_sticky);
	suite_add_tcase(suite, tc);
	suite_add_tcase(suite, escape_case());
	return suite;
}

int main(void)
{

	return suite_run(text_suite());
}
