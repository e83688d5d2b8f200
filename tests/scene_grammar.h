#ifndef TESTS_SCENE_GRAMMAR_H
#define TESTS_SCENE_GRAMMAR_H
/* Scenes drawn by a grammar: the words of gen/scene.h with names that the robot has, mostly where they belong, so that most
   are accepted; some are garbled afterwards. What is drawn depends on bytes alone, which a fuzzer may change. */

#include "rneagen.h"
#include "robot.h"
#include <stdint.h>

/* Bytes that decide; where none is left, every decision is the first. */
struct dice {
	const uint8_t *data;
	size_t size;
};

/* One of 0 .. n - 1; 0 for n = 0. */
size_t dice_below(struct dice *d, size_t n);

/* Draw for a robot and these options, but o->scene and o->order, which are the strings that come out, of `a`; NULL when
   memory runs out. *garbled: what was drawn has been changed, so that it need not be a scene. */
const char *scene_draw(struct dice *d, const struct robot *r, const struct rneagen_options *o, const char **order, int *garbled,
	struct arena *a);

#endif
