/* Kernels of large batches: one of its own for each part of the text, beside the one whose grid has all of them along y. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_alone.h"
#include "emit/kernels/emit_tiles.h"

int emit_alone_is_whole(const struct emission *e)
{
	return !e->part_count && e->kernels.alone_least > 0;
}

/* `rnea_part0`: the whole is one part. */
const char *emit_alone_name(const struct emission *e, int part)
{
	return text_format(e->arena, "%s_part%d", emit_main(e)->algorithm->name, part);
}

void emit_alone(const struct emission *e, struct text *out)
{
	struct text kernels, tiles;

	if (!e->kernels.alone_least)
		return;
	text_init(&kernels, e->arena);
	text_init(&tiles, e->arena);
	emit_tiles(e, &tiles);
	for (int i = 0; i < e->part_count && emit_is_apart(e); i++)
		emit_part_small(e, &e->parts[i], out);
	emit_parts_small(e, 1, &kernels);
	for (int i = 0; i < emit_part_places(e); i++)
		emit_alone_kernel(e, i, &kernels);
	const struct slot slots[] = {{"LEAST", emit_int(e, e->kernels.alone_least)}, {"BLOCK", emit_int(e, e->kernels.alone_block)},
		{"TILES", text_string(&tiles)}, {"KERNELS", text_string(&kernels)}, {"UNLESS_ALONE", EMIT_UNLESS_ALONE}};

	template_expand(out, template_alone_in, slots, sizeof slots / sizeof *slots);
}

/* What a launch of kernels with tiles has beside that of others. */
static const char *if_tiled(const struct emission *e, const char *format)
{
	struct text t;

	text_init(&t, e->arena);
	if (e->kernels.has_tiles)
		text_printf(&t, format, e->options->name);
	return text_string(&t);
}

const char *emit_launch_alone(const struct emission *e)
{
	struct text t, kernels;

	text_init(&t, e->arena);
	if (!e->kernels.alone_least)
		return text_string(&t);
	text_init(&kernels, e->arena);
	for (int i = 0; i < emit_part_places(e); i++)
		text_printf(&kernels, "%s(const void *)%s_%s_kernel", i ? ", " : "", e->options->name, emit_alone_name(e, i));
	const struct slot slots[] = {{"TILES", if_tiled(e, "\t%s_tiles tiles;\n\n")},
		{"FIT", if_tiled(e, " && %s_make_tiles(&tiles, arguments, count)")},
		{"ADDRESSES", emit_params(e, emit_main(e), PARAMS_ADDRESSES)}, {"MORE", e->kernels.has_tiles ? ", &tiles" : ""},
		{"KERNELS", text_string(&kernels)}, {"COUNT", emit_int(e, emit_part_places(e))}};

	template_expand(&t, template_launch_alone_in, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}
