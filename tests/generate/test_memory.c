/* No memory, at every request there is: linked with arena_each.c, where each request asks the allocator. */
#include "passes/analysis.h"
#include "rneagen.h"
#include "support/exhaustive.h"
#include "support/read.h"
#include "support/suite.h"
#include "support/urdf_text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A warning, a follower, a fixed joint, a floating joint, names that are escaped. */
static const char urdf[] = ROBOT("r \"*/\"", BALL("base") BALL("a/*") BALL("b") POINT("c", "1", "1 2 3") BALL("d")
	JOINT("ja", "revolute", "base", "a/*", AXIS("0 0 2"))
		JOINT("jb", "prismatic", "a/*", "b", AXIS("0 1 0") MIMIC("ja", "-2", "0.5"))
		JOINT("jc", "fixed", "b", "c", ORIGIN("0 0 1", "0.1 0.2 0.3")) JOINT("jd", "revolute", "c", "d", AXIS("1 1 0")));

/* One of each of a task's choices. */
static const char everything[] = "fold q.ja=0.5\nfold qdd=0\nfree gravity\nfree mass.b:sample\nfree inertia.c\nfree payload.d\n"
				 "free offset.jd\nfext a/*,d\nfext-frame world\narmature ja=1\ndamping\nfriction 0.1\n"
				 "want tau,bias,gravity,power,kinetic,potential,wrench.jd,twist.c,accel.b\n";

/* Refuses the request with number `refused`, and all later ones where `for_good`. */
struct warden {
	long requests, refused, out;
	int for_good;
};

static void *warden_alloc(void *context, size_t size)
{
	struct warden *w = context;
	long request = w->requests++;
	void *p = request == w->refused || (w->for_good && request > w->refused) ? NULL : malloc(size);

	w->out += p != NULL;
	return p;
}

static void warden_release(void *context, void *block)
{
	((struct warden *)context)->out--;
	free(block);
}

/* What is tried: on success everything is given back, on failure there is nothing. */
static enum rneagen_code generate(const struct rneagen_options *o, struct rneagen_error *e)
{
	struct rneagen_result r;

	if (rneagen_generate(urdf, sizeof urdf - 1, o, &r, e))
		ck_assert(!r.source && !r.header && !r.info && !r.info_json && !r.dump && !r.name && !r.warning_count);
	else
		rneagen_result_free(&r);
	return e->code;
}

static enum rneagen_code analyse(const struct rneagen_options *o, struct rneagen_error *e)
{
	struct analysis a;

	if (analysis_open(&a, urdf, sizeof urdf - 1, o, e))
		ck_assert(!a.dag.nodes && !a.tree.bodies);
	else
		analysis_free(&a);
	return e->code;
}

/* Of the requests after the first hundred each `step`th is refused, in the long form twice as many. */
static long step_of(long step)
{
	return exhaustive() ? (step + 1) / 2 : step;
}

typedef enum rneagen_code runs(const struct rneagen_options *o, struct rneagen_error *e);

/* Refuses one request, or with -1 none. A refusal must come out as MEMORY, and nothing be left. Returns how many there were. */
static long refuse(const struct rneagen_options *options, long refused, int for_good, runs *run)
{
	struct warden w = {.refused = refused, .for_good = for_good};
	struct rneagen_allocator allocator = {warden_alloc, warden_release, &w};
	struct rneagen_options o = *options;
	struct rneagen_error e;
	enum rneagen_code code;

	o.allocator = &allocator;
	code = run(&o, &e);
	ck_assert_msg(w.out == 0, "request %ld refused: %ld blocks left", refused, w.out);
	if (refused < 0 || refused >= w.requests) {
		ck_assert_msg(code == RNEAGEN_OK, "%s", e.message);
		return w.requests;
	}
	ck_assert_msg(code == RNEAGEN_MEMORY, "request %ld refused: code %d, %s", refused, code, e.message);
	ck_assert_str_eq(e.message, "out of memory");
	return w.requests;
}

/* One after the other. Returns the number of requests. */
static long refuse_each(const struct rneagen_options *options, int for_good, long step, runs *run)
{
	for (long k = 0;; k += k < 100 ? 1 : step_of(step)) {
		long requests = refuse(options, k, for_good, run);

		if (k >= requests)
			return requests;
	}
}

/* The search for base parameters, which asks for much memory, has a scene of its own. */
static const char *by_urdf(const char *scene)
{
	static char text[1000];

	snprintf(text, sizeof text, "params urdf\n%s", scene ? scene : "");
	return text;
}

enum { DUMPS = 11 }; /* tests before those of dumps, which have no text */

START_TEST(every_request)
{
	struct rneagen_options o = rneagen_options_default();
	long requests;

	o.target = (enum rneagen_target)(_i % 3);
	o.base = _i % 2 ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	o.layout = _i % 2 ? RNEAGEN_SOA : RNEAGEN_AOS;
	o.order = _i == 1 ? "jd,ja" : NULL;
	o.tell = _i < DUMPS ? RNEAGEN_TELL_ALL : 0;
	o.scene = _i == 4 ? "# some\nroot base\ntip b,d\nsnap-angle 1e-3" : _i == 5 ? "lock jd=0.5" : NULL;
	if (_i == 3) { /* CUDA in f32 */
		o.scene = "free payload.d\nwant qdd\nrefine 1:f32x2";
		o.base = RNEAGEN_FIXED;
	}
	if (_i == 6)
		o.scene = "fold qdd=0\nfree payload.d\nfext b\nwant tau,power\ndrop-below 1e-3:sampled\nrange payload.d=0,2";
	if (_i >= 7 && _i < DUMPS) {
		o.scene = _i == 8 ? "free gravity\nwant qdd\njvp qdd,pose.d\nvjp M,accel.d\nby gravity" :
			"free gravity\nwant M,dtau_dq,dtau_dgravity,jvp,vjp,regressor";
		o.target = _i % 2 ? RNEAGEN_TARGET_C : RNEAGEN_TARGET_CUDA;
		o.base = RNEAGEN_FIXED;
	}
	if (_i >= 9 && _i < DUMPS) {
		o.target = RNEAGEN_TARGET_CUDA;
		o.layout = RNEAGEN_SOA;
		o.parts = 2;
	}
	if (_i >= DUMPS)
		o.dump = (enum rneagen_dump)(_i - DUMPS + 1);
	o.scene = by_urdf(o.scene);
	requests = refuse_each(&o, _i % 2, 7, generate);
	printf("one in %ld of %ld requests refused\n", step_of(7), requests);
	ck_assert_int_gt(requests, 100);
}
END_TEST

/* What takes long in a whole generation: a joint that may be kept, terms that may be dropped, all of a task, a bound,
   a search for constants. */
START_TEST(every_request_of_a_scene)
{
	static const char *const scenes[] = {
		"lock jd=0.5\nround-constants 5\nrange q=-1,1\nrange qd=-1,1\nrange qdd=-1,1\ndrop-below 1e-3", everything,
		"want qdd_bound", "params auto\nfree mass.d",
		"free mass.b\nwant com,vcom,com_jacobian,momentum,momentum_matrix,dmomentum,coriolis,opspace.d,opspace_inv.d",
		"contact d\nfree accel.d\nwant qdd,contact.d,dqdd_dqd\nvjp contact.d\nrefine 1:same"};
	struct rneagen_options o = rneagen_options_default();
	long requests, step = _i < 6 || _i >= 8 ? 7 : 53;

	o.base = _i < 8 ? o.base : RNEAGEN_FLOATING;
	o.scene = strstr(scenes[_i / 2], "params") ? scenes[_i / 2] : by_urdf(scenes[_i / 2]);
	requests = refuse_each(&o, _i % 2, step, analyse);
	printf("one in %ld of %ld requests refused\n", step_of(step), requests);
	ck_assert_int_gt(requests, 100);
}
END_TEST

static const char *robot;

static enum rneagen_code generate_robot(const struct rneagen_options *o, struct rneagen_error *e)
{
	struct rneagen_result r;

	if (!rneagen_generate(robot, strlen(robot), o, &r, e))
		rneagen_result_free(&r);
	return e->code;
}

enum { KERNELS = 6 };

/* Kernels one after the other, of a robot that is large enough for these: some requests of each text. */
START_TEST(kernels)
{
	static const char *const scenes[KERNELS] = {"want qdd", "vjp qdd", "jvp qdd", "want qdd\ncontact lf_foot,rh_foot,lh_foot",
		"vjp qdd\ncontact lf_foot,rh_foot", "vjp qdd\ncontact lf_foot,rf_foot,lh_foot,rh_foot"};
	struct rneagen_options o = rneagen_options_default();
	char *text = robot_text("hyq");
	long requests, count = exhaustive() ? 20 : sanitized() ? 2 : 6;

	robot = text;
	o.target = RNEAGEN_TARGET_CUDA;
	o.precision = RNEAGEN_F64;
	o.base = RNEAGEN_FLOATING;
	o.scene = by_urdf(scenes[_i]);
	requests = refuse(&o, -1, 0, generate_robot);
	for (long k = 1; k <= count; k++)
		refuse(&o, requests * (3 * k - 1) / (3 * count), (int)(k % 2), generate_robot);
	printf("%ld of %ld requests refused\n", count, requests);
	free(text);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("memory");
	TCase *c = tcase_create("generate");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_set_timeout(c, 300);
	tcase_add_loop_test(c, every_request, 0, DUMPS + RNEAGEN_DUMP_PARAMS);
	tcase_add_loop_test(c, every_request_of_a_scene, 0, 12);
	tcase_add_loop_test(c, kernels, 0, KERNELS);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
