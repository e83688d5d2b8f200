#ifndef RNEAGEN_EMIT_H
#define RNEAGEN_EMIT_H
/* Text is made here, and only here: plans become statements, statements fill the templates. */

#include "plan.h"
#include "rnea.h"
#include "rneagen.h"

/* One generated function on its way to text. */
struct pass {
	const struct algorithm *algorithm;
	struct dag raw, dag; /* as the algorithm made it; fused */
	struct plan plan;
};

struct emission {
	const struct tree *tree;
	const struct rneagen_options *options; /* defaults resolved: precision, name, file */
	const struct pass *passes;             /* PASS_COUNT */
	const char *const *warnings;
	size_t warning_count;
	const char *hash; /* SHA-256 of the URDF, in hex */
	struct arena *arena;
	struct rneagen_error *error;
};

/* The statements of a pass, each indented by one tab. Errors: NUMBER when a constant is no finite number in the
   target's precision. */
void emit_body(const struct emission *e, const struct pass *p, struct text *out);

/* A number that reads back as the same value in the precision: the shortest decimal that does. */
void emit_number(const struct emission *e, real value, struct text *out);

/* The table NAME_info as adjacent string literals. */
void emit_info(const struct emission *e, struct text *out);

/* Its middle part: the block and the arguments. */
void emit_info_shape(const struct emission *e, struct text *out);

/* The sine and cosine function that the statements call. */
void emit_sincos(const struct emission *e, struct text *out);

/* The comment at the head of the text. */
void emit_banner(const struct emission *e, struct text *out);

/* The whole .cu, .c or header; for target C, also the .h that declares its functions. */
void emit_source(const struct emission *e, struct text *out);
void emit_declarations(const struct emission *e, struct text *out);

/* In accurate mode the functions take one argument more, which says whether all angles are small: one branch instead of
   one for each joint. */
static inline int emit_has_small(const struct emission *e)
{
	return e->options->trig == RNEAGEN_ACCURATE;
}

static inline int emit_is_f32(const struct emission *e)
{
	return e->options->precision == RNEAGEN_F32;
}

#endif
