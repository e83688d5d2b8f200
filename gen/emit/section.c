/* The comment at which a part of the algorithm begins. */
#include "emit/emit.h"

/* Of sections that are about no body. */
static const char *const SECTION_TITLES[SECTION_COUNT] = {[SECTION_END] = "torques of joints that others mimic",
	[SECTION_FREED] = "what the scene frees", [SECTION_TOTALS] = "power and energies",
	[SECTION_BIAS] = "from here on without accelerations: torques of gravity and velocities",
	[SECTION_GRAVITY] = "from here on at rest: torques of gravity",
	[SECTION_PRODUCTS] = "derivatives times vectors, and by what is freed"};

/* "out to link 2 "lower" (fpass)"; "back from link 2 "lower" to link 1 (bpass): torque of "elbow"" */
void emit_section(const struct emission *e, const struct pass *pass, const struct section *s, struct text *out)
{
	const struct body *k = &e->tree->bodies[s->body];

	if (emit_is_operation(e))
		return;
	if (SECTION_TITLES[s->kind]) {
		text_printf(out, "\n\t/* ---- %s ---- */\n", SECTION_TITLES[s->kind]);
		return;
	}
	if (s->kind == SECTION_BY) {
		text_put(out, "\n\t/* ---- derivatives by \"");
		text_put_comment(out, *k->joint ? k->joint : "base");
		text_put(out, "\" ---- */\n");
		return;
	}
	text_printf(out, "\n\t/* ---- %s link %d \"", s->kind == SECTION_OUT ? "out to" : "back from", k->number);
	text_put_comment(out, k->link);
	text_putc(out, '"');
	if (s->kind == SECTION_OUT) {
		text_put(out, dag_find_role(&pass->dag, ROLE_BODY_WRENCHES, 0) >= 0 ? "" : " (fpass)");
	} else {
		if (k->parent < 0)
			text_put(out, " to the world (bpass)");
		else
			text_printf(out, " to link %d (bpass)", e->tree->bodies[k->parent].number);
		if (*k->joint) {
			text_put(out, k->type == JOINT_FIXED ? ": held at \"" : k->follower ? ": share of the driver of \"" : ": torque of \"");
			text_put_comment(out, k->joint);
			text_putc(out, '"');
		}
	}
	text_put(out, " ---- */\n");
}
