#define _POSIX_C_SOURCE 200809L
#include "reference/tree.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "reference/read.h"

struct builder {
	const struct raw_robot *raw;
	struct reference *r;
	int *source;		// entry -> raw joint, -1 for entry 0
	char *message;
	size_t size;
};

static bool refuse(struct builder *b, const char *fmt, ...)
{
	va_list ap;

	va_start(ap, fmt);
	vsnprintf(b->message, b->size, fmt, ap);
	va_end(ap);
	return false;
}

static int find_link(const struct raw_robot *raw, const char *name)
{
	for (int i = 0; i < raw->nlinks; i++)
		if (!strcmp(raw->links[i].name, name))
			return i;
	return -1;
}

static int find_joint(const struct reference *r, const char *name)
{
	for (int i = 1; i < r->nj; i++)
		if (!strcmp(r->joints[i].name, name))
			return i;
	return -1;
}

static int find_type(const char *name)
{
	static const char *const names[] = {"fixed", "revolute", "continuous", "prismatic", "floating", "planar"};

	for (int i = 0; i < (int)(sizeof names / sizeof *names); i++)
		if (!strcmp(names[i], name))
			return i;
	return -1;
}

// The only link that is nobody's child.
static int find_root(struct builder *b)
{
	const struct raw_robot *raw = b->raw;
	int *parents = raw_memory(NULL, (size_t)raw->nlinks, sizeof *parents), root = -1, roots = 0;
	bool good = true;

	memset(parents, 0, (size_t)raw->nlinks * sizeof *parents);
	for (int i = 0; i < raw->njoints && good; i++) {
		int child = find_link(raw, raw->joints[i].child);

		if (child < 0 || find_link(raw, raw->joints[i].parent) < 0 || parents[child]++)
			good = refuse(b, "joint %s: a link is missing or has two parents", raw->joints[i].name);
	}
	for (int i = 0; i < raw->nlinks && good; i++)
		if (!parents[i]) {
			root = i;
			roots++;
		}
	free(parents);
	if (good && roots != 1)
		refuse(b, "%d root links", roots);
	return good && roots == 1 ? root : -1;
}

static int by_name_last_first(const void *a, const void *b)
{
	const struct raw_joint *const *x = a, *const *y = b;

	return strcmp((*y)->name, (*x)->name);
}

// Pushes the raw joints below a link, the first name on top.
static int push_children(const struct raw_robot *raw, const char *link, const struct raw_joint **stack, int top)
{
	int n = 0;

	for (int i = 0; i < raw->njoints; i++)
		if (!strcmp(raw->joints[i].parent, link))
			stack[top + n++] = &raw->joints[i];
	qsort(stack + top, (size_t)n, sizeof *stack, by_name_last_first);
	return top + n;
}

static int entry_of_link(const struct reference *r, const char *link)
{
	for (int i = r->nj - 1; i >= 0; i--)
		if (!strcmp(r->joints[i].link, link))
			return i;
	return -1;
}

static void add_entry(struct builder *b, int source, const char *name, const char *link, int parent)
{
	struct reference *r = b->r;

	b->source[r->nj] = source;
	r->joints[r->nj] = (struct reference_joint){
		.name = raw_copy(name),
		.link = raw_copy(link),
		.parent = parent,
		.driver = r->nj,
		.multiplier = 1,
	};
	r->nj++;
}

static bool walk(struct builder *b, int root)
{
	const struct raw_robot *raw = b->raw;
	const struct raw_joint **stack = raw_memory(NULL, (size_t)raw->njoints, sizeof *stack);
	int top;

	add_entry(b, -1, "", raw->links[root].name, -1);
	top = push_children(raw, raw->links[root].name, stack, 0);
	while (top) {
		const struct raw_joint *j = stack[--top];

		add_entry(b, (int)(j - raw->joints), j->name, j->child, entry_of_link(b->r, j->parent));
		top = push_children(raw, j->child, stack, top);
	}
	free(stack);
	return b->r->nj == raw->nlinks || refuse(b, "%d links hang on no root", raw->nlinks - b->r->nj);
}

// 1 / (1 + z) is written without cancellation for z near -1.
static void plane_axes(struct reference_link *l)
{
	wide x = l->axis.x[0], y = l->axis.x[1], z = l->axis.x[2], d = x * x + y * y;
	wide g = z >= 0 ? 1 / (1 + z) : d > 0 ? (1 - z) / d : 0;

	l->plane[0] = (struct d3_vec){{1 - x * x * g, -x * y * g, -x}};
	l->plane[1] = (struct d3_vec){{-x * y * g, 1 - y * y * g, -y}};
	if (d <= 0 && z < 0)
		l->plane[1].x[1] = -1;
}

static bool set_axis(struct builder *b, const struct raw_joint *raw, struct reference_link *l)
{
	wide largest = 0, sum = 0;

	for (int i = 0; i < 3; i++)
		if (wide_abs(raw->axis[i]) > largest)
			largest = wide_abs(raw->axis[i]);
	if (!(largest > 0))
		return refuse(b, "joint %s: no axis", raw->name);
	for (int i = 0; i < 3; i++) {
		l->axis.x[i] = raw->axis[i] / largest;
		sum += l->axis.x[i] * l->axis.x[i];
	}
	for (int i = 0; i < 3; i++)
		l->axis.x[i] /= wide_sqrt(sum);
	plane_axes(l);
	return true;
}

static struct d3_vec point(const wide x[3])
{
	return (struct d3_vec){{x[0], x[1], x[2]}};
}

static void set_inertia(const struct raw_link *raw, struct reference_link *l)
{
	const wide *i = raw->inertia;
	struct d3_mat r = d3_rpy(raw->rpy);
	struct d3_mat ic = {{{i[0], i[1], i[2]}, {i[1], i[3], i[4]}, {i[2], i[4], i[5]}}};

	ic = d3_mul(r, d3_mul(ic, d3_transpose(r)));
	l->inertia = d6_inertia(raw->mass, point(raw->xyz), ic);
}

static bool set_entry(struct builder *b, int i, bool floating)
{
	struct reference_joint *j = &b->r->joints[i];
	struct reference_link *l = &b->r->links[i];

	*l = (struct reference_link){.tree = d6_identity()};
	set_inertia(&b->raw->links[find_link(b->raw, j->link)], l);
	if (i == 0) {
		j->type = floating ? REFERENCE_FLOATING : REFERENCE_FIXED;
		return true;
	}
	const struct raw_joint *raw = &b->raw->joints[b->source[i]];
	int type = find_type(raw->type);

	if (type < 0)
		return refuse(b, "joint %s: unknown type %s", raw->name, raw->type);
	j->type = (enum reference_type)type;
	j->lower = (double)raw->lower;
	j->upper = (double)raw->upper;
	l->tree = d6_transform(d3_rpy(raw->rpy), point(raw->xyz));
	return type == REFERENCE_FIXED || type == REFERENCE_FLOATING || set_axis(b, raw, l);
}

static bool one_axis(const struct reference_joint *j)
{
	return j->type == REFERENCE_REVOLUTE || j->type == REFERENCE_CONTINUOUS || j->type == REFERENCE_PRISMATIC;
}

// Follows <mimic> to its end: q_i = m1 (m2 (... q + o) + o2) + o1.
static bool set_mimic(struct builder *b, int i)
{
	struct reference_joint *j = &b->r->joints[i];
	int steps = 0;

	while (j->driver > 0 && one_axis(j)) {
		const struct raw_joint *raw = &b->raw->joints[b->source[j->driver]];

		if (!raw->mimic)
			break;
		j->driver = find_joint(b->r, raw->mimic);
		j->offset += j->multiplier * raw->offset;
		j->multiplier *= raw->multiplier;
		if (j->driver < 0 || !one_axis(&b->r->joints[j->driver]) || ++steps > b->r->nj)
			return refuse(b, "joint %s: mimic leads to no movable joint", j->name);
	}
	return true;
}

static void number(struct reference *r, int i)
{
	static const int nq[] = {0, 1, 1, 1, 7, 3}, nv[] = {0, 1, 1, 1, 6, 3};
	struct reference_joint *j = &r->joints[i];

	if (j->driver != i)
		return;
	j->iq = r->nq;
	j->iv = r->nv;
	j->nq = nq[j->type];
	j->nv = nv[j->type];
	r->nq += j->nq;
	r->nv += j->nv;
}

static void number_bodies(struct reference *r)
{
	for (int i = 0; i < r->nj; i++) {
		struct reference_joint *j = &r->joints[i];

		if (j->type != REFERENCE_FIXED)
			j->body = r->nb++;
		else
			j->body = j->parent < 0 ? -1 : r->joints[j->parent].body;
	}
}

static bool has_rows(const struct reference *r, int i)
{
	return r->joints[i].driver == i && r->joints[i].type != REFERENCE_FIXED;
}

static bool number_listed(struct builder *b, const char *order, bool *done)
{
	struct reference *r = b->r;
	int listed = 0, expected = 0;

	for (const char *s = order; *s;) {
		size_t n = strcspn(s, ",");
		int found = 0;

		for (int i = 1; i < r->nj && !found; i++)
			if (strlen(r->joints[i].name) == n && !memcmp(r->joints[i].name, s, n))
				found = i;
		if (!found || done[found] || !has_rows(r, found))
			return refuse(b, "order: no such joint, or twice: %s", s);
		done[found] = true;
		listed++;
		number(r, found);
		s += s[n] ? n + 1 : n;
	}
	for (int i = 1; i < r->nj; i++)
		expected += has_rows(r, i);
	return listed == expected || refuse(b, "order: %d names for %d joints", listed, expected);
}

static bool number_all(struct builder *b, const char *order)
{
	struct reference *r = b->r;
	bool good = true;

	number(r, 0);
	if (order) {
		bool *done = raw_memory(NULL, (size_t)r->nj, sizeof *done);

		memset(done, 0, (size_t)r->nj);
		good = number_listed(b, order, done);
		free(done);
	}
	for (int i = 1; i < r->nj && !order; i++)
		number(r, i);
	number_bodies(r);
	return good;
}

static bool build(struct builder *b, const struct reference_options *o)
{
	int root = find_root(b);

	if (root < 0 || !walk(b, root))
		return false;
	for (int i = 0; i < b->r->nj; i++)
		if (!set_entry(b, i, o->floating))
			return false;
	for (int i = 0; i < b->r->nj && !o->independent; i++)
		if (!set_mimic(b, i))
			return false;
	for (int i = 0; i < 3; i++)
		b->r->gravity[i] = (wide)(o->gravity ? o->gravity[i] : i == 2 ? -9.81 : 0);
	return number_all(b, o->order);
}

struct reference *reference_open(const char *urdf, size_t length, const struct reference_options *o, char *message,
                                 size_t size)
{
	static const struct reference_options defaults = {0};
	struct raw_robot raw;
	bool good = raw_read(&raw, urdf, length, o && o->decimals, message, size);
	struct reference *r = raw_memory(NULL, 1, sizeof *r);
	struct builder b = {.raw = &raw, .r = r, .message = message, .size = size};

	*r = (struct reference){0};
	r->joints = raw_memory(NULL, (size_t)raw.nlinks + 1, sizeof *r->joints);
	r->links = raw_memory(NULL, (size_t)raw.nlinks + 1, sizeof *r->links);
	b.source = raw_memory(NULL, (size_t)raw.nlinks + 1, sizeof *b.source);
	good = good && build(&b, o ? o : &defaults);
	free(b.source);
	raw_free(&raw);
	if (good)
		return r;
	reference_close(r);
	return NULL;
}

void reference_close(struct reference *r)
{
	if (!r)
		return;
	for (int i = 0; i < r->nj; i++) {
		free(r->joints[i].name);
		free(r->joints[i].link);
	}
	free(r->joints);
	free(r->links);
	free(r);
}
