#ifndef RNEAGEN_PARAMS_PUT_H
#define RNEAGEN_PARAMS_PUT_H
/* By which constants the model is computed (--params), and what was counted; which sine and cosine were chosen by ranges. */

#include "passes/analysis.h"

/* Nothing where the scene does not say. */
void params_put_table(const struct analysis *a, struct text *out);
void params_put_json(const struct analysis *a, struct text *out);

/* Nothing where they are the URDF's, and nobody asked for a choice. */
void params_put_comment(const struct analysis *a, struct text *out);

/* Nothing where ranges chose nothing. */
void trig_put_comment(const struct analysis *a, struct text *out);
void trig_put_table(const struct analysis *a, struct text *out);

#endif
