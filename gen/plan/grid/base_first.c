#include "plan/grid/base_first.h"
#include "plan/grid/apart.h"
#include "plan/grid/hands/hands.h"
#include "plan/grid/hands/turns.h"
#include "plan/grid/joined.h"

/* Values at once of the whole beyond which there are two kernels, and what share of them a part may have; measured in f64, since
   in f32 no whole that is divided holds so little. H200, ps for each of a million samples, one kernel and two, in aos as well,
   and in brackets values of the whole and of the fullest part:
   hyq              310 and 572, 328 and 970 (144, 138)
   panda            186 and 318, 198 and 397 (114, 106)
   allegro_right    519 and 649, 526 and 1070 (204, 137)
   baxter           1370 and 903, but 65536 samples 86 and 100 us, 890 and 1200 (214, 198)
   anymal_kinova    767 and 711, 725 and 929 (278, 199)
   simple_humanoid  1740 and 992, 1670 and 1340 (345, 192) */
enum { FULL = 300 };
static const double LEFT = 0.7;

/* In f32 it serves where mu is found with qdd (found.h), and one kernel has more operations than the instruction cache has
   room for. H200, ps for each of a million samples, and us of 65536 and 16384: vjp of accelerations, atlas 1570 and 1130
   (128, 126; 40, 48), g1_29dof 1840 and 1250 (140, 139; 44, 51); but accelerations alone 358 and 580 (27, 53; 13, 28), and
   jvp 1240 and 1480. */
enum { LONG_SINGLE = 8200 };

/* Operations of the base's kernel, beyond which its limbs are on two sides; what share of them the second side may have. The
   same figures, of one kernel and two, f64: accelerations, simple_humanoid, 4645 operations, 947 and 983 (98, 92; 38, 34),
   atlas, 6757, 1370 and 1280 (151, 129; 57, 51), g1_29dof, 7457, 1850 and 1350 (157, 134; 59, 51), in aos atlas 2270 and
   1760; with mu, of the vjp of accelerations: simple_humanoid, 5397, 2320 and 2220 (201, 197; 88, 77), atlas, 7679, 4260 and
   3110, g1_29dof, 8421, 4230 and 2780. */
enum { LONG = 5000 };
static const double LESS = 0.75;

enum { FIRST, SECOND };

/* Rows of a base that moves freely: the first ones. */
enum { BASE_ROWS = 6 };

int base_is_free(const struct tree *t)
{
	return t->body_count > 1 && t->bodies[0].type == JOINT_FLOATING && t->bodies[0].iv == 0 && tree_end(t, 0) == t->body_count;
}

static unsigned operations_of(const struct dag *d)
{
	return plan_flops(plan_operations_of(d, 0, d->count));
}

int base_first_serves(const struct parts_of *x)
{
	const struct dag *d = x->raw;
	int is_long = (int)d->output_count > x->tree->nv && operations_of(d) > LONG_SINGLE;

	return (x->options->precision == RNEAGEN_F64 || (x->options->precision == RNEAGEN_F32 && is_long)) && base_is_free(x->tree);
}

static int is_served(const struct parts_of *x)
{
	const struct request *k = x->request;

	if (!x->has_kernels || !x->is_unpruned || x->is_relayed || x->options->strict || k->refine_steps || k->contact_count)
		return 0;
	return k->is_forward && k->stored_count == 1 && k->wants[0].kind == WANT_QDD && base_first_serves(x);
}

/* By output, the kernel that stores it: where mu is found too (found.h), it has rows of its own. */
static int *kernels_of(const struct dag *d, const struct tree *t, struct arena *a)
{
	int *kernel = arena_alloc(a, d->output_count + 1, sizeof *kernel);

	for (size_t i = 0; i < d->output_count && kernel; i++)
		kernel[i] = d->outputs[i].row % t->nv < BASE_ROWS ? FIRST : SECOND;
	return kernel;
}

/* In the copy of a share, rows of the base are read and not made. What only they take is no longer live. */
static void read_base(struct dag *copy, const struct share *s, const int *kernel)
{
	const struct dag *d = s->whole;

	for (size_t i = 0; i < d->output_count; i++) {
		const struct output *o = &d->outputs[i];

		if (kernel[i] == FIRST && s->live[o->value.i] && node_is_operation(&d->nodes[o->value.i]))
			copy->nodes[s->place[o->value.i]] = (struct node){.op = OP_INPUT,
				.arg = {{(uint32_t)o->argument}, {(uint32_t)o->row}}};
	}
}

/* The shares of both kernels, and the DAG of the second, which reads what the first one makes. */
static int divide(struct share *s, struct dag *limbs, const struct dag *d, const struct tree *t, struct arena *spare)
{
	const int *kernel = kernels_of(d, t, spare);

	if (!kernel || !share_begin(s, d, kernel, spare))
		return 0;
	share_copy(s, SECOND, SECOND + 1, limbs, spare);
	if (!limbs->failed)
		read_base(limbs, s, kernel);
	return !limbs->failed;
}

/* One of the kernels before. */
static int finish(struct part *p, const struct parts_of *x, struct arena *a)
{
	if (!part_order(p, ORDERED_BASE, x, a) || !turns_delay_stores(&p->function.plan, a))
		return 0;
	p->is_before = 1;
	return apart_set_rows(p, stretches_make, 0, x, a);
}

static int make(struct part *p, const struct dag *d, int number, const char *what, const struct parts_of *x, struct arena *a)
{
	const char *name = text_format(a, "%s_part%d", x->whole->algorithm->name, number);
	const char *doc = text_format(a, "Part %d of it: %s.", number, what);

	p->what = what;
	return part_build(p, d, name, doc, x, a) && finish(p, x, a);
}

/* What the base feels of its limbs on one side, where the base's kernel would be longer than the instruction cache. */
static int find_felt(struct hands *h, const struct dag *base, const struct parts_of *x, struct arena *a)
{
	*h = (struct hands){0};
	return operations_of(base) < LONG || !base_is_free(x->tree) || hands_find_felt(h, base, x, a);
}

/* The side's own kernel makes at least what the rest does without. */
static int is_shorter(const struct dag *rest, const struct dag *base)
{
	return operations_of(rest) <= LESS * operations_of(base);
}

/* Its DAG is what the one side's stores alone take. */
static int make_felt(struct part *p, const struct hands *h, int number, const struct parts_of *x, struct arena *spare,
	struct arena *a)
{
	const struct body *bodies = x->tree->bodies;
	struct share share;
	struct dag d;

	if (!share_begin(&share, &h->levels->first, h->levels->owner, spare))
		return 0;
	share_copy(&share, 0, 1, &d, spare);
	if (d.failed || !make(p, &d, number, text_format(a, "what the base feels of links %d to %d", bodies[h->list->first].number,
						 bodies[h->list->last].number), x, a))
		return 0;
	p->first = h->list->first;
	p->last = h->list->last;
	return 1;
}

/* Where its rows are all that a slice of qdd has. */
static int leaves_whole_rows(const struct part *p, const struct tree *t)
{
	const struct dag *d = &p->function.dag;

	return d->arguments[parts_handed(d)].rows > t->nv || stretches_are_written(p->function.stretches, d);
}

int base_first_make_before(struct part *parts, int *count, const struct dag *base, int number, const char *what,
	const struct parts_of *x, struct arena *spare, struct arena *a)
{
	struct hands h;
	int sides;

	if (!find_felt(&h, base, x, spare))
		return 0;
	sides = h.level_count && is_shorter(&h.levels->rest, base);
	if (sides && !make_felt(parts, &h, number, x, spare, a))
		return 0;
	sides = sides && leaves_whole_rows(parts, x->tree);
	*count = 1 + sides;
	parts[sides].level = sides;
	return make(&parts[sides], sides ? &h.levels->rest : base, number + sides, what, x, a);
}

int base_first_divide(struct base_first *k, struct part *parts, int number, const char *of, int whole, const struct parts_of *x,
	struct arena *spare, struct arena *a)
{
	static const char WHAT[] = "limbs, where those are found";
	int *owner = arena_alloc(spare, x->raw->output_count + 1, sizeof *owner); /* by output of the limbs: its part */
	struct share s;
	struct dag base, limbs;

	*k = (struct base_first){0};
	if (whole <= FULL)
		return !spare->failed;
	if (!owner || !divide(&s, &limbs, x->raw, x->tree, spare))
		return 0;
	share_copy(&s, FIRST, FIRST + 1, &base, spare);
	k->limbs = joined_own_beyond(owner, &limbs, x->tree, BASE_ROWS, spare);
	if (base.failed || !k->limbs ||
		!base_first_make_before(parts, &k->before, &base, number, text_format(a, "the base's rows of %s", of), x, spare, a) ||
		!apart_make_limbs(parts + k->before, number + k->before, k->limbs, &limbs, owner, WHAT, x, spare, a))
		return 0;
	if (parts_alive(parts, k->before + k->limbs) > LEFT * whole)
		*k = (struct base_first){0};
	return !spare->failed;
}

int base_first_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	struct base_first k;

	if (!is_served(x))
		return 1;
	*parts = arena_alloc(a, (size_t)x->tree->nv + 2, sizeof **parts);
	if (!*parts || !base_first_divide(&k, *parts, 0, "qdd", plan_alive(&x->whole->plan, spare), x, spare, a))
		return 0;
	*count = k.before + k.limbs;
	parts_divide(*parts, *count, DIVIDED_BASE_FIRST);
	return 1;
}
