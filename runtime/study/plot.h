#ifndef RUNTIME_PLOT_H
#define RUNTIME_PLOT_H
/* A picture of a study: samples per second against error, the Pareto front of each backend marked and labelled. */

#include "study/report_put.h"

/* Write an SVG of the rows with the largest batch to `path`, by gnuplot. Errors: UNSUPPORTED (there is no gnuplot, or it
   fails), WRITE, READ, MEMORY. */
enum rneagen_code plot_write(const struct report *r, const char *path, struct rneagen_error *e);

#endif
