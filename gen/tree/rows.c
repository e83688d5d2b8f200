#include "tree/rows.h"
#include <string.h>

static const char *input_name(const struct rneagen_options *o)
{
	return o->file ? o->file : "<input>";
}

/* The joint with this name and entries in q among `count` of them; -1 if there is none. */
static int find_joint(const struct tree_joint *joints, int count, const char *name, size_t length)
{
	for (int i = 0; i < count; i++)
		if (strlen(joints[i].name) == length && !memcmp(joints[i].name, name, length))
			return i;
	return -1;
}

/* The length of the name that the list begins with: a name may have commas in it, so the longest that is not chosen yet. */
static size_t name_length(
	const struct tree_joint *joints, int total, const struct tree_joint *chosen, int count, const char *list)
{
	size_t longest = 0;

	for (int i = 0; i < total; i++) {
		size_t n = strlen(joints[i].name);

		if (n > longest && !strncmp(list, joints[i].name, n) && (!list[n] || list[n] == ',') &&
			find_joint(chosen, count, list, n) < 0)
			longest = n;
	}
	return longest ? longest : strcspn(list, ",");
}

/* Reorder as the option says; every joint (the base of --base floating apart) must be named once. */
static enum rneagen_code apply_order(
	struct tree *t, const struct rneagen_options *o, struct arena *a, struct rneagen_error *e)
{
	int first = t->floating, count = 0, total = t->joint_count - first;
	struct tree_joint *chosen = arena_alloc(a, (size_t)t->joint_count, sizeof *chosen);

	if (!chosen)
		return error_memory(e);
	for (const char *s = o->order; s;) {
		size_t length = name_length(t->joints + first, total, chosen, count, s);
		int i = find_joint(t->joints + first, total, s, length);

		if (i < 0)
			return error_set(e, RNEAGEN_USAGE, "%s: --order names '%.*s', which is no joint with entries in q",
				input_name(o), (int)(length < 255 ? length : 255), s);
		if (find_joint(chosen, count, s, length) >= 0)
			return error_set(e, RNEAGEN_USAGE, "%s: --order names joint '%.*s' twice", input_name(o),
				(int)length, s);
		chosen[count++] = t->joints[first + i];
		s = s[length] ? s + length + 1 : NULL;
	}
	for (int i = 0; i < total; i++)
		if (find_joint(chosen, count, t->joints[first + i].name, strlen(t->joints[first + i].name)) < 0)
			return error_set(e, RNEAGEN_USAGE, "%s: --order leaves out joint '%s'; name all %d joints",
				input_name(o), t->joints[first + i].name, total);
	memcpy(t->joints + first, chosen, (size_t)total * sizeof *chosen);
	return RNEAGEN_OK;
}

enum rneagen_code rows_number(
	struct tree *t, const struct rneagen_options *o, struct arena *a, struct rneagen_error *e)
{
	for (int k = 0; k < t->body_count; k++)
		if (!t->bodies[k].follower && t->bodies[k].type != JOINT_FIXED)
			t->joints[t->joint_count++] = (struct tree_joint){
				.name = t->bodies[k].joint, .type = t->bodies[k].type, .body = k};
	if (!t->joint_count)
		return error_set(e, RNEAGEN_NO_JOINTS, "%s: no movable joints in robot '%s'%s", input_name(o), t->robot,
			o->scene && *o->scene ? ", or none that the scene leaves" : "");
	if (o->order && apply_order(t, o, a, e))
		return e->code;
	for (int i = 0; i < t->joint_count; i++) {
		struct tree_joint *j = &t->joints[i];

		j->iq = t->nq;
		j->iv = t->nv;
		t->nq += j->nq = joint_nq(j->type);
		t->nv += j->nv = joint_nv(j->type);
		t->bodies[j->body].iq = j->iq;
		t->bodies[j->body].iv = j->iv;
	}
	for (int i = 0; i < t->mimic_count; i++) {
		struct tree_mimic *m = &t->mimics[i];
		int driver = find_joint(t->joints, t->joint_count, m->driver, strlen(m->driver));

		t->bodies[m->body].iq = t->joints[driver].iq;
		t->bodies[m->body].iv = t->joints[driver].iv;
	}
	return RNEAGEN_OK;
}
