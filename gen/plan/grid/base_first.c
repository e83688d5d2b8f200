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

/* Rows of a base that moves freely: the first ones. */
enum { BASE_ROWS = 6 };

int base_is_free(const struct tree *t)
{
	return t->body_count > 1 && t->bodies[0].type == JOINT_FLOATING && t->bodies[0].iv == 0 && tree_end(t, 0) == t->body_count;
}

int base_first_serves(const struct parts_of *x)
{
	return x->options->precision == RNEAGEN_F64 && base_is_free(x->tree);
}

static int is_served(const struct parts_of *x)
{
	const struct request *k = x->request;

	if (!x->has_kernels || !x->is_unpruned || x->is_relayed || x->options->strict || k->refine_steps)
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

static int make_base(struct part *p, struct share *s, int number, const char *of, const struct parts_of *x, struct arena *a)
{
	const char *name = text_format(a, "%s_part%d", x->whole->algorithm->name, number);
	const char *doc = text_format(a, "Part %d of it: the base's rows of %s.", number, of);

	p->what = text_format(a, "the base's rows of %s", of);
	if (!part_build_share(p, s, FIRST, FIRST + 1, name, doc, x, a) || !part_order(p, ORDERED_BASE, x, a))
		return 0;
	p->is_before = 1;
	return apart_set_rows(p, stretches_make, 0, x, a);
}

int base_first_divide(struct part *parts, int *count, int number, const struct dag *d, const char *of, int whole,
	const struct parts_of *x, struct arena *spare, struct arena *a)
{
	static const char WHAT[] = "limbs, where those are found";
	int *owner, limb_parts; /* by output of the limbs: its part; parts */
	struct share s;
	struct dag limbs;

	if (whole <= FULL)
		return 1;
	owner = arena_alloc(spare, d->output_count + 1, sizeof *owner);
	if (!owner || !divide(&s, &limbs, d, x->tree, spare))
		return 0;
	limb_parts = joined_own_beyond(owner, &limbs, x->tree, BASE_ROWS, spare);
	if (!limb_parts || !make_base(parts, &s, number, of, x, a) ||
		!apart_make_limbs(parts + 1, number + 1, limb_parts, &limbs, owner, WHAT, x, spare, a))
		return 0;
	*count = parts_alive(parts, 1 + limb_parts) <= LEFT * whole ? 1 + limb_parts : 0;
	return !spare->failed;
}

int base_first_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	if (!is_served(x))
		return 1;
	*parts = arena_alloc(a, (size_t)x->tree->nv + 1, sizeof **parts);
	return *parts && base_first_divide(*parts, count, 0, x->raw, "qdd", plan_alive(&x->whole->plan, spare), x, spare, a);
}

int base_first_is(const struct part *parts, int count, const struct request *k)
{
	return count && parts[0].is_before && k->is_forward && k->wants[0].kind == WANT_QDD; /* wants that are stored come first */
}
