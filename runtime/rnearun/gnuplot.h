#ifndef RUNTIME_GNUPLOT_H
#define RUNTIME_GNUPLOT_H
/* Pictures drawn by gnuplot, which is looked for when one is asked for. */

#include "base/error.h"
#include <stdio.h>

/* Is there a gnuplot in PATH? `option` is what asks for the picture: "--plot". Errors: UNSUPPORTED. */
enum rneagen_code gnuplot_check(const char *option, struct rneagen_error *e);

/* Write an SVG to `path`, whole or not at all, by what `put` writes: a script of gnuplot but for its "set output". Errors:
   UNSUPPORTED (there is no gnuplot, or it fails), WRITE, READ, MEMORY. */
enum rneagen_code gnuplot_draw(const char *option, const char *path, void (*put)(const void *context, FILE *f),
	const void *context, struct rneagen_error *e);

/* A name as the inside of a quoted string of gnuplot's: what it could take for more than text is a blank. */
void gnuplot_put_name(FILE *f, const char *name);

#endif
