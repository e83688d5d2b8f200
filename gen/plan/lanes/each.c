#include "plan/lanes/each.h"
#include "plan/grid/again.h"
#include "plan/grid/places.h"
#include "plan/lanes/angles.h"
#include "plan/lanes/lanes.h"
#include "plan/readings.h"
#include "plan/stretch.h"

/* A loop makes two turns. */
enum { LIMBS = 2 };

/* Joints in a stretch of which motion is made again; values for which a thread has room, and what one more costs, in
   operations. H100, 1 M samples of tau with vjp in f64, ps, by stretches of 2, 3, 4, in brackets the most values at once: atlas
   1310 (183), 1569 (194), -; g1_29dof 1287 (139), 1253 (128), 1337 (137); jvrc1 1903 (224), 2119 (241), 2073 (261);
   g1_d_wheeled 2436 (173), 2499 (181), 2466 (201); romeo 898 (117), 884 (135), 853 (121). With all motion kept: atlas 1901
   (247), g1_29dof 2094 (242), jvrc1 3094 (330), romeo 1258 (167). H200, 4 M samples, each limb in threads of its own
   (each_threads.c), the same: atlas 754, 726, 754; g1_29dof 736, 690 to 755, 726; jvrc1 1231, 1389, 1550; g1_d_wheeled 943,
   964, 1097; romeo 656, 661, 628 to 646. */
static const int LENGTHS[] = {0, 4, 3, 2};
enum { ROOM = 110, FULL_SINGLE = 340 };
static const double COST_BEYOND = 40;

/* ---- which groups of limbs ---- */

/* Do the rows of each limb stand as far behind those of the one before it, in q and in qd? */
static int stands_evenly(const struct alike_group *g, int limbs, const struct tree *t)
{
	const struct body *first = &t->bodies[g->first[0]];
	int shift = t->bodies[g->first[1]].iv - first->iv;

	for (int k = 1; k < limbs && shift > 0; k++)
		for (int i = 0; i < g->bodies; i++) {
			const struct body *x = first + i, *y = &t->bodies[g->first[k] + i];

			if (!x->follower && (y->iv - x->iv != k * shift || y->iq - x->iq != k * shift))
				return 0;
		}
	return shift > 0;
}

static void keep_even(struct alike *limbs, const struct tree *t)
{
	int kept = 0;

	for (int i = 0; i < limbs->group_count; i++)
		if (stands_evenly(&limbs->groups[i], limbs->limbs, t))
			limbs->groups[kept++] = limbs->groups[i];
	limbs->group_count = kept;
}

static void set_loops(struct each *x, const struct alike *limbs, const struct tree *t)
{
	*x = (struct each){.limbs = limbs->limbs, .count = limbs->group_count};
	for (int i = 0; i < limbs->group_count; i++) {
		const struct alike_group *g = &limbs->groups[i];

		x->shift[i + 1] = t->bodies[g->first[1]].iv - t->bodies[g->first[0]].iv;
		x->bodies[i + 1] = g->bodies;
		for (int k = 0; k < limbs->limbs; k++)
			x->first[i + 1][k] = g->first[k];
	}
}

/* Is one the other's negation, in the same loop? */
static int are_opposite(const struct dag_lanes *a, const struct dag_lanes *b)
{
	int are = a->loop == b->loop;

	for (int k = 0; k < LIMBS; k++)
		are &= a->x[k] == -b->x[k];
	return are;
}

/* The table of constants: of a number and its negation one stands there. */
static int find_numbers(struct each *x, const struct dag *d, struct arena *a)
{
	uint32_t *uses = arena_alloc(a, d->count, sizeof *uses);
	int *number = arena_alloc(a, d->lane_count + 1, sizeof *number), *place = arena_alloc(a, d->lane_count + 1, sizeof *place);

	if (a->failed)
		return 0;
	dag_uses(d, uses);
	x->number_count = 0;
	for (size_t i = 0; i < d->count; i++) {
		const int lanes = d->nodes[i].op == OP_CONST && uses[i] ? (int)d->nodes[i].arg[0].i - 1 : -1;
		int k = 0;

		if (lanes < 0)
			continue;
		while (k < x->number_count && !are_opposite(&d->lanes[number[k]], &d->lanes[lanes]))
			k++;
		place[lanes] = k < x->number_count ? -1 - k : k + 1;
		if (k == x->number_count)
			number[x->number_count++] = lanes;
	}
	x->number = number;
	x->place = place;
	return 1;
}

/* By row: that of the first limb that is alike. */
static const int *find_first_rows(const struct each *x, const struct tree *t, struct arena *a)
{
	int *row = arena_alloc(a, (size_t)t->nv + 1, sizeof *row);

	for (int i = 0; i < t->nv && row; i++)
		row[i] = i;
	for (int loop = 1; loop <= x->count && row; loop++)
		for (int k = 1; k < x->limbs; k++)
			for (int i = 0; i < x->bodies[loop]; i++)
				row[t->bodies[x->first[loop][k] + i].iv] = t->bodies[x->first[loop][0] + i].iv;
	return row;
}

/* By node: lanes are made in a loop, and each of them leaves it. */
static const unsigned char *find_loops(const struct dag *d, struct arena *a)
{
	unsigned char *loop = arena_alloc(a, d->count, 1);

	for (size_t i = 0; i < d->count && loop; i++) {
		const struct node *n = &d->nodes[i];

		if (n->op == OP_INPUT)
			loop[i] = (unsigned char)dag_loop_of(n);
		else if (n->op == OP_CONST && n->arg[0].i)
			loop[i] = (unsigned char)d->lanes[n->arg[0].i - 1].loop;
		for (int k = 0; k < op_arity[n->op] && n->is_wide; k++)
			if (loop[n->arg[k].i])
				loop[i] = loop[n->arg[k].i];
	}
	return loop;
}

/* ---- the whole ---- */

/* Do the sines of each loop stand evenly in the table of the whole? */
static int find_sines(const struct function *p, const struct parts_of *x, struct arena *a)
{
	const struct angles list = angles_of(&x->whole->plan, 0, a);

	for (const struct line *l = p->plan.lines; l < p->plan.lines + p->plan.line_count; l++) {
		struct ref angle = p->dag.nodes[l->value.i].arg[0];
		int first, step;

		if (l->kind != LINE_SINCOS)
			continue;
		first = angles_place(&list, &p->dag, angle, p->loops, 0);
		step = angles_place(&list, &p->dag, angle, p->loops, 1) - first;
		for (int k = 0; k < p->loops->limbs; k++)
			if (first < 0 || angles_place(&list, &p->dag, angle, p->loops, k) != first + k * step)
				return 0;
	}
	return 1;
}

static int is_for_all(const struct dag *d)
{
	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].per_batch)
			return 1;
	return 0;
}

/* A vjp's rows for qd and qdd that stand one row further on, as those for q do, take the places of the next limb's inputs, whose
   turn comes later. */
static int stand_apart(const struct stretches *s)
{
	return !s->period || !s->shift;
}

static int may_have(const struct part *p, const struct parts_of *x)
{
	return stand_apart(p->function.stretches) && x->is_unpruned && !x->options->strict && !is_for_all(x->raw);
}

/* What is tried. */
struct trial {
	const struct parts_of *x;
	struct each *loops;
	struct dag lanes; /* in memory that is given back at the end */
	struct arena spare;
};

/* The DAG of lanes. *serves: are limbs alike? Returns 0 when memory runs out. */
static int begin(struct trial *y, int *serves)
{
	const struct request *k = y->x->request;
	struct arena *a = &y->spare;
	struct alike limbs;
	struct tree told;
	struct dag raw;

	*serves = tree_alike(&limbs, &told, y->x->tree, LIMBS, !k->freed_count && !k->push_count, a);
	keep_even(&limbs, y->x->tree);
	*serves &= limbs.group_count > 0;
	if (!*serves)
		return !a->failed;
	set_loops(y->loops, &limbs, y->x->tree);
	dag_init(&raw, a);
	y->x->whole->algorithm->build(&raw, &told, k);
	raw.width = LIMBS;
	raw.is_each = 1;
	dag_init(&y->lanes, a);
	lanes_of_twins(&y->lanes, &raw, &told, &limbs);
	return !y->lanes.failed && !a->failed;
}

/* The lines, with motion made again in stretches of so many joints (grid/again.h); 0: it is kept. */
static int plan_lines(struct trial *y, struct function *p, int joints, struct arena *spare, struct arena *a)
{
	const struct parts_of *x = y->x;
	struct dag fused;

	dag_init(joints ? &fused : &p->dag, joints ? spare : a);
	dag_fuse(joints ? &fused : &p->dag, &y->lanes, 0);
	if (joints)
		again_make(&p->dag, &fused, x->tree, joints, find_first_rows(y->loops, x->tree, spare), a);
	return !spare->failed && plan_build(&p->plan, &p->dag, x->tree, a) &&
		(!request_wants_derivative(x->request) || plan_order(p, x->tree, x->request, x->options, ORDERED_LOOPS, a));
}

/* *serves: can the loops stand there, each behind what it takes, and can outputs take the places of inputs? Returns 0 when memory
   runs out. */
static int make(struct trial *y, struct function *p, int joints, int *serves, struct arena *a)
{
	struct arena spare;
	int done;

	arena_init(&spare, y->x->options->allocator);
	done = plan_lines(y, p, joints, &spare, a);
	p->loops = y->loops;
	if (done)
		y->loops->loop = find_loops(&p->dag, a);
	done = done && y->loops->loop && find_numbers(y->loops, &p->dag, a) && each_gather(serves, &y->loops->is_apart, p, &spare, a);
	if (done && *serves)
		*serves = find_sines(p, y->x, &spare);
	done = done && (!*serves || places_serve(serves, p, p->stretches, &spare)) && !spare.failed;
	arena_free(&spare);
	return done;
}

/* What a length costs, less than 0 where it does not serve, and how many values wait. Returns 0 when memory runs out. */
static int cost_of(double *cost, int *most, struct trial *y, const struct function *of, int joints)
{
	struct function p = *of;
	struct arena a;
	int serves, done;

	*most = 0;
	arena_init(&a, y->x->options->allocator);
	done = make(y, &p, joints, &serves, &a) && readings_alive(most, &p.plan, &a);
	*cost = !done || !serves ? -1 : plan_flops(plan_operations(&p.plan)) + (*most > ROOM ? COST_BEYOND * (*most - ROOM) : 0);
	arena_free(&a);
	return done;
}

/* Is all motion kept, of which so many values wait, or nothing serves? In f32 registers have room for more: motion is made
   again only where more wait, all motion kept, than FULL_SINGLE. H200, 1 M samples of the
   torques with their vjp, ps, motion kept and made again, in brackets us of 16384 and of 65536: g1_brainco, 382 values, 2646
   and 2464 (46 and 38, 157 and 150), by threads 2124 (27, 144); jvrc1, 330, 468 and 486 (16.5 and 17.5, 67 both); pr2, 247, 291
   and 259 (10.2 and 11.8, 24 and 25); g1_d_wheeled, 329, whole 512, in a loop so 467 (15.5 and 17.9, 104 and 49). */
static int keeps_all(const struct trial *y, double cost, int most)
{
	return y->x->options->precision == RNEAGEN_F32 && (cost < 0 || most <= FULL_SINGLE);
}

/* The length that costs least, where motion may be made again. Returns 0 when memory runs out. */
static int choose_length(int *joints, struct trial *y, const struct function *of)
{
	double least = -1;

	*joints = 0;
	if (!again_is_of(y->x) || !again_is_ordered(y->x->tree))
		return 1;
	for (size_t i = 0; i < sizeof LENGTHS / sizeof *LENGTHS; i++) {
		double cost;
		int most;

		if (!cost_of(&cost, &most, y, of, LENGTHS[i]))
			return 0;
		if (LENGTHS[i] == 0 && keeps_all(y, cost, most))
			return 1;
		if (cost >= 0 && (least < 0 || cost < least)) {
			least = cost;
			*joints = LENGTHS[i];
		}
	}
	return 1;
}

/* Returns 0 when memory runs out. */
static int make_best(struct part *p, struct trial *y, struct arena *a)
{
	struct function *each = arena_alloc(a, 1, sizeof *each);
	int joints, serves;

	y->loops = arena_alloc(a, 1, sizeof *y->loops);
	if (a->failed || !begin(y, &serves))
		return 0;
	*each = (struct function){.algorithm = p->function.algorithm, .stretches = p->function.stretches};
	if (!serves || !choose_length(&joints, y, each))
		return !serves;
	if (!make(y, each, joints, &serves, a))
		return 0;
	if (!serves)
		return 1;
	p->joints = joints;
	p->function.each = each;
	y->loops->most_block = each_most_block(each, y->x);
	return readings_alive(&p->alive, &each->plan, a);
}

int each_make(struct part *p, const struct parts_of *x, struct arena *a)
{
	struct trial y = {.x = x};
	int done;

	if (!may_have(p, x))
		return 1;
	arena_init(&y.spare, x->options->allocator);
	done = make_best(p, &y, a);
	arena_free(&y.spare);
	return done;
}
