/* What may stand for a link: a link, a frame that the scene adds, or a joint. */
#include "base/nearest.h"
#include "request/resolve.h"
#include <string.h>

enum { FRAME_NUMBERS = 6 };

/* How poses are written, and in which frame Jacobians are. */
void request_forms(const struct resolver *x)
{
	const struct scene_choice *pose = scene_next(x->s, SCENE_POSE, NULL), *frame = scene_next(x->s, SCENE_FRAME, NULL);

	if (pose && !strcmp(pose->value, "quaternion"))
		x->k->pose = POSE_QUATERNION;
	if (frame && strcmp(frame->value, "link"))
		x->k->frame = !strcmp(frame->value, "world") ? FRAME_WORLD : FRAME_WORLD_ALIGNED;
}

static int find_added(const struct request *k, const char *name)
{
	for (int i = 0; i < k->frame_count; i++)
		if (!strcmp(k->frames[i].name, name))
			return i;
	return -1;
}

static enum rneagen_code refuse(const struct resolver *x, const struct scene_choice *c, const char *name)
{
	int links = x->r->link_count, joints = x->r->joint_count, frames = x->k->frame_count;
	const char **names = arena_alloc(x->a, (size_t)(links + joints + frames), sizeof *names), *meant;

	if (!names)
		return error_memory(x->e);
	for (int i = 0; i < links; i++)
		names[i] = x->r->links[i].name;
	for (int i = 0; i < frames; i++)
		names[links + i] = x->k->frames[i].name;
	for (int i = 0; i < joints; i++)
		names[links + frames + i] = x->r->joints[i].name;
	meant = nearest_name(name, names, (size_t)(links + joints + frames), sizeof *names);
	return scene_refuse(x->s, c, x->e, "no link '%.255s'%s%s%s", name, meant ? "; did you mean '" : "", meant ? meant : "",
		meant ? "'?" : "");
}

enum rneagen_code request_find_frame(const struct resolver *x, const struct scene_choice *c, const char *name, int *body,
	struct placement *X)
{
	int link = robot_link(x->r, name), added = find_added(x->k, name), joint = robot_joint(x->r, name);

	if (link < 0 && added >= 0)
		link = x->k->frames[added].link;
	else if (link < 0 && joint >= 0)
		link = x->r->joints[joint].child;
	else if (link < 0)
		return refuse(x, c, name);
	if (request_find_link(x, c, x->r->links[link].name) < 0)
		return x->e->code;
	*body = x->t->links[link].body;
	*X = x->t->links[link].X;
	if (added >= 0)
		*X = placement_mul(X, &x->k->frames[added].X);
	return RNEAGEN_OK;
}

/* ---- frames that are added ---- */

/* LINK,x,y,z,r,p,y: where the comma before the six numbers is; NULL and an error where there are not six. */
static const char *find_numbers(const struct resolver *x, const struct scene_choice *c)
{
	const char *at = c->value + strlen(c->value), *first = strchr(c->value, ',');
	char *link;
	int commas = 0, found = 0;

	for (const char *s = c->value; *s; s++)
		commas += *s == ',';
	while (at > c->value && found < FRAME_NUMBERS)
		found += *--at == ',';
	link = first ? arena_string(x->a, c->value, (size_t)(first - c->value)) : NULL;
	if (found == FRAME_NUMBERS && (at == first || !link || robot_link(x->r, link) < 0))
		return at;
	scene_refuse(x->s, c, x->e,
		"takes NAME=LINK,x,y,z,r,p,y, a link and six numbers, m and rad; '%.255s' has %d number%s", c->value,
		commas, commas == 1 ? "" : "s");
	return NULL;
}

/* A name of its own, that no link, joint or other frame has. */
static enum rneagen_code check_name(const struct resolver *x, const struct scene_choice *c)
{
	const char *what = robot_link(x->r, c->name) >= 0 ? "link" : robot_joint(x->r, c->name) >= 0 ? "joint" :
		find_added(x->k, c->name) >= 0 ? "frame" : NULL;

	return what ? scene_refuse(x->s, c, x->e, "there is a %s '%.255s' already: give the frame another name", what,
			      c->name)
		    : RNEAGEN_OK;
}

/* Without the blanks around it, unless the robot has a link with them. */
static const char *link_name(const struct resolver *x, const char *name, size_t length)
{
	const char *whole = arena_string(x->a, name, length);

	if (!whole || robot_link(x->r, whole) >= 0)
		return whole;
	for (; length && *name == ' '; name++)
		length--;
	while (length && name[length - 1] == ' ')
		length--;
	return arena_string(x->a, name, length);
}

enum rneagen_code request_add_frame(const struct resolver *x, const struct scene_choice *c)
{
	const char *at = find_numbers(x, c), *link;
	struct added_frame *f = &x->k->frames[x->k->frame_count];
	struct scene_choice numbers = *c;
	struct within values[FRAME_NUMBERS];

	if (!at || check_name(x, c))
		return x->e->code;
	link = link_name(x, c->value, (size_t)(at - c->value));
	if (!link)
		return error_memory(x->e);
	numbers.value = at + 1;
	if ((f->link = request_find_link(x, c, link)) < 0 || scene_numbers(x->s, &numbers, values, FRAME_NUMBERS, x->e))
		return x->e->code;
	f->name = c->name;
	f->X = (struct placement){rotation_rpy(values + 3), {values[0], values[1], values[2]}};
	x->k->frame_count++;
	return RNEAGEN_OK;
}
