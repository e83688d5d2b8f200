#ifndef RNEAGEN_C_LOCALE_H
#define RNEAGEN_C_LOCALE_H
/* The C locale for one thread and a while: strtod and printf then use a point whatever the program chose.
   Needs _POSIX_C_SOURCE 200809L. */

#include <locale.h>

struct c_locale {
	locale_t c, before;
};

/* Returns 0 if there is no memory for it. Nests. */
int c_locale_enter(struct c_locale *l);
void c_locale_leave(struct c_locale *l);

#endif
