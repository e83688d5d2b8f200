/* The pipeline, one arrow after the other: URDF -> robot -> tree -> DAG -> plan -> text. */
#define _POSIX_C_SOURCE 200809L
#include "rneagen.h"
#include "tell/dot.h"
#include "tell/effect.h"
#include "emit/emit.h"
#include "base/identifier.h"
#include "tell/info.h"
#include "hold.h"
#include "plan/parts.h"
#include "dynamics/registry.h"
#include "urdf/robot.h"
#include "tell/saving.h"
#include <locale.h>
#include <sha256.h>
#include <string.h>

struct generation {
	struct rneagen_options options;
	struct robot robot;
	struct tree tree;
	struct pass passes[ALGORITHM_COUNT];
	struct part *parts;
	int part_count;
	char hash[SHA256_DIGEST_STRING_LENGTH];
	struct emission emission;
	struct rneagen_result *result;
	struct rneagen_error *error;
};

struct rneagen_options rneagen_options_default(void)
{
	return (struct rneagen_options){.gravity = {0, 0, -9.81}};
}

/* Defaults that depend on other choices, and the name of everything. */
static enum rneagen_code resolve_options(struct generation *g)
{
	struct rneagen_options *o = &g->options;

	o->precision = emit_precision_of(o);
	if (o->strict && o->trig == RNEAGEN_FAST)
		return error_set(g->error, RNEAGEN_USAGE,
			"--strict and --trig fast exclude each other: the sine of a GPU's own unit has other bits; take bounded");
	if (o->strict && o->precision == RNEAGEN_F32X2)
		return error_set(g->error, RNEAGEN_USAGE,
			"--strict and --precision f32x2 exclude each other: its products have other bits where no fused multiply-add is; take f64");
	if (o->bounded && o->target != RNEAGEN_TARGET_C)
		return error_set(g->error, RNEAGEN_USAGE, "--bounded is for target c: take --target c, or an output whose name ends in .c");
	if (o->bounded && o->precision == RNEAGEN_F32X2)
		return error_set(g->error, RNEAGEN_USAGE,
			"--bounded and --precision f32x2 exclude each other: pairs of floats have no bounded function; take f64");
	if (!o->name)
		o->name = identifier_from(g->robot.name, &g->result->arena);
	else if (!identifier_is(o->name))
		return error_set(g->error, RNEAGEN_NAME,
			"--name '%.255s' is no C identifier: letters, digits and underscores, no digit first, no keyword", o->name);
	return o->name ? RNEAGEN_OK : error_memory(g->error);
}

static int pass_count(const struct generation *g)
{
	return algorithms_of(g->tree.request.is_plain);
}

/* What the choices make of each other. */
static enum rneagen_code check_task(const struct generation *g)
{
	if (g->options.bounded && g->tree.request.friction_width.x > 0)
		return error_set(g->error, RNEAGEN_USAGE, "--bounded and --friction exclude each other: quotients have no bounded function");
	return RNEAGEN_OK;
}

/* What the algorithm makes goes again once it is fused, and cut into parts. */
static enum rneagen_code make_pass(struct generation *g, int i, struct dag *raw)
{
	struct arena *a = &g->result->arena;
	struct pass *p = &g->passes[i];

	p->algorithm = ALGORITHMS[i];
	p->algorithm->build(raw, &g->tree);
	dag_close(raw);
	dag_init(&p->dag, a);
	dag_fuse(&p->dag, raw, g->options.strict);
	if (!plan_build(&p->plan, &p->dag, &g->tree, a))
		return error_memory(g->error);
	return i == 0 ? parts_make(&g->parts, &g->part_count, p, raw, &g->tree, &g->options, a, g->error) : RNEAGEN_OK;
}

static enum rneagen_code make_passes(struct generation *g)
{
	for (int i = 0; i < pass_count(g) && !g->error->code; i++) {
		struct arena spare;
		struct dag raw;

		arena_init(&spare, g->options.allocator);
		dag_init(&raw, &spare);
		make_pass(g, i, &raw);
		arena_free(&spare);
	}
	return g->error->code;
}

static void make_dump(struct generation *g, struct text *t)
{
	switch (g->options.dump) {
	case RNEAGEN_DUMP_ROBOT:
		robot_dump(&g->robot, t);
		break;
	case RNEAGEN_DUMP_TREE:
		tree_dump(&g->tree, t);
		break;
	case RNEAGEN_DUMP_DAG:
		dag_dump(&g->passes[0].dag, t);
		break;
	case RNEAGEN_DUMP_PLAN:
		plan_dump(&g->passes[0].plan, t);
		break;
	case RNEAGEN_DUMP_NONE:
		break;
	}
}

static enum rneagen_code make_texts(struct generation *g)
{
	struct rneagen_result *r = g->result;
	int has_source = g->options.dump == RNEAGEN_DUMP_NONE, has_header = has_source && g->options.target == RNEAGEN_TARGET_C;
	struct text source, header, dump;

	text_init(&source, &r->arena);
	text_init(&header, &r->arena);
	text_init(&dump, &r->arena);
	if (has_source)
		emit_source(&g->emission, &source);
	if (has_header)
		emit_declarations(&g->emission, &header);
	make_dump(g, &dump);
	if (source.failed || header.failed || dump.failed)
		return error_memory(g->error);
	r->source = has_source ? text_string(&source) : NULL;
	r->header = has_header ? text_string(&header) : NULL;
	r->dump = has_source ? NULL : text_string(&dump);
	return g->error->code;
}

static enum rneagen_code make_reports(struct generation *g)
{
	struct rneagen_result *r = g->result;
	struct text info, json, dot;

	if (g->options.text_alone)
		return RNEAGEN_OK;
	text_init(&info, &r->arena);
	text_init(&json, &r->arena);
	text_init(&dot, &r->arena);
	info_table(&g->emission, &info);
	info_json(&g->emission, &json);
	dot_graph(&g->tree, &dot);
	if (info.failed || json.failed || dot.failed)
		return error_memory(g->error);
	r->info = text_string(&info);
	r->info_json = text_string(&json);
	r->dot = text_string(&dot);
	return RNEAGEN_OK;
}

/* What reports tell beside the text; the text's head tells of changed constants alone. */
static enum rneagen_code measure(struct generation *g)
{
	const struct pass *p = g->passes;
	struct arena *a = &g->result->arena;
	int is_reported = !g->options.text_alone;

	if ((is_reported || adjust_is_asked(&g->tree.adjust)) && effect_measure(&g->tree, &p->dag, &g->robot, &g->options, a, g->error))
		return g->error->code;
	return is_reported ? saving_measure(&g->tree, &p->plan, &g->robot, &g->options, a, g->error) : RNEAGEN_OK;
}

static enum rneagen_code generate(struct generation *g, const char *urdf, size_t length)
{
	struct arena *a = &g->result->arena;

	if (robot_read(&g->robot, urdf, length, g->options.file, a, g->error) || resolve_options(g) ||
		keep_build(&g->tree, &g->robot, &g->options, a, g->error) || check_task(g) || make_passes(g) || measure(g))
		return g->error->code;
	tree_warn(&g->tree, &g->robot, g->options.file, a);
	if (a->failed)
		return error_memory(g->error);
	SHA256Data((const uint8_t *)urdf, length, g->hash);
	g->result->name = g->options.name;
	g->result->warnings = g->robot.warnings;
	g->result->warning_count = g->robot.warning_count;
	g->emission = (struct emission){.tree = &g->tree,
		.options = &g->options,
		.passes = g->passes,
		.pass_count = pass_count(g),
		.parts = g->parts,
		.part_count = g->part_count,
		.warnings = g->robot.warnings,
		.warning_count = g->robot.warning_count,
		.hash = g->hash,
		.written = arena_alloc(a, EMIT_WRITTEN, sizeof(struct written_number)),
		.arena = a,
		.error = g->error};
	emit_set_precision(&g->emission);
	return make_texts(g) ? g->error->code : make_reports(g);
}

enum rneagen_code rneagen_generate(const char *urdf, size_t length, const struct rneagen_options *options,
	struct rneagen_result *result, struct rneagen_error *error)
{
	struct generation g = {.options = *options, .result = result, .error = error};
	locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0), before; /* numbers are printed with a point everywhere */

	*result = (struct rneagen_result){0};
	*error = (struct rneagen_error){0};
	if (!c)
		return error_memory(error);
	if (!g.options.file)
		g.options.file = "<input>";
	before = uselocale(c);
	arena_init(&result->arena, options->allocator);
	if (generate(&g, urdf, length))
		rneagen_result_free(result);
	uselocale(before);
	freelocale(c);
	return error->code;
}

void rneagen_result_free(struct rneagen_result *result)
{
	arena_free(&result->arena);
	*result = (struct rneagen_result){0};
}
