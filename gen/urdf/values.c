#include "base/number.h"
#include "urdf/walk.h"
#include <stddef.h>
#include <string.h>

/* An attribute, and where its numbers go in the open link or joint; 0: nowhere. */
struct kept {
	const char *name;
	size_t at;
};

#define IN_LINK(field) offsetof(struct link, field)
#define IN_JOINT(field) offsetof(struct joint, field)

/* The elements whose values matter. Each attribute holds `width` numbers; the first `required` must be there, or, if that
   is ANY, one of them. */
struct rule {
	enum place place;
	const char *element;
	int width, required;
	struct kept attributes[7];
};

enum { ANY = -1 };

static const struct rule rules[] = {
	{INERTIAL, "origin", 3, 0, {{"xyz", IN_LINK(com)}, {"rpy", IN_LINK(com_rpy)}}},
	{INERTIAL, "mass", 1, 1, {{"value", IN_LINK(mass)}}},
	{INERTIAL, "inertia", 1, 6,
		{{"ixx", IN_LINK(inertia[0])}, {"ixy", IN_LINK(inertia[1])}, {"ixz", IN_LINK(inertia[2])},
			{"iyy", IN_LINK(inertia[3])}, {"iyz", IN_LINK(inertia[4])}, {"izz", IN_LINK(inertia[5])}}},
	{JOINT, "origin", 3, 0, {{"xyz", IN_JOINT(xyz)}, {"rpy", IN_JOINT(rpy)}}},
	{JOINT, "axis", 3, 0, {{"xyz", IN_JOINT(axis)}}},
	{JOINT, "limit", 1, 2, {{"effort", 0}, {"velocity", 0}, {"lower", 0}, {"upper", 0}}},
	{JOINT, "dynamics", 1, ANY, {{"damping", IN_JOINT(damping)}, {"friction", IN_JOINT(friction)}}},
	{JOINT, "mimic", 1, 0, {{"multiplier", IN_JOINT(multiplier)}, {"offset", IN_JOINT(offset)}}},
	{JOINT, "parent", 1, 0, {{0}}},
	{JOINT, "child", 1, 0, {{0}}},
	{JOINT, "safety_controller", 1, 1,
		{{"k_velocity", 0}, {"k_position", 0}, {"soft_lower_limit", 0}, {"soft_upper_limit", 0}}},
	{JOINT, "calibration", 1, 0, {{"rising", 0}, {"falling", 0}}},
};

enum { RULE_COUNT = sizeof rules / sizeof *rules };

const char *values_attribute(const char *const *attributes, const char *name)
{
	for (; *attributes; attributes += 2)
		if (!strcmp(attributes[0], name))
			return attributes[1];
	return NULL;
}

static int rule_find(enum place place, const char *element)
{
	for (int i = 0; i < RULE_COUNT; i++)
		if (rules[i].place == place && !strcmp(rules[i].element, element))
			return i;
	return -1;
}

/* Whether a value in the tag, as it stands in the file, holds a tab or a line break. expat makes them blanks, as XML
   asks; urdfdom sees them and refuses the vector. */
static int tab_in_tag(const struct walk *w)
{
	const char *s = w->xml + XML_GetCurrentByteIndex(w->parser);
	const char *end = s + XML_GetCurrentByteCount(w->parser);
	char quote = '\0';

	for (; s < end; s++) {
		if (quote && strchr("\t\r\n", *s))
			return 1;
		if (*s == quote)
			quote = '\0';
		else if (!quote && (*s == '"' || *s == '\''))
			quote = *s;
	}
	return 0;
}

/* What a value is, and what to do. */
static const char *describe(enum number_fault fault, int width)
{
	if (fault == NUMBER_LARGE)
		return width == 1 ? "is too large: numbers go up to 1.79e308; correct it"
				  : "has a number that is too large: they go up to 1.79e308; correct it";
	if (fault == NUMBER_BLANK)
		return "ends with a blank, which urdfdom does not take after a single number; remove it";
	return width == 1 ? "is not a number; write a finite decimal one, such as 0.25"
			  : "is not three numbers; write finite decimal ones with blanks between";
}

static void read_numbers(struct walk *w, const struct rule *rule, const char *const *attributes)
{
	int count = 0;

	for (int i = 0; rule->attributes[i].name; i++) {
		const char *name = rule->attributes[i].name;
		const char *value = values_attribute(attributes, name);
		enum number_fault fault;
		struct within v[3];

		if (!value && i < rule->required)
			walk_fail(w, RNEAGEN_URDF, "%s '%s': <%s> has no %s; add it", w->owner, w->owner_name,
				rule->element, name);
		if (!value)
			continue;
		count++;
		fault = number_read(value, v, rule->width);
		if (fault)
			walk_fail(w, RNEAGEN_NUMBER, "%s '%s': <%s> %s=\"%.100s\" %s", w->owner, w->owner_name,
				rule->element, name, value, describe(fault, rule->width));
		else if (rule->attributes[i].at)
			memcpy(w->numbers + rule->attributes[i].at, v, (size_t)rule->width * sizeof *v);
	}
	if (rule->required == ANY && !count)
		walk_fail(w, RNEAGEN_URDF, "%s '%s': <%s> has neither %s nor %s; add one, or remove it", w->owner, w->owner_name,
			rule->element, rule->attributes[0].name, rule->attributes[1].name);
}

static void refuse_odd_vectors(struct walk *w, const char *element, const char *const *attributes)
{
	if (tab_in_tag(w))
		walk_fail(w, RNEAGEN_NUMBER,
			"%s '%s': <%s> holds a tab or a line break between its numbers; use blanks", w->owner,
			w->owner_name, element);
	if (values_attribute(attributes, "quat_xyzw"))
		walk_fail(w, RNEAGEN_UNSUPPORTED, "%s '%s': <%s> quat_xyzw is not supported; give rpy", w->owner,
			w->owner_name, element);
}

static const char *copy_name(struct walk *w, const char *element, const char *const *attributes, const char *name)
{
	const char *value = values_attribute(attributes, name);

	if (!value)
		walk_fail(w, RNEAGEN_URDF, "joint '%s': <%s> has no %s; name one", w->owner_name, element, name);
	return value ? arena_string(w->diagnostic->arena, value, strlen(value)) : NULL;
}

static void read_names(struct walk *w, const char *element, const char *const *attributes)
{
	struct outline_joint *j = &w->outline->joints[w->outline->joint_count - 1];

	if (!strcmp(element, "parent"))
		j->parent = copy_name(w, element, attributes, "link");
	else if (!strcmp(element, "child"))
		j->child = copy_name(w, element, attributes, "link");
	else if (!strcmp(element, "mimic"))
		j->driver = copy_name(w, element, attributes, "joint");
}

/* Fixed and floating joints have no axis: urdfdom ignores what stands there, and so do we. */
static int axis_is_idle(const struct walk *w, const char *element)
{
	enum joint_type type = w->outline->joints[w->outline->joint_count - 1].type;

	return !strcmp(element, "axis") && (type == JOINT_FIXED || type == JOINT_FLOATING);
}

static void warn_twice(struct walk *w, const char *element, unsigned bit)
{
	if (!(w->twice & bit))
		diagnostic_warning(w->diagnostic, walk_line(w), "%s '%s': more than one <%s>; the first is used", w->owner,
			w->owner_name, element);
	w->twice |= bit;
}

enum place values_read(struct walk *w, const char *element, const char *const *attributes)
{
	enum place place = w->places[w->depth];
	int row = rule_find(place, element);

	if (row < 0 || (place == JOINT && axis_is_idle(w, element)))
		return SKIPPED;
	if (w->seen & 1u << row) {
		warn_twice(w, element, 1u << row);
		return SKIPPED;
	}
	w->seen |= 1u << row;
	if (rules[row].width == 3)
		refuse_odd_vectors(w, element, attributes);
	read_numbers(w, &rules[row], attributes);
	if (place == JOINT)
		read_names(w, element, attributes);
	return VALUE;
}

void values_end_inertial(struct walk *w)
{
	static const char *const needed[] = {"mass", "inertia"};

	for (int i = 0; i < 2; i++)
		if (!(w->seen & 1u << rule_find(INERTIAL, needed[i])))
			walk_fail(w, RNEAGEN_URDF, "link '%s': <inertial> has no <%s>; add it, or drop the <inertial>",
				w->owner_name, needed[i]);
}

void values_end_joint(struct walk *w)
{
	const struct outline_joint *j = &w->outline->joints[w->outline->joint_count - 1];

	if ((j->type == JOINT_REVOLUTE || j->type == JOINT_PRISMATIC) && !(w->seen & 1u << rule_find(JOINT, "limit")))
		walk_fail_at(w, j->id.line, RNEAGEN_URDF,
			"joint '%s' is %s and has no <limit>; add one with effort and velocity%s", j->id.name,
			joint_type_name(j->type), j->type == JOINT_REVOLUTE ? ", or make the joint continuous" : "");
}
