/* The picture of an envelope: for each joint a frame with what is proved, what a search found, and the limits of effort. */
#include "proved/envelope.h"
#include "rnearun/gnuplot.h"
#include <math.h>

/* Pixels: of a joint's frame with what is around it, of the whole picture's edges. */
enum { CELL_WIDTH = 135, CELL_HEIGHT = 235, MOST_COLUMNS = 7, LEAST_COLUMNS = 4, LEFT = 58, RIGHT = 14, HEAD = 62, FOOT = 42,
	ABOVE = 24, BELOW = 44 };

#define PROVED "#b9d0ee"
#define FOUND "#1f5fbf"
#define LIMIT "#c0392b"

/* A limit that is so many times what is proved stands in words alone, so that the rest can be seen. */
#define FAR_LIMIT 4

struct sheet {
	const struct envelope *x;
	int columns, lines, width, height;
};

static struct sheet sheet_of(const struct envelope *x)
{
	struct sheet s = {.x = x};
	int count = (int)x->count;

	s.lines = (count + MOST_COLUMNS - 1) / MOST_COLUMNS;
	s.columns = (count + s.lines - 1) / s.lines;
	s.width = LEFT + CELL_WIDTH * (s.columns < LEAST_COLUMNS ? LEAST_COLUMNS : s.columns) + RIGHT;
	s.height = HEAD + CELL_HEIGHT * s.lines + FOOT;
	return s;
}

/* Left to right, then down; from the left and from the bottom, in parts of the picture. */
static void put_place(const struct sheet *s, int i, FILE *f)
{
	double left = LEFT + CELL_WIDTH * (i % s->columns), top = s->height - HEAD - CELL_HEIGHT * (i / s->columns);

	fprintf(f, "set lmargin at screen %.6f\nset rmargin at screen %.6f\n", left / s->width,
		(left + CELL_WIDTH - LEFT) / s->width);
	fprintf(f, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n", (top - ABOVE) / s->height,
		(top - CELL_HEIGHT + BELOW) / s->height);
}

static int shows_limit(const struct envelope_row *r)
{
	return r->effort > 0 && r->proved * FAR_LIMIT >= 1;
}

static void put_bar(FILE *f, double from, double to, double low, double high, const char *colour)
{
	fprintf(f, "set object rectangle from %g,%.9g to %g,%.9g front fillstyle solid noborder fillcolor rgb '%s'\n", from, low,
		to, high, colour);
}

static void put_limit(FILE *f, double at)
{
	fprintf(f, "set arrow from 0,%.9g to 1,%.9g nohead front lw 2 dashtype 2 lc rgb '" LIMIT "'\n", at, at);
}

static void put_words(const struct envelope_row *r, FILE *f)
{
	const char *colour = r->verdict == ENVELOPE_EXCEEDED ? LIMIT : "#303030";

	if (r->effort > 0)
		fprintf(f, "set label 'at most %.0f %% of' at graph 0.5,-0.075 center font ',10' textcolor rgb '%s'\n"
			   "set label 'the limit, %g %s' at graph 0.5,-0.155 center font ',10' textcolor rgb '%s'\n",
			ceil(100 * r->proved), colour, r->effort, r->unit, colour);
	else
		fprintf(f, "set label 'no limit in the' at graph 0.5,-0.075 center font ',10' textcolor rgb '%s'\n"
			   "set label 'URDF; %s' at graph 0.5,-0.155 center font ',10' textcolor rgb '%s'\n", colour,
			r->unit, colour);
}

static int is_finite(const struct envelope_row *r)
{
	return isfinite(r->low) && isfinite(r->high) && isfinite(r->found_low) && isfinite(r->found_high);
}

static void put_joint(const struct sheet *s, int i, FILE *f)
{
	const struct envelope_row *r = &s->x->rows[i];
	double most = fmax(fmax(fabs(r->low), fabs(r->high)), shows_limit(r) ? r->effort : 0);

	put_place(s, i, f);
	most = is_finite(r) && most > 0 ? 1.12 * most : 1;
	fprintf(f, "set title '");
	gnuplot_put_name(f, r->joint);
	fprintf(f, "' noenhanced font ',11' offset 0,-0.6\nset yrange [%.9g:%.9g]\n", -most, most);
	if (is_finite(r)) {
		put_bar(f, 0.14, 0.86, r->low, r->high, PROVED);
		put_bar(f, 0.3, 0.7, r->found_low, r->found_high, FOUND);
		for (int side = -1; side <= 1 && shows_limit(r); side += 2)
			put_limit(f, side * r->effort);
		put_words(r, f);
	} else {
		fprintf(f, "set label 'no range' at graph 0.5,-0.075 center font ',10' textcolor rgb '#303030'\n");
	}
	fprintf(f, "plot 0 notitle lc rgb '#909090'\nunset object\nunset arrow\nunset label\n");
}

/* In parts of the picture, so it is set with the first joint alone. */
static void put_key(const struct sheet *s, FILE *f)
{
	static const struct {
		const char *colour, *word;
	} keys[] = {{PROVED, "proved: no state needs more"}, {FOUND, "found by a search"}, {LIMIT, "limit of effort"}};
	double y = 18.0 / s->height, at = 30;

	for (int i = 0; i < 3; i++, at += 200) {
		fprintf(f, "set object rectangle from screen %.6f,%.6f to screen %.6f,%.6f front fillstyle solid noborder fillcolor rgb '%s'\n",
			at / s->width, y - (i < 2 ? 5.0 : 1.0) / s->height, (at + 18) / s->width,
			y + (i < 2 ? 5.0 : 1.0) / s->height, keys[i].colour);
		fprintf(f, "set label '%s' at screen %.6f,%.6f left font ',11'\n", keys[i].word, (at + 24) / s->width, y);
	}
	fprintf(f, "set label '");
	gnuplot_put_name(f, s->x->of->a->robot.name);
	fprintf(f, ": torques for all states within the limits and ranges' at screen %.6f,%.6f left noenhanced font ',16'\n",
		30.0 / s->width, 1 - 24.0 / s->height);
}

static void put_script(const void *sheet, FILE *f)
{
	const struct sheet *s = sheet;

	fprintf(f, "set terminal svg size %d,%d font 'sans-serif,12' background rgb 'white'\nset multiplot\n",
		s->width, s->height);
	fprintf(f, "set xrange [0:1]\nunset xtics\nunset key\nset ytics font ',10'\nset grid ytics lc rgb '#e0e0e0'\n");
	put_key(s, f);
	for (int i = 0; i < (int)s->x->count; i++)
		put_joint(s, i, f);
	fprintf(f, "unset multiplot\n");
}

enum rneagen_code envelope_draw(const struct envelope *x, const char *path, struct rneagen_error *e)
{
	struct sheet s = sheet_of(x);

	return gnuplot_draw("--picture", path, put_script, &s, e);
}
