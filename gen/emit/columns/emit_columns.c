/* The last segments of what a call of one sample or a batch runs, where they are loops over columns (DAG_COLUMN): their bodies,
   the functions that run these, and the calls. One sample's columns stand side by side in an array, a batch's in the matrices. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/columns/emit_columns.h"
#include "emit/columns/emit_way_back.h"
#include "emit/unparse.h"

int emit_is_loop(const struct function *p, int segment)
{
	return segment >= p->segments.count - p->dag.loop_count;
}

static int loop_of(const struct function *p, int segment)
{
	return segment - (p->segments.count - p->dag.loop_count);
}

/* From a sample's elements to those of the next. */
static const char *pitch_text(const struct emission *e, const struct function *p, int loop)
{
	const struct column_run *r = p->dag.runs;
	struct text t;

	while (r < p->dag.runs + p->dag.run_count && r->loop != loop)
		r++;
	text_init(&t, e->arena);
	if (r < p->dag.runs + p->dag.run_count && e->options->layout == RNEAGEN_AOS)
		text_printf(&t, "*%d", p->dag.arguments[r->argument].rows);
	return text_string(&t);
}

/* Parameters that a body of one row does not touch. */
static const char *unused_text(const struct emission *e, const struct plan *lines)
{
	struct touched touched = emit_touched(e, lines);
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, touched.stride ? "" : "\t(void)stride;\n");
	text_put(&t, touched.across[0] ? "" : "\t(void)across;\n");
	text_put(&t, touched.step ? "" : "\t(void)step;\n");
	return text_string(&t);
}

/* Columns of which a compiler makes vectors are as many as fill them, of AVX2 or half as long: one more that is solved by itself
   would take as long as a vector. */
enum { VECTOR_BYTES = 32 };

void emit_columns_macros(const struct emission *e, struct text *out)
{
	int is_f32 = e->arithmetic->bytes == 4, each = VECTOR_BYTES / e->arithmetic->bytes;
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->memory->type}, {"EACH", emit_int(e, each)},
		{"LAST", emit_int(e, each - 1)},
		{"BUILTIN", is_f32 ? "__builtin_ia32_vfmaddps256" : "__builtin_ia32_vfmaddpd512_mask"},
		{"MORE", is_f32 ? "" : ", (unsigned char)-1, 4"}};

	template_expand(out, template_columns_in, slots, sizeof slots / sizeof *slots);
}

/* Lines to come are, or no longer are, of a loop over columns on a processor. */
static void write_columns(struct writer *w, int is_over)
{
	const struct emission *e = w->own.emission;

	w->own.numbers = !is_over ? e->numbers : e->arithmetic->bytes == 4 ? &COLUMNS_F32 : &COLUMNS_F64;
	w->own.calls = w->own.numbers->calls;
	w->own.is_over_columns = is_over;
}

static int is_way(const struct function *p, int loop)
{
	return p->dag.rooms[loop].columns > 0;
}

/* Is it the last loop of its kind? */
static int is_last(const struct function *p, int loop)
{
	return loop == p->dag.loop_count - 1 || is_way(p, loop) != is_way(p, loop + 1);
}

static const char *what_text(const struct function *p, int loop, int is_row)
{
	if (dag_loop_is_last(&p->dag, loop))
		return "d qdd of what another segment has left of a column, in its place";
	if (dag_reduced_rows(&p->dag))
		return "what a column that stands in the place of d qdd leaves for the last segment";
	if (is_way(p, loop))
		return is_row ? "coordinates side by side, from a link to the one before" : "a coordinate, from a link to the one before";
	return is_row ? "d qdd = -M^-1 of the columns of d tau, in their place" : "d qdd = M^-1 of a column that stands in its place";
}

/* What goes from the loop of a limb's columns to that of all. */
static const char *reduced_text(const struct emission *e, const struct function *p, int loop)
{
	struct text t;

	text_init(&t, e->arena);
	if (dag_reduced_rows(&p->dag))
		text_printf(&t, ", %s%s *const reduced", dag_loop_is_last(&p->dag, loop) ? "const " : "", e->memory->type);
	return text_string(&t);
}

/* Statements are made in `spare` before they are indented. */
void emit_columns(const struct emission *e, const struct function *p, int segment, struct writer *w, struct text *spare,
	struct text *out)
{
	const struct segments *s = &p->segments;
	int is_many = p == emit_main(e)->many, is_row = !e->target->kernel && !is_many;
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"T", e->memory->type},
		{"PITCH", pitch_text(e, p, loop_of(p, segment))}, {"LANES", emit_int(e, emit_lanes(e, s))}, {"SEGMENT", emit_int(e, segment)},
		{"COUNT", emit_int(e, s->count)}, {"UNUSED", unused_text(e, &s->plans[segment])},
		{"NUMBER", emit_int(e, loop_of(p, segment))}, {"WHAT", what_text(p, loop_of(p, segment), is_row)},
		{"REDUCED", reduced_text(e, p, loop_of(p, segment))}, {"COLUMNS", emit_int(e, dag_loop_columns(&p->dag, loop_of(p, segment)))}};
	size_t from = out->length, count = sizeof slots / sizeof *slots;
	const char *frame = is_many ? template_segment_columns_many_in
		: is_row ? template_segment_columns_c_in : template_segment_columns_in;
	const char *rest = template_expand_to(out, frame, "BODY", slots, count);

	text_clear(spare);
	if (is_row)
		write_columns(w, 1);
	unparse_within(w, &s->plans[segment]);
	unparse_lines(w, &s->plans[segment], spare);
	if (is_row)
		write_columns(w, 0);
	text_put_indented(out, text_string(spare));
	out->failed |= spare->failed;
	template_expand(out, rest, slots, count);
	if (is_row)
		template_expand(out, template_segment_columns_row_in, slots, count);
	if (is_way(p, loop_of(p, segment)) && is_last(p, loop_of(p, segment)))
		emit_way_functions(e, p, out);
	else if (is_row && is_last(p, loop_of(p, segment)))
		template_expand(out, template_segment_columns_put_in, slots, count);
	fold(out, from);
}

/* ---- calls ---- */

const char *emit_columns_many_declarations(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	text_put(&t, emit_across(e, &p->segments, ACROSS_LANES));
	if (dag_loops_go_back(&p->dag))
		emit_way_many_declaration(e, p, &t);
	return text_string(&t);
}

const char *emit_columns_declaration(const struct emission *e, const struct function *p)
{
	int last = p->dag.loop_count - 1;
	const struct argument *columns = last < 0 ? NULL : &p->dag.arguments[p->dag.rooms[last].argument];
	struct text t;

	text_init(&t, e->arena);
	if (columns && !is_way(p, last))
		text_printf(&t, "\t%s %s[%d];\n", e->memory->type, columns->name, columns->rows);
	if (dag_loops_go_back(&p->dag))
		emit_way_declaration(e, p, &t);
	if (dag_loops_go_back(&p->dag) && !is_way(p, last))
		text_printf(&t, "\tfor (size_t i = 0; i < %d; i++)\n\t\t%s[i] = 0;\n", columns->rows, columns->name);
	return text_string(&t);
}

/* What nobody reads is zero: else it might be anything, and take long. */
static void put_zeros(const struct function *p, int loop, struct text *out)
{
	const struct column_room *r = &p->dag.rooms[loop];
	int columns = dag_loop_columns(&p->dag, loop);

	if (columns % DAG_COLUMNS_UNIT)
		text_printf(out, "\tfor (size_t i = 0; i < %d; i++)\n\t\tfor (size_t l = %d; l < RNEA_COLUMNS_FILL(%d); l++)\n"
			"\t\t\t%s[%d + i*%d + l] = 0;\n", r->rows, columns, columns, p->dag.arguments[r->argument].name, r->first, r->room);
}

void emit_put_address(const char *array, int row, const char *step, struct text *out)
{
	text_put(out, array);
	if (row)
		text_printf(out, " + %d%s%s", row, *step ? "*" : "", step);
}

/* `stride`: "" where it is 1. */
static void put_copies(const struct emission *e, const struct function *p, int loop, const char *indent, const char *stride,
	struct text *out)
{
	const struct column_room *x = &p->dag.rooms[loop];
	const struct argument *arguments = p->dag.arguments;

	for (const struct column_run *r = p->dag.runs; r < p->dag.runs + p->dag.run_count; r++) {
		if (r->loop != loop)
			continue;
		text_printf(out, "%s%s_%s_put_columns(", indent, e->options->name, p->algorithm->name);
		emit_put_address(arguments[x->argument].name, x->first + r->lane, "", out);
		text_printf(out, ", %d, ", x->room);
		emit_put_address(arguments[r->argument].name, r->first, stride, out);
		text_printf(out, ", %d, %d, %d, %s);\n", x->pitch, x->rows, r->count, *stride ? stride : "1");
	}
}

/* Where a sample's rows are together, their elements are side by side; in a batch of soa one comes after the other. */
void emit_columns_calls(const struct emission *e, const struct function *p, int segment, struct text *out)
{
	int loop = loop_of(p, segment);

	if (is_way(p, loop)) {
		emit_way_calls(e, p, loop, out);
		return;
	}
	if (!dag_loops_go_back(&p->dag)) /* else all of it is zero */
		put_zeros(p, loop, out);
	text_printf(out, "\t%s_%s_columns%d(", e->options->name, p->algorithm->name, loop);
	emit_put_address(p->dag.arguments[p->dag.rooms[loop].argument].name, p->dag.rooms[loop].first, "", out);
	text_put(out, ", across);\n");
	if (e->options->layout != RNEAGEN_SOA) {
		put_copies(e, p, loop, "\t", "", out);
		return;
	}
	text_put(out, "\tif (stride == 1) {\n");
	put_copies(e, p, loop, "\t\t", "", out);
	text_put(out, "\t} else {\n");
	put_copies(e, p, loop, "\t\t", "stride", out);
	text_put(out, "\t}\n");
}

/* ---- batches ---- */

static const char *step_of(const struct emission *e, const struct function *p, int argument)
{
	return e->options->layout == RNEAGEN_SOA ? "count" : emit_int(e, p->dag.arguments[argument].rows);
}

/* `x + first`, of a sample. */
static void put_first(const struct emission *e, const struct function *p, int argument, struct text *out)
{
	int is_soa = e->options->layout == RNEAGEN_SOA;

	text_printf(out, "%s + first%s%s", p->dag.arguments[argument].name, is_soa ? "" : "*", is_soa ? "" : step_of(e, p, argument));
}

void emit_columns_many_calls(const struct emission *e, const struct function *p, int segment, struct text *out)
{
	int loop = loop_of(p, segment), is_soa = e->options->layout == RNEAGEN_SOA;

	if (is_way(p, loop)) {
		emit_way_many_calls(e, p, loop, out);
		return;
	}
	for (const struct column_run *r = p->dag.runs; r < p->dag.runs + p->dag.run_count; r++) {
		if (r->loop != loop)
			continue;
		text_printf(out, "\tfor (size_t j = %d; j < %d; j++)\n\t\t%s_%s_columns%d(", r->first, r->first + r->count,
			e->options->name, p->algorithm->name, loop);
		put_first(e, p, r->argument, out);
		text_printf(out, " + j%s, %s, across);\n", is_soa ? "*count" : "", is_soa ? "count" : "1");
	}
}

static int zero_runs(const struct emission *e, const struct function *p, int argument, struct text *out)
{
	return emit_zero_runs(e, &p->dag, p->zeros, p->zero_count, argument, out);
}

void emit_zeros_many(const struct emission *e, const struct function *p, struct text *out)
{
	const char *name = e->options->name, *function = p->algorithm->name;
	int is_soa = e->options->layout == RNEAGEN_SOA;
	struct text tables, runs;

	if (!p->zero_count)
		return;
	text_init(&tables, e->arena);
	for (int i = 0; i < p->dag.argument_count; i++) {
		int count = zero_runs(e, p, i, &runs);

		if (count)
			text_printf(&tables, "static const unsigned %s_%s_%s_zeros[%d][2] = {%s};\n", name, function, p->dag.arguments[i].name,
				count, text_string(&runs));
	}
	const struct slot slots[] = {{"NAME", name}, {"FUNCTION", function}, {"T", e->memory->type},
		{"LANES", emit_int(e, emit_lanes(e, &p->segments))}, {"PLACE", is_soa ? "i*stride + l" : "i + l*stride"},
		{"TABLES", text_string(&tables)}};
	size_t from = out->length;

	template_expand(out, template_segment_zeros_in, slots, sizeof slots / sizeof *slots);
	fold(out, from);
}

void emit_zeros_many_calls(const struct emission *e, const struct function *p, struct text *out)
{
	const char *name = e->options->name, *function = p->algorithm->name;
	struct text runs;

	for (int i = 0; i < p->dag.argument_count && p->zero_count; i++) {
		int count = zero_runs(e, p, i, &runs);

		if (!count)
			continue;
		text_printf(out, "\t%s_%s_zeros(", name, function);
		put_first(e, p, i, out);
		text_printf(out, ", %s, %s_%s_%s_zeros, %d);\n", step_of(e, p, i), name, function, p->dag.arguments[i].name, count);
	}
}
