#include "plan/grid/base_first.h"
#include "plan/grid/apart.h"
#include "plan/grid/joined.h"

/* Values at once of the whole, in f64, beyond which there are two kernels, and what share of them a part may have. H200, ps for
   each of a million samples, one kernel and two, in aos as well, and in brackets values of the whole and of the fullest part:
   hyq              310 and 572, 328 and 970 (144, 138)
   panda            186 and 318, 198 and 397 (114, 106)
   allegro_right    519 and 649, 526 and 1070 (204, 137)
   baxter           1370 and 903, but 65536 samples 86 and 100 us, 890 and 1200 (214, 198)
   anymal_kinova    767 and 711, 725 and 929 (278, 199)
   simple_humanoid  1740 and 992, 1670 and 1340 (345, 192) */
enum { FULL = 300 };
static const double LEFT = 0.7;

enum { FIRST, SECOND };

/* Does everything hang on a free base, which has the first rows? */
static int has_free_base(const struct tree *t)
{
	return t->body_count > 1 && t->bodies[0].type == JOINT_FLOATING && t->bodies[0].iv == 0 && tree_end(t, 0) == t->body_count;
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
static int divide(struct share *s, struct dag *limbs, const struct dag *d, int base_rows, struct arena *spare)
{
	const int *kernel = kernels_of(d, base_rows, spare);

	if (!kernel || !share_begin(s, d, kernel, spare))
		return 0;
	share_copy(s, SECOND, SECOND + 1, limbs, spare);
	if (!limbs->failed)
		read_base(limbs, s, kernel);
	return !limbs->failed;
}

static int make_base(struct part *p, struct share *s, const struct parts_of *x, struct arena *a)
{
	const char *name = text_format(a, "%s_part0", x->whole->algorithm->name);

	if (!part_build_share(p, s, FIRST, FIRST + 1, name, "Part 0 of it: the base's acceleration.", x, a) ||
		!part_order(p, ORDERED_BASE, x, a))
		return 0;
	p->is_before = 1;
	return apart_set_rows(p, stretches_make, 0, x, a);
}

int base_first_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	static const char WHAT[] = "limbs, where the base's acceleration is found";
	const int base_rows = joint_nv(JOINT_FLOATING), whole = is_served(x) ? plan_alive(&x->whole->plan, spare) : 0;
	struct share s;
	struct dag limbs;
	int *owner, limb_parts; /* by output of the limbs: its part; parts */

	if (whole <= FULL)
		return !spare->failed;
	owner = arena_alloc(spare, x->raw->output_count + 1, sizeof *owner);
	if (!owner || !divide(&s, &limbs, x->raw, base_rows, spare))
		return 0;
	limb_parts = joined_own_beyond(owner, &limbs, x->tree, base_rows, spare);
	*parts = limb_parts ? arena_alloc(a, 1 + (size_t)limb_parts, sizeof **parts) : NULL;
	if (!*parts || !make_base(*parts, &s, x, a) || !apart_make_limbs(*parts, 1, limb_parts, &limbs, owner, WHAT, x, spare, a))
		return 0;
	*count = parts_alive(*parts, 1 + limb_parts) <= LEFT * whole ? 1 + limb_parts : 0;
	return !spare->failed;
}

int base_first_is(const struct part *parts, int count, const struct request *k)
{
	return count && parts[0].is_before && k->is_forward && k->wants[0].kind == WANT_QDD; /* wants that are stored come first */
}
