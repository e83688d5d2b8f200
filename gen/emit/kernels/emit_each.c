/* Loops over alike limbs (plan/lanes/each.h): the lines of one limb stand there once. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/unparse.h"
#include "plan/lanes/each.h"
#include <stdlib.h>

static void put_numbers_of(const struct emission *e, const struct function *p, int limb, struct text *out)
{
	size_t from = out->length;

	text_put(out, "\t{");
	for (int i = 0; i < p->loops->number_count; i++) {
		text_put(out, i ? ", " : "");
		emit_number(e, e->arithmetic, p->dag.lanes[p->loops->number[i]].x[limb], out);
	}
	text_put(out, "},\n");
	fold(out, from);
}

/* Where each thread has its own number of the limb, constants go through its registers; where all threads share one, through
   those of the warp, for which a long loop waits. With a vjp no register is left. H100, 1 M samples in aos, ps, own and shared:
   tau of g1_brainco 454, 502, in f64 1393, 1342, of jvrc1 198, 192, in f64 420, 438, of g1_29dof and atlas alike; with the vjp of
   jvrc1 528, 503, in f64 2196, 1936, of atlas in f64 1291, 1158, of g1_29dof 1277, 1272, of romeo 850, 886. */
static const char *first_text(const struct emission *e)
{
	const char *turns =
		request_wants_derivative(e->request) ? "0" : "(threadIdx.x >> 16) /* 0: each thread has its own number of the limb */";
	return text_format(e->arena, emit_each_block(e) ? "(RNEA_SAMPLE_THREADS > 1 ? threadIdx.x/RNEA_BLOCK : %s)" : "%s", turns);
}

void emit_each_numbers(const struct emission *e, const struct function *p, struct text *out)
{
	const struct slot first[] = {{"FIRST", first_text(e)}, {"BLOCK", emit_int(e, e->kernels.block)},
		{"MOST", emit_int(e, p->loops->most_block)}, {"LIMBS", emit_int(e, p->loops->limbs)}};
	struct text rows;

	template_expand(out, template_each_in, first, sizeof first / sizeof *first);
	if (p->loops->most_block)
		template_expand(out, template_each_threads_in, first, sizeof first / sizeof *first);
	if (!p->loops->number_count)
		return;
	text_init(&rows, e->arena);
	for (int limb = 0; limb < p->loops->limbs; limb++)
		put_numbers_of(e, p, limb, &rows);
	const struct slot slots[] = {{"T", e->numbers->value}, {"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"LIMBS", emit_int(e, p->loops->limbs)}, {"COUNT", emit_int(e, p->loops->number_count)}, {"ROWS", text_string(&rows)}};

	template_expand(out, template_each_numbers_in, slots, sizeof slots / sizeof *slots);
}

void emit_put_each_number(const struct unparser *u, const struct node *n, struct text *out)
{
	int place = u->function->loops->place[n->arg[0].i - 1];

	text_printf(out, place < 0 ? "(-%s_%s_each[each][%d])" : "%s_%s_each[each][%d]", u->emission->options->name,
		u->function->algorithm->name, abs(place) - 1);
}

void emit_put_each_step(const struct unparser *u, struct ref angle, int first, struct text *out)
{
	int step = 2 * (angles_place(&u->sines, u->plan->dag, angle, u->function->loops, 1) - first);

	text_printf(out, " %c %d*each", step < 0 ? '-' : '+', abs(step));
}

int emit_is_later_limb(const struct unparser *u, const struct line *store)
{
	const struct each *x = u->function->loops;
	int row = u->plan->dag->outputs[store->index].row % u->plan->tree->nv, first = x->first[u->loop][0];

	for (int k = first; k < first + x->bodies[u->loop]; k++)
		if (u->plan->tree->bodies[k].iv == row)
			return 0;
	return 1;
}

static unsigned lane_of(const struct unparser *u, struct ref a)
{
	return u->plan->dag->nodes[a.i].op - OP_LANE0;
}

void emit_put_leaving(const struct unparser *u, struct ref a, struct text *out)
{
	const char *value = u->plan->names[u->plan->dag->nodes[a.i].arg[0].i];

	text_printf(out, "if (each == %u)\n\t\t%s = %s", lane_of(u, a), u->plan->names[a.i], value);
}

/* ---- a loop's beginning and end ---- */

static int loop_at(const struct unparser *u, const struct plan *p, size_t line)
{
	return line < p->line_count ? each_of_line(u->function, &p->lines[line]) : 0;
}

/* The first line, from this one on, that is no section's; where the loop ends. */
static size_t next_line(const struct plan *p, size_t line)
{
	while (line < p->line_count && p->lines[line].kind == LINE_SECTION)
		line++;
	return line;
}

static size_t end_of(const struct unparser *u, const struct plan *p, size_t line, int loop)
{
	while (line < p->line_count && (p->lines[line].kind == LINE_SECTION || loop_at(u, p, line) == loop))
		line++;
	return line;
}

/* What leaves the loop: `float t5 = 0, t6 = 0;`. */
static void put_leaving(const struct unparser *u, const struct plan *p, size_t line, size_t end, struct text *out)
{
	size_t from = out->length;
	struct text names;

	text_init(&names, u->emission->arena);
	for (; line < end; line++) {
		const struct line *l = &p->lines[line];

		if (l->kind == LINE_VALUE && p->dag->nodes[l->value.i].op >= OP_LANE0)
			text_printf(&names, "%s%s = 0", names.length ? ", " : "", p->names[l->value.i]);
	}
	if (names.length)
		text_printf(out, "\t%s %s;\n", u->numbers->value, text_string(&names));
	fold(out, from);
}

/* The arrays of which the loop has rows. */
static void put_pointers(const struct unparser *u, const struct plan *p, size_t line, size_t end, int loop, struct text *out)
{
	const struct plan lines = {
		.dag = p->dag, .tree = p->tree, .names = p->names, .lines = p->lines + line, .line_count = end - line};
	unsigned char used[DAG_EVERY] = {0};

	emit_mark_arguments(u->emission, &lines, used);
	for (int i = 0; i < p->dag->argument_count; i++) {
		const struct argument *a = &p->dag->arguments[i];

		if (used[i])
			text_printf(out, "\t\t%s%s *const %s" EMIT_EACH " = %s + each*(%d*stride);\n", a->is_output ? "" : "const ",
				u->emission->memory->type, a->name, a->name, u->function->loops->shift[loop]);
	}
}

/* "links 3 to 8, and so 9 to 14" */
static void put_comment(const struct unparser *u, int loop, struct text *out)
{
	const struct each *x = u->function->loops;
	const struct body *bodies = u->plan->tree->bodies;

	text_put(out, "\n\t/* ==== alike limbs: what is said of links ");
	for (int k = 0; k < x->limbs; k++)
		text_printf(out, "%s%d to %d", k ? (k == 1 ? " goes for " : " and ") : "", bodies[x->first[loop][k]].number,
			bodies[x->first[loop][k] + x->bodies[loop] - 1].number);
	text_put(out, " ==== */\n");
}

static void put_begin(const struct unparser *u, const struct plan *p, size_t line, int loop, struct text *out)
{
	size_t end = end_of(u, p, line, loop);

	put_comment(u, loop, out);
	put_leaving(u, p, line, end, out);
	text_printf(out, "\tRNEA_EACH_LIMB\n\tfor (unsigned each = RNEA_EACH_FIRST; each < %s; each++) {\n",
		u->function->loops->most_block ? "RNEA_EACH_END" : emit_int(u->emission, u->function->loops->limbs));
	put_pointers(u, p, line, end, loop, out);
}

/* ---- where limbs have threads of their own ---- */

/* What a limb leaves, from a place on: stored there, or fetched. Returns the place after it. */
static int put_left(const struct plan *p, int limb, int place, int is_store, struct text *out)
{
	for (size_t i = 0; i < p->line_count; i++) {
		if (each_left_by(p, i) != limb)
			continue;
		if (is_store)
			text_printf(out, "\t\tleft[%d*RNEA_BLOCK] = %s;\n", place++, p->names[p->lines[i].value.i]);
		else
			text_printf(out, "\t%s = left[%d*RNEA_BLOCK];\n", p->names[p->lines[i].value.i], place++);
	}
	return place;
}

static const char *room_text(const struct unparser *u, int numbers)
{
	const char *type = u->numbers->value;
	struct text t;

	text_init(&t, u->emission->arena);
	if (numbers)
		text_printf(&t, "\t__shared__ %s numbers_left[%d*RNEA_BLOCK];\n\t%s *const left = numbers_left + threadIdx.x%%RNEA_BLOCK;\n",
			type, numbers, type);
	return text_string(&t);
}

/* After the last loop the first limb's threads go on alone. */
static void put_meeting(const struct unparser *u, const struct plan *p, struct text *out)
{
	struct text stores, loads;
	int place = 0;

	text_init(&stores, u->emission->arena);
	text_init(&loads, u->emission->arena);
	for (int limb = 1, after; limb < u->function->loops->limbs; limb++, place = after) {
		after = put_left(p, limb, place, 0, &loads);
		if (after == place)
			continue;
		text_printf(&stores, "\tif (threadIdx.x/RNEA_BLOCK == %d) {\n", limb);
		put_left(p, limb, place, 1, &stores);
		text_put(&stores, "\t}\n");
	}
	const struct slot slots[] = {{"ROOM", room_text(u, place)}, {"STORES", text_string(&stores)}, {"LOADS", text_string(&loads)},
		{"RETURN", emit_has_known(u->emission) ? "return all_small" : "return"}};

	template_expand(out, template_each_meet_in, slots, sizeof slots / sizeof *slots);
}

static int is_last(const struct unparser *u, const struct plan *p, size_t line)
{
	for (; line < p->line_count; line++)
		if (loop_at(u, p, line))
			return 0;
	return 1;
}

void emit_each_before(struct unparser *u, const struct plan *lines, size_t line, struct text *out)
{
	int next;

	if (!u->function->loops)
		return;
	next = loop_at(u, lines, next_line(lines, line));
	if (u->loop && next != u->loop) {
		text_put(out, "\t}\n");
		if (u->function->loops->most_block && is_last(u, lines, line))
			put_meeting(u, lines, out);
	}
	if (next && next != u->loop)
		put_begin(u, lines, line, next, out);
	u->loop = next;
}
