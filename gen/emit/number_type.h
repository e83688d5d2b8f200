#ifndef RNEAGEN_NUMBER_TYPE_H
#define RNEAGEN_NUMBER_TYPE_H
/* How a text writes numbers: a record for each --precision, and for the pairs of value and bound of --bounded. The walk over
   the plan (unparse.c) and the frames ask these; nothing else tells one type of numbers from another. */

#include "dag/eval_model.h"
#include "dag/ops.h"
#include "rneagen.h"

struct emission;
struct unparser;
struct node;
struct text;

/* What arrays hold, or what constants are rounded to and functions of arithmetic are named after. */
struct scalar {
	const char *name;          /* in options and tables: "f32" */
	const char *type;          /* in the text: "float" */
	const char *suffix;        /* of functions: "f" in fmaf; of macros "F" in FP_FAST_FMAF, HUGE_VALF */
	const char *upper;
	const char *letter;        /* of a GPU's instructions and registers: "f" in __fadd_rn */
	int bytes;
	double domain;             /* the largest angle of the bounded sine and cosine */
	double unit, tiny;         /* unit roundoff; above what underflow takes from a constant */
	const char *unit_text, *tiny_text, *largest; /* as the text writes them: unit, more than underflow takes from an
							operation, the largest number */
	int flushes;               /* a GPU may flush what is subnormal to zero */
	const char *more;          /* in a message, what has room for a constant that is too large for this; "" nothing */
	real (*round)(real x);     /* to the nearest that the type has */
	void (*write)(double x, char *s, size_t size); /* a literal: the fewest digits that read back as x, which the type has */
};

/* What stands before and after a value. */
struct around {
	const char *before, *after;
};

/* Templates of sine and cosine. Each text has the core, and what its --trig takes. */
struct sincos_frames {
	const char *core, *bounded, *accurate, *known;
	const char *fast;  /* a GPU's own unit; NULL: it has none for this type */
	const struct sincos_frames *large; /* of the type that takes the large angles in accurate mode; NULL: this one */
};

struct number_type {
	const struct scalar *memory, *arithmetic;
	const char *value;                            /* the type of a value: "double", "struct rneagen_f32x2" */
	const char *const *calls, *const *strict_calls; /* by operation, what is called with the operands; NULL: a sign
							   stands between them. With --strict the second */
	const char *splat;                            /* of vectors: `NAME(`, what makes one of a number; NULL: it is no vector */
	const char *sincos, *strict_sincos;           /* what is called, but for the mode's name */
	struct around load, store;                    /* from memory and to it */
	int store_is_cast;                            /* which binds as a sign does */
	struct around angle;                          /* of a value as an argument of sine and cosine */
	int angle_is_memory;                          /* these take an input as memory has it */
	int is_beside; /* the statements stand beside those of a body and store bounds: their rows have no stride, and sine and
			    cosine are not told whether angles are small */
	void (*put_constant)(const struct unparser *u, const struct node *n, struct text *out);
	/* a cheaper way to write an operation, and 1; or nothing, and 0; NULL: there is none */
	int (*put_cheaper)(const struct unparser *u, const struct node *n, struct text *out);
	void (*put_functions)(const struct emission *e, struct text *out); /* that the operations call; NULL: none */
	struct around widen, narrow;                  /* as wide numbers of a text in f32: from a float, and rounded to one */
	const char *note;                             /* for the head of a text */
	const struct sincos_frames *frames;
	const struct number_type *lanes;              /* limbs, or coordinates, side by side; NULL: none */
	const struct number_type *bounded;            /* pairs of such a number and a bound of its error; NULL: none */
	struct eval_model model;                      /* of its arithmetic, but for what options say */
	double fast_sine, fast_cosine, fast_angle;    /* of the model with frames->fast: powers of two, the largest angle */
	int fuses;                                    /* a product joined to a sum may be rounded with it */
};

/* By --precision, with one row here for each of RNEAGEN_PRECISIONS. */
#define NUMBER_TYPE_DECLARATION(upper, word) extern const struct number_type NUMBER_##upper;
RNEAGEN_PRECISIONS(NUMBER_TYPE_DECLARATION)
#undef NUMBER_TYPE_DECLARATION

extern const struct scalar SCALAR_F32, SCALAR_F64;
extern const struct sincos_frames SINCOS_F64;
/* Wide numbers in a text whose numbers have fewer bits: the same types, with functions of their own names. */
extern const struct number_type WIDE_F64, WIDE_F32X2;
/* Of several columns side by side. */
extern const struct number_type COLUMNS_F32, COLUMNS_F64;
/* Of several limbs, or coordinates, side by side. */
extern const struct number_type LANES_F32, LANES_F64;
extern const struct number_type WITHIN_F32, WITHIN_F64, WITHIN_MIXED;

const struct number_type *number_type_of(enum rneagen_precision precision);

/* The arithmetic of a text with these options: its precision and its own sine and cosine, products joined to sums rounded
   once or twice; on a GPU once, and with its own unit for the trigonometry "fast". Of that the CUDA C++ Programming Guide
   (Mathematical Functions, Intrinsic Functions) says: for x in [-pi, pi] the maximum absolute error is 2^-21.41 of __sinf
   and 2^-21.19 of __cosf, "and larger otherwise"; found by extensive tests, not guaranteed. Beyond pi, where it grows
   with x, the model knows nothing. */
struct eval_model eval_model_of(const struct rneagen_options *o, int on_gpu);

#endif
