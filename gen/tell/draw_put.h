#ifndef RNEAGEN_DRAW_PUT_H
#define RNEAGEN_DRAW_PUT_H
/* What the inputs of a text are drawn from, told: those that its DAG reads, without rows that the scene gives. */

#include "passes/analysis.h"
#include "base/text.h"

/* "q[0..6] -1..1, payload_hand a body of 0..1 kg", in lines of a bearable length with `next` between them. */
void draw_put(const struct analysis *a, const char *next, struct text *out);

/* {"name": "q", "first": 0, "count": 7, "kind": "number", "lower": -1, "upper": 1}, ... with `next` between them. */
void draw_put_json(const struct analysis *a, const char *next, struct text *out);

#endif
