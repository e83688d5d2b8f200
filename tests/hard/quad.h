#ifndef TESTS_HARD_QUAD_H
#define TESTS_HARD_QUAD_H
/* The independent reference once more, in quad precision (113 bits), in a library of its own: its names stay inside. */

#include <stddef.h>

struct quad;

/* NULL and a text in message[size] where the robot is refused. `order` may be NULL. */
struct quad *quad_open(const char *urdf, size_t length, int floating, int independent, const double gravity[3],
	const char *order, char *message, size_t size);
void quad_close(struct quad *x);

/* tau = ID(q, qd, qdd), the inputs as they are. */
void quad_rnea(struct quad *x, const double *q, const double *qd, const double *qdd, __float128 *tau);

/* Its derivatives, [nv][nv], a row for each torque, by central differences: by q, a floating joint's by a twist in its own
   frame, by qd, and by qdd, the mass matrix. */
void quad_derivatives(struct quad *x, const double *q, const double *qd, const double *qdd, __float128 *dq, __float128 *dqd,
	__float128 *M);

/* The magnitudes of all products that the reference sums, per torque. */
void quad_magnitude(struct quad *x, const double *q, const double *qd, const double *qdd, double *size);

#endif
