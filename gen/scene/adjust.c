#include "scene/adjust.h"
#include "base/number.h"
#include <math.h>
#include <string.h>

static const real RIGHT = 1.57079632679489661923132169163975144L;

/* ---- what the scene says ---- */

static enum rneagen_code read_number(double *value, const struct scene *s, enum scene_key key, struct rneagen_error *e)
{
	const struct scene_choice *c = scene_next(s, key, NULL);
	struct within read;

	if (!c || scene_numbers(s, c, &read, 1, e))
		return e->code;
	*value = (double)read.x;
	return RNEAGEN_OK;
}

/* FRACTION, or FRACTION:sampled. */
static enum rneagen_code read_fraction(struct adjust *x, const struct scene *s, struct arena *a, struct rneagen_error *e)
{
	const struct scene_choice *c = scene_next(s, SCENE_DROP_BELOW, NULL);
	struct scene_choice bare;
	struct within read;
	const char *colon = c && c->value ? strrchr(c->value, ':') : NULL;

	if (!c)
		return RNEAGEN_OK;
	if (colon && strcmp(colon, ":sampled") != 0)
		return scene_refuse(s, c, e, "takes FRACTION or FRACTION:sampled, not '%.255s'", c->value);
	bare = *c;
	if (colon)
		bare.value = arena_string(a, c->value, (size_t)(colon - c->value));
	if (a->failed)
		return error_memory(e);
	if (scene_numbers(s, &bare, &read, 1, e))
		return e->code;
	x->prune = (double)read.x;
	x->is_sampled = colon != NULL;
	return RNEAGEN_OK;
}

enum rneagen_code adjust_read(struct adjust *x, const struct scene *s, struct arena *a, struct rneagen_error *e)
{
	double digits = 0;

	*x = (struct adjust){0};
	if (read_number(&x->snap, s, SCENE_SNAP_ANGLE, e) || read_number(&digits, s, SCENE_ROUND_CONSTANTS, e) ||
		read_fraction(x, s, a, e))
		return e->code;
	if (x->snap < 0 || x->snap > 0.1)
		return scene_refuse(s, scene_next(s, SCENE_SNAP_ANGLE, NULL), e, "takes an angle from 0 to 0.1 rad, not %s",
			number_plain(x->snap).s);
	if (scene_next(s, SCENE_ROUND_CONSTANTS, NULL) && !(digits >= 1 && digits <= 17 && digits == floor(digits)))
		return scene_refuse(s, scene_next(s, SCENE_ROUND_CONSTANTS, NULL), e, "takes a whole number from 1 to 17, not %s",
			number_plain(digits).s);
	if (x->prune < 0 || x->prune >= 1)
		return scene_refuse(s, scene_next(s, SCENE_DROP_BELOW, NULL), e, "takes a fraction from 0 to below 1, not %s",
			number_plain(x->prune).s);
	x->digits = (int)digits;
	return RNEAGEN_OK;
}

int adjust_is_asked(const struct adjust *x)
{
	return x->snap > 0 || x->digits > 0 || x->prune > 0;
}

int adjust_matters(const struct adjust *x, const struct scene *s, int line)
{
	return s->lines[line].key != SCENE_RANGE || adjust_is_asked(x) || x->has_angles;
}

/* ---- angles ---- */

static double off_of(struct within angle)
{
	real quarter = RIGHT * roundl(angle.x / RIGHT), off = fabsl(angle.x - quarter);
	struct within s, c;

	angle_sincos(angle, &s, &c);
	return s.x == 0 || c.x == 0 ? 0 : (double)off;
}

double adjust_off_rpy(const struct within rpy[3], double tolerance)
{
	double largest = 0;

	for (int i = 0; i < 3; i++) {
		double off = off_of(rpy[i]);

		if (off <= tolerance)
			largest = fmax(largest, off);
	}
	return largest;
}

static void snap(struct within rpy[3], double tolerance)
{
	for (int i = 0; i < 3; i++)
		if (off_of(rpy[i]) <= tolerance)
			rpy[i] = within_exact((real)(double)(RIGHT * roundl(rpy[i].x / RIGHT)));
}

struct robot adjust_snap(const struct robot *r, double tolerance, struct arena *a)
{
	struct robot s = *r;

	s.links = arena_alloc(a, (size_t)r->link_count, sizeof *s.links);
	s.joints = arena_alloc(a, (size_t)r->joint_count, sizeof *s.joints);
	if (!s.links || !s.joints)
		return s;
	memcpy(s.links, r->links, (size_t)r->link_count * sizeof *s.links);
	if (r->joint_count)
		memcpy(s.joints, r->joints, (size_t)r->joint_count * sizeof *s.joints);
	for (int i = 0; i < r->link_count; i++)
		snap(s.links[i].com_rpy, tolerance);
	for (int i = 0; i < r->joint_count; i++)
		snap(s.joints[i].rpy, tolerance);
	return s;
}
