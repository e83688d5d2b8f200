/* Constants of a long kernel in doubles: in a table in constant memory. In the code a double takes two instructions wherever it
   is used, from the table one, and none where it stays in a register. */
#include "base/fold.h"
#include "base/template.h"
#include "emit/unparse.h"
#include <math.h>
#include <string.h>

/* Each launch fetches the table. H100, ps for each of a million samples and, in brackets, us of 16384, with constants in the code
   and so; operations. Gradients: g1_29dof 4387, 3550 (107, 99), 23900; atlas 4492, 3974 (101, 98), 20000; simple_humanoid 3007,
   2530 (67.0, 64.3), 14500; yumi 2153, 2080 (65.3, 65.1), 13800; floating hyq 1833, 1791 (33.6, 31.7), 10600; floating atlas
   13243, 12454 (273, 261); jvrc1 21931, 20179 (376, 341). qdd: jvrc1 2679, 2054 (43.2, 41.8), in aos 2898, 2410 (49.6, 45.8),
   9900; g1_29dof 617, 566 (16.0, 15.4), floating 4836, 4451 (76.9, 73.7); atlas 592, 525 (16.0, 15.3), in aos 793, 738
   (17.3, 16.3), floating 4064, 3796 (72.9, 69.9), 6300. Its gradients: atlas 9610, 9302 (237, 236); panda 715, 692 (13.2, 14.0),
   7800. Shorter texts lose where batches are small: qdd of yumi 242, 239 (7.1, 8.2), 4300; of baxter 230, 224 (7.1, 8.2);
   gradients of hyq 357, 360 (6.6, 7.3). Torques gain nothing, and with a vjp they lose, in loops over limbs: jvrc1 in aos 1927,
   2037 (33.8, 36.2). */
enum { LEAST_OPERATIONS = 6000 };

/* Of all tables of a text: 48 of the 64 KB that a program has of constant memory. */
enum { MOST_NUMBERS = 6144 };

int emit_has_numbers(const struct emission *e)
{
	const struct request *k = e->request;

	return e->target->kernel && !emit_is_operation(e) && e->options->precision != RNEAGEN_F32X2 && e->arithmetic->bytes == 8 &&
		!k->vjp.count && !k->jvp.count && (k->is_forward || request_wants_derivative(k)) &&
		plan_flops(emit_operations(e)) > LEAST_OPERATIONS;
}

struct numbers *emit_new_numbers(const struct emission *e)
{
	int bodies = 2 + e->part_count + (e->relay ? e->relay->start_count : 0);
	struct numbers *table = emit_has_numbers(e) ? arena_alloc(e->arena, 1, sizeof *table) : NULL;

	if (!table)
		return NULL;
	table->limit = MOST_NUMBERS / bodies;
	table->value = arena_alloc(e->arena, (size_t)table->limit, sizeof *table->value);
	return table->value ? table : NULL;
}

/* An instruction has room for the high half of a double. */
static int is_short(double value)
{
	uint64_t bits;

	memcpy(&bits, &value, sizeof bits);
	return !(bits & 0xffffffffu);
}

/* Its place in the table, which grows; -1: it has no room. */
static int place_of(struct numbers *table, double value)
{
	for (int i = 0; i < table->count; i++)
		if (table->value[i] == value)
			return i;
	if (table->count == table->limit)
		return -1;
	table->value[table->count] = value;
	return table->count++;
}

int emit_put_number(const struct unparser *u, real constant, struct text *out)
{
	double value = (double)u->numbers->arithmetic->round(constant);
	int place = u->table && isfinite(value) && !is_short(value) ? place_of(u->table, fabs(value)) : -1;

	if (place < 0)
		return 0;
	text_printf(out, "%sRNEA_NUMBER(%d, ", value < 0 ? "-" : "", place);
	emit_number(u->emission, u->numbers->arithmetic, fabsl(constant), out);
	text_putc(out, ')');
	return 1;
}

void emit_numbers(const struct emission *e, const struct function *p, const struct numbers *table, struct text *out)
{
	struct text numbers;

	if (!table->count)
		return;
	text_init(&numbers, e->arena);
	text_putc(&numbers, '\t');
	for (int i = 0; i < table->count; i++) {
		emit_number(e, e->arithmetic, (real)table->value[i], &numbers);
		text_put(&numbers, i + 1 < table->count ? ", " : "");
	}
	fold(&numbers, 0);
	const struct slot slots[] = {{"T", e->numbers->value}, {"NAME", e->options->name}, {"FUNCTION", p->algorithm->name},
		{"COUNT", emit_int(e, table->count)}, {"NUMBERS", text_string(&numbers)}};

	template_expand(out, template_numbers_in, slots, sizeof slots / sizeof *slots);
}
