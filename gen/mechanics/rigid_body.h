#ifndef RNEAGEN_RIGID_BODY_H
#define RNEAGEN_RIGID_BODY_H
/* A body as a load: the wrench that its own motion takes, and its energies. */

#include "dag/svec.h"
#include "tree/tree.h"

/* How a body moves, all in its own frame. */
struct motion {
	struct svec v, w, dw, a; /* velocity of the origin, angular velocity, its rate, acceleration less gravity */
	struct smat U;           /* [dw]x + [w]x[w]x: U r is the acceleration of a point r fixed in the body */
};

/* That U of w and dw. */
struct smat motion_rate_matrix(struct dag *d, struct svec w, struct svec dw);

/* dV + 2 w x V: what sliding at V adds to an acceleration in a frame that turns with w. */
struct svec motion_slide(struct dag *d, struct svec w, struct svec V, struct svec dV);

/* The ten inertial parameters as expressions: the tree's, and what inputs add to them. */
struct parameters {
	struct ref mass, I[6]; /* xx xy xz yy yz zz about the origin */
	struct svec h;
};

/* f = m a + U h, n = I dw + w x I w + h x a, with h = m c; or from the centre of mass: f = m (a + U c),
   n = I_c dw + w x I_c w + c x f (Featherstone 2008, 2.70; Craig 6.49 to 6.51). */
void rigid_body_wrench(struct dag *d, const struct body *k, const struct motion *x, struct svec *f, struct svec *n);

/* n = I dw + w x I w */
struct svec rigid_body_moment(struct dag *d, const struct inertia *I, const struct motion *x);

/* The same wrench from parameters that are not all numbers. */
void rigid_body_wrench_free(struct dag *d, const struct parameters *p, const struct motion *x, struct svec *f, struct svec *n);

/* I, and I w */
struct smat rigid_body_inertia_matrix(const struct parameters *p);
struct svec rigid_body_inertia_times(struct dag *d, const struct parameters *p, struct svec w);

struct parameters rigid_body_parameters(struct dag *d, const struct inertia *I);
/* p + s I */
void rigid_body_add(struct dag *d, struct parameters *p, struct ref s, const struct inertia *I);

/* V.f + W.n of the twist (V, W) and of the wrench that the motion takes with a unit of each of the ten parameters: m, h,
   xx xy xz yy yz zz. Of m it is V.a, of h U'V + a x W. */
void rigid_body_powers(struct dag *d, const struct motion *x, struct svec V, struct svec W, struct ref *power);

/* (m v.v + w.(I w)) / 2 + v.(w x h) */
struct ref rigid_body_kinetic(struct dag *d, const struct parameters *p, const struct motion *x);

#endif
