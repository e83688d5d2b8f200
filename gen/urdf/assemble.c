#include "urdf/assemble.h"
#include <stdlib.h>
#include <string.h>

/* Every entry of an outline begins with its id. */
static int compare_ids(const void *x, const void *y)
{
	const struct outline_id *a = x, *b = y;
	int order = strcmp(a->name, b->name);

	return order ? order : (a->line > b->line) - (a->line < b->line);
}

static int compare_name(const void *name, const void *entry)
{
	return strcmp(name, ((const struct outline_id *)entry)->name);
}

static int find_name(const void *entries, size_t count, size_t size, const char *name)
{
	const char *found = count ? bsearch(name, entries, count, size, compare_name) : NULL;

	return found ? (int)((size_t)(found - (const char *)entries) / size) : -1;
}

/* Sort by name; no name may be used twice. */
static enum rneagen_code sort_names(void *entries, size_t count, size_t size, const char *what, const struct diagnostic *p)
{
	const char *at = entries;

	if (count)
		qsort(entries, count, size, compare_ids);
	for (size_t i = 1; i < count; i++) {
		const struct outline_id *a = (const void *)(at + (i - 1) * size), *b = (const void *)(at + i * size);

		if (!strcmp(a->name, b->name))
			return diagnostic_error(p, RNEAGEN_URDF, b->line,
				"%s '%s' is already defined on line %ld; rename one", what, b->name, a->line);
	}
	return RNEAGEN_OK;
}

/* The link at one end of a joint; -1 on failure. */
static int find_link(const struct outline *o, const struct outline_joint *j, const char *end, const char *link,
	const struct diagnostic *p)
{
	int i = link ? find_name(o->links, o->link_count, sizeof *o->links, link) : -1;

	if (!link)
		diagnostic_error(p, RNEAGEN_TREE, j->id.line, "joint '%s' has no <%s>; name the link", j->id.name, end);
	else if (i < 0)
		diagnostic_error(p, RNEAGEN_TREE, j->id.line,
			"joint '%s': its %s link '%s' is not defined; add the link or correct the name", j->id.name,
			end, link);
	return i;
}

/* The joint that a joint mimics, or -1. */
static int find_driver(const struct outline *o, const struct outline_joint *j, const struct diagnostic *p)
{
	int i = j->driver ? find_name(o->joints, o->joint_count, sizeof *o->joints, j->driver) : -1;

	if (j->driver && i < 0)
		diagnostic_error(p, RNEAGEN_MIMIC, j->id.line,
			"joint '%s' mimics joint '%s', which is not defined; correct the name", j->id.name, j->driver);
	return i;
}

static enum rneagen_code fill_joint(int index, const struct outline *o, const struct diagnostic *p)
{
	const struct outline_joint *from = &o->joints[index];
	struct robot *r = p->robot;
	struct joint *j = &r->joints[index];
	struct link *child;

	*j = from->joint;
	j->name = from->id.name;
	j->type = from->type;
	j->parent = find_link(o, from, "parent", from->parent, p);
	j->child = find_link(o, from, "child", from->child, p);
	j->driver = find_driver(o, from, p);
	if (p->error->code)
		return p->error->code;
	child = &r->links[j->child];
	if (j->parent == j->child)
		return diagnostic_error(p, RNEAGEN_TREE, from->id.line,
			"joint '%s' joins link '%s' to itself; give another parent or child", j->name, child->name);
	if (child->parent_joint >= 0)
		return diagnostic_error(p, RNEAGEN_TREE, from->id.line,
			"link '%s' is the child of two joints, '%s' and '%s'; remove one: loops are not supported",
			child->name, r->joints[child->parent_joint].name, j->name);
	child->parent_joint = index;
	return RNEAGEN_OK;
}

/* Towards the root, at most `steps` joints. */
static int climb(const struct robot *r, int link, int steps)
{
	while (steps-- > 0 && r->links[link].parent_joint >= 0)
		link = r->joints[r->links[link].parent_joint].parent;
	return link;
}

/* One root, and every link leads up to it. A climb that still goes on after as many joints as there are is in a
   cycle. */
static enum rneagen_code check_tree(const struct outline *o, const struct diagnostic *p)
{
	struct robot *r = p->robot;

	r->root = -1;
	for (int i = 0; i < r->link_count; i++) {
		int top = climb(r, i, r->joint_count), up = r->links[top].parent_joint;

		if (up >= 0)
			return diagnostic_error(p, RNEAGEN_TREE, o->joints[up].id.line,
				"links '%s' and '%s' are in a cycle, not reachable from a root; remove joint '%s'",
				r->links[top].name, r->links[r->joints[up].parent].name, r->joints[up].name);
		if (r->root >= 0 && top != r->root)
			return diagnostic_error(p, RNEAGEN_TREE, o->links[top].id.line,
				"links '%s' and '%s' both have no parent joint; join them, or remove one",
				r->links[r->root].name, r->links[top].name);
		r->root = top;
	}
	return RNEAGEN_OK;
}

enum rneagen_code assemble_robot(struct outline *o, const struct diagnostic *p)
{
	struct robot *r = p->robot;

	r->name = o->name;
	if (!o->link_count)
		return diagnostic_error(p, RNEAGEN_URDF, 0, "robot '%s' has no <link>; add at least one", o->name);
	if (sort_names(o->links, o->link_count, sizeof *o->links, "link", p) ||
		sort_names(o->joints, o->joint_count, sizeof *o->joints, "joint", p))
		return p->error->code;
	r->link_count = (int)o->link_count;
	r->joint_count = (int)o->joint_count;
	r->links = arena_alloc(p->arena, o->link_count, sizeof *r->links);
	r->joints = arena_alloc(p->arena, o->joint_count, sizeof *r->joints);
	if (!r->links || !r->joints)
		return error_memory(p->error);
	for (int i = 0; i < r->link_count; i++) {
		r->links[i] = o->links[i].link;
		r->links[i].name = o->links[i].id.name;
		r->links[i].parent_joint = -1;
	}
	for (int i = 0; i < r->joint_count; i++)
		if (fill_joint(i, o, p))
			return p->error->code;
	return check_tree(o, p);
}
