#ifndef RUNTIME_CERTIFY_ASKED_H
#define RUNTIME_CERTIFY_ASKED_H
/* What a certificate is about: a robot, a scene, its text, and ranges of inputs. */

#include "steps/outward.h"
#include "passes/analysis.h"

enum { HASH_TEXT = 65 };

/* Ranges by argument of the DAG, NULL for outputs; where no range is known, lo is above hi. The one behind them is empty, for a
   DAG that reads no q. */
struct asked_box {
	struct span *rows[DAG_ARGUMENTS + 1];
	int position, q_rows; /* the argument q */
};

/* By the limits of the joints and the scene's ranges, which count more. It lives in `a`. Returns 0 when memory runs out. */
int asked_box(struct asked_box *b, const struct analysis *x, struct arena *a);

/* The same box once more, for whoever changes it. */
int asked_copy(struct asked_box *to, const struct asked_box *from, const struct dag *d, struct arena *a);

/* SHA-256 in hexadecimal digits. */
void asked_hash(const void *bytes, size_t length, char hash[HASH_TEXT]);

/* That of the text in C of this precision, made anew. Errors: as rneagen_generate. */
enum rneagen_code asked_text_hash(const struct analysis *x, enum rneagen_precision precision, char hash[HASH_TEXT],
	struct rneagen_error *e);

/* How a text in this precision computes. */
struct eval_model asked_model(const struct analysis *x, enum rneagen_precision precision);

#endif
