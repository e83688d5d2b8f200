#ifndef RUNTIME_CERTIFY_CERTIFICATE_H
#define RUNTIME_CERTIFY_CERTIFICATE_H
/* A certificate: bounds of a proof, and the steps by which others verify them without any search. */

#include "certify/asked.h"
#include "steps/boxes.h"
#include "steps/grid.h"
#include "core/workers.h"

enum { CERTIFICATE_FORMAT = 1 };

/* Steps that a bound rests on. */
/* boxes with the output's range; with its errors too; a grid */
enum step_kind { STEP_VALUES, STEP_ERRORS, BOX_STEPS, STEP_GRID = BOX_STEPS, STEP_COUNT };
extern const char *const STEP_NAMES[STEP_COUNT];

/* One output of the text. */
struct certified {
	const char *left_out;            /* why nothing is stated; NULL: something is */
	struct box_bound bound;          /* what is stated of all states; INFINITY: nothing */
	struct boxes steps[BOX_STEPS];   /* count 0: there is no such step */
	struct grid_step grid;           /* dim_count 0: there is none */
};

/* What was proved of an output, which the certificate comes as close to as its steps do. */
struct proved_bound {
	double low, high, errors[STEPS_PRECISIONS];
};

struct certificate {
	const struct analysis *a;
	const enum rneagen_precision *precisions;
	int precision_count;
	struct eval_model models[STEPS_PRECISIONS];
	char text_hash[STEPS_PRECISIONS][HASH_TEXT];
	struct asked_box box;
	struct certified *rows; /* by output of the DAG */
};

/* Make the steps of a proof's record, within so many seconds, with `threads` threads (0: one for each processor), in `arena`.
   Errors: as rneagen_generate. certificate_free in any case. */
enum rneagen_code certificate_make(struct certificate *c, const struct record *record,
	const struct proved_bound *proved, double seconds, unsigned threads, struct arena *arena, struct rneagen_error *e);
void certificate_free(struct certificate *c);

/* Its JSON. */
void certificate_put(const struct certificate *c, struct text *out);

/* What the steps of an output say together. */
struct box_bound certified_total(const struct certified *row, int precision_count);

/* The models and ranges of c->a for c->precisions. Returns 0 when memory runs out. */
int certificate_ask(struct certificate *c, struct arena *arena);

/* Verify a step of an output: as boxes_check; as grid_check. */
long certificate_check_boxes(const struct certificate *c, size_t output, enum step_kind kind, const struct boxes *step,
	const char **what);
const char *certificate_check_grid(const struct certificate *c, size_t output, const struct grid_step *step);

#endif
