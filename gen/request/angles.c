/* What the scene's ranges say of the angles that have a sine. */
#include "request/request.h"
#include <math.h>

/* The largest magnitude of a row whose range is stated; else INFINITY. */
static double stated(const struct request *k, const char *argument, int row)
{
	const struct request_range *r = request_range_of(k, argument, row);

	return r ? fmax(fabs(r->lower), fabs(r->upper)) : (double)INFINITY;
}

static double largest_offset(const struct request *k)
{
	double most = 0;

	for (int i = 0; i < k->freed_count; i++)
		if (k->freed[i].kind == FREED_OFFSET)
			most = fmax(most, stated(k, k->freed[i].argument, 0));
	return most;
}

/* The largest magnitude of what a joint is turned by: a row that is given is a constant, but beside a free offset. */
static double largest(const struct request *k, int row)
{
	return k->q[row].is_given ? fabs((double)k->q[row].value.x) : stated(k, "q", row);
}

int request_bounds_angles(const struct request *k, const struct tree *t, double most)
{
	double offset = largest_offset(k);
	int count = 0;

	for (int i = 0; i < t->body_count; i++) {
		const struct body *b = &t->bodies[i];
		int row = b->iq + (b->type == JOINT_PLANAR ? 2 : 0);

		if (b->type != JOINT_REVOLUTE && b->type != JOINT_CONTINUOUS && b->type != JOINT_PLANAR)
			continue;
		if (k->q[row].is_given && offset == 0)
			continue;
		if (!(fabs((double)b->multiplier.x) * (largest(k, row) + offset) <= most))
			return 0;
		count++;
	}
	return count > 0;
}
