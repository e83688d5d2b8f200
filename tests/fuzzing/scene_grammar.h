#ifndef TESTS_SCENE_GRAMMAR_H
#define TESTS_SCENE_GRAMMAR_H
/* Scenes drawn by a grammar: the words of gen/scene/scene.h with names that the robot has, mostly where they belong, so that most
   are accepted; some are garbled afterwards. */

#include "dice.h"
#include "rneagen.h"
#include "urdf/robot.h"

/* Draw for a robot and these options, but o->scene and o->order, which are the strings that come out, of `a`; NULL when
   memory runs out. *garbled: what was drawn has been changed, so that it need not be a scene. */
const char *scene_draw(struct dice *d, const struct robot *r, const struct rneagen_options *o, const char **order, int *garbled,
	struct arena *a);

/* The scene with a byte changed, a line gone, lines repeated, or a piece of noise in it; NULL when memory runs out. */
const char *scene_garble(struct dice *d, const char *scene, struct arena *a);

#endif
