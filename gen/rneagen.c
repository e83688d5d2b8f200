/* From the text of a URDF to the text of a program: every pass, in order, is a line of PASSES. */
#define _POSIX_C_SOURCE 200809L
#include "rneagen.h"
#include "base/template.h"
#include "choices.h"
#include "emit/emit.h"
#include "passes/plans.h"
#include "tell/dot.h"
#include "tell/dump.h"
#include "tell/effect.h"
#include "tell/info.h"
#include "tell/params_put.h"
#include "tell/saving.h"
#include "tell/scene_put.h"
#include <locale.h>
#include <sha256.h>
#include <string.h>

struct generation {
	struct analysis analysis; /* up to the fused DAG */
	struct dag raw[ALGORITHM_COUNT]; /* of the halves, until they are fused; the analysis has that of the whole */
	struct arena raw_arena;
	struct plans plans; /* beyond it */
	char hash[SHA256_DIGEST_STRING_LENGTH];
	struct emission emission;
	struct info info;
	struct rneagen_result *result;
};

struct rneagen_options rneagen_options_default(void)
{
	return (struct rneagen_options){.trig = RNEAGEN_TRIG_AUTO, .gravity = {0, 0, -9.81}};
}

/* ---- passes beyond those of the analysis ---- */

static enum rneagen_code options_resolve(struct generation *g)
{
	return choices_resolve(&g->analysis);
}

static enum rneagen_code options_check(struct generation *g)
{
	return choices_check(&g->analysis);
}

/* The halves of the algorithm go with the whole of it, not with a scene's choice of inputs and outputs. */
static enum rneagen_code dag_build_all(struct generation *g)
{
	struct analysis *a = &g->analysis;
	const struct algorithm *algorithms[ALGORITHM_COUNT];
	int count = algorithms_for(&a->request, algorithms);

	g->plans.function_count = a->options.only ? 1 : count;
	for (int i = 0; i < g->plans.function_count; i++)
		g->plans.functions[i].algorithm = algorithms[i];
	if (pass_dag_build(a))
		return a->error->code;
	arena_init(&g->raw_arena, &a->arena->allocator);
	for (int i = 1; i < g->plans.function_count; i++) {
		dag_init(&g->raw[i], &g->raw_arena);
		algorithms[i]->build(&g->raw[i], &a->stated, &a->request); /* they write by the URDF's frames */
		dag_close(&g->raw[i]);
		if (g->raw[i].failed)
			error_memory(a->error);
	}
	return a->error->code;
}

static enum rneagen_code dag_fuse_all(struct generation *g)
{
	struct analysis *a = &g->analysis;

	if (pass_dag_fuse(a))
		return a->error->code;
	g->plans.functions[0].dag = a->dag;
	for (int i = 1; i < g->plans.function_count; i++) {
		dag_init(&g->plans.functions[i].dag, a->arena);
		dag_fuse(&g->plans.functions[i].dag, &g->raw[i], a->options.strict);
	}
	arena_free(&g->raw_arena);
	return RNEAGEN_OK;
}

static enum rneagen_code warn(struct generation *g)
{
	g->result->name = g->analysis.options.name;
	if (analysis_warn(&g->analysis))
		return g->analysis.error->code;
	g->result->warnings = g->analysis.robot.warnings;
	g->result->warning_count = g->analysis.robot.warning_count;
	return RNEAGEN_OK;
}

/* What changed constants change, which the head of the text tells too; what choices save, for --info alone. */
static enum rneagen_code measure(struct generation *g)
{
	struct analysis *a = &g->analysis;
	int is_told = (a->options.tell & (RNEAGEN_TELL_INFO | RNEAGEN_TELL_JSON)) != 0;

	if ((is_told || adjust_is_asked(&a->adjust)) && effect_measure(&g->info.effects, a))
		return a->error->code;
	return is_told ? saving_measure(&g->info.savings, a, &g->plans.functions[0].plan) : RNEAGEN_OK;
}

static struct emission new_emission(struct generation *g, const char *told)
{
	const struct plans *p = &g->plans;
	struct analysis *a = &g->analysis;

	return (struct emission){.tree = &a->tree, .request = &a->request, .scene = &a->scene, .adjust = &a->adjust,
		.options = &a->options, .functions = p->functions, .function_count = p->function_count, .parts = p->parts,
		.part_count = p->part_count, .relay = p->relay, .rounds = p->rounds, .is_transposed = p->is_transposed, .kernels = p->kernels,
		.warnings = g->result->warnings, .warning_count = g->result->warning_count,
		.told = told, .hash = g->hash,
		.written = arena_alloc(a->arena, EMIT_WRITTEN, sizeof(struct written_number)),
		.arena = a->arena, .error = a->error};
}

static enum rneagen_code emit(struct generation *g)
{
	struct analysis *a = &g->analysis;
	int is_dumped = a->options.dump != RNEAGEN_DUMP_NONE, has_header = !is_dumped && target_type_of(a->options.target)->declarations;
	struct text told, source, header;

	text_init(&told, a->arena);
	text_init(&source, a->arena);
	text_init(&header, a->arena);
	scene_put_comment(&a->scene, &a->outcome, &told);
	params_put_comment(a, &told);
	trig_put_comment(a, &told);
	effect_put_comment(&g->info.effects, a, &told);
	SHA256Data((const uint8_t *)a->urdf, a->length, g->hash);
	g->emission = new_emission(g, text_string(&told));
	emit_set_precision(&g->emission);
	if (!is_dumped)
		emit_source(&g->emission, &source);
	if (has_header)
		emit_declarations(&g->emission, &header);
	if (told.failed || source.failed || header.failed || a->arena->failed)
		return template_error(a->error, a->arena);
	g->result->source = is_dumped ? NULL : text_string(&source);
	g->result->header = has_header ? text_string(&header) : NULL;
	return a->error->code;
}

static enum rneagen_code tell(struct generation *g)
{
	struct analysis *a = &g->analysis;
	struct rneagen_result *r = g->result;
	struct text info, json, dot;

	text_init(&info, a->arena);
	text_init(&json, a->arena);
	text_init(&dot, a->arena);
	g->info.analysis = a;
	g->info.emission = &g->emission;
	if (a->options.tell & RNEAGEN_TELL_INFO)
		info_table(&g->info, &info);
	if (a->options.tell & RNEAGEN_TELL_JSON)
		info_json(&g->info, &json);
	if (a->options.tell & RNEAGEN_TELL_DOT)
		dot_graph(&a->stated, &dot);
	if (info.failed || json.failed || dot.failed || a->arena->failed)
		return error_memory(a->error);
	r->info = info.length ? text_string(&info) : NULL;
	r->info_json = json.length ? text_string(&json) : NULL;
	r->dot = dot.length ? text_string(&dot) : NULL;
	return RNEAGEN_OK;
}

/* ---- all of them ---- */

/* A pass is the analysis's, the plans', or the generation's. */
struct step {
	const char *name, *makes;
	enum rneagen_code (*analyse)(struct analysis *a);
	enum rneagen_code (*plan)(struct plans *p, struct analysis *a);
	enum rneagen_code (*generate)(struct generation *g);
	const char *word; /* of --dump; NULL: there is nothing to print */
	enum rneagen_dump dump;
	dump_function *put;
};

#define ANALYSIS_PASS(pass) pass_##pass, NULL, NULL
#define PLANS_PASS(pass) NULL, plans_##pass, NULL
#define TEXT_PASS(pass) NULL, NULL, pass
#define DUMPED(word, name) #word, RNEAGEN_DUMP_##name, dump_##word
#define SILENT NULL, RNEAGEN_DUMP_NONE, NULL

static const struct step PASSES[] = {
	{"urdf_read", "the robot, as its file states it", ANALYSIS_PASS(urdf_read), DUMPED(robot, ROBOT)},
	{"options_resolve", "options, with their defaults", TEXT_PASS(options_resolve), SILENT},
	{"scene_parse", "the scene's choices", ANALYSIS_PASS(scene_parse), SILENT},
	{"scene_select", "joints that move, are held, are cut away", ANALYSIS_PASS(scene_select), SILENT},
	{"holds_choose", "of held joints, those that are bodies of their own", ANALYSIS_PASS(holds_choose), DUMPED(scene, SCENE)},
	{"robot_snap", "the robot, angles snapped", ANALYSIS_PASS(robot_snap), SILENT},
	{"tree_build", "bodies that move, every constant placed", ANALYSIS_PASS(tree_build), DUMPED(tree, TREE)},
	{"params_choose", "bodies by constants that cost less", ANALYSIS_PASS(params_choose), DUMPED(params, PARAMS)},
	{"request_resolve", "inputs and outputs", ANALYSIS_PASS(request_resolve), DUMPED(request, REQUEST)},
	{"options_check", "options that go with the request", TEXT_PASS(options_check), SILENT},
	{"dag_build", "expressions of the outputs", TEXT_PASS(dag_build_all), SILENT},
	{"dag_prune", "expressions, without terms that no output feels", ANALYSIS_PASS(dag_prune), SILENT},
	{"dag_fuse", "expressions, products joined to sums", TEXT_PASS(dag_fuse_all), DUMPED(dag, DAG)},
	{"plan_build", "names and lines", PLANS_PASS(build), DUMPED(plan, PLAN)},
	{"parts_choose", "parts of the grid", PLANS_PASS(parts), DUMPED(parts, PARTS)},
	{"segments_choose", "stretches that run for several samples", PLANS_PASS(segments), DUMPED(segments, SEGMENTS)},
	{"limbs_choose", "windows for outputs, or warps that share samples", PLANS_PASS(limbs), DUMPED(limbs, LIMBS)},
	{"kernels_choose", "threads, registers and shared memory of kernels", PLANS_PASS(kernels), DUMPED(kernels, KERNELS)},
	{"measure", "what choices change and save", TEXT_PASS(measure), SILENT},
	{"warn", "warnings", TEXT_PASS(warn), SILENT},
	{"emit", "the text, and its header", TEXT_PASS(emit), SILENT},
	{"tell", "--info and --dot", TEXT_PASS(tell), SILENT},
};
enum { STEPS = sizeof PASSES / sizeof *PASSES };

static void put_passes(struct text *out)
{
	for (int i = 0; i < STEPS; i++) {
		const struct step *p = &PASSES[i];

		text_printf(out, p->word ? "%-16s %-51s --dump %s\n" : "%-16s %s\n", p->name, p->makes, p->word);
	}
}

static enum rneagen_code dump(struct generation *g)
{
	struct analysis *a = &g->analysis;
	const struct dumped d = {a, &g->plans};
	struct text out;

	if (a->options.dump == RNEAGEN_DUMP_NONE)
		return RNEAGEN_OK;
	text_init(&out, a->arena);
	if (a->options.dump == RNEAGEN_DUMP_PASSES)
		put_passes(&out);
	for (int i = 0; i < STEPS; i++)
		if (PASSES[i].put && PASSES[i].dump == a->options.dump)
			PASSES[i].put(&d, &out);
	if (out.failed)
		return error_memory(a->error);
	g->result->dump = text_string(&out);
	return RNEAGEN_OK;
}

static enum rneagen_code run(struct generation *g, const struct step *pass)
{
	if (pass->analyse)
		return pass->analyse(&g->analysis);
	return pass->plan ? pass->plan(&g->plans, &g->analysis) : pass->generate(g);
}

static enum rneagen_code generate(struct generation *g)
{
	enum rneagen_code code = RNEAGEN_OK;

	for (int i = 0; i < STEPS && !code; i++) {
		if (g->analysis.options.progress)
			g->analysis.options.progress(g->analysis.options.progress_context, PASSES[i].makes);
		code = run(g, &PASSES[i]);
	}
	analysis_free_raw(&g->analysis);
	arena_free(&g->raw_arena);
	return code ? code : dump(g);
}

enum rneagen_code rneagen_generate(const char *urdf, size_t length, const struct rneagen_options *options,
	struct rneagen_result *result, struct rneagen_error *error)
{
	struct analysis a = {.urdf = urdf, .length = length, .options = *options, .arena = &result->arena, .error = error};
	struct generation g = {.analysis = a, .result = result};
	locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0), before; /* numbers are printed with a point everywhere */

	*result = (struct rneagen_result){0};
	*error = (struct rneagen_error){0};
	if (!c)
		return error_memory(error);
	if (!g.analysis.options.file)
		g.analysis.options.file = "<input>";
	before = uselocale(c);
	arena_init(&result->arena, options->allocator);
	if (generate(&g))
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
