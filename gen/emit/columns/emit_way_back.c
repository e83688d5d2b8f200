/* Loops over coordinates on their way back to the base: their array, what puts elements into the matrices, and the calls. One
   sample's coordinates stand side by side, a row after the other; those of a block one after the other, each with its rows, and
   its samples side by side. */
#include "base/template.h"
#include "emit/columns/emit_columns.h"
#include "emit/columns/emit_way_back.h"

static const struct column_room *room_of(const struct function *p, int loop)
{
	return &p->dag.rooms[loop];
}

/* Samples that stand side by side. */
static int samples_of(const struct emission *e, const struct function *p)
{
	return room_of(p, 0)->is_batch ? emit_lanes(e, &p->segments) : 1;
}

/* ---- the array ---- */

/* Vectors reach over places of coordinates that have not set out: what they find there is finite. */
void emit_way_declaration(const struct emission *e, const struct function *p, struct text *out)
{
	const struct column_room *r = room_of(p, 0);

	text_printf(out, "\t%s carried[%d];\n", e->memory->type, p->dag.arguments[r->argument].rows);
	text_printf(out, "\n\tfor (size_t i = 0; i < %d; i++)\n\t\tcarried[i] = 0;\n", r->rows * r->room);
}

void emit_way_many_declaration(const struct emission *e, const struct function *p, struct text *out)
{
	text_printf(out, "\n\tRNEA_ALIGNED %s carried[%d];", e->memory->type,
		p->dag.arguments[room_of(p, 0)->argument].rows * samples_of(e, p));
}

/* ---- functions ---- */

/* From a sample's rows to those of the next; both matrices have as many. */
static const char *pitch_text(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	if (room_of(p, 0)->is_batch && e->options->layout == RNEAGEN_AOS)
		text_printf(&t, "*%d", p->dag.arguments[p->dag.puts[0].argument].rows);
	return text_string(&t);
}

static const char *row_begins(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	for (int i = 0; i < p->dag.begin_count; i++)
		text_printf(&t, "%s%d", i ? ", " : "", p->dag.begins[i]);
	return text_string(&t);
}

void emit_way_functions(const struct emission *e, const struct function *p, struct text *out)
{
	const struct column_room *r = room_of(p, 0);
	int rows = p->dag.arguments[r->argument].rows / r->room, samples = samples_of(e, p);
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"T", e->memory->type},
		{"BEGINS", row_begins(e, p)}, {"WHOSE", r->is_batch ? "several samples" : "one sample"}, {"LANES", emit_int(e, samples)},
		{"PITCH", pitch_text(e, p)}, {"STEP", emit_int(e, r->is_batch ? r->room * samples : 1)},
		{"CARRIED", emit_int(e, r->rows)}, {"ROOM", emit_int(e, r->room)}, {"FROM", emit_int(e, rows - r->rows)}};

	template_expand(out, template_way_back_in, slots, sizeof slots / sizeof *slots);
	if (!r->is_batch)
		template_expand(out, template_way_back_start_in, slots, sizeof slots / sizeof *slots);
}

/* ---- calls ---- */

/* Where a row of the first of a loop's coordinates stands. */
static int place_of(const struct emission *e, const struct function *p, int loop, int row)
{
	const struct column_room *r = room_of(p, loop);

	return r->is_batch ? (r->first * r->room + row) * samples_of(e, p) : row * r->room + r->first;
}

/* A matrix, of the first of a block's samples. */
static const char *matrix_text(const struct emission *e, const struct function *p, const struct argument *to)
{
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, to->name);
	if (room_of(p, 0)->is_batch)
		text_put(&t, " + first");
	if (room_of(p, 0)->is_batch && e->options->layout == RNEAGEN_AOS)
		text_printf(&t, "*%d", to->rows);
	return text_string(&t);
}

/* What a loop leaves for the matrices; `step`: from a row of these to the next, "" where it is 1. */
static void put_puts(const struct emission *e, const struct function *p, int loop, const char *indent, const char *step,
	struct text *out)
{
	const struct column_room *r = room_of(p, loop);
	const char *name = e->options->name, *function = p->algorithm->name;

	if (p->dag.arguments[p->dag.puts[0].argument].per_batch) /* columns that are solved then, side by side */
		step = "";
	for (const struct column_put *x = p->dag.puts; x < p->dag.puts + p->dag.put_count; x++) {
		if (x->loop != loop)
			continue;
		text_printf(out, "%s%s_%s_put(", indent, name, function);
		emit_put_address("carried", place_of(e, p, loop, x->row), "", out);
		if (x->is_down)
			text_printf(out, ", %s_%s_begins + %d, ", name, function, r->first);
		else
			text_put(out, ", NULL, ");
		emit_put_address(matrix_text(e, p, &p->dag.arguments[x->argument]), x->first, step, out);
		text_printf(out, ", %s, %d);\n", *step ? step : "1", r->columns);
	}
}

void emit_way_calls(const struct emission *e, const struct function *p, int loop, struct text *out)
{
	const struct column_room *r = room_of(p, loop);
	const char *name = e->options->name, *function = p->algorithm->name;

	text_printf(out, "\t%s_%s_set_out(carried + %d, %d);\n", name, function, r->first, r->own);
	text_printf(out, "\t%s_%s_columns%d(carried + %d, across);\n", name, function, loop, r->first);
	put_puts(e, p, loop, "\t", e->options->layout == RNEAGEN_SOA ? "stride" : "", out);
}

void emit_way_many_calls(const struct emission *e, const struct function *p, int loop, struct text *out)
{
	const struct column_room *r = room_of(p, loop);
	int samples = samples_of(e, p);

	text_printf(out, "\tfor (size_t j = %d; j < %d; j++)\n\t\t%s_%s_columns%d(carried + j*%d, %d, across);\n", r->first,
		r->first + r->columns, e->options->name, p->algorithm->name, loop, r->room * samples, samples);
	put_puts(e, p, loop, "\t", e->options->layout == RNEAGEN_SOA ? "count" : "", out);
}
