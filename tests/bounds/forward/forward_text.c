#define _POSIX_C_SOURCE 200809L
#include "forward_text.h"
#include <check.h>
#include <dlfcn.h>
#include <math.h>
#include <quadmath.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 256 };

static void *symbol(const struct forward_text *x, const char *function)
{
	char name[256];
	void *found;

	if (!function)
		return NULL;
	snprintf(name, sizeof name, "%s_%s", x->target.text.name, function);
	found = dlsym(x->library, name);
	ck_assert_msg(found != NULL, "%s: %s", x->target.what, dlerror());
	return found;
}

void forward_text_open(struct forward_text *x, const char *urdf, const struct rneagen_options *o, const struct forward_kind *kind,
	const char *function, const char *plain, const char *what)
{
	struct target_path text = target_path("forward", ".c"), object = target_path("forward", ".so");
	const char *const *f = kind->flags;
	const char *command[] = {"gcc", "-std=c11", WARNING_FLAGS, "-shared", "-fPIC", "-o", object.s, text.s, "-lm", f[0],
		f[1], f[2], NULL};
	struct rneagen_options options = *o;

	*x = (struct forward_text){0};
	options.target = RNEAGEN_TARGET_C;
	options.precision = kind->options.precision;
	options.trig = kind->options.trig;
	options.strict = kind->options.strict;
	target_generate(&x->target, urdf, strlen(urdf), &options, what);
	target_write(text, x->target.text.source);
	target_compile(&x->target, command);
	x->library = dlopen(object.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(x->library != NULL, "%s", dlerror());
	x->bounded.address = symbol(x, function);
	x->plain.address = symbol(x, plain);
	remove(text.s);
	remove(object.s);
}

void forward_text_close(struct forward_text *x)
{
	dlclose(x->library);
	rneagen_result_free(&x->target.text);
}

void forward_text_run(const struct forward_text *x, const double *const *in, const int *rows, double *out, double *bound)
{
	static float single[3][ROWS], out_f32[ROWS], bound_f32[ROWS], again_f32[ROWS];
	static double again[ROWS];
	int n = rows[2];

	for (int a = 0; a < 3; a++)
		for (int i = 0; i < rows[a]; i++)
			single[a][i] = (float)in[a][i];
	if (!x->target.f32) {
		x->bounded.wide(in[0], in[1], in[2], out, bound);
		if (x->plain.address)
			x->plain.wide(in[0], in[1], in[2], again);
	} else {
		x->bounded.single(single[0], single[1], single[2], out_f32, bound_f32);
		if (x->plain.address)
			x->plain.single(single[0], single[1], single[2], again_f32);
	}
	for (int i = 0; i < n && x->target.f32; i++) {
		out[i] = (double)out_f32[i];
		bound[i] = (double)bound_f32[i];
		again[i] = (double)again_f32[i];
	}
	for (int i = 0; i < n && x->plain.address; i++)
		ck_assert_msg(same_number(out[i], again[i]), "%s: row %d has other bits", x->target.what, i);
}

void closeness_add(struct closeness *c, const struct forward_text *x, int n, const double *got, const double *bound,
	const __float128 *want)
{
	for (int i = 0; i < n; i++) {
		double error = isfinite(got[i]) ? (double)fabsq((__float128)got[i] - want[i]) : (double)INFINITY;

		ck_assert_msg(error <= bound[i] || isnan(bound[i]), "%s: row %d is %g, off by %g, bound %g", x->target.what, i,
			got[i], error, bound[i]);
		c->count++;
		c->finite += isfinite(bound[i]);
		if (!isfinite(bound[i]))
			continue;
		c->error = fmax(c->error, error);
		c->bound = fmax(c->bound, bound[i]);
		c->share = bound[i] > 0 ? fmax(c->share, error / bound[i]) : c->share;
	}
}

void closeness_print(const struct closeness *c, const struct forward_text *x)
{
	printf("%-56s %3.0f %% finite; largest error %8.2g, bound %8.2g; error at most %.2g of a bound\n", x->target.what,
		c->count ? 100.0 * (double)c->finite / (double)c->count : 0, c->error, c->bound, c->share);
}
