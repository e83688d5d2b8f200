/* Plans shared out among warps, run by rules alone: what a warp reads it has made itself or fetched from a slot that held it
   before the last wait, no slot is written while another warp may read it, each output is stored once. */
#include "passes/analysis.h"
#include "plan/limbs/limbs.h"
#include "rneagen.h"
#include "support/read.h"
#include "support/random_robot.h"
#include "support/rng.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RANDOM_ROBOTS = 60, MOST_LINKS = 16, MOST_PHASES = 16 };

static const char *const ROBOTS[] = {"iiwa14", "hyq", "double_pendulum", "mimic_chain", "atlas"};
static const char *const SCENES[] = {"", "fold qdd = 0", "fold qd = 0", "want dtau_dq, dtau_dqd", "want M, tau",
	"free gravity", "want qdd"};
enum { ROBOT_COUNT = sizeof ROBOTS / sizeof *ROBOTS, SCENE_COUNT = sizeof SCENES / sizeof *SCENES, ATLAS_SCENES = 2 };

/* A slot: by phase, the node that is written (0: none), by which warp, and whether another warp reads it. */
struct cell {
	uint32_t written;
	int writer, is_read;
};

struct checked {
	const struct plan *whole;
	const struct limbs *limbs;
	struct cell *cells;     /* [slot][phase] */
	unsigned char *has;     /* by node: the warp has the value */
	int *stored;            /* by output */
	const char *what;
};

static struct cell *cell(const struct checked *x, size_t slot, int phase)
{
	ck_assert_msg(slot < (size_t)x->limbs->slots, "%s: slot %zu of %d", x->what, slot, x->limbs->slots);
	ck_assert_msg(phase < MOST_PHASES, "%s: phase %d", x->what, phase);
	return &x->cells[slot * MOST_PHASES + (size_t)phase];
}

static void expect_read(const struct checked *x, int warp, struct ref r)
{
	const struct node *n = &x->whole->dag->nodes[r.i];

	if (n->op == OP_CONST)
		return;
	if (x->whole->names[r.i]) {
		ck_assert_msg(x->has[r.i], "%s: warp %d reads %s, which it has not", x->what, warp, x->whole->names[r.i]);
		return;
	}
	for (int k = 0; k < op_arity[n->op]; k++)
		expect_read(x, warp, n->arg[k]);
}

static void expect_operands(const struct checked *x, int warp, struct ref r)
{
	const struct node *n = &x->whole->dag->nodes[r.i];

	for (int k = 0; k < op_arity[n->op]; k++)
		expect_read(x, warp, n->arg[k]);
}

static void make_sines(const struct checked *x, struct ref r)
{
	struct ref s = plan_partner(x->whole, r, OP_SIN), c = plan_partner(x->whole, r, OP_COS);

	x->has[s.i] = x->has[c.i] = x->has[r.i] = 1;
}

/* Behind what goes across, its angle's sine before the cosine. */
static void expect_sine(const struct checked *x, const struct line *l)
{
	const struct angles *first = &x->limbs->first;
	const struct node *n = &x->whole->dag->nodes[l->value.i];
	size_t place = l->index - (size_t)x->limbs->slots;

	ck_assert_msg(l->index >= (size_t)x->limbs->slots && place < 2 * (size_t)first->count, "%s: a sine at %zu", x->what, l->index);
	ck_assert_msg(first->angle[place / 2].i == n->arg[0].i && n->op == (place % 2 ? OP_COS : OP_SIN),
		"%s: %s stands elsewhere than at %zu", x->what, x->whole->names[l->value.i], l->index);
}

/* Writes of all warps, and what each has. */
static void run_writes(const struct checked *x, int warp)
{
	const struct plan *p = &x->limbs->plans[warp];
	int phase = 0;

	memset(x->has, 0, x->whole->dag->count);
	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++)
		switch (l->kind) {
		case LINE_JOIN:
			phase++;
			break;
		case LINE_SINCOS:
			expect_operands(x, warp, l->value);
			make_sines(x, l->value);
			break;
		case LINE_VALUE:
			expect_operands(x, warp, l->value);
			x->has[l->value.i] = 1;
			break;
		case LINE_STORE:
			expect_read(x, warp, l->value);
			x->stored[l->index]++;
			break;
		case LINE_KEEP: {
			struct cell *c = cell(x, l->index, phase);

			expect_read(x, warp, l->value);
			ck_assert_msg(!c->written, "%s: slot %zu is written twice in phase %d", x->what, l->index, phase);
			*c = (struct cell){.written = l->value.i, .writer = warp};
			break;
		}
		case LINE_SINE:
			expect_sine(x, l);
			x->has[l->value.i] = 1;
			break;
		default: /* inputs, and what it fetches */
			x->has[l->value.i] = 1;
		}
	ck_assert_msg(phase + 1 == x->limbs->phases, "%s: warp %d waits %d times in %d phases", x->what, warp, phase,
		x->limbs->phases);
}

/* What is fetched was left in an earlier phase, and nothing else since; not even in this one. */
static void run_fetches(const struct checked *x, int warp)
{
	const struct plan *p = &x->limbs->plans[warp];
	int phase = 0;

	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++) {
		const char *name = l->kind == LINE_FETCH ? x->whole->names[l->value.i] : "";
		int before = phase - 1;

		phase += l->kind == LINE_JOIN;
		if (l->kind != LINE_FETCH)
			continue;
		ck_assert_msg(!cell(x, l->index, phase)->written,
			"%s: slot %zu of %s is written while warp %d fetches it, in phase %d", x->what, l->index,
			name, warp, phase);
		while (before >= 0 && !cell(x, l->index, before)->written)
			before--;
		ck_assert_msg(before >= 0, "%s: warp %d fetches %s from slot %zu, which nothing was left in", x->what,
			warp, name, l->index);
		ck_assert_msg(cell(x, l->index, before)->written == l->value.i,
			"%s: warp %d fetches %s from slot %zu, where %s is", x->what, warp, name, l->index,
			x->whole->names[cell(x, l->index, before)->written]);
	}
}

static void check_limbs(const struct plan *p, const struct limbs *s, const char *what, struct arena *a)
{
	struct checked x = {.whole = p, .limbs = s, .what = what,
		.cells = arena_alloc(a, (size_t)(s->slots + 1) * MOST_PHASES, sizeof *x.cells),
		.has = arena_alloc(a, p->dag->count, 1), .stored = arena_alloc(a, p->dag->output_count, sizeof *x.stored)};

	for (int w = 0; w < s->warps; w++)
		run_writes(&x, w);
	for (int w = 0; w < s->warps; w++)
		run_fetches(&x, w);
	for (size_t i = 0; i < p->dag->output_count; i++)
		ck_assert_msg(x.stored[i] == 1, "%s: output %zu is stored %d times", what, i, x.stored[i]);
}

/* Sines are made first where all angles are made of one input each. */
static void expect_first(const struct plan *p, const struct limbs *s, int has_first, const char *what)
{
	int sines = 0;

	for (int w = 0; w < s->warps; w++)
		for (size_t i = 0; i < s->plans[w].line_count; i++)
			sines += s->plans[w].lines[i].kind == LINE_SINCOS;
	ck_assert_msg(s->first.count == (has_first ? (int)plan_operations(p).sincos : 0), "%s: %d angles first", what, s->first.count);
	ck_assert_msg(!has_first || !sines, "%s: %d sines beside those that are made first", what, sines);
}

/* Operations of all warps, what is fetched being one: near those of their lines, which have some inputs more. */
static void expect_sum(const struct limbs *s, const char *what, struct arena *a)
{
	unsigned sum = 0;

	for (int w = 0; w < s->warps; w++) {
		sum += limbs_operations(&s->plans[w], a);
		for (size_t i = 0; i < s->plans[w].line_count; i++)
			sum += s->plans[w].lines[i].kind == LINE_FETCH;
	}
	ck_assert_msg(!s->warps || (s->sum <= sum && 100 * s->sum >= 95 * sum), "%s: %u operations, by lines %u", what, s->sum, sum);
}

/* With `first` to `last` warps, each four times as many, without sines that are made first and with them. Returns how many
   schedules there were. */
static int check_text(const char *urdf, size_t length, const struct rneagen_options *o, const char *name, int first, int last)
{
	struct analysis a;
	struct rneagen_error e = {0};
	struct plan p;
	int count = 0;
	char what[200];

	if (analysis_open(&a, urdf, length, o, &e))
		return 0;
	ck_assert(plan_build(&p, &a.dag, &a.tree, a.arena));
	for (int k = 0, warps = first; warps <= last; warps *= k % 2 ? 4 : 1, k++) {
		struct limbs_limits limits = {.warps = warps, .across = warps == 2 ? 48 : 384, .join = 20, .has_first_sines = k % 2};
		struct limbs s;

		ck_assert(limbs_make(&s, &p, &limits, a.arena));
		snprintf(what, sizeof what, "%s, scene '%s', %d warps%s", name, o->scene, warps, k % 2 ? ", sines first" : "");
		ck_assert(!s.warps || (s.slots <= (int)limits.across && 10 * s.longest <= 9 * s.whole));
		expect_sum(&s, what, a.arena);
		if (s.warps)
			check_limbs(&p, &s, what, a.arena);
		expect_first(&p, &s, k % 2, what);
		count += s.warps > 0;
	}
	analysis_free(&a);
	return count;
}

/* It would catch a value that no warp leaves for the others, and a slot that is used again too early. */
START_TEST(test_robots)
{
	struct rneagen_options o = rneagen_options_default();
	const char *name = ROBOTS[_i % ROBOT_COUNT];
	char *urdf = robot_text(name);

	o.scene = SCENES[_i / ROBOT_COUNT];
	if (strcmp(name, "atlas") || _i / ROBOT_COUNT < ATLAS_SCENES)
		ck_assert_msg(check_text(urdf, strlen(urdf), &o, name, 4, 16) || strstr(o.scene, "fold") ||
			!strcmp(name, "double_pendulum"), "%s, scene '%s': no schedule", name, o.scene);
	free(urdf);
}
END_TEST

START_TEST(test_random)
{
	struct rneagen_options o = rneagen_options_default();
	int count = 0;

	for (uint64_t seed = 1; seed <= RANDOM_ROBOTS; seed++) {
		struct random_robot_knobs knobs = random_robot_knobs(seed, MOST_LINKS);
		struct rng r = rng_seed(seed);
		char *urdf = random_robot(seed, &knobs), what[40];

		int warps = 2 << rng_below(&r, 4);

		snprintf(what, sizeof what, "seed %llu", (unsigned long long)seed);
		o.scene = SCENES[rng_below(&r, SCENE_COUNT)];
		o.base = rng_chance(&r, 0.5) ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
		count += check_text(urdf, strlen(urdf), &o, what, warps, warps);
		free(urdf);
	}
	ck_assert_msg(count > RANDOM_ROBOTS / 2, "%d schedules of %d robots", count, RANDOM_ROBOTS);
}
END_TEST

/* Catches a rule that gives each text as many warps: long ones have three where their code then fits, eight where
   more is saved. */
static const struct chosen {
	const char *name, *scene;
	enum rneagen_base base;
	enum rneagen_precision precision;
	int warps;
} CHOSEN[] = {
	{"atlas", "", RNEAGEN_FIXED, RNEAGEN_F32, 4},
	{"atlas", "want qdd\n", RNEAGEN_FIXED, RNEAGEN_F64, 4},
	{"hyq", "want qdd\n", RNEAGEN_FLOATING, RNEAGEN_F64, 4},
	{"shadow_hand_right", "want tau,vjp\n", RNEAGEN_FIXED, RNEAGEN_F64, 8},
	{"chain_75", "", RNEAGEN_FIXED, RNEAGEN_F64, 4},
};

START_TEST(test_chosen)
{
	const struct chosen *c = &CHOSEN[_i];
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e;
	struct rneagen_result r;
	char says[64], *urdf = robot_text(c->name);

	snprintf(says, sizeof says, "#define RNEA_LIMBS %d\n", c->warps);
	o.scene = *c->scene ? c->scene : NULL;
	o.base = c->base;
	o.precision = c->precision;
	ck_assert_msg(!rneagen_generate(urdf, strlen(urdf), &o, &r, &e), "%s", e.message);
	ck_assert_msg(strstr(r.source, says) != NULL, "%s: not %d warps", c->name, c->warps);
	free(urdf);
	rneagen_result_free(&r);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("limbs");

	suite_add(s, "robots", test_robots, ROBOT_COUNT * SCENE_COUNT, 60);
	suite_add(s, "random", test_random, 1, 60);
	suite_add(s, "chosen", test_chosen, sizeof CHOSEN / sizeof *CHOSEN, 60);
	return suite_run(s);
}
