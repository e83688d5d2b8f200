#define _POSIX_C_SOURCE 200809L
#include "robots.h"
#include "support/rng.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A text in the making. */
struct urdf {
	FILE *file;
	char *text;
	size_t size;
};

/* One link after the root, and the joint that carries it. */
struct part {
	int parent; /* 0 is the root link */
	const char *type;
	double xyz[3], rpy[3], axis[3];
	double mass, com[3], tilt[3], inertia[3]; /* principal, about the centre of mass */
};

static void urdf_open(struct urdf *u, const char *name)
{
	*u = (struct urdf){0};
	u->file = open_memstream(&u->text, &u->size);
	if (!u->file)
		abort();
	fprintf(u->file, "<robot name=\"%s\">\n<link name=\"link_0\"/>\n", name);
}

static char *urdf_close(struct urdf *u)
{
	fputs("</robot>\n", u->file);
	if (fclose(u->file))
		abort();
	return u->text;
}

static void put_origin(struct urdf *u, const double xyz[3], const double rpy[3])
{
	fprintf(u->file, "<origin xyz=\"%.17g %.17g %.17g\" rpy=\"%.17g %.17g %.17g\"/>", xyz[0], xyz[1], xyz[2], rpy[0],
		rpy[1], rpy[2]);
}

static void put_part(struct urdf *u, int number, const struct part *p)
{
	fprintf(u->file, "<link name=\"link_%d\"><inertial>", number);
	put_origin(u, p->com, p->tilt);
	fprintf(u->file, "<mass value=\"%.17g\"/><inertia ixx=\"%.17g\" iyy=\"%.17g\" izz=\"%.17g\" ", p->mass, p->inertia[0],
		p->inertia[1], p->inertia[2]);
	fprintf(u->file, "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n<joint name=\"joint_%04d\" type=\"%s\">", number,
		p->type);
	put_origin(u, p->xyz, p->rpy);
	fprintf(u->file, "<parent link=\"link_%d\"/><child link=\"link_%d\"/><axis xyz=\"%.17g %.17g %.17g\"/>", p->parent,
		number, p->axis[0], p->axis[1], p->axis[2]);
	fputs("<limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/></joint>\n", u->file);
}

/* A slender link of a mass and a length along x, hinged about a coordinate axis, on the link before it. */
static struct part part_link(int number, int axis, double mass, double length)
{
	struct part p = {.parent = number - 1,
		.type = "revolute",
		.xyz = {number > 1 ? length : 0, 0, 0.1 * length},
		.mass = mass,
		.com = {0.45 * length, 0.03 * length, -0.02 * length},
		.inertia = {mass * length * length * 0.01, mass * length * length * 0.08, mass * length * length * 0.085}};

	p.axis[axis] = 1;
	return p;
}

char *robot_chain(int joints)
{
	struct urdf u;

	urdf_open(&u, "chain");
	for (int i = 1; i <= joints; i++) {
		struct part p = part_link(i, i % 2 ? 2 : 1, 1, 0.1);

		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_masses(double first, double last)
{
	struct urdf u;

	urdf_open(&u, "masses");
	for (int i = 1; i <= 8; i++) {
		struct part p = part_link(i, i % 3, first * pow(last / first, (i - 1) / 7.0), 0.2);

		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_rotors(void)
{
	struct urdf u;

	urdf_open(&u, "rotors");
	for (int i = 1; i <= 6; i++) {
		struct part p = part_link(i, (i - 1) / 2 % 3, 1, 0.3);

		if (i % 2 == 0)
			p.xyz[0] = p.xyz[2] = 0;
		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_balance(void)
{
	struct part beam = {.type = "revolute", .axis = {0, 1, 0}, .mass = 2, .inertia = {0.01, 0.2, 0.2}};
	struct urdf u;

	urdf_open(&u, "balance");
	put_part(&u, 1, &beam);
	for (int i = 2; i <= 3; i++) {
		struct part arm = {.parent = 1,
			.type = "revolute",
			.xyz = {i == 2 ? 0.7 : -0.7, 0, 0},
			.axis = {0, 1, 0},
			.mass = 3.1,
			.com = {0, 0, i == 2 ? -0.4 : 0.4},
			.inertia = {0.02, 0.02, 0.001}};

		put_part(&u, i, &arm);
	}
	return urdf_close(&u);
}

/* The six joints that several robots share. */
static struct part part_common(int number, double length, double mass)
{
	static const int axes[] = {2, 0, 1, 2, 0, 1};

	return part_link(number, axes[number - 1], mass * (7 - number), length);
}

/* The frame of joint k is slid by s_k along its axis: its origin moves by s_k, and what stands in it by -s_k. */
char *robot_slid(double slide)
{
	double before[3] = {0};
	struct urdf u;

	urdf_open(&u, "slid");
	for (int i = 1; i <= 6; i++) {
		struct part p = part_common(i, 0.3, 1);

		for (int k = 0; k < 3; k++) {
			double by = p.axis[k] > 0 ? (i % 2 ? slide : -slide) : 0;

			p.xyz[k] += by - before[k];
			p.com[k] -= by;
			before[k] = by;
		}
		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_right_angles(void)
{
	static const double angles[6][3] = {
		{1.57, 0, 0}, {-1.5708, 0, 0}, {0, 1.57, 3.1416}, {1.5708, 0, -1.57}, {0, -1.5708, 0}, {3.14, 0, 1.5708}};
	struct urdf u;

	urdf_open(&u, "right_angles");
	for (int i = 1; i <= 6; i++) {
		struct part p = part_common(i, 0.3, 1);

		for (int k = 0; k < 3; k++)
			p.rpy[k] = angles[i - 1][k];
		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_parallel(void)
{
	struct urdf u;

	urdf_open(&u, "parallel");
	for (int i = 1; i <= 6; i++) {
		struct part p = part_link(i, 2, 7 - i, 0.3);

		p.axis[0] = i % 2 ? 1e-7 : 0;
		p.rpy[1] = i % 3 ? 0 : 1e-7;
		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_scaled(double length, double mass)
{
	struct urdf u;

	urdf_open(&u, "scaled");
	for (int i = 1; i <= 6; i++) {
		struct part p = part_common(i, length, mass);

		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_skew(void)
{
	struct rng rng = rng_seed(11);
	struct urdf u;

	urdf_open(&u, "skew");
	for (int i = 1; i <= 7; i++) {
		struct part p = part_link(i, 0, 8 - i, 0.3);

		for (int k = 0; k < 3; k++) {
			p.axis[k] = rng_uniform(&rng, -1, 1);
			p.rpy[k] = rng_uniform(&rng, -3, 3);
			p.tilt[k] = rng_uniform(&rng, -3, 3);
		}
		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_star(int arms)
{
	struct part hub = {.type = "revolute", .axis = {0, 0, 1}, .mass = 1, .inertia = {0.1, 0.1, 0.2}};
	struct urdf u;

	urdf_open(&u, "star");
	put_part(&u, 1, &hub);
	for (int i = 0; i < arms; i++) {
		double angle = 2 * 3.141592653589793 * i / arms;
		struct part arm = part_link(2 + i, 1, 0.5, 0.4);

		arm.parent = 1;
		arm.xyz[0] = 0.5 * cos(angle);
		arm.xyz[1] = 0.5 * sin(angle);
		arm.rpy[2] = angle;
		put_part(&u, 2 + i, &arm);
	}
	return urdf_close(&u);
}

char *robot_finger(void)
{
	struct part finger = part_link(7, 1, 1e-3, 0.03);
	struct urdf u;

	urdf_open(&u, "finger");
	for (int i = 1; i <= 6; i++) {
		struct part p = part_link(i, i % 2 ? 2 : 1, 100 / 6.0, 0.4);

		put_part(&u, i, &p);
	}
	finger.xyz[0] = 0.4;
	put_part(&u, 7, &finger);
	return urdf_close(&u);
}

char *robot_needle(void)
{
	struct urdf u;

	urdf_open(&u, "needle");
	for (int i = 1; i <= 6; i++) {
		struct part p = part_link(i, i % 3, 1, 0.2);

		if (i == 6) {
			p = (struct part){.parent = 5, .type = "revolute", .xyz = {0.2, 0, 0}, .axis = {1, 0, 0}, .mass = 0.01,
				.com = {0.05, 0, 0}, .inertia = {1e-8, 1e-5, 1e-5}};
		}
		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}

char *robot_satellite(void)
{
	struct part base = {.type = "fixed", .axis = {1, 0, 0}, .mass = 1000, .com = {0.1, 0.2, -0.1},
		.inertia = {400, 500, 600}};
	struct urdf u;

	urdf_open(&u, "satellite");
	put_part(&u, 1, &base);
	for (int i = 2; i <= 4; i++) {
		struct part p = part_link(i, i % 3, 1e-3, 0.1);

		put_part(&u, i, &p);
	}
	return urdf_close(&u);
}
