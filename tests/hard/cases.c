#include "cases.h"
#include "support/merged.h"
#include "robots.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *chain_64(void)
{
	return robot_chain(64);
}

static char *chain_200(void)
{
	return robot_chain(200);
}

static char *light_tip(void)
{
	return robot_masses(3e3, 3e-4);
}

static char *heavy_tip(void)
{
	return robot_masses(3e-4, 3e3);
}

static char *slid_0(void)
{
	return robot_slid(0);
}

static char *slid_10(void)
{
	return robot_slid(10);
}

static char *slid_1e6(void)
{
	return robot_slid(1e6);
}

static char *common(void)
{
	return robot_scaled(0.3, 1);
}

static char *micro(void)
{
	return robot_scaled(1e-5, 1e-20);
}

static char *nano(void)
{
	return robot_scaled(1e-7, 1e-26);
}

static char *star(void)
{
	return robot_star(100);
}

#define ORDINARY(robot) {#robot, #robot, "an ordinary robot", "-", #robot ".urdf", .samples = 1000}
#define F64 "f64: the same operations"

const struct hard_case HARD_CASES[] = {
	ORDINARY(iiwa14),
	ORDINARY(ur5),
	ORDINARY(panda),
	ORDINARY(hyq),
	ORDINARY(atlas),
	ORDINARY(g1_29dof),
	{"chain_64", "64 links of 1 kg in a row", "errors add up along the chain", "nothing needed", .build = chain_64,
		.samples = 50},
	{"chain_200", "200 links of 1 kg in a row", "errors add up along the chain", "nothing needed", .build = chain_200,
		.samples = 10},
	{"light_tip", "8 links from 3 t to 0.3 g", "small torques beside large ones", "nothing needed",
		.build = light_tip, .samples = 1000},
	{"heavy_tip", "8 links from 0.3 g to 3 t", "small links carry large wrenches", "nothing needed",
		.build = heavy_tip, .samples = 1000},
	{"fast", "coaxial joints at 300 and -300 rad/s", "Coriolis terms of 1e5 cancel", F64, .build = robot_rotors,
		.states = STATES_FAST, .samples = 1000},
	{"balance", "a seesaw in exact balance", "the axle's torque is 0", "judge by the terms", .build = robot_balance,
		.states = STATES_LEVEL, .samples = 1000},
	{"free_fall", "a robot that falls freely", "only the input's rounding is left", "judge by the terms", .build = robot_skew,
		.floating = 1, .states = STATES_FALL, .samples = 1000},
	{"slid_0", "six joints with frames at the links", "for comparison with the next", "-", .build = slid_0,
		.samples = 1000},
	{"slid_10", "the same robot with frames 10 m off", "lever arms of 10 m cancel",
		"frames nearer the links; 1.2e-04 and 1.4e-13 before wrenches were made about the centre of mass",
		.build = slid_10, .samples = 1000},
	{"slid_1e6", "the same robot with frames 1000 km off", "lever arms of 1e6 m cancel", "the same; 5e+05 and 1.4e-03 before",
		.build = slid_1e6, .samples = 1000},
	{"turns_1e5", "angles up to 1e5 rad", "15915 turns to take off", "nothing needed", .build = common,
		.states = STATES_TURNS_1E5, .samples = 1000},
	{"turns_1e6", "angles up to 1e6 rad", "159155 turns to take off", "nothing needed", .build = common,
		.states = STATES_TURNS_1E6, .samples = 1000},
	{"right_angles", "rpy of 1.57 and 1.5708 and 3.14", "cosines of 1e-3 and 4e-6", "nothing needed",
		.build = robot_right_angles, .samples = 1000},
	{"parallel", "axes 1e-7 rad from parallel", "common normals 1000 km away", "nothing needed",
		.build = robot_parallel, .samples = 1000},
	{"skew", "skew axes and full rotations", "no zero to leave out", "nothing needed", .build = robot_skew,
		.samples = 1000},
	{"micro", "weightless links of 10 um with inertias of 1e-31", "terms near the end of f32",
		"nothing needed", .build = micro, .weightless = 1, .samples = 1000},
	{"nano", "weightless links of 0.1 um with inertias of 1e-41", "constants are subnormal floats", F64, .build = nano,
		.weightless = 1, .samples = 1000},
	{"star", "100 equal arms around a hub", "100 forces cancel in the hub", "nothing needed", .build = star,
		.floating = 1, .states = STATES_RING, .samples = 50},
	{"quaternion", "a base's quaternion of length 0.5 to 2", "R is no rotation", "nothing needed", "hyq.urdf",
		.floating = 1, .states = STATES_SCALED, .samples = 1000},
	{"away", "a floating base 1e6 m away", "must not enter", "nothing needed", "hyq.urdf", .floating = 1,
		.states = STATES_AWAY, .samples = 1000},
	{"weightless", "no gravity and 1e-3 rad/s", "torques of 1e-6 N m", "nothing needed", "iiwa14.urdf", .weightless = 1,
		.states = STATES_SLOW, .samples = 1000},
	{"overflow", "1e20 rad/s (1e160 in f64)", "the squares overflow", "f64: up to 1e150 rad/s", "iiwa14.urdf",
		.states = STATES_HUGE, .samples = 100},
};
const int HARD_CASE_COUNT = (int)(sizeof HARD_CASES / sizeof *HARD_CASES);

int hard_is_long(const struct hard_case *c)
{
	static const char *const names[] = {"atlas", "g1_29dof", "chain_64", "chain_200", "star"};

	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (!strcmp(c->name, names[i]))
			return 1;
	return 0;
}

static void refuse(const struct hard *h, const char *message)
{
	fprintf(stderr, "%s: %s\n", h->of->name, message);
	exit(1);
}

/* What model_open does, outside a test of Check's. */
static void open_model(struct hard *h)
{
	struct reference_options o = {.floating = h->of->floating, .gravity = h->options.gravity};
	struct model *m = &h->model;
	struct rneagen_error e = {0};
	struct analysis *x;
	char message[256];

	arena_init(&m->arena, NULL);
	if (robot_read(&m->robot, h->urdf, h->length, h->of->name, &m->arena, &e) ||
		merged_analysis(&x, &m->robot, &h->options, &m->arena, &e))
		refuse(h, e.message);
	m->tree = x->tree;
	m->request = x->request;
	dag_init(&m->raw[ALGORITHM_rnea], &m->arena);
	algorithm_rnea.build(&m->raw[ALGORITHM_rnea], &m->tree, &m->request);
	dag_init(&m->dag[ALGORITHM_rnea], &m->arena);
	dag_fuse(&m->dag[ALGORITHM_rnea], &m->raw[ALGORITHM_rnea], 0);
	if (m->dag[ALGORITHM_rnea].failed)
		refuse(h, "out of memory");
	m->reference = reference_open(h->urdf, h->length, &o, message, sizeof message);
	if (!m->reference)
		refuse(h, message);
}

void hard_open(struct hard *h, const struct hard_case *c)
{
	char path[4096];

	*h = (struct hard){.of = c, .options = rneagen_options_default()};
	h->options.base = c->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	h->options.scene = c->scene;
	if (c->weightless)
		h->options.gravity[2] = 0;
	if (c->build) {
		h->urdf = c->build();
		h->length = strlen(h->urdf);
	} else {
		snprintf(path, sizeof path, "%s/robots/%s", TEST_DIR, c->file);
		h->urdf = read_file(path, &h->length);
		if (!h->urdf)
			refuse(h, path);
	}
	open_model(h);
}

void hard_close(struct hard *h)
{
	reference_close(h->model.reference);
	arena_free(&h->model.arena);
	free(h->urdf);
}

static void fill(double *x, int n, struct rng *rng, double size)
{
	for (int i = 0; i < n; i++)
		x[i] = rng_uniform(rng, -size, size);
}

static void fill_turns(double *q, int n, struct rng *rng, double size)
{
	for (int i = 0; i < n; i++)
		q[i] = rng_uniform(rng, size / 2, size) * (rng_chance(rng, 0.5) ? 1 : -1);
}

/* qdd = R^T g at rest: R's third row times -9.81 */
static void fall(const double *q, int nv, double *qd, double *qdd)
{
	double x = q[3], y = q[4], z = q[5], w = q[6];

	memset(qd, 0, (size_t)nv * sizeof *qd);
	memset(qdd, 0, (size_t)nv * sizeof *qdd);
	qdd[0] = -9.81 * 2 * (x * z - y * w);
	qdd[1] = -9.81 * 2 * (y * z + x * w);
	qdd[2] = -9.81 * (1 - 2 * (x * x + y * y));
}

/* All arms move alike: what they do to the hub cancels but for its own axis. */
static void ring(int nv, double *q, double *qd, double *qdd)
{
	for (int i = 0; i < nv; i++) {
		if (i < 6)
			qd[i] = qdd[i] = 0;
		if (i > 7) {
			q[i + 1] = q[8];
			qd[i] = qd[7];
			qdd[i] = qdd[7];
		}
	}
}

static void close_fist(const struct reference *r, double *q, struct rng *rng)
{
	for (int j = 0; j < r->nj; j++)
		if (r->joints[j].nq == 1)
			q[r->joints[j].iq] = r->joints[j].upper - rng_uniform(rng, 0, 0.05);
}

static void adapt(const struct hard *h, struct rng *rng, int f32, double *q, double *qd, double *qdd)
{
	int nv = h->model.tree.nv;
	double size;

	switch (h->of->states) {
	case STATES_ORDINARY:
		break;
	case STATES_FAST:
		for (int i = 0; i < nv; i++)
			qd[i] = i % 2 ? -qd[i - 1] : 300;
		break;
	case STATES_LEVEL:
		q[2] = q[1];
		fill(qd, nv, rng, 0);
		fill(qdd, nv, rng, 0);
		break;
	case STATES_FALL:
		fall(q, nv, qd, qdd);
		break;
	case STATES_TURNS_1E5:
	case STATES_TURNS_1E6:
		fill_turns(q, h->model.tree.nq, rng, h->of->states == STATES_TURNS_1E5 ? 1e5 : 1e6);
		break;
	case STATES_AWAY:
		fill(q, 3, rng, 1e6);
		break;
	case STATES_SCALED:
		size = rng_uniform(rng, 0.5, 2);
		for (int i = 3; i < 7; i++)
			q[i] *= size;
		break;
	case STATES_SLOW:
		fill(qd, nv, rng, 1e-3);
		fill(qdd, nv, rng, 1e-3);
		break;
	case STATES_RING:
		ring(nv, q, qd, qdd);
		break;
	case STATES_HUGE:
		fill(qd, nv, rng, f32 ? 1e20 : 1e160);
		break;
	case STATES_STRETCHED:
		fill(q, h->model.tree.nq, rng, 1e-4);
		break;
	case STATES_FIST:
		close_fist(h->model.reference, q, rng);
		break;
	}
}

static void round_to_float(double *x, int n)
{
	for (int i = 0; i < n; i++)
		x[i] = (double)(float)x[i];
}

void hard_sample(const struct hard *h, struct rng *rng, int f32, double *q, double *qd, double *qdd)
{
	reference_sample(h->model.reference, rng, f32, q, qd, qdd);
	adapt(h, rng, f32, q, qd, qdd);
	if (f32) {
		round_to_float(q, h->model.tree.nq);
		round_to_float(qd, h->model.tree.nv);
		round_to_float(qdd, h->model.tree.nv);
	}
}
