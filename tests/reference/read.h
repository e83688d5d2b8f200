#ifndef TESTS_REFERENCE_READ_H
#define TESTS_REFERENCE_READ_H

#include <stdbool.h>
#include <stddef.h>

#include "reference/wide.h"

// What a URDF says, element by element: absent elements are their defaults.
struct raw_link {
	char *name;
	wide mass, xyz[3], rpy[3];
	wide inertia[6];	// xx xy xz yy yz zz
};

struct raw_joint {
	char *name, *type, *parent, *child;
	wide xyz[3], rpy[3], axis[3];
	wide lower, upper;
	char *mimic;		// the joint followed, or NULL
	wide multiplier, offset, damping, friction;
};

struct raw_robot {
	struct raw_link *links;
	struct raw_joint *joints;
	int nlinks, njoints;
};

// Numbers are the doubles nearest to the text's or, with `decimals`, rounded to the reference's own type and to no other on
// the way. False, with a text in message[size], where the XML is not well formed or a needed attribute is missing. Needs
// raw_free either way.
bool raw_read(struct raw_robot *raw, const char *urdf, size_t length, bool decimals, char *message, size_t size);
void raw_free(struct raw_robot *raw);

// realloc and strdup that abort without memory: a test has nothing better to do.
void *raw_memory(void *old, size_t count, size_t size);
char *raw_copy(const char *s);

#endif
