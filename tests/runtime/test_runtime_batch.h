#ifndef TEST_RUNTIME_BATCH_H
#define TEST_RUNTIME_BATCH_H
/* Batches of the robot of mixed.cu, whose arrays differ in type, in rows, and in what they hold for each sample. */

#include "rnea.h"

enum { ARRAYS = 5, GUARD = 64, POISON = 0x7b };

struct batch {
	size_t count;
	int aos;
	char *memory[ARRAYS]; /* with GUARD bytes of poison before and after */
	void *arrays[ARRAYS];
};

/* `count` samples of numbers made of `seed`. */
void batch_make(struct batch *b, size_t count, int is_aos, unsigned seed);
void batch_free(struct batch *b);

/* Bytes of array i. */
size_t batch_size(const struct batch *b, int i);

/* Whether every output is right to the bit, and nothing beside the outputs was written. */
int batch_is_right(const struct batch *b);

/* Open that robot. */
struct rnea_robot *batch_open(int is_aos);

/* It in both layouts, on the pretended device, which runs what is enqueued only when it is waited for; closed again, when
   all that was taken must have been given back. */
extern struct rnea_robot *soa, *aos;
void batch_setup(void);
void batch_teardown(void);

#endif
