#ifndef RUNTIME_PROVED_ROWS_PUT_H
#define RUNTIME_PROVED_ROWS_PUT_H
/* What was proved, as a table for people and as JSON. */

#include "prove/prove.h"

struct proved {
	const struct analysis *a;
	const struct box *b;
	const struct prove_options *o;
	const struct proof *p;
};

void rows_put_table(const struct proved *x, struct text *out);
void rows_put_json(const struct proved *x, struct text *out);

#endif
