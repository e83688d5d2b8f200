#ifndef TESTS_HARD_QUAD_H
#define TESTS_HARD_QUAD_H
/* The independent reference once more, in quad precision (113 bits), in a library of its own: its names stay inside. */

#include <stddef.h>

struct quad;

/* NULL and a text in message[size] where the robot is refused. Its numbers are the URDF's decimals, in quad precision too, or
   the doubles nearest to them. `order` may be NULL. */
enum quad_numbers { QUAD_DECIMALS, QUAD_DOUBLES };
struct quad *quad_open(const char *urdf, size_t length, int floating, int independent, enum quad_numbers numbers,
	const double gravity[3], const char *order, char *message, size_t size);
void quad_close(struct quad *x);

/* Another gravity from here on, m/s^2. */
void quad_set_gravity(struct quad *x, const __float128 gravity[3]);

/* tau = ID(q, qd, qdd), the inputs as they are. */
void quad_rnea(struct quad *x, const double *q, const double *qd, const double *qdd, __float128 *tau);
void quad_rnea_wide(struct quad *x, const __float128 *q, const __float128 *qd, const __float128 *qdd, __float128 *tau);

/* Its derivatives, [nv][nv], a row for each torque, by central differences: by q, a floating joint's by a twist in its own
   frame, by qd, and by qdd, the mass matrix. */
void quad_derivatives(struct quad *x, const double *q, const double *qd, const double *qdd, __float128 *dq, __float128 *dqd,
	__float128 *M);

/* qdd = FD(q, qd, tau) by a factorisation of M, column by column, refined; returns 0 where M is not positive definite. */
int quad_forward(struct quad *x, const double *q, const double *qd, const double *tau, __float128 *qdd);

/* The condition number of M. */
double quad_condition(struct quad *x, const double *q);

/* The magnitudes of all products that the reference sums, per torque. */
void quad_magnitude(struct quad *x, const double *q, const double *qd, const double *qdd, double *size);

#endif
