#ifndef TESTS_FUZZ_CHECK_H
#define TESTS_FUZZ_CHECK_H
/* What holds of every call of the generator, for programs that feed it whatever is drawn: what does not hold ends the
   program with a message. */

#include "rneagen.h"

/* Memory for `left` blocks and then none (negative: for all); what is out must come back. */
struct ration {
	int left, out;
};
struct rneagen_allocator ration_allocator(struct ration *r);

void require(int holds, const char *what, const struct rneagen_error *e);

/* The result and the error of rneagen_generate belong together, and hold what they promise. */
void check_result(const struct rneagen_options *o, const struct rneagen_result *r, const struct rneagen_error *e);

/* Count an execution. The counts are added, a line now and then, to the file that FUZZ_COUNTS in the environment names:
   "executions accepted". */
void count_execution(int accepted);

#endif
