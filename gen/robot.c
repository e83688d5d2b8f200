#define _POSIX_C_SOURCE 200809L
#include "robot.h"
#include "assemble.h"
#include "c_locale.h"
#include "robot_check.h"
#include "urdf.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *joint_type_name(enum joint_type type)
{
	static const char *const names[] = {"fixed", "revolute", "continuous", "prismatic", "planar", "floating"};

	return (unsigned)type <= JOINT_FLOATING ? names[type] : "unknown";
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
	const struct report p = {file, r, a, e};
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

static void dump_link(const struct robot *r, const struct link *l, struct text *t)
{
	const double *i = l->inertia;

	text_put(t, "link ");
	text_put_json(t, l->name);
	if (l->parent_joint >= 0) {
		text_put(t, ", parent joint ");
		text_put_json(t, r->joints[l->parent_joint].name);
	}
	text_put(t, l->has_inertial ? "\n" : ", no inertial\n");
	if (!l->has_inertial)
		return;
	text_printf(t, "\tmass %.17g\n", l->mass);
	text_printf(t, "\tcom %.17g %.17g %.17g, rpy %.17g %.17g %.17g\n", l->com[0], l->com[1], l->com[2],
		l->com_rpy[0], l->com_rpy[1], l->com_rpy[2]);
	text_printf(t, "\tinertia xx %.17g xy %.17g xz %.17g yy %.17g yz %.17g zz %.17g\n", i[0], i[1], i[2], i[3],
		i[4], i[5]);
}

static void dump_joint(const struct robot *r, const struct joint *j, struct text *t)
{
	text_put(t, "joint ");
	text_put_json(t, j->name);
	text_printf(t, ", %s, from ", joint_type_name(j->type));
	text_put_json(t, r->links[j->parent].name);
	text_put(t, " to ");
	text_put_json(t, r->links[j->child].name);
	text_printf(t, "\n\torigin %.17g %.17g %.17g, rpy %.17g %.17g %.17g\n", j->xyz[0], j->xyz[1], j->xyz[2],
		j->rpy[0], j->rpy[1], j->rpy[2]);
	if (j->type != JOINT_FIXED && j->type != JOINT_FLOATING)
		text_printf(t, "\taxis %.17g %.17g %.17g\n", j->axis[0], j->axis[1], j->axis[2]);
	if (j->has_limits)
		text_printf(t, "\tlimits: lower %.17g, upper %.17g, velocity %.17g, effort %.17g\n", j->lower, j->upper,
			j->velocity, j->effort);
	if (j->has_dynamics)
		text_printf(t, "\tdynamics: damping %.17g, friction %.17g\n", j->damping, j->friction);
	if (j->driver >= 0) {
		text_put(t, "\tmimics ");
		text_put_json(t, r->joints[j->driver].name);
		text_printf(t, ", multiplier %.17g, offset %.17g\n", j->multiplier, j->offset);
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
