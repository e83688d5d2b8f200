#include "proved/gap_put.h"
#include "emit/number_type.h"
#include "emit/emit.h"
#include <math.h>
#include <string.h>

/* Letters of tags. */
static const struct {
	const char *quantity, *word;
} QUANTITIES[] = {{"w", "the angular velocity"}, {"dw", "the angular acceleration"}, {"a", "the acceleration"},
	{"v", "the velocity"},
	{"f", "the force"}, {"n", "the moment"}};

static const char *quantity_of(const struct node *n)
{
	for (size_t i = 0; i < sizeof QUANTITIES / sizeof *QUANTITIES; i++)
		if (!strcmp(n->tag.quantity, QUANTITIES[i].quantity))
			return QUANTITIES[i].word;
	return "a value";
}

/* The body on whose way out or back the node stands; NULL where that is none's. */
static const struct body *body_of(const struct proved *x, uint32_t node)
{
	const struct dag *d = &x->a->dag;
	const struct body *b = NULL;

	for (size_t i = 0; i < d->section_count && d->sections[i].node <= node; i++) {
		const struct section *s = &d->sections[i];

		b = (s->kind == SECTION_OUT || s->kind == SECTION_BACK) && s->body >= 0 ? &x->a->tree.bodies[s->body] : NULL;
	}
	return b;
}

/* The row, of positions or of the rest, that reaches furthest of those that a node is made of; 0 where there is none. */
static int find_widest(const struct proved *x, uint32_t node, int is_position, int *argument, int *row, struct arena *a)
{
	const struct dag *d = &x->a->dag;
	unsigned char *is_part = arena_alloc(a, (size_t)node + 1, 1);
	double most = 0;

	if (!is_part)
		return 0;
	is_part[node] = 1;
	dag_mark_operands(d, (size_t)node + 1, is_part);
	for (uint32_t i = node + 1; i-- > 0;) {
		const struct node *n = &d->nodes[i];

		if (!is_part[i] || n->op != OP_INPUT || (d->arguments[n->arg[0].i].role == ROLE_JOINT_POSITION) != is_position)
			continue;
		if (interval_size(x->b->rows[n->arg[0].i][n->arg[1].i]) <= most)
			continue;
		most = interval_size(x->b->rows[n->arg[0].i][n->arg[1].i]);
		*argument = (int)n->arg[0].i;
		*row = (int)n->arg[1].i;
	}
	return most > 0;
}

static void put_advice(const struct proved *x, uint32_t node, int is_position, struct text *out)
{
	int argument, row;

	if (!find_widest(x, node, is_position, &argument, &row, out->arena) &&
		!find_widest(x, node, !is_position, &argument, &row, out->arena))
		return;
	text_put(out, "; narrow --range ");
	box_put_name(x->a, argument, row, out);
	text_printf(out, ", which reaches %.3g", interval_size(x->b->rows[argument][row]));
}

static void put_what(const struct proved *x, uint32_t node, struct text *out)
{
	const struct body *b = body_of(x, node);

	text_put(out, quantity_of(&x->a->dag.nodes[node]));
	if (b)
		text_printf(out, " of link '%s'", b->link);
	if (b && *b->joint)
		text_printf(out, ", joint '%s',", b->joint);
}

void gap_put(const struct proved *x, size_t output, int precision, struct text *out)
{
	const struct prove_row *r = &x->p->rows[output];
	const struct prove_gap *g = &r->gaps[precision];
	const char *name = emit_precision_name(x->o->precisions[precision]);

	if (isfinite(r->error_bound[precision]))
		return;
	switch (g->why) {
	case PROVE_OVERFLOW:
		put_what(x, g->node, out);
		text_printf(out, " may reach %.3g, and the largest number of %s is %.3g", g->size, name, g->most);
		put_advice(x, g->node, 0, out);
		return;
	case PROVE_STORED:
		text_printf(out, "the output itself may reach %.3g, and the largest number that %s stores is %.3g",
			g->size, name, g->most);
		put_advice(x, g->node, 0, out);
		return;
	case PROVE_ANGLE:
		text_printf(out, "an angle may reach %.3g rad, and --trig %s takes %.3g", g->size,
			emit_trig_name(x->a->options.trig), g->most);
		put_advice(x, g->node, 1, out);
		text_put(out, ", or take --trig accurate");
		return;
	default:
		put_what(x, g->node, out);
		text_put(out, " is of an operation whose rounding is not bounded here");
	}
}
