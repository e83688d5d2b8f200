#include "assemble.h"
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
static enum rneagen_code sort_names(
	void *entries, size_t count, size_t size, const char *what, const char *file, struct rneagen_error *e)
{
	const char *at = entries;

	if (count)
		qsort(entries, count, size, compare_ids);
	for (size_t i = 1; i < count; i++) {
		const struct outline_id *a = (const void *)(at + (i - 1) * size), *b = (const void *)(at + i * size);
		if (!strcmp(a->name, b->name))
			return error_set(e, RNEAGEN_URDF, "%s:%ld: %s '%s' is already defined on line %ld; rename one", file, b->line,
				what, b->name, a->line);
	}
	return RNEAGEN_OK;
}

static int find_link(const struct outline *o, const struct outline_joint *j, const char *end, const char *link,
	const char *file, struct rneagen_error *e)
{
	int i = link ? find_name(o->links, o->link_count, sizeof *o->links, link) : -1;

	if (!link)
		error_set(e, RNEAGEN_TREE, "%s:%ld: joint '%s' has no <%s>; name the link", file, j->id.line, j->id.name, end);
	else if (i < 0)
		error_set(e, RNEAGEN_TREE, "%s:%ld: joint '%s': its %s link '%s' is not defined; add the link or correct the name",
			file, j->id.line, j->id.name, end, link);
	return i;
}

static enum rneagen_code fill_joint(
	struct robot *r, int index, const struct outline *o, const char *file, struct rneagen_error *e)
{
	const struct outline_joint *from = &o->joints[index];
	struct joint *j = &r->joints[index];
	int parent = find_link(o, from, "parent", from->parent, file, e);
	int child = find_link(o, from, "child", from->child, file, e);

	*j = (struct joint){.name = from->id.name, .type = from->type, .parent = parent, .child = child, .driver = -1};
	memcpy(j->rpy, from->rpy, sizeof j->rpy);
	if (from->driver) {
		j->driver = find_name(o->joints, o->joint_count, sizeof *o->joints, from->driver);
		if (j->driver < 0)
			error_set(e, RNEAGEN_MIMIC, "%s:%ld: joint '%s' mimics joint '%s', which is not defined; correct the name", file,
				from->id.line, j->name, from->driver);
	}
	if (e->code)
		return e->code;
	if (parent == child)
		return error_set(e, RNEAGEN_TREE, "%s:%ld: joint '%s' joins link '%s' to itself; give another parent or child",
			file, from->id.line, j->name, from->child);
	if (r->links[child].parent_joint >= 0)
		return error_set(e, RNEAGEN_TREE,
			"%s:%ld: link '%s' is the child of two joints, '%s' and '%s'; a loop cannot be given as a tree", file,
			from->id.line, from->child, r->joints[r->links[child].parent_joint].name, j->name);
	r->links[child].parent_joint = index;
	return RNEAGEN_OK;
}

/* Towards the root, at most `steps` joints. */
static int climb(const struct robot *r, int link, int steps)
{
	while (steps-- > 0 && r->links[link].parent_joint >= 0)
		link = r->joints[r->links[link].parent_joint].parent;
	return link;
}

/* One root, and every link leads up to it; a walk that is still going after as many joints as there are is in a
   cycle. */
static enum rneagen_code check_tree(struct robot *r, const struct outline *o, const char *file, struct rneagen_error *e)
{
	r->root = -1;
	for (int i = 0; i < r->link_count; i++) {
		int top = climb(r, i, r->joint_count + 1), up = r->links[top].parent_joint;

		if (up >= 0)
			return error_set(e, RNEAGEN_TREE,
				"%s:%ld: links '%s' and '%s' are in a cycle of joints, not reachable from a root; remove joint '%s'", file,
				o->joints[up].id.line, r->links[top].name, r->links[r->joints[up].parent].name, r->joints[up].name);
		if (r->root >= 0 && top != r->root)
			return error_set(e, RNEAGEN_TREE,
				"%s:%ld: links '%s' and '%s' both have no parent joint; join them, or remove one", file,
				o->links[top].id.line, r->links[r->root].name, r->links[top].name);
		r->root = top;
	}
	return RNEAGEN_OK;
}

enum rneagen_code assemble_robot(
	struct robot *r, struct outline *o, const char *file, struct arena *a, struct rneagen_error *e)
{
	r->name = o->name;
	if (!o->link_count)
		return error_set(e, RNEAGEN_URDF, "%s: robot '%s' has no <link>; add at least one", file, o->name);
	if (sort_names(o->links, o->link_count, sizeof *o->links, "link", file, e) ||
		sort_names(o->joints, o->joint_count, sizeof *o->joints, "joint", file, e))
		return e->code;
	r->link_count = (int)o->link_count;
	r->joint_count = (int)o->joint_count;
	r->links = arena_alloc(a, o->link_count, sizeof *r->links);
	r->joints = arena_alloc(a, o->joint_count, sizeof *r->joints);
	if (!r->links || !r->joints)
		return error_memory(e);
	for (int i = 0; i < r->link_count; i++) {
		r->links[i] = (struct link){.name = o->links[i].id.name, .parent_joint = -1};
		memcpy(r->links[i].com_rpy, o->links[i].com_rpy, sizeof r->links[i].com_rpy);
	}
	for (int i = 0; i < r->joint_count; i++)
		if (fill_joint(r, i, o, file, e))
			return e->code;
	return check_tree(r, o, file, e);
}
