#ifndef RNEAGEN_WANT_H
#define RNEAGEN_WANT_H
/* A scene's request while its DAG is made. */

#include "dynamics/recursion.h"
#include "dynamics/tour.h"

struct build {
	struct dag *d;
	const struct tree *t;
	const struct request *k;
	struct ref *offset, *gravity;
	struct parameters **parameters;
	int *pushed, *outputs; /* arguments, by push and by want */
	char *done;            /* by want: the recursion writes it */
	struct ref kinetic;
	enum derivatives derivatives;
	struct recursion recursion;
};

/* What joins a tour: the tour's context is a struct build. */
void want_world(const struct tour *r);
void want_entered(const struct tour *r, int body);
void want_leaving(const struct tour *r, int body);
void want_left(const struct tour *r, int body);

#endif
