#ifndef RNEAGEN_SELECT_H
#define RNEAGEN_SELECT_H
/* What a scene leaves of a robot: where it begins, which joints move, which are held and where, which are cut away with
   all that they carry. */

#include "rneagen.h"
#include "scene/scene.h"
#include "tree/spatial.h"

enum { SELECTION_VALUES = 7 };

enum selection_state { SELECTION_MOVES, SELECTION_HELD, SELECTION_GONE };

/* Of a joint of the robot; fixed joints move in this sense. */
struct selection_joint {
	enum selection_state state;
	const char *why;                  /* held: the scene's word for it, or "mimic" where the joint that it follows is held */
	struct within value[SELECTION_VALUES];  /* held: its q */
	int leader;                       /* the joint whose q moves it: itself, or the end of a chain of <mimic> that is honoured */
	struct within multiplier, offset; /* q = multiplier q_leader + offset */
};

struct selection {
	int root; /* a link */
	struct selection_joint *joints;
};

/* A joint on a chain that follows another brings that joint's chain with it; one that follows a joint outside of the
   subtree is held where that joint is held, at zero if nothing else is said. Errors: SCENE, MEMORY. */
enum rneagen_code scene_select(struct selection *c, const struct scene *s, const struct robot *r, const struct rneagen_options *o,
	struct arena *a, struct rneagen_error *e);

/* After the tree was walked: a joint that the scene locks must be part of it (`visited`, by link), or be followed by one
   that is. Error: SCENE. */
enum rneagen_code scene_select_check(const struct selection *c, const struct scene *s, const struct robot *r, const char *visited,
	struct rneagen_error *e);

/* Is a held joint outside of its limits? */
int selection_beyond(const struct joint *j, const struct selection_joint *held);

#endif
