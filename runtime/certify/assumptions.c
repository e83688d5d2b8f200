#include "certify/assumptions.h"

static int has_planar(const struct analysis *a)
{
	return tree_has_type(&a->tree, JOINT_PLANAR);
}

static int has_floating(const struct analysis *a)
{
	return tree_has_type(&a->tree, JOINT_FLOATING);
}

static int has_bodies(const struct analysis *a)
{
	return dag_find_role(&a->dag, ROLE_LINK_INERTIA, 0) >= 0 || dag_find_role(&a->dag, ROLE_LINK_PAYLOAD, 0) >= 0;
}

static int has_friction(const struct analysis *a)
{
	for (int i = 0; i < a->tree.body_count; i++)
		if (a->request.own[OWN_FRICTION][i].x != 0)
			return 1;
	return dag_find_role(&a->dag, ROLE_JOINT_FRICTION, 0) >= 0 || dag_find_role(&a->dag, ROLE_FRICTION, 0) >= 0;
}

const struct assumption ASSUMPTIONS[ASSUMPTION_COUNT] = {
	{NULL,
		"rigid bodies as the URDF's decimals state them, angles within 5e-15 rad of a multiple of pi/2 being that; limits are "
		"the doubles "
		"nearest to the file's decimals",
		NULL},
	{NULL,
		"rotations between joints are exact rotations: where the generator takes one of their elements for zero, "
		"or for equal to another, within the rounding of the file's decimals or of extended precision, outputs "
		"change by some 1e-15 of their terms, and ranges are 2^-30 of themselves wider",
		NULL},
	{NULL, "all inputs are within their ranges, in any combination; a continuous joint has any angle that --trig takes",
		NULL},
	{has_planar, "a planar joint has any angle that --trig takes, unless a range is given", NULL},
	{has_floating, "quaternions: the square of the length of each is within 1e-6 of 1; it is any orientation", NULL},
	{has_bodies, "the ten numbers of a freed inertia or payload are each within the range that is listed, in any combination",
		NULL},
	{has_friction, "friction is the smooth one of the text: c qd / sqrt(qd^2 + width^2)", NULL},
	{NULL, "ranges are of the exact outputs; a text's result is within error_bound of these", NULL},
	{NULL, "rounding to nearest, subnormal numbers kept; products may be joined to sums or not; sine and cosine are the text's own",
		NULL},
	{NULL, "nothing overflows: where it may, error_bound is null",
		", and no_bound names the quantity and the range to narrow"},
	{NULL,
		"the double and extended arithmetic of the processor that proves is that of IEEE 754, and its sine and cosine in extended "
		"precision are good to 2^-60",
		NULL}};

int assumption_is_needed(const struct analysis *a, int i)
{
	return !ASSUMPTIONS[i].needed || ASSUMPTIONS[i].needed(a);
}
