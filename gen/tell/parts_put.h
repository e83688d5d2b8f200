#ifndef RNEAGEN_PARTS_PUT_H
#define RNEAGEN_PARTS_PUT_H
/* The parts of a grid and its kernels, told: nothing where there are none. */

#include "emit/emit.h"

/* Lines of --info, and a member of --info=json. */
void parts_put_table(const struct emission *e, struct text *out);
void parts_put_json(const struct emission *e, struct text *out);

#endif
