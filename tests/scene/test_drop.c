/* What --drop-below FRACTION:sampled leaves out: nothing that an input of the scene can make felt, by the independent reference
   and beside the text that has all terms; no other terms than a sweep by each output, one sample after the other, finds; and the
   text keeps its inputs. Seeds are printed or in DROP_SEEDS. */
#define _POSIX_C_SOURCE 200809L
#include "tell/effect.h"
#include "dag/eval.h"
#include "draw/felt.h"
#include "support/suite.h"
#include "support/task/task.h"
#include "support/urdf_text.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TREES = 80, LINKS = 10, STATES = 40, SEED = 20261121 };

/* ---- against the reference ---- */

/* What is freed and pushed has any value, mostly far from the URDF's; of 1e-18 of an output nothing can be seen. */
START_TEST(random_trees)
{
	int tried = 0;

	for (uint64_t seed = 1; seed <= TREES; seed++) {
		struct task_case *c = case_random(seed, LINKS, NO_ODD_NAMES);
		char what[64];

		if (!c)
			continue;
		snprintf(what, sizeof what, "dropped, seed %d", (int)seed);
		case_draw_folds(c);
		case_draw_frees(c, 0);
		if (seed % 2)
			case_draw_pushes(c);
		if (seed % 3)
			case_draw_wants(c);
		case_say(c, "drop-below 1e-18:sampled\n");
		case_checked(c, what);
		case_close(c);
		tried++;
	}
	printf("against the reference: %d random trees, seeds 1 to %d\n", tried, TREES);
	ck_assert_int_gt(tried, TREES / 2);
}
END_TEST

/* ---- beside the text that has all terms ---- */

/* A link that turns about its centre of mass, with equal inertias about all axes: nothing of it but one number shows. */
static const char even[] = ROBOT("even", BALL("base") BALL("a") JOINT("ja", "revolute", "base", "a", AXIS("1 0 0"))
	LINK("b", "1", "0 0 0", "0 0 0", "0.1", "0", "0", "0.1", "0", "0.1")
	JOINT("jb", "revolute", "a", "b", ORIGIN("0 0 1", "0 0 0") AXIS("0 1 0")));

static const struct beside {
	const char *robot, *scene; /* robot: NULL: `even` */
	enum rneagen_base base;
} BESIDES[] = {
	{"panda", "free payload.panda_hand", RNEAGEN_FIXED},
	{"panda", "free payload.panda_hand:batch", RNEAGEN_FIXED},
	{"panda", "free offset.panda_joint2", RNEAGEN_FIXED},
	{"panda", "free gravity", RNEAGEN_FIXED},
	{"panda", "free gravity:sample\nwant tau,gravity,potential", RNEAGEN_FIXED},
	{"panda", "fold gravity=0,0,0\nfree gravity", RNEAGEN_FIXED},
	{"iiwa14", "free mass.iiwa_link_ee", RNEAGEN_FIXED},
	{"iiwa14", "free inertia.iiwa_link_ee", RNEAGEN_FIXED},
	{NULL, "free inertia.b", RNEAGEN_FIXED},
	{NULL, "free inertia.b:sample\nwant tau,kinetic", RNEAGEN_FLOATING},
	{"panda", "fext panda_hand", RNEAGEN_FIXED},
	{"panda", "fext panda_hand\nfext-frame world", RNEAGEN_FIXED},
	{"hyq", "fext lf_foot,rh_foot\nfext-frame world", RNEAGEN_FLOATING},
	{"panda", "want vjp", RNEAGEN_FIXED},
	{"panda", "want tau,jvp", RNEAGEN_FIXED},
	{"hyq", "want vjp,jvp\nfree payload.trunk", RNEAGEN_FLOATING},
	{"panda", "free payload.panda_hand,gravity\nwant tau,dtau_dpayload.panda_hand,dtau_dgravity,dtau_dq", RNEAGEN_FIXED},
};
enum { BESIDE_COUNT = sizeof BESIDES / sizeof *BESIDES };

static void open_scene(struct scene_model *m, const char *text, enum rneagen_base base, const char *scene, const char *more)
{
	struct rneagen_options o = rneagen_options_default();
	char all[1024];

	snprintf(all, sizeof all, "%s\n%s", scene, more);
	o.scene = all;
	o.base = base;
	ck_assert_msg(!scene_open(m, text, &o), "%s", m->error.message);
	ck_assert_msg(!effect_measure(&m->effects, &m->analysis), "%s", m->error.message);
}

static void check_same_arguments(const struct dag *a, const struct dag *b)
{
	ck_assert_int_eq(a->argument_count, b->argument_count);
	for (int i = 0; i < a->argument_count; i++) {
		const struct argument *x = &a->arguments[i], *y = &b->arguments[i];

		ck_assert_str_eq(x->name, y->name);
		ck_assert(x->rows == y->rows && x->is_output == y->is_output && x->per_batch == y->per_batch);
	}
}

/* Any numbers, of which a quaternion is one. */
static void draw_rows_here(struct rng *rng, const struct tree *t, const struct argument *a, double *x)
{
	int is_q = !strcmp(a->name, "q");

	for (int i = 0; i < a->rows; i++)
		x[i] = rng_uniform(rng, -2, 2);
	for (int j = 0; j < t->joint_count && is_q; j++) {
		double *u = x + t->joints[j].iq + 3, size = 0;

		for (int i = 0; i < 4 && t->joints[j].nq == 7; i++)
			size = hypot(size, u[i]);
		for (int i = 0; i < 4 && t->joints[j].nq == 7; i++)
			u[i] /= size;
	}
}

/* The largest difference of an output array as a part of its largest number. */
static double difference(const struct dag *d, const struct dag *e, const struct tree *t, int seed)
{
	static double in[DAG_ARGUMENTS][ROWS], y[DAG_ARGUMENTS][ROWS], z[DAG_ARGUMENTS][ROWS];
	double off[DAG_ARGUMENTS] = {0}, size[DAG_ARGUMENTS] = {0}, most = 0;
	const double *ins[DAG_ARGUMENTS];
	double *ys[DAG_ARGUMENTS], *zs[DAG_ARGUMENTS];
	struct rng rng = rng_seed((uint64_t)seed);

	for (int k = 0; k < STATES; k++) {
		for (int i = 0; i < d->argument_count; i++) {
			ck_assert_int_le(d->arguments[i].rows, ROWS);
			draw_rows_here(&rng, t, &d->arguments[i], in[i]);
			ins[i] = in[i];
			ys[i] = y[i];
			zs[i] = z[i];
		}
		ck_assert(eval_f64(d, ins, ys, NULL) && eval_f64(e, ins, zs, NULL));
		for (int i = 0; i < d->argument_count; i++)
			for (int r = 0; r < d->arguments[i].rows && d->arguments[i].is_output; r++) {
				off[i] = fmax(off[i], fabs(y[i][r] - z[i][r]));
				size[i] = fmax(size[i], fabs(z[i][r]));
			}
	}
	for (int i = 0; i < d->argument_count; i++)
		most = off[i] > 0 ? fmax(most, off[i] / size[i]) : most;
	return most;
}

/* At 1e-12 a thousand terms are 1e-9, and inputs here are up to a hundred times what the ranges have. */
START_TEST(beside_all)
{
	const struct beside *b = &BESIDES[_i];
	char *text = b->robot ? robot_text(b->robot) : strdup(even);
	struct scene_model m, whole;
	double off;

	open_scene(&m, text, b->base, b->scene, "drop-below 1e-12:sampled");
	open_scene(&whole, text, b->base, b->scene, "");
	check_same_arguments(&m.dag, &whole.dag);
	off = difference(&m.dag, &whole.dag, &m.tree, SEED);
	ck_assert_msg(off < 1e-7, "%s, %s: off by %g, seed %d", b->robot ? b->robot : "even", b->scene, off, SEED);
	ck_assert(m.effects.of[m.effects.count - 1].share < 1e-8);
	scene_close(&m);
	scene_close(&whole);
	free(text);
}
END_TEST

/* What is dropped from what is freed is told: a payload of next to nothing; and its ten numbers are still an input. */
START_TEST(told)
{
	char *text = robot_text("panda");
	struct scene_model m, whole;
	double change;

	open_scene(&m, text, RNEAGEN_FIXED, "free payload.panda_hand",
		"drop-below 1e-6:sampled\nrange payload.panda_hand=0,1e-7");
	open_scene(&whole, text, RNEAGEN_FIXED, "free payload.panda_hand", "drop-below 1e-6:sampled");
	check_same_arguments(&m.dag, &whole.dag);
	for (size_t i = 0; i < m.dag.count; i++)
		ck_assert(m.dag.nodes[i].op != OP_INPUT ||
			strcmp(m.dag.arguments[m.dag.nodes[i].arg[0].i].name, "payload_panda_hand") != 0);
	ck_assert_uint_lt(operation_total(&m), operation_total(&whole));
	ck_assert_msg(m.effects.of[0].share > 1e-10 && m.effects.of[0].share < 1e-5, "%g", m.effects.of[0].share);
	ck_assert(!effect_total(&change, &m.analysis, &(struct draw_options){.seed = 7, .count = 100}, &m.error));
	ck_assert_msg(change > 1e-10 && change < 1e-5, "%g", change);
	scene_close(&m);
	scene_close(&whole);
	free(text);
}
END_TEST

/* A narrower range leaves less to feel. */
START_TEST(ranges_count)
{
	char *text = robot_text("iiwa14");
	struct scene_model m, wide_, slow;

	open_scene(&m, text, RNEAGEN_FIXED, "", "drop-below 1e-4:sampled");
	open_scene(&wide_, text, RNEAGEN_FIXED, "range qd=-100,100\nrange qdd=-1000,1000", "drop-below 1e-4:sampled");
	open_scene(&slow, text, RNEAGEN_FIXED, "range qd=-0.01,0.01\nrange qdd=-0.01,0.01", "drop-below 1e-4:sampled");
	ck_assert_uint_lt(operation_total(&slow), operation_total(&m));
	ck_assert_uint_lt(operation_total(&slow), operation_total(&wide_));
	scene_close(&m);
	scene_close(&wide_);
	scene_close(&slow);
	free(text);
}
END_TEST

/* Where numbers end nothing is known, and all stays. */
START_TEST(overflow)
{
	char *text = robot_text("panda");
	struct scene_model m, whole;
	double change;

	open_scene(&m, text, RNEAGEN_FIXED, "range qd=-1e200,1e200", "drop-below 1e-3:sampled");
	open_scene(&whole, text, RNEAGEN_FIXED, "", "");
	ck_assert_uint_eq(operation_total(&m), operation_total(&whole));
	ck_assert(isnan(m.effects.of[0].share) && isnan(m.effects.of[0].change));
	ck_assert(!effect_total(&change, &m.analysis, &(struct draw_options){.seed = 7, .count = 10}, &m.error));
	ck_assert(isinf(change));
	scene_close(&m);
	scene_close(&whole);
	free(text);
}
END_TEST

/* ---- which terms ---- */

struct naive {
	const struct dag *d;
	double *value, *slope, *scale, (*effect)[2];
	char *is_kept; /* under a root, in a divisor, or dead */
};

static void evaluate(struct naive *n, const struct drawn *x, size_t sample)
{
	for (size_t i = 0; i < n->d->count; i++) {
		const struct node *k = &n->d->nodes[i];
		int is_read = k->op == OP_INPUT && (int)k->arg[0].i < n->d->argument_count;

		n->value[i] = is_read ? draw_rows(x, &n->d->arguments[k->arg[0].i], sample)[k->arg[1].i]
			: k->op == OP_INPUT ? 0 : eval_node(k, n->value);
	}
}

static void sweep(struct naive *n, size_t output)
{
	double by[3];

	memset(n->slope, 0, n->d->count * sizeof *n->slope);
	n->slope[n->d->outputs[output].value.i] = 1;
	for (size_t i = n->d->count; i-- > 0;) {
		const struct node *k = &n->d->nodes[i];

		eval_partials(k, n->value, by);
		for (int a = 0; a < op_arity[k->op]; a++) {
			n->slope[k->arg[a].i] += n->slope[i] * by[a];
			if (a < 2 && n->scale[output] > 0)
				n->effect[i][a] = fmax(n->effect[i][a],
					fabs(n->slope[i] * n->value[k->arg[a].i]) / n->scale[output]);
		}
	}
}

static void mark_kept(struct naive *n, struct arena *a)
{
	uint32_t *uses = arena_alloc(a, n->d->count, sizeof *uses);

	dag_uses(n->d, uses);
	for (size_t i = n->d->count; i-- > 0;) {
		const struct node *k = &n->d->nodes[i];

		if (k->op == OP_SQRT || k->op == OP_DIV)
			n->is_kept[k->arg[k->op == OP_DIV].i] = 1;
		for (int b = 0; b < op_arity[k->op] && n->is_kept[i] == 1; b++)
			n->is_kept[k->arg[b].i] = 1;
		if (!uses[i] && !n->is_kept[i])
			n->is_kept[i] = 2;
	}
}

static void find_effects(struct naive *n, const struct drawn *x)
{
	for (size_t k = 0; k < x->samples; k++) {
		evaluate(n, x, k);
		for (size_t i = 0; i < n->d->output_count; i++)
			n->scale[i] = fmax(n->scale[i], fabs(n->value[n->d->outputs[i].value.i]));
	}
	for (size_t k = 0; k < x->samples; k++) {
		evaluate(n, x, k);
		for (size_t i = 0; i < n->d->output_count; i++)
			sweep(n, i);
	}
}

/* Terms that are as good as at the fraction may be on either side. */
static size_t check_terms(const struct naive *n, const unsigned char *unfelt, double fraction)
{
	size_t found = 0;

	for (size_t i = 0; i < n->d->count; i++)
		for (int k = 0; k < 2; k++) {
			int is_sum = n->d->nodes[i].op == OP_ADD || n->d->nodes[i].op == OP_SUB;
			int is_unfelt = is_sum && !n->is_kept[i] && n->effect[i][k] < fraction;

			if (is_sum && fabs(n->effect[i][k] / fraction - 1) < 1e-6)
				continue;
			ck_assert_msg((unfelt[i] >> k & 1) == is_unfelt, "operand %d of node %zu: effect %g, fraction %g, %s", k,
				i, n->effect[i][k], fraction, is_unfelt ? "and is kept" : "and is dropped");
			found += (size_t)is_unfelt;
		}
	return found;
}

static const struct exact {
	const char *robot, *scene;
	enum rneagen_base base;
} EXACTS[] = {
	{"panda", "free payload.panda_hand,gravity", RNEAGEN_FIXED},
	{"hyq", "want tau,vjp\nfext lf_foot\nfext-frame world", RNEAGEN_FLOATING},
	{"allegro_right", "friction\ndamping\nwant tau,power,kinetic", RNEAGEN_FIXED}, /* more than 16 outputs, and roots */
	{"iiwa14", "want tau,dtau_dq,dtau_dqd,M", RNEAGEN_FIXED},
	{"chain_75", "", RNEAGEN_FIXED},
};

START_TEST(exact)
{
	static const double fractions[] = {1e-14, 1e-9, 1e-4, 0.02, 0.4};
	char *text = robot_text(EXACTS[_i].robot);
	struct scene_model m;
	struct naive n;
	struct dag raw;
	struct drawn x;
	size_t most = 0;

	open_scene(&m, text, EXACTS[_i].base, EXACTS[_i].scene, "");
	dag_init(&raw, &m.arena);
	algorithm_rnea.build(&raw, &m.tree, &m.analysis.request);
	ck_assert(draw_inputs(&x, &m.tree, &m.analysis.request, &FELT_SAMPLES, &m.arena));
	n = (struct naive){.d = &raw, .value = arena_alloc(&m.arena, raw.count, sizeof(double)),
		.slope = arena_alloc(&m.arena, raw.count, sizeof(double)),
		.scale = arena_alloc(&m.arena, raw.output_count, sizeof(double)),
		.effect = arena_alloc(&m.arena, raw.count, sizeof *n.effect), .is_kept = arena_alloc(&m.arena, raw.count, 1)};
	mark_kept(&n, &m.arena);
	find_effects(&n, &x);
	for (size_t i = 0; i < sizeof fractions / sizeof *fractions; i++) {
		unsigned char *unfelt = felt_find(&raw, &m.tree, &m.analysis.request, fractions[i], &m.arena);

		ck_assert(unfelt != NULL);
		most = check_terms(&n, unfelt, fractions[i]);
	}
	printf("%s: %zu nodes, %zu outputs, %zu terms unfelt at %g\n", EXACTS[_i].robot, raw.count, raw.output_count,
		most, fractions[4]);
	ck_assert_uint_gt(most, 10);
	scene_close(&m);
	free(text);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("drop");
	TCase *c = tcase_create("drop");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 120);
	tcase_add_test(c, random_trees);
	tcase_add_loop_test(c, beside_all, 0, BESIDE_COUNT);
	tcase_add_test(c, told);
	tcase_add_test(c, ranges_count);
	tcase_add_test(c, overflow);
	tcase_add_loop_test(c, exact, 0, sizeof EXACTS / sizeof *EXACTS);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
