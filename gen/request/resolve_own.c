/* What joints bear beside the links, rotor inertia, damping and friction: as constants, and as inputs. */
#include "request/resolve.h"
#include <string.h>

static int has_one_row(const struct resolver *x, int body)
{
	return joint_nv(x->t->bodies[body].type) == 1;
}

static enum rneagen_code set_armature(const struct resolver *x, const struct scene_choice *c)
{
	struct within value;
	int body = request_find_body(x, c, c->name);

	if (body < 0 || scene_numbers(x->s, c, &value, 1, x->e))
		return x->e->code;
	if (request_is_said(x, c))
		return scene_refuse(x->s, c, x->e, "the armature of '%.255s' is given already", c->name);
	if (!has_one_row(x, body))
		return scene_refuse(x->s, c, x->e, "an armature belongs to a joint with one row in qd, which '%.255s' is not",
			c->name);
	if (value.x < 0)
		return scene_refuse(x->s, c, x->e, "an armature of %g kg m^2 is less than nothing", (double)value.x);
	x->k->own[OWN_ARMATURE][body] = value;
	return RNEAGEN_OK;
}

/* What the URDF's <dynamics> says; rotors it does not know. */
static struct within term_of_urdf(const struct resolver *x, enum own_term term, int body)
{
	int j = robot_joint(x->r, x->t->bodies[body].joint);

	if (j < 0 || !has_one_row(x, body))
		return within_exact(0);
	return term == OWN_FRICTION ? x->r->joints[j].friction : x->r->joints[j].damping;
}

static void set_as_urdf(const struct resolver *x, enum own_term term)
{
	for (int i = 0; i < x->t->body_count; i++)
		x->k->own[term][i] = term_of_urdf(x, term, i);
}

/* Its square, and that of a hundred thousandth of it, a follower's, has to be a normal float. */
#define LEAST_WIDTH 1e-12

/* The width, in rad/s or m/s, is the velocity at which friction has grown to 1/sqrt(2) of its size. */
static enum rneagen_code set_friction(const struct resolver *x, const struct scene_choice *c)
{
	struct within width = x->k->friction_width;

	if (c->value && scene_numbers(x->s, c, &width, 1, x->e))
		return x->e->code;
	if (!(width.x >= LEAST_WIDTH))
		return scene_refuse(x->s, c, x->e, "a width of %g rad/s or m/s is none: friction must be smooth, in f32 too, "
			"so at least %g", (double)width.x, LEAST_WIDTH);
	x->k->friction_width = width;
	set_as_urdf(x, OWN_FRICTION);
	return RNEAGEN_OK;
}

enum rneagen_code request_own_terms(const struct resolver *x)
{
	const struct scene_choice *friction = scene_next(x->s, SCENE_FRICTION, NULL);

	x->k->friction_width = within_decimal(0.01, 0.01L);
	for (const struct scene_choice *c = NULL; (c = scene_next(x->s, SCENE_ARMATURE, c));)
		if (set_armature(x, c))
			return x->e->code;
	if (scene_next(x->s, SCENE_DAMPING, NULL))
		set_as_urdf(x, OWN_DAMPING);
	return friction ? set_friction(x, friction) : RNEAGEN_OK;
}

/* ---- inputs ---- */

static real nominal_of(const struct resolver *x, enum own_term term, int body)
{
	return term == OWN_ARMATURE ? x->k->own[term][body].x : term_of_urdf(x, term, body).x;
}

static enum rneagen_code free_of_joint(const struct resolver *x, const struct scene_choice *c, const char *joint, struct freed *f)
{
	f->body = request_find_body(x, c, joint);
	f->rows = 1;
	if (f->body < 0)
		return x->e->code;
	if (!has_one_row(x, f->body))
		return scene_refuse(x->s, c, x->e, "'%.255s' is of a joint with one row in qd, which '%.255s' is not", c->name, joint);
	if (!request_alloc_nominal(f, x))
		return error_memory(x->e);
	f->nominal[0] = nominal_of(x, (enum own_term)(f->kind - FREED_OWN), f->body);
	return RNEAGEN_OK;
}

/* Followers keep what is said of them: they have no rows. */
static enum rneagen_code free_of_all(const struct resolver *x, const struct scene_choice *c, struct freed *f)
{
	int count = 0;

	f->body = -1;
	f->rows = x->t->nv;
	if (!request_alloc_nominal(f, x))
		return error_memory(x->e);
	for (int i = 0; i < x->t->body_count; i++)
		if (has_one_row(x, i) && !x->t->bodies[i].follower) {
			f->nominal[x->t->bodies[i].iv] = nominal_of(x, (enum own_term)(f->kind - FREED_OWN), i);
			count++;
		}
	return count ? RNEAGEN_OK : scene_refuse(x->s, c, x->e, "no joint of this scene has one row in qd: '%s' is of such", c->name);
}

enum rneagen_code request_free_own(const struct resolver *x, const struct scene_choice *c, struct freed *f)
{
	const char *point = strchr(c->name, '.');

	return point ? free_of_joint(x, c, point + 1, f) : free_of_all(x, c, f);
}
