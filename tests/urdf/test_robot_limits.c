/* Where reading a robot ends: its limits, and memory. */
#include "test_robot.h"
#include <stdlib.h>

/* ---- just inside is read, one more is refused with its name ---- */

static void chain(struct text *t, int links)
{
	text_put(t, "<robot name='chain'><link name='l0'/>");
	for (int i = 1; i < links; i++)
		text_printf(t, "<link name='l%d'>" INERTIAL "</link><joint name='j%d' type='continuous'>"
			       "<parent link='l%d'/><child link='l%d'/></joint>", i, i, i - 1, i);
	text_put(t, "</robot>");
}

static void nested(struct text *t, int depth)
{
	text_put(t, "<robot name='deep'><link name='l'/>");
	for (int i = 1; i < depth; i++)
		text_put(t, "<a>");
	for (int i = 1; i < depth; i++)
		text_put(t, "</a>");
	text_put(t, "</robot>");
}

static void long_name(struct text *t, int bytes)
{
	text_put(t, "<robot name='r'><link name='");
	for (int i = 0; i < bytes; i++)
		text_put(t, "n");
	text_put(t, "'/></robot>");
}

static void large_file(struct text *t, int bytes)
{
	text_put(t, "<robot name='r'><link name='l'/></robot>");
	while (t->length < (size_t)bytes)
		text_put(t, "\n");
}

static const struct limit {
	void (*make)(struct text *t, int size);
	int most;
	const char *says;
} limits[] = {
	{chain, LIMIT_LINKS, "test:1: link 'l1024' is one too many"},
	{nested, LIMIT_XML_DEPTH, "test:1: elements are nested more than 100 deep"},
	{long_name, LIMIT_NAME_BYTES, "nnn...': the name is longer than 255 bytes"},
	{large_file, LIMIT_FILE_BYTES, "test: 16777217 bytes, and at most 16777216 are read"},
};

START_TEST(limit)
{
	const struct limit *l = &limits[_i];
	struct arena a;
	struct text t;
	struct read r;

	arena_init(&a, NULL);
	for (int over = 0; over < 2; over++) {
		text_init(&t, &a);
		l->make(&t, l->most + over);
		read_string(&r, text_string(&t));
		ck_assert_msg(r.error.code == (over ? RNEAGEN_LIMIT : RNEAGEN_OK), "%s", r.error.message);
		ck_assert_msg(!over || strstr(r.error.message, l->says), "%s", r.error.message);
		read_free(&r);
	}
	arena_free(&a);
}
END_TEST

/* ---- memory ---- */

/* An allocator that gives `left` blocks and then none. */
struct ration {
	int left;
};

static void *ration_alloc(void *context, size_t size)
{
	struct ration *r = context;

	return r->left-- > 0 ? malloc(size) : NULL;
}

static void ration_release(void *context, void *block)
{
	(void)context;
	free(block);
}

/* Read with so many blocks; the first `used` bytes are taken. */
static enum rneagen_code read_rationed(const char *xml, int blocks, size_t used)
{
	struct ration ration = {blocks};
	const struct rneagen_allocator allocator = {ration_alloc, ration_release, &ration};
	struct rneagen_error e = {0};
	struct robot robot;
	struct arena a;

	arena_init(&a, &allocator);
	if (used)
		arena_alloc(&a, used, 1);
	robot_read(&robot, xml, strlen(xml), "test", &a, &e);
	ck_assert_msg(e.code == RNEAGEN_OK || e.code == RNEAGEN_MEMORY, "%s", e.message);
	ck_assert_str_eq(e.message, e.code ? "out of memory" : "");
	arena_free(&a);
	return e.code;
}

/* The k-th block is refused, for every k until all are given. */
START_TEST(memory_runs_out_by_blocks)
{
	struct arena a;
	struct text t;
	int blocks = 0;

	arena_init(&a, NULL);
	text_init(&t, &a);
	chain(&t, 1000);
	while (read_rationed(text_string(&t), blocks, 0))
		blocks++;
	ck_assert_int_ge(blocks, 10);
	arena_free(&a);
}
END_TEST

/* Every single allocation fails once: there is one block, and less and less of it is used up beforehand. */
START_TEST(memory_runs_out_by_bytes)
{
	const char *xml = ROBOT("<joint name='j' type='revolute'>" ENDS("base", "arm") ORIGIN LIMIT
				"<axis xyz='0 0 2'/><origin/><mimic joint='k'/></joint><link name='hand'/>"
				"<joint name='k' type='continuous'>" ENDS("arm", "hand") "</joint>");
	size_t used = 65536 - 16, failures = 0;

	for (; used > 16 && read_rationed(xml, 1, used); used -= 16)
		failures++;
	ck_assert_uint_ge(failures, 100);
	ck_assert_uint_gt(used, 16);
}
END_TEST

TCase *case_limits(void)
{
	TCase *tc = tcase_create("limits");

	tcase_set_timeout(tc, 120);
	tcase_add_loop_test(tc, limit, 0, sizeof limits / sizeof *limits);
	tcase_add_test(tc, memory_runs_out_by_blocks);
	tcase_add_test(tc, memory_runs_out_by_bytes);
	return tc;
}
