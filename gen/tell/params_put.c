#include "tell/params_put.h"

static const char *word(const struct params_choice *p)
{
	return p->is_base ? "base" : "urdf";
}

/* Where the scene says nothing and nothing was chosen, constants are as the URDF has them. */
static int is_told(const struct analysis *a)
{
	return a->params.is_auto || scene_next(&a->scene, SCENE_PARAMS, NULL);
}

void params_put_table(const struct analysis *a, struct text *out)
{
	const struct params_choice *p = &a->params;

	if (!is_told(a))
		return;
	text_printf(out, "\nparameters: %s", word(p));
	if (p->is_auto)
		text_printf(out, ", of urdf with %ld flops and base with %ld", p->flops[0], p->flops[1]);
	text_putc(out, '\n');
}

void params_put_comment(const struct analysis *a, struct text *out)
{
	const struct params_choice *p = &a->params;

	if (p->is_auto)
		text_printf(out, " * Parameters: %s, of urdf with %ld flops and base with %ld.\n", word(p),
			p->flops[0], p->flops[1]);
	if (p->is_base)
		text_put(out,
			" * Base parameters: what is named below is in frames of the text's own, and the inertia of a link is what the outputs\n"
			" * feel of it. What the functions take and write is in the URDF's frames.\n");
	if (p->is_base && a->request.is_plain && !a->options.only)
		text_put(out, " * fpass and bpass are computed by the URDF's constants.\n");
}

void trig_put_comment(const struct analysis *a, struct text *out)
{
	if (a->adjust.has_angles)
		text_put(out,
			" * Sine and cosine are bounded: the scene states a range of every joint's angle. Beyond 1e4 rad they may be NaN;\n"
			" * with --trig accurate they take any angle.\n");
}

void trig_put_table(const struct analysis *a, struct text *out)
{
	if (a->adjust.has_angles)
		text_put(out,
			"\nsine and cosine: bounded, the scene states a range of every joint's angle; with --trig accurate they take any angle\n");
}

void params_put_json(const struct analysis *a, struct text *out)
{
	const struct params_choice *p = &a->params;

	if (!is_told(a))
		return;
	text_printf(out, "  \"params\": \"%s\",\n", word(p));
	if (p->is_auto)
		text_printf(out, "  \"params_flops\": {\"urdf\": %ld, \"base\": %ld},\n", p->flops[0], p->flops[1]);
}
