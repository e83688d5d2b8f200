#define _POSIX_C_SOURCE 200809L
#include "urdf/robot.h"
#include "urdf/assemble.h"
#include "base/c_locale.h"
#include "base/number.h"
#include "urdf/robot_check.h"
#include "urdf/urdf_shim.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *joint_type_name(enum joint_type type)
{
	static const char *const names[] = {"fixed", "revolute", "continuous", "prismatic", "planar", "floating"};

	return (unsigned)type <= JOINT_FLOATING ? names[type] : "unknown";
}

int joint_nq(enum joint_type type)
{
	static const int rows[] = {
		[JOINT_REVOLUTE] = 1, [JOINT_CONTINUOUS] = 1, [JOINT_PRISMATIC] = 1, [JOINT_PLANAR] = 3, [JOINT_FLOATING] = 7};

	return rows[type];
}

int joint_nv(enum joint_type type)
{
	return type == JOINT_FLOATING ? 6 : joint_nq(type);
}

int robot_link(const struct robot *r, const char *name)
{
	for (int i = 0; i < r->link_count; i++)
		if (!strcmp(r->links[i].name, name))
			return i;
	return -1;
}

int robot_joint(const struct robot *r, const char *name)
{
	for (int i = 0; i < r->joint_count; i++)
		if (!strcmp(r->joints[i].name, name))
			return i;
	return -1;
}

void robot_warn(struct robot *r, struct arena *a, const char *fmt, ...)
{
	const char **warnings =
		arena_grow(a, (void *)r->warnings, r->warning_count, &r->warning_capacity, sizeof *warnings);
	char *s;
	va_list ap;
	int n;

	va_start(ap, fmt);
	n = vsnprintf(NULL, 0, fmt, ap);
	va_end(ap);
	if (warnings)
		r->warnings = warnings;
	s = n < 0 ? NULL : arena_alloc(a, (size_t)n + 1, 1);
	if (!warnings || !s) {
		a->failed = 1;
		return;
	}
	va_start(ap, fmt);
	vsnprintf(s, (size_t)n + 1, fmt, ap);
	va_end(ap);
	r->warnings[r->warning_count++] = s;
	for (; *s; s++)
		if ((unsigned char)*s < 0x20 || *s == 0x7f)
			*s = '?';
}

enum rneagen_code robot_read(
	struct robot *r, const char *xml, size_t length, const char *file, struct arena *a, struct rneagen_error *e)
{
	const struct diagnostic p = {file, r, a, e};
	struct outline o;
	struct c_locale l;

	*r = (struct robot){.name = ""};
	if (!c_locale_enter(&l))
		return error_memory(e);
	if (!precheck(&o, xml, length, &p) && !assemble_robot(&o, &p) && !urdf_read(&o, &p))
		robot_check(&o, &p);
	c_locale_leave(&l);
	return e->code;
}

/* A name and numbers, each as short as it reads back. */
static void put_numbers(struct text *t, const char *name, const struct within *x, int count)
{
	text_put(t, name);
	for (int i = 0; i < count; i++)
		text_printf(t, " %s", number_plain((double)x[i].x).s);
}

static void dump_link(const struct robot *r, const struct link *l, struct text *t)
{
	static const char *const elements[] = {" xx", " xy", " xz", " yy", " yz", " zz"};

	text_put(t, "link ");
	text_put_json(t, l->name);
	if (l->parent_joint >= 0) {
		text_put(t, ", parent joint ");
		text_put_json(t, r->joints[l->parent_joint].name);
	}
	text_put(t, l->has_inertial ? "\n" : ", no inertial\n");
	if (!l->has_inertial)
		return;
	put_numbers(t, "\tmass", &l->mass, 1);
	put_numbers(t, "\n\tcom", l->com, 3);
	put_numbers(t, ", rpy", l->com_rpy, 3);
	text_put(t, "\n\tinertia");
	for (int i = 0; i < 6; i++)
		put_numbers(t, elements[i], &l->inertia[i], 1);
	text_putc(t, '\n');
}

static void dump_limits(const struct joint *j, struct text *t)
{
	text_printf(t, "\tlimits: lower %s, upper %s, velocity %s, effort %s\n", number_plain(j->lower).s,
		number_plain(j->upper).s, number_plain(j->velocity).s, number_plain(j->effort).s);
}

static void dump_joint(const struct robot *r, const struct joint *j, struct text *t)
{
	text_put(t, "joint ");
	text_put_json(t, j->name);
	text_printf(t, ", %s, from ", joint_type_name(j->type));
	text_put_json(t, r->links[j->parent].name);
	text_put(t, " to ");
	text_put_json(t, r->links[j->child].name);
	put_numbers(t, "\n\torigin", j->xyz, 3);
	put_numbers(t, ", rpy", j->rpy, 3);
	text_putc(t, '\n');
	if (j->type != JOINT_FIXED && j->type != JOINT_FLOATING) {
		put_numbers(t, "\taxis", j->axis, 3);
		text_putc(t, '\n');
	}
	if (j->has_limits)
		dump_limits(j, t);
	if (j->has_dynamics) {
		put_numbers(t, "\tdynamics: damping", &j->damping, 1);
		put_numbers(t, ", friction", &j->friction, 1);
		text_putc(t, '\n');
	}
	if (j->driver >= 0) {
		text_put(t, "\tmimics ");
		text_put_json(t, r->joints[j->driver].name);
		put_numbers(t, ", multiplier", &j->multiplier, 1);
		put_numbers(t, ", offset", &j->offset, 1);
		text_putc(t, '\n');
	}
}

void robot_dump(const struct robot *r, struct text *t)
{
	struct c_locale l;

	if (!c_locale_enter(&l)) {
		t->failed = 1;
		return;
	}
	text_put(t, "robot ");
	text_put_json(t, r->name);
	text_printf(t, ", %d links, %d joints, root link ", r->link_count, r->joint_count);
	text_put_json(t, r->links[r->root].name);
	text_put(t, "\n");
	for (int i = 0; i < r->link_count; i++)
		dump_link(r, &r->links[i], t);
	for (int i = 0; i < r->joint_count; i++)
		dump_joint(r, &r->joints[i], t);
	c_locale_leave(&l);
}
