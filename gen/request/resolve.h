#ifndef RNEAGEN_RESOLVE_H
#define RNEAGEN_RESOLVE_H
/* How the choices of a scene find their links and joints: what request.c and resolve_*.c share. */

#include "request/request.h"

struct resolver {
	struct tree *t;
	struct request *k;
	const struct scene *s;
	const struct robot *r;
	struct arena *a;
	struct rneagen_error *e;
};

/* A word that a choice may begin with, and whether a name must follow it: "mass.NAME". */
struct kind_word {
	const char *word;
	int has_name;
};

/* Which of these words a choice has; -1 and an error that names the nearest, or all of them. */
int request_find_kind(const struct resolver *x, const struct scene_choice *c, const struct kind_word *kinds, int count);

/* "payload.left hand" -> payload_left_hand; two that come out the same, or a kernel's own, differ by a number. */
const char *request_argument(const struct resolver *x, const char *word);

/* The constant of `free` or the wrench of `fext` whose word is nearest; NULL where none is near, and where memory runs out. */
const char *request_nearest_input(const struct resolver *x, const char *word);

/* The link of this name, carried by a body, and the body that the joint of this name moves ("base": the floating base);
   -1 and an error where there is none. */
int request_find_link(const struct resolver *x, const struct scene_choice *c, const char *name);
int request_find_body(const struct resolver *x, const struct scene_choice *c, const char *name);

/* What may stand for a link: a link, a frame that the scene adds, or a joint, for its child link. Its body, and where
   it is in that body's frame; an error that names the nearest where there is none. */
enum rneagen_code request_find_frame(const struct resolver *x, const struct scene_choice *c, const char *name, int *body,
	struct placement *X);

/* Has an earlier line said the same of this name? Of two values, none would be the last word. */
int request_is_said(const struct resolver *x, const struct scene_choice *c);

/* How poses are written, and in which frame Jacobians are. */
void request_forms(const struct resolver *x);

/* A choice of `add-frame`. */
enum rneagen_code request_add_frame(const struct resolver *x, const struct scene_choice *c);

/* The contact of this name, with so many rows, 0: with any; NULL: it does not stand so. */
const struct contact *request_find_contact(const struct request *k, const char *name, int rows);

/* A choice of `contact` or `weld`; whether the force that a choice of `want` names is that of one; and whether contacts serve
   what else is asked for, after all other choices. */
enum rneagen_code request_contact(const struct resolver *x, const struct scene_choice *c);
enum rneagen_code request_check_force(const struct resolver *x, const struct scene_choice *c, const struct want *w);
enum rneagen_code request_check_contacts(const struct resolver *x);

/* A choice of `want`. */
enum rneagen_code request_want(const struct resolver *x, const struct scene_choice *c);

/* The quantity that a choice names, which is not added to those wanted. */
enum rneagen_code request_quantity(const struct resolver *x, const struct scene_choice *c, struct want *w);

/* A quantity as an output; twice is an error. */
enum rneagen_code request_add_want(const struct resolver *x, const struct scene_choice *c, const struct want *w);

/* Are these the same quantity? */
int request_is_same(const struct want *a, const struct want *b);

/* All choices of `jvp`, `vjp` and `by`, after those of `free`, `fext` and `want`. */
enum rneagen_code request_products(const struct resolver *x);

/* What joints bear of themselves, as `armature`, `damping` and `friction` say; and such a term as an input, of one joint or of
   all, whose kind and word are set. */
enum rneagen_code request_own_terms(const struct resolver *x);
enum rneagen_code request_free_own(const struct resolver *x, const struct scene_choice *c, struct freed *f);

/* A choice of `free`; and room for what the URDF says of its rows, zeros. Returns 0 when memory runs out. */
enum rneagen_code request_free(const struct resolver *x, const struct scene_choice *c);
int request_alloc_nominal(struct freed *f, const struct resolver *x);

/* A choice of `range`, after all others. */
enum rneagen_code request_range(const struct resolver *x, const struct scene_choice *c);

#endif
