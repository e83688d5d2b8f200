/* Headers: the joints' names and limits, by the rows of q and of qd. */
#include "emit/emit.h"
#include "base/template.h"
#include <math.h>
#include <string.h>

/* What stands at a row of a joint; NULL as a joint: the floating base. */
typedef void put_row(const struct emission *e, const char *name, const struct joint *j, struct text *out);

static void put_joint_name(const struct emission *e, const char *name, const struct joint *j, struct text *out)
{
	(void)e;
	(void)j;
	text_putc(out, '"');
	emit_literal(name, strlen(name), out);
	text_putc(out, '"');
}

/* A limit that the URDF states; none is beyond every number. */
static void put_limit(const struct emission *e, int is_stated, double limit, int is_lower, struct text *out)
{
	if (is_stated && isfinite((double)e->memory->round(limit)))
		emit_number(e, e->memory, limit, out);
	else
		text_printf(out, "%sHUGE_VAL%s", is_lower ? "-" : "", e->memory->upper);
}

static void put_lower(const struct emission *e, const char *name, const struct joint *j, struct text *out)
{
	(void)name;
	put_limit(e, j && j->has_limits, j ? j->lower : 0, 1, out);
}

static void put_upper(const struct emission *e, const char *name, const struct joint *j, struct text *out)
{
	(void)name;
	put_limit(e, j && j->has_limits, j ? j->upper : 0, 0, out);
}

static void put_velocity(const struct emission *e, const char *name, const struct joint *j, struct text *out)
{
	(void)name;
	put_limit(e, j && j->has_rates, j ? j->velocity : 0, 0, out);
}

static void put_effort(const struct emission *e, const char *name, const struct joint *j, struct text *out)
{
	(void)name;
	put_limit(e, j && j->has_rates, j ? j->effort : 0, 0, out);
}

/* One entry a row of q, or of qd. */
static const char *rows(const struct emission *e, int is_q, put_row *put)
{
	const struct tree *t = e->tree;
	struct text out;
	int row = 0;

	text_init(&out, e->arena);
	for (int i = 0; i < t->joint_count; i++) {
		const struct joint *j = tree_joint_of(t->source, t, i);

		for (int k = 0; k < (is_q ? t->joints[i].nq : t->joints[i].nv); k++) {
			text_put(&out, row++ ? ", " : "");
			put(e, t->joints[i].name, j, &out);
		}
	}
	return text_string(&out);
}

const char *emit_joints(const struct emission *e)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->memory->type}, {"Q_JOINT", rows(e, 1, put_joint_name)},
		{"QD_JOINT", rows(e, 0, put_joint_name)}, {"Q_MIN", rows(e, 1, put_lower)}, {"Q_MAX", rows(e, 1, put_upper)},
		{"QD_MAX", rows(e, 0, put_velocity)}, {"TAU_MAX", rows(e, 0, put_effort)}};

	return emit_is_operation(e) ? "" : template_text(e->arena, template_joints_in, slots, sizeof slots / sizeof *slots);
}
