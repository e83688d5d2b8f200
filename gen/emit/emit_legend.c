/* What the names in the statements mean: of each kind that this text uses, a line in its head. */
#include "emit/emit.h"
#include "emit/kernels/emit_kernel.h"
#include "emit/kernels/emit_parts.h"
#include "plan/grid/parts.h"
#include "plan/tiles/tiles.h"
#include <ctype.h>
#include <string.h>

int emit_names(const struct plan *p, const char *quantity)
{
	for (size_t i = 0; i < p->dag->count; i++)
		if (p->names[i] && !strcmp(p->dag->nodes[i].tag.quantity, quantity))
			return 1;
	return 0;
}

/* Those of the functions, and of the parts of the first. */
static const struct plan *plan_at(const struct emission *e, int i)
{
	return i < e->function_count ? &e->functions[i].plan : &e->parts[i - e->function_count].function.plan;
}

static int any_names(const struct emission *e, const char *quantity)
{
	for (int i = 0; i < e->function_count + e->part_count; i++)
		if (emit_names(plan_at(e, i), quantity))
			return 1;
	return 0;
}

typedef int is_there(const struct plan *p, size_t node);

static int somewhere(const struct emission *e, is_there *test)
{
	for (int i = 0; i < e->function_count + e->part_count; i++) {
		const struct plan *p = plan_at(e, i);

		for (size_t k = 0; k < p->dag->count; k++)
			if (p->names[k] && test(p, k))
				return 1;
	}
	return 0;
}

static int is_temporary(const struct plan *p, size_t node)
{
	return p->names[node][0] == 't' && isdigit((unsigned char)p->names[node][1]);
}

/* f1x_2: a name that was taken. */
static int is_again(const struct plan *p, size_t node)
{
	const char *last = strrchr(p->names[node], '_');

	return p->dag->nodes[node].op != OP_INPUT && last && isdigit((unsigned char)last[1]);
}

static int is_half(const struct plan *p, size_t node)
{
	enum op op = p->dag->nodes[node].op;

	return (op == OP_SIN && !plan_partner(p, (struct ref){(uint32_t)node}, OP_COS).i) ||
	       (op == OP_COS && !plan_partner(p, (struct ref){(uint32_t)node}, OP_SIN).i);
}

static const char *argument_of(const struct plan *p, size_t node)
{
	const struct node *n = &p->dag->nodes[node];

	return n->op == OP_INPUT ? p->dag->arguments[n->arg[0].i].name : "";
}

static int is_joint_row(const struct plan *p, size_t node)
{
	const char *name = argument_of(p, node);

	return !strcmp(name, "q") || !strcmp(name, "qd") || !strcmp(name, "qdd") || !strcmp(name, "tau");
}

/* What a hand has left there, and has no name of its own. */
static int is_left(const struct plan *p, size_t node)
{
	const struct node *n = &p->dag->nodes[node];

	return n->op == OP_INPUT && p->dag->arguments[n->arg[0].i].is_output &&
		!strncmp(p->names[node], argument_of(p, node), strlen(argument_of(p, node)));
}

static int is_own_wrench(const struct plan *p, size_t node)
{
	return !strcmp(argument_of(p, node), "f");
}

static int is_other_row(const struct plan *p, size_t node)
{
	return *argument_of(p, node) && !is_joint_row(p, node) && !is_own_wrench(p, node);
}

static void put_entry(const char *names, const char *meaning, struct text *out)
{
	text_printf(out, " *   %-15s  %s\n", names, meaning);
}

static void put_inputs(const struct emission *e, struct text *out)
{
	if (somewhere(e, is_joint_row)) {
		if (e->request->is_forward)
			put_entry("q qd tau qdd", "position, velocity, torque and acceleration of the link's joint", out);
		else
			put_entry("q qd qdd", "position, velocity and acceleration of the link's joint", out);
		if (tree_has_type(e->tree, JOINT_FLOATING))
			put_entry("", "floating: with x y z qx qy qz qw after the number, and vx vy vz wx wy wz", out);
		if (tree_has_type(e->tree, JOINT_PLANAR))
			put_entry("", "planar: with x y t after the number, in the plane and about its normal", out);
	}
	if (somewhere(e, is_own_wrench))
		put_entry("own_f own_n", "force and moment that fpass wrote, in the URDF's frame of the link", out);
	if (somewhere(e, is_other_row))
		put_entry("ARRAY_...", "a row of another array: number, x y z, fx fy fz nx ny nz, or m hx hy hz Ixx Ixy Ixz Iyy Iyz Izz", out);
}

static void put_quantities(const struct emission *e, struct text *out)
{
	static const char *const quantities[][2] = {{"w", "angular velocity"}, {"dw", "rate of the angular velocity"},
		{"v", "velocity of the origin"}, {"a", "acceleration of the origin, less gravity"},
		{"f", "force: the link's own, then with its children's"}, {"n", "moment about the origin, as f"},
		{"qdd", "acceleration of the link's joint, as it is found"},
		{"sum", "what the base feels of the limbs on its other side, sum1, sum2 and so on: the number is no link's"},
		{"rhs", "change of the torque of the link's joint along the tangents, while qdd stands still"},
		{"mu", "M^-1 of the weights on the accelerations, by the link's joint"},
		{"iD", "1/D: the inverse of the inertia that the joint feels"},
		{"S", "of J M^-1 J^T, of links that stand, by rows of forces: what joints beyond the base's make of it"},
		{"rx", "the link's x axis, in the world's axes; so ry and rz"},
		{"p", "its origin, from that of the first body on the way to it, in the world's axes"},
		{"mc", "first moment about the origin of all masses from the link on"},
		{"P", "momentum of the same, by velocities less the origin's; so K, angular, about the origin"},
		{"F", "rate of that momentum; so N, of the angular one"}};

	if (any_names(e, "s") || any_names(e, "c"))
		put_entry("s c", "sine and cosine of the joint's angle", out);
	if (any_names(e, "sa") || any_names(e, "ca"))
		put_entry("sa ca", "of the joint's angle and a constant one, by which the link's frame is turned ahead", out);
	for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++)
		if (any_names(e, quantities[i][0]))
			put_entry(quantities[i][0], quantities[i][1], out);
	if (somewhere(e, is_half))
		put_entry("unused_...", "of a sine and a cosine the one that nobody needs", out);
	if (somewhere(e, is_temporary))
		put_entry("t", "with a number of its own: a value that has no name in the textbook", out);
	if (e->wide)
		put_entry("..._wide", "the same quantity in the residual's numbers, which have more bits", out);
	if (e->lanes)
		put_entry("..._wide", "the same quantity of several limbs or coordinates side by side: lanes", out);
	if (somewhere(e, is_again))
		put_entry("..._2 ..._3", "the same quantity again, as it grows or in another part of the text", out);
}

static int has_period(const struct function *p)
{
	return p->stretches && p->stretches->period;
}

static int has_gap(const struct function *p)
{
	return tiles_rows(p) && tiles_rows(p)->gap;
}

static int has_part(const struct emission *e, int (*is)(const struct function *p))
{
	for (int i = 0; i < e->part_count; i++)
		if (is(&e->parts[i].function))
			return 1;
	return 0;
}

/* Loops on a processor. */
static void put_columns(const struct function *p, struct text *out)
{
	if (p->single && dag_loops_go_back(&p->single->dag)) {
		put_entry("carried column", "what coordinates carry on their way back to the base; that of the first of them", out);
		put_entry("sn sm sf", "of a coordinate at the link: what it feels of a field is sn.alpha + sm.beta + sf.gamma", out);
		put_entry("fq nq fd nd", "force and moment on the links beyond, by its q and by its qd", out);
		if (!p->single->dag.run_count)
			return;
	}
	if (p->many)
		put_entry("column", "in a batch, a column of a derivative of qdd, in its place", out);
	if (p->single)
		put_entry("columns column l", "of both derivatives of qdd, side by side; the first of them; which of them this is", out);
}

/* Of parts of a kernel, and of loops over limbs. */
static void put_parts(const struct emission *e, struct text *out)
{
	const struct dag *d = &emit_main(e)->dag;
	int has_hands = emit_division(e) == DIVIDED_BY_HANDS;

	if (emit_hands(e) && somewhere(e, is_left))
		put_entry(d->arguments[parts_handed(d)].name, !has_hands
			? "what a kernel before has left in the row" : "what a hand left in the row of the link's joint", out);
	if (has_part(e, emit_takes_found))
		put_entry("handed found mu step", "where qdd and mu stand in the vjp, or in slices; from a row to the next", out);
	else if (emit_hands(e) && !has_hands)
		put_entry("handed step", "where what a kernel before has left stands; from a row to the next", out);
	else if (has_hands)
		put_entry("handed gap step",
			"what hands left in the last array; rows that a part's slice lacks; from a row of handed to the next", out);
	if (!has_hands && has_part(e, has_gap))
		put_entry("gap", "rows that a part's slice or tile lacks", out);
	if (has_part(e, tiles_are_inputs))
		put_entry("inner", "from one row of an input to the next, which may be in a tile", out);
	if (has_part(e, has_period))
		put_entry("skip", "from one row of the vjp to its next for qd, or qdd, where it stands where these were", out);
	if (emit_loops(e))
		put_entry("each ..._each",
			"in a loop over limbs that are alike, which of them it is; an array where the limb's rows begin", out);
}

static void put_segments(const struct emission *e, struct text *out)
{
	if (emit_has_segments(e))
		put_entry(e->lanes ? "across wide_across step" : "across step",
			"values that one segment leaves for another; from one of them to the next", out);
	if (emit_has_segments(e))
		put_entry("first_... l", "an array at the first of several samples in a row; which of them this is", out);
	put_columns(emit_main(e), out);
}

static void put_bounds(const struct emission *e, struct text *out)
{
	if (emit_bounds_by_table(e, &emit_main(e)->dag)) {
		put_entry("bound e", "of each output, how far it may be off; before it is rounded", out);
		put_entry("operations constants results",
			"what the function computes, as a table; which operations give its outputs", out);
		put_entry("type in all", "how numbers are rounded; arrays of inputs; values of all operations", out);
	} else if (e->options->bounded) {
		put_entry("bound factor", "of each output, how far it may be off; what the bounds' own rounding is made good by",
			out);
	}
}

static void put_macros(const struct emission *e, struct text *out)
{
	if (emit_uses(e, OP_FMA) && e->numbers->calls[OP_MUL] == NULL)
		put_entry("RNEA_FMA", "a*b + c, rounded once where the machine can", out);
	if (e->lanes)
		put_entry("RNEA_LANES RNEA_SPLAT RNEA_LANES_FMA", "these numbers side by side; one in all lanes; a*b + c in each", out);
	if (e->wide && e->wide->calls[OP_MUL] == NULL && !e->options->strict)
		put_entry("RNEA_WIDE_FMA", "the same in the residual's numbers", out);
	if (e->options->strict)
		put_entry("RNEA_...", "an operation that is rounded once, and as it stands", out);
	if (emit_has_numbers(e))
		put_entry("RNEA_NUMBER", "a constant, in a kernel by its place in a table", out);
	if (emit_joints_again(e))
		put_entry("RNEA_READ_ANEW", "an input, read from memory once more", out);
	if (emit_is_streamed(e))
		put_entry("RNEA_STORE",
			emit_stores_to_tiles(e) ? "a store to an output, or to a tile of it" : "a store that nobody reads again here", out);
	if (e->target->kernel && emit_windows(e)->slots)
		put_entry("RNEA_HOLD RNEA_FLUSH", "an element into its slot of a window; rows that leave, sample by sample", out);
}

static void put_functions(const struct emission *e, struct text *out)
{
	put_entry("stride", "from one row of an array to the next", out);
	put_parts(e, out);
	put_segments(e, out);
	if (emit_has_known(e))
		put_entry("known sines all_small", "are the sines and cosines of angles known; these; are all angles small", out);
	put_bounds(e, out);
	put_macros(e, out);
	put_entry("rneagen_...", "functions and types that this text brings along", out);
}

static void put_symbols(const struct emission *e, struct text *out)
{
	if (emit_is_operation(e))
		return;
	text_put(out,
		" * In the formulas: _p of the parent; R, p orientation and origin of the link's frame in the parent's; R' transposed;\n"
		" * x cross product; z the joint's axis; U = [dw]x + [w]x[w]x; m, h = m c, I mass, first moment and inertia about the\n"
		" * origin; M, in sections at rest, the mass from the link on; += what each child adds.\n");
}

void emit_legend(const struct emission *e, struct text *out)
{
	text_put(out,
		" *\n * Names in the statements: a quantity, the number of a link, and x y z for the component in the link's frame.\n");
	put_inputs(e, out);
	put_quantities(e, out);
	put_functions(e, out);
	put_symbols(e, out);
}
