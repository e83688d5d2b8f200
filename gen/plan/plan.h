#ifndef RNEAGEN_PLAN_H
#define RNEAGEN_PLAN_H
/* What the text will say, before it is text: which values get a line of their own, what they are called, and the order
   of the lines. One plan serves every target. */

#include "dynamics/registry.h"
#include "tree/alike.h"

enum line_kind { LINE_SECTION, LINE_INPUT, LINE_VALUE, LINE_SINCOS, LINE_STORE, LINE_FETCH, LINE_KEEP, LINE_SINE, LINE_JOIN,
	LINE_KINDS };

struct line {
	enum line_kind kind;
	struct ref value;   /* INPUT, VALUE, FETCH, KEEP, SINE; SINCOS: the sine or the cosine, whichever came first */
	size_t index;       /* SECTION: into dag->sections; STORE: into dag->outputs; FETCH, KEEP: the slot; SINE: where in the table */
};

struct plan {
	const struct dag *dag;
	const struct tree *tree;
	const char **names; /* per node; NULL: written where it is used */
	struct line *lines;
	size_t line_count;
};

/* The plan once more, in stretches that each run for several samples before the next one does (segments.h). */
struct segments {
	int count;          /* 0: the plan is whole */
	struct plan *plans; /* each the lines of one, what it fetches and keeps among them */
	int slots[2];       /* of a sample across the cuts: of numbers, of wide numbers */
	int carried;        /* numbers that a sample's coordinates carry in a batch, in loops over these */
};

/* Each angle once, in the order of the statements. */
struct angles {
	const struct dag *dag;
	struct ref *angle;
	int count;
};

/* The plan once more, shared out among warps that wait for each other between phases (limbs/limbs.h). */
struct limbs {
	int warps;          /* 0: there are none */
	struct plan *plans; /* each the lines of a warp, what it fetches and keeps among them, and where it waits */
	int phases;
	int slots;          /* of a sample, for what goes across */
	int alive;          /* values that a warp has at once at most */
	/* whose sines all threads make before the first phase, by their rows; none: a warp makes those that it takes */
	struct angles first;
	unsigned longest, whole; /* operations of the longest warp, the phases after each other, and of the whole plan */
	unsigned sum;       /* of all warps */
	/* of the kernel, whose functions have the same */
	int words;      /* of a sample in shared memory: what goes across, and then sines that are made first */
	int groups;     /* of 32 samples, in a block at most */
	unsigned most;  /* samples of a batch up to which it is launched */
};

/* Rows of an output that leave together, and in which slot each stands: the last is the one of zeros. */
struct window_run {
	int argument;
	unsigned row, count;
	const int *slots;
};

/* What leaves together. */
struct window_flush {
	struct window_run *runs;
	int count;
};

/* Outputs on their way through windows of shared memory (stage.h). */
struct windows {
	int slots;   /* of a window, the one of zeros not among them; 0: there are none */
	int *slot;   /* of each output; -1: it is always zero */
	int *before; /* of each output: which flush comes before it, from 1; 0: none */
	struct window_flush *flushes; /* flush_count of them, the last at the end */
	int flush_count;
};

/* Loops over alike limbs (lanes/each.h), by number from 1. */
struct each {
	int limbs, count;                  /* turns of each loop; loops */
	int shift[ALIKE_GROUPS + 1];       /* from the rows of one limb to those of the next one */
	int first[ALIKE_GROUPS + 1][ALIKE_LIMBS], bodies[ALIKE_GROUPS + 1]; /* the first body of each limb; how many it has */
	const unsigned char *loop;         /* by node: which one makes it; 0: none */
	int number_count;                  /* constants that are not the same in all limbs, in a table */
	const int *number;                 /* of the table: which of the DAG's lanes it is */
	const int *place;                  /* of the DAG's lanes: where it stands, from 1; less than 0: its negation does */
	int is_apart;                      /* no loop takes what another one has left */
	int most_block; /* where each limb has threads of its own in a kernel, in blocks of so many samples at most; 0: it has none */
};

/* One generated function on its way to text. */
struct function {
	const struct algorithm *algorithm;
	struct dag dag; /* fused */
	struct plan plan;
	struct segments segments;
	struct windows windows;
	struct limbs limbs;
	/* of a part of a kernel: the same with loops over alike limbs, which its text then has; NULL: none */
	const struct function *each;
	const struct each *loops;  /* of such a function */
	const struct stretches *stretches; /* of a part that shares nothing with the others (grid/apart.h): its rows; NULL: it may */
	const struct stretches *tiles;     /* what a kernel of large batches moves by tensor maps (tiles/tiles.h); NULL: it has none */
	/* target C: what a call for one sample runs, in lanes (lanes/lanes.h), where compilers have vectors */
	const struct function *beside;
	int lanes_in_batches;      /* so does what a batch leaves over: nothing promises its bits */
	const struct function *single; /* target C: in segments too, and what a call for one sample runs instead; NULL: nothing else */
	const struct function *many;   /* the same for batches */
	const struct output *zeros; /* zero_count of them: outputs of `many` that are always zero, and of no line */
	size_t zero_count;
};

struct operation_count {
	unsigned mul, add, sub, neg, fma, sincos;
	unsigned wide; /* flops of them that are in wide numbers */
};

/* The DAG must be fused. Returns 0 when memory runs out. */
int plan_build(struct plan *p, const struct dag *d, const struct tree *t, struct arena *a);

/* The same, and a value has a line too where the inputs of earlier joints are enough for it than its reader takes: of a sum over
   limbs, what the limbs so far have made of it. */
int plan_build_by_joints(struct plan *p, const struct dag *d, const struct tree *t, struct arena *a);

/* What is put into another order: a function, a part that shares nothing with others, what has loops over limbs, which takes
   any order in which rows are written late, or what makes the base's acceleration of all limbs, one after the other. */
enum plan_ordered { ORDERED_WHOLE, ORDERED_PART, ORDERED_LOOPS, ORDERED_BASE };

/* There is room for the line. */
void plan_add_line(struct plan *p, enum line_kind kind, struct ref value, size_t index);

/* Puts the DAG of a function, and its plan, into an order in which fewer values wait, where it finds one (order.c). Returns 0
   when memory runs out. */
int plan_order(struct function *p, const struct tree *t, const struct request *k, const struct rneagen_options *o,
	enum plan_ordered what, struct arena *a);

/* The node that holds the sine (op OP_SIN) or cosine (OP_COS) of the same angle; node 0 if nobody needs it. */
struct ref plan_partner(const struct plan *p, struct ref sincos, enum op op);

/* Angles whose sine, cosine or both it computes. */
unsigned plan_sincos(const struct plan *p);

/* Operations of the DAG as it is written; a sine and cosine of one angle count once, a quotient or root as a product. */
struct operation_count plan_operations(const struct plan *p);

/* The same of some nodes, without sines and cosines. */
struct operation_count plan_operations_of(const struct dag *d, size_t first, size_t end);

/* Add them, so many times. */
void plan_add_operations(struct operation_count *sum, struct operation_count n, unsigned times);

/* A joined product and sum are one; signs, sines and cosines are not counted. */
unsigned plan_instructions(struct operation_count n);

/* A joined product and sum are two; signs, sines and cosines are not counted. */
unsigned plan_flops(struct operation_count n);

/* The most values that are alive at once, if each is made where it stands and dies with its last use: about the registers
   that a kernel needs beside its addresses. */
int plan_alive(const struct plan *p, struct arena *a);

/* The same, and how many of them have no room, summed over the nodes. */
struct waits {
	int most;
	size_t beyond;
};

struct waits plan_waits(const struct plan *p, int room, struct arena *a);

void plan_dump(const struct plan *p, struct text *t);

#endif
