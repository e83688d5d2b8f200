/* Kernels of large batches in soa: one thread of a block asks for tiles, some rows of its samples each, and a copy engine moves
   them by tensor maps, which the launch makes. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_alone.h"
#include "emit/kernels/slices/emit_slices.h"
#include "emit/kernels/emit_tiles.h"
#include "plan/tiles/tiles.h"

/* Rows of an argument that move, and where they stand in shared memory. */
struct tile_move {
	int argument, row, rows; /* row: the first */
	int place, slot;         /* rows on from where the place of an argument begins */
};

enum { MOVES_LIMIT = DAG_ARGUMENTS * STRETCHES + PERIODS };

/* A vjp's rows for q, qd and qdd, from the places of these. */
static int add_divided(const struct stretches *s, struct tile_move *list)
{
	const struct stretch *own = s->own[s->divided];

	for (int i = 0; i < PERIODS; i++)
		list[i] = (struct tile_move){s->divided, i * s->period + own->first, own->rows, i, emit_divided_slot(s)};
	return PERIODS;
}

/* Returns how many there are, of inputs or of outputs. */
static int find_moves(const struct function *p, int is_output, struct tile_move list[MOVES_LIMIT])
{
	const struct stretches *s = p->tiles;
	int count = 0;

	for (int i = 0; i < p->dag.argument_count; i++) {
		if (p->dag.arguments[i].is_output != is_output)
			continue;
		if (s->period && i == s->divided) {
			count += add_divided(s, list + count);
			continue;
		}
		for (int k = 0; k < STRETCHES; k++)
			if (s->own[i][k].rows)
				list[count++] = (struct tile_move){i, s->own[i][k].first, s->own[i][k].rows, s->place_of[i],
					emit_slot(s, &p->dag, i, k)};
	}
	return count;
}

/* Of all kernels. */
static struct tiles find_tiles(const struct emission *e)
{
	struct tiles t = {.count = 0};

	for (int i = 0; i < emit_part_places(e) && !emit_is_operation(e) && !emit_main(e)->segments.count; i++)
		tiles_add(&t, emit_part(e, i));
	return t;
}

void emit_info_tiles(const struct emission *e, struct text *out)
{
	const struct tiles t = find_tiles(e);

	text_put(out, t.count ? "tiles" : "");
	for (int i = 0; i < t.count; i++)
		text_printf(out, " %d %d", t.list[i].argument, t.list[i].rows);
	text_put(out, t.count ? "\n" : "");
}

/* ---- a kernel ---- */

/* A line for each, and the bytes of a sample. */
static const char *moves_text(const struct emission *e, const struct function *p, int is_output, int *rows)
{
	const struct tiles t = find_tiles(e);
	struct tile_move list[MOVES_LIMIT];
	int count = find_moves(p, is_output, list);
	struct text lines;

	text_init(&lines, e->arena);
	for (const struct tile_move *m = list; m < list + count; m++) {
		text_printf(&lines, "\t\trneagen_tile_%s(%s_slice", is_output ? "out" : "in", p->dag.arguments[m->place].name);
		if (m->slot)
			text_printf(&lines, " + RNEA_PART_BLOCK*%d", m->slot);
		text_printf(&lines, ", &tiles.map[%d], %d);\n", tiles_find(&t, m->argument, m->rows), m->row);
		*rows += m->rows;
	}
	return text_string(&lines);
}

static const char *leave_text(const struct emission *e, const struct function *p)
{
	int rows = 0;
	const struct slot slots[] = {{"TILES", moves_text(e, p, 1, &rows)}};

	return rows ? template_text(e->arena, template_tiles_leave_in, slots, sizeof slots / sizeof *slots) : "";
}

void emit_tiled_kernel(const struct emission *e, const struct tiled_kernel *k, struct text *out)
{
	const struct function *p = k->function;
	const struct slices s = emit_slices(e, p->tiles, "RNEA_PART_BLOCK");
	int rows = 0, are_inputs = tiles_are_inputs(p);
	const struct call call = {.indent = "\t\t",
		.arguments = s.here,
		.q = "q_here",
		.stride = are_inputs ? "count" : "RNEA_PART_BLOCK",
		.q_stride = "RNEA_PART_BLOCK",
		.part = k->part,
		.is_staged = 1,
		.is_tiled = 1,
		.handed = k->handed};
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", k->name}, {"T", e->memory->type},
		{"PARAMS", emit_params(e, emit_main(e), PARAMS_CUDA_RESTRICT)}, {"SPILL", k->spill},
		{"WORDS", emit_int(e, tiles_words(p, e->options))}, {"SLICES", s.slices}, {"TILES", moves_text(e, p, 0, &rows)},
		{"BYTES", emit_int(e, rows * e->memory->bytes)}, {"POINTERS", s.pointers}, {"ZEROS", k->zeros},
		{"CALL", emit_call(e, p, &call)}, {"LEAVE", leave_text(e, p)}, {"DIRECT", k->direct}};

	template_expand(out, template_kernel_tiles_in, slots, sizeof slots / sizeof *slots);
}

/* Do tiles leave, too? */
static int has_outputs(const struct emission *e)
{
	for (int i = 0; i < emit_part_places(e); i++)
		if (emit_part(e, i)->tiles && !tiles_are_inputs(emit_part(e, i)))
			return 1;
	return 0;
}

void emit_tiles(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"COUNT", emit_int(e, find_tiles(e).count)},
		{"OUT", has_outputs(e) ? template_tiles_out_in : ""}};

	if (e->kernels.has_tiles)
		template_expand(out, template_tiles_in, slots, sizeof slots / sizeof *slots);
}

/* `{0, 30, 18}, ...`: the argument, its rows, and those of a tile. */
const char *emit_tiles_launch(const struct emission *e)
{
	const struct tiles t = find_tiles(e);
	struct text list;

	if (!e->kernels.alone_least || !e->kernels.has_tiles)
		return "";
	text_init(&list, e->arena);
	for (int i = 0; i < t.count; i++)
		text_printf(&list, "%s{%d, %d, %d}", i ? ", " : "", t.list[i].argument,
			emit_main(e)->dag.arguments[t.list[i].argument].rows, t.list[i].rows);
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->memory->type},
		{"TYPE", e->memory->bytes == 4 ? "FLOAT32" : "FLOAT64"}, {"LIST", text_string(&list)},
		{"UNTILED", e->kernels.serves_untiled ? "1" : "0"},
		{"WITHOUT", e->kernels.serves_untiled ? "kernels of parts pay too" : "it is faster"}};

	return template_text(e->arena, template_tiles_launch_in, slots, sizeof slots / sizeof *slots);
}
