#include "plan/grid/found/found.h"
#include "plan/grid/apart.h"
#include "plan/grid/base_first.h"
#include "plan/grid/hands/turns.h"
#include "plan/grid/joined.h"
#include "plan/grid/places.h"
#include "plan/stage.h"
#include <string.h>

/* Values at once of the whole, beyond which there are two kernels. H200, ps for each of a million samples, one kernel and two, in
   brackets values of the whole: f32: panda 96 and 134 (187), baxter 271 and 328 (234), floating panda 185 and 241 (302), floating
   hyq 340 and 347 (430), floating allegro_right 884 and 448 (513), atlas 3390 and 634 (741), g1_29dof 3370 and 686 (812); f64:
   iiwa14 129 and 202 (155), panda 209 and 245 (190), baxter 2310 and 640 (234), floating panda 1830 and 466 (302), floating hyq
   4105 and 808 (430), atlas 9490 and 1620, g1_29dof 10420 and 1670. Accelerations where links stand, f64: hyq on two feet 712
   and 780 (231), on four 3110 and 890 (404). */
enum { FULL_SINGLE = 450, FULL_DOUBLE = 210, FULL_CONTACTS_DOUBLE = 300 };

/* In aos in f32 whole samples come and go as one part, unless its code would be longer than the instruction cache: so many
   operations are. */
enum { LONG = 8200 };

/* What is made one after the other: of a vjp qdd and mu, then the rest; of a jvp qdd, then what tau changes by while qdd stands
   still, then M^-1 of that. Where links stand, forces on these come first. */
enum { MOST_ROUNDS = 3 };

struct round {
	const char *what;
	int is_forward; /* accelerations; else torques with their product */
};

struct rounds {
	int count, has_forces; /* the first finds forces on what stands */
	struct round of[MOST_ROUNDS];
};

static const struct rounds OF_VJP = {2, 0, {{"qdd, and M^-1 of the weights", 1}, {"the rest, where both are found", 0}}},
	OF_JVP = {3, 0, {{"qdd", 1}, {"what tau changes by where qdd stands still", 0}, {"M^-1 of that", 1}}},
	OF_CONTACTS = {2, 1, {{"forces on what stands", 1}, {"qdd, with these", 1}}},
	OF_CONTACTS_VJP = {3, 1, {{"forces on what stands, and those of the weights", 1},
		{"qdd, and M^-1 of the weights, with these", 1}, {"the rest, where all are found", 0}}},
	OF_MANY_CONTACTS_VJP = {3, 1, {{"forces on what stands, and those of the weights", 1}, {"qdd, with these", 1},
		{"M^-1 of the weights, and the rest", 0}}};

/* One of them on its way to parts. */
struct made {
	struct request request;
	struct want qdd;
	struct parts_of of;
};

/* All parts so far, of kernels one after the other. */
struct chain {
	const struct rounds *rounds;
	struct dag dags[MOST_ROUNDS];
	struct made made[MOST_ROUNDS];
	struct part *parts;
	int count, level;
};

static enum want_kind product_of(const struct parts_of *x)
{
	return x->request->wants[0].kind;
}

/* In aos mu takes the place of the third array, which must be tau: it is not where a scene gives all of tau, or of qd. */
static int has_places(const struct parts_of *x)
{
	return x->options->layout != RNEAGEN_AOS ||
		dag_find_role(x->raw, ROLE_JOINT_TORQUE, 0) == stretches_found_place(x->raw, FOUND_MU);
}

/* Do all forces stand in rows that nothing writes before they are read? Rows of qdd of a base that moves may be made first; a
   vjp has rows by qd. */
static int have_rows(const struct parts_of *x)
{
	int is_base_first = base_is_free(x->tree) && product_of(x) == WANT_QDD;

	return x->request->contact_rows <= x->tree->nv - (is_base_first ? joint_nv(JOINT_FLOATING) : 0);
}

static int is_served(const struct parts_of *x)
{
	const struct rneagen_options *o = x->options;
	const struct request *k = x->request;

	if (!x->has_kernels || !x->is_unpruned || o->strict || k->refine_steps || !k->is_forward || k->stored_count != 1 ||
		!stage_is_plain(o))
		return 0;
	if (k->contact_count)
		return (product_of(x) == WANT_QDD || (product_of(x) == WANT_VJP && request_is_plain_product(k, &k->vjp))) &&
			o->layout == RNEAGEN_SOA && have_rows(x);
	if (product_of(x) == WANT_VJP)
		return request_is_plain_product(k, &k->vjp) && has_places(x);
	return product_of(x) == WANT_JVP && request_is_plain_product(k, &k->jvp) && o->layout == RNEAGEN_SOA;
}

static int is_full(const struct parts_of *x, struct arena *a)
{
	int full = product_of(x) == WANT_QDD ? FULL_CONTACTS_DOUBLE : FULL_DOUBLE;

	return plan_alive(&x->whole->plan, a) > (x->options->precision == RNEAGEN_F32 ? FULL_SINGLE : full);
}

/* By output, the round that stores it. The first are qdd, before these forces where they are found with it; of a vjp rows from
   2 nv on are mu, of a jvp the next nv are the second round's. */
static int *rounds_of(const struct dag *d, const struct parts_of *x, enum handed handed, struct arena *a)
{
	int nv = x->tree->nv, *round = arena_alloc(a, d->output_count + 1, sizeof *round);
	int first = nv + (handed == HANDED_FOUND ? 2 * x->request->contact_rows : 0);
	int is_mu_found = !x->request->contact_count || contacts_weights_fit(x->tree, x->request);

	for (int i = 0; i < (int)d->output_count && round; i++)
		round[i] = product_of(x) == WANT_JVP ? i / nv : i >= first && (d->outputs[i].row < 2 * nv || !is_mu_found);
	return round;
}

int found_rounds(struct dag *dags, int count, const struct parts_of *x, enum handed handed, struct arena *a)
{
	struct dag raw;
	struct share share;
	const int *round;

	dag_init(&raw, a);
	algorithm_build_handed(&raw, x->tree, x->request, handed);
	round = raw.failed ? NULL : rounds_of(&raw, x, handed, a);
	if (!round || !share_begin(&share, &raw, round, a))
		return 0;
	for (int i = 0; i < count; i++) {
		share_copy(&share, i, i + 1, &dags[i], a);
		if (dags[i].failed)
			return 0;
	}
	return 1;
}

/* Where links stand, the forces' round has a DAG of its own. */
static int make_rounds(struct chain *c, const struct parts_of *x, struct arena *a)
{
	if (!x->request->contact_count)
		return found_rounds(c->dags, c->rounds->count, x, HANDED_ALL, a);
	dag_init(&c->dags[0], a);
	algorithm_build_handed(&c->dags[0], x->tree, x->request, HANDED_FORCES);
	return !c->dags[0].failed && found_rounds(c->dags + 1, c->rounds->count - 1, x, HANDED_BY_FORCES, a);
}

static const struct rounds *rounds_for(const struct parts_of *x)
{
	if (!x->request->contact_count)
		return product_of(x) == WANT_JVP ? &OF_JVP : &OF_VJP;
	if (product_of(x) == WANT_QDD)
		return &OF_CONTACTS;
	return contacts_weights_fit(x->tree, x->request) ? &OF_CONTACTS_VJP : &OF_MANY_CONTACTS_VJP;
}

/* Rows of a jvp hold first the one, then the other. */
static void rename_found(struct dag *d)
{
	static const char QUANTITY[sizeof d->nodes->tag.quantity] = "rhs";

	for (size_t i = 0; i < d->count; i++)
		if (d->nodes[i].op == OP_INPUT && strcmp(d->nodes[i].tag.quantity, "qdd") == 0)
			memcpy(d->nodes[i].tag.quantity, QUANTITY, sizeof QUANTITY);
}

static int begin(struct chain *c, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	int is_jvp = product_of(x) == WANT_JVP;

	c->rounds = rounds_for(x);
	c->parts = arena_alloc(a, (size_t)c->rounds->count * ((size_t)x->tree->nv + 2), sizeof *c->parts);
	if (!c->parts || !make_rounds(c, x, spare))
		return 0;
	if (is_jvp)
		rename_found(&c->dags[2]);
	for (int i = 0; i < c->rounds->count; i++) {
		struct made *m = &c->made[i];

		m->request = *x->request;
		m->request.is_forward = 0;
		if (c->rounds->of[i].is_forward)
			m->request = request_of_accelerations(x->request, &m->qdd);
		if (i > 0) /* by then their forces are known */
			m->request.contact_count = m->request.contact_rows = 0;
		m->of = *x;
		m->of.raw = &c->dags[i];
		m->of.request = &m->request;
	}
	return 1;
}

/* ---- parts of a round ---- */

/* In aos outputs stand in the places of inputs: qdd where q was, mu where tau was, and what it leaves for the vjp by qd is
   written over. */
static int set_rows(struct part *p, int round, const struct parts_of *x, struct arena *a)
{
	int nv = x->options->layout == RNEAGEN_AOS ? x->tree->nv : 0;

	return apart_set_rows(p, round > 0 && nv ? stretches_make_found : stretches_make, nv, x, a);
}

static int is_together(const struct dag *d, const struct rneagen_options *o)
{
	return o->layout == RNEAGEN_AOS && o->precision == RNEAGEN_F32 && plan_flops(plan_operations_of(d, 0, d->count)) <= LONG;
}

/* In parts where limbs share nothing: of `d`, from parts[first] on. Returns how many there are; 0 when memory runs out. */
static int make_limbs(
	struct chain *c, int round, const struct dag *d, int first, struct arena *spare, struct arena *a)
{
	const struct parts_of *x = &c->made[round].of;
	int *owner = arena_alloc(spare, d->output_count + 1, sizeof *owner), count;
	struct share share;

	if (!owner || !share_begin(&share, d, owner, spare))
		return 0;
	count = is_together(d, x->options) ? 1 : joined_own(owner, d, x->tree->nv, spare);
	for (int i = 0; i < count; i++) {
		struct part *p = &c->parts[first + i];

		if (!apart_build(p, &share, i, first + i, c->rounds->of[round].what, x, a) || !set_rows(p, round, x, a))
			return 0;
	}
	return count;
}

/* How a round is made: by so many kernels of one part, and then by one of so many parts. */
struct kernels {
	int before, main;
};

/* The base's rows first, where that serves: k->before is 0 where it does not. Returns 0 when memory runs out. */
static int divide(struct kernels *k, struct chain *c, int round, struct arena *spare, struct arena *a)
{
	const struct parts_of *x = &c->made[round].of;
	struct base_first base;
	struct part whole;

	if (!base_first_serves(x))
		return 1;
	memset(&whole, 0, sizeof whole);
	if (!part_build(&whole, x->raw, "", "", x, spare) || !part_order(&whole, ORDERED_PART, x, spare) ||
		!base_first_divide(&base, c->parts + c->count, c->count, c->rounds->of[round].what, whole.alive, x, spare, a))
		return 0;
	*k = (struct kernels){base.before, base.limbs};
	return 1;
}

/* One side of the base first, which hands on sums to the other one and the base, where that serves. */
static int make_hands(struct kernels *k, struct chain *c, int round, struct arena *spare, struct arena *a)
{
	const struct parts_of *x = &c->made[round].of;
	struct hands h;

	if (!hands_find(&h, x, spare))
		return 0;
	if (h.count != 1)
		return 1;
	if (!apart_make_hands(c->parts + c->count, c->count, &h, x, spare, a))
		return 0;
	for (int i = 0; i < h.count; i++)
		if (!set_rows(&c->parts[c->count + i], round, x, a))
			return 0;
	*k = (struct kernels){h.count, make_limbs(c, round, &h.levels->rest, c->count + h.count, spare, a)};
	return k->main;
}

/* Forces on what stands, which take all limbs as the base's rows do. */
static int make_forces(struct kernels *k, struct chain *c, struct arena *spare, struct arena *a)
{
	int count;

	if (!base_first_make_before(c->parts, &count, &c->dags[0], 0, c->rounds->of[0].what, &c->made[0].of, spare, a))
		return 0;
	*k = (struct kernels){count - 1, 1};
	return 1;
}

static int make_kernels(struct kernels *k, struct chain *c, int round, struct arena *spare, struct arena *a)
{
	const struct parts_of *x = &c->made[round].of;
	int is_forward = c->rounds->of[round].is_forward, has_forces = c->rounds->has_forces;

	*k = (struct kernels){0};
	if (has_forces && round == 0)
		return make_forces(k, c, spare, a);
	/* a side would write rows in which the other one's forces stand */
	if (x->options->layout == RNEAGEN_SOA && base_is_free(x->tree) && (is_forward || !has_forces) &&
		!(is_forward ? divide : make_hands)(k, c, round, spare, a))
		return 0;
	if (!k->before)
		k->main = make_limbs(c, round, &c->dags[round], c->count, spare, a);
	return k->main;
}

static int add_round(struct chain *c, int round, struct arena *spare, struct arena *a)
{
	int is_last = round == c->rounds->count - 1;
	struct part *p = c->parts + c->count;
	struct kernels k;

	if (!make_kernels(&k, c, round, spare, a))
		return 0;
	for (int i = 0; i < k.before + k.main; i++) {
		p[i].is_before = i < k.before || !is_last;
		p[i].level = p[i].is_before ? c->level + (i < k.before ? i : k.before) : 0;
	}
	c->level += 1 + k.before;
	c->count += k.before + k.main;
	return 1;
}

/* Kernels that may have stored a row which the last one reads: of a jvp's base those of qdd, of the second round, and of its
   own. */
enum { MOST_STORING = 3 };

/* Are rows read before others are written in their places? */
static int are_in_order(int *are, const struct part *parts, int count, const struct parts_of *x, struct arena *a)
{
	const struct dag *d = &x->whole->dag;

	*are = turns_serve(parts, count, d->arguments[parts_handed(d)].rows, MOST_STORING, a);
	for (int i = 0, serves; i < count && *are; i++) {
		if (!places_serve(&serves, &parts[i].function, parts[i].function.stretches, a))
			return 0;
		*are = serves;
	}
	return !a->failed;
}

int found_make(struct part **parts, int *count, const struct parts_of *x, struct arena *spare, struct arena *a)
{
	struct chain c = {0};
	int are;

	if (!is_served(x) || !is_full(x, spare))
		return !spare->failed;
	if (!begin(&c, x, spare, a))
		return 0;
	for (int i = 0; i < c.rounds->count; i++)
		if (!add_round(&c, i, spare, a))
			return 0;
	if (!are_in_order(&are, c.parts, c.count, x, spare))
		return 0;
	*parts = c.parts;
	*count = are ? c.count : 0;
	parts_divide(*parts, *count, DIVIDED_IN_ROUNDS);
	return 1;
}
