#ifndef RNEAGEN_UNPARSE_H
#define RNEAGEN_UNPARSE_H
/* The one walk over a plan that writes it: sections, loads, statements and stores. What numbers look like it asks the record
   of their type. */

#include "emit/emit.h"

/* Joints whose formulas differ: section.c. */
enum { SECTION_JOINT_KINDS = 5 };

/* Constants of a function, without their signs. */
struct numbers {
	double *value;
	int count, limit;
};

struct unparser {
	const struct emission *emission;
	const struct function *function;
	const struct plan *plan;
	const struct number_type *numbers;
	const char *const *calls;    /* of the type, as the options choose them */
	const struct unparser *narrow, *wide; /* of the two types of numbers in the text; wide: NULL where there is one */
	const unsigned char *angles; /* per node: an input that sines and cosines alone read, as memory has it; NULL: none */
	/* stores of what is always zero: among the others, not written, nothing else is */
	enum { ZEROS_AMONG, ZEROS_LEFT, ZEROS_ALONE } zeros;
	int loop; /* over limbs, which the lines are in, from 1; 0: none (kernels/emit_each.c) */
	int is_over_columns; /* lines of a loop over columns, on a processor */
	/* of constants, in the order in which they are met (kernels/emit_numbers.c); NULL: they stand in the code */
	struct numbers *table;
	struct angles sines; /* where the table of known ones has them */
	int has_samples; /* inputs are those of one sample, row after row, whatever the stride (plan/transposed.h) */
	int has_inner; /* rows of inputs have a stride of their own, `inner` (plan/tiles/tiles.h) */
	size_t sections; /* so many of the plan's DAG are behind */
	unsigned char written[SECTION_COUNT][SECTION_JOINT_KINDS]; /* whose formula stands there already: section.c */
};

/* The statements of a function in numbers of a type, each indented by one tab. Its constants go to the table, unless that is
   NULL. Errors: NUMBER when a constant is no finite number in the target's precision. */
void unparse(const struct emission *e, const struct function *p, const struct number_type *numbers, struct numbers *table,
	struct text *out);

/* The same in steps, for a function in segments: what was said once is not said again. A writer stays where it began. */
struct writer {
	struct unparser own, wide;
};
void unparse_begin(struct writer *w, const struct emission *e, const struct function *p, const struct number_type *numbers);

/* The lines to come are among these, the whole's, a segment's or a warp's: looks at what they read of each input. */
void unparse_within(struct writer *w, const struct plan *lines);
void unparse_lines(struct writer *w, const struct plan *lines, struct text *out);

/* A load of an input; an angle as sines and cosines are made of it. */
void unparse_load(const struct unparser *u, const struct node *n, struct text *out);
void unparse_angle(const struct unparser *u, struct ref angle, struct text *out);
struct unparser unparse_new(const struct emission *e, const struct function *p, const struct number_type *numbers);

/* Lines `x[i] = ...`, one for each angle of the list, each input as its load. `suffix` goes after x. */
void unparse_angles(const struct emission *e, const struct function *p, const struct number_type *numbers,
	const struct angles *list, const char *suffix, struct text *out);

/* An angle whose input has this name. */
void unparse_angle_of(const struct emission *e, const struct function *p, struct ref angle, const char *input, struct text *out);

/* Where the bounds of an output begin in those of all: one output's come after the other's. */
int unparse_first_bound(const struct dag *d, int argument);

/* A comment that says which part of the algorithm begins, and how it goes where it is the first of its kind. */
void unparse_section(struct unparser *u, const struct section *s, struct text *out);

/* Lanes made of numbers, or one of them: OP_PAIR and what follows it. */
void emit_put_lanes(const struct unparser *u, const struct node *n, struct text *out);

/* Of an array in a batch, `step` from one to the next. A row of an argument: in a batch the rows have a stride, but not of what
   all samples share. */
void unparse_index(const char *array, unsigned i, const char *step, struct text *out);
void unparse_element(const struct unparser *u, int argument, int row, struct text *out);
/* The same of the limb whose turn it is in a loop: the row is the first limb's. */
void unparse_element_each(const struct unparser *u, int argument, int row, struct text *out);

/* Loops over alike limbs. The table of constants that are not the same in all of them, before the body of the function; one of
   them. Before a line: the end of a loop that it is not in, and the beginning of one that it is in. A number that leaves the
   loop. How much further on than those of the first limb the sines of an angle stand. */
void emit_each_numbers(const struct emission *e, const struct function *p, struct text *out);
void emit_put_each_number(const struct unparser *u, const struct node *n, struct text *out);
void emit_each_before(struct unparser *u, const struct plan *lines, size_t line, struct text *out);
void emit_put_leaving(const struct unparser *u, struct ref a, struct text *out);
void emit_put_each_step(const struct unparser *u, struct ref angle, int first, struct text *out);

/* An empty table for a body's constants; NULL: they stand in the code. A constant by its place in the table: 0 where it stands in
   the code. The table of a function, before its body. */
struct numbers *emit_new_numbers(const struct emission *e);
int emit_put_number(const struct unparser *u, real constant, struct text *out);
void emit_numbers(const struct emission *e, const struct function *p, const struct numbers *table, struct text *out);

/* Does a store of the loop speak of a limb other than the first, whose store serves all? */
int emit_is_later_limb(const struct unparser *u, const struct line *store);

/* The end of a name in a loop: `q_each` points to the rows of the limb. */
#define EMIT_EACH "_each"

/* A name, a number, or an expression: for a record that writes an operation in its own way. */
void unparse_value(const struct unparser *u, struct ref a, struct text *out);

#endif
