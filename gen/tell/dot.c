#include "tell/dot.h"

/* A name inside a quoted label. Graphviz resolves backslashes and the entities of HTML there; control characters are
   shown as \xHH. */
static void put_label(struct text *out, const char *s)
{
	for (; *s; s++) {
		unsigned char c = (unsigned char)*s;

		if (c == '"')
			text_put(out, "\\\"");
		else if (c == '\\')
			text_put(out, "\\\\");
		else if (c == '&')
			text_put(out, "&amp;");
		else if (c < 0x20 || c == 0x7f)
			text_printf(out, "\\\\x%02x", c);
		else
			text_putc(out, (char)c);
	}
}

static void put_rows(struct text *out, const struct body *k)
{
	int n = joint_nq(k->type);

	if (n > 1)
		text_printf(out, "q[%d..%d]", k->iq, k->iq + n - 1);
	else
		text_printf(out, "q[%d]", k->iq);
}

/* The unit axis in the joint's URDF frame: frame (sign e_axis). */
static void put_axis(struct text *out, const struct body *k)
{
	text_put(out, k->type == JOINT_PLANAR ? "\\nnormal" : "\\naxis");
	for (int i = 0; i < 3; i++)
		text_printf(out, " %.6Lg", k->sign * k->frame.m[i][k->axis].x + 0); /* -0 + 0 = 0 */
}

static void put_world(const struct tree *t, struct text *out)
{
	text_put(out, "\tworld [peripheries=2, label=\"");
	put_label(out, t->root);
	text_printf(out, "\\nbase, fixed to the world\\n%.6Lg kg\"];\n", t->fixed.mass.x);
}

static void put_node(const struct body *k, struct text *out)
{
	int is_base = !*k->joint;

	text_printf(out, "\tb%d [%slabel=\"", k->number, is_base ? "peripheries=2, " : "");
	put_label(out, k->link);
	text_printf(out, "\\nbody %d", k->number);
	if (is_base) {
		text_put(out, ", floating base\\n");
		put_rows(out, k);
	}
	text_printf(out, "\\n%.6Lg kg\"];\n", k->inertia.mass.x);
}

/* q = multiplier q_driver + offset */
static void put_mimic(const struct tree_mimic *m, const struct body *k, struct text *out)
{
	text_printf(out, ", mimic %.9Lg ", m->multiplier.x);
	put_rows(out, k);
	if (m->offset.x != 0)
		text_printf(out, " %c %.9Lg", m->offset.x < 0 ? '-' : '+', m->offset.x < 0 ? -m->offset.x : m->offset.x);
}

static const struct tree_mimic *find_mimic(const struct tree *t, const struct body *k)
{
	const struct tree_mimic *m = t->mimics;

	while (&t->bodies[m->body] != k)
		m++;
	return m;
}

static void put_edge(const struct tree *t, const struct body *k, struct text *out)
{
	if (k->parent < 0)
		text_put(out, "\tworld");
	else
		text_printf(out, "\tb%d", t->bodies[k->parent].number);
	text_printf(out, " -> b%d [label=\"", k->number);
	put_label(out, k->joint);
	text_printf(out, "\\n%s", joint_type_name(k->type));
	if (k->type == JOINT_FIXED) {
		text_put(out, " held");
	} else if (k->follower) {
		put_mimic(find_mimic(t, k), k, out);
	} else {
		text_putc(out, ' ');
		put_rows(out, k);
	}
	if (k->type != JOINT_FLOATING && k->type != JOINT_FIXED)
		put_axis(out, k);
	text_put(out, "\"];\n");
}

/* A follower's body is drawn to the body of the joint that has its rows in q. */
static void put_driver(const struct tree *t, const struct body *follower, struct text *out)
{
	for (int i = 0; i < t->joint_count; i++)
		if (t->joints[i].iq == follower->iq)
			text_printf(out, "\tb%d -> b%d [style=dashed, constraint=false];\n", follower->number,
				t->bodies[t->joints[i].body].number);
}

void dot_graph(const struct tree *t, struct text *out)
{
	text_put(out, "digraph robot {\n\tlabel=\"");
	put_label(out, t->robot);
	text_put(out, "\";\n\tlabelloc=t;\n\tnode [shape=box];\n");
	if (!t->floating)
		put_world(t, out);
	for (int k = 0; k < t->body_count; k++) {
		put_node(&t->bodies[k], out);
		if (*t->bodies[k].joint)
			put_edge(t, &t->bodies[k], out);
	}
	for (int i = 0; i < t->mimic_count; i++)
		put_driver(t, &t->bodies[t->mimics[i].body], out);
	text_put(out, "}\n");
}
