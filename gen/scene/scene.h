#ifndef RNEAGEN_SCENE_H
#define RNEAGEN_SCENE_H
/* The scene: what of a robot is modelled, and how. A scene is a text with one choice on a line, the long option of the
   command without its dashes, a blank, and its value; what follows a # at the beginning of a line or after a blank is a
   comment:

       # the right arm of a robot on wheels
       root torso_lift_link
       tip r_gripper_tool_frame
       lock r_gripper_joint=0.03

   A value may stand in quotes, "#1 joint=0.03", where \" is a quote, \\ a backslash and \n a line break; blanks at the ends
   of a name belong to it if the robot has such a name. The command writes its own options as lines that keep their
   dashes: messages then name the option, and the numbers of lines are those of files. */

#include "base/arena.h"
#include "base/error.h"
#include "urdf/robot.h"
#include "base/text.h"

/* key, word, whether it takes a value: 0 no, 1 yes, 2 may; what the value is */
#define SCENE_KEYS(X)                                                                                                  \
	X(ROOT, "root", 1, SCENE_NAME)                                                                                 \
	X(TIP, "tip", 1, SCENE_NAMES)                                                                                  \
	X(BESIDE, "beside", 1, SCENE_VALUE)                                                                            \
	X(LOCK, "lock", 1, SCENE_PAIR)                                                                                 \
	X(LOCK_ALL_BUT, "lock-all-but", 1, SCENE_NAMES)                                                                \
	X(FOLD, "fold", 1, SCENE_PAIR)                                                                                 \
	X(FREE, "free", 1, SCENE_FREED)                                                                                \
	X(WANT, "want", 1, SCENE_NAMES)                                                                                \
	X(DENSE, "dense", 0, SCENE_VALUE)                                                                              \
	X(DERIVATIVES, "derivatives", 1, SCENE_VALUE)                                                                  \
	X(DYNAMICS, "dynamics", 1, SCENE_VALUE)                                                                        \
	X(PARAMS, "params", 1, SCENE_VALUE)                                                                            \
	X(POSE, "pose", 1, SCENE_VALUE)                                                                                \
	X(FRAME, "frame", 1, SCENE_VALUE)                                                                              \
	X(ADD_FRAME, "add-frame", 1, SCENE_PAIR)                                                                       \
	X(REFINE, "refine", 1, SCENE_VALUE)                                                                            \
	X(JVP, "jvp", 1, SCENE_NAMES)                                                                                  \
	X(VJP, "vjp", 1, SCENE_NAMES)                                                                                  \
	X(BY, "by", 1, SCENE_NAMES)                                                                                    \
	X(FEXT, "fext", 1, SCENE_NAMES)                                                                                \
	X(FEXT_FRAME, "fext-frame", 1, SCENE_VALUE)                                                                    \
	X(CONTACT, "contact", 1, SCENE_NAMES)                                                                          \
	X(WELD, "weld", 1, SCENE_NAMES)                                                                                \
	X(ARMATURE, "armature", 1, SCENE_PAIR)                                                                         \
	X(DAMPING, "damping", 0, SCENE_VALUE)                                                                          \
	X(FRICTION, "friction", 2, SCENE_VALUE)                                                                        \
	X(SNAP_ANGLE, "snap-angle", 1, SCENE_VALUE)                                                                    \
	X(ROUND_CONSTANTS, "round-constants", 1, SCENE_VALUE)                                                          \
	X(DROP_BELOW, "drop-below", 1, SCENE_VALUE)                                                                    \
	X(RANGE, "range", 1, SCENE_PAIR)

enum scene_key {
#define SCENE_KEY_ENUM(key, word, takes, kind) SCENE_##key,
	SCENE_KEYS(SCENE_KEY_ENUM)
#undef SCENE_KEY_ENUM
	SCENE_KEY_COUNT
};

/* NAMES: commas between them, unless the whole is one name; PAIR: NAME=VALUE, split at the last =, of ADD_FRAME at the
   first; FREED: names, each of which may end in :sample or :batch; VALUE: given at most once */
enum scene_kind { SCENE_NAME, SCENE_NAMES, SCENE_PAIR, SCENE_FREED, SCENE_VALUE };

struct scene_choice {
	enum scene_key key;
	const char *name;  /* "" where the key takes a value alone */
	const char *value; /* "lock", "1.57"; NULL where there is none */
	int line;          /* of the text, from 1 */
	int told;          /* the line for messages, of its file or of all that are no options; 0: it is an option */
	const char *from;  /* the file whose line it is; NULL: a scene that is no file */
};

/* An option line `--scene FILE`: what follows up to the next option are the lines of this file. */
#define SCENE_OF_FILE "--scene "


struct scene {
	const char *file;           /* the URDF, for messages */
	struct scene_choice *lines; /* as written: lists are one choice; what to repeat the scene by */
	int line_count;
	struct scene_choice *choices; /* the same with one choice for each name of a list; made by scene_expand */
	int count;
};

/* Read a scene; NULL is an empty one. Strings live in `a`. Errors: SCENE, MEMORY. */
enum rneagen_code scene_read(
	struct scene *s, const char *text, const char *file, struct arena *a, struct rneagen_error *e);

/* Fill s->choices, now that the names of the robot are known. Errors: SCENE, MEMORY. */
enum rneagen_code scene_expand(struct scene *s, const struct robot *r, struct arena *a, struct rneagen_error *e);

/* The next choice of this key after `before` (NULL: the first); NULL when there is none. */
const struct scene_choice *scene_next(const struct scene *s, enum scene_key key, const struct scene_choice *before);

/* How many lines there are that choose something: ranges do not. */
static inline int scene_choice_count(const struct scene *s)
{
	int count = 0;

	for (int i = 0; i < s->line_count; i++)
		count += s->lines[i].key != SCENE_RANGE;
	return count;
}

/* "lock", "lock-all-but", ... */
const char *scene_word(enum scene_key key);

/* "in line N", "in line N of FILE", or "by an option". */
struct scene_place {
	char s[300];
};
struct scene_place scene_place(const struct scene_choice *c);

/* "FILE:N: WORD: what is wrong" of a file's line; else "URDF: scene line N, WORD: ..." or "URDF: --WORD: ..."; error SCENE. */
enum rneagen_code scene_refuse(const struct scene *s, const struct scene_choice *c, struct rneagen_error *e,
	const char *fmt, ...) RNEAGEN_PRINTF(4, 5);

/* The index of a link or joint of the robot; -1 and an error that names the nearest where there is none. */
int scene_link(const struct scene *s, const struct scene_choice *c, const struct robot *r, const char *name,
	struct rneagen_error *e);
int scene_joint(const struct scene *s, const struct scene_choice *c, const struct robot *r, const char *name,
	struct rneagen_error *e);

/* Numbers of a choice's value, `count` of them with commas between; an error unless they are all finite. */
enum rneagen_code scene_numbers(const struct scene *s, const struct scene_choice *c, struct within *values, int count,
	struct rneagen_error *e);

/* One line of the scene as a shell takes it: "--lock 'a b=1.5'". */
void scene_put_option(const struct scene_choice *line, struct text *t);

#endif
