#ifndef RUNTIME_SIGNATURE_H
#define RUNTIME_SIGNATURE_H
/* What a text takes and gives, in the order of rnea_info(), by the names that the scene and the text have for it. */

#include "passes/analysis.h"
#include "rnea.h"

struct signature_array {
	const char *word, *name; /* of the scene, of the text: "payload.left hand", "payload_left_hand" */
	size_t rows;
	enum role role;
	int is_output, per_batch;
	int has_default;     /* the input may be left out */
	const real *nominal; /* its rows are these then; NULL: 0 */
};

struct signature {
	struct signature_array arrays[DAG_ARGUMENTS];
	size_t count;
	int is_plain; /* q, qd, qdd -> tau */
};

/* Strings live in a->arena. Returns 0 when memory runs out. */
int signature_of(struct signature *s, struct analysis *a);

/* The input or output whose word or name is the first `length` characters of `text`; -1: none. */
int signature_find(const struct signature *s, const char *text, size_t length, int is_output);

/* The word nearest to a misspelt one; NULL: none is near. */
const char *signature_nearest(const struct signature *s, const char *word, int is_output);

/* Does a compiled text take the arrays of the DAG that was analysed? */
int signature_fits(const struct dag *d, const struct rnea_info *info);

#endif
