#define _POSIX_C_SOURCE 200809L
#include "base/c_locale.h"

int c_locale_enter(struct c_locale *l)
{
	l->c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	if (!l->c)
		return 0;
	l->before = uselocale(l->c);
	return 1;
}

void c_locale_leave(struct c_locale *l)
{
	uselocale(l->before);
	freelocale(l->c);
}
