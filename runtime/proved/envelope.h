#ifndef RUNTIME_PROVED_ENVELOPE_H
#define RUNTIME_PROVED_ENVELOPE_H
/* What actuators must give: proved ranges of the joints' torques beside their limits of effort. */

#include "proved/rows_put.h"

/* KEPT: no state needs more than the limit. OPEN: what is proved is above the limit, and what was found is not. EXCEEDED: a state
   was found that needs more. */
enum envelope_verdict { ENVELOPE_NO_LIMIT, ENVELOPE_KEPT, ENVELOPE_OPEN, ENVELOPE_EXCEEDED };

struct envelope_row {
	const char *output, *joint, *unit; /* "tau"; "N m" or "N" */
	int argument, row;
	double low, high, found_low, found_high;
	double effort; /* 0: the URDF has no limit */
	double proved, found; /* the largest magnitudes, over the limit where there is one */
	enum envelope_verdict verdict;
};

struct envelope {
	const struct proved *of;
	struct envelope_row *rows; /* of outputs that are torques, by output and row */
	size_t count;
};

/* Is any output the torques of joints, all of them, those of gravity, or of gravity and velocity? */
int envelope_is_there(const struct dag *d);

/* Arrays live in `a`. Returns 0 when memory runs out. */
int envelope_list(struct envelope *x, const struct proved *of, struct arena *a);

/* As CSV; as sentences that say which joints need more than their limit. */
void envelope_put_csv(const struct envelope *x, struct text *out);
void envelope_put_limits(const struct envelope *x, struct text *out);

/* As SVG, by gnuplot, a frame for each joint. Errors: as gnuplot_draw. */
enum rneagen_code envelope_draw(const struct envelope *x, const char *path, struct rneagen_error *e);

#endif
