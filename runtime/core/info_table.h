#ifndef RNEA_INFO_TABLE_H
#define RNEA_INFO_TABLE_H
/* The table that a generated text holds about itself: lines `key values`, the first `rneagen-info VERSION`.

	name NAME | precision f32|f64 | layout soa|aos | trig WORD | base WORD | nq N | nv N | nb N | block N
	stage BYTES                               (of shared memory in which the rnea kernel stages each sample, where it does)
	arithmetic WORD                           (where it does not stand, it is the precision)
	parts N                                   (version 2 alone: blocks of the rnea kernel's grid along y, 2 and more)
	input NAME ROWS f32|f64 sample|batch      (and `output`; one line each, in the order of the signature)
	operations MUL ADD SUB NEG FMA SINCOS     (of the rnea kernel, a sample)
	kernels rnea|fpass|bpass ...              (those that the text has; where it does not stand, all three may be there)
	joint IQ NQ IV NV TYPE NAME               (the name goes to the end of the line)

	matrix NAME ROWS COLS general|lower       (an output's; after it its rows, from 0:)
	row NAME ROW COL COL ...                  (the columns of what is stored; in all, as many as the output has rows)

   Version 1: a launch has one block for each slice of the batch. Version 2: `parts` of them, each of which makes some of
   the outputs; who knows nothing of parts would launch a text of parts and leave the rest unwritten.

   Each key of the first line stands once, and so do `operations` and, in version 2, `parts`; `arithmetic`, `stage` and
   `kernels` at most once. A key that is not listed is passed over: what would change the meaning of the rest gets a new
   version. */

#include "core/failure.h"

/* Parse `length` bytes at `text`; a final NUL may be among them. On success *info is to be released with
   rnea_info_free, on failure it is empty. Errors: TABLE (the message has the line), MEMORY. */
enum rnea_code rnea_info_parse(const char *text, size_t length, struct rnea_info *info, struct rnea_error *e);

/* The same for the table of the text that defines NAME_info: it must call the robot `name`. */
enum rnea_code rnea_info_read(
	const char *text, size_t length, const char *name, struct rnea_info *info, struct rnea_error *e);
void rnea_info_free(struct rnea_info *info);

#endif
