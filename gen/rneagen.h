#ifndef RNEAGEN_H
#define RNEAGEN_H
/* librneagen: from the text of a URDF to straight-line CUDA C or C for that robot's inverse dynamics,
   tau = ID(q, qd, qdd), by the recursive Newton-Euler algorithm (Luh, Walker, Paul 1980; Featherstone, Rigid Body
   Dynamics Algorithms, 2008, chapter 5). SI units. Re-entrant: no function keeps state between calls. */

#include "base/arena.h"
#include "base/error.h"
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RNEAGEN_VERSION "0.1.0"

/* RNEAGEN_TARGET_CUDA, ..., and the words of --target. */
#define RNEAGEN_TARGETS(X) X(CUDA, "cuda") X(C, "c") X(HEADER, "header")
/* RNEAGEN_F32, ..., and the words of --precision. mixed: f32 in memory, f64 in arithmetic; f32x2: f64 in memory, pairs of
   floats in arithmetic. */
#define RNEAGEN_PRECISIONS(X) X(F32, "f32") X(F64, "f64") X(MIXED, "mixed") X(F32X2, "f32x2")

#define RNEAGEN_TARGET_ENUM(name, word) RNEAGEN_TARGET_##name,
enum rneagen_target { RNEAGEN_TARGETS(RNEAGEN_TARGET_ENUM) RNEAGEN_TARGET_COUNT };
#undef RNEAGEN_TARGET_ENUM
#define RNEAGEN_PRECISION_ENUM(name, word) RNEAGEN_##name,
/* default: f64 for C, else f32 */
enum rneagen_precision { RNEAGEN_PRECISION_DEFAULT, RNEAGEN_PRECISIONS(RNEAGEN_PRECISION_ENUM) };
#undef RNEAGEN_PRECISION_ENUM
enum rneagen_layout { RNEAGEN_SOA, RNEAGEN_AOS };                                /* [row][sample], [sample][row] */
enum rneagen_trig { RNEAGEN_ACCURATE, RNEAGEN_BOUNDED, RNEAGEN_FAST,
	RNEAGEN_TRIG_AUTO }; /* bounded where the scene states a range for every joint's angle, else accurate */
enum rneagen_base { RNEAGEN_FIXED, RNEAGEN_FLOATING };
enum rneagen_mimic { RNEAGEN_MIMIC_HONOUR, RNEAGEN_MIMIC_INDEPENDENT };
/* the closer ones, or those that are found faster, beside each statement */
enum { RNEAGEN_BOUNDS_CLOSE = 1, RNEAGEN_BOUNDS_RUNNING };

/* What --only leaves of a text's functions: the main one, whichever that is, or by its name. */
#define RNEAGEN_ONLY_WORDS(X) X(RNEA, "rnea") X(FD, "fd") X(KIN, "kin")
enum { RNEAGEN_ONLY_MAIN = 1, RNEAGEN_ONLY_RNEA, RNEAGEN_ONLY_FD, RNEAGEN_ONLY_KIN };
enum { RNEAGEN_PARTS_AUTO = 0, RNEAGEN_SEGMENTS_AUTO = 0, RNEAGEN_SEGMENTS_WHOLE = 1, RNEAGEN_LIMBS_AUTO = 0,
	RNEAGEN_LIMBS_NONE = 1 };
/* What there is to tell beside the text. */
enum rneagen_tell { RNEAGEN_TELL_INFO = 1, RNEAGEN_TELL_JSON = 2, RNEAGEN_TELL_DOT = 4,
	RNEAGEN_TELL_ALL = RNEAGEN_TELL_INFO | RNEAGEN_TELL_JSON | RNEAGEN_TELL_DOT };

/* What a pass has made, or PASSES: the list of them. */
enum rneagen_dump { RNEAGEN_DUMP_NONE, RNEAGEN_DUMP_ROBOT, RNEAGEN_DUMP_TREE, RNEAGEN_DUMP_DAG, RNEAGEN_DUMP_PLAN,
	RNEAGEN_DUMP_SCENE, RNEAGEN_DUMP_REQUEST, RNEAGEN_DUMP_PARTS, RNEAGEN_DUMP_PASSES, RNEAGEN_DUMP_PARAMS,
	RNEAGEN_DUMP_SEGMENTS, RNEAGEN_DUMP_LIMBS, RNEAGEN_DUMP_KERNELS };

/* What to generate. Start from rneagen_options_default(). Strings belong to the caller and must outlive the call. */
struct rneagen_options {
	enum rneagen_target target;
	enum rneagen_precision precision;
	enum rneagen_layout layout;
	enum rneagen_trig trig;
	enum rneagen_base base;
	enum rneagen_mimic mimic;
	int strict; /* the same bits from every compiler, CPU and GPU, for all results that are not NaN */
	int bounded; /* target C: also a function that gives a bound of each output's error: of how far it is from what the URDF's
			decimals give in exact arithmetic (eval.h says it in full); 0, or of RNEAGEN_BOUNDS_* */
	int only; /* of RNEAGEN_ONLY_*: the main function without the halves of the algorithm and, in target c, without the
		     functions that take batches; one that is named has to be the main one. 0: all */
	int parts; /* of the grid, target CUDA: each makes some elements of the matrices; default RNEAGEN_PARTS_AUTO: as few as the
		      registers and the instruction cache have room for, 1 where a text cannot be split */
	int segments; /* operations of a segment at most: a stretch of a text that runs for several samples before the next one does;
			 default RNEAGEN_SEGMENTS_AUTO: where that is faster, or compiles faster; RNEAGEN_SEGMENTS_WHOLE: none */
	int limbs; /* warps of a kernel for small batches, which share out each sample; default RNEAGEN_LIMBS_AUTO: where that is
		      faster; RNEAGEN_LIMBS_NONE: there is no such kernel */
	double gravity[3];  /* m/s^2, in the world's frame, of a fixed robot that of the root link; default 0 0 -9.81. Bounds hold for
			       any decimals that are read as these doubles; a whole number is meant as it is */
	const char *order;  /* names of all joints with entries in q, comma-separated; NULL: depth-first, by name */
	const char *name;   /* a C identifier; NULL: the robot's name made one */
	const char *file;   /* name of the input, for messages and the text's header; NULL: "<input>" */
	const char *scene;  /* what of the robot is modelled: one choice on a line, as in the command's --scene FILE; NULL: all */
	enum rneagen_dump dump;
	unsigned tell; /* which of rneagen_tell are wanted, added; default none: they may take longer to make than the text */
	const struct rneagen_allocator *allocator; /* NULL: malloc and free */
	/* Called before each pass: what it makes, "expressions of the outputs" for one; NULL: nobody is told */
	void (*progress)(void *context, const char *makes);
	void *progress_context;
};

/* What was generated; every string is NUL-terminated and owned by the struct (rneagen_result_free). */
struct rneagen_result {
	const char *name;      /* the identifier that prefixes every function */
	const char *source;    /* the .cu, .c or header text; NULL where a dump is asked for */
	const char *header;    /* target C, and no dump: the .h that declares the functions; NULL otherwise */
	const char *info;      /* the table of --info; NULL unless asked for, as the next two */
	const char *info_json; /* the object of --info=json */
	const char *dot;       /* the graph of --dot, for Graphviz */
	const char *dump;      /* NULL unless asked for */
	const char *const *warnings;
	size_t warning_count;
	struct arena arena; /* private */
};

struct rneagen_options rneagen_options_default(void);

/* Generate from `length` bytes of URDF at `urdf`. On failure `result` is empty (nothing to free) and `error` holds the
   code and one line that names the file and the link, joint or option. */
enum rneagen_code rneagen_generate(const char *urdf, size_t length, const struct rneagen_options *options,
	struct rneagen_result *result, struct rneagen_error *error);

void rneagen_result_free(struct rneagen_result *result);

#ifdef __cplusplus
}
#endif
#endif
