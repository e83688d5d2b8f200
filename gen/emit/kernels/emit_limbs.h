#ifndef RNEAGEN_EMIT_LIMBS_H
#define RNEAGEN_EMIT_LIMBS_H
/* The kernel of small batches, whose warps share out each sample (plan/limbs). */

#include "emit/emit.h"

/* CUDA: the kernel of small batches, whose warps share out each sample, where there is one, with that of a relay's first kernel;
   what launches them; what is to be known of them, of warps, groups and samples (of the relay's: NULL where there is none), and
   the bytes of shared memory of a group. */
int emit_has_limbs(const struct emission *e);
void emit_limbs(const struct emission *e, struct text *out);
const char *emit_launch_limbs(const struct emission *e);
const char *emit_launch_start_limbs(const struct emission *e);
const struct limbs *emit_limbs_of(const struct emission *e);
const struct limbs *emit_start_limbs(const struct emission *e);
int emit_limbs_bytes(const struct emission *e, const struct limbs *s);

/* Do warps ask for sines that may be known, as the other kernels do: those that make sines themselves? Not where all are made
   first. */
int emit_limbs_know(const struct emission *e);

/* What a program of that kernel alone leaves out. */
#define EMIT_UNLESS_LIMBS "#if !defined RNEA_ONLY_LIMBS\n"
const char *emit_unless_limbs(const struct emission *e, const char *what);

/* By what the warps of a limbs' kernel wait for each other. */
#define EMIT_JOIN "RNEA_JOIN"

#endif
