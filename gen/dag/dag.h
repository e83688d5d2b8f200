#ifndef RNEAGEN_DAG_H
#define RNEAGEN_DAG_H
/* The scalar expression DAG. Nodes stand in one array, operands before users, so that every pass is one loop.
   Constructors fold, order operands and look up before they add: folding and sharing cannot be forgotten.
   x*0 is 0: inputs are taken to be finite there. Sums are never re-associated. Constants that have the same value, and may be
   the same number, are: the one that is known better. */

#include "base/arena.h"
#include "base/text.h"
#include "base/within.h"
#include "dag/ops.h"
#include "dag/role.h"
#include <stdint.h>

/* A node, by value. Node 0 is the constant 0. */
struct ref {
	uint32_t i;
};

/* What a value is called in the text; never affects sharing. The quantity is a letter of the textbook's. */
struct tag {
	char quantity[4]; /* "w", "dw", "a", ...; "" for none */
	char component;   /* 'x', 'y', 'z', or 0 */
	int body;         /* the body's number */
};

struct node {
	enum op op;
	struct ref arg[3]; /* INPUT: arg[0].i is the argument, arg[1].i the row, arg[2].i tells readings apart, or is of a loop */
	real value;        /* CONST; if arg[0].i is not 0, which of the DAG's lanes it is, from 1, and so is this */
	struct tag tag;
	uint32_t number : 31; /* CONST: which of the DAG's numbers it is, counted from 1; 0: exactly the value */
	uint32_t is_wide : 1; /* it is of the type with more bits: WIDEN, and what is made of wide operands */
};

/* Lanes of a wide node, at most. */
enum { DAG_LANES = 4 };

struct dag_lanes {
	real x[DAG_LANES];
	int loop; /* of a DAG with loops over limbs: whose constant it is, from 1; else 0 */
};

enum section_kind { SECTION_OUT, SECTION_BACK, SECTION_END, SECTION_FREED, SECTION_TOTALS, SECTION_BIAS, SECTION_GRAVITY,
	SECTION_BY, SECTION_PRODUCTS, SECTION_FACTORS, SECTION_ARTICULATED, SECTION_INVERSE, SECTION_RESIDUAL,
	SECTION_REFINED, SECTION_BOUND, SECTION_REGRESSOR, SECTION_PLACE, SECTION_JACOBIAN, SECTION_RATE, SECTION_SUBTREE,
	SECTION_CENTROID, SECTION_FACTORED, SECTION_OPSPACE, SECTION_CONTACTS, SECTION_SWEEPS, SECTION_ROWS, SECTION_INPUTS,
	SECTION_COLUMNS, SECTION_WAY,
	SECTION_COUNT };

/* From this node (and this output) on, the text belongs to going out to a body, or back from it. */
struct section {
	enum section_kind kind;
	int body; /* index into the tree */
	uint32_t node;
	size_t output;
};

struct output {
	int argument, row;
	struct ref value;
};

/* A parameter of the generated function: q, qd, ..., tau. */
struct argument {
	const char *name;
	int rows, is_output;
	int per_batch; /* the same rows for all samples */
	enum role role;
	const char *of; /* the link, joint or constant that the role speaks of; NULL or "": none */
};

/* As many as a kernel takes (RNEA_ARGUMENT_LIMIT). DAG_COLUMN is no parameter, but what the first loop reads and writes: a
   column of an output, whose rows count elements from its first one. The second loop's is DAG_COLUMN + 1. */
enum { DAG_ARGUMENTS = 64, DAG_COLUMN = DAG_ARGUMENTS, DAG_STRUCK = 1 << 20, DAG_HELD, DAG_UNSTORED };

/* Columns of an output that stand in a row, over which a loop goes; `first`: the element with which the first column begins,
   `lane`: which of the loop's columns that one is. */
struct column_run {
	int loop, argument, first, count, lane;
};

/* Where a loop's columns stand side by side in an array of their own: `rows` rows from row `first` of this argument on, with room
   for so many columns each; and from one row to the next in the output. No room: they stand in the output itself.
   Of coordinates on their way back to the base `first` is the first one's place, `rows` are what each carries, and the array is
   of `room` places for each row; or in a batch of `room` rows for each place. */
struct column_room {
	int argument, first, rows, room, pitch;
	int is_batch;     /* each place has its rows together, and is of several samples */
	int columns, own; /* so many coordinates, of which these set out here; 0: they are none, and runs tell how many columns */
	int body;         /* that coordinates leave */
};

/* Row `row` of a loop's array, put into an output when the loop has run: side by side from element `first` on; or `is_down`, each
   into the row of the matrix that is its coordinate's, `first` elements from where that row begins. */
struct column_put {
	int loop, row, argument, first, is_down;
};

/* A row has room for a multiple of so many. */
enum { DAG_COLUMNS_UNIT = 8 };

/* Readings of inputs are those of a loop over limbs from its number times this on. */
enum { DAG_EACH = 1 << 16 };

enum { DAG_RUNS = 256, DAG_LOOPS = 256, DAG_PUTS = 1152 };

/* What loops leave of a column for the last loop, which then goes over the columns of all: rows of an array of the column's own,
   zero where its loop leaves nothing. No rows: there is no such loop. */
enum { DAG_REDUCED = DAG_COLUMN + DAG_LOOPS, DAG_EVERY };

/* A matrix that no state makes regular: the row of qd whose joint moves no mass, the want that has no inverse, or the contact
   that holds what is held already. */
struct singular {
	enum singular_of { SINGULAR_NONE, SINGULAR_ROW, SINGULAR_WANT, SINGULAR_CONTACT } of;
	int number;
};

struct dag {
	struct arena *arena;
	struct node *nodes;
	size_t count, capacity;
	uint32_t *table; /* hash table of node indices, 0 = empty */
	size_t table_size;
	struct within *numbers; /* of constants that are not exactly their value */
	size_t number_count, number_capacity;
	int width;               /* lanes of its wide nodes: four, or two */
	int is_each;             /* these are made by loops over limbs, one lane after the other (plan/lanes/each.h) */
	struct dag_lanes *lanes; /* of constants that are not the same in all lanes */
	size_t lane_count, lane_capacity;
	struct argument arguments[DAG_EVERY]; /* the last ones, of the loops, are not counted */
	int argument_count;
	struct output *outputs;
	size_t output_count, output_capacity;
	struct section *sections;
	size_t section_count, section_capacity;
	struct column_run runs[DAG_RUNS];
	struct column_room rooms[DAG_LOOPS];
	struct column_put puts[DAG_PUTS];
	int *begins, begin_count; /* where the rows of these outputs begin, by coordinates */
	int run_count, loop_count, put_count;
	int is_wide;  /* while it is set, inputs are widened where they are read, and constants are wide */
	double angle; /* the sine and cosine of a larger one are evaluated as NAN; 0: they are not */
	size_t limit; /* nodes; 0: as many as memory holds */
	int failed;   /* sticky: out of memory, an argument, a node or a run too many, a matrix that cannot be solved */
	struct singular singular; /* where that made it fail */
	int constant; /* 1 + the number of a want that does not vary, where that made it fail */
};

void dag_init(struct dag *d, struct arena *a);

/* Make room for so many nodes in all; one more makes it fail. */
void dag_limit(struct dag *d, size_t nodes);

/* Give back what only more nodes would need: from now on it can be read and fused, and one more makes it fail. */
void dag_close(struct dag *d);

/* Give back what it has taken, and leave it empty; dag_init begins it again. */
void dag_free(struct dag *d);

/* Make `d`, which has an arena and nothing else, a closed copy of another arena's DAG. */
void dag_take(struct dag *d, const struct dag *from);

/* Strike a parameter that nothing alive reads; those after it move up, and dead inputs are of DAG_STRUCK, which is none. It
   closes the DAG. */
void dag_strike(struct dag *d, int argument);

/* Put by[row] where dag_input(d, DAG_HELD, row) stands for it: a value that is known, and that the rules of the constructors and
   derivatives take for an input. by[row] is made before that is first used. It leaves live nodes, and closes the DAG. */
void dag_substitute(struct dag *d, const struct ref *by);

/* Drop the outputs of arguments from DAG_UNSTORED on, which are none: what others were made of. */
void dag_forget(struct dag *d);

/* Declare a parameter of the function; returns its index. Outputs after inputs. */
int dag_argument(struct dag *d, const char *name, int rows, int is_output);
int dag_argument_of(struct dag *d, struct argument a);

/* Begin one more loop, a section: what is made of DAG_COLUMN + its number, which is returned; -1: there are too many. Let the
   last loop go over a column that begins with this element. `room`: NULL, or where its columns stand. */
int dag_loop(struct dag *d, const struct column_room *room);
void dag_loop_over(struct dag *d, int argument, int first);

/* Is a section a loop? */
static inline int dag_section_loops(const struct section *s)
{
	return s->kind == SECTION_COLUMNS || s->kind == SECTION_WAY;
}

/* How many columns a loop goes over. */
int dag_loop_columns(const struct dag *d, int loop);

/* Let the loops before the last one leave so many rows of DAG_REDUCED for it. How many these are; 0: all loops are alike. Is this
   loop such a last one? */
void dag_loops_reduce(struct dag *d, int rows);
int dag_reduced_rows(const struct dag *d);
int dag_loop_is_last(const struct dag *d, int loop);

/* Room for where so many rows of the outputs begin into which elements are put; NULL when memory runs out. */
int *dag_loops_begin_rows(struct dag *d, int count);

/* Put a row of the last loop's array into an output, when it has run. */
void dag_loop_put(struct dag *d, const struct column_put *put);

/* Are there loops, of coordinates on their way back to the base? */
int dag_loops_go_back(const struct dag *d);

/* Are there loops, of columns that stand in their outputs? */
int dag_loops_in_place(const struct dag *d);

/* The first node of all loops; the number of nodes where there are none. */
size_t dag_loops_begin(const struct dag *d);

/* The index of an argument; -1 where there is none of the name. */
int dag_find_argument(const struct dag *d, const char *name);

/* The first input, or output, of a role; -1 where there is none. */
int dag_find_role(const struct dag *d, enum role role, int is_output);

struct ref dag_const(struct dag *d, real value);
/* What is taken for zero is exactly that. */
struct ref dag_within(struct dag *d, struct within c);
struct ref dag_const_lanes(struct dag *d, struct dag_lanes x);
/* Lanes of numbers; a number that is the same in all stays one. And one of them. */
struct ref dag_pack(struct dag *d, const struct ref each[DAG_LANES]);
struct ref dag_lane(struct dag *d, struct ref lanes, int lane);
struct ref dag_input(struct dag *d, int argument, int row);
/* The same input, read from memory once more; `reading` tells such readings apart, and is 0 for the first. Like dag_anew, another
   value. */
struct ref dag_input_anew(struct dag *d, int argument, int row, int reading);
/* In the loop over limbs of this number, from 1: the first limb's row, and where that of each other one is. It is wide. */
struct ref dag_input_each(struct dag *d, int argument, int row, int loop);

/* Is it neither a constant nor an input? */
static inline int node_is_operation(const struct node *n)
{
	return n->op != OP_CONST && n->op != OP_INPUT;
}

/* Of an input: its loop over limbs; 0: it is read in none. */
static inline int dag_loop_of(const struct node *input)
{
	return (int)(input->arg[2].i / DAG_EACH);
}

/* And which reading of it, from 0. */
static inline int dag_reading_of(const struct node *input)
{
	return (int)(input->arg[2].i % DAG_EACH);
}

struct ref dag_neg(struct dag *d, struct ref a);
struct ref dag_add(struct dag *d, struct ref a, struct ref b);
struct ref dag_sub(struct dag *d, struct ref a, struct ref b);
struct ref dag_mul(struct dag *d, struct ref a, struct ref b);
struct ref dag_div(struct dag *d, struct ref a, struct ref b);
struct ref dag_sqrt(struct dag *d, struct ref a);
struct ref dag_abs(struct dag *d, struct ref a);
/* The same value, which counts as another one: what is made of it is made again, where keeping it would cost more. */
struct ref dag_anew(struct dag *d, struct ref a);
struct ref dag_sin(struct dag *d, struct ref a);
struct ref dag_cos(struct dag *d, struct ref a);
/* Both leave a constant one: of the other type. */
struct ref dag_widen(struct dag *d, struct ref a);
struct ref dag_narrow(struct dag *d, struct ref a);
/* a*b + c, rounded once where the target can */
struct ref dag_fma(struct dag *d, struct ref a, struct ref b, struct ref c);

/* Any of these, by its name. */
struct ref dag_operation(struct dag *d, enum op op, struct ref a, struct ref b, struct ref c);

/* Name a value unless it has a name already or is a constant. */
void dag_tag(struct dag *d, struct ref a, const char *quantity, int body, char component);
void dag_section(struct dag *d, enum section_kind kind, int body);
void dag_output(struct dag *d, int argument, int row, struct ref value);

/* The live part of a DAG, with a product that has no other use joined to the sum that uses it; with `every`, each product
   to each sum, so that no sum has a product for an operand. */
void dag_fuse(struct dag *out, const struct dag *d, int every);

/* The number that a constant stands for. */
struct within dag_number(const struct dag *d, const struct node *n);

/* What stands in `out` for node i of another DAG; node 0 where nothing does. */
typedef struct ref dag_copier(void *context, struct dag *out, size_t i);

/* Arguments, sections, tags and outputs of `d`, with nodes as `copy` makes them; map[i] (d->count of them) is what it made of
   node i. */
void dag_copy(struct dag *out, const struct dag *d, struct ref *map, dag_copier *copy, void *context);

/* Node i of another DAG, a constant or an input. */
struct ref dag_copy_leaf(struct dag *out, const struct dag *d, size_t i);

/* Is any node wide? */
int dag_has_wide(const struct dag *d);

/* The node without its signs, which turn *sign, where that is not NULL. */
uint32_t dag_bare(const struct dag *d, uint32_t i, int *sign);

/* The place of a node in a list; -1: none. */
static inline int dag_place(const uint32_t *list, int count, uint32_t node)
{
	for (int k = 0; k < count; k++)
		if (list[k] == node)
			return k;
	return -1;
}

/* How often each node is used by live nodes and outputs, in `uses` (d->count of them); 0 means dead. */
void dag_uses(const struct dag *d, uint32_t *uses);

/* Mark what marked nodes are made of, of the first `count`. */
void dag_mark_operands(const struct dag *d, size_t count, unsigned char *marks);

/* The numbers of the outputs, by argument and then by row: in d->outputs they stand in the order of the tour. */
void dag_order_outputs(const struct dag *d, uint32_t *order);

void dag_dump(const struct dag *d, struct text *t);

/* For simplify.c: look the node up or add it, without any rule. The value is a constant's. */
struct ref dag_node(struct dag *d, enum op op, struct ref a, struct ref b, struct ref c, real value);
/* The node if it is there already, else node 0. */
struct ref dag_find(const struct dag *d, enum op op, struct ref a, struct ref b, struct ref c, real value);

static inline int ref_equal(struct ref a, struct ref b)
{
	return a.i == b.i;
}

#endif
