/* Any share of the outputs makes a part: the DAG drops what it does not need. */
#include "plan/grid/parts.h"
#include "plan/grid/apart.h"
#include "plan/grid/owners.h"
#include "plan/grid/share.h"
#include "plan/stage.h"

/* What one part may hold and be without a loss (sm_90): values alive at once, of which registers hold some 250 floats
   or 125 doubles and shared memory, in blocks of 64, 192 or 96 more, less what the compiler's order of things takes;
   and operations, each about an instruction of 16 bytes, for the instruction cache. */
enum { ALIVE_SINGLE = 280, ALIVE_DOUBLE = 170, OPERATIONS = 7000 };

/* A part of fullness FULL has all that it may take; of more than MOST there is none. */
enum { FULL = 1000, MOST = 1 << 20 };

/* How many more parts than the best so far are tried; of a text longer than LONG parts are measured less exactly. */
enum { LOOK_AHEAD = 6, LONG = 250000 };

/* Parts in layout aos at most: they cut lines of matrices, and write parts of sectors (H100, gradients of atlas, whole matrices, 1, 2, 3 and 4 parts, ns: 7.9, 6.6, 9.1 and 9.4, in f64 16.2,
   16.6, 17.2 and 18.1; 1024 samples, us: 63, 38, 31 and 32, in f64 88, 61, 49 and 49). */
enum { PARTS_IN_AOS = 2 };

struct size {
	int alive;      /* values at once: plan_alive */
	int operations; /* plan_flops, and 1 */
};

struct splitter {
	const struct parts_of *x;
	struct share share; /* of x->raw */
	struct arena *a;
	struct owners owners;
	int count;          /* of owners */
	struct size *sizes; /* [first][end]: of such a part; 0 operations: not known yet */
	int failed;
};

/* ---- a part ---- */

static struct size size_of_plan(const struct plan *p, struct arena *a)
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
		z = size_of_plan(&plan, &a);
	s->failed |= plan.dag->failed | a.failed;
	arena_free(&a);
	return z;
}

static int is_long(const struct splitter *s)
{
	return s->sizes[s->count].operations > LONG;
}

static const struct size *size_of(struct splitter *s, int first, int end)
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
static int fullness_of(struct splitter *s, int first, int end)
{
	const struct size *z = size_of(s, first, end);
	long long alive = (long long)z->alive * FULL / most_alive(s), operations = (long long)z->operations * FULL / OPERATIONS;
	long long most = alive > operations ? alive : operations;

	return most < MOST ? (int)most : MOST;
}

static double within(double x, double most)
{
	return x < 0 ? 0 : x > most ? most : x;
}

/* The same of texts of forward dynamics, which are longer. H100, qdd and both gradients, 1 M samples, ns beside the number of parts,
   f32: floating hyq, 1 to 5 parts 6.5 4.8 2.5 2.8 2.9; atlas, 4 to 8, 10 and 12 parts 7.0 7.5 6.4 5.5 6.1 6.1 6.3, by base parameters
   4 to 9 parts 6.7 6.9 5.1 4.2 4.2 4.7; g1_29dof, 4 and 6 parts 6.6 7.5: what this says is off by 12 % (rms). f64, where what waits is
   spilled to memory: panda, 1 to 3 parts 1.83 0.93 1.00, iiwa14 0.43 0.56 0.71, atlas, 4, 6, 8 and 12 parts 24.6 31.4 32.0 33.6. */
static double forward_loss_of(const struct splitter *s, const struct size *z)
{
	int is_single = s->x->options->precision == RNEAGEN_F32;
	double longer = (z->operations - OPERATIONS) / (is_single ? 4000.0 : 8000.0);
	double more = is_single ? (z->alive - 317) / 48.0 : 2.4 * ((double)z->alive / ALIVE_DOUBLE - 1);

	return (1 + within(longer, is_single ? 1.75 : 2)) * (1 + within(more, is_single ? 7 : 2.4));
}

/* How many times as much an operation of such a part takes as one of a part that loses nothing. H100, both gradients, us
   measured, and in brackets what this says, summed, beside the number of parts that it takes: atlas at 131072 samples in
   f32, 3 to 6 and 8 parts 300 299 325 357 411 (348 299 336 372 442), in f64, 4 to 6 and 8 parts 803 802 798 915 (891 802
   886 1159); floating hyq at 262144 in f32, 1 to 3 parts 350 271 307 (460 271 299). Whole, atlas's warps wait for
   instructions in three quarters of their cycles. */
static double loss_of(const struct splitter *s, const struct size *z)
{
	if (s->x->request->is_forward)
		return forward_loss_of(s, z);
	double longer = (z->operations - OPERATIONS) / 2000.0, more = (double)z->alive / most_alive(s) - 1;

	/* nothing was measured beyond 0.6 */
	return (1 + 1.5 * within(longer, 1)) * (1 + 0.8 * within(more, 0.6));
}

static double cost_of(struct splitter *s, int first, int end)
{
	const struct size *z = size_of(s, first, end);

	return z->operations * loss_of(s, z);
}

/* Can a part lose less than the whole, where to look takes long a quarter less? Not on a long chain, where each takes all bodies'
   motions. No part is smaller than the elements of one of its owners, less a tenth for what these are before they are fused. */
static int can_gain(struct splitter *s)
{
	double most = loss_of(s, size_of(s, 0, s->count)) * (is_long(s) ? 0.75 : 1);

	for (int k = s->count; k-- > 0 && !s->failed;) {
		struct size z = make_size(s, k, k + 1, 0);

		z.alive -= z.alive / 10;
		z.operations -= z.operations / 10;
		if (loss_of(s, &z) < most)
			return 1;
	}
	return 0;
}

/* ---- where the parts begin ---- */

/* The first body of a part that ends here, of fullness `most`, with `left` bodies left over for others: by bisection,
   since more bodies fill more. */
static int first_body(struct splitter *s, int end, int left, int most)
{
	int good = end - 1, bad = left - 1;

	while (good - bad > 1) {
		int middle = (good + bad) / 2;

		if (fullness_of(s, middle, end) <= most)
			good = middle;
		else
			bad = middle;
	}
	return good;
}

/* From the last body on, `count` parts, each as large as a fullness of `most` allows. first[0] is of the last part. Returns 0
   where they are too few. */
static int split(struct splitter *s, int count, int most, int *first)
{
	int end = s->count;

	for (int made = 0; made < count; made++) {
		first[made] = first_body(s, end, count - made - 1, most);
		if (fullness_of(s, first[made], end) > most)
			return 0;
		end = first[made];
	}
	return end == 0;
}

/* So many parts that the fullest is as little full as can be. Returns 0 where there is no such split. */
static int split_evenly(struct splitter *s, int count, int *first)
{
	int bad = 0, good = fullness_of(s, 0, s->count);

	/* alone, what a part has in common with others may be a little more than in the whole */
	if (!split(s, count, good, first))
		good = MOST;
	while (good - bad > 1) {
		int middle = (good + bad) / 2;

		if (split(s, count, middle, first))
			good = middle;
		else
			bad = middle;
	}
	return split(s, count, good, first);
}

static double cost_of_split(struct splitter *s, int count, const int *first)
{
	double sum = 0;

	for (int i = 0, end = s->count; i < count; end = first[i++])
		sum += cost_of(s, first[i], end);
	return sum;
}

/* In aos, where the arrays have room in shared memory, each block writes whole samples. */
static int may_have(const struct splitter *s)
{
	return s->x->options->layout == RNEAGEN_SOA || !stage_fits(&s->x->whole->dag, s->x->options);
}

/* As many parts as cost least. One more need not cost less where a few more do: only when all fit is nothing lost. */
static int choose_count(struct splitter *s, int *first)
{
	double least = cost_of(s, 0, s->count);
	int best = 1;

	if (fullness_of(s, 0, s->count) <= FULL || !can_gain(s) || !may_have(s))
		return 1;
	for (int count = 2; count <= s->count && count <= best + LOOK_AHEAD; count++) {
		double cost = split_evenly(s, count, first) ? cost_of_split(s, count, first) : least;

		if (cost < least) {
			least = cost;
			best = count;
		}
	}
	return s->x->options->layout == RNEAGEN_AOS && best > PARTS_IN_AOS ? PARTS_IN_AOS : best;
}

int part_build(struct part *p, const struct dag *raw, const char *name, const char *doc, const struct parts_of *x, struct arena *a)
{
	p->algorithm = (struct algorithm){.name = name, .doc = doc};
	p->pass.algorithm = &p->algorithm;
	dag_init(&p->pass.dag, a);
	dag_fuse(&p->pass.dag, raw, x->options->strict);
	if (!plan_build(&p->pass.plan, &p->pass.dag, x->tree, a))
		return 0;
	p->alive = plan_alive(&p->pass.plan, a);
	return !a->failed;
}

int part_build_share(struct part *p, struct share *share, int first, int end, const char *name, const char *doc,
	const struct parts_of *x, struct arena *a)
{
	struct arena spare;
	struct dag raw;
	int is_built;

	arena_init(&spare, x->options->allocator);
	share_copy(share, first, end, &raw, &spare);
	is_built = part_build(p, &raw, name, doc, x, a);
	arena_free(&spare);
	return is_built;
}

static int make_part(struct splitter *s, int number, int first, int end, struct part *p)
{
	struct text name, doc;

	p->first = s->owners.bodies[first];
	p->last = s->owners.bodies[end - 1];
	text_init(&name, s->a);
	text_init(&doc, s->a);
	text_printf(&name, "%s_part%d", s->x->whole->algorithm->name, number);
	text_printf(&doc, "Part %d of it: elements of matrices by the joints of links %d to %d%s.", number,
		s->x->tree->bodies[p->first].number, s->x->tree->bodies[p->last].number,
		first ? "" : ", and all that is no matrix");
	return part_build_share(p, &s->share, first, end, text_string(&name), text_string(&doc), s->x, s->a) && !name.failed && !doc.failed;
}

/* ---- the whole ---- */

static int begin(struct splitter *s)
{
	if (!owners_make(&s->owners, s->x->raw, s->x->tree, s->x->request, !s->x->is_relayed, s->a))
		return 0;
	s->count = s->owners.count;
	s->sizes = arena_alloc(s->a, (size_t)(s->count + 1) * (size_t)(s->count + 1), sizeof *s->sizes);
	if (!s->sizes)
		return 0;
	s->sizes[s->count] = size_of_plan(&s->x->whole->plan, s->a); /* from the first to the last: that is made already */
	return share_begin(&s->share, s->x->raw, s->owners.owner, s->a) && !s->a->failed;
}

/* Why a text cannot be in parts; NULL: it can. */
static const char *obstacle(const struct request *k, int has_kernels)
{
	if (!has_kernels)
		return "is for kernels: take --target cuda";
	if (!owners_matrix(k))
		return "is for matrices: name one in --want, such as dtau_dq, M or dqdd_dq";
	return NULL;
}

/* Returns how many parts there are, 0 after an error; first[0] is where the last of them begins, if there are several. */
static int choose(struct splitter *s, int *first, struct rneagen_error *e)
{
	int count = s->x->options->parts == RNEAGEN_PARTS_AUTO ? choose_count(s, first) : s->x->options->parts;

	if (count == 1 || (count <= s->count && split_evenly(s, count, first)))
		return count;
	error_set(e, RNEAGEN_USAGE, "--parts %d: there are elements of %d bodies to share out; take fewer, or auto",
		count, s->count);
	return 0;
}

static struct part *make_parts(struct splitter *s, int count, const int *first)
{
	struct part *parts = arena_alloc(s->a, (size_t)count, sizeof *parts);

	for (int i = 0; i < count && parts; i++)
		if (!make_part(s, i, first[count - 1 - i], i + 1 < count ? first[count - 2 - i] : s->count, &parts[i]))
			return NULL;
	return parts;
}

enum rneagen_code parts_make(struct part **parts, int *count, const struct parts_of *x, struct arena *a, struct rneagen_error *e)
{
	const struct rneagen_options *o = x->options;
	struct splitter s = {.x = x, .a = a};
	const char *why = obstacle(x->request, x->has_kernels);
	int least = x->is_relayed ? 1 : 2;
	int made, *first;

	*count = 0;
	if (o->parts == RNEAGEN_PARTS_AUTO && why)
		return apart_make(parts, count, x, a) ? RNEAGEN_OK : error_memory(e);
	if (o->parts == 1)
		return RNEAGEN_OK;
	if (why)
		return error_set(e, RNEAGEN_USAGE, "--parts %d %s", o->parts, why);
	first = arena_alloc(a, (size_t)x->tree->body_count, sizeof *first);
	if (!first || !begin(&s))
		return error_memory(e);
	made = choose(&s, first, e);
	if (e->code)
		return e->code;
	if (made == 1)
		first[0] = 0;
	*parts = made >= least ? make_parts(&s, made, first) : NULL;
	if (s.failed || (made >= least && !*parts))
		return error_memory(e);
	*count = made >= least ? made : 0;
	return RNEAGEN_OK;
}

int parts_alive(const struct part *parts, int count)
{
	int most = 0;

	for (int i = 0; i < count; i++)
		most = parts[i].alive > most ? parts[i].alive : most;
	return most;
}

struct operation_count parts_operations(const struct part *parts, int count, const struct plan *whole)
{
	struct operation_count sum = {0};

	if (!count)
		return plan_operations(whole);
	for (int i = 0; i < count; i++)
		plan_add_operations(&sum, plan_operations(&parts[i].pass.plan), 1);
	return sum;
}

void parts_dump(const struct part *parts, int count, const struct pass *whole, const struct tree *t, struct text *out)
{
	if (!count)
		text_printf(out, "whole: %u flops\n", plan_flops(plan_operations(&whole->plan)));
	for (int i = 0; i < count; i++)
		text_printf(out, "part %d: links %d..%d, %u flops, %d values at once\n", i, t->bodies[parts[i].first].number,
			t->bodies[parts[i].last].number, plan_flops(plan_operations(&parts[i].pass.plan)), parts[i].alive);
}
