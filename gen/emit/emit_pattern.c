/* Where the elements of a matrix stand in it, for programs that unpack one: in NAME_info, as arrays of row and column, and
   in --info=json. Which of them are always zero. */
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_kernel.h"
#include "plan/stage.h"
#include "plan/transposed.h"
#include "tree/lumps.h"
#include "tree/pattern.h"

struct shape {
	const char *name;
	int rows, cols, is_lower;
	const int *at; /* [rows][cols]: where an element is stored; -1: nowhere */
	int count;
};

/* By the rows of a freed constant: nothing is left out. */
static int shape_by_freed(struct shape *s, const struct emission *e)
{
	int *at = arena_alloc(e->arena, (size_t)s->count, sizeof *at);

	for (int i = 0; at && i < s->count; i++)
		at[i] = i;
	s->at = at;
	return at != NULL;
}

/* 0: no matrix, or the arena has failed. */
static int shape_make(struct shape *s, const struct emission *e, const struct want *w)
{
	const struct request *k = e->request;
	int nv = e->tree->nv, is_lower = want_is(w->kind, IS_SYMMETRIC) && !k->dense;
	struct pattern p;

	*s = (struct shape){.name = w->argument, .rows = nv, .cols = nv, .is_lower = is_lower, .count = w->rows};
	if (want_is(w->kind, OF_FREED)) {
		s->cols = k->freed[w->body].rows;
		return shape_by_freed(s, e);
	}
	if (!request_is_matrix(k, w) || !request_pattern(&p, e->tree, w, k->dense, e->arena))
		return 0;
	s->at = p.row;
	s->rows = p.lines;
	s->cols = p.cols;
	return 1;
}

static void put_info_matrix(const struct shape *s, struct text *out)
{
	text_printf(out, "matrix %s %d %d %s\n", s->name, s->rows, s->cols, s->is_lower ? "lower" : "general");
	for (int i = 0; i < s->rows; i++) {
		text_printf(out, "row %s %d", s->name, i);
		for (int j = 0; j < s->cols; j++)
			if (s->at[i * s->cols + j] >= 0)
				text_printf(out, " %d", j);
		text_putc(out, '\n');
	}
}

void emit_info_matrices(const struct emission *e, struct text *out)
{
	const struct request *k = e->request;
	struct shape s;

	for (int i = 0; i < k->stored_count; i++)
		if (shape_make(&s, e, &k->wants[i]))
			put_info_matrix(&s, out);
}

/* The rows of the elements, or their columns, in the order in which they are stored. */
static void put_numbers(const struct shape *s, int columns, const char *wrap, struct text *out)
{
	int n = 0;

	for (int i = 0; i < s->rows; i++)
		for (int j = 0; j < s->cols; j++)
			if (s->at[i * s->cols + j] >= 0) {
				text_put(out, n == 0 ? "" : n % 24 ? ", " : wrap);
				text_printf(out, "%d", columns ? j : i);
				n++;
			}
}

static void put_declaration(const struct emission *e, const struct shape *s, const char *qualifier, struct text *out)
{
	const char *name = e->options->name;

	text_printf(out, "extern %sconst int %s_%s_row[%d], %s_%s_col[%d];\n", qualifier, name, s->name, s->count, name, s->name,
		s->count);
}

void emit_pattern_declarations(const struct emission *e, struct text *out)
{
	const struct request *k = e->request;
	struct shape s;

	for (int i = 0; i < k->stored_count; i++)
		if (shape_make(&s, e, &k->wants[i])) {
			text_printf(out, "/* Of each element of %s, in the order in which they are stored: row and column%s. */\n", s.name,
				s.is_lower ? "; (j, i) is (i, j)" : "");
			put_declaration(e, &s, "", out);
		}
}

static void put_definitions(const struct emission *e, const struct shape *s, struct text *out)
{
	for (int columns = 0; columns < 2; columns++) {
		text_printf(out, "RNEA_INFO const int %s_%s_%s[] = {\n\t", e->options->name, s->name, columns ? "col" : "row");
		put_numbers(s, columns, ",\n\t", out);
		text_put(out, "};\n");
	}
}

const char *emit_patterns(const struct emission *e)
{
	const struct request *k = e->request;
	struct text t, declarations, definitions;
	struct shape s;

	text_init(&t, e->arena);
	text_init(&declarations, e->arena);
	text_init(&definitions, e->arena);
	for (int i = 0; i < k->stored_count && e->target->patterns; i++)
		if (shape_make(&s, e, &k->wants[i])) {
			put_declaration(e, &s, "RNEA_INFO ", &declarations);
			put_definitions(e, &s, &definitions);
		}
	const struct slot slots[] = {{"DECLARATIONS", text_string(&declarations)}, {"DEFINITIONS", text_string(&definitions)}};
	if (definitions.length)
		template_expand(&t, e->target->patterns, slots, sizeof slots / sizeof *slots);
	return text_string(&t);
}

void emit_pattern_json(const struct emission *e, struct text *out)
{
	const struct request *k = e->request;
	struct shape s;
	int count = 0;

	for (int i = 0; i < k->stored_count; i++) {
		if (!shape_make(&s, e, &k->wants[i]))
			continue;
		text_put(out, count++ ? ",\n    " : "  \"matrices\": {\n    ");
		text_printf(out, "\"%s\": {\"shape\": [%d, %d], \"lower\": %s,\n      \"row\": [", s.name, s.rows, s.cols,
			s.is_lower ? "true" : "false");
		put_numbers(&s, 0, ",\n        ", out);
		text_put(out, "],\n      \"col\": [");
		put_numbers(&s, 1, ",\n        ", out);
		text_put(out, "]}");
	}
	text_put(out, count ? "\n  },\n" : "");
	out->failed |= e->arena->failed;
}

/* ---- columns of the regressor ---- */

void emit_info_parameters(const struct emission *e, struct text *out)
{
	struct lumps x;

	if (!request_wants(e->request, WANT_REGRESSOR) || !lumps_make(&x, e->tree, e->arena))
		return;
	for (int i = 0; i < x.count; i++) {
		text_printf(out, "parameters regressor %d ", LUMP_PARAMETERS * i);
		emit_info_name(e->tree->bodies[x.body[i]].link, out);
	}
}

static void put_lump(const struct emission *e, const struct pattern *p, int lump, const char *link, struct text *out)
{
	text_printf(out, "\n *     %d..%d, \"", LUMP_PARAMETERS * lump, LUMP_PARAMETERS * (lump + 1) - 1);
	text_put_comment(out, link);
	text_put(out, "\":");
	for (int i = 0; i < e->tree->nv; i++)
		if (p->row[i * p->cols + LUMP_PARAMETERS * lump] >= 0)
			text_printf(out, " %d", i);
}

void emit_regressor_legend(const struct emission *e, struct text *out)
{
	struct lumps x;
	struct pattern p;

	if (!lumps_make(&x, e->tree, e->arena) || !pattern_lumps(&p, e->tree, 0, e->arena))
		return;
	text_put(out, ": row by row, the torque for a unit of each of m hx hy hz Ixx Ixy Ixz Iyy Iyz Izz\n"
		      " *     of a link and what is fixed to it, about the link's origin, in its frame.\n"
		      " *     (Pinocchio: m hx hy hz Ixx Ixy Iyy Ixz Iyz Izz.) Columns, the link, and the rows that feel it:");
	for (int i = 0; i < x.count; i++)
		put_lump(e, &p, i, e->tree->bodies[x.body[i]].link, out);
}

/* The outputs that a product is of, with their rows; of the torques alone, or of qdd, it is known. */
static void put_product(const struct request *k, const struct product *p, struct text *out)
{
	for (int i = 0; i < p->count && !request_is_plain_product(k, p); i++) {
		text_put(out, i ? ", " : "of ");
		text_put_comment(out, k->wants[p->of[i]].word);
		text_printf(out, "[%d]", k->wants[p->of[i]].rows);
	}
}

void emit_product_legend(const struct request *k, const struct argument *a, struct text *out)
{
	if (a->role == ROLE_TANGENT) {
		text_put(out, *a->of ? "along " : "along q, along qd, along ");
		text_put_comment(out, *a->of ? a->of : k->is_forward ? "tau" : "qdd");
	}
	if (a->role == ROLE_COTANGENT)
		put_product(k, &k->vjp, out);
	if (a->role == ROLE_JVP)
		put_product(k, &k->jvp, out);
}

/* ---- elements that are always zero ---- */

/* Fewer are stored one by one. */
enum { FEWEST_ZEROS = 64 };

static int count_zeros(const struct dag *d)
{
	int zeros = 0;

	for (size_t i = 0; i < d->output_count; i++)
		zeros += output_is_zero(d, &d->outputs[i]);
	return zeros;
}

/* What the kernel stores that has the zeros: of a relay the second, which has those that the third reads. */
static const struct dag *stored_by(const struct emission *e)
{
	return e->relay ? &e->relay->between.dag : &emit_main(e)->dag;
}

int emit_has_zeros(const struct emission *e, const struct function *p)
{
	int is_further = (p > emit_main(e) && p < e->functions + e->function_count) || emit_is_relays(e, p);

	/* parts that share nothing have no loops, and store theirs one by one */
	return emit_is_streamed(e) && !is_further && !emit_is_apart(e) && !emit_main(e)->segments.count &&
		count_zeros(stored_by(e)) >= FEWEST_ZEROS;
}

int emit_is_zero_store(const struct plan *p, const struct line *l)
{
	return l->kind == LINE_STORE && output_is_zero(p->dag, &p->dag->outputs[l->index]);
}

static int has_zero_stores(const struct plan *p)
{
	for (size_t i = 0; i < p->line_count; i++)
		if (emit_is_zero_store(p, &p->lines[i]))
			return 1;
	return 0;
}

const char *emit_zeros_unless(const struct emission *e, const struct function *p, int is_beside)
{
	if (p->windows.slots && !is_beside)
		return has_zero_stores(&p->plan) ? "!RNEA_WINDOW /* else these zeros leave with their neighbours */" : NULL;
	if (!emit_has_zeros(e, p))
		return NULL;
	return text_format(e->arena, "!defined %s /* a kernel stores these zeros in a loop */", e->target->kernel->compiler);
}

int emit_run_end(const unsigned char *mask, int rows, int first)
{
	int end = first + 1;

	while (end < rows && mask[end] == mask[first])
		end++;
	return end;
}

/* `{10, 7}, {18, 2}`: from a first row on, so many. */
static int put_runs(const unsigned char *zero, int rows, struct text *out)
{
	int runs = 0;

	for (int i = 0, end; i < rows; i = end) {
		end = emit_run_end(zero, rows, i);
		if (zero[i])
			text_printf(out, "%s{%d, %d}", runs++ ? ", " : "", i, end - i);
	}
	return runs;
}

static unsigned char *zero_rows(const struct emission *e, const struct dag *d, const struct output *outputs, size_t count,
	int argument)
{
	unsigned char *zero = arena_alloc(e->arena, (size_t)d->arguments[argument].rows + 1, 1);

	for (size_t i = 0; i < count && zero; i++)
		if (outputs[i].argument == argument && output_is_zero(d, &outputs[i]))
			zero[outputs[i].row] = 1;
	return zero;
}

int emit_zero_runs(const struct emission *e, const struct dag *d, const struct output *outputs, size_t count, int argument,
	struct text *out)
{
	const unsigned char *zero = zero_rows(e, d, outputs, count, argument);

	text_init(out, e->arena);
	return zero ? put_runs(zero, d->arguments[argument].rows, out) : 0;
}

static int zero_runs(const struct emission *e, int argument, struct text *out)
{
	const struct dag *d = stored_by(e);

	return emit_zero_runs(e, d, d->outputs, d->output_count, argument, out);
}

static int *count_kept(const struct emission *e)
{
	const struct dag *d = stored_by(e);
	int *kept = arena_alloc(e->arena, (size_t)d->argument_count + 1, sizeof *kept);

	for (int i = 0; i < d->argument_count && kept; i++)
		kept[i] = d->arguments[i].rows;
	for (size_t i = 0; i < d->output_count && kept; i++)
		kept[d->outputs[i].argument] -= output_is_zero(d, &d->outputs[i]);
	return kept;
}

/* Not a relay's zeros, which the third kernel reads, nor where the tables for that take more room than the zeros. */
const int *emit_kept_rows(const struct emission *e)
{
	const struct dag *d = stored_by(e);
	const int *kept;

	if (!e->is_transposed || e->relay || !emit_has_zeros(e, emit_main(e)))
		return NULL;
	kept = count_kept(e);
	return transposed_of(d, kept, e->options).samples >= transposed_of(d, NULL, e->options).samples ? kept : NULL;
}

const unsigned char *emit_zero_rows(const struct emission *e, int argument)
{
	const struct dag *d = stored_by(e);

	return zero_rows(e, d, d->outputs, d->output_count, argument);
}

/* Do loops of kernels write the zeros? */
static int has_zero_loops(const struct emission *e)
{
	return emit_has_zeros(e, emit_main(e)) && !emit_kept_rows(e);
}

void emit_zeros(const struct emission *e, struct text *out)
{
	const struct dag *d = &emit_main(e)->dag;
	struct text tables, runs;

	if (!has_zero_loops(e))
		return;
	text_init(&tables, e->arena);
	for (int i = 0; i < d->argument_count; i++) {
		int count = zero_runs(e, i, &runs);
		const struct slot slots[] = {{"NAME", e->options->name}, {"ARRAY", d->arguments[i].name},
			{"COUNT", emit_int(e, count)}, {"RUNS", text_string(&runs)}};

		if (count)
			template_expand(&tables, template_zeros_table_in, slots, sizeof slots / sizeof *slots);
	}
	const struct slot slots[] = {{"T", e->memory->type}, {"TABLES", text_string(&tables)}};

	template_expand(out, e->target->kernel->zeros, slots, sizeof slots / sizeof *slots);
}

const char *emit_zero_loops(const struct emission *e, const char *first, const char *step)
{
	const struct dag *d = &emit_main(e)->dag;
	struct text loops, runs, place;

	text_init(&loops, e->arena);
	if (!has_zero_loops(e))
		return text_string(&loops);
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		int count = zero_runs(e, i, &runs);

		text_init(&place, e->arena);
		emit_put_at_sample(e, a, &place);
		const struct slot slots[] = {{"NAME", e->options->name}, {"ARRAY", a->name},
			{"PLACE", text_string(&place)}, {"STRIDE", emit_stride(e)}, {"COUNT", emit_int(e, count)},
			{"FIRST", first}, {"STEP", step}};

		if (count)
			template_expand(&loops, template_zeros_loop_in, slots, sizeof slots / sizeof *slots);
	}
	return text_string(&loops);
}
