#ifndef PAYLOAD_ARM_H
#define PAYLOAD_ARM_H
/* The arm of payload.c: one whose payload is an input, one that carries the hidden payload, and how it moves. */

#include <rneagen/urdf.h>

enum { N = 7, P = 10, STATES = 100 }; /* joints; numbers of a payload; moments of the trajectory */

/* Payload: m, m cx, m cy, m cz, Ixx, Ixy, Ixz, Iyy, Iyz, Izz; the inertia about the link's origin, in its frame. */
struct body {
	double mass, centre[3], inertia[6]; /* the same, but the inertia about the centre of mass: as a URDF has it */
};

void payload_of(const struct body *b, double p[P]);

/* The arm whose payload on `link` is an input of each sample. Returns NULL, having said why, if it cannot be had. */
struct rnea_robot *arm_open(const char *path, const char *link);

/* The arm with the body fixed to `link`, as a link of its URDF. The same. */
struct rnea_robot *arm_open_loaded(const char *path, const char *link, const struct body *b);

/* tau[count][STATES][N] along the trajectory with each of `count` payloads, in one batch; `payloads` NULL: of the loaded
   arm, once. Returns 1, having said why, if that cannot be done. */
int arm_torques(const struct rnea_robot *arm, const double (*payloads)[P], size_t count, double *tau);

#endif
