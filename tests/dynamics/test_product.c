/* jvp and vjp of sets of outputs: a wrong derivative of any output, by the state or by what is free or pushes, a row in the wrong
   place, a qdd found that stands still, a given tau that does. Against differences of the outputs themselves, of a text without
   products, in extended precision, in drawn scenes of random trees and of robots of this folder; and vjp is jvp transposed.
   Second derivatives, the jvp of the vjp, against differences of the vjp. */
#include "product_case.h"
#include "support/exhaustive.h"
#include "support/suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINKS = 8 };
#define TREES (exhaustive() ? 120 : 70)

/* What is left of a difference of fourth order, of the largest number beside it. */
static const real TOLERANCE = 1e-10L;

/* ---- evaluated ---- */

static struct given *find_given(struct drawn_case *x, const char *name)
{
	for (int i = 0; i < x->given_count; i++)
		if (!strcmp(x->given[i].name, name))
			return &x->given[i];
	return NULL;
}

static const real *input_of(struct drawn_case *x, const struct argument *a, real h, real *room)
{
	struct given *g = find_given(x, a->name);

	if (!strcmp(a->name, "jvp_v"))
		return x->v;
	if (a->role == ROLE_COTANGENT)
		return x->weights;
	if (a->role == ROLE_TANGENT)
		return find_given(x, a->name + strlen("jvp_v_"))->along;
	ck_assert_msg(g != NULL, "%s: what is '%s'?", x->what, a->name);
	for (int i = 0; i < g->rows; i++)
		room[i] = g->at[i] + (x->by_all || g < x->given + 3 ? h * g->along[i] : 0);
	return room;
}

/* Outputs one after another, in `out`; `of` has where each begins, and the end. */
static int evaluate(struct drawn_case *x, const struct dag *d, real h, real *out, int *of)
{
	const real *in[DAG_ARGUMENTS] = {NULL};
	real *to[DAG_ARGUMENTS] = {NULL}, *room = calloc(DAG_ARGUMENTS * ROWS, sizeof *room);
	int count = 0, at = 0;

	for (int i = 0; i < d->argument_count; i++) {
		if (!d->arguments[i].is_output) {
			in[i] = input_of(x, &d->arguments[i], h, room + i * ROWS);
			continue;
		}
		of[count++] = at;
		to[i] = out + at;
		at += d->arguments[i].rows;
		ck_assert_int_le(at, VALUES);
	}
	of[count] = at;
	ck_assert(eval_real(d, in, to, NULL));
	free(room);
	return count;
}

/* Along the direction: (8 (f(h) - f(-h)) - f(2h) + f(-2h))/12h. */
static int differentiate(struct drawn_case *x, real h, real *out, int *of)
{
	static const real at[] = {1, -1, 2, -2}, weight[] = {8, -8, -1, 1};
	real *one = calloc(VALUES, sizeof *one);
	int count = 0;

	memset(out, 0, VALUES * sizeof *out);
	for (int i = 0; i < 4; i++) {
		count = evaluate(x, &x->values.dag, at[i] * h, one, of);
		for (int k = 0; k < of[count]; k++)
			out[k] += weight[i] * one[k] / (12 * h);
	}
	free(one);
	return count;
}

/* ---- compared ---- */

static void compare_jvp(struct drawn_case *x, const real *jvp)
{
	real *room = calloc(3 * VALUES, sizeof *room), *fine = room, *rough = room + VALUES, *value = room + 2 * VALUES;
	int of[DAG_ARGUMENTS], count;

	differentiate(x, 2e-4L, rough, of);
	differentiate(x, 1e-4L, fine, of);
	count = evaluate(x, &x->values.dag, 0, value, of);
	for (int k = 0; k < count; k++) {
		real most = 1;

		for (int i = of[k]; i < of[k + 1]; i++)
			most = fmaxl(most, fmaxl(fabsl(fine[i]), fabsl(value[i])));
		for (int i = of[k]; i < of[k + 1]; i++)
			ck_assert_msg(fabsl(jvp[i] - fine[i]) <= TOLERANCE * most + 10 * fabsl(fine[i] - rough[i]),
				"%s: row %d of output %d of %s: jvp is %.12Lg, the difference %.12Lg; scene:\n%s", x->what,
				i - of[k], k, x->of, jvp[i], fine[i], x->scene);
	}
	free(room);
}

/* weights . jvp = vjp . direction, the parts by other inputs included. */
static void compare_vjp(struct drawn_case *x, const real *out, const int *of)
{
	const struct dag *d = &x->products.dag;
	real sum = 0, size = 1;

	for (int i = 0, k = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		const real *with = a->role == ROLE_JVP ? x->weights : x->v;

		if (!a->is_output)
			continue;
		if (a->role == ROLE_VJP && *a->of)
			with = find_given(x, a->name + strlen("vjp_"))->along;
		for (int r = 0; r < a->rows && (a->role == ROLE_JVP || a->role == ROLE_VJP); r++) {
			sum += (a->role == ROLE_JVP ? 1 : -1) * with[r] * out[of[k] + r];
			size += fabsl(with[r] * out[of[k] + r]);
		}
		k++;
	}
	ck_assert_msg(fabsl(sum) <= 1e-11L * size, "%s: vjp of %s differs from jvp by %Lg of %Lg; scene:\n%s", x->what, x->of,
		sum, size, x->scene);
}

static void check_case(struct drawn_case *x, int is_second)
{
	const struct dag *d = &x->products.dag;
	real *out = calloc(VALUES, sizeof *out);
	int of[DAG_ARGUMENTS], k = 0;

	x->given_count = 0;
	draw_numbers(x);
	evaluate(x, d, 0, out, of);
	for (int i = 0; i < d->argument_count; i++) {
		if (d->arguments[i].role == ROLE_JVP)
			compare_jvp(x, out + of[k]);
		k += d->arguments[i].is_output;
	}
	if (!is_second)
		compare_vjp(x, out, of);
	free(out);
}

/* By all inputs besides the state, or by none. */
static void say_by(struct drawn_case *x, char *to, size_t room)
{
	const struct request *k = &x->values.analysis.request;

	for (int i = 0; i < k->freed_count && x->by_all; i++)
		say(to, room, "by %s\n", k->freed[i].word);
	for (int i = 0; i < k->push_count && x->by_all; i++)
		say(to, room, "by %s\n", k->pushes[i].word);
}

/* The text of the outputs, and that of their products, which stores some of them too. Returns 0 where M is singular, or nothing
   has a mass. */
static int open_both(struct drawn_case *x)
{
	char scene[4096] = "";
	enum rneagen_code code;

	say(scene, sizeof scene, "%swant %s\n", x->scene, x->of);
	x->options.scene = scene;
	code = scene_open(&x->values, x->urdf, &x->options);
	ck_assert_msg(!code || code == RNEAGEN_TREE || strstr(x->values.error.message, "nothing that moves has a mass"),
		"%s: %s; scene:\n%s", x->what, x->values.error.message, scene);
	if (code)
		return 0;
	*scene = '\0';
	say(scene, sizeof scene, "%sjvp %s\nvjp %s\n", x->scene, x->of, x->of);
	if (rng_chance(&x->rng, 0.5))
		say(scene, sizeof scene, "want kinetic,%.*s\n", (int)strcspn(x->of, ","),
			strncmp(x->of, "kinetic", 7) ? x->of : "M");
	say_by(x, scene, sizeof scene);
	ck_assert_msg(!scene_open(&x->products, x->urdf, &x->options), "%s: %s; scene:\n%s", x->what,
		x->products.error.message, scene);
	return 1;
}

static void open_scene(struct drawn_case *x, struct scene_model *m, char *scene)
{
	x->options.scene = scene;
	ck_assert_msg(!scene_open(m, x->urdf, &x->options), "%s: %s; scene:\n%s", x->what, m->error.message, scene);
}

/* How the vjp varies: of these outputs, by the same inputs. */
static void check_second(struct drawn_case *x)
{
	char scene[4096] = "", second[4096] = "";

	say(second, sizeof second, "%svjp %s\njvp vjp\n", x->scene, x->of);
	say_by(x, second, sizeof second);
	scene_close(&x->products);
	scene_close(&x->values);
	say(scene, sizeof scene, "%svjp %s\n", x->scene, x->of);
	open_scene(x, &x->values, scene);
	open_scene(x, &x->products, second);
	check_case(x, 1);
}

/* Returns whether the robot has such dynamics. */
static int check_drawn(const char *urdf, enum rneagen_base base, uint64_t seed, int is_forward, const char *what)
{
	struct drawn_case *x = calloc(1, sizeof *x);
	struct scene_model plain;
	int is_open;

	*x = (struct drawn_case){.rng = rng_seed(seed), .what = what, .urdf = urdf, .options = rneagen_options_default(),
		.is_forward = is_forward};
	x->options.base = base;
	x->by_all = rng_chance(&x->rng, 0.7);
	is_open = !scene_open(&plain, urdf, &x->options);
	if (is_open) {
		draw_others(x, &plain.tree);
		draw_set(x, &plain.tree);
		is_open = open_both(x);
		if (is_open) {
			check_case(x, 0);
			check_second(x);
			scene_close(&x->products);
		}
		scene_close(&x->values);
	}
	scene_close(&plain);
	free(x);
	return is_open;
}

START_TEST(trees)
{
	uint64_t seed = 5100 + (uint64_t)_i;
	char *urdf = torque_robot(seed, LINKS, NO_ODD_NAMES | (_i % 5 ? 0 : ALWAYS_MIMIC)), what[64];

	snprintf(what, sizeof what, "seed %d", (int)seed);
	check_drawn(urdf, _i % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING, seed, _i % 2, what);
	free(urdf);
}
END_TEST

static const char *const ROBOTS[] = {"iiwa14", "panda", "cartpole", "planar_joint", "floating_joint", "mimic_chain",
	"root_with_mass", "prismatic_skew"};
enum { ROBOT_COUNT = sizeof ROBOTS / sizeof *ROBOTS };

START_TEST(robots)
{
	const char *name = ROBOTS[_i];
	char *urdf = robot_text(name);

	/* the root of some has no mass: afloat neither qdd nor opspace_inv can be had */
	for (int k = 0; k < 4; k++)
		ck_assert_msg(check_drawn(urdf, k % 2 ? RNEAGEN_FLOATING : RNEAGEN_FIXED, 9000 + (uint64_t)(4 * _i + k), k / 2,
			name) || k % 2, "%s, seed %d: refused", name, 9000 + 4 * _i + k);
	free(urdf);
}
END_TEST

/* The products of qdd and of what follows it, in numbers of the row's; a tau that is given has its own value. */
static void products_with(const char *fold, const char *urdf, double *jvp, double *vjp)
{
	static const double angle[] = {0.3, -0.7}, rate[] = {0.4, 1.1}, torque[] = {1.5, 0.5},
		along[] = {0.2, -1, 0.7, 0.3, -0.6, 0.9}, weights[] = {1, -0.4, 0.8};
	struct rneagen_options o = rneagen_options_default();
	const double *in[DAG_ARGUMENTS] = {NULL};
	double qdd[2], *out[DAG_ARGUMENTS] = {NULL};
	struct scene_model m;
	char scene[128] = "";

	say(scene, sizeof scene, "want qdd\njvp qdd,power\nvjp qdd,power\n%s", fold);
	o.scene = scene;
	ck_assert_msg(!scene_open(&m, urdf, &o), "%s: %s", fold, m.error.message);
	for (int i = 0; i < m.dag.argument_count; i++) {
		const struct argument *a = &m.dag.arguments[i];

		in[i] = a->role == ROLE_JOINT_POSITION ? angle : a->role == ROLE_JOINT_VELOCITY ? rate
			: a->role == ROLE_TANGENT ? along : a->role == ROLE_COTANGENT ? weights : torque;
		out[i] = a->role == ROLE_JVP ? jvp : a->role == ROLE_VJP ? vjp : qdd;
	}
	ck_assert(eval_f64(&m.dag, in, out, NULL));
	scene_close(&m);
}

/* tau varies in all its rows, given or not. */
START_TEST(given_torques)
{
	static const char *const folds[] = {"fold tau.elbow=0.5", "fold tau.shoulder=1.5\nfold tau.elbow=0.5"};
	char *urdf = robot_text("double_pendulum");
	double jvp[3], vjp[6], given_jvp[3], given_vjp[6];

	products_with("", urdf, jvp, vjp);
	for (int k = 0; k < 2; k++) {
		products_with(folds[k], urdf, given_jvp, given_vjp);
		for (int i = 0; i < 3; i++)
			ck_assert_msg(fabs(jvp[i] - given_jvp[i]) <= 1e-12, "%s: jvp %d is %g, not %g", folds[k], i, given_jvp[i], jvp[i]);
		for (int i = 0; i < 6; i++)
			ck_assert_msg(fabs(vjp[i] - given_vjp[i]) <= 1e-12, "%s: vjp %d is %g, not %g", folds[k], i, given_vjp[i], vjp[i]);
	}
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("product");

	suite_add(s, "trees", trees, TREES, 60);
	suite_add(s, "robots", robots, ROBOT_COUNT, 60);
	suite_add(s, "given torques", given_torques, 1, 10);
	return suite_run(s);
}
