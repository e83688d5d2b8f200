/* Batches of C functions: in groups of samples, of which compilers make vectors. Samples that fill no group are computed beside
   others, where a group costs less than they do by themselves. Compilers make few vectors of arrays [sample][row]: in layout aos
   some samples at a time are turned to [row][sample] and back, unless clang compiles a short text. */
#include "emit/emit_groups.h"
#include "base/template.h"

enum {
	VECTOR_BYTES = 32, /* a group of a short text: a vector of AVX, of which AVX-512 has two and SSE half a one */
	ROOM_BYTES = 131072, /* for samples that are moved: a thread's stack has it */
	TURNED_BYTES = 32768, TURNED = 32, /* so many at a time stay in the first cache */
	AT_A_TIME = 256 /* samples whose angles are looked at before they are computed */
};

/* Where gcc computes several samples at a time without its -O3, which takes it ten times as long: atlas 47 s instead of 5. */
enum { SHORT_FLOPS = 1500 };

static int is_soa(const struct emission *e)
{
	return e->options->layout == RNEAGEN_SOA;
}

static const char *count_text(const struct emission *e)
{
	return is_soa(e) ? "count, " : "";
}

/* ---- how many ---- */

/* How many samples a group has: of segments as many as their values have room for. */
static int group_of(const struct emission *e, const struct function *p)
{
	return p->segments.count ? emit_segments_lanes(e, p) : VECTOR_BYTES / e->arithmetic->bytes;
}

/* Of what stands for each sample in memory. */
static int sample_bytes(const struct emission *e, const struct function *p)
{
	int rows = 0;

	for (int i = 0; i < p->dag.argument_count; i++)
		rows += p->dag.arguments[i].per_batch ? 0 : p->dag.arguments[i].rows;
	return rows * e->memory->bytes;
}

static int has_input(const struct function *p)
{
	for (const struct argument *a = p->dag.arguments; a < p->dag.arguments + p->dag.argument_count; a++)
		if (!a->is_output && !a->per_batch)
			return 1;
	return 0;
}

/* May samples be moved? Loops over columns, of what a batch runs, know the places of these. Asked of a function, or of what its
   batches run, the answer is the same. */
static int has_few(const struct emission *e, const struct function *p)
{
	return has_input(p) && group_of(e, p) * sample_bytes(e, p) <= ROOM_BYTES && !emit_many_of(p)->dag.loop_count;
}

static int is_turned(const struct emission *e, const struct function *p)
{
	return !is_soa(e) && !e->target->kernel && has_few(e, p);
}

enum rneagen_layout emit_groups_layout(const struct emission *e, const struct function *p)
{
	return is_turned(e, p) ? RNEAGEN_SOA : e->options->layout;
}

/* Do groups get samples from where they are moved to? */
static int moves_samples(const struct emission *e, const struct function *p)
{
	return has_few(e, p) && emit_groups_layout(e, p) == RNEAGEN_SOA;
}

/* How many samples are moved at a time. */
static int room_of(const struct emission *e, const struct function *p)
{
	int room = group_of(e, p);

	if (is_turned(e, p) && !p->segments.count)
		while (2 * room <= TURNED && 2 * room * sample_bytes(e, p) <= TURNED_BYTES)
			room *= 2;
	return room;
}

/* ---- words ---- */

static const char *where_small(const struct emission *e)
{
	return emit_has_known(e) ? " where their angles are small, which is the rule" : "";
}

/* Which argument says whether angles are small; -1: none is read. */
static int angles_argument(const struct emission *e, const struct function *p)
{
	return emit_has_known(e) ? dag_find_role(&p->dag, ROLE_JOINT_POSITION, 0) : -1;
}

/* Whether these samples' angles are small. */
static const char *small_text(const struct emission *e, const struct function *p, const char *from, const char *to)
{
	int q = angles_argument(e, p);
	struct text t;

	text_init(&t, e->arena);
	if (q < 0)
		text_put(&t, "1");
	else
		text_printf(&t, "%s_are_small(%s, %s%s, %s)", e->options->name, p->dag.arguments[q].name, count_text(e), from, to);
	return text_string(&t);
}

static const char *and_small(const struct emission *e, const struct function *p, const char *from)
{
	struct text t;

	text_init(&t, e->arena);
	if (angles_argument(e, p) >= 0)
		text_printf(&t, " && %s", small_text(e, p, from, "end"));
	return text_string(&t);
}

/* `, n`: how many samples a group is called with, where that may vary. */
static const char *many_text(const struct emission *e, const struct function *p, const char *many)
{
	struct text t;

	text_init(&t, e->arena);
	if (!p->segments.count)
		text_printf(&t, ", %s", many);
	return text_string(&t);
}

/* ---- a group ---- */

static void put_group(const struct emission *e, const struct function *p, struct text *out)
{
	int is_short = plan_flops(plan_operations(&p->plan)) <= SHORT_FLOPS;
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"GROUP", emit_int(e, group_of(e, p))}, {"WHERE_SMALL", where_small(e)},
		{"VECTORS", is_short ? "RNEA_VECTORS " : ""}, {"LOOP", is_short ? "RNEA_LOOP" : "RNEA_ALONE"},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_RESTRICT)},
		{"COUNT_PARAM", emit_count_param(emit_groups_layout(e, p))},
		{"AT_SAMPLE", emit_at_sample(e, p, emit_groups_layout(e, p))},
		{"UNKNOWN", emit_handed_on(e, emit_unread_names(e, p))}};

	if (p->segments.count)
		emit_segments_group(e, p, where_small(e), out);
	else
		template_expand(out, template_group_in, slots, sizeof slots / sizeof *slots);
}

/* ---- samples that are moved ---- */

static const char *few_arrays(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	for (const struct argument *a = p->dag.arguments; a < p->dag.arguments + p->dag.argument_count; a++)
		if (!a->per_batch)
			text_printf(&t, "\tRNEA_ALIGNED %s few_%s[%d*%d];\n", e->memory->type, a->name, a->rows, room_of(e, p));
	return text_string(&t);
}

static const char *few_names(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	for (const struct argument *a = p->dag.arguments; a < p->dag.arguments + p->dag.argument_count; a++)
		text_printf(&t, "%s%s, ", a->per_batch ? "" : "few_", a->name);
	return text_string(&t);
}

static const char *moves(const struct emission *e, const struct function *p, int of_outputs)
{
	struct text t;

	text_init(&t, e->arena);
	for (const struct argument *a = p->dag.arguments; a < p->dag.arguments + p->dag.argument_count; a++)
		if (!a->per_batch && a->is_output == of_outputs)
			text_printf(&t, "\t%s_%s(few_%s, %s, %d, %sfirst, end, %s%d);\n", e->options->name, of_outputs ? "scatter" : "gather",
				a->name, a->name, a->rows, count_text(e), of_outputs ? "" : "samples, ", room_of(e, p));
	return text_string(&t);
}

static void put_few(const struct emission *e, const struct function *p, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"GROUP", emit_int(e, group_of(e, p))},
		{"WHAT", is_soa(e) ? "Fewer samples than a group has" : "Some samples, turned to [row][sample]"},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_RESTRICT)}, {"COUNT_PARAM", emit_count_param(e->options->layout)},
		{"ARRAYS", few_arrays(e, p)}, {"FEW_NAMES", few_names(e, p)}, {"GATHER", moves(e, p, 0)},
		{"SCATTER", moves(e, p, 1)}, {"ROOM", emit_int(e, room_of(e, p))}, {"SAMPLES", many_text(e, p, "samples")}};

	template_expand(out, template_few_in, slots, sizeof slots / sizeof *slots);
}

/* A short text that clang leaves as it is, since it makes vectors of [sample][row] too. */
static int is_direct(const struct emission *e, const struct function *p)
{
	return is_turned(e, p) && !p->segments.count;
}

#define UNLESS_CLANG "#if !defined __clang__\n"

void emit_groups_moves(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->memory->type}};
	int users = 0, direct = 0;

	for (int i = 0; i < e->function_count; i++) {
		users += moves_samples(e, &e->functions[i]);
		direct += is_direct(e, &e->functions[i]);
	}
	if (!users)
		return;
	text_put(out, direct == users ? UNLESS_CLANG : "");
	template_expand(out, is_soa(e) ? template_gather_in : template_gather_aos_in, slots, sizeof slots / sizeof *slots);
	text_put(out, direct == users ? "#endif\n" : "");
}

/* ---- a part of a batch ---- */

static const char *next_text(const struct emission *e, const struct function *p)
{
	int group = group_of(e, p);
	struct text t;

	text_init(&t, e->arena);
	if (p->segments.count)
		text_printf(&t, "first + %d", group);
	else
		text_printf(&t, "first + (end - first < %d ? (end - first)/%d*%d : %d)", AT_A_TIME, group, group, AT_A_TIME);
	return text_string(&t);
}

/* Some samples that fill groups. */
static const char *whole_groups(const struct emission *e, const struct function *p)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"COUNT", count_text(e)},
		{"MANY", many_text(e, p, "next - first")}, {"SMALL", small_text(e, p, "first", "next")},
		{"NAMES", emit_params(e, p, PARAMS_NAMES)}};

	return template_text(e->arena, angles_argument(e, p) >= 0 ? template_part_small_in : template_part_any_in, slots,
		sizeof slots / sizeof *slots);
}

static const char *else_few(const struct emission *e, const struct function *p)
{
	struct text t;

	text_init(&t, e->arena);
	if (has_few(e, p) && is_soa(e))
		text_printf(&t, "\telse if (end - first > RNEA_WORTH(%d)%s)\n\t\t%s_%s_few(%s, %sfirst, end);\n", group_of(e, p),
			and_small(e, p, "first"), e->options->name, p->algorithm->name, emit_params(e, p, PARAMS_NAMES), count_text(e));
	return text_string(&t);
}

static void put_part(const struct emission *e, const struct function *p, const char *frame, struct text *out)
{
	const char *group = emit_int(e, group_of(e, p)), *back = text_format(e->arena, "end - %s", group);
	const struct slot slots[] = {{"NAME", e->options->name}, {"FUNCTION", p->algorithm->name}, {"GROUP", group},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_RESTRICT)}, {"COUNT_PARAM", emit_count_param(e->options->layout)},
		{"COUNT", count_text(e)}, {"LAST_IS_SMALL", and_small(e, p, back)},
		{"IS_SMALL", and_small(e, p, "first")}, {"SMALL", small_text(e, p, "first", "end")},
		{"NAMES", emit_params(e, p, PARAMS_NAMES)}, {"ONE_GROUP", many_text(e, p, group)}, {"ELSE_FEW", else_few(e, p)},
		{"ANY", emit_any_name(e, p)}, {"AT_SAMPLE", emit_at_sample(e, p, e->options->layout)}, {"NEXT", next_text(e, p)},
		{"PART", whole_groups(e, p)}, {"ROOM", emit_int(e, room_of(e, p))}, {"AT_A_TIME", emit_int(e, AT_A_TIME)},
		{"UNKNOWN", emit_handed_on(e, emit_unread_names(e, p))}};

	template_expand(out, frame, slots, sizeof slots / sizeof *slots);
}

void emit_groups(const struct emission *e, const struct function *p, struct text *out)
{
	put_part(e, p, template_part_each_in, out);
	text_put(out, is_direct(e, p) ? UNLESS_CLANG : "");
	put_group(e, p, out);
	if (moves_samples(e, p))
		put_few(e, p, out);
	put_part(e, p, is_turned(e, p) ? template_part_turned_in : template_part_in, out);
	if (is_direct(e, p)) {
		text_put(out, "#else\n");
		put_part(e, p, template_part_direct_in, out);
		text_put(out, "#endif\n");
	}
}
