/* Kernels of large batches: one of its own for each part of the text, beside the one whose grid has all of them along y. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_alone.h"
#include "emit/kernels/emit_tiles.h"
#include "plan/tiles/tiles.h"

enum {
	LEAST_SAMPLES = 132 * 128,  /* of matrices: one warp for each scheduler of an H100 */
	LEAST_TILED = 1 << 19,      /* of rows that move as tiles */
	LEAST_PRODUCT = 132 * 1920, /* of these, with a vjp or a jvp */
	/* where the base's acceleration comes first: 16384 and 262144 samples of floating atlas take 69 and 508 us without tiles,
	   57 and 415 with them (H200) */
	LEAST_BASE = 1 << 14,
	/* where links stand: 16384, 65536 and 262144 samples of accelerations without tiles and with them, f64, atlas welded by both
	   feet 144 129, 334 323, 1144 977, hyq on four feet 30 33, 93 91, 274 258, in f32 atlas 41 43, 110 111, 342 320 (H200) */
	LEAST_CONTACTS = 1 << 16
};

static int least_tiled(const struct emission *e)
{
	if (request_wants_derivative(e->request))
		return LEAST_PRODUCT;
	return emit_division(e) == DIVIDED_BASE_FIRST ? LEAST_BASE : e->request->contact_count ? LEAST_CONTACTS : LEAST_TILED;
}

static int are_long(const struct emission *e)
{
	return e->part_count > 1 && plan_flops(parts_operations(e->parts, e->part_count, &emit_main(e)->plan)) > TILES_COLUMNS;
}

/* Smaller batches leave multiprocessors idle that the one kernel gives other parts. Beyond, the blocks of one part do not share a
   multiprocessor with those of another, and each takes the registers that it needs. In f64 all parts take all registers there
   are: without tiles a million samples lose. Measurements: gen/plan/grid/README.md, Parts of matrices. */
int emit_alone_least(const struct emission *e)
{
	if (!e->target->kernel || e->wide || emit_is_operation(e))
		return 0;
	if (!emit_has_columns(e))
		return emit_has_tiles(e) ? least_tiled(e) : 0;
	return emit_has_tiles(e) || (emit_serves_untiled(e) && are_long(e)) ? LEAST_SAMPLES : 0;
}

int emit_serves_untiled(const struct emission *e)
{
	return emit_has_columns(e) && e->arithmetic->bytes == 4;
}

int emit_alone_is_whole(const struct emission *e)
{
	return !e->part_count && emit_alone_least(e) > 0;
}

/* `rnea_part0`: the whole is one part. */
const char *emit_alone_name(const struct emission *e, int part)
{
	return text_format(e->arena, "%s_part%d", emit_main(e)->algorithm->name, part);
}

void emit_alone(const struct emission *e, struct text *out)
{
	struct text kernels, tiles;

	if (!emit_alone_least(e))
		return;
	text_init(&kernels, e->arena);
	text_init(&tiles, e->arena);
	emit_tiles(e, &tiles);
	for (int i = 0; i < e->part_count && emit_is_apart(e); i++)
		emit_part_small(e, &e->parts[i], out);
	emit_parts_small(e, 1, &kernels);
	for (int i = 0; i < emit_part_places(e); i++)
		emit_alone_kernel(e, i, &kernels);
	const struct slot slots[] = {{"LEAST", emit_int(e, emit_alone_least(e))}, {"BLOCK", emit_int(e, emit_alone_block(e))},
		{"TILES", text_string(&tiles)}, {"KERNELS", text_string(&kernels)}, {"UNLESS_ALONE", EMIT_UNLESS_ALONE}};

	template_expand(out, template_alone_in, slots, sizeof slots / sizeof *slots);
}

/* What a launch of kernels with tiles has beside that of others. */
static const char *if_tiled(const struct emission *e, const char *format)
{
	struct text t;

	text_init(&t, e->arena);
	if (emit_has_tiles(e))
		text_printf(&t, format, e->options->name);
	return text_string(&t);
}

const char *emit_launch_alone(const struct emission *e)
{
	struct text t, kernels;

	text_init(&t, e->arena);
	if (!emit_alone_least(e))
		return text_string(&t);
	text_init(&kernels, e->arena);
	for (int i = 0; i < emit_part_places(e); i++)
		text_printf(&kernels, "%s(const void *)%s_%s_kernel", i ? ", " : "", e->options->name, emit_alone_name(e, i));
	const struct slot slots[] = {{"TILES", if_tiled(e, "\t%s_tiles tiles;\n\n")},
		{"FIT", if_tiled(e, " && %s_make_tiles(&tiles, arguments, count)")},
		{"ADDRESSES", emit_params(e, emit_main(e), PARAMS_ADDRESSES)}, {"MORE", emit_has_tiles(e) ? ", &tiles" : ""},
		{"KERNELS", text_string(&kernels)}, {"COUNT", emit_int(e, emit_part_places(e))}};

	template_expand(&t, template_launch_alone_in, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}
