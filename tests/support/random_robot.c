#define _POSIX_C_SOURCE 200809L
#include "support/random_robot.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/rng.h"

struct part {
	char *link, *joint;	// names
	const char *type;
	int parent, follows;	// indices of earlier parts; follows < 0: none
};

struct maker {
	struct rng rng;
	const struct random_robot_knobs *k;
	struct part *parts;
	FILE *out;
};

// Any double, or (as people write them) one of three decimals.
static double number(struct maker *m, double size)
{
	double x = rng_uniform(&m->rng, -size, size);

	return rng_chance(&m->rng, 0.5) ? x : rint(x * 1000) / 1000;
}

static void put_escaped(FILE *out, const char *s)
{
	static const char special[] = "<>&\"'";
	static const char *const entities[] = {"&lt;", "&gt;", "&amp;", "&quot;", "&apos;"};

	for (; *s; s++) {
		const char *at = strchr(special, *s);

		if (at)
			fputs(entities[at - special], out);
		else
			fputc(*s, out);
	}
}

static void put_attribute(FILE *out, const char *key, const char *value)
{
	fprintf(out, " %s=\"", key);
	put_escaped(out, value);
	fputc('"', out);
}

static void put_vector(FILE *out, const char *key, const double *x)
{
	fprintf(out, " %s=\"%.17g %.17g %.17g\"", key, x[0], x[1], x[2]);
}

static const char *odd_name(struct rng *rng)
{
	static const char *const names[] = {
		"int", "a.b", "a-b", "a_b", "A_B", "*/ evil(); /*", "// \\", "for", "__global__", "1st", "left knee",
		"gr\xc3\xb6\xc3\x9f" "e", "\xe9\x96\xa2\xe7\xaf\x80", "\"quoted\"", "<&>", "it's", "%d%s%n", "?" "?/",
		"q", "tau", "sin", "double", "joint\\", "#define x", "@NAME@", "main", "_", "-", ".", "\xf0\x9f\xa4\x96",
		"c0", "s0", "t1", "stride", "NULL", "@", "/*", "new",
	};

	return names[rng_below(rng, (int)(sizeof names / sizeof *names))];
}

static bool name_taken(const struct maker *m, int n, bool joint, const char *name)
{
	for (int i = 0; i < n; i++)
		if (!strcmp(joint ? m->parts[i].joint : m->parts[i].link, name))
			return true;
	return false;
}

// Names are unique among the joints and among the links, not across; their byte order is not the order of making.
static char *make_name(struct maker *m, int i, bool joint)
{
	char name[64];

	if (rng_chance(&m->rng, m->k->odd_names))
		snprintf(name, sizeof name, "%s", odd_name(&m->rng));
	else
		snprintf(name, sizeof name, "%s_%02d_%d", joint ? "joint" : "link", rng_below(&m->rng, 100), i);
	if (name_taken(m, i, joint, name))
		snprintf(name + strlen(name), sizeof name - strlen(name), "%d", i);
	return strdup(name);
}

static const char *make_type(struct maker *m)
{
	const struct random_robot_knobs *k = m->k;
	const double chance[] = {k->fixed, k->continuous, k->prismatic, k->floating, k->planar};
	static const char *const types[] = {"fixed", "continuous", "prismatic", "floating", "planar"};
	double x = rng_uniform(&m->rng, 0, 1);

	for (int i = 0; i < 5; i++) {
		if (x < chance[i])
			return types[i];
		x -= chance[i];
	}
	return "revolute";
}

static bool one_axis(const struct part *p)
{
	return !strcmp(p->type, "revolute") || !strcmp(p->type, "continuous") || !strcmp(p->type, "prismatic");
}

static void make_part(struct maker *m, int i)
{
	struct part *p = &m->parts[i];
	int other = i > 1 ? 1 + rng_below(&m->rng, i - 1) : 0;

	p->link = make_name(m, i, false);
	p->joint = make_name(m, i, true);
	p->type = make_type(m);
	p->parent = rng_chance(&m->rng, m->k->branching) ? rng_below(&m->rng, i) : i - 1;
	p->follows = -1;
	if (other && one_axis(p) && one_axis(&m->parts[other]) && rng_chance(&m->rng, m->k->mimic))
		p->follows = other;
}

static void make_parts(struct maker *m)
{
	char *root = make_name(m, 0, false);
	bool moves = false;

	m->parts[0] = (struct part){.link = root, .joint = strdup(""), .type = "fixed", .follows = -1};
	for (int i = 1; i < m->k->links; i++) {
		make_part(m, i);
		moves |= strcmp(m->parts[i].type, "fixed") != 0;
	}
	if (!moves && m->k->links > 1)
		m->parts[m->k->links - 1].type = "revolute";
}

static void put_origin(struct maker *m, double size, double right, double general)
{
	static const double right_angles[] = {0, 1.5707963267948966, -1.5707963267948966, 3.141592653589793,
	                                      1.570796326794897, -3.14159265358979};
	double xyz[3], rpy[3], x = rng_uniform(&m->rng, 0, 1);

	for (int i = 0; i < 3; i++) {
		xyz[i] = rng_chance(&m->rng, 0.3) ? 0 : number(m, size);
		rpy[i] = x < general ? number(m, 3.2) : right_angles[rng_below(&m->rng, 6)];
	}
	fputs("<origin", m->out);
	put_vector(m->out, "xyz", xyz);
	if (x < right + general)
		put_vector(m->out, "rpy", rpy);
	fputs("/>", m->out);
}

// Rotation from three turns about z, x, z.
static void random_rotation(struct rng *rng, double r[3][3])
{
	double a = rng_uniform(rng, -3, 3), b = rng_uniform(rng, -3, 3), c = rng_uniform(rng, -3, 3);
	double ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b), cc = cos(c), sc = sin(c);
	const double all[3][3] = {
		{ca * cc - sa * cb * sc, -ca * sc - sa * cb * cc, sa * sb},
		{sa * cc + ca * cb * sc, -sa * sc + ca * cb * cc, -ca * sb},
		{sb * sc, sb * cc, cb},
	};

	memcpy(r, all, sizeof all);
}

// With d the second moments of the mass along three directions, I = (tr d) 1 - R d R^T: physical for any d >= 0.
static void random_inertia(struct maker *m, double mass, double in[3][3])
{
	double r[3][3], d[3], trace = 0;
	bool turned = rng_chance(&m->rng, 0.6), point = rng_chance(&m->rng, m->k->points);

	random_rotation(&m->rng, r);
	for (int i = 0; i < 3; i++) {
		d[i] = point ? 0 : mass * rng_uniform(&m->rng, 0.001, 0.05);
		trace += d[i];
	}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			double sum = 0;

			for (int k = 0; k < 3; k++)
				sum += turned ? r[i][k] * d[k] * r[j][k] : i == k && j == k ? d[k] : 0;
			in[i][j] = (i == j ? trace : 0) - sum;
		}
}

static void put_inertial(struct maker *m)
{
	bool massless = rng_chance(&m->rng, m->k->massless);
	double mass = massless ? 0 : rng_uniform(&m->rng, 0.05, 5), in[3][3];

	random_inertia(m, mass, in);
	fputs("<inertial>", m->out);
	put_origin(m, 0.2, 0, rng_chance(&m->rng, m->k->rotated) ? 1 : 0);
	fprintf(m->out, "<mass value=\"%.17g\"/><inertia ixx=\"%.17g\" ixy=\"%.17g\" ixz=\"%.17g\"", mass, in[0][0],
	        in[0][1], in[0][2]);
	fprintf(m->out, " iyy=\"%.17g\" iyz=\"%.17g\" izz=\"%.17g\"/></inertial>", in[1][1], in[1][2], in[2][2]);
}

static void put_link(struct maker *m, int i)
{
	fputs("\t<link", m->out);
	put_attribute(m->out, "name", m->parts[i].link);
	fputs(">", m->out);
	if (i ? !rng_chance(&m->rng, m->k->bare) : m->k->root_mass)
		put_inertial(m);
	fputs("</link>\n", m->out);
}

static void put_axis(struct maker *m)
{
	double axis[3] = {0, 0, 0};
	int main_axis = rng_below(&m->rng, 3);

	if (rng_chance(&m->rng, m->k->odd_axis))
		for (int i = 0; i < 3; i++)
			axis[i] = number(m, 2);
	axis[main_axis] += axis[main_axis] < 0 || rng_chance(&m->rng, 0.3) ? -1 : 1;
	fputs("<axis", m->out);
	put_vector(m->out, "xyz", axis);
	fputs("/>", m->out);
}

static void put_limit(struct maker *m)
{
	double low = -rng_uniform(&m->rng, 0, 4), high = rng_uniform(&m->rng, 0, 4);

	fprintf(m->out, "<limit lower=\"%.3f\" upper=\"%.3f\" effort=\"10\" velocity=\"3\"/>", low, high);
}

static void put_mimic(struct maker *m, const struct part *p)
{
	fputs("<mimic", m->out);
	put_attribute(m->out, "joint", m->parts[p->follows].joint);
	if (rng_chance(&m->rng, 0.8))
		fprintf(m->out, " multiplier=\"%.17g\"", rng_chance(&m->rng, 0.3) ? -1 : number(m, 2));
	if (rng_chance(&m->rng, 0.6))
		fprintf(m->out, " offset=\"%.17g\"", number(m, 1));
	fputs("/>", m->out);
}

static void put_joint(struct maker *m, int i)
{
	const struct part *p = &m->parts[i];

	fputs("\t<joint", m->out);
	put_attribute(m->out, "name", p->joint);
	fprintf(m->out, " type=\"%s\">", p->type);
	put_origin(m, 0.5, m->k->right_rpy, m->k->general_rpy);
	fputs("<parent", m->out);
	put_attribute(m->out, "link", m->parts[p->parent].link);
	fputs("/><child", m->out);
	put_attribute(m->out, "link", p->link);
	fputs("/>", m->out);
	if (strcmp(p->type, "fixed") && strcmp(p->type, "floating") && !rng_chance(&m->rng, 0.1))
		put_axis(m);
	if (!strcmp(p->type, "revolute") || !strcmp(p->type, "prismatic"))
		put_limit(m);
	if (p->follows >= 0)
		put_mimic(m, p);
	fputs("</joint>\n", m->out);
}

// Links 0 .. n-1 and joints 1 .. n-1 as items 0 .. 2n-2, in order or by a Fisher-Yates shuffle.
static void put_robot(struct maker *m)
{
	int n = m->k->links, items = 2 * n - 1, *order = calloc((size_t)items, sizeof *order);

	for (int i = 0; i < items; i++)
		order[i] = i;
	for (int i = items - 1; i > 0 && m->k->shuffled; i--) {
		int j = rng_below(&m->rng, i + 1), item = order[i];

		order[i] = order[j];
		order[j] = item;
	}
	fputs("<?xml version=\"1.0\"?>\n<robot name=\"random\">\n", m->out);
	for (int i = 0; i < items; i++)
		order[i] < n ? put_link(m, order[i]) : put_joint(m, order[i] - n + 1);
	fputs("</robot>\n", m->out);
	free(order);
}

char *random_robot(uint64_t seed, const struct random_robot_knobs *knobs)
{
	locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0), old = uselocale(c);
	struct maker m = {.rng = rng_seed(seed), .k = knobs};
	char *text = NULL;
	size_t length;

	m.parts = calloc((size_t)knobs->links, sizeof *m.parts);
	m.out = open_memstream(&text, &length);
	make_parts(&m);
	put_robot(&m);
	fclose(m.out);
	for (int i = 0; i < knobs->links; i++) {
		free(m.parts[i].link);
		free(m.parts[i].joint);
	}
	free(m.parts);
	uselocale(old);
	freelocale(c);
	return text;
}

struct random_robot_knobs random_robot_knobs(uint64_t seed, int links)
{
	struct rng r = rng_seed(seed ^ 0x6b6e6f6273u);

	return (struct random_robot_knobs){
		.links = links > 1 ? 2 + rng_below(&r, links - 1) : 1,
		.branching = rng_uniform(&r, 0, 0.6),
		.fixed = rng_uniform(&r, 0, 0.4),
		.continuous = rng_uniform(&r, 0, 0.2),
		.prismatic = rng_uniform(&r, 0, 0.2),
		.floating = rng_chance(&r, 0.3) ? 0.08 : 0,
		.planar = rng_chance(&r, 0.3) ? 0.08 : 0,
		.mimic = rng_chance(&r, 0.5) ? 0.3 : 0,
		.odd_axis = rng_uniform(&r, 0, 1),
		.right_rpy = rng_uniform(&r, 0, 0.5),
		.general_rpy = rng_uniform(&r, 0, 0.5),
		.bare = rng_uniform(&r, 0, 0.2),
		.massless = rng_uniform(&r, 0, 0.1),
		.points = 0.05,
		.rotated = rng_uniform(&r, 0, 1),
		.odd_names = rng_chance(&r, 0.5) ? 0.5 : 0,
		.root_mass = rng_chance(&r, 0.7),
		.shuffled = rng_chance(&r, 0.5),
	};
}
