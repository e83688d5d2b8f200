#ifndef RNEAGEN_SCENE_WORDS_H
#define RNEAGEN_SCENE_WORDS_H
/* Words of a scene, for its reader. */

#include "scene/scene.h"

struct scene_key_word {
	const char *name;
	int takes; /* a value: 0 no, 1 yes, 2 may */
	enum scene_kind kind;
};

extern const struct scene_key_word SCENE_WORDS[SCENE_KEY_COUNT];

#define SCENE_BLANKS " \t\r"

/* A copy of `length` bytes without the blanks around them; NULL on failure. */
const char *scene_trimmed(struct arena *a, const char *s, size_t length);

#endif
