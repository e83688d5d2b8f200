#include "plan/segments.h"
#include "plan/early.h"
#include "plan/grid/owners.h"
#include "plan/stage.h"
#include <limits.h>

/* Loops on a processor. Segments of 400 to 1600 operations are as fast, within 4 %: batches of atlas take 0.89 to 0.93
   of the time of the whole, of yumi 0.93 to 0.99; one call 0.89, and 0.85. gcc 12 at -O3 takes a sixth of the time for
   both. Shorter ones compile faster: jvrc1 with 400 takes half the time of 800. */
enum { LOOP_LEAST = 980, LOOP_OPERATIONS = 500, LOOP_OVERHEAD = 8 };

/* Kernels (H100, 1 M samples, ps). f32: g1_brainco, 5700 operations in 2 segments, 643 instead of 1256; what the
   instruction cache holds is better whole: atlas 204 instead of 189, romeo 205 instead of 197. f64, where registers
   spill: jvrc1 515 instead of 653, romeo 526 instead of 574, g1_brainco 2487 instead of 3743; but not where the slice
   has room in shared memory: g1_29dof 540 instead of 438. All with --trig bounded, and before there were parts for
   limbs that share nothing. Accelerations: f32 of atlas 422 instead of 312; f64 1963 instead of 2553 (103 values
   across, in locals), but not where more goes across: g1_29dof 2971 instead of 3284 with 166, floating atlas 4789
   instead of 3767 with 177. The torques with their vjp in f64: atlas 1783 instead of 3073, jvrc1 3897 instead of 6579,
   floating hyq 1129 instead of 1737; but in f32 g1_29dof 594 instead of 438. In aos each segment fetches inputs that
   stand apart: g1_brainco in f64 4126 instead of 5007, but in f32 1766 to 2448 instead of 1034. */
enum { KERNEL_LEAST_SINGLE = 5000, KERNEL_LEAST_DOUBLE = 2500, KERNEL_LONG = 5000, KERNEL_OPERATIONS = 1500,
	KERNEL_LONG_OPERATIONS = 6000, FORWARD_OPERATIONS = 5000, FORWARD_ACROSS = 170, KERNEL_PRODUCT = 3500,
	PRODUCT_OPERATIONS = 2500 };

/* Bytes that a block's own shared memory has for each of two samples of 64, or 32, threads; rows that it stages instead. */
enum { ROOM_SINGLE = SHARED_BYTES / (2 * 64), ROOM_DOUBLE = SHARED_BYTES / (2 * 32), STAGED_ROWS = 96 };

static struct segment_limits loop_limits(unsigned flops)
{
	struct segment_limits none = {0}, x = {LOOP_OPERATIONS, LOOP_OVERHEAD, UINT_MAX};

	return flops > LOOP_LEAST ? x : none;
}

/* Rows of a sample that have a place. */
static int staged_rows(const struct dag *d)
{
	int rows = 0;

	for (int i = 0; i < d->argument_count; i++)
		rows += stage_has_place(d, i) ? d->arguments[i].rows : 0;
	return rows;
}

/* Derivatives of the torques times vectors, and no others. */
static int is_product(const struct request *k)
{
	return !k->is_forward && !request_wants(k, WANT_DTAU_DFREED) &&
		(request_wants(k, WANT_JVP) || request_wants(k, WANT_VJP));
}

/* Long torques in f64, where what spills costs more than inputs that stand apart. */
static int is_cut_in_aos(unsigned flops, const struct request *k, const struct rneagen_options *o)
{
	return o->precision == RNEAGEN_F64 && !k->is_forward && !request_wants_derivative(k) && flops > KERNEL_LONG;
}

static struct segment_limits kernel_limits(
	const struct function *p, unsigned flops, const struct request *k, const struct rneagen_options *o)
{
	struct segment_limits none = {0};
	int is_single = o->precision == RNEAGEN_F32;

	if (o->precision == RNEAGEN_F32X2 || owners_matrix(k) || (o->layout == RNEAGEN_AOS && !is_cut_in_aos(flops, k, o)))
		return none;
	if (request_wants_derivative(k))
		return is_product(k) && !is_single && flops > KERNEL_PRODUCT
			? (struct segment_limits){PRODUCT_OPERATIONS, 0, UINT_MAX} : none;
	if (k->is_forward)
		return o->precision == RNEAGEN_F64 && !k->refine_steps && flops > KERNEL_LONG ?
			(struct segment_limits){FORWARD_OPERATIONS, 0, FORWARD_ACROSS} : none;
	if (is_single)
		return flops > KERNEL_LEAST_SINGLE ? (struct segment_limits){KERNEL_LONG_OPERATIONS, 0, ROOM_SINGLE / 4} : none;
	if (flops <= KERNEL_LEAST_DOUBLE || staged_rows(&p->dag) <= STAGED_ROWS)
		return none;
	return (struct segment_limits){flops > KERNEL_LONG ? KERNEL_LONG_OPERATIONS : KERNEL_OPERATIONS, 0, ROOM_DOUBLE / 8};
}

static struct segment_limits limits_for(
	const struct function *p, enum segment_use use, const struct request *k, const struct rneagen_options *o)
{
	unsigned flops = plan_flops(plan_operations(&p->plan));
	struct segment_limits asked = {(unsigned)o->segments, 0, UINT_MAX};

	if (o->segments != RNEAGEN_SEGMENTS_AUTO)
		return asked;
	if (use == SEGMENT_AGAIN)
		return loop_limits(UINT_MAX);
	return use == SEGMENT_LOOPS ? loop_limits(flops) : kernel_limits(p, flops, k, o);
}

/* Accelerations alone take 0.95 of the time for g1_29dof, but 1.03 for arms. A batch's columns of their derivatives, each
   solved in lines of its own, gain nothing, and gcc takes up to 1.8 times as long. */
static int is_early(const struct function *p, enum segment_use use, const struct request *k)
{
	return use == SEGMENT_AGAIN ? p->dag.loop_count > 0 || !k->is_forward : use == SEGMENT_LOOPS && !k->is_forward;
}

int segments_choose(
	struct function *p, enum segment_use use, const struct request *k, const struct rneagen_options *o, struct arena *a)
{
	struct segment_limits limits;
	struct plan early = p->plan;

	p->segments = (struct segments){0};
	if (use == SEGMENT_NONE || o->segments == RNEAGEN_SEGMENTS_WHOLE)
		return 1;
	limits = limits_for(p, use, k, o);
	if (!limits.operations)
		return 1;
	if (is_early(p, use, k) && !plan_early(&early, &p->plan, a))
		return 0;
	if (!segments_make(&p->segments, &early, &limits, a))
		return 0;
	if ((p->segments.count < 2 && use != SEGMENT_AGAIN) ||
		(o->segments == RNEAGEN_SEGMENTS_AUTO && (unsigned)p->segments.slots[0] > limits.across))
		p->segments = (struct segments){0};
	return 1;
}

int segments_may_differ(const struct rneagen_options *o)
{
	return o->segments == RNEAGEN_SEGMENTS_AUTO && !o->strict && !o->bounded && stage_is_plain(o);
}

/* Outputs that are always zero are stored in a loop: among lines a compiler looks at each beside all others. Those of loops, and
   of what they read, stay. */
static int take_zeros(struct function *s, struct arena *a)
{
	struct output *zeros = arena_alloc(a, s->dag.output_count, sizeof *zeros);

	for (size_t i = 0; i < s->dag.output_count && zeros; i++)
		if (s->dag.outputs[i].argument < DAG_COLUMN && !s->dag.arguments[s->dag.outputs[i].argument].per_batch &&
			output_is_zero(&s->dag, &s->dag.outputs[i])) {
			zeros[s->zero_count++] = s->dag.outputs[i];
			s->dag.outputs[i].argument = DAG_UNSTORED;
		}
	dag_forget(&s->dag);
	s->zeros = zeros;
	return zeros != NULL;
}

/* Its lines; *is_built where `build` serves. 0 when memory runs out, or there are too many runs of columns. */
static int make_lines(struct function *s, const struct function *p, segments_build *build, const struct request *k,
	struct arena *a, int *is_built)
{
	struct arena spare;
	struct dag raw;

	arena_init(&spare, &a->allocator);
	dag_init(&raw, &spare);
	*is_built = build(&raw, p, k);
	dag_init(&s->dag, a);
	if (*is_built)
		dag_fuse(&s->dag, &raw, 0);
	a->failed |= spare.failed;
	arena_free(&spare);
	if (*is_built && !s->dag.failed && dag_loops_in_place(&s->dag) && !take_zeros(s, a))
		return 0;
	return !*is_built || (!s->dag.failed && plan_build(&s->plan, &s->dag, p->plan.tree, a));
}

int segments_once_more(struct function **made, const struct function *p, segments_build *build, const char *name,
	const struct request *k, const struct rneagen_options *o, struct arena *a)
{
	struct algorithm *x = arena_alloc(a, 1, sizeof *x);
	struct function *s = arena_alloc(a, 1, sizeof *s);
	int is_built;

	*made = NULL;
	if (!x || !s || !make_lines(s, p, build, k, a, &is_built) || !is_built)
		return !a->failed;
	*x = *p->algorithm;
	x->name = name;
	s->algorithm = x;
	if (!segments_choose(s, SEGMENT_AGAIN, k, o, a))
		return 0;
	if (plan_sincos(&s->plan) == plan_sincos(&p->plan))
		*made = s;
	return 1;
}

static int build_back(struct dag *d, const struct function *p, const struct request *k)
{
	return algorithm_build_way_back(d, p->plan.tree, k, 0);
}

static int build_looped(struct dag *d, const struct function *p, const struct request *k)
{
	return algorithm_build_looped(d, p->plan.tree, k, LOOPED_SINGLE);
}

/* A loop's body is told what goes across, and its column; so it must read some of these values, and no input, and leave none for
   another one. */
static int is_closed(const struct function *s)
{
	for (int k = s->segments.count - s->dag.loop_count; k < s->segments.count; k++) {
		const struct plan *lines = &s->segments.plans[k];
		int fetched = 0, kept = 0;

		for (const struct line *l = lines->lines; l < lines->lines + lines->line_count; l++) {
			fetched |= l->kind == LINE_FETCH && l->index > 0;
			kept |= l->kind == LINE_KEEP;
		}
		if (!fetched || kept || segments_reads_input(lines))
			return 0;
	}
	return 1;
}

int segments_single(struct function *p, const struct request *k, const struct rneagen_options *o, struct arena *a)
{
	static segments_build *const builds[] = {build_back, build_looped};
	struct function *s;

	for (int i = 0; i < 2 && p->segments.count && segments_may_differ(o) && !p->single; i++) {
		if (!segments_once_more(&s, p, builds[i], k->is_forward ? "fd_single" : "rnea_single", k, o, a))
			return 0;
		if (s && is_closed(s))
			p->single = s;
	}
	return !a->failed;
}

/* Batches in f64, against those whose columns have lines of their own (Zen 5, gcc 12 at -O3): time; seconds to compile, from and
   to. g1_brainco, floating, 0.61; 68, 35; on the ground, 170000 operations, 0.52; 32, 29. Floating jvrc1, 122000, 0.65; 29, 16;
   g1_29dof, 90000, 0.89; 33, 13; atlas, 87000, 0.90; 33, 13; simple_humanoid, 75000, 0.90; 30, 11. jvrc1, 57000, 0.95, for AVX2
   0.88; 22, 16. But atlas, 24000, 1.40; floating hyq, 22000, 1.34. In f32 jvrc1 1.29, floating jvrc1 1.01; 35, 28; g1_29dof 1.16;
   50, 16; simple_humanoid 0.99; 39, 14. In aos columns are fetched and stored apart: floating atlas 1.3, jvrc1 0.95, g1_brainco
   1.06; 96, 38. */
enum { MANY_LEAST = 50000, MANY_LEAST_SINGLE = 60000, MANY_LEAST_AOS = 100000 };

static int build_many(struct dag *d, const struct function *p, const struct request *k)
{
	return dag_loops_go_back(&p->single->dag) ? algorithm_build_way_back(d, p->plan.tree, k, 1)
		: algorithm_build_looped(d, p->plan.tree, k, LOOPED_BATCH);
}

/* In aos, from a sample to the next: the same for all matrices of a loop. */
static int is_even(const struct dag *d)
{
	for (int i = 1; i < d->run_count; i++)
		if (d->runs[i].loop == d->runs[i - 1].loop &&
			d->arguments[d->runs[i].argument].rows != d->arguments[d->runs[i - 1].argument].rows)
			return 0;
	return 1;
}

int segments_many(struct function *p, const struct request *k, const struct rneagen_options *o, struct arena *a)
{
	unsigned least = o->layout == RNEAGEN_AOS ? MANY_LEAST_AOS : o->precision == RNEAGEN_F32 ? MANY_LEAST_SINGLE : MANY_LEAST;
	struct function *s;

	if (!p->single || (!dag_loops_go_back(&p->single->dag) && plan_flops(plan_operations(&p->plan)) < least))
		return !a->failed;
	if (!segments_once_more(&s, p, build_many, k->is_forward ? "fd_many" : "rnea_many", k, o, a))
		return 0;
	if (s && is_closed(s) && is_even(&s->dag))
		p->many = s;
	return 1;
}
