#include "tell/scene_put.h"
#include "base/number.h"

enum { WIDTH = 110 };

void scene_put_options(const struct scene *s, const char *before, struct text *out)
{
	for (int i = 0; i < s->line_count; i++) {
		text_put(out, before);
		scene_put_option(&s->lines[i], out);
	}
}

static void put_value(const struct outcome_held *h, struct text *out)
{
	for (int i = 0; i < joint_nq(h->type); i++)
		text_printf(out, "%s%.9Lg", i ? ", " : "", h->value[i].x);
}

/* ---- --info ---- */

/* Names after one another, in lines of a bearable length. */
static void put_names(const char *what, const char *next, void (*put)(const char *name, struct text *out),
	const char *const *names, int count, struct text *out)
{
	size_t begin = out->length;

	for (int i = 0; i < count; i++) {
		if (i == 0 || out->length - begin > WIDTH) {
			text_put(out, i ? next : what);
			begin = out->length;
		} else {
			text_put(out, ", ");
		}
		put(names[i], out);
	}
	if (count)
		text_putc(out, '\n');
}

static void put_plain(const char *name, struct text *out)
{
	text_put(out, name);
}

void scene_put_ignored(const struct outcome *o, struct text *out)
{
	const struct outcome_ignored *x = &o->ignored;

	if (x->damping_count || x->friction_count || x->limit_count || x->transmission_count)
		text_put(out, "\nin the URDF and not modelled\n");
	put_names("  damping of ", ",\n    ", put_plain, x->damping, x->damping_count, out);
	put_names("  friction of ", ",\n    ", put_plain, x->friction, x->friction_count, out);
	put_names("  limits of ", ",\n    ", put_plain, x->limits, x->limit_count, out);
	if (x->transmission_count)
		text_printf(out, "  %d transmissions\n", x->transmission_count);
}

void scene_put_table(const struct scene *s, const struct outcome *o, struct text *out)
{
	if (!s->line_count)
		return;
	text_put(out, "\nscene");
	scene_put_options(s, "\n  ", out);
	text_put(out, o->held_count ? "\nheld\n" : "\n");
	for (int i = 0; i < o->held_count; i++) {
		text_printf(out, "  %s = ", o->held[i].name);
		put_value(&o->held[i], out);
		text_printf(out, " (%s)\n", o->held[i].why);
	}
	if (o->cut.link_count)
		text_printf(out, "cut away: %d links of %.6Lg kg, %d joints\n", o->cut.link_count, o->cut.mass,
			o->cut.joint_count);
	put_names("  joints: ", ",\n    ", put_plain, o->cut.joints, o->cut.joint_count, out);
	put_names("  links: ", ",\n    ", put_plain, o->cut.links, o->cut.link_count, out);
}

/* ---- --info=json ---- */

static void put_json_names(const char *key, const char *const *names, int count, struct text *out)
{
	text_printf(out, "\"%s\": [", key);
	for (int i = 0; i < count; i++) {
		text_put(out, i ? ", " : "");
		text_put_json(out, names[i]);
	}
	text_putc(out, ']');
}

static void put_json_options(const struct scene *s, struct text *out)
{
	for (int i = 0; i < s->line_count; i++) {
		struct text option;

		text_init(&option, out->arena);
		scene_put_option(&s->lines[i], &option);
		out->failed |= option.failed;
		text_put(out, i ? ", " : "");
		text_put_json(out, text_string(&option));
	}
}

void scene_put_json_ignored(const struct outcome *o, struct text *out)
{
	const struct outcome_ignored *x = &o->ignored;

	text_put(out, "  \"ignored\": {");
	put_json_names("damping", x->damping, x->damping_count, out);
	text_put(out, ", ");
	put_json_names("friction", x->friction, x->friction_count, out);
	text_put(out, ", ");
	put_json_names("limits", x->limits, x->limit_count, out);
	text_printf(out, ", \"transmissions\": %d},\n", x->transmission_count);
}

void scene_put_json(const struct scene *s, const struct outcome *o, struct text *out)
{
	if (!s->line_count)
		return;
	text_put(out, "  \"scene\": {\n    \"options\": [");
	put_json_options(s, out);
	text_put(out, "],\n    \"held\": [");
	for (int i = 0; i < o->held_count; i++) {
		text_put(out, i ? ",\n      {\"name\": " : "\n      {\"name\": ");
		text_put_json(out, o->held[i].name);
		text_put(out, ", \"value\": [");
		for (int k = 0; k < joint_nq(o->held[i].type); k++)
			text_printf(out, "%s%s", k ? ", " : "", number_plain((double)o->held[i].value[k].x).s);
		text_printf(out, "], \"why\": \"%s\"}", o->held[i].why);
	}
	text_printf(out, "],\n    \"cut\": {\"mass\": %s, ", number_plain((double)o->cut.mass).s);
	put_json_names("joints", o->cut.joints, o->cut.joint_count, out);
	text_put(out, ", ");
	put_json_names("links", o->cut.links, o->cut.link_count, out);
	text_put(out, "}\n  },\n");
}

/* ---- the head of a text ---- */

static void put_quoted(const char *name, struct text *out)
{
	text_putc(out, '"');
	text_put_comment(out, name);
	text_putc(out, '"');
}

static void put_comment_ignored(const struct outcome *o, struct text *out)
{
	const struct outcome_ignored *x = &o->ignored;

	if (x->damping_count + x->friction_count + x->limit_count)
		text_printf(out, " * In the URDF and not modelled: damping of %d joints, friction of %d, limits of %d\n",
			x->damping_count, x->friction_count, x->limit_count);
}

void scene_put_comment(const struct scene *s, const struct outcome *o, struct text *out)
{
	if (scene_choice_count(s))
		put_comment_ignored(o, out);
	for (int i = 0; i < o->held_count; i++) {
		text_put(out, i ? " *   " : " * Held:\n *   ");
		put_quoted(o->held[i].name, out);
		text_put(out, " = ");
		put_value(&o->held[i], out);
		text_printf(out, " (%s)\n", o->held[i].why);
	}
	if (o->cut.link_count)
		text_printf(out, " * Cut away: %d links of %.6Lg kg, %d joints\n", o->cut.link_count, o->cut.mass,
			o->cut.joint_count);
	put_names(" *   joints: ", ",\n *     ", put_quoted, o->cut.joints, o->cut.joint_count, out);
	put_names(" *   links: ", ",\n *     ", put_quoted, o->cut.links, o->cut.link_count, out);
}
