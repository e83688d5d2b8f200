#include "plan/grid/base_first.h"
#include "plan/grid/apart.h"
#include "plan/grid/joined.h"

/* Values at once of the whole, in f64, beyond which there are two kernels, and what share of them each part may have. H200, ps for
   each of a million samples, one kernel and two, in brackets values at once of the whole and of the fullest part: hyq 310 and 572
   (144, 138), panda 186 and 318 (114, 106), allegro_right 519 and 649 (204, 137), baxter 1370 and 903, but 65536 samples 86 and
   100 us, and in aos 890 and 1200 (214, 198), anymal_kinova 767 and 711, in aos 725 and 929 (278, 199); simple_humanoid 1740 and
   1000, in aos 1670 and 1340 (345, 192), atlas 3390 and 1380, 3600 and 2310 (361, 220), g1_29dof 4290 and 1850 (390, 213). */
enum { FULL = 300 };
static const double LEFT = 0.7;

enum { FIRST, SECOND };

/* Everything hangs on the free base, which has the first rows. */
static int has_free_base(const struct tree *t)
{
	return t->body_count > 1 && t->bodies[0].type == JOINT_FLOATING && tree_end(t, 0) == t->body_count;
}

static int is_served(const struct parts_of *x)
{
	const struct request *k = x->request;

	if (!x->has_kernels || !x->is_unpruned || x->is_relayed || x->options->strict || k->refine_steps)
		return 0;
	return x->options->precision == RNEAGEN_F64 && k->is_forward && k->stored_count == 1 && k->wants[0].kind == WANT_QDD &&
		has_free_base(x->tree);
}

/* By output, the kernel that stores it. */
static int *kernels_of(const struct dag *d, int base_rows, struct arena *a)
{
	int *kernel = arena_alloc(a, d->output_count + 1, sizeof *kernel);

	for (size_t i = 0; i < d->output_count && kernel; i++)
		kernel[i] = d->outputs[i].row < base_rows ? FIRST : SECOND;
	return kernel;
}

static int is_operation(const struct node *n)
{
	return n->op != OP_CONST && n->op != OP_INPUT;
}

/* In the copy of a share, rows of the base are read and not made. What only they take is no longer live. */
static void read_base(struct dag *copy, const struct share *s, const int *kernel)
{
	const struct dag *d = s->whole;

	for (size_t i = 0; i < d->output_count; i++) {
		const struct output *o = &d->outputs[i];

		if (kernel[i] == FIRST && s->live[o->value.i] && is_operation(&d->nodes[o->value.i]))
			copy->nodes[s->place[o->value.i]] = (struct node){.op = OP_INPUT,
				.arg = {{(uint32_t)o->argument}, {(uint32_t)o->row}}};
	}
}

static int make_base(struct part *p, struct share *s, const struct parts_of *x, struct arena *a)
{
	const char *name = text_format(a, "%s_part0", x->whole->algorithm->name);

	if (!part_build_share(p, s, FIRST, FIRST + 1, name, "Part 0 of it: the base's acceleration.", x, a) ||
		!plan_order(&p->function, x->tree, x->request, x->options, ORDERED_BASE, a))
		return 0;
	p->alive = plan_alive(&p->function.plan, a);
	p->is_hand = 1;
	return apart_set_rows(p, stretches_make, 0, x, a);
}

static int make_limbs(struct part *parts, int count, const struct dag *d, const int *owner, const struct parts_of *x,
	struct arena *spare, struct arena *a)
{
	struct share s;

	if (!share_begin(&s, d, owner, spare))
		return 0;
	for (int i = 0; i < count; i++)
		if (!apart_build(&parts[i], &s, i, 1 + i, "limbs, where the base's acceleration is found", x, a) ||
			!apart_set_rows(&parts[i], stretches_make, 0, x, a))
			return 0;
	return 1;
}

static int hold_less(const struct part *parts, int count, const struct parts_of *x, struct arena *a)
{
	int whole = plan_alive(&x->whole->plan, a);

	for (int i = 0; i < count; i++)
		if (parts[i].alive > LEFT * whole)
			return 0;
	return 1;
}

int base_first_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	const int base_rows = x->tree->joint_count ? x->tree->joints[0].nv : 0;
	struct share s;
	struct dag limbs;
	int *kernel, *owner, all;

	if (!is_served(x) || plan_alive(&x->whole->plan, spare) <= FULL)
		return !spare->failed;
	kernel = kernels_of(x->raw, base_rows, spare);
	owner = arena_alloc(spare, x->raw->output_count + 1, sizeof *owner);
	if (!kernel || !owner || !share_begin(&s, x->raw, kernel, spare))
		return 0;
	share_copy(&s, SECOND, SECOND + 1, &limbs, spare);
	if (limbs.failed)
		return 0;
	read_base(&limbs, &s, kernel);
	all = joined_own_beyond(owner, &limbs, x->tree, base_rows, spare);
	*parts = all ? arena_alloc(a, 1 + (size_t)all, sizeof **parts) : NULL;
	if (!*parts || !make_base(*parts, &s, x, a) || !make_limbs(*parts + 1, all, &limbs, owner, x, spare, a))
		return 0;
	*count = hold_less(*parts, 1 + all, x, spare) ? 1 + all : 0;
	return !spare->failed;
}

int base_first_is(const struct part *parts, int count, const struct request *k)
{
	return count && parts[0].is_hand && k->is_forward && request_wants(k, WANT_QDD);
}
