#ifndef RNEAGEN_SCENE_LINES_H
#define RNEAGEN_SCENE_LINES_H
/* Lines of a scene, as options become them: they keep their dashes, so that messages name the option. */

#include "scene/scene.h"

/* "--lock", or "--lock "VALUE"", what a value must not hold escaped; NULL: no value. Without the line break. */
void scene_put_line(enum scene_key key, const char *value, struct text *out);

/* The line before those of a file. */
void scene_put_file(const char *path, struct text *out);

/* The lines of a file of rotor inertias, JOINT KG_M2 each, as lines of a scene's file with a break between them, the first of
   which names it. A joint may stand in quotes, as in a scene; what stands after a # at the beginning of a line is a comment.
   `content` is changed; `path` is what messages call the file. Errors: SCENE, which names the file and the line. */
enum rneagen_code scene_put_armature(const char *path, char *content, struct text *out, struct rneagen_error *e);

#endif
