/* What a scene makes of each joint. */
#include "scene/select.h"

static void dump_joint(const struct selection *c, const struct robot *r, int k, struct text *out)
{
	const struct joint *j = &r->joints[k];
	const struct selection_joint *s = &c->joints[k];

	text_printf(out, "joint \"%s\" %s", j->name, joint_type_name(j->type));
	if (!c->reached[j->parent] || !c->reached[j->child]) {
		text_put(out, " cut away\n");
		return;
	}
	text_put(out, s->state == SELECTION_HELD ? " held at" : " moves");
	for (int i = 0; i < joint_nq(j->type) && s->state == SELECTION_HELD; i++)
		text_printf(out, " %.17Lg", s->value[i].x);
	if (s->state == SELECTION_HELD)
		text_printf(out, " (%s), %s", s->why, s->is_body ? "a body of its own" : "merged");
	else if (s->leader != k)
		text_printf(out, " with \"%s\": multiplier %.17Lg offset %.17Lg", r->joints[s->leader].name,
			s->multiplier.x, s->offset.x);
	text_putc(out, '\n');
}

void scene_dump(const struct scene *s, const struct selection *c, const struct robot *r, struct text *out)
{
	text_printf(out, "scene of \"%s\": root link \"%s\"\n", r->name, r->links[c->root].name);
	for (int i = 0; i < s->line_count; i++) {
		text_put(out, "  ");
		scene_put_option(&s->lines[i], out);
		text_putc(out, '\n');
	}
	for (int j = 0; j < r->joint_count; j++)
		if (r->joints[j].type != JOINT_FIXED)
			dump_joint(c, r, j, out);
}
