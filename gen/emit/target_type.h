#ifndef RNEAGEN_TARGET_TYPE_H
#define RNEAGEN_TARGET_TYPE_H
/* What a text is for: a record for each --target. Its frames are templates, with @SLOTS@ that emit.c fills. */

#include "rneagen.h"

/* Of targets with kernels. */
struct kernel_frames {
	const char *direct, *staged_aos, *staged_soa; /* a kernel: on the arrays themselves, or on slices in shared memory */
	const char *windowed;                         /* or on inputs themselves, and on windows of outputs */
	const char *again;                            /* the call of a body, and again where an angle is large */
	const char *parts, *apart;                    /* the body that is in parts; the kernel of parts that share nothing */
	const char *spill;                            /* what gives registers more room; at the head of a kernel of derivatives */
	const char *slices, *stage, *stage_aos, *stage_launch; /* shared memory: declared, filled, and given by a launch */
	const char *stage_start; /* of a relay's first kernel */
	const char *stage_rows_aos, *stage_join, *stage_join_threads; /* filled with some rows of each sample; three slices made one */
	const char *stage_copy, *stage_bulk, *stage_come; /* how it is filled: by threads, by a copy engine; when it is */
	const char *store, *store_tiles, *windows;    /* what RNEA_STORE means, and where to a tile; RNEA_HOLD and RNEA_FLUSH */
	const char *prefetch;                         /* what asks for a sample's inputs in advance */
	const char *zeros;                            /* what stores the elements that are always zero */
	const char *compiler;                         /* a macro that the compiler of kernels defines */
};

struct target_type {
	const char *const *suffixes;        /* of files that hold such texts, up to NULL */
	enum rneagen_precision precision;   /* where none is named */
	const char *frame;                  /* of the text */
	const char *declarations;           /* of the .h beside it; NULL: there is none */
	const char *arithmetic, *strict_arithmetic; /* what RNEA_FMA and, with --strict, the other operations mean */
	const char *patterns;               /* of the tables of where the elements of matrices stand; NULL: it has none */
	const struct kernel_frames *kernel; /* NULL: there are no kernels */
	int has_unit;                       /* may run where there is a unit for sine and cosine */
	int has_batches;                    /* some functions take batches */
	int is_header;                      /* C++ too; functions of one sample, without loops over columns or a table for librnea */
	const char *aliases;                /* which arrays of a sample may be one */
	const char *note;                   /* for the head of the text */
};

/* With one row here for each of RNEAGEN_TARGETS. */
#define TARGET_DECLARATION(upper, word) extern const struct target_type TARGET_##upper;
RNEAGEN_TARGETS(TARGET_DECLARATION)
#undef TARGET_DECLARATION

const struct target_type *target_type_of(enum rneagen_target target);

/* The word of --target. */
const char *emit_target_name(enum rneagen_target target);

#endif
