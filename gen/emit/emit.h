#ifndef RNEAGEN_EMIT_H
#define RNEAGEN_EMIT_H
/* Text is made here, and only here: plans become statements, statements fill the templates. */

#include "emit/number_type.h"
#include "emit/target_type.h"
#include "plan/grid/base_first.h"
#include "plan/grid/found/found.h"
#include "plan/grid/found/found_limbs.h"
#include "plan/grid/hands/base_sides.h"
#include "plan/grid/relay.h"
#include "plan/lanes/angles.h"
#include "plan/kernels.h"
#include "rneagen.h"
#include "scene/adjust.h"

struct emission {
	const struct tree *tree;
	const struct request *request;
	const struct scene *scene;   /* for the command at the head; NULL: none, as its */
	const struct adjust *adjust;
	const struct rneagen_options *options; /* defaults resolved: precision, name, file */
	const struct function *functions;             /* function_count of them: the functions of the text, the first of which is a */
	int function_count;                        /* scene's request, or one operation of the robot, where it is such a text */
	const struct part *parts;              /* what the first function does, as parts of the grid; part_count 0: it is whole */
	int part_count;
	const struct relay *relay;             /* whose second kernel has these parts; NULL: there is one kernel */
	const struct part *rounds;             /* whose limbs serve small batches of the first function (found_limbs.h); or NULL */
	struct kernels kernels;                /* what they take of a multiprocessor */
	int is_transposed;                     /* kernels write as in soa (plan/transposed.h); their options say soa */
	const char *banner;                    /* the comment at the head, where it is not inverse dynamics; else NULL */
	const char *const *warnings;
	size_t warning_count;
	const char *told; /* lines of the comment at the head: what the scene made of the robot; NULL: none */
	const char *hash; /* SHA-256 of the URDF, in hex */
	struct arena *arena;
	struct rneagen_error *error;
	/* of the options, by emit_set_precision */
	const struct target_type *target;
	const struct number_type *numbers;
	const struct number_type *wide;           /* of the nodes with more bits; NULL: there are none */
	const struct number_type *lanes;          /* of the nodes of several limbs; NULL: there are none */
	const struct scalar *memory, *arithmetic; /* the numbers' */
	struct written_number *written;           /* EMIT_WRITTEN of them; NULL: each number is made anew */
};

/* The text's first function: what a call of a sample, or of a batch, computes; what may be in parts, staged and bounded. */
static inline const struct function *emit_main(const struct emission *e)
{
	return e->functions;
}

static inline const struct dag *emit_arguments(const struct emission *e)
{
	return &emit_main(e)->dag;
}

/* What a kernel computes in each place along y of its grid: the main function, or a part of it; how many such
   places there are. */
static inline const struct function *emit_part(const struct emission *e, int part)
{
	return e->part_count ? &e->parts[part].function : emit_main(e);
}

static inline int emit_is_apart(const struct emission *e)
{
	return parts_are_apart(e->parts, e->part_count);
}

/* The windows through which its outputs leave, their slots 0 where there are none. */
static inline const struct windows *emit_windows(const struct emission *e)
{
	return &emit_part(e, 0)->windows;
}

/* Which of the parts that have the elements of matrices a function is; -1: none. */
static inline int emit_column_part(const struct emission *e, const struct function *p)
{
	for (int i = 0; i < e->part_count && e->kernels.has_columns; i++)
		if (p == &e->parts[i].function)
			return i;
	return -1;
}

/* Is it the main function, or one of these parts? */
static inline int emit_is_of_main(const struct emission *e, const struct function *p)
{
	return p == emit_main(e) || emit_column_part(e, p) >= 0;
}

/* How many of the parts, the first ones, are hands: of kernels of their own, which run before. */
static inline int emit_hands(const struct emission *e)
{
	int count = 0;

	while (count < e->part_count && e->parts[count].is_before)
		count++;
	return count;
}

static inline enum division emit_division(const struct emission *e)
{
	return parts_division(e->parts, e->part_count);
}

/* How many kernels hands have; how many parts the kernel `level` of these has; what it is called after the function. */
int emit_hand_levels(const struct emission *e);
int emit_hands_of(const struct emission *e, int level);
const char *emit_hands_kernel(const struct emission *e, int level);

/* The most joints of a stretch whose motion a part makes again (plan/grid/again.h); 0: none does. */
int emit_joints_again(const struct emission *e);

/* Loops over alike limbs in the main kernel (plan/lanes/each.h); NULL: there are none. */
static inline const struct each *emit_loops(const struct emission *e)
{
	return e->part_count && e->parts->function.each ? e->parts->function.each->loops : NULL;
}

/* Samples of a block up to which each limb has threads of its own; 0: all are turns of a loop. A launch's factor for its
   threads, or nothing. */
static inline int emit_each_block(const struct emission *e)
{
	return emit_loops(e) ? emit_loops(e)->most_block : 0;
}
static inline const char *emit_each_threads(const struct emission *e)
{
	return emit_each_block(e) ? "*RNEA_SAMPLE_THREADS" : "";
}

/* Of the nodes that are wide; NULL: there are none. */
static inline const struct number_type *emit_wide(const struct emission *e)
{
	return e->wide ? e->wide : e->lanes;
}

/* Is it of a relay's first or third kernel? */
static inline int emit_is_relays(const struct emission *e, const struct function *p)
{
	for (int i = 0; e->relay && i < e->relay->start_count; i++)
		if (p == &e->relay->starts[i].function)
			return 1;
	return e->relay && (p == &e->relay->start.function || p == &e->relay->solve.function);
}

static inline int emit_part_places(const struct emission *e)
{
	return e->part_count ? e->part_count : 1;
}

/* A number as it was written last time: a model's few constants come again and again. */
struct written_number {
	const struct scalar *type; /* NULL: none yet */
	double value;
	char s[40];
};

enum { EMIT_WRITTEN = 4096 };

/* The records of the target and of the precision that the options name. */
void emit_set_precision(struct emission *e);

/* The precision that the options name, or their target's. */
enum rneagen_precision emit_precision_of(const struct rneagen_options *o);
const char *emit_precision_name(enum rneagen_precision precision);
const char *emit_trig_name(enum rneagen_trig trig);
const char *emit_only_name(int only); /* of RNEAGEN_ONLY_*, which name a function */

/* The sine and cosine that the statements call: "fast" is of single precision on a GPU, elsewhere it is "bounded"; what nobody
   chose is "accurate". */
enum rneagen_trig emit_trig_of(const struct rneagen_options *o);

const char *emit_layout_name(enum rneagen_layout layout);

/* The options of the command line that name these choices, resolved, each after a blank: all but the names of joints, of
   files and of the functions, which take quotes. */
void emit_options(const struct rneagen_options *o, struct text *out);

/* Is there such an operation in a function; in the text? */
int emit_function_uses(const struct function *p, enum op op);
int emit_uses(const struct emission *e, enum op op);
/* The same of wide nodes, or of the others. */
int emit_uses_in(const struct emission *e, enum op op, int is_wide);

/* C: NAME_rnea_bounded and what it calls. */
void emit_bounded(const struct emission *e, struct text *out);

/* Are bounds found by a table of operations? It is asked for, has all of them, and is small enough. */
int emit_bounds_by_table(const struct emission *e, const struct dag *d);

/* A number that reads back as the same value in the type: the shortest decimal that does. */
void emit_number(const struct emission *e, const struct scalar *s, real value, struct text *out);

/* Have the bodies of the text's kernels their constants in tables (kernels/emit_numbers.c)? */
int emit_has_numbers(const struct emission *e);

/* Operations of the main function: of its parts together, or of the kernels of a relay. */
struct operation_count emit_operations(const struct emission *e);

/* The table NAME_info as adjacent string literals. */
void emit_info(const struct emission *e, struct text *out);

/* Where the elements of matrices stand in them: lines of the table; arrays of rows and of columns as C declares and defines
   them, with an empty line before; a member of the object of --info=json. Nothing where no matrix is wanted. */
void emit_info_matrices(const struct emission *e, struct text *out);
void emit_pattern_declarations(const struct emission *e, struct text *out);
const char *emit_patterns(const struct emission *e);
void emit_pattern_json(const struct emission *e, struct text *out);

/* Of the regressor: which columns are of which link, as lines of the table (nothing where it is not wanted); the same for a
   reader, with the rows that feel them. A name that may hold a newline, to the end of a line of the table. */
void emit_info_parameters(const struct emission *e, struct text *out);
void emit_regressor_legend(const struct emission *e, struct text *out);
/* What jvp, and vectors of products, are of. */
void emit_product_legend(const struct request *k, const struct argument *a, struct text *out);
void emit_info_name(const char *s, struct text *out);

/* The macros of the operations, as compilers of such texts take them. */
const char *emit_arithmetic(const struct emission *e, const struct target_type *target);

/* Flags of compilers that the text refuses, as it would be wrong by them. */
const char *emit_ieee(const struct emission *e);

/* What takes those of --strict back at the end of a header, and those of the residual's type. */
const char *emit_undef_strict(const struct emission *e);
const char *emit_undef_wide(const struct emission *e);

/* The sine and cosine function that the statements call; its declaration, which stands before them; its name, by the type of
   numbers. */
const char *emit_sincos_name(const struct emission *e, const struct number_type *n);
const char *emit_sincos(const struct emission *e);
const char *emit_sincos_declaration(const struct emission *e);

/* Headers: names and limits of the joints. */
const char *emit_joints(const struct emission *e);

/* What can stand in a string of C, whatever `s` holds. */
void emit_literal(const char *s, size_t length, struct text *out);

/* A function's arguments as parameters (SIZED: of one sample, with their rows, so that compilers see arrays that are too short;
   FIRST: of a segment, at the first of its samples), as their names, as addresses, out of an array of pointers, or moved on to
   sample k of a batch. */
enum params {
	PARAMS_PLAIN, PARAMS_SIZED, PARAMS_FIRST, PARAMS_RESTRICT, PARAMS_CUDA_RESTRICT, PARAMS_NAMES, PARAMS_ADDRESSES, PARAMS_ARRAYS,
	PARAMS_AT_SAMPLE
};
const char *emit_params(const struct emission *e, const struct function *p, enum params kind);
const char *emit_q_at_sample(const struct emission *e);
void emit_put_at_sample(const struct emission *e, const struct argument *a, struct text *out);

/* Arrays of this layout moved on to sample k of a batch, and the stride of their rows. */
const char *emit_at_sample(const struct emission *e, const struct function *p, enum rneagen_layout layout);

/* From one row of a batch to the next. */
const char *emit_stride(const struct emission *e);
const char *emit_q_stride(const struct emission *e);
/* A batch's count as a parameter, before others, where it is the stride: in layout soa. */
const char *emit_count_param(enum rneagen_layout layout);

/* C: the macros that the bodies use, the functions that call them, and their declarations. */
const char *emit_head_c(const struct emission *e);
const char *emit_functions_c(const struct emission *e);
const char *emit_prototypes(const struct emission *e);

/* Are there functions, or kernels, that take batches? */
int emit_has_batches(const struct emission *e);

/* Mark the arguments that these lines read or write. Returns whether they need the stride from row to row. */
int emit_mark_arguments(const struct emission *e, const struct plan *p, unsigned char *used);

/* What a segment reads and writes: these arguments, and of what goes across, wide or not, whether any, and whether beyond the
   first. */
struct touched {
	unsigned char arguments[DAG_EVERY];
	int across[2], step, stride;
};

struct touched emit_touched(const struct emission *e, const struct plan *p);

/* Parameters that these lines, some or all of the function's, do not read: `prefix` goes before the names of what each sample
   has its own of. */
void emit_unused(const struct emission *e, const struct plan *p, const char *prefix, struct text *out);

#define EMIT_RETURNS                                                                                                   \
	"   known: sines holds the sine and cosine of each angle. Returns whether all angles are small: if not, and not `known`,\n" \
	"   the results mean nothing.\n"
int emit_has_segments(const struct emission *e);
/* A function in segments: the body of each; target C: the functions of a sample and of a part of a batch; CUDA: its kernel. */
void emit_segments(const struct emission *e, const struct function *p, struct text *out);
void emit_segments_one(const struct emission *e, const struct function *p, struct text *out);
void emit_segments_group(const struct emission *e, const struct function *p, const char *where_small, struct text *out);
const struct function *emit_many_of(const struct function *p); /* what a batch runs: its own, or the function itself */
int emit_segments_lanes(const struct emission *e, const struct function *p); /* samples of such a group */

/* What a call of one sample runs in lanes, and a batch does not; NULL: there is nothing. Its bodies, and the call, of a function
   that has such or has not. */
#define EMIT_IF_LANES "#if defined RNEA_LANES\n"
#define EMIT_UNLESS_LANES "#if !defined RNEA_LANES\n"
const struct function *emit_lanes_alone(const struct function *p);
int emit_lanes_instead(const struct emission *e, const struct function *p); /* of the function's own, which no batch calls */
void emit_lanes_call_bodies(const struct emission *e, const struct function *p, struct text *out);
void emit_lanes_call(const struct emission *e, const struct function *p, struct text *out);
/* What the function of one sample does. */
const char *emit_one_call(const struct emission *e, const struct function *p);
/* The function of one sample, with any angles, that batches call: its name; its text where it is not the body, alone or after a
   comment. */
const char *emit_any_name(const struct emission *e, const struct function *p);
const char *emit_any(const struct emission *e, const struct function *p);
void emit_put_any(const struct emission *e, const struct function *p, struct text *out);

/* The arrays of what goes across cuts, or the one that there is: as parameters; the same where compilers are to know that they
   overlap nothing; as those of a segment, for its first sample; their names; their declarations with room for a sample, or for
   some lanes; in a kernel, for all threads; where a thread's sample has them. */
enum across_form { ACROSS_PARAMETER, ACROSS_RESTRICT, ACROSS_FIRST, ACROSS_NAME, ACROSS_LOCAL, ACROSS_LANES, ACROSS_SHARED,
	ACROSS_AT_THREAD };
const char *emit_across(const struct emission *e, const struct segments *s, enum across_form form);

/* How many samples a segment runs for. */
int emit_lanes(const struct emission *e, const struct segments *s);

/* Does a kernel of this function store the elements of matrices that are always zero in a loop, beside the statements? Is this
   the store of one? Where the statements of a function have them apart, under which condition; NULL: among the others. What the
   loops of the first function call, and the loops: every `step`th run, from the number `first` on. */
int emit_has_zeros(const struct emission *e, const struct function *p);
int emit_is_zero_store(const struct plan *p, const struct line *l);
const char *emit_zeros_unless(const struct emission *e, const struct function *p, int is_beside);
void emit_zeros(const struct emission *e, struct text *out);
const char *emit_zero_loops(const struct emission *e, const char *first, const char *step);
/* By argument, how many rows others write than the kernel that transposes outputs, which writes the zeros; NULL: they write all.
   And of an array, which rows are zeros, 1 each. */
const int *emit_kept_rows(const struct emission *e);
const unsigned char *emit_zero_rows(const struct emission *e, int argument);

/* Where the run ends of elements that are as the first one is. */
int emit_run_end(const unsigned char *mask, int rows, int first);

/* `{10, 7}, {18, 2}`: the rows of an array that these outputs leave always zero, from a row on so many. Returns how many such
   runs there are. */
int emit_zero_runs(const struct emission *e, const struct dag *d, const struct output *outputs, size_t count, int argument,
	struct text *out);

/* A call of a body. */
struct call {
	const char *indent, *arguments, *q, *stride;
	const char *q_stride; /* NULL: stride */
	int is_any;        /* the sines of all angles come first, as on a processor; else only where one is large */
	/* in a kernel, on sample k: they come where one turned out to be large, and the body then runs again */
	int is_optimistic;
	/* of a kernel that has slices of its own; NULL: the whole. The sines of all angles are then made of the array itself */
	const struct part *part;
	int is_staged;       /* of a part: see emit_more */
	int is_tiled;        /* inputs are in tiles */
	int has_threads;     /* limbs of a sample have threads of their own, and blocks some without a sample */
	const char *handed;
};

/* The call, and what comes before and after it so that the results are right whatever the angles. */
const char *emit_call(const struct emission *e, const struct function *p, const struct call *c);
const char *emit_call_any(const struct emission *e, const struct function *p); /* of a sample in a batch, whatever its angles */

/* What the main function computes: its algorithm's formula, or in words where a scene asks for other arrays. */
const char *emit_what(const struct emission *e);
/* What goes in and what comes out: "q[7], qd[7], qdd[7] -> tau[7]." */
const char *emit_dimensions(const struct emission *e);

/* The number in digits. */
const char *emit_int(const struct emission *e, int value);

/* Is there a value of the quantity that has a name, "w" in w3x? */
int emit_names(const struct plan *p, const char *quantity);

/* The part of it that explains the names of the statements. */
void emit_legend(const struct emission *e, struct text *out);

/* The comment at the head of the text. */
const char *emit_banner(const struct emission *e);

/* The whole .cu, .c or header; for target C, also the .h that declares its functions. */
void emit_source(const struct emission *e, struct text *out);
void emit_declarations(const struct emission *e, struct text *out);

/* In accurate mode the bodies take two arguments more, which say whether sines and cosines are known, and what they are: the
   statements have no branch, and large angles are taken care of before them. Not where angles are not q alone. */
int emit_has_known(const struct emission *e);

/* The angles of a function, each once, in the order of the statements: those whose sines are wide numbers, or the others. A part
   has those of the whole. */
struct angles emit_angles(const struct emission *e, const struct function *p, int is_wide);
int emit_has_angles(const struct emission *e, const struct function *p);

/* Those two arguments: as parameters after others, "" where there are none; as they are handed on; as they are where nothing
   is known. */
const char *emit_known_params(const struct emission *e);
const char *emit_known_names(const struct emission *e);
const char *emit_unknown_names(const struct emission *e);
/* The same in C functions, with tables of which nobody reads, where a body has angles; and the declarations of these. */
const char *emit_unread_names(const struct emission *e, const struct function *p);
const char *emit_unread_tables(const struct emission *e);
/* Such names behind the other arguments of a call: nothing where bodies take none. */
const char *emit_handed_on(const struct emission *e, const char *names);

/* `known` and the tables that a function has, after it was declared by emit_rounds: a kernel's loops over the segments, and again
   for each sample of which an angle is large. */
const char *emit_known_tables(const struct emission *e, const struct function *p);
void emit_rounds(const struct emission *e, const struct function *p, const char *loops, struct text *out);

/* The test of a sample's angles, in accurate mode, with those functions; the same of a part's angles alone. */
const char *emit_is_small(const struct emission *e);
void emit_part_small(const struct emission *e, const struct part *part, struct text *out);

/* Does each part for matrices ask of the rows that it reads alone? The functions that do; the one that asks for
   a block's part. */
int emit_asks_by_parts(const struct emission *e);
void emit_parts_small(const struct emission *e, int is_alone, struct text *out);
void emit_part_asks(const struct emission *e, struct text *out);

/* The functions that fill the tables of sines; the macro that tells the runtime what stack they take. */
const char *emit_sines(const struct emission *e);
const char *emit_sines_bytes(const struct emission *e);

/* Is the text one operation alone, rather than algorithms? */
static inline int emit_is_operation(const struct emission *e)
{
	return e->banner != NULL;
}

#endif
