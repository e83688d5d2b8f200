#include "dag/dag.h"
#include <string.h>

#define OP_ARITY(name, arity, commutes, strength) arity,
#define OP_COMMUTES(name, arity, commutes, strength) commutes,
#define OP_STRENGTH(name, arity, commutes, strength) strength,
#define OP_NAME(name, arity, commutes, strength) #name,
const unsigned char op_arity[OP_COUNT] = {DAG_OPS(OP_ARITY)};
const unsigned char op_commutes[OP_COUNT] = {DAG_OPS(OP_COMMUTES)};
const unsigned char op_strength[OP_COUNT] = {DAG_OPS(OP_STRENGTH)};
const char *const op_name[OP_COUNT] = {DAG_OPS(OP_NAME)};

static const struct ref NONE = {0};

static uint64_t mix(uint64_t h, uint64_t x)
{
	h = (h ^ x) * 0x9e3779b97f4a7c15u;
	return h ^ (h >> 29);
}

/* long double has padding: hash the value, not its bytes. -0 and 0 are one constant. */
static uint64_t hash_value(real value)
{
	double head = (double)value, tail = (double)(value - (real)head);
	uint64_t a, b;

	head += 0.0;
	tail += 0.0;
	memcpy(&a, &head, sizeof a);
	memcpy(&b, &tail, sizeof b);
	return mix(a, b);
}

static uint64_t hash_node(enum op op, struct ref a, struct ref b, struct ref c, real value)
{
	uint64_t h = mix(mix((uint64_t)op + 1, (uint64_t)a.i << 32 | b.i), c.i);

	return op == OP_CONST ? mix(h, hash_value(value)) : h;
}

struct within dag_number(const struct dag *d, const struct node *n)
{
	return n->number ? d->numbers[n->number - 1] : within_exact(n->value);
}

/* What a node is told by. */
struct key {
	enum op op;
	struct ref a, b, c;
	real value;		     /* CONST */
	const struct within *number; /* NULL: exactly the value */
	int is_wide;		     /* CONST */
};

static int number_is(const struct dag *d, const struct node *n, const struct key *k)
{
	if (!n->number && !k->number)
		return 1;
	return within_meets(dag_number(d, n), k->number ? *k->number : within_exact(k->value));
}

static int node_is(const struct dag *d, const struct node *n, const struct key *k)
{
	return n->op == k->op && n->arg[0].i == k->a.i && n->arg[1].i == k->b.i && n->arg[2].i == k->c.i &&
	       (k->op != OP_CONST || (n->value == k->value && (int)n->is_wide == k->is_wide && number_is(d, n, k)));
}

/* The place in the table where the node is or would be. */
static size_t table_slot(const struct dag *d, const struct key *k)
{
	size_t mask = d->table_size - 1, slot = (size_t)hash_node(k->op, k->a, k->b, k->c, k->value) & mask;

	while (d->table[slot] && !node_is(d, &d->nodes[d->table[slot] - 1], k))
		slot = (slot + 1) & mask;
	return slot;
}

static int table_grow(struct dag *d)
{
	size_t size = d->table_size ? d->table_size * 2 : 1024;
	uint32_t *table = arena_alloc(d->arena, size, sizeof *table);

	if (!table)
		return 0;
	arena_release(d->arena, d->table);
	d->table = table;
	d->table_size = size;
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		size_t slot = (size_t)hash_node(n->op, n->arg[0], n->arg[1], n->arg[2], n->value) & (size - 1);

		while (table[slot]) /* all are different */
			slot = (slot + 1) & (size - 1);
		table[slot] = (uint32_t)i + 1;
	}
	return 1;
}

struct ref dag_find(const struct dag *d, enum op op, struct ref a, struct ref b, struct ref c, real value)
{
	const struct key k = {op, a, b, c, value, NULL, 0};
	uint32_t found = d->failed || !d->table ? 0 : d->table[table_slot(d, &k)];

	return (struct ref){found ? found - 1 : 0};
}

/* Of a node that is not there yet. The constant 0, which has one node, is of both types. */
static int is_wide(const struct dag *d, const struct key *k)
{
	const struct ref args[] = {k->a, k->b, k->c};
	int wide = k->op == OP_WIDEN || k->op == OP_PACK || k->is_wide || (k->op == OP_INPUT && k->c.i >= DAG_EACH);

	for (int i = 0; i < op_arity[k->op] && k->op != OP_NARROW && k->op < OP_LANE0; i++)
		wide |= (int)d->nodes[args[i].i].is_wide;
	return wide;
}

/* Look the node up or add it. */
static struct ref node_of(struct dag *d, const struct key *k)
{
	struct node *nodes;
	size_t slot;

	d->failed |= !d->table;
	if (d->failed)
		return NONE;
	slot = table_slot(d, k);
	if (d->table[slot])
		return (struct ref){d->table[slot] - 1};
	nodes = d->count < (d->limit ? d->limit : UINT32_MAX - 1)
			? arena_grow(d->arena, d->nodes, d->count, &d->capacity, sizeof *nodes)
			: NULL;
	if (!nodes) {
		d->failed = 1;
		return NONE;
	}
	d->nodes = nodes;
	d->nodes[d->count] = (struct node){.op = k->op, .arg = {k->a, k->b, k->c}, .value = k->value,
		.is_wide = is_wide(d, k) != 0};
	d->table[slot] = (uint32_t)++d->count;
	if (d->count > d->table_size / 2 && !table_grow(d))
		d->failed = 1;
	return (struct ref){(uint32_t)d->count - 1};
}

struct ref dag_node(struct dag *d, enum op op, struct ref a, struct ref b, struct ref c, real value)
{
	const struct key k = {op, a, b, c, value, NULL, op == OP_CONST && d->is_wide && value != 0};

	return node_of(d, &k);
}

static void set_number(struct dag *d, struct node *n, struct within c)
{
	struct within *numbers = d->numbers;

	if (!n->number) {
		numbers = arena_grow(d->arena, d->numbers, d->number_count, &d->number_capacity, sizeof *numbers);
		if (!numbers) {
			d->failed = 1;
			return;
		}
		n->number = (uint32_t)++d->number_count & 0x7fffffff;
	}
	d->numbers = numbers;
	numbers[n->number - 1] = c;
}

struct ref dag_const(struct dag *d, real value)
{
	struct ref r = dag_node(d, OP_CONST, NONE, NONE, NONE, value + 0);

	if (!d->failed && d->nodes[r.i].number)
		set_number(d, &d->nodes[r.i], within_exact(value));
	return r;
}

struct ref dag_within(struct dag *d, struct within c)
{
	const struct key k = {OP_CONST, NONE, NONE, NONE, c.x + 0, &c, d->is_wide};
	size_t count = d->count;
	struct ref r;

	if (!c.limb && (c.x == 0 || (c.near == c.x && c.e == 0)))
		return dag_const(d, c.x);
	r = node_of(d, &k);
	if (!d->failed && (d->count > count || c.e < dag_number(d, &d->nodes[r.i]).e))
		set_number(d, &d->nodes[r.i], c);
	return r;
}

void dag_init(struct dag *d, struct arena *a)
{
	*d = (struct dag){.arena = a, .width = DAG_LANES};
	if (!table_grow(d))
		d->failed = 1;
	dag_node(d, OP_CONST, NONE, NONE, NONE, 0);
}

void dag_limit(struct dag *d, size_t nodes)
{
	struct node *room = d->failed || d->count > nodes ? NULL : arena_take(d->arena, nodes, sizeof *room);

	if (!room) {
		d->failed = 1;
		return;
	}
	memcpy(room, d->nodes, d->count * sizeof *room);
	arena_release(d->arena, d->nodes);
	d->nodes = room;
	d->limit = d->capacity = nodes;
}

void dag_close(struct dag *d)
{
	arena_release(d->arena, d->table);
	d->table = NULL;
}

void dag_free(struct dag *d)
{
	arena_release(d->arena, d->nodes);
	arena_release(d->arena, d->table);
	arena_release(d->arena, d->outputs);
	arena_release(d->arena, d->sections);
	arena_release(d->arena, d->numbers);
	arena_release(d->arena, d->lanes);
	*d = (struct dag){.failed = 1};
}

void dag_strike(struct dag *d, int argument)
{
	const uint32_t gone = (uint32_t)argument;

	dag_close(d);
	for (size_t i = 0; i < d->count; i++) {
		uint32_t *of = &d->nodes[i].arg[0].i;

		if (d->nodes[i].op == OP_INPUT && *of >= gone && *of < DAG_COLUMN)
			*of = *of == gone ? DAG_STRUCK : *of - 1;
	}
	for (size_t i = 0; i < d->output_count; i++)
		d->outputs[i].argument -= d->outputs[i].argument > argument && d->outputs[i].argument < DAG_COLUMN;
	for (int i = 0; i < d->loop_count; i++)
		d->rooms[i].argument -= d->rooms[i].argument > argument;
	for (int i = 0; i < d->put_count; i++)
		d->puts[i].argument -= d->puts[i].argument > argument;
	d->argument_count--;
	memmove(d->arguments + argument, d->arguments + argument + 1,
		(size_t)(d->argument_count - argument) * sizeof *d->arguments);
}

int dag_argument(struct dag *d, const char *name, int rows, int is_output)
{
	return dag_argument_of(d, (struct argument){.name = name, .rows = rows, .is_output = is_output});
}

int dag_argument_of(struct dag *d, struct argument a)
{
	if (d->argument_count == DAG_ARGUMENTS) {
		d->failed = 1;
		return 0;
	}
	d->arguments[d->argument_count] = a;
	return d->argument_count++;
}

int dag_find_argument(const struct dag *d, const char *name)
{
	for (int i = 0; i < d->argument_count; i++)
		if (!strcmp(d->arguments[i].name, name))
			return i;
	return -1;
}

int dag_find_role(const struct dag *d, enum role role, int is_output)
{
	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].role == role && d->arguments[i].is_output == is_output)
			return i;
	return -1;
}

int dag_has_wide(const struct dag *d)
{
	for (size_t i = 0; i < d->count; i++)
		if (d->nodes[i].is_wide)
			return 1;
	return 0;
}

void dag_tag(struct dag *d, struct ref a, const char *quantity, int body, char component)
{
	struct node *n = d->failed ? NULL : &d->nodes[a.i];

	if (!n || n->op == OP_CONST || n->tag.quantity[0])
		return;
	strncpy(n->tag.quantity, quantity, sizeof n->tag.quantity - 1);
	n->tag.body = body;
	n->tag.component = component;
}

void dag_section(struct dag *d, enum section_kind kind, int body)
{
	struct section *s =
		arena_grow(d->arena, d->sections, d->section_count, &d->section_capacity, sizeof *s);

	if (!s) {
		d->failed = 1;
		return;
	}
	d->sections = s;
	d->sections[d->section_count++] = (struct section){kind, body, (uint32_t)d->count, d->output_count};
}

void dag_output(struct dag *d, int argument, int row, struct ref value)
{
	struct output *o = arena_grow(d->arena, d->outputs, d->output_count, &d->output_capacity, sizeof *o);

	if (!o) {
		d->failed = 1;
		return;
	}
	d->outputs = o;
	d->outputs[d->output_count++] = (struct output){argument, row, value};
}

void dag_uses(const struct dag *d, uint32_t *uses)
{
	memset(uses, 0, d->count * sizeof *uses);
	for (size_t i = 0; i < d->output_count; i++)
		uses[d->outputs[i].value.i]++;
	for (size_t i = d->count; i-- > 0;)
		if (uses[i])
			for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
				uses[d->nodes[i].arg[k].i]++;
}

uint32_t dag_bare(const struct dag *d, uint32_t i, int *sign)
{
	for (; d->nodes[i].op == OP_NEG; i = d->nodes[i].arg[0].i)
		if (sign)
			*sign = -*sign;
	return i;
}

void dag_mark_operands(const struct dag *d, size_t count, unsigned char *marks)
{
	for (size_t i = count; i-- > 0;)
		for (int k = 0; k < op_arity[d->nodes[i].op] && marks[i]; k++)
			marks[d->nodes[i].arg[k].i] = 1;
}

static int is_before(const struct output *a, const struct output *b)
{
	return a->argument < b->argument || (a->argument == b->argument && a->row < b->row);
}

void dag_order_outputs(const struct dag *d, uint32_t *order)
{
	for (size_t i = 0; i < d->output_count; i++) {
		size_t before = 0;

		for (size_t k = 0; k < d->output_count; k++)
			before += (size_t)is_before(&d->outputs[k], &d->outputs[i]);
		order[before] = (uint32_t)i;
	}
}

void dag_dump(const struct dag *d, struct text *t)
{
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		text_printf(t, "%zu %s", i, op_name[n->op]);
		if (n->op == OP_CONST)
			text_printf(t, " %.21Lg", n->value);
		else if (n->op == OP_INPUT)
			text_printf(t, " %s[%u]%s", d->arguments[n->arg[0].i].name, (unsigned)n->arg[1].i, n->arg[2].i ? " anew" : "");
		for (int k = 0; k < op_arity[n->op]; k++)
			text_printf(t, " %u", (unsigned)n->arg[k].i);
		if (n->tag.quantity[0])
			text_printf(t, "  # %s%d%.1s", n->tag.quantity, n->tag.body, &n->tag.component);
		text_putc(t, '\n');
	}
	for (size_t i = 0; i < d->output_count; i++)
		text_printf(t, "%s[%d] = %u\n", d->arguments[d->outputs[i].argument].name, d->outputs[i].row,
			(unsigned)d->outputs[i].value.i);
}
