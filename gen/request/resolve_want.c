/* The quantities that a scene asks for. */
#include "tree/lumps.h"
#include "tree/pattern.h"
#include "request/resolve.h"
#include <string.h>

/* "dtau_dpayload.hand": by what the scene frees. */
static enum rneagen_code want_by_freed(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	const char *freed = strstr(c->name, "_d") + strlen("_d");

	for (int i = 0; i < x->k->freed_count; i++)
		if (!strcmp(x->k->freed[i].word, freed)) {
			w->kind = c->name[1] == 'q' ? WANT_DQDD_DFREED : WANT_DTAU_DFREED;
			w->body = i;
			w->rows = x->t->nv * x->k->freed[i].rows;
			w->argument = request_argument(x, c->name);
			return RNEAGEN_OK;
		}
	if (!strcmp(freed, "qdd"))
		return scene_refuse(x->s, c, x->e, "the derivative by qdd is the mass matrix: want M");
	return scene_refuse(x->s, c, x->e,
		"'%.255s' is not free: no derivative by it; there is dtau_dq, dtau_dqd, and dtau_dNAME for what --free names",
		freed);
}

/* Elements that are stored. */
static enum rneagen_code want_matrix(const struct resolver *x, struct want *w)
{
	struct pattern p;

	if (!request_pattern(&p, x->t, w, x->k->dense, x->a))
		return error_memory(x->e);
	w->rows = p.rows;
	return RNEAGEN_OK;
}

/* The joint with this row of q, or of qd. */
static const char *name_of_row(const struct tree *t, int is_q, int row)
{
	const struct tree_joint *j = is_q ? tree_joint_of_q(t, row) : tree_joint_of_row(t, row);

	return *j->name ? j->name : "(base)";
}

/* What is given does not vary. */
static enum rneagen_code check_varies(const struct resolver *x, const struct scene_choice *c, enum want_kind kind)
{
	int is_q = want_is(kind, IS_BY_Q), count = is_q ? x->t->nq : want_is(kind, IS_BY_QD) ? x->t->nv : 0;
	const struct row *rows = is_q ? x->k->q : x->k->qd;

	for (int i = 0; i < count; i++)
		if (rows[i].is_given)
			return scene_refuse(x->s, c, x->e, "'%.255s': row %d of %s, joint '%.255s', is given: no derivative by it",
				c->name, i, is_q ? "q" : "qd", name_of_row(x->t, is_q, i));
	return RNEAGEN_OK;
}

/* "dtau_dNAME", "dqdd_dNAME" */
static int is_by_freed(const char *word)
{
	static const char *const others[] = {"dtau_dq", "dtau_dqd", "dqdd_dq", "dqdd_dqd", "dqdd_dtau"};

	for (size_t i = 0; i < sizeof others / sizeof *others; i++)
		if (!strcmp(word, others[i]))
			return 0;
	return !strncmp(word, "dtau_d", 6) || !strncmp(word, "dqdd_d", 6);
}

int request_pattern(struct pattern *p, const struct tree *t, const struct want *w, int dense, struct arena *a)
{
	int symmetric = want_is(w->kind, IS_SYMMETRIC);

	switch (want_type(w->kind)->shape) {
	case SHAPE_LUMPS:
		return pattern_lumps(p, t, dense, a);
	case SHAPE_COUPLED:
		return pattern_coupled(p, t, symmetric, dense, a);
	case SHAPE_CHAIN:
		return pattern_chain(p, t, w->body, dense, a);
	case SHAPE_POINT:
		return pattern_whole(p, 3, t->nv, 0, a);
	case SHAPE_SPATIAL:
		return pattern_momentum(p, t, dense, a);
	case SHAPE_SQUARE:
		return pattern_whole(p, 6, 6, symmetric && !dense, a);
	case SHAPE_PLACEMENT:
		return pattern_whole(p, 3, 4, 0, a);
	default:
		return pattern_make(p, t, symmetric, dense, a);
	}
}

int request_is_same(const struct want *a, const struct want *b)
{
	return a->kind == b->kind && (!want_is(a->kind, OF_LINK | OF_JOINT | OF_FREED) || !strcmp(a->word, b->word));
}

enum rneagen_code request_add_want(const struct resolver *x, const struct scene_choice *c, const struct want *w)
{
	for (int i = 0; i < x->k->want_count; i++)
		if (!strcmp(x->k->wants[i].word, w->word))
			return scene_refuse(x->s, c, x->e, "'%.255s' is wanted already", w->word);
		else if (request_is_same(&x->k->wants[i], w) && !want_is(w->kind, IS_PRODUCT))
			return scene_refuse(x->s, c, x->e, "'%.255s' is wanted already, as '%.255s'", w->word, x->k->wants[i].word);
	x->k->wants[x->k->want_count++] = *w;
	x->k->is_forward |= want_is(w->kind, FINDS_QDD);
	return RNEAGEN_OK;
}

/* A centre of mass is that of something. */
static enum rneagen_code check_masses(const struct resolver *x, const struct scene_choice *c, enum want_kind kind)
{
	int has_mass = !want_is(kind, OF_MASSES);

	for (int i = 0; i < x->t->body_count; i++)
		has_mass |= x->t->bodies[i].inertia.mass.x != 0 && !lumps_is_held(x->t, i);
	for (int i = 0; i < x->k->freed_count; i++) {
		enum freed_kind freed = x->k->freed[i].kind;

		has_mass |= freed == FREED_MASS || freed == FREED_INERTIA || freed == FREED_PAYLOAD;
	}
	return has_mass ? RNEAGEN_OK
			: scene_refuse(x->s, c, x->e, "'%.255s' is of masses, and nothing that moves has a mass", c->name);
}

/* An inertia that is felt in all six directions takes six degrees of freedom. */
static enum rneagen_code check_chain(const struct resolver *x, const struct scene_choice *c, const struct want *w)
{
	const struct tree *t = x->t;
	unsigned char *rows = arena_alloc(x->a, (size_t)t->nv, 1);
	const char *name = strchr(c->name, '.');
	int count = 0;

	if (!rows)
		return error_memory(x->e);
	for (int k = w->body; k >= 0 && w->kind == WANT_OPSPACE; k = t->bodies[k].parent)
		for (int i = t->bodies[k].iv; i < t->bodies[k].iv + joint_nv(t->bodies[k].type); i++) {
			count += !rows[i];
			rows[i] = 1;
		}
	if (w->kind != WANT_OPSPACE || count >= 6)
		return RNEAGEN_OK;
	return scene_refuse(x->s, c, x->e,
		"'%.255s' moves with %d coordinate%s, and takes six to be moved in all directions: want opspace_inv%.255s",
		name + 1, count, count == 1 ? "" : "s", name);
}

/* The link or joint that follows the word. */
static enum rneagen_code want_name(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	const char *name = strchr(c->name, '.');

	if (want_is(w->kind, OF_JOINT))
		w->body = request_find_body(x, c, name + 1);
	if (want_is(w->kind, OF_LINK))
		request_find_frame(x, c, name + 1, &w->body, &w->X);
	return x->e->code;
}

static enum rneagen_code want_rows(const struct resolver *x, struct want *w)
{
	const struct want_type *type = want_type(w->kind);

	w->rows = type->rows ? type->rows : x->t->nv;
	if (w->kind == WANT_POSE && x->k->pose == POSE_QUATERNION)
		w->rows = 7;
	else if (type->shape != SHAPE_NONE)
		return want_matrix(x, w);
	return RNEAGEN_OK;
}

enum rneagen_code request_quantity(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	struct kind_word kinds[WANT_COUNT];
	int kind;

	*w = (struct want){.word = c->name};
	if (is_by_freed(c->name))
		return want_by_freed(x, c, w);
	for (int i = 0; i < WANT_COUNT; i++)
		kinds[i] = (struct kind_word){want_type((enum want_kind)i)->word, want_is((enum want_kind)i, OF_LINK | OF_JOINT)};
	kind = strcmp(c->name, "dqdd_dtau") ? request_find_kind(x, c, kinds, WANT_COUNT) : WANT_MINV;
	if (kind < 0)
		return x->e->code;
	w->kind = (enum want_kind)kind;
	if (want_name(x, c, w) || check_varies(x, c, w->kind) || check_masses(x, c, w->kind) || check_chain(x, c, w) ||
		request_check_force(x, c, w) || want_rows(x, w))
		return x->e->code;
	w->argument = want_type(w->kind)->argument;
	if (!w->argument)
		w->argument = request_argument(x, c->name);
	return RNEAGEN_OK;
}

enum rneagen_code request_want(const struct resolver *x, const struct scene_choice *c)
{
	struct want w;

	return request_quantity(x, c, &w) ? x->e->code : request_add_want(x, c, &w);
}

int request_is_matrix(const struct request *k, const struct want *w)
{
	if (w->kind == WANT_POSE)
		return k->pose == POSE_ROWS;
	return want_type(w->kind)->shape != SHAPE_NONE;
}
