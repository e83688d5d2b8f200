#ifndef RNEAGEN_SVEC_H
#define RNEAGEN_SVEC_H
/* Symbolic 3-vectors over the DAG; zeros and ones of constant operands fold away in the constructors below. */

#include "dag/dag.h"
#include "tree/spatial.h"

struct svec {
	struct ref x[3];
};

/* A rotation with expressions for elements: x_parent = m x_child. */
struct smat {
	struct ref m[3][3];
};

/* a b + c e and a b - c e. Here as elsewhere what two arguments of a call are made of is made in statements of its own, the last
   argument first: C leaves their order open, and nodes, and so texts, go by it. It leaves that of initialisers open too; gcc and
   clang take the first one first. */
struct ref dag_add_products(struct dag *d, struct ref a, struct ref b, struct ref c, struct ref e);
struct ref dag_sub_products(struct dag *d, struct ref a, struct ref b, struct ref c, struct ref e);

struct svec svec_const(struct dag *d, const struct within v[3]);
/* Rows row, row + 1, row + 2 of an argument. */
struct svec svec_input(struct dag *d, int argument, int row);
struct svec svec_add(struct dag *d, struct svec a, struct svec b);
struct svec svec_sub(struct dag *d, struct svec a, struct svec b);
struct svec svec_scale(struct dag *d, struct ref s, struct svec a);
struct svec svec_cross(struct dag *d, struct svec a, struct svec b);
struct ref svec_dot(struct dag *d, struct svec a, struct svec b);
struct svec smat_row(const struct smat *m, int i);
struct svec smat_column(const struct smat *m, int j);
void smat_set_row(struct smat *m, int i, struct svec u);
void smat_set_column(struct smat *m, int j, struct svec u);
struct smat smat_transposed(const struct smat *m);
/* a b, column by column; m v and m^T v */
struct smat smat_product(struct dag *d, const struct smat *a, const struct smat *b);
struct svec smat_mul(struct dag *d, const struct smat *m, struct svec v);
struct svec smat_mul_transposed(struct dag *d, const struct smat *m, struct svec v);
/* c + a x b, sum + a.b and w + m v, product by product: each joins the sum before it in one operation. */
struct svec svec_add_cross(struct dag *d, struct svec c, struct svec a, struct svec b);
struct ref svec_add_dot(struct dag *d, struct ref sum, struct svec a, struct svec b);
struct svec smat_add_mul(struct dag *d, struct svec w, const struct smat *m, struct svec v);
struct smat smat_const(struct dag *d, const struct rotation *r);
/* R(q) v and R(q)^T v for the turn by an angle with this sine and cosine about a coordinate axis. */
struct svec svec_turn(struct dag *d, int axis, struct ref s, struct ref c, struct svec v);
struct svec svec_turn_back(struct dag *d, int axis, struct ref s, struct ref c, struct svec v);
/* Name the components quantity+body+x|y|z. */
void svec_tag(struct dag *d, struct svec a, const char *quantity, int body);

#endif
