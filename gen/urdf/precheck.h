#ifndef RNEAGEN_PRECHECK_H
#define RNEAGEN_PRECHECK_H
/* The first look at a URDF, by expat, before urdfdom sees it. urdfdom crashes on deep nesting, stops at a NUL byte,
   keeps a link whose mass is no number as massless, and hands some attributes to printf as a format; so it is given
   only what has passed here, as a clean copy that holds links, inertials and joints and nothing else. */

#include "urdf/diagnostic.h"

struct outline_id {
	const char *name;
	long line;
};

struct outline_link {
	struct outline_id id;
	struct link link; /* its numbers */
};

struct outline_joint {
	struct outline_id id;
	enum joint_type type;
	const char *parent, *child; /* names of links; NULL if absent */
	const char *driver;         /* name of the joint that is mimicked, or NULL */
	struct joint joint;         /* its numbers */
};

/* Names, and the numbers as written: urdfdom rounds them to doubles, and of angles keeps only a quaternion, in which pi/2 is
   no longer exact. */
struct outline {
	const char *name;
	long line; /* of the <robot> */
	struct outline_link *links;
	size_t link_count, link_capacity;
	struct outline_joint *joints;
	size_t joint_count, joint_capacity;
	struct text urdf; /* the clean copy */
};

/* Call in the C locale. Errors: MEMORY, LIMIT, XML, XACRO, URDF, NUMBER, UNSUPPORTED. */
enum rneagen_code precheck(struct outline *o, const char *xml, size_t length, const struct diagnostic *p);

#endif
