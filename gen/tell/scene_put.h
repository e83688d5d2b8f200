#ifndef RNEAGEN_SCENE_PUT_H
#define RNEAGEN_SCENE_PUT_H
/* What a scene made of a robot: its choices, the joints it holds, what it cuts away. Nothing where there is no scene. */

#include "scene/outcome.h"

/* Lines of --info, a member of the object of --info=json, and lines of the comment at a text's head. */
void scene_put_table(const struct scene *s, const struct outcome *o, struct text *out);
void scene_put_json(const struct scene *s, const struct outcome *o, struct text *out);
void scene_put_comment(const struct scene *s, const struct outcome *o, struct text *out);

/* What the URDF has that is not modelled, for --info, with a scene or without. */
void scene_put_ignored(const struct outcome *o, struct text *out);
void scene_put_json_ignored(const struct outcome *o, struct text *out);

/* The choices as options of the command line, each after `before`. */
void scene_put_options(const struct scene *s, const char *before, struct text *out);

#endif
