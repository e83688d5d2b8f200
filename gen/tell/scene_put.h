#ifndef RNEAGEN_SCENE_PUT_H
#define RNEAGEN_SCENE_PUT_H
/* What a scene made of a robot: its choices, the joints it holds, what it cuts away. Nothing where there is no scene. */

#include "tree/tree.h"

/* Lines of --info, a member of the object of --info=json, and lines of the comment at a text's head. */
void scene_put_table(const struct tree *t, struct text *out);
void scene_put_json(const struct tree *t, struct text *out);
void scene_put_comment(const struct tree *t, struct text *out);

/* What the URDF has that is not modelled, for --info, with a scene or without. */
void scene_put_ignored(const struct tree *t, struct text *out);
void scene_put_json_ignored(const struct tree *t, struct text *out);

/* Does a text depend on this line of the scene? On a range only where constants are changed. */
int scene_put_matters(const struct tree *t, int line);

/* The choices as options of the command line, each after `before`. */
void scene_put_options(const struct scene *s, const char *before, struct text *out);

#endif
