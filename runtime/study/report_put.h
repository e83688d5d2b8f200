#ifndef RUNTIME_REPORT_PUT_H
#define RUNTIME_REPORT_PUT_H
/* The rows of a study as a table for people, as JSON and as CSV. */

#include "study/study.h"
#include <stdio.h>

/* What was measured, and how. */
struct report {
	const struct study *study;
	const struct study_row *rows;
	size_t count;
	/* where there are several ranks: the rows of each, one rank's after another; rows[] are of all */
	const struct study_row *each;
	size_t ranks;                 /* else 0 */
	const char *command; /* the command line */
	const char *scene;   /* as options; "" where there is none */
	char date[32];       /* "2026-11-21T06:30:00Z" */
};

void report_put_table(const struct report *r, FILE *out);
void report_put_json(const struct report *r, struct text *out);
void report_put_csv(const struct report *r, FILE *out);

#endif
