#include "prove/ranging.h"
#include <math.h>
#include <stdlib.h>

int ranging_make(struct ranging *r, const struct field *f, const struct sought (*found)[2])
{
	size_t n = (size_t)f->output_count;

	*r = (struct ranging){calloc(n, sizeof *r->found), calloc(n, sizeof *r->largest),
		calloc(n * (size_t)f->dim_count + 1, sizeof *r->bends), calloc(n, sizeof *r->whole),
		calloc(n, sizeof *r->ranges), {0}, {0}, {0}};
	if (!r->found || !r->largest || !r->bends || !r->whole || !r->ranges)
		return 0;
	for (int i = 0; i < f->output_count; i++)
		for (int side = 0; side < 2; side++) {
			r->found[i][side] = found[i][side].value;
			r->largest[i] = fmax(r->largest[i], fabs(r->found[i][side]));
		}
	return 1;
}

void ranging_free(struct ranging *r)
{
	free(r->found);
	free(r->largest);
	free(r->bends);
	free(r->whole);
	free(r->ranges);
	free(r->curvature.most);
	free(r->cover.lower);
	free(r->cover.upper);
	knots_free(&r->knots);
}

int ranging_plain(struct cover *c, const struct field *f)
{
	*c = (struct cover){.upper = calloc((size_t)f->output_count, sizeof *c->upper),
		.lower = calloc((size_t)f->output_count, sizeof *c->lower)};
	for (int i = 0; c->upper && c->lower && i < f->output_count; i++) {
		c->upper[i] = f->plain[i];
		c->lower[i] = -f->plain[i];
	}
	return c->upper && c->lower;
}
