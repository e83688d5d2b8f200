/* The expressions are those of loops over columns; what each kernel writes tells what it is to make. */
#include "plan/grid/relay.h"
#include "plan/grid/apart.h"
#include "plan/limbs/limb_limits.h"
#include "plan/segments.h"
#include "plan/stage.h"
#include <limits.h>
#include <string.h>

/* Operations of the one kernel. H100, half a million samples, ns each, in one kernel and in a relay: floating hyq, 19000, f32 2.6
   and 2.5, f64 14.3 and 4.7; atlas, 34000, f64 24.7 and 9.6; 1024 samples, us: hyq 27.6 and 22.2, 45.3 and 34.0, atlas 63
   and 50.5. f32, 1 sample, us, 1024, 16384, and a million, ns, and seconds of NVRTC: shadow_hand, 23000, 30.4 at
   1024, 89.7, 4.72, 16 s, and 28.1, 79.8, 3.54, 3 s; atlas 27.7, 28.3, 148, 5.52, 13 s, and 25.4, 35.6, 110, 4.23, 4 s before its
   first kernel had parts; g1_29dof 35.9, 37.0, 121, 6.45, 14 s, and 28.3, 38.6, 108, 4.11, 7 s. Nothing smaller was tried. */
enum { LEAST_OPERATIONS = 12000 };

/* Warps of 255 and of 168 registers that a multiprocessor has room for; blocks that gain nothing from more beside them in f64. */
enum { WARPS = 8, WARPS_SHORT = 12, DOUBLE_BLOCKS = 4 };

/* Values at once of a part of the first kernel in f64, beyond which its limbs serve more samples than beside other parts, and how
   many. H200, both gradients, us, the first kernel in segments, in parts, and by limbs; in brackets values in a part: 64, 1024,
   2048 and 4096 samples: atlas (206) 39.2 43.2 38.9, 50.0 52.4 50.1, 61.4 63.5 62.0, 75.5 81.0 79.2; g1_29dof (179) in parts
   unstaged, staged, and by limbs 43.6 39.1 40.2, 55.3 51.3 55.8, 64.3 59.3 66.8, 78.1 75.4 80.9. */
enum { START_ALIVE_DOUBLE = 190, START_MOST = 2048 };

/* Which kernel writes an output. */
enum { START, COLUMNS, SOLVE, KERNELS };

static int may_be_relayed(const struct parts_of *x)
{
	const struct rneagen_options *o = x->options;

	if (!x->has_kernels || !x->is_unpruned || !x->request->is_forward)
		return 0;
	if (o->layout != RNEAGEN_SOA || o->strict || !stage_is_plain(o))
		return 0;
	if (o->parts != RNEAGEN_PARTS_AUTO || o->segments != RNEAGEN_SEGMENTS_AUTO)
		return 0;
	return plan_flops(plan_operations(&x->whole->plan)) >= LEAST_OPERATIONS;
}

static int *kernels_of(const struct dag *d, struct arena *a)
{
	int qdd = dag_find_role(d, ROLE_JOINT_ACCELERATION, 1), *kernel = arena_alloc(a, d->output_count, sizeof *kernel);

	for (size_t i = 0; i < d->output_count && kernel; i++) {
		int argument = d->outputs[i].argument;

		kernel[i] = argument >= DAG_COLUMN ? SOLVE : argument == qdd ? START : COLUMNS;
	}
	return kernel;
}

static void drop_loops(struct dag *d)
{
	d->loop_count = d->run_count = 0;
}

/* The algorithm anew, in the way that is cheaper for qdd alone. Returns 0 where its arrays are not the first ones
   of the whole. */
static int build_alone(struct dag *d, const struct request *alone, const struct parts_of *x)
{
	const struct dag *whole = &x->whole->dag;
	int count;

	x->whole->algorithm->build(d, x->tree, alone);
	count = d->argument_count;
	for (int i = 0; i < count; i++)
		if (strcmp(d->arguments[i].name, whole->arguments[i].name))
			return 0;
	for (int i = count; i < whole->argument_count; i++)
		dag_argument_of(d, whole->arguments[i]);
	return 1;
}

/* In parts where limbs share nothing, else in segments where that pays, unless outputs are transposed. */
static int divide_start(
	struct relay *r, const struct dag *raw, const struct request *alone, const struct parts_of *x, struct arena *a)
{
	const struct parts_of own = {.whole = &r->start.function, .raw = raw, .tree = x->tree, .request = alone, .options = x->options,
		.has_kernels = 1};

	if (raw && !apart_make(&r->starts, &r->start_count, &own, a))
		return 0;
	return r->start_count || x->is_transposed || segments_choose(&r->start.function, SEGMENT_KERNEL, alone, x->options, a);
}

static int build_start(struct relay *r, struct share *share, const char *name, const struct parts_of *x, struct arena *spare,
	struct arena *a)
{
	static const char doc[] = "The accelerations alone.";
	struct want *qdd = arena_alloc(a, 1, sizeof *qdd);
	struct request alone;
	struct dag raw;
	int is_alone;

	if (!qdd)
		return 0;
	alone = request_of_accelerations(x->request, qdd);
	dag_init(&raw, spare);
	is_alone = build_alone(&raw, &alone, x);
	if (is_alone ? raw.failed || !part_build(&r->start, &raw, name, doc, x, a)
		     : !part_build_share(&r->start, share, START, START + 1, name, doc, x, a))
		return 0;
	drop_loops(&r->start.function.dag);
	return plan_order(&r->start.function, x->tree, &alone, x->options, ORDERED_WHOLE, a) &&
		divide_start(r, is_alone ? &raw : NULL, &alone, x, a);
}

/* The factors of M as one segment, which leaves them for the loops. */
static int build_solve(struct relay *r, struct share *share, const char *name, const struct parts_of *x, struct arena *a)
{
	static const struct segment_limits limits = {INT_MAX, 0, UINT_MAX};
	static const char doc[] = "The factors of M, and d qdd = M^-1 of the columns that stand in its place.";

	return part_build_share(&r->solve, share, SOLVE, KERNELS, name, doc, x, a) &&
		segments_make(&r->solve.function.segments, &r->solve.function.plan, &limits, a);
}

/* All parts of the second kernel together. */
static int build_between(struct relay *r, struct share *share, struct dag *columns, const struct parts_of *x, struct arena *spare,
	struct arena *a)
{
	share_copy(share, COLUMNS, COLUMNS + 1, columns, spare);
	drop_loops(columns);
	r->between.algorithm = x->whole->algorithm;
	dag_init(&r->between.dag, a);
	dag_fuse(&r->between.dag, columns, 0);
	return plan_build(&r->between.plan, &r->between.dag, x->tree, a);
}

static const char *name_of(const struct parts_of *x, const char *what, struct arena *a)
{
	return text_format(a, "%s_%s", x->whole->algorithm->name, what);
}

static int build(struct relay *r, const struct dag *raw, struct dag *columns, const struct parts_of *x, struct arena *spare,
	struct arena *a)
{
	struct share share;
	int *kernel = kernels_of(raw, spare);

	return kernel && share_begin(&share, raw, kernel, spare) && build_start(r, &share, name_of(x, "start", a), x, spare, a) &&
		build_solve(r, &share, name_of(x, "solve", a), x, a) && build_between(r, &share, columns, x, spare, a);
}

static int bytes_of(const struct relay *r, const struct rneagen_options *o, int samples)
{
	return r->solve.function.segments.slots[0] * stage_number_bytes(o) * samples;
}

int relay_bytes(const struct relay *r, const struct rneagen_options *o)
{
	return bytes_of(r, o, r->samples);
}

/* Blocks of so many samples of the third kernel for which a multiprocessor's shared memory has room; each takes 1 KiB more. */
static int fitting(const struct relay *r, const struct rneagen_options *o, int samples)
{
	return MULTIPROCESSOR_BYTES / (bytes_of(r, o, samples) + 1024);
}

/* Blocks of a small batch beyond which more along y gain nothing: each makes the factors anew, and those that do not run at once
   wait. H100, 1024 samples, us, 8, 16 and 32 along y, of which 24 have room: atlas in f64 52.3, 49.7 and 58.7; 4096 samples, 4
   and 6: 80.7 and 88.5; where 8 have room, floating atlas in f64: 168, with 16 222. H200, 4096 samples, 8 and 12 along y of 64
   samples each: atlas in f32 48.9 and 53.0, g1_29dof 44.0 and 47.8; 2 and 4 with two threads for each sample: atlas in f64 76.9
   and 79.5. */
static int side_by_side(const struct relay *r, const struct rneagen_options *o)
{
	int fit = fitting(r, o, r->samples), most = WARPS * WARP_THREADS / (r->threads * r->samples);

	if (o->precision == RNEAGEN_F64)
		most = r->threads > 1 ? DOUBLE_BLOCKS / 2 : DOUBLE_BLOCKS;
	return fit < most ? fit : most;
}

/* As many warps as registers have room for. Where shared memory has room for the factors of fewer warps, several threads share
   a sample's columns. In f32, where it has room for those of WARPS_SHORT, the factors of M take no more than 168 registers, and
   blocks of two warps' samples read and write longer pieces of rows. H200, ps for each of a million samples, with a thread for
   each sample in blocks of a warp, and so: floating g1_29dof in f32 14710 and 12400, floating atlas 13390 and 12740, in f64 atlas
   7810 and 7560, g1_29dof 7290 and 7050, floating hyq 3780 and 3860 (16384 samples, us: 89 and 82); and with two warps' samples,
   in f32 atlas 3880 and 3270, of them by 8 warps 3680, by 12 in blocks of one 3750, of four 3350; g1_29dof 3580 and 3320,
   floating hyq 2230 and 1900. */
static void set_grid(struct relay *r, const struct rneagen_options *o)
{
	enum { WIDE = 2 * WARP_THREADS };
	int is_wide = o->precision == RNEAGEN_F32 && 2 * fitting(r, o, WIDE) >= WARPS_SHORT;

	r->samples = is_wide ? WIDE : WARP_THREADS;
	if (relay_bytes(r, o) > ASKED_BYTES)
		return;
	for (r->threads = 1; !is_wide && r->threads * fitting(r, o, WARP_THREADS) < WARPS; r->threads *= 2)
		;
	r->blocks = is_wide ? WARPS_SHORT / 2 : WARPS / r->threads;
	r->room = MULTIPROCESSORS * side_by_side(r, o);
}

/* Each loop has a segment of its own, which reads nothing but columns and what goes across; and there are columns. */
static int is_closed(const struct relay *r)
{
	const struct function *p = &r->solve.function;

	if (!p->dag.run_count || p->segments.count != p->dag.loop_count + 1)
		return 0;
	for (int k = 1; k < p->segments.count; k++)
		if (segments_reads_input(&p->segments.plans[k]))
			return 0;
	return 1;
}

/* NULL where a relay does not serve, or memory runs out; `columns`: what the second kernel's parts are to make. */
static struct relay *make(struct dag *columns, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	struct relay *r = arena_alloc(a, 1, sizeof *r);
	struct dag raw;

	dag_init(&raw, spare);
	if (!r || !algorithm_build_looped(&raw, x->tree, x->request, LOOPED_RELAY))
		return NULL;
	if (raw.failed && !spare->failed) /* there are too many runs of columns */
		return NULL;
	if (raw.failed || !build(r, &raw, columns, x, spare, a)) {
		a->failed = 1;
		return NULL;
	}
	if (is_closed(r))
		set_grid(r, x->options);
	return r->threads ? r : NULL;
}

enum rneagen_code relay_or_parts(struct relay **relay, struct part **parts, int *count, const struct parts_of *x, struct arena *a,
	struct rneagen_error *e)
{
	struct request torques = *x->request; /* the parts are as of torques' gradients */
	struct parts_of second = *x;
	struct arena spare;
	struct dag columns;

	arena_init(&spare, x->options->allocator);
	*relay = may_be_relayed(x) ? make(&columns, x, &spare, a) : NULL;
	a->failed |= spare.failed;
	torques.is_forward = 0;
	if (*relay)
		second = (struct parts_of){.whole = &(*relay)->between, .raw = &columns, .tree = x->tree, .request = &torques,
			.options = x->options, .has_kernels = 1, .is_relayed = 1};
	if (a->failed)
		error_memory(e);
	else
		parts_make(parts, count, &second, a, e);
	arena_free(&spare);
	return e->code;
}

/* A loop's body counts for each of its columns. */
static void add_solve(struct operation_count *sum, const struct function *p)
{
	const struct dag *d = &p->dag;
	size_t end = d->count;
	int loop = d->loop_count;

	for (size_t s = d->section_count; s-- > 0 && loop > 0;) {
		if (d->sections[s].kind != SECTION_COLUMNS)
			continue;
		loop--;
		plan_add_operations(sum, plan_operations_of(d, d->sections[s].node, end), (unsigned)dag_loop_columns(d, loop));
		end = d->sections[s].node;
	}
	struct operation_count factors = plan_operations_of(d, 0, end);

	factors.sincos = plan_sincos(&p->plan);
	plan_add_operations(sum, factors, 1);
}

struct operation_count relay_operations(const struct relay *r, const struct part *parts, int count)
{
	struct operation_count sum = parts_operations(parts, count, NULL);

	plan_add_operations(&sum, plan_operations(&r->start.function.plan), 1);
	add_solve(&sum, &r->solve.function);
	return sum;
}

int relay_columns(const struct relay *r)
{
	const struct dag *d = &r->solve.function.dag;
	int columns = 0;

	for (int i = 0; i < d->run_count; i++)
		columns += d->runs[i].count;
	return columns;
}

void relay_dump(const struct relay *r, struct text *out)
{
	struct operation_count solve = {0};

	add_solve(&solve, &r->solve.function);
	text_printf(out, "start: %u flops, %d values at once, parts: %d\n", plan_flops(plan_operations(&r->start.function.plan)),
		r->start_count ? parts_alive(r->starts, r->start_count) : r->start.alive, r->start_count ? r->start_count : 1);
	text_printf(out, "solve: %u flops, %d values for %d loops over %d columns, %d threads for each of %d samples\n",
		plan_flops(solve), r->solve.function.segments.slots[0], r->solve.function.dag.loop_count, relay_columns(r), r->threads,
		r->samples);
}

int relay_limbs(struct relay *r, const struct rneagen_options *o, struct arena *a)
{
	struct function *start = &r->start.function;

	if (!limbs_choose(&start, 1, o, a))
		return 0;
	if (r->start_count)
		limbs_beside_starts(&start->limbs, o);
	if (o->precision == RNEAGEN_F64 && parts_alive(r->starts, r->start_count) > START_ALIVE_DOUBLE)
		start->limbs.most = START_MOST;
	return 1;
}
