#ifndef RNEAGEN_WALK_H
#define RNEAGEN_WALK_H
/* Private to precheck: the walk over a URDF. precheck.c drives it, elements.c says what each element is, values.c
   reads the numbers. */

#include "urdf/precheck.h"
#include <expat.h>

/* Where an element stands; SKIPPED is everything that the dynamics do not need. */
enum place { DOCUMENT, ROBOT, LINK, INERTIAL, JOINT, VALUE, SKIPPED };

struct walk {
	XML_Parser parser;
	struct outline *outline;
	const char *xml;
	const struct diagnostic *diagnostic;
	int depth;
	enum place places[LIMIT_XML_DEPTH + 1]; /* of the open elements; places[0] is the document */
	const char *owner, *owner_name;         /* "robot", "link" or "joint", and its name, for messages */
	char *numbers;                          /* the open link or joint of the robot, into which they go */
	unsigned seen, twice;                   /* children of the open inertial or joint: bits, by row of the rules */
	int inertials;                          /* in the open link */
};

long walk_line(const struct walk *w);

/* Record an error at the current line, or at another, and stop the parse. */
void walk_fail(struct walk *w, enum rneagen_code code, const char *fmt, ...) RNEAGEN_PRINTF(3, 4);
void walk_fail_at(struct walk *w, long line, enum rneagen_code code, const char *fmt, ...) RNEAGEN_PRINTF(4, 5);

/* What the element is that starts in w->places[w->depth]; a link or joint becomes the owner. */
enum place elements_enter(struct walk *w, const char *element, const char *const *attributes);

/* At the end of a link or joint: the robot is the owner again. */
void elements_leave(struct walk *w);

/* The value of an attribute, or NULL. */
const char *values_attribute(const char *const *attributes, const char *name);

/* A child of an inertial or a joint: check its numbers and note what the outline needs. VALUE, or SKIPPED if it is of
   no use. */
enum place values_read(struct walk *w, const char *element, const char *const *attributes);

/* At the end of an inertial, or a joint: fails if something is missing. */
void values_end_inertial(struct walk *w);
void values_end_joint(struct walk *w);

#endif
