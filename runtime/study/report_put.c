#include "study/report_put.h"
#include "tell/draw_put.h"
#include "emit/emit.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* The numbers of a row: name, as printf has it, value; NAN is null. */
enum { FIELDS = 13, SAME = 32 };
struct field {
	const char *name;
	double value;
};

static void list_fields(const struct study_row *row, struct field f[FIELDS])
{
	int gpu = row->registers >= 0;
	double none = (double)NAN;
	const struct field fields[FIELDS] = {{"ns_per_sample", row->ns}, {"spread", row->spread},
		{"floor_ratio", row->floor_ratio}, {"error_max", row->errors.max}, {"error_rms", row->errors.rms},
		{"error_terms_max", row->errors.terms}, {"bound_max", row->bound_max},
		{"model_change", row->model_change}, {"registers", gpu ? (double)row->registers : none},
		{"spill_bytes", gpu ? (double)row->spill_bytes : none}, {"parts", gpu ? (double)row->parts : none},
		{"compile_ms", row->compile_ms}};

	memcpy(f, fields, sizeof fields);
	f[FIELDS - 1] = (struct field){"batch", (double)row->batch};
}

/* A number of JSON: what is infinite is the largest there is, what is not known null. */
static void number_text(double x, const char *none, char *text, size_t size)
{
	if (isnan(x))
		snprintf(text, size, "%s", none);
	else if (isinf(x))
		snprintf(text, size, "%.17g", DBL_MAX);
	else
		snprintf(text, size, x == floor(x) && fabs(x) < 1e15 ? "%.0f" : "%.4g", x);
}

/* ---- table ---- */

static void put_cell(FILE *out, int width, int digits, char kind, double x)
{
	char text[40] = "-";

	if (kind == 'e' && !isnan(x))
		snprintf(text, sizeof text, "%.*e", digits, x);
	else if (kind == 'f' && !isnan(x))
		snprintf(text, sizeof text, "%.*f", digits, x);
	else if (!isnan(x))
		snprintf(text, sizeof text, "%.*g", digits, x);
	fprintf(out, " %*s", width, text);
}

/* "all", or the number of a rank; nothing where there is one. */
static const char *rank_text(const struct report *r, size_t rank, char text[24])
{
	snprintf(text, 24, rank == r->ranks ? "all" : "%zu", rank);
	return r->ranks ? text : "";
}

/* The row of a rank; of all, where it is beyond the last. */
static const struct study_row *row_of(const struct report *r, size_t rank, size_t i)
{
	return rank == r->ranks ? &r->rows[i] : &r->each[rank * r->count + i];
}

/* All, then rank after rank: the k-th of these. */
static size_t kth_rank(const struct report *r, size_t k)
{
	return k ? k - 1 : r->ranks;
}

static void put_row(const struct study_row *r, const char *rank, FILE *out)
{
	char same[SAME];

	if (*rank)
		fprintf(out, "%4s ", rank);
	fprintf(out, "%-7s %-9s %-8s %-6s %8zu", study_backend_name(r->backend), emit_precision_name(r->precision),
		emit_trig_name(r->trig), emit_layout_name(r->layout), r->batch);
	put_cell(out, 10, 4, 'g', r->ns);
	put_cell(out, 6, 2, 'f', r->spread);
	put_cell(out, 6, 2, 'f', r->floor_ratio);
	put_cell(out, 9, 1, 'e', r->errors.max);
	put_cell(out, 9, 1, 'e', r->errors.rms);
	put_cell(out, 6, 1, 'f', r->errors.terms);
	put_cell(out, 9, 1, 'e', r->bound_max);
	put_cell(out, 8, 1, 'e', r->model_change);
	put_cell(out, 4, 0, 'f', r->registers >= 0 ? (double)r->registers : (double)NAN);
	put_cell(out, 6, 0, 'f', r->registers >= 0 ? (double)r->spill_bytes : (double)NAN);
	put_cell(out, 8, 0, 'f', r->compile_ms);
	study_same(r, ", ", same, sizeof same);
	fprintf(out, "  %s\n", *same ? same : "-");
}

static void put_inputs(const struct report *r, FILE *out)
{
	const struct analysis *a = &r->study->analysis;
	struct arena arena;
	struct text t;

	arena_init(&arena, NULL);
	text_init(&t, &arena);
	draw_put(a, "\n  ", &t);
	fprintf(out, "drawn: %s\n", t.failed ? "out of memory" : text_string(&t));
	arena_free(&arena);
}

void report_put_table(const struct report *r, FILE *out)
{
	const struct study *s = r->study;
	char rank[24];

	fprintf(out, "robot %s, %s, seed %llu, errors over %zu samples against %s\n", s->analysis.robot.name, r->date,
		s->options->sample.seed, s->options->sample.count, JUDGE_TEXT);
	if (*r->scene)
		fprintf(out, "scene: %s\n", r->scene);
	put_inputs(r, out);
	for (int i = 0; i < s->backend_count; i++)
		fprintf(out, "%s: %s, %s, %s\n", study_backend_name(s->backends[i].backend), s->backends[i].device,
			s->backends[i].target, s->backends[i].compiler);
	if (r->ranks)
		fprintf(out, "%zu ranks at the same time: what a sample takes all of them together, and each\n", r->ranks);
	fprintf(out, "\n%sbackend precision trig     layout    batch  ns/sample spread  floor error max error rms  terms"
		     " bound max    model regs  spill  compile  same code\n",
		r->ranks ? "rank " : "");
	for (size_t i = 0; i < r->count; i++)
		for (size_t k = 0; k <= r->ranks; k++)
			put_row(row_of(r, kth_rank(r, k), i), rank_text(r, kth_rank(r, k), rank), out);
}

/* ---- JSON ---- */

static void put_json_row(const struct study_row *row, const char *rank, struct text *out)
{
	struct field f[FIELDS];
	char number[40], same[SAME];

	list_fields(row, f);
	study_same(row, "\", \"", same, sizeof same);
	text_put(out, "{");
	if (*rank)
		text_printf(out, strcmp(rank, "all") ? "\"rank\": %s, " : "\"rank\": \"%s\", ", rank);
	text_printf(out, "\"backend\": \"%s\", \"precision\": \"%s\", \"trig\": \"%s\", \"layout\": \"%s\"",
		study_backend_name(row->backend), emit_precision_name(row->precision), emit_trig_name(row->trig),
		emit_layout_name(row->layout));
	for (int i = 0; i < FIELDS; i++) {
		number_text(f[i].value, "null", number, sizeof number);
		text_printf(out, ", \"%s\": %s", f[i].name, number);
	}
	text_printf(out, *same ? ", \"same_code\": [\"%s\"]}" : ", \"same_code\": []}", same);
}

static void put_json_backend(const struct study_backend *b, struct text *out)
{
	int driver = bench_driver(b->bench);

	text_printf(out, "{\"backend\": \"%s\", \"device\": ", study_backend_name(b->backend));
	text_put_json(out, b->device);
	text_put(out, ", \"compiler\": ");
	text_put_json(out, b->compiler);
	text_printf(out, ", \"target\": \"%s\", \"driver\": ", b->target);
	if (driver)
		text_printf(out, "\"CUDA %d.%d\", \"threads\": null}", driver / 1000, driver % 1000 / 10);
	else
		text_printf(out, "null, \"threads\": %u}", b->threads);
}

static void put_json_string(struct text *out, const char *name, const char *value)
{
	text_printf(out, "  \"%s\": ", name);
	text_put_json(out, value);
	text_put(out, ",\n");
}

void report_put_json(const struct report *r, struct text *out)
{
	const struct study *s = r->study;
	char rank[24];

	text_put(out, "{\n");
	put_json_string(out, "robot", s->analysis.robot.name);
	put_json_string(out, "command", r->command);
	put_json_string(out, "scene", r->scene);
	put_json_string(out, "date", r->date);
	put_json_string(out, "reference", JUDGE_TEXT);
	text_printf(out, "  \"seed\": %llu,\n  \"samples\": %zu,\n  \"inputs\": [\n    ", s->options->sample.seed,
		s->options->sample.count);
	draw_put_json(&s->analysis, ",\n    ", out);
	text_put(out, "\n  ],\n  \"backends\": [");
	for (int i = 0; i < s->backend_count; i++) {
		text_put(out, i ? ",\n    " : "\n    ");
		put_json_backend(&s->backends[i], out);
	}
	text_put(out, "\n  ],\n  \"rows\": [");
	for (size_t i = 0; i < r->count * (r->ranks + 1); i++) {
		size_t k = kth_rank(r, i % (r->ranks + 1));

		text_put(out, i ? ",\n    " : "\n    ");
		put_json_row(row_of(r, k, i / (r->ranks + 1)), rank_text(r, k, rank), out);
	}
	text_put(out, "\n  ]\n}\n");
}

/* ---- CSV ---- */

static void put_csv_row(const struct study_row *row, const char *rank, FILE *out)
{
	struct field f[FIELDS];
	char number[40], same[SAME];

	list_fields(row, f);
	fprintf(out, "%s%s%s,%s,%s,%s", rank, *rank ? "," : "", study_backend_name(row->backend),
		emit_precision_name(row->precision), emit_trig_name(row->trig), emit_layout_name(row->layout));
	for (int i = 0; i < FIELDS; i++) {
		number_text(f[i].value, "", number, sizeof number);
		fprintf(out, ",%s", number);
	}
	study_same(row, " ", same, sizeof same);
	fprintf(out, ",%s\n", same);
}

void report_put_csv(const struct report *r, FILE *out)
{
	struct field f[FIELDS];
	char rank[24];

	fprintf(out, "%sbackend,precision,trig,layout", r->ranks ? "rank," : "");
	list_fields(&(struct study_row){.registers = -1}, f);
	for (int i = 0; i < FIELDS; i++)
		fprintf(out, ",%s", f[i].name);
	fputs(",same_code\n", out);
	for (size_t i = 0; i < r->count; i++)
		for (size_t k = 0; k <= r->ranks; k++)
			put_csv_row(row_of(r, kth_rank(r, k), i), rank_text(r, kth_rank(r, k), rank), out);
}
