/* Which texts have such parts, and whether they pay. */
#include "plan/grid/apart.h"
#include "plan/grid/again.h"
#include "plan/grid/base_first.h"
#include "plan/grid/found/found.h"
#include "plan/grid/hands/hands.h"
#include "plan/grid/joined.h"
#include "plan/grid/places.h"
#include "plan/grid/hands/turns.h"
#include "plan/lanes/each.h"
#include "plan/stage.h"

/* Operations of the whole. H100, 1 M samples, ps, whole and in parts. f64: hyq 131 and 126, but 16384 samples 196 and 229; yumi,
   1478 operations, 174 and 171, 16384 samples 410 and 374; baxter 203 and 173, atlas 379 and 329, romeo 547 and 375, g1_29dof 443
   and 358, jvrc1 545 and 448; but not where the slice of a part has no room: g1_brainco 2455 and 3455. Mixed: yumi 115 and 119,
   16384 samples 327 and 291, baxter 180 and 150, atlas 298 and 271, g1_29dof 371 and 324, jvrc1 459 and 369. f32: atlas, 2668,
   174 and 186, g1_29dof 185 and 197, jvrc1 213 and 229, but g1_brainco 619 and 463. In aos a part's rows stand apart: in f64
   atlas 348 and 491, but g1_brainco 4134 and 3792, in f32 1107 and 704. */
enum { LEAST_STAGED = 1400, LEAST = 5000, NEVER = 1 << 30 };

/* Operations of accelerations in soa in f32. H100, 1 M samples, ps, whole and in parts: hyq, 1284 operations, 70.8 and 76.8,
   yumi, 4334, 152 and 144, atlas 269 and 265, g1_29dof 312 and 310, jvrc1 709 and 454; 4096 samples, us: yumi 5.7 and 2.6,
   atlas 9.5 and 6.5. In f64 accelerations are as torques: hyq 132 and 125, yumi 308 and 236, atlas 968 and 578, g1_29dof 1835 and
   817, jvrc1 2832 and 2682, in aos atlas 1252 and 788, g1_29dof 2733 and 1028. In f32 in aos atlas takes 417 instead of 269. */
enum { LEAST_ACCELERATIONS = 2000 };

/* Operations of texts with a vjp, beyond which there may be parts; values at once: in f32 more than so many in the whole, in f64
   no more than so many in each part, for segments serve those better. H100, 1 M samples, ps, in brackets values in the whole or
   in a part: f32: hyq, 2284 operations, 144 and 141 (73), yumi 197 and 221 (212), romeo 425 and 483 (230), atlas 391 and 404, but
   16384 samples in 10.2 us instead of 12.5 (285), baxter 314 and 226 (289), g1_29dof 416 and 430 (307), jvrc1 1293 and 571 (394).
   f64, with motion made again: yumi 998 and 421 (135), baxter 892 and 482 (126), romeo 1611 and 868 (171), atlas 1814 and 850
   (160), g1_29dof 2608 and 1001 (168), jvrc1 3656 and 2912 (255), but g1_brainco 8218 and 8273 (287). Without: g1_29dof 1590
   (307), jvrc1 4716 (394). Of all limbs in one part, instead of segments: floating hyq 966 and 531 (166), g1_29dof 4301 and, by
   stretches of three, 4154 (209), jvrc1 5613 and 5972 (267); and where they would have no segments: atlas 6920 and 3629 (228). */
enum { LEAST_PRODUCT = 2500, PRODUCT_ALIVE_SINGLE = 280, PRODUCT_ALIVE_DOUBLE = 340, PRODUCT_ALIVE_AGAIN = 280,
	LEAST_ALONE = 3500, ALONE_ALIVE = 240 };

/* In aos such texts are in f64 alone, and where the slices of all parts have room. Up to so many operations of the whole all
   limbs are in one part: to fetch and write a part's rows of each sample alone takes its time. H100, 1 M samples, ns, whole with
   windows, in parts, in one: yumi, 3598 operations, 1.10, 0.49, 0.38, baxter, 5044, 1.51, 1.10, 0.45, romeo,
   7406, 3.04, 1.69, 2.89; atlas 3.06 and 1.64, g1_29dof 5.01 and 1.90, jvrc1 5.99 and 3.74; floating hyq 1.13 and 0.60,
   atlas 7.93 and 3.75, g1_29dof 6.89 and 4.53. Parts as warps of one block, whose samples come in one piece, take turns at the
   instruction cache: atlas 2.2, g1_29dof 3.4, jvrc1 4.7. In f32 jvrc1 takes 1.42 and 1.27, but 16384 samples 22.7 us and 22.9. */
enum { SHORT_AOS = 5500 };

/* ---- parts ---- */

int parts_is_by_row(const struct argument *a, int nv)
{
	static const enum role roles[] = {ROLE_JOINT_TORQUE, ROLE_GRAVITY_TORQUE, ROLE_BIAS_TORQUE, ROLE_JOINT_ACCELERATION};

	for (size_t i = 0; i < sizeof roles / sizeof *roles; i++)
		if (a->role == roles[i])
			return nv > 0 && a->rows == nv;
	return nv > 0 && a->role == ROLE_VJP && a->rows == 3 * nv;
}

/* Of a jvp of accelerations alone, whose rows kernels hand on (found.h). */
static int is_by_row(const struct argument *a, const struct parts_of *x)
{
	return parts_is_by_row(a, x->tree->nv) || (x->request->is_forward && a->role == ROLE_JVP && a->rows == x->tree->nv);
}

static int is_staged_soa(const struct rneagen_options *o)
{
	return o->layout == RNEAGEN_SOA && o->precision != RNEAGEN_F32;
}

/* Operations beyond which there are parts; NEVER: there are none. */
static unsigned least_operations(const struct parts_of *x)
{
	const struct rneagen_options *o = x->options;
	int is_forward = x->request->is_forward, is_product = request_wants_derivative(x->request);

	if ((is_forward && is_product) || x->request->refine_steps)
		return NEVER;
	if ((is_forward || is_product) && o->precision == RNEAGEN_MIXED) /* nothing was measured */
		return NEVER;
	if (o->layout == RNEAGEN_AOS && o->precision == RNEAGEN_F32 && (is_forward || is_product))
		return NEVER;
	if (is_product)
		return LEAST_PRODUCT;
	if (is_staged_soa(o))
		return LEAST_STAGED;
	return is_forward && o->layout == RNEAGEN_SOA ? LEAST_ACCELERATIONS : LEAST;
}

/* What is made of inputs that all samples share is no limb's own: used once in a part, and twice in the whole, it may be joined
   to other sums, with other bits. */
static int may_be_apart(const struct parts_of *x)
{
	const struct rneagen_options *o = x->options;
	const struct dag *d = x->raw;

	if (!x->has_kernels || o->parts != RNEAGEN_PARTS_AUTO || o->segments != RNEAGEN_SEGMENTS_AUTO ||
		o->precision == RNEAGEN_F32X2)
		return 0;
	for (size_t i = 0; i < d->output_count; i++)
		if (!is_by_row(&d->arguments[d->outputs[i].argument], x))
			return 0;
	for (int i = 0; i < d->argument_count; i++)
		if (o->strict && d->arguments[i].per_batch)
			return 0;
	return 1;
}

static unsigned operations_of(const struct parts_of *x)
{
	return plan_flops(plan_operations(&x->whole->plan));
}

/* Have the slices of all room in shared memory? */
static int are_staged(const struct part *parts, int count, const struct rneagen_options *o)
{
	for (int i = 0; i < count; i++)
		if (!stage_has_room(stretches_words(parts[i].function.stretches, &parts[i].function.dag, o), o))
			return 0;
	return 1;
}

/* Do they write every row of their slices? */
static int are_written(const struct part *parts, int count)
{
	for (int i = 0; i < count; i++)
		if (!stretches_are_written(parts[i].function.stretches, &parts[i].function.dag))
			return 0;
	return 1;
}

/* Where they are to be there. */
static int have_room(const struct part *parts, int count, const struct rneagen_options *o)
{
	return !is_staged_soa(o) || are_staged(parts, count, o);
}

/* Of a vjp: does the whole hold too much, and no part of it? */
static int hold_less(const struct part *parts, int count, const struct parts_of *x, struct arena *a)
{
	if (x->options->precision == RNEAGEN_F32)
		return plan_alive(&x->whole->plan, a) > PRODUCT_ALIVE_SINGLE;
	if (count == 1)
		return parts->joints && parts->alive <= ALONE_ALIVE &&
			operations_of(x) > LEAST_ALONE;
	for (int i = 0; i < count; i++)
		if (parts[i].alive > (parts[i].joints ? PRODUCT_ALIVE_AGAIN : PRODUCT_ALIVE_DOUBLE))
			return 0;
	return 1;
}

/* Can it stand there? Sets *can. Returns 0 when memory runs out. */
static int find_places(int *can, const struct part *parts, int count, const struct parts_of *x, struct arena *a)
{
	*can = 1;
	if (!apart_has_places(x))
		return 1;
	*can = parts->function.stretches->period && are_staged(parts, count, x->options) && are_written(parts, count);
	for (int i = 0, serves; i < count && *can; i++) {
		if (!places_serve(&serves, &parts[i].function, parts[i].function.stretches, a))
			return 0;
		*can = serves;
	}
	return 1;
}

static int do_pay(const struct part *parts, int count, const struct parts_of *x, struct arena *a)
{
	return request_wants_derivative(x->request) ? hold_less(parts, count, x, a) : have_room(parts, count, x->options);
}

static int nv_of(const struct parts_of *x)
{
	return request_wants_derivative(x->request) ? x->tree->nv : 0;
}

static int make_part(struct part *p, struct share *share, int owner, int number, const char *what, const struct parts_of *x,
	struct arena *a)
{
	return apart_build(p, share, owner, number, what, x, a) && apart_set_rows(p, stretches_make, nv_of(x), x, a) && !a->failed;
}

int apart_make_hands(struct part *parts, int number, const struct hands *h, const struct parts_of *x, struct arena *spare,
	struct arena *a)
{
	struct share share;
	int level = -1;

	for (int i = 0; i < h->count; i++) {
		const struct hand_level *l = &h->levels[h->list[i].level];
		const struct body *bodies = x->tree->bodies;
		const char *what = h->is_base
			? text_format(a, "links %d to %d, and what the base takes of them", bodies[h->list[i].first].number,
				  bodies[h->list[i].last].number)
			: text_format(a, "what link %d carries, and the force of all that on it", bodies[h->list[i].body].number);

		if (h->list[i].level != level && !share_begin(&share, &l->first, l->owner, spare))
			return 0;
		level = h->list[i].level;
		if (!make_part(&parts[i], &share, i, number + i, what, x, a))
			return 0;
		parts[i].is_before = 1;
		parts[i].level = level;
		parts[i].first = h->list[i].first;
		parts[i].last = h->list[i].last;
	}
	return 1;
}

int apart_make_limbs(struct part *parts, int number, int count, const struct dag *d, const int *owner, const char *what,
	const struct parts_of *x, struct arena *spare, struct arena *a)
{
	struct share share;

	if (!share_begin(&share, d, owner, spare))
		return 0;
	for (int i = 0; i < count; i++)
		if (!make_part(&parts[i], &share, i, number + i, what, x, a))
			return 0;
	return 1;
}

/* All in one part. Returns how many there are. */
static int own_together(int *owner, const struct dag *d)
{
	for (size_t i = 0; i < d->output_count; i++)
		owner[i] = 0;
	return 1;
}

/* Those of hands first. */
static int make_all(struct part **parts, int *count, const struct hands *h, const struct parts_of *x, struct arena *spare,
	struct arena *a)
{
	const struct dag *d = h->count ? &h->levels[h->level_count - 1].rest : x->raw;
	int *owner = arena_alloc(spare, d->output_count + 1, sizeof *owner);
	int limbs = owner ? joined_own(owner, d, x->tree->nv, spare) : 0, can;
	const char *what;

	if (limbs > 1 && apart_has_places(x) && operations_of(x) <= SHORT_AOS)
		limbs = own_together(owner, d);
	if (limbs + h->count < (again_serves(x) ? 1 : 2))
		return limbs;
	what = limbs + h->count > 1 ? "limbs that share nothing with the others" : "the whole, where some of the motion is made again";
	*parts = arena_alloc(a, (size_t)(limbs + h->count), sizeof **parts);
	if (!*parts || !apart_make_hands(*parts, 0, h, x, spare, a) ||
		!apart_make_limbs(*parts + h->count, h->count, limbs, d, owner, what, x, spare, a))
		return 0;
	if (!find_places(&can, *parts, limbs + h->count, x, spare))
		return 0;
	*count = can && ((h->count && h->is_full) || do_pay(*parts, limbs + h->count, x, spare)) ? limbs + h->count : 0;
	return 1;
}

/* Each part takes at most half of the whole's operations, or two thirds where the whole spills much or motion is made again. It
   writes every row that it stages, and reads what others have left before that is written over. */
static int do_serve(const struct part *parts, int count, const struct hands *h, const struct parts_of *x, struct arena *a)
{
	unsigned whole = operations_of(x), most = h->is_base ? whole : h->is_full || again_serves(x) ? whole / 3 * 2 : whole / 2;

	if (are_staged(parts, count, x->options) && !are_written(parts, count))
		return 0;
	for (const struct part *p = parts; p < parts + count; p++)
		if (plan_flops(plan_operations(&p->function.plan)) > most)
			return 0;
	return turns_serve(parts, count, x->raw->arguments[parts_handed(x->raw)].rows, 1, a);
}

/* Alike limbs in loops, in aos: operations of the whole beyond which there are such; with a vjp in f32, values at once in the
   whole beyond which there are, and how many of them may be left. H100, 1 M samples, ps, so far and in loops, in brackets us of
   16384. tau in f32: hyq, 832 operations, 68 and 74, yumi, 1478, 102 and 104, pr2, 2460, 116 and 120 (5.3 and 4.7), atlas 167 and
   168 (6.4 and 6.6), g1_29dof, 2918, 167 and 164 (7.8 and 6.6), g1_d_wheeled 205 and 191, jvrc1 210 and 192 (8.1 and 7.1),
   g1_brainco 664 and 445; but floating jvrc1 238 and 251 (9.0 and 8.4). f64: yumi 174 both, baxter, 1857, 195 and 185 (6.4
   and 5.2), pr2 252 and 226, atlas 326 and 324, romeo 388 and 353, g1_29dof 349 and 316, floating 525 and 444, jvrc1 472 and 430,
   floating 745 and 676, g1_brainco 1473 and 1449; but g1_d_wheeled 491 and 541. With the vjp in f32: yumi, 212 values, 249 and
   239, simple_humanoid, 229, 326 and 331, atlas, 285, 360 and 370, g1_29dof, 283, 369 and 386, pr2, 435, 417 and 292, jvrc1, 394,
   1202 and 500, g1_brainco, 444, 4075 and 3077; but g1_d_wheeled, 372 and in a loop 354, 592 and 607. In f64: yumi 384 and 377,
   baxter 407 and 377, simple_humanoid, 4461 operations, 651 and 865, shadow_hand_right, 4404, 878 and 1028, pr2, 5959, 1115 and
   702, atlas 1658 and 1310, g1_29dof 1660 and 1253, romeo 1614 and 853, jvrc1 3676 and 1903, g1_d_wheeled 3871 and 2436. */
enum { LEAST_LOOPS_SINGLE = 2900, LEAST_LOOPS_DOUBLE = 1800, LOOPS_ALIVE = 300 };
static const double LOOPS_LEFT = 0.87;

/* How much of the operations are in loops at least: 0.9 of atlas, a third of shadow_hand_right, whose fingers alone are alike. */
static const double LOOPS_SHARE = 0.6;

static int may_loop(const struct parts_of *x, struct arena *a)
{
	const struct rneagen_options *o = x->options;
	unsigned operations = operations_of(x);
	int is_product = request_wants_derivative(x->request);

	if (o->layout != RNEAGEN_AOS || x->request->is_forward || x->request->refine_steps)
		return 0;
	if (o->precision == RNEAGEN_F64)
		return operations > (is_product ? SHORT_AOS : LEAST_LOOPS_DOUBLE);
	if (o->precision != RNEAGEN_F32)
		return 0;
	return is_product ? plan_alive(&x->whole->plan, a) > LOOPS_ALIVE : operations > LEAST_LOOPS_SINGLE;
}

/* Are most operations in loops, and does what it holds have more room there? */
static int loops_pay(const struct part *p, const struct parts_of *x, struct arena *a)
{
	unsigned all = plan_flops(part_operations(p)), once = plan_flops(plan_operations(&p->function.each->plan));

	if (p->function.each->loops->limbs * (double)(all - once) < LOOPS_SHARE * all)
		return 0;
	return x->options->precision == RNEAGEN_F64 || !request_wants_derivative(x->request) ||
		p->alive <= LOOPS_LEFT * plan_alive(&x->whole->plan, a);
}

/* All in one part, with alike limbs in loops. */
static int make_loops(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	int *owner = arena_alloc(spare, x->raw->output_count + 1, sizeof *owner);
	struct share share;
	const char *name = text_format(a, "%s_part0", x->whole->algorithm->name);
	struct part *p = *parts = arena_alloc(a, 1, sizeof *p);

	if (!owner || !p || !share_begin(&share, x->raw, owner, spare))
		return 0;
	if (!part_build_share(p, &share, 0, 1, name, "The whole, with loops over limbs that are alike.", x, a) ||
		(request_wants_derivative(x->request) && !part_order(p, ORDERED_PART, x, a)) ||
		!apart_set_rows(p, stretches_make_whole, nv_of(x), x, a) || !each_make(p, x, a))
		return 0;
	*count = p->function.each && are_staged(p, 1, x->options) && are_written(p, 1) && loops_pay(p, x, spare);
	parts_divide(p, 1, DIVIDED_BY_LIMBS);
	return 1;
}

static int make_parts(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	struct hands hands, none = {0};

	if (!hands_find(&hands, x, spare))
		return 0;
	if (hands.count && !make_all(parts, count, &hands, x, spare, a))
		return 0;
	if (*count && do_serve(*parts, *count, &hands, x, spare)) {
		parts_divide(*parts, *count, base_is_free(x->tree) ? DIVIDED_BY_SIDES : DIVIDED_BY_HANDS);
		return 1;
	}
	*count = 0;
	if (!make_all(parts, count, &none, x, spare, a))
		return 0;
	parts_divide(*parts, *count, DIVIDED_BY_LIMBS);
	return 1;
}

int apart_make(struct part **parts, int *count, const struct parts_of *x, struct arena *a)
{
	struct arena spare;
	int is_made;

	*count = 0;
	if (!may_be_apart(x))
		return 1;
	arena_init(&spare, x->options->allocator);
	is_made = !may_loop(x, &spare) || make_loops(parts, count, x, &spare, a);
	if (is_made && !*count && operations_of(x) > least_operations(x))
		is_made = make_parts(parts, count, x, &spare, a);
	if (is_made && !*count)
		is_made = found_make(parts, count, x, &spare, a);
	if (is_made && !*count)
		is_made = base_first_make(parts, count, x, &spare, a);
	arena_free(&spare);
	return is_made;
}
