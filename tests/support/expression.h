#ifndef TESTS_EXPRESSION_H
#define TESTS_EXPRESSION_H
/* DAGs written in prefix notation, for tables: inputs x y z w, numbers, and
     + a b   - a b   * a b   n a (the sign)   s a   c a (sine, cosine)   f a b c (a*b + c)
   Blanks between; several expressions are parted by ';'. */

#include "dag/dag.h"

/* A DAG with one input argument "in" of rows x y z w and one output argument "out". */
void expression_init(struct dag *d, struct arena *a);

/* Build the expressions, each an output; the last one is returned. */
struct ref expression_build(struct dag *d, const char *text);

/* The node, or all outputs, as they are stored, in the same notation. */
void expression_print(const struct dag *d, struct ref a, struct text *t);
void expression_print_outputs(const struct dag *d, struct text *t);

#endif
