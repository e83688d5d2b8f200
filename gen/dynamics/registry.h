#ifndef RNEAGEN_REGISTRY_H
#define RNEAGEN_REGISTRY_H
/* The algorithms: each is a generated function. To add one, write a file in this folder that defines its struct algorithm,
   and enter its name in ALGORITHM_LIST. What writes texts, what tells of them and the runtime go through this list, by names and
   roles. */

#include "dag/dag.h"
#include "request/request.h"

/* The first that is made for a request is the text's main function: what --parts divides, what is staged and bounded, and what
   the calls of one sample and of a batch do. */
#define ALGORITHM_LIST(X)                                                                                              \
	X(rnea)                                                                                                        \
	X(fpass)                                                                                                       \
	X(bpass)                                                                                                       \
	X(fd)                                                                                                          \
	X(kin)

enum { ALGORITHM_ARRAYS = 8 };

struct algorithm {
	const char *name; /* of the function: NAME_rnea */
	const char *doc;  /* the comment above it */
	const char *what; /* of a scene that asks for more than its own arrays: "Inverse dynamics"; NULL: it is in no such text */
	const char *how;  /* behind it, in the head of a text */
	const char *brief; /* the comment above its declaration for a caller; of the first, the frames say more */
	const char *note; /* a line of the comment at the head of the text; NULL: none */

	/* What it takes and gives where the scene does not say otherwise, in the order of its signature: arrays of joints and
	   bodies (role_rows is not ROWS_ANY). The list ends with a name that is NULL. */
	struct algorithm_array {
		const char *name;
		enum role role;
		int is_output;
	} arrays[ALGORITHM_ARRAYS];

	/* Is it in the text of this request? */
	int (*is_made_for)(const struct request *k);

	/* Fills an empty DAG, declarations included; failure is in dag->failed. */
	void (*build)(struct dag *d, const struct tree *t, const struct request *k);
};

#define ALGORITHM_EXTERN(name) extern const struct algorithm algorithm_##name;
ALGORITHM_LIST(ALGORITHM_EXTERN)
#undef ALGORITHM_EXTERN

#define ALGORITHM_NUMBER(name) ALGORITHM_##name,
enum { ALGORITHM_LIST(ALGORITHM_NUMBER) ALGORITHM_COUNT };
#undef ALGORITHM_NUMBER

extern const struct algorithm *const ALGORITHMS[ALGORITHM_COUNT];

/* Those in the text of a request, in order; returns their count. */
int algorithms_for(const struct request *k, const struct algorithm *found[ALGORITHM_COUNT]);

/* What loops over columns serve: one sample on a processor; the same, coordinates side by side in lanes; batches there; a
   relay. */
enum looped { LOOPED_SINGLE, LOOPED_LANES, LOOPED_BATCH, LOOPED_RELAY };

/* The DAG of the main function once more, with its derivatives of qdd by loops over their columns: for processors, whose vectors
   then take several columns of a sample; or as a relay, for kernels that go on from what the one before has written: outputs that
   are made of qdd read it back. Returns 0, and leaves the DAG empty, where that does not serve the request, or is no gain. */
int algorithm_build_looped(struct dag *d, const struct tree *t, const struct request *k, enum looped use);

/* The main function once more, with gradients of the torques in loops over the coordinates beyond each body: for long chains.
   Returns 0, and leaves the DAG empty, where that does not serve the request, or is no gain. */
int algorithm_build_way_back(struct dag *d, const struct tree *t, const struct request *k, int is_batch);

/* What stands in rows of the output, and is read back there: nothing; qdd, and mu of a vjp (product.c), before these forces on
   links that stand, and those of the weights; of a jvp also what M^-1 is to be taken of. Such forces and nothing else; or they are
   read, and all else is made as where nothing stands. */
enum handed { HANDED_NOTHING, HANDED_FOUND, HANDED_ALL, HANDED_FORCES, HANDED_BY_FORCES };

/* Of a vjp, do forces of its weights stand beside the others, in rows by qd? Else they have those by tau, until mu is there. */
int contacts_weights_fit(const struct tree *t, const struct request *k);

/* The DAG of a product of accelerations, or of accelerations with contacts, once more, the only output, without refinement: for
   kernels that go on from what the one before has written. What is handed on is an output of its own before those that read it
   there. */
void algorithm_build_handed(struct dag *d, const struct tree *t, const struct request *k, enum handed handed);

/* Declare the arrays of its own. */
void algorithm_declare(const struct algorithm *x, struct dag *d, const struct tree *t);

#endif
