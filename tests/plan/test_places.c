/* Outputs that take the places of inputs, run line by line in a memory that both share. It would catch a part that is said to
   write only what it has read: its numbers are wrong for the robots alone whose lines come in that order. And one that is
   refused without need: it takes more memory, or more kernels, and the same numbers come out. */
#include "plan/drawn.h"
#include "plan/grid/places.h"
#include "support/suite.h"

/* The arguments, of which positions have more rows than there are velocities. */
enum { Q, QD, QDD, WEIGHT, TAU, VJP, ARGUMENTS };
enum { NV = 3, NQ = 4, DRAWS = 4000 };

/* The output's row stands where this row of this argument was. */
struct where {
	int argument, row;
};

static struct where where(const struct stretches *s, const struct output *o)
{
	if (!s->period || o->argument != VJP)
		return (struct where){s->place_of[o->argument], o->row};
	return (struct where){o->row < NV ? Q : o->row < 2 * NV ? QD : QDD, o->row % NV + s->shift};
}

/* No line reads an input behind one that has written there. */
static int runs(const struct plan *p, const struct stretches *s, struct arena *a)
{
	const struct dag *d = p->dag;
	unsigned char written[ARGUMENTS][3 * NV] = {{0}}, *reads = arena_alloc(a, d->count, 1);

	for (const struct line *l = p->lines; l < p->lines + p->line_count; l++) {
		drawn_reads(p, l, reads);
		for (uint32_t i = 0; i < d->count; i++) {
			int is_read = l->kind == LINE_INPUT ? l->value.i == i : reads[i] && !p->names[i];

			if (d->nodes[i].op == OP_INPUT && is_read && written[d->nodes[i].arg[0].i][d->nodes[i].arg[1].i])
				return 0;
		}
		if (l->kind == LINE_STORE) {
			const struct output *o = &d->outputs[l->index];

			if (s->place_of[o->argument] != o->argument)
				written[where(s, o).argument][where(s, o).row] = 1;
		}
	}
	return 1;
}

/* The torque has the place of accelerations, or of its weight, or its own; a vjp has those of all joints' inputs, or its own. */
static void draw_stretches(struct stretches *s, struct rng *r)
{
	static const int places[] = {QDD, WEIGHT, TAU};

	*s = (struct stretches){.divided = VJP};
	for (int i = 0; i < ARGUMENTS; i++)
		s->place_of[i] = i;
	s->place_of[TAU] = places[rng_below(r, 3)];
	if (rng_chance(r, 0.7)) {
		s->place_of[VJP] = Q;
		s->period = NV;
		s->shift = rng_chance(r, 0.5) ? NQ - NV : 0;
	}
}

static void draw_dag(struct dag *d, struct rng *r)
{
	static const char *const names[ARGUMENTS] = {"q", "qd", "qdd", "weight", "tau", "vjp"};

	for (int i = 0; i < ARGUMENTS; i++)
		dag_argument(d, names[i], i == Q ? NQ : i == VJP ? 3 * NV : NV, i >= TAU);
	for (int i = 0; i < TAU; i++)
		for (int row = 0; row < d->arguments[i].rows; row++)
			for (int reading = 0; reading < 2 && rng_chance(r, 0.5); reading++)
				dag_input_anew(d, i, row, reading);
	dag_input(d, QDD, NV - 1);
	drawn_operations(d, r, 6 + rng_below(r, 20));
	for (int row = 0; row < 4 * NV; row++)
		if (rng_chance(r, 0.5))
			dag_output(d, row < NV ? TAU : VJP, row < NV ? row : row - NV, (struct ref){1 + (uint32_t)rng_below(r, (int)d->count - 1)});
}

START_TEST(test_drawn)
{
	int good = 0, bad = 0;

	for (unsigned long long seed = 1; seed <= DRAWS; seed++) {
		struct rng r = rng_seed(seed);
		const struct drawn_knobs knobs = {.named = rng_uniform(&r, 0, 1), .late = rng_uniform(&r, 0, 0.9),
			.named_inputs = seed % 2 ? 1 : 0.7};
		struct function f = {.stretches = NULL};
		struct stretches s;
		struct arena a;
		int found, expected;

		arena_init(&a, NULL);
		dag_init(&f.dag, &a);
		draw_dag(&f.dag, &r);
		draw_stretches(&s, &r);
		drawn_plan(&f.plan, &f.dag, &r, &knobs, &a);
		expected = runs(&f.plan, &s, &a);
		ck_assert(places_serve(&found, &f, &s, &a));
		ck_assert_msg(found == expected, "seed %llu: %s", seed, found ? "an input is lost" : "no input is lost");
		good += expected && (s.period || s.place_of[TAU] != TAU);
		bad += !expected;
		arena_free(&a);
	}
	ck_assert_msg(good > DRAWS / 8 && bad > DRAWS / 8, "%d serve, %d do not", good, bad);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("places");

	suite_add(s, "drawn", test_drawn, 1, 20);
	return suite_run(s);
}
