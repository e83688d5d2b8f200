#define _POSIX_C_SOURCE 200809L
#include "decimals.h"
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>

/* A text in the making. Links are called link_0, link_1, ...; each joint is called after its child. */
struct drawing {
	FILE *file;
	char *text;
	size_t size;
	struct rng rng;
	int links;
};

static void begin(struct drawing *d, const char *name, uint64_t seed)
{
	*d = (struct drawing){.rng = rng_seed(seed), .links = 1};
	d->file = open_memstream(&d->text, &d->size);
	if (!d->file)
		abort();
	fprintf(d->file, "<robot name=\"%s\">\n<link name=\"link_0\"/>\n", name);
}

static char *end(struct drawing *d)
{
	fputs("</robot>\n", d->file);
	if (fclose(d->file))
		abort();
	return d->text;
}

/* A decimal of one to four digits, as people write them. */
static __float128 draw(struct drawing *d, double low, double high)
{
	static const int scales[] = {10, 100, 1000, 10000};
	int scale = scales[rng_below(&d->rng, 4)];

	return (__float128)((int)(rng_uniform(&d->rng, low, high) * scale)) / scale;
}

/* x but for a part between 1e-5 and 1e-12 of it. */
static __float128 nearly(struct drawing *d, __float128 x)
{
	return x * (1 + (__float128)rng_uniform(&d->rng, 1, 9) * powq(10, -6 - rng_below(&d->rng, 7)));
}

/* So many digits that what is left of a difference has some. */
static void put(struct drawing *d, __float128 x)
{
	char text[64];

	quadmath_snprintf(text, sizeof text, "%.20Qg", x);
	fputs(text, d->file);
}

static void put3(struct drawing *d, const char *name, const __float128 x[3])
{
	fprintf(d->file, " %s=\"", name);
	for (int i = 0; i < 3; i++) {
		put(d, x[i]);
		fputs(i < 2 ? " " : "\"", d->file);
	}
}

static void draw3(struct drawing *d, double size, __float128 x[3])
{
	for (int i = 0; i < 3; i++)
		x[i] = draw(d, -size, size);
}

static void put_origin(struct drawing *d, const __float128 xyz[3], const __float128 rpy[3])
{
	fputs("<origin", d->file);
	put3(d, "xyz", xyz);
	put3(d, "rpy", rpy);
	fputs("/>", d->file);
}

static const __float128 NONE[3] = {0, 0, 0};

/* inertia: xx xy xz yy yz zz */
static void link(struct drawing *d, __float128 mass, const __float128 com[3], const __float128 rpy[3],
	const __float128 inertia[6])
{
	static const char *const names[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};

	fprintf(d->file, "<link name=\"link_%d\"><inertial>", d->links++);
	put_origin(d, com, rpy);
	fputs("<mass value=\"", d->file);
	put(d, mass);
	fputs("\"/><inertia", d->file);
	for (int i = 0; i < 6; i++) {
		fprintf(d->file, " %s=\"", names[i]);
		put(d, inertia[i]);
		fputs("\"", d->file);
	}
	fputs("/></inertial></link>\n", d->file);
}

/* A link that weighs nothing. */
static void bare(struct drawing *d)
{
	fprintf(d->file, "<link name=\"link_%d\"/>\n", d->links++);
}

/* The joint that carries the last link, which another hangs on; `rest` stands inside it. */
static void joint(struct drawing *d, const char *type, int parent, const __float128 xyz[3], const __float128 rpy[3],
	const char *rest)
{
	fprintf(d->file, "<joint name=\"joint_%02d\" type=\"%s\"><parent link=\"link_%d\"/><child link=\"link_%d\"/>",
		d->links - 1, type, parent, d->links - 1);
	put_origin(d, xyz, rpy);
	fprintf(d->file, "%s<limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/></joint>\n", rest);
}

static void fix(struct drawing *d, const __float128 xyz[3], const __float128 rpy[3])
{
	joint(d, "fixed", d->links - 2, xyz, rpy, "");
}

static const char *draw_axis(struct drawing *d)
{
	static const char *const axes[] = {"<axis xyz=\"1 0 0\"/>", "<axis xyz=\"0 -1 0\"/>", "<axis xyz=\"0 0 1\"/>",
		"<axis xyz=\"0.1 0.2 -0.3\"/>", "<axis xyz=\"0 0.6 0.8\"/>"};

	return axes[rng_below(&d->rng, sizeof axes / sizeof *axes)];
}

static void draw_inertia(struct drawing *d, __float128 inertia[6])
{
	for (int i = 0; i < 6; i++)
		inertia[i] = draw(d, -0.1, 0.1);
	for (int i = 0; i < 6; i += i ? 2 : 3)
		inertia[i] += 1;
}

/* A moving link with mass, with ordinary numbers. */
static void draw_link(struct drawing *d, const char *type)
{
	__float128 com[3], tilt[3], inertia[6], xyz[3], rpy[3];

	draw3(d, 0.3, com);
	draw3(d, 3, tilt);
	draw_inertia(d, inertia);
	draw3(d, 0.5, xyz);
	draw3(d, 3, rpy);
	link(d, draw(d, 0.1, 3), com, tilt, inertia);
	joint(d, type, d->links - 2, xyz, rng_chance(&d->rng, 0.5) ? NONE : rpy, draw_axis(d));
}

/* m1 c1 + m2 (p + c2) is next to nothing. */
static char *draw_moments(uint64_t seed)
{
	static const __float128 points[6] = {0};
	__float128 m1, m2, c1[3], c2[3], p[3];
	struct drawing d;

	begin(&d, "moments", seed);
	m1 = draw(&d, 0.1, 2);
	m2 = draw(&d, 0.1, 2);
	draw3(&d, 0.3, c1);
	draw3(&d, 0.2, p);
	for (int i = 0; i < 3; i++)
		c2[i] = nearly(&d, -m1 * c1[i] / m2 - p[i]);
	link(&d, m1, c1, NONE, points);
	joint(&d, "revolute", 0, NONE, NONE, draw_axis(&d));
	link(&d, m2, c2, NONE, points);
	fix(&d, p, NONE);
	return end(&d);
}

/* 0.1 + 0.2 - 0.3 and a little, as lever arm of what hangs there. */
static char *draw_origins(uint64_t seed)
{
	__float128 a[3], b[3], c[3], e[3], inertia[6] = {0};
	struct drawing d;

	begin(&d, "origins", seed);
	draw3(&d, 0.5, a);
	draw3(&d, 0.5, b);
	for (int i = 0; i < 3; i++)
		c[i] = i == 1 ? -a[i] - b[i] : nearly(&d, -a[i] - b[i]);
	draw3(&d, 0.1, e);
	bare(&d);
	joint(&d, "revolute", 0, NONE, NONE, draw_axis(&d));
	bare(&d);
	fix(&d, a, NONE);
	bare(&d);
	fix(&d, b, NONE);
	link(&d, draw(&d, 0.1, 2), NONE, NONE, inertia);
	fix(&d, c, NONE);
	link(&d, draw(&d, 0.1, 2), e, NONE, inertia);
	joint(&d, "revolute", d.links - 2, NONE, NONE, draw_axis(&d));
	return end(&d);
}

/* Turns that nearly undo one another. */
static char *draw_angles(uint64_t seed)
{
	__float128 a[3] = {0}, b[3] = {0}, c[3] = {0}, inertia[6] = {0};
	struct drawing d;
	int axis;

	begin(&d, "angles", seed);
	axis = rng_below(&d.rng, 3);
	a[axis] = draw(&d, 0.1, 1);
	b[axis] = draw(&d, 0.1, 1);
	c[axis] = nearly(&d, -a[axis] - b[axis]);
	bare(&d);
	joint(&d, "revolute", 0, NONE, NONE, "<axis xyz=\"0 0 1\"/>");
	bare(&d);
	fix(&d, NONE, a);
	bare(&d);
	fix(&d, NONE, b);
	link(&d, draw(&d, 0.1, 2), NONE, NONE, inertia);
	joint(&d, "prismatic", d.links - 2, NONE, c, draw_axis(&d));
	link(&d, draw(&d, 0.1, 2), NONE, NONE, inertia);
	joint(&d, "prismatic", d.links - 2, NONE, NONE, draw_axis(&d));
	return end(&d);
}

/* Moments of inertia that are nearly equal: of their products with rates the difference alone is left. */
static char *draw_spread(uint64_t seed)
{
	__float128 inertia[6] = {0}, more[6] = {0}, tilt[3];
	struct drawing d;

	begin(&d, "spread", seed);
	inertia[0] = draw(&d, 0.1, 2);
	inertia[3] = nearly(&d, inertia[0]);
	inertia[5] = nearly(&d, inertia[0]);
	for (int i = 0; i < 6; i++)
		more[i] = inertia[i];
	draw3(&d, 1, tilt);
	bare(&d);
	joint(&d, "revolute", 0, NONE, NONE, "<axis xyz=\"1 0 0\"/>");
	bare(&d);
	joint(&d, "revolute", 1, NONE, NONE, "<axis xyz=\"0 1 0\"/>");
	link(&d, 1, NONE, NONE, inertia);
	joint(&d, "revolute", 2, NONE, NONE, "<axis xyz=\"0 0 1\"/>");
	link(&d, draw(&d, 0.1, 1), NONE, tilt, more);
	fix(&d, NONE, NONE);
	return end(&d);
}

/* A follower whose weight nearly holds its driver's. */
static char *draw_followers(uint64_t seed)
{
	__float128 inertia[6] = {0}, m1, m2, rpy[3] = {0};
	char rest[256], multiplier[64];
	struct drawing d;

	begin(&d, "followers", seed);
	m1 = draw(&d, 0.1, 2);
	m2 = draw(&d, 0.1, 2);
	rpy[0] = draw(&d, -1, 1);
	link(&d, m1, NONE, NONE, inertia);
	joint(&d, "prismatic", 0, NONE, rpy, "<axis xyz=\"0 0 1\"/>");
	quadmath_snprintf(multiplier, sizeof multiplier, "%.20Qg", nearly(&d, -m1 / m2));
	snprintf(rest, sizeof rest, "<axis xyz=\"0 0 1\"/><mimic joint=\"joint_01\" multiplier=\"%s\" offset=\"0.1\"/>",
		multiplier);
	link(&d, m2, NONE, NONE, inertia);
	joint(&d, "prismatic", 0, NONE, rpy, rest);
	return end(&d);
}

/* Frames metres away from what stands in them. */
static char *draw_frames(uint64_t seed)
{
	__float128 inertia[6] = {0}, com[3] = {0}, xyz[3] = {0}, tilt[3] = {0};
	struct drawing d;

	begin(&d, "frames", seed);
	for (int i = 0; i < 2; i++) {
		for (int k = 0; k < 6; k += k ? 2 : 3)
			inertia[k] = draw(&d, 0.001, 0.002) + 0.0001Q;
		draw3(&d, 30, com);
		for (int k = 0; k < 3; k++)
			xyz[k] = -nearly(&d, com[k]);
		tilt[2] = i ? draw(&d, -1, 1) : 0;
		link(&d, draw(&d, 0.1, 2), com, tilt, inertia);
		joint(&d, "revolute", i, xyz, NONE, draw_axis(&d));
	}
	return end(&d);
}

/* Ordinary numbers, joints of each type. */
static char *draw_ordinary(uint64_t seed)
{
	static const char *const types[] = {"revolute", "prismatic", "continuous", "planar"};
	struct drawing d;

	begin(&d, "ordinary", seed);
	for (int i = 1 + rng_below(&d.rng, 4); i > 0; i--)
		draw_link(&d, types[rng_below(&d.rng, 4)]);
	draw_link(&d, "fixed");
	return end(&d);
}

const struct decimal_case DECIMAL_CASES[] = {
	{"moments", "first moments cancel", draw_moments},
	{"origins", "0.1 + 0.2 - 0.3", draw_origins},
	{"angles", "turns undo one another", draw_angles},
	{"spread", "inertias that are nearly equal", draw_spread},
	{"followers", "a follower holds its driver's weight", draw_followers},
	{"frames", "frames metres away", draw_frames},
	{"ordinary", "numbers as people write them", draw_ordinary},
};
const int DECIMAL_CASE_COUNT = (int)(sizeof DECIMAL_CASES / sizeof *DECIMAL_CASES);

void decimal_state(const struct reference *r, struct rng *rng, int kind, double *const state[3])
{
	reference_sample(r, rng, true, state[0], state[1], state[2]);
	for (int i = 0; i < r->nq; i++)
		state[0][i] *= kind != 4;
	for (int i = 0; i < r->nv; i++) {
		state[1][i] *= kind == 0 || kind == 2 || kind == 4;
		state[2][i] *= kind == 0 || (kind == 3 && i == 0);
	}
}
