/* Forward dynamics by --strict: several compilers give the same bits, by the factor of M in f64 and by the articulated-body
   algorithm in f32. */
#define _POSIX_C_SOURCE 200809L
#include "support/rng.h"
#include "support/suite.h"
#include "target/target.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The first sets them. */
static const struct compiler STRICT[] = {{"gcc", {"-O0", "-std=c11"}}, {"clang", {"-O0", "-std=c11"}},
	{"gcc", {"-O3", "-std=gnu11", "-ffp-contract=fast", "-march=x86-64-v3"}},
	{"clang", {"-O3", "-std=c11", "-ffp-contract=fast", "-march=x86-64-v3"}}, {"gcc", {"-O2", "-std=c11"}}};

enum { STRICT_COUNT = sizeof STRICT / sizeof *STRICT, NV = 6, COUNT = 150, SEED = 77 };

static void run_strict(const struct target *t, const struct compiler *c, int f32, double *out)
{
	struct target_path source = target_path("forward_strict", ".c"), library = target_path("forward_strict", ".so");
	const char *argv[20] = {c->command, "-fPIC", "-shared", "-o", library.s, source.s};
	void (*as_f64)(const double *q, const double *qd, const double *tau, double *qdd, double *X);
	void (*as_f32)(const float *q, const float *qd, const float *tau, float *qdd, float *X);
	struct rng rng = rng_seed(SEED);
	void *handle;
	int n = 6;

	for (int i = 0; c->flags[i]; i++)
		argv[n++] = c->flags[i];
	argv[n] = "-lm";
	target_compile(t, argv);
	handle = dlopen(library.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(handle != NULL, "%s", dlerror());
	target_symbol(t, handle, "forward_strict_fd", &as_f64);
	target_symbol(t, handle, "forward_strict_fd", &as_f32);
	for (int s = 0; s < COUNT; s++, out += NV + NV * NV) {
		double in[3 * NV];
		float in_f32[3 * NV], out_f32[NV + NV * NV];

		for (int i = 0; i < 3 * NV; i++)
			in_f32[i] = (float)(in[i] = rng_uniform(&rng, -2, 2));
		if (!f32) {
			as_f64(in, in + NV, in + 2 * NV, out, out + NV);
			continue;
		}
		as_f32(in_f32, in_f32 + NV, in_f32 + 2 * NV, out_f32, out_f32 + NV);
		for (int i = 0; i < NV + NV * NV; i++)
			out[i] = (double)out_f32[i];
	}
	dlclose(handle);
	unlink(library.s);
}

START_TEST(strict)
{
	static double first[COUNT * (NV + NV * NV)], now[COUNT * (NV + NV * NV)];
	struct rneagen_options o = rneagen_options_default();
	char scene[128];
	struct target t;
	size_t length;
	char *urdf = target_robot("ur5", &length);
	int f32 = _i;

	snprintf(scene, sizeof scene, "dense\nrefine 1\nwant qdd,Minv\n%s", _i ? "dynamics articulated\n" : "dynamics factor\n");
	o.scene = scene;
	o.target = RNEAGEN_TARGET_C;
	o.precision = f32 ? RNEAGEN_F32 : RNEAGEN_F64;
	o.strict = 1;
	o.name = "forward_strict";
	target_generate(&t, urdf, length, &o, "ur5");
	target_write(target_path("forward_strict", ".c"), t.text.source);
	for (int i = 0; i < STRICT_COUNT; i++) {
		if (!compiler_serves(&STRICT[i], STRICT[i].flags[3] != NULL))
			continue;
		run_strict(&t, &STRICT[i], f32, i ? now : first);
		for (int k = 0; k < COUNT * (NV + NV * NV) && i; k++)
			ck_assert_msg(same_number(first[k], now[k]), "%s by %s %s: number %d is %a, not %a", t.what,
				STRICT[i].command, STRICT[i].flags[0], k, now[k], first[k]);
	}
	unlink(target_path("forward_strict", ".c").s);
	target_close(&t);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("strict forward");

	setvbuf(stdout, NULL, _IOLBF, 0);
	suite_add(suite, "strict", strict, 2, 120);
	return suite_run(suite);
}
