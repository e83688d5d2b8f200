#include "plan/grid/found.h"
#include "plan/grid/apart.h"
#include "plan/grid/hands/turns.h"
#include "plan/grid/joined.h"
#include "plan/grid/places.h"

/* Values at once of the whole, beyond which there are two kernels. H200, ps for each of a million samples, one kernel and two, in
   brackets values of the whole: f32: panda 96 and 134 (187), baxter 271 and 328 (234), floating panda 185 and 241 (302), floating
   hyq 340 and 347 (430), floating allegro_right 884 and 448 (513), atlas 3390 and 634 (741), g1_29dof 3370 and 686 (812); f64:
   iiwa14 129 and 202 (155), panda 209 and 245 (190), baxter 2310 and 640 (234), floating panda 1830 and 466 (302), floating hyq
   4105 and 808 (430), atlas 9490 and 1620, g1_29dof 10420 and 1670. */
enum { FULL_SINGLE = 450, FULL_DOUBLE = 210 };

/* In aos in f32 whole samples come and go as one part, unless its code would be longer than the instruction cache: so many
   operations are. */
enum { LONG = 8200 };

enum { FIRST, SECOND, KERNELS };

/* One of the two. */
struct kernel {
	struct dag dag;
	struct request request; /* accelerations; the vjp of torques */
	struct parts_of of;
	int *owner, count; /* by output: its part; parts */
};

/* In aos mu takes the place of the third array, which must be tau: it is not where a scene gives all of tau, or of qd. */
static int has_places(const struct parts_of *x)
{
	return x->options->layout != RNEAGEN_AOS ||
		dag_find_role(x->raw, ROLE_JOINT_TORQUE, 0) == stretches_found_place(x->raw, FOUND_MU);
}

static int is_served(const struct parts_of *x)
{
	const struct rneagen_options *o = x->options;
	const struct request *k = x->request;

	if (!x->has_kernels || !x->is_unpruned || !has_places(x) || o->strict || k->refine_steps)
		return 0;
	if (o->precision != RNEAGEN_F32 && o->precision != RNEAGEN_F64)
		return 0;
	return k->is_forward && k->stored_count == 1 && k->wants[0].kind == WANT_VJP && request_is_plain_product(k, &k->vjp);
}

static int is_full(const struct parts_of *x, struct arena *a)
{
	return plan_alive(&x->whole->plan, a) > (x->options->precision == RNEAGEN_F32 ? FULL_SINGLE : FULL_DOUBLE);
}

/* By output, the kernel that stores it. The first nv outputs are qdd, rows from 2 nv on are mu: both are the first kernel's. */
static int *kernels_of(const struct dag *d, int nv, struct arena *a)
{
	int *kernel = arena_alloc(a, d->output_count + 1, sizeof *kernel);

	for (size_t i = 0; i < d->output_count && kernel; i++)
		kernel[i] = i < (size_t)nv || d->outputs[i].row >= 2 * nv ? FIRST : SECOND;
	return kernel;
}

static int is_together(const struct dag *d, const struct rneagen_options *o)
{
	return o->layout == RNEAGEN_AOS && o->precision == RNEAGEN_F32 && plan_flops(plan_operations_of(d, 0, d->count)) <= LONG;
}

static int share_out(struct kernel *k, const struct parts_of *x, struct arena *spare)
{
	k->owner = arena_alloc(spare, k->dag.output_count + 1, sizeof *k->owner);
	if (!k->owner || k->dag.failed)
		return 0;
	k->count = is_together(&k->dag, x->options) ? 1 : joined_own(k->owner, &k->dag, x->tree->nv, spare);
	k->of = *x;
	k->of.raw = &k->dag;
	k->of.request = &k->request;
	return k->count;
}

static int begin(struct kernel kernels[KERNELS], struct want *qdd, const struct parts_of *x, struct arena *spare)
{
	struct dag raw;
	struct share share;
	const int *kernel;

	dag_init(&raw, spare);
	algorithm_build_handed(&raw, x->tree, x->request);
	kernel = raw.failed ? NULL : kernels_of(&raw, x->tree->nv, spare);
	if (!kernel || !share_begin(&share, &raw, kernel, spare))
		return 0;
	kernels[FIRST].request = request_of_accelerations(x->request, qdd);
	kernels[SECOND].request = *x->request;
	kernels[SECOND].request.is_forward = 0;
	for (int i = 0; i < KERNELS; i++) {
		share_copy(&share, i, i + 1, &kernels[i].dag, spare);
		if (!share_out(&kernels[i], x, spare))
			return 0;
	}
	return 1;
}

/* In aos outputs stand in the places of inputs: qdd where q was, mu where tau was, and what it leaves for the vjp by qd is
   written over. */
static int set_rows(struct part *p, int kernel, const struct parts_of *x, struct arena *a)
{
	int nv = x->options->layout == RNEAGEN_AOS ? x->tree->nv : 0;

	return apart_set_rows(p, kernel == SECOND && nv ? stretches_make_found : stretches_make, nv, x, a);
}

static int make_kernel(struct part *parts, int first, int kernel, const struct kernel *k, struct arena *spare, struct arena *a)
{
	static const char *const WHAT[KERNELS] = {"qdd, and M^-1 of the weights", "the rest, where both are found"};
	struct share share;

	if (!share_begin(&share, &k->dag, k->owner, spare))
		return 0;
	for (int i = 0; i < k->count; i++) {
		struct part *p = &parts[first + i];

		if (!apart_build(p, &share, i, first + i, WHAT[kernel], &k->of, a) ||
			!turns_delay_stores(&p->function.plan, spare) || !set_rows(p, kernel, &k->of, a))
			return 0;
		p->is_before = kernel == FIRST;
	}
	return 1;
}

/* Are rows read before others are written in their places? */
static int are_in_order(int *are, const struct part *parts, int count, const struct parts_of *x, struct arena *a)
{
	*are = turns_serve(parts, count, x->whole->dag.arguments[parts_handed(&x->whole->dag)].rows, a);
	for (int i = 0, serves; i < count && *are; i++) {
		if (!places_serve(&serves, &parts[i].function, parts[i].function.stretches, a))
			return 0;
		*are = serves;
	}
	return !a->failed;
}

int found_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	struct kernel kernels[KERNELS] = {0};
	struct want qdd;
	int all, are;

	if (!is_served(x) || !is_full(x, spare))
		return !spare->failed;
	if (!begin(kernels, &qdd, x, spare))
		return 0;
	all = kernels[FIRST].count + kernels[SECOND].count;
	*parts = arena_alloc(a, (size_t)all, sizeof **parts);
	if (!*parts || !make_kernel(*parts, 0, FIRST, &kernels[FIRST], spare, a) ||
		!make_kernel(*parts, kernels[FIRST].count, SECOND, &kernels[SECOND], spare, a) ||
		!are_in_order(&are, *parts, all, x, spare))
		return 0;
	*count = are ? all : 0;
	return 1;
}
