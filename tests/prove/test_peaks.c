/* Magnitudes and lengths that are known of a whole box by points of q hold at states drawn within it, and those of all
   angles at any; first and second derivatives by q are no longer than what is known of them, by differences; and values
   are of their degrees: those at 2 d + 1 places of a circle give any other. The first finds a grid whose places are
   taken for all there is, the others a rule or a row that is left out. */
#include "prove/peaked.h"
#include "support/suite.h"
#include <math.h>
#include <stdlib.h>

enum { SEED = 53, STATES = 150, DIFFERENCES = 12 };

static const char *const ROBOTS[] = {
	"iiwa14", "panda", "ur5", "hyq", "prismatic_skew", "planar_joint", "double_pendulum"};

static const double PI = 3.14159265358979323846;

static double length_of(const struct peak *k, const double *v)
{
	return k->pair ? hypot(v[k->nodes[0]], v[k->nodes[1]]) : fabs(v[k->nodes[0]]);
}

/* A short time: few places, so that what is between them counts; ranges with another middle than 0; short ones, of a
 * single place. */
static const struct {
	const char *scene;
	double seconds;
} CASES[] = {
	{"range qdd=-20,20\nrange qd=-2,2\nrange q=-2,2.5", 0.4},
	{"range qdd=-5,20\nrange qd=-2,1\nrange q=-2,2.5", 2},
	{"range qdd=-20,20\nrange qd=-2,2\nrange q=0.5,0.52", 0.4},
};

enum { CASE_COUNT = 3, ARMS = 3 };

START_TEST(test_states)
{
	const char *name = ROBOTS[_i / CASE_COUNT];
	struct peaked c;
	struct rng r = rng_seed(SEED);
	double least = 1;

	peaked_open(&c, name, CASES[_i % CASE_COUNT].scene, 0, CASES[_i % CASE_COUNT].seconds);
	for (size_t i = 0; i < c.p.count; i++)
		if (c.p.list[i].kind != PEAK_UNKNOWN && c.p.list[i].dims)
			least = fmin(
				least, c.p.list[i].most /
					       (c.p.list[i].pair ? norms_of_pair(&c.norms, &c.values, c.p.list[i].pair)
								 : c.values.size[c.p.list[i].nodes[0]]));
	ck_assert_msg(_i % CASE_COUNT != 1 || _i / CASE_COUNT >= ARMS || least < 0.9, "%s: nothing is closer", name);
	for (int s = 0; s < STATES; s++) {
		peaked_draw(&c, &r, s % 2);
		peaked_evaluate(&c);
		for (size_t i = 0; i < c.p.count; i++) {
			const struct peak *k = &c.p.list[i];
			double most = s % 2 ? k->whole : k->most, length = length_of(k, c.v);

			ck_assert_msg(length <= most * (1 + 1e-9) + 1e-12,
				"%s, seed %d, state %d: peak %zu of kind %d, node %u, is %g, but at most %g", name,
				SEED, s, i, k->kind, k->nodes[0], length, most);
		}
	}
	robot_box_close(&c.x);
}
END_TEST

/* At q[k] - h, q[k], q[k] + h: first and second differences of each node. */
static void differ(struct peaked *c, int k, double h, double *first, double *second)
{
	size_t count = c->adjoint.d.count;
	double at = c->in[0][k];

	for (int side = -1; side <= 1; side++) {
		c->in[0][k] = at + side * h;
		peaked_evaluate(c);
		for (size_t i = 0; i < count; i++) {
			first[i] = (side == -1 ? 0 : first[i]) + side * c->v[i] / (2 * h);
			second[i] = (side == -1 ? 0 : second[i]) + (side ? 1 : -2) * c->v[i] / (h * h);
		}
	}
	c->in[0][k] = at;
}

START_TEST(test_bends)
{
	const char *name = ROBOTS[_i];
	struct peaked c;
	struct rng r = rng_seed(SEED);
	double *first, *second;

	peaked_open(&c, name, "range qdd=-20,20\nrange qd=-2,2\nrange q=-2,2.5", 0, 0.5);
	first = arena_alloc(&c.x.arena, c.adjoint.d.count, sizeof *first);
	second = arena_alloc(&c.x.arena, c.adjoint.d.count, sizeof *second);
	for (int s = 0; s < DIFFERENCES; s++)
		for (int k = 0; k < c.p.dim_count; k++) {
			peaked_draw(&c, &r, s % 2);
			differ(&c, k, 1e-3, first, second);
			for (size_t i = 0; i < c.p.count; i++) {
				const struct peak *x = &c.p.list[i];
				double off = 1e-8 + 1e-5 * x->whole;

				ck_assert_msg(
					x->kind == PEAK_UNKNOWN || s % 2 || length_of(x, second) <= x->near[k] + off,
					"%s, seed %d: peak %zu, node %u, by row %d, in the box: %g, but at most %g",
					name, SEED, i, x->nodes[0], k, length_of(x, second), x->near[k]);
				ck_assert_msg(
					x->kind == PEAK_UNKNOWN || (length_of(x, first) <= x->tilts[k] + off &&
									   length_of(x, second) <= x->bends[k] + off),
					"%s, seed %d: peak %zu, node %u, by row %d: %g and %g, but at most %g and %g",
					name, SEED, i, x->nodes[0], k, length_of(x, first), length_of(x, second),
					x->tilts[k], x->bends[k]);
			}
		}
	robot_box_close(&c.x);
}
END_TEST

/* Of the value at one of 2 d + 1 places of a circle, and at one of 0, 1 ... d, for that at another place. */
static double weight_of_angle(double at, int d, int place)
{
	double n = 2 * d + 1, by = 1 / n;

	for (int h = 1; h <= d; h++)
		by += 2 * cos(h * (at - 2 * PI * place / n)) / n;
	return by;
}

static double weight_of_length(double at, int d, int place)
{
	double by = 1;

	for (int i = 0; i <= d; i++)
		by *= i == place ? 1 : (at - i) / (place - i);
	return by;
}

START_TEST(test_degrees)
{
	const char *name = ROBOTS[_i];
	struct peaked c;
	struct rng r = rng_seed(SEED);
	double *sum;

	peaked_open(&c, name, "range qdd=-20,20\nrange qd=-2,2\nrange q=-2,2.5", 0, 0.5);
	sum = arena_alloc(&c.x.arena, c.p.count, sizeof *sum);
	for (int k = 0; k < c.p.dim_count; k++)
		for (int d = 1; d <= 4; d++) {
			double at = rng_uniform(&r, -PI, PI);
			int is_angle = c.p.is_angle[k], n = is_angle ? 2 * d + 1 : d + 1;

			peaked_draw(&c, &r, 1);
			memset(sum, 0, c.p.count * sizeof *sum);
			for (int place = 0; place <= n; place++) { /* the last is where it is asked for */
				double by = place == n ? -1 : is_angle ? weight_of_angle(at, d, place) : weight_of_length(at, d, place);

				c.in[0][k] = place == n ? at : is_angle ? 2 * PI * place / n : place;
				peaked_evaluate(&c);
				for (size_t i = 0; i < c.p.count; i++)
					sum[i] += by * c.v[c.p.list[i].nodes[0]];
			}
			for (size_t i = 0; i < c.p.count; i++)
				ck_assert_msg(c.p.list[i].kind == PEAK_UNKNOWN || c.p.list[i].degrees[k] > d ||
						      fabs(sum[i]) <= (is_angle ? 1e-9 : 1e-7) * (1 + c.p.list[i].whole),
					"%s, seed %d: peak %zu, node %u, is no polynomial of degree %d in row %d", name,
					SEED, i, c.p.list[i].nodes[0], d, k);
		}
	robot_box_close(&c.x);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("peaks");
	int robots = (int)(sizeof ROBOTS / sizeof *ROBOTS);

	suite_add(suite, "states", test_states, CASE_COUNT * robots, 60);
	suite_add(suite, "bends", test_bends, robots, 60);
	suite_add(suite, "degrees", test_degrees, robots, 60);
	return suite_run(suite);
}
