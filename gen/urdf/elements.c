#include "urdf/walk.h"
#include <string.h>

/* The name of a robot, link or joint as a string of the arena: there and not too long; NULL on failure. */
static const char *read_name(struct walk *w, const char *element, const char *const *attributes)
{
	const char *name = values_attribute(attributes, "name");

	if (!name)
		walk_fail(w, RNEAGEN_URDF, "a <%s> has no name; give it one", element);
	else if (strlen(name) > LIMIT_NAME_BYTES)
		walk_fail(w, RNEAGEN_LIMIT, "%s '%.60s...': the name is longer than %d bytes; shorten it", element,
			name, LIMIT_NAME_BYTES);
	else
		return arena_string(w->diagnostic->arena, name, strlen(name));
	return NULL;
}

static enum place start_robot(struct walk *w, const char *element, const char *const *attributes)
{
	if (strcmp(element, "robot") != 0)
		walk_fail(w, RNEAGEN_URDF, "the root element is <%.100s>, not <robot>; give a URDF", element);
	else
		w->outline->name = read_name(w, element, attributes);
	w->outline->line = walk_line(w);
	elements_leave(w);
	return ROBOT;
}

/* Start a link or a joint: its name, and room for it in `array`. Returns the array, or NULL on failure. */
static void *start_named(struct walk *w, const char *element, const char *const *attributes, void *array, size_t count,
	size_t *capacity, size_t size)
{
	const char *name = read_name(w, element, attributes);

	if (!name)
		return NULL;
	if (!*name) {
		walk_fail(w, RNEAGEN_URDF, "a <%s> has an empty name; give it one", element);
		return NULL;
	}
	w->owner = element;
	w->owner_name = name;
	w->seen = w->twice = 0;
	w->inertials = 0;
	if (count < LIMIT_LINKS)
		return arena_grow(w->diagnostic->arena, array, count, capacity, size);
	walk_fail(w, RNEAGEN_LIMIT, "%s '%s' is one too many: at most %d %ss are supported", element, name, LIMIT_LINKS,
		element);
	return NULL;
}

static struct outline_id id_here(const struct walk *w)
{
	return (struct outline_id){w->owner_name, walk_line(w)};
}

static enum place start_link(struct walk *w, const char *const *attributes)
{
	struct outline *o = w->outline;
	struct outline_link *links =
		start_named(w, "link", attributes, o->links, o->link_count, &o->link_capacity, sizeof *links);

	if (!links)
		return SKIPPED;
	o->links = links;
	links += o->link_count++;
	*links = (struct outline_link){.id = id_here(w)};
	w->numbers = (char *)&links->link;
	return LINK;
}

static enum joint_type read_type(struct walk *w, const char *type)
{
	for (int t = JOINT_FIXED; type && t <= JOINT_FLOATING; t++)
		if (!strcmp(type, joint_type_name((enum joint_type)t)))
			return (enum joint_type)t;
	walk_fail(w, RNEAGEN_URDF,
		"joint '%s': type \"%.60s\" is unknown; use revolute, continuous, prismatic, fixed, planar or floating",
		w->owner_name, type ? type : "");
	return JOINT_FIXED;
}

static enum place start_joint(struct walk *w, const char *const *attributes)
{
	struct outline *o = w->outline;
	struct outline_joint *joints =
		start_named(w, "joint", attributes, o->joints, o->joint_count, &o->joint_capacity, sizeof *joints);

	if (!joints)
		return SKIPPED;
	o->joints = joints;
	joints += o->joint_count++;
	*joints = (struct outline_joint){.id = id_here(w)};
	joints->type = read_type(w, values_attribute(attributes, "type"));
	w->numbers = (char *)&joints->joint;
	return JOINT;
}

static enum place start_inertial(struct walk *w)
{
	if (!w->inertials++)
		return INERTIAL;
	if (w->inertials == 2)
		diagnostic_warning(w->diagnostic, walk_line(w), "link '%s': more than one <inertial>; the first is used",
			w->owner_name);
	return SKIPPED;
}

/* It closes a loop of joints, in dialects of URDF; left out, the robot would be another one. */
static void refuse_loop(struct walk *w, const char *name)
{
	walk_fail(w, RNEAGEN_TREE, "loop_joint '%.200s' closes a loop, which is not supported: take it out where the loop may be open",
		name ? name : "");
}

enum place elements_enter(struct walk *w, const char *element, const char *const *attributes)
{
	switch (w->places[w->depth]) {
	case DOCUMENT:
		return start_robot(w, element, attributes);
	case ROBOT:
		if (!strcmp(element, "link"))
			return start_link(w, attributes);
		if (!strcmp(element, "loop_joint"))
			refuse_loop(w, values_attribute(attributes, "name"));
		w->diagnostic->robot->transmission_count += !strcmp(element, "transmission");
		return strcmp(element, "joint") ? SKIPPED : start_joint(w, attributes);
	case LINK:
		return strcmp(element, "inertial") ? SKIPPED : start_inertial(w);
	case INERTIAL:
	case JOINT:
		return values_read(w, element, attributes);
	case VALUE:
	case SKIPPED:
		break;
	}
	return SKIPPED;
}

void elements_leave(struct walk *w)
{
	w->owner = "robot";
	w->owner_name = w->outline->name;
}
