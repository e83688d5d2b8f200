/* What a part holds, and what that costs. */
#include "plan/grid/splitter.h"

/* What one part may hold and be without a loss (sm_90): values alive at once, of which registers hold some 250 floats
   or 125 doubles and shared memory, in blocks of 64, 192 or 96 more, less what the compiler's order of things takes;
   and operations, each about an instruction of 16 bytes, for the instruction cache. */
enum { ALIVE_SINGLE = 280, ALIVE_DOUBLE = 170, OPERATIONS = 7000, OPERATIONS_DOUBLE = 6500 };

/* Of a text longer than LONG parts are measured less exactly. */
enum { LONG = 250000 };

struct size splitter_plan_size(const struct plan *p, struct arena *a)
{
	return (struct size){.alive = plan_alive(p, a), .operations = 1 + (int)plan_flops(plan_operations(p))};
}

/* The size of the part of these owners, made in an arena of its own; before it is fused that takes a sixth of the time and is
   off by less than 8 % (30 robots, chains). */
static struct size make_size(struct splitter *s, int first, int end, int is_fused)
{
	struct arena a;
	struct dag raw, fused;
	struct plan plan = {.dag = is_fused ? &fused : &raw};
	struct size z = {.operations = 1};

	arena_init(&a, s->x->options->allocator);
	share_copy(&s->share, first, end, &raw, &a);
	if (is_fused) {
		dag_init(&fused, &a);
		dag_fuse(&fused, &raw, s->x->options->strict);
	}
	if (!plan.dag->failed)
		z = splitter_plan_size(&plan, &a);
	s->failed |= plan.dag->failed | a.failed;
	arena_free(&a);
	return z;
}

static int is_long(const struct splitter *s)
{
	return s->sizes[s->count].operations > LONG;
}

const struct size *splitter_size(struct splitter *s, int first, int end)
{
	struct size *known = &s->sizes[first * (s->count + 1) + end];

	if (!known->operations)
		*known = make_size(s, first, end, !is_long(s));
	return known;
}

static int most_alive(const struct splitter *s)
{
	return s->x->options->precision == RNEAGEN_F32 ? ALIVE_SINGLE : ALIVE_DOUBLE;
}

/* The larger of its shares of what a part may be. */
int splitter_fullness(struct splitter *s, int first, int end)
{
	const struct size *z = splitter_size(s, first, end);
	long long alive = (long long)z->alive * FULL / most_alive(s), operations = (long long)z->operations * FULL / OPERATIONS;
	long long most = alive > operations ? alive : operations;

	return most < MOST ? (int)most : MOST;
}

static double within(double x, double most)
{
	return x < 0 ? 0 : x > most ? most : x;
}

/* The same of texts of forward dynamics, which are longer. H100, qdd and both gradients, 1 M samples, ns beside the number of
   parts, f32: floating hyq, 1 to 5 parts 6.5 4.8 2.5 2.8 2.9; atlas, 4 to 8, 10 and 12 parts 7.0 7.5 6.4 5.5 6.1 6.1 6.3, by base
   parameters 4 to 9 parts 6.7 6.9 5.1 4.2 4.2 4.7; g1_29dof, 4 and 6 parts 6.6 7.5: what this says is off by 12 % (rms). f64,
   where what waits is spilled to memory: panda, 1 to 3 parts 1.83 0.93 1.00, iiwa14 0.43 0.56 0.71, atlas, 4, 6, 8 and 12
   parts 24.6 31.4 32.0 33.6. Where links stand a whole holds more than was measured: floating hyq on four feet, in f32, 867
   values, and 150 kB are spilled; nine parts hold 430 to 620 and spill 14 kB together (nvcc 13 for sm_90). */
static double forward_loss_of(const struct splitter *s, const struct size *z)
{
	int is_single = s->x->options->precision == RNEAGEN_F32;
	double longer = (z->operations - OPERATIONS) / (is_single ? 4000.0 : 8000.0);
	double more = is_single ? (z->alive - 317) / 48.0 : 2.4 * ((double)z->alive / ALIVE_DOUBLE - 1);

	double most = s->x->request->contact_count ? MOST : is_single ? 7 : 2.4;

	return (1 + within(longer, is_single ? 1.75 : 2)) * (1 + within(more, most));
}

/* How many times as much an operation of such a part takes as one of a part that loses nothing. H100, both gradients, us
   measured, and in brackets what this says, summed, beside the number of parts that it takes: atlas at 131072 samples in
   f32, 3 to 6 and 8 parts 300 299 325 357 411 (348 299 336 372 442), in f64, 4 to 6 and 8 parts 803 802 798 915 (891 802
   886 1159); floating hyq at 262144 in f32, 1 to 3 parts 350 271 307 (460 271 299). Whole, atlas's warps wait for
   instructions in three quarters of their cycles. Of parts alone in f64, with constants in a table: up to 8200 instructions, 128
   KiB, a million samples take 85 to 120 ps for each thousand of them, of 8640 161, of 9000 195, of 9200 209 and 229, of 9750 239;
   an operation is 1.15 to 1.3 instructions. In f32 it is one, and parts of up to 7900 take 45 to 75. */
static double loss_of(const struct splitter *s, const struct size *z)
{
	if (s->x->request->is_forward)
		return forward_loss_of(s, z);
	int is_single = s->x->options->precision == RNEAGEN_F32;
	double longer = is_single ? (z->operations - OPERATIONS) / 2000.0 : (z->operations - OPERATIONS_DOUBLE) / 900.0;
	double more = (double)z->alive / most_alive(s) - 1;

	/* nothing was measured beyond 0.6 */
	return (1 + 1.5 * within(longer, 1)) * (1 + 0.8 * within(more, 0.6));
}

double splitter_cost(struct splitter *s, int first, int end)
{
	const struct size *z = splitter_size(s, first, end);

	return z->operations * loss_of(s, z);
}

/* Can a part lose less than the whole, where to look takes long a quarter less? Not on a long chain, where each takes all bodies'
   motions. No part is smaller than the elements of one of its owners, less a tenth for what these are before they are fused. */
int splitter_can_gain(struct splitter *s)
{
	double most = loss_of(s, splitter_size(s, 0, s->count)) * (is_long(s) ? 0.75 : 1);

	for (int k = s->count; k-- > 0 && !s->failed;) {
		struct size z = make_size(s, k, k + 1, 0);

		z.alive -= z.alive / 10;
		z.operations -= z.operations / 10;
		if (loss_of(s, &z) < most)
			return 1;
	}
	return 0;
}
