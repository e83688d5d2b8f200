#ifndef RNEAGEN_SELECT_H
#define RNEAGEN_SELECT_H
/* What a scene leaves of a robot: where it begins, which joints move, which are held and where, which are cut away with
   all that they carry. */

#include "rneagen.h"
#include "scene/scene.h"
#include "base/within.h"

enum { SELECTION_VALUES = 7 };

enum selection_state { SELECTION_MOVES, SELECTION_HELD, SELECTION_GONE };

/* Of a joint of the robot; fixed joints move in this sense. */
struct selection_joint {
	enum selection_state state;
	const char *why;                  /* held: the scene's word for it, or "mimic" where the joint that it follows is held */
	int is_body;                      /* held: a fixed body of its own, not merged with the body that carries it */
	struct within value[SELECTION_VALUES];  /* held: its q */
	/* the joint whose q moves it: itself, or the end of a chain of <mimic> that is honoured */
	int leader;
	struct within multiplier, offset; /* q = multiplier q_leader + offset */
};

struct selection {
	int root; /* a link */
	struct selection_joint *joints;
	int *walk, walk_count; /* joints that are modelled: depth-first from the root, children in byte order of their names */
	char *reached;         /* by link: it is modelled */
	char *freed;           /* by link: its mass or inertia is an input */
};

/* A follower on a chain brings the chain of its leader with it; one whose leader is outside of the subtree is held where
   the leader is held, at zero if nothing else is said. A joint that the scene locks, and its followers, are not cut away
   beside a chain. A joint that the scene locks must be modelled, or be followed by one that is. Errors: SCENE, MEMORY. */
enum rneagen_code scene_select(struct selection *c, const struct scene *s, const struct robot *r, enum rneagen_mimic mimic,
	struct arena *a, struct rneagen_error *e);

/* Does this joint of the robot move? */
int selection_moves(const struct selection *c, const struct robot *r, int joint);

/* The choices, and what became of each joint that is not fixed. */
void scene_dump(const struct scene *s, const struct selection *c, const struct robot *r, struct text *out);

/* Is a held joint outside of its limits? */
int selection_beyond(const struct joint *j, const struct selection_joint *held);

#endif
