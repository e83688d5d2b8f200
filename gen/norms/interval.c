#include "norms/interval.h"
#include <math.h>

struct interval interval_around(real x, double error)
{
	double near = (double)x, off = fabs((double)(x - (real)near)) + error;

	if (off == 0)
		return (struct interval){near, near};
	off = round_up(round_up(off));
	return (struct interval){round_down(near - off), round_up(near + off)};
}

/* Does an angle of sine 1, pi/2 + 2 k pi, lie in it, or may it? */
static int has_top(struct interval a, real top)
{
	static const real TURN = 6.283185307179586476925286766559L;
	real turns = ceill(((real)a.lower - 1e-6L - top) / TURN);

	return top + turns * TURN <= (real)a.upper + 1e-6L;
}

/* The C library's sine in extended precision is within some units of its last place; 1e-15 is far more. Beyond 1e6 rad, and where
   the interval is longer than a turn, nothing is known but -1 to 1. */
static struct interval of_wave(struct interval a, real (*wave)(real), real top, real bottom)
{
	real x = wave((real)a.lower), y = wave((real)a.upper);
	struct interval r = {(double)fminl(x, y) - 1e-15, (double)fmaxl(x, y) + 1e-15};

	if (!(interval_size(a) <= 1e6) || a.upper - a.lower >= 6.28)
		return (struct interval){-1, 1};
	if (has_top(a, top))
		r.upper = 1;
	if (has_top(a, bottom))
		r.lower = -1;
	return (struct interval){fmax(-1, r.lower), fmin(1, r.upper)};
}

struct interval interval_sin(struct interval a)
{
	return of_wave(a, sinl, 1.570796326794896619231321691640L, -1.570796326794896619231321691640L);
}

struct interval interval_cos(struct interval a)
{
	return of_wave(a, cosl, 0, 3.141592653589793238462643383280L);
}
