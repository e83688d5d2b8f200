/* What inputs are drawn from where a text is measured by samples: the ranges that a scene states. */
#include "request/resolve.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum kind { KIND_Q, KIND_QD, KIND_QDD, KIND_TAU, KIND_Q_OF, KIND_QD_OF, KIND_QDD_OF, KIND_TAU_OF, KIND_GRAVITY,
	KIND_MASS, KIND_INERTIA, KIND_PAYLOAD, KIND_OFFSET, KIND_ARMATURE, KIND_DAMPING, KIND_FRICTION, KIND_ARMATURES, KIND_DAMPINGS,
	KIND_FRICTIONS, KIND_FEXT, KIND_JVP, KIND_VJP };

static const struct kind_word KINDS[] = {[KIND_Q] = {"q", 0}, [KIND_QD] = {"qd", 0}, [KIND_QDD] = {"qdd", 0},
	[KIND_TAU] = {"tau", 0}, [KIND_Q_OF] = {"q", 1}, [KIND_QD_OF] = {"qd", 1}, [KIND_QDD_OF] = {"qdd", 1},
	[KIND_TAU_OF] = {"tau", 1}, [KIND_GRAVITY] = {"gravity", 0}, [KIND_MASS] = {"mass", 1},
	[KIND_INERTIA] = {"inertia", 1}, [KIND_PAYLOAD] = {"payload", 1}, [KIND_OFFSET] = {"offset", 1},
	[KIND_ARMATURE] = {"armature", 1}, [KIND_DAMPING] = {"damping", 1}, [KIND_FRICTION] = {"friction", 1},
	[KIND_ARMATURES] = {"armature", 0}, [KIND_DAMPINGS] = {"damping", 0}, [KIND_FRICTIONS] = {"friction", 0},
	[KIND_FEXT] = {"fext", 1}, [KIND_JVP] = {"jvp_v", 0}, [KIND_VJP] = {"vjp_v", 0}};

/* What makes an input of these; of the others --free. */
static const char *const MAKERS[] = {[KIND_FEXT] = "--fext", [KIND_JVP] = "--want jvp", [KIND_VJP] = "--want vjp"};

/* "gravity[2]" without its row, which is returned; -1 where there is none. A joint or link may be called so itself. */
static int split_row(const struct resolver *x, struct scene_choice *c)
{
	const char *open = strrchr(c->name, '['), *dot = strchr(c->name, '.');
	size_t digits = open ? strspn(open + 1, "0123456789") : 0;

	if (!digits || digits > 4 || strcmp(open + 1 + digits, "]"))
		return -1;
	if (dot && (robot_joint(x->r, dot + 1) >= 0 || robot_link(x->r, dot + 1) >= 0))
		return -1;
	c->name = arena_string(x->a, c->name, (size_t)(open - c->name));
	return c->name ? atoi(open + 1) : (error_memory(x->e), -1);
}

/* ---- which rows ---- */

static enum rneagen_code find_states(
	const struct resolver *x, const struct scene_choice *c, enum kind kind, struct request_range *r)
{
	const struct tree *t = x->t;
	int is_q = kind == KIND_Q || kind == KIND_Q_OF, body;

	if (kind % KIND_Q_OF == (x->k->is_forward ? KIND_QDD : KIND_TAU))
		return scene_refuse(x->s, c, x->e, "'%.255s' is no input of this scene; %s is", c->name,
			x->k->is_forward ? "tau" : "qdd");
	r->argument = KINDS[kind].word;
	r->count = is_q ? t->nq : t->nv;
	if (!KINDS[kind].has_name)
		return RNEAGEN_OK;
	body = request_find_body(x, c, strchr(c->name, '.') + 1);
	if (body < 0)
		return x->e->code;
	if (t->bodies[body].follower)
		return scene_refuse(x->s, c, x->e, "'%.255s' follows another joint: name that", t->bodies[body].joint);
	r->level = 1;
	r->first = is_q ? t->bodies[body].iq : t->bodies[body].iv;
	r->count = is_q ? joint_nq(t->bodies[body].type) : joint_nv(t->bodies[body].type);
	return RNEAGEN_OK;
}

static enum rneagen_code refuse_input(const struct resolver *x, const struct scene_choice *c, enum kind kind)
{
	const char *meant = request_nearest_input(x, c->name);
	const char *what = KINDS[kind].has_name && kind == KIND_FEXT ? strchr(c->name, '.') + 1 : c->name;

	if (x->a->failed)
		return error_memory(x->e);
	if (meant)
		return scene_refuse(x->s, c, x->e, "'%.255s' is no input of this scene; did you mean '%.255s'?", c->name, meant);
	return scene_refuse(x->s, c, x->e, "'%.255s' is no input of this scene; %s%s%.255s makes it one", c->name,
		MAKERS[kind] ? MAKERS[kind] : "--free",
		kind < KIND_JVP ? " " : "", kind < KIND_JVP ? what : "");
}

static enum rneagen_code find_other(
	const struct resolver *x, const struct scene_choice *c, enum kind kind, struct request_range *r)
{
	const struct request *k = x->k;

	for (int i = 0; i < k->freed_count && kind < KIND_FEXT; i++)
		if (!strcmp(k->freed[i].word, c->name))
			*r = (struct request_range){.argument = k->freed[i].argument, .count = k->freed[i].rows};
	for (int i = 0; i < k->push_count && kind == KIND_FEXT; i++)
		if (!strcmp(k->pushes[i].word, c->name))
			*r = (struct request_range){.argument = k->pushes[i].argument, .count = 6};
	if (kind == KIND_JVP && request_wants(k, WANT_JVP))
		*r = (struct request_range){.argument = "jvp_v", .count = 3 * x->t->nv};
	if (kind == KIND_VJP && request_wants(k, WANT_VJP))
		*r = (struct request_range){.argument = "vjp_v", .count = k->vjp.rows};
	return r->argument ? RNEAGEN_OK : refuse_input(x, c, kind);
}

static enum rneagen_code take_row(
	const struct resolver *x, const struct scene_choice *c, enum kind kind, int row, struct request_range *r)
{
	if (kind == KIND_INERTIA || kind == KIND_PAYLOAD)
		return scene_refuse(x->s, c, x->e,
			"ten numbers that no body has apart are drawn together: the range of '%.255s' is that of its mass, kg",
			c->name);
	if (row >= r->count)
		return scene_refuse(x->s, c, x->e, "'%.255s' has no row %d: the last is %d", c->name, row, r->count - 1);
	r->first += row;
	r->count = 1;
	r->level = REQUEST_RANGE_LEVELS - 1;
	if ((kind == KIND_Q || kind == KIND_Q_OF) && tree_is_quaternion(x->t, r->first))
		return scene_refuse(x->s, c, x->e,
			"row %d of '%.255s' is of a quaternion, which is drawn over all orientations: leave it out", row,
			c->name);
	return RNEAGEN_OK;
}

/* ---- what cannot be ---- */

static int is_given(const struct resolver *x, enum kind kind, const struct request_range *r)
{
	const struct row *const rows[] = {x->k->q, x->k->qd, x->k->qdd, x->k->tau};

	return kind <= KIND_TAU_OF && request_has_all(rows[kind % KIND_Q_OF] + r->first, r->count);
}

static enum rneagen_code check(
	const struct resolver *x, const struct scene_choice *c, enum kind kind, const struct request_range *r)
{
	if (is_given(x, kind, r))
		return scene_refuse(x->s, c, x->e,
			"'%.255s' is given by --fold, and nothing of it is drawn: leave one of them out", c->name);
	for (int i = 0; i < x->k->range_count; i++) {
		const struct request_range *other = &x->k->ranges[i];

		if (!strcmp(other->argument, r->argument) && other->level == r->level && other->first < r->first + r->count &&
			r->first < other->first + other->count)
			return scene_refuse(x->s, c, x->e, "'%.255s' has a range already; give it one", c->name);
	}
	if (r->lower > r->upper)
		return scene_refuse(x->s, c, x->e, "takes LOWER,UPPER, and %g is more than %g", r->lower, r->upper);
	if (!isfinite(r->upper - r->lower))
		return scene_refuse(x->s, c, x->e, "from %g to %g is farther than a number reaches", r->lower, r->upper);
	if (kind >= KIND_MASS && kind <= KIND_PAYLOAD && r->lower < 0)
		return scene_refuse(x->s, c, x->e, "'%.255s' has the range of a mass, kg, which is never %g", c->name, r->lower);
	return RNEAGEN_OK;
}

enum rneagen_code request_range(const struct resolver *x, const struct scene_choice *c)
{
	struct scene_choice bare = *c;
	struct request_range r = {.argument = NULL};
	int row = split_row(x, &bare), kind = x->e->code ? -1 : request_find_kind(x, &bare, KINDS, sizeof KINDS / sizeof *KINDS);
	struct within limits[2];

	if (kind < 0)
		return x->e->code;
	if (kind <= KIND_TAU_OF ? find_states(x, &bare, (enum kind)kind, &r) : find_other(x, &bare, (enum kind)kind, &r))
		return x->e->code;
	if ((row >= 0 && take_row(x, &bare, (enum kind)kind, row, &r)) || scene_numbers(x->s, c, limits, 2, x->e))
		return x->e->code;
	r.lower = (double)limits[0].x;
	r.upper = (double)limits[1].x;
	if (check(x, c, (enum kind)kind, &r))
		return x->e->code;
	x->k->ranges[x->k->range_count++] = r;
	return RNEAGEN_OK;
}
