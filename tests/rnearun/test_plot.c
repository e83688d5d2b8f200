/* The picture of rnearun report: where its names stand, over points that are drawn, and that equal rows give equal bytes. */
#include "cli/files.h"
#include "study/plot.h"
#include "study/plot_labels.h"
#include "support/rng.h"
#include "support/suite.h"
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEEDS = 300, POINTS = 24, WIDTH = 730, HEIGHT = 1000, LETTER = 7, HALF_LINE = 7 };

static const struct plot_line NO_LINES[1];
static int has_gnuplot;

struct box {
	double x0, y0, x1, y1;
};

static struct box box_of(const struct plot_label *l)
{
	double width = (double)(LETTER * strlen(l->text));

	return (struct box){l->ends_there ? l->at_x - width : l->at_x, l->at_y - HALF_LINE,
		l->ends_there ? l->at_x : l->at_x + width, l->at_y + HALF_LINE};
}

static int overlap(struct box a, struct box b)
{
	return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

/* Every precision at an error of its own, as in truth; every variant once. */
static size_t draw_points(uint64_t seed, struct study_row *rows, struct plot_point *points)
{
	struct rng rng = rng_seed(seed);
	size_t count = 0;

	for (int i = 0; i < POINTS; i++) {
		struct study_row *r = &rows[count];

		if (rng_below(&rng, 4) == 0)
			continue;
		*r = (struct study_row){.backend = RNEA_BACKEND_HOST, .precision = (enum rneagen_precision)(RNEAGEN_F32 + i / 6),
			.trig = (enum rneagen_trig)(i % 3), .layout = (enum rneagen_layout)(i / 3 % 2)};
		points[count] = (struct plot_point){.row = r, .x = 60 + 150 * (i / 6), .y = rng_uniform(&rng, 40, 940)};
		if (i % 3 && rng_below(&rng, 2) && count)
			points[count].y = points[count - 1].y + 5; /* in a cluster with the last, if that is of its precision */
		count++;
	}
	return count;
}

static int names(const struct plot_label *l, const struct study_row *r)
{
	static const char *const precisions[] = {[RNEAGEN_F32] = "f32 ", [RNEAGEN_F64] = "f64 ", [RNEAGEN_MIXED] = "mixed ",
		[RNEAGEN_F32X2] = "f32x2 "};
	static const char *const trigs[] = {"accurate", "bounded", "fast"}, *const layouts[] = {"soa", "aos"};

	return !strncmp(l->text, precisions[r->precision], strlen(precisions[r->precision])) && strstr(l->text, trigs[r->trig]) &&
		strstr(l->text, layouts[r->layout]);
}

/* Would catch a point without a name, names on each other or on points, and one beyond the frame. */
START_TEST(every_point_has_a_clear_name)
{
	int clear = 0;

	for (uint64_t seed = 0; seed < SEEDS; seed++) {
		struct study_row rows[POINTS];
		struct plot_point points[POINTS];
		struct plot_label labels[POINTS];
		size_t count = draw_points(seed, rows, points), n;

		if (!plot_place(labels, &n, points, count, NO_LINES, 0, WIDTH, HEIGHT))
			continue;
		clear++;
		for (size_t i = 0; i < n; i++) {
			struct box b = box_of(&labels[i]);

			ck_assert_msg(b.x0 >= 0 && b.y0 >= 0 && b.x1 <= WIDTH && b.y1 <= HEIGHT, "seed %d: %s",
				(int)seed, labels[i].text);
			for (size_t k = 0; k < i; k++)
				ck_assert_msg(!overlap(b, box_of(&labels[k])), "seed %d: %s", (int)seed, labels[i].text);
			for (size_t k = 0; k < count; k++)
				ck_assert_msg(!overlap(b,
					(struct box){points[k].x - 4, points[k].y - 4, points[k].x + 4, points[k].y + 4}),
					"seed %d: %s", (int)seed, labels[i].text);
		}
		for (size_t k = 0; k < count; k++) {
			int named = 0;

			for (size_t i = 0; i < n; i++)
				named |= names(&labels[i], &rows[k]);
			ck_assert_msg(named, "seed %d: point %d", (int)seed, (int)k);
		}
	}
	ck_assert_msg(clear >= SEEDS - SEEDS / 20, "%d of %d pictures have room for their names", clear, SEEDS);
}
END_TEST

static struct plot_label only_label(const struct study_row *rows, const double *y, size_t count)
{
	struct plot_point points[8];
	struct plot_label labels[8];
	size_t n;

	for (size_t i = 0; i < count; i++)
		points[i] = (struct plot_point){.row = &rows[i], .x = 300, .y = y[i]};
	ck_assert(plot_place(labels, &n, points, count, NO_LINES, 0, WIDTH, HEIGHT));
	ck_assert_uint_eq(n, 1);
	return labels[0];
}

START_TEST(a_cluster_has_one_name)
{
	const struct study_row rows[] = {{.precision = RNEAGEN_F32, .trig = RNEAGEN_ACCURATE, .layout = RNEAGEN_SOA},
		{.precision = RNEAGEN_F32, .trig = RNEAGEN_BOUNDED, .same = 1u << RNEAGEN_FAST, .layout = RNEAGEN_SOA},
		{.precision = RNEAGEN_F32, .trig = RNEAGEN_ACCURATE, .layout = RNEAGEN_AOS},
		{.precision = RNEAGEN_F32, .trig = RNEAGEN_BOUNDED, .same = 1u << RNEAGEN_FAST, .layout = RNEAGEN_AOS}};
	const double y[] = {100, 108, 124, 116}; /* the third is near the last alone */

	ck_assert_str_eq(only_label(rows, y, 1).text, "f32 accurate soa");
	ck_assert_str_eq(only_label(rows + 1, y, 1).text, "f32 bounded, fast soa");
	ck_assert_str_eq(only_label(rows, y, 2).text, "f32 accurate, bounded, fast soa");
	ck_assert_str_eq(only_label(rows + 1, y, 2).text, "f32 bounded, fast soa; accurate aos");
	ck_assert_str_eq(only_label(rows, y, 4).text, "f32 accurate, bounded, fast soa, aos");
	ck_assert_double_eq(only_label(rows, y, 4).y, 112);
}
END_TEST

/* Would catch the name of a temporary file in a picture, or what nobody set. */
START_TEST(equal_rows_equal_bytes)
{
	static struct study study;
	struct study_options options = {.sample = {.count = 10}};
	struct study_row rows[] = {
		{.backend = RNEA_BACKEND_HOST, .precision = RNEAGEN_F32, .batch = 9, .ns = 5, .floor_ratio = 0.5,
			.errors = {.max = 1e-7}},
		{.backend = RNEA_BACKEND_HOST, .precision = RNEAGEN_F64, .batch = 9, .ns = 9, .floor_ratio = 0.6,
			.errors = {.max = 1e-16}}};
	struct report report = {.study = &study, .rows = rows, .count = 2};
	struct rneagen_error e = {0};
	struct file_content a, b;

	if (!has_gnuplot)
		return;
	study.options = &options;
	study.analysis.robot.name = "arm";
	study.backends[0].backend = RNEA_BACKEND_HOST;
	study.backend_count = 1;
	ck_assert_msg(!plot_write(&report, "test_plot_a.svg", &e), "%s", e.message);
	ck_assert_msg(!plot_write(&report, "test_plot_b.svg", &e), "%s", e.message);
	ck_assert(!file_read("test_plot_a.svg", &a, &e) && !file_read("test_plot_b.svg", &b, &e));
	ck_assert(a.length == b.length && a.length > 1000 && !memcmp(a.bytes, b.bytes, a.length));
	unlink("test_plot_a.svg");
	unlink("test_plot_b.svg");
	free(a.bytes);
	free(b.bytes);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("plot");
	TCase *c = tcase_create("plot");

	has_gnuplot = !system("gnuplot --version >/dev/null 2>&1");
	if (!has_gnuplot)
		puts("skipped: the bytes of a picture: there is no gnuplot");
	tcase_add_test(c, every_point_has_a_clear_name);
	tcase_add_test(c, a_cluster_has_one_name);
	tcase_add_test(c, equal_rows_equal_bytes);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
