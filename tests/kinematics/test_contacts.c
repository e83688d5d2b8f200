/* Links that stand, in quad precision against the independent reference: with the forces found as pushes from outside, inverse
   dynamics at the qdd found gives tau back, and the links have no acceleration. Derivatives: along jvp both stay so to first
   order, vjp is its transpose, and the matrices are its columns; momentum changes as it does at the qdd found. Robots and random
   trees. Would catch a force of the wrong sign, axes or point, rows of two contacts exchanged, what is left out when forces vary,
   and forces left out of what is summed up. */
#define _POSIX_C_SOURCE 200809L
#include "kinematics/kin_case.h"
#include "reference/differences.h"
#include "support/exhaustive.h"
#include "support/random_robot.h"
#include "support/read.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 41, FIRST = 9300, LINKS = 9, SAMPLES = 2, TEXT = 2048 };

static const struct subject {
	const char *robot, *scene; /* behind whose lines come wants, products and matrices */
	enum rneagen_base base;
	const char *accelerated; /* the input that says how all rows of the first contact are to accelerate; NULL: it stands */
} SUBJECTS[] = {
	{"hyq", "contact lf_foot,rf_foot,lh_foot,rh_foot\n", RNEAGEN_FLOATING, NULL},
	{"hyq", "contact lf_foot,rf_foot,lh_foot,rh_foot\ndynamics articulated\n", RNEAGEN_FLOATING, NULL},
	{"g1_29dof", "contact head_link\nweld right_ankle_roll_link\ndynamics articulated\n", RNEAGEN_FLOATING, NULL},
	{"hyq", "contact rh_foot,lf_foot\nframe world-aligned\nrefine 1:same\nfree accel.rh_foot\n", RNEAGEN_FLOATING, "accel_rh_foot"},
	{"g1_29dof", "contact right_rubber_hand\nweld left_ankle_roll_link\nframe world-aligned\n", RNEAGEN_FLOATING, NULL},
	{"iiwa14", "add-frame tip=iiwa_link_ee,0.1,-0.2,0.3,1,2,3\ncontact tip\nparams base\n", RNEAGEN_FIXED, NULL},
	{"iiwa14", "weld iiwa_link_7\nframe world-aligned\ndynamics articulated\nfree accel.iiwa_link_7\n", RNEAGEN_FIXED,
		"accel_iiwa_link_7"},
	{"floating_joint", "contact left_arm\n", RNEAGEN_FIXED, NULL},
	{"mimic_chain", "contact hand\n", RNEAGEN_FLOATING, NULL},
	{"panda", "contact panda_leftfinger\n", RNEAGEN_FIXED, NULL},
};
enum { SUBJECT_COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

/* Robots' numbers are doubles, and zeros stand for the rounding of such. */
static const wide NOISE = WIDE_C(1e-13), DIFFERED = WIDE_C(1e-8), TRANSPOSED = WIDE_C(1e-16);

/* ---- what the equations leave ---- */

static wide *output_of(struct kin_case *c, const char *name)
{
	int a = dag_find_argument(&c->analysis.dag, name);

	ck_assert_msg(a >= 0, "%s: no output '%s'", c->what, name);
	return c->out[a];
}

/* All forces, by the rows of contacts. */
static void gather(struct kin_case *c, wide *f)
{
	const struct request *k = &c->analysis.request;

	for (int i = 0; i < k->stored_count; i++) {
		const struct contact *to = request_contact_of(k, &k->wants[i]);

		if (to)
			memcpy(f + to->first, output_of(c, k->wants[i].argument), (size_t)to->rows * sizeof *f);
	}
}

/* Out of the axes in which forces are told, into the ground's. */
static void turn(const struct kin_case *c, const struct reference_pose *at, const wide *u, wide *out)
{
	for (int i = 0; i < 3; i++) {
		out[i] = c->analysis.request.frame == FRAME_LINK ? 0 : u[i];
		for (int j = 0; j < 3 && c->analysis.request.frame == FRAME_LINK; j++)
			out[i] += at->m[i][j] * u[j];
	}
}

/* The wrench on the link of its entry, about that link's origin. */
static void push_at(struct kin_case *c, const struct contact *k, const wide *q, const wide *f, wide *pushes)
{
	struct reference_frame frame = kin_frame(c, k->name), link = {.entry = frame.entry, .at = reference_shift(0, 0, 0)};
	struct reference_pose at = reference_pose(c->reference, &frame, q), origin = reference_pose(c->reference, &link, q);
	wide w[6] = {0}, r[3], *to = pushes + 6 * frame.entry;

	turn(c, &at, f + k->first, w);
	if (k->rows == 6)
		turn(c, &at, f + k->first + 3, w + 3);
	for (int i = 0; i < 3; i++)
		r[i] = at.m[i][3] - origin.m[i][3];
	for (int i = 0; i < 3; i++)
		w[3 + i] += r[(i + 1) % 3] * w[(i + 2) % 3] - r[(i + 2) % 3] * w[(i + 1) % 3];
	for (int i = 0; i < 6; i++)
		to[i] += w[i];
}

/* Torques, in the rows of the reference, and how contacts accelerate. */
static void leave(struct kin_case *c, const wide *q, const wide *qd, const wide *qdd, const wide *f, wide *tau, wide *a)
{
	const struct request *k = &c->analysis.request;
	wide *pushes = calloc((size_t)c->reference->nj * 6, sizeof *pushes), all[6];

	for (int i = 0; i < k->contact_count; i++)
		push_at(c, &k->contacts[i], q, f, pushes);
	for (int e = 0; e < c->reference->nj; e++)
		reference_set_push(c->reference, e, pushes + 6 * e, true);
	reference_rnea_wide(c->reference, q, qd, qdd, tau);
	for (int i = 0; i < k->contact_count; i++) {
		struct reference_frame frame = kin_frame(c, k->contacts[i].name);

		reference_acceleration(c->reference, &frame, REFERENCE_ALIGNED, q, qd, qdd, all);
		memcpy(a + k->contacts[i].first, all, (size_t)k->contacts[i].rows * sizeof *a);
	}
	free(pushes);
}

static wide largest(const wide *x, int n)
{
	wide most = 0;

	for (int i = 0; i < n; i++)
		most = wide_abs(x[i]) > most ? wide_abs(x[i]) : most;
	return most;
}

/* By rows of what is modelled, from those of the whole. */
static void model(const struct kin_case *c, const wide *whole, wide *rows)
{
	const struct tree *t = &c->analysis.tree;

	for (int i = 0; i < t->joint_count; i++)
		memcpy(rows + t->joints[i].iv, whole + kin_joint(c, t->joints[i].name)->iv, (size_t)t->joints[i].nv * sizeof *rows);
}

static void unmodel(const struct kin_case *c, const wide *rows, wide *whole)
{
	const struct tree *t = &c->analysis.tree;

	for (int i = 0; i < t->joint_count; i++)
		memcpy(whole + kin_joint(c, t->joints[i].name)->iv, rows + t->joints[i].iv, (size_t)t->joints[i].nv * sizeof *rows);
}

/* Of what stands, in the world's axes. */
static wide demanded(const struct kin_case *c, int row)
{
	return c->more && row < c->analysis.request.contacts[0].rows ? c->in[KIN_INPUTS - 1][row] : 0;
}

static void check_found(struct kin_case *c)
{
	int nv = c->reference->nv, rows = c->analysis.request.contact_rows;
	wide f[KIN_ROWS], tau[KIN_ROWS], a[KIN_ROWS], left[KIN_ROWS], free_tau[KIN_ROWS], none[KIN_ROWS] = {0}, size;

	gather(c, f);
	leave(c, c->q, c->qd, c->qdd, none, free_tau, a);
	leave(c, c->q, c->qd, c->qdd, f, tau, a);
	size = 5 * (1 + largest(free_tau, nv) + largest(tau, nv) + largest(f, rows));
	model(c, tau, left);
	for (int i = 0; i < c->analysis.tree.nv; i++)
		kin_expect(c, "ID(q, qd, qdd), pushed", i, 0, left[i], c->in[3][i], NOISE * size);
	for (int i = 0; i < rows; i++)
		kin_expect(c, "acceleration of what stands", i, 0, a[i], demanded(c, i), 50 * NOISE * (10 + largest(c->qdd, nv)));
}

/* ---- derivatives ---- */

/* The state moved by h along the direction and along the jvp of qdd and of all forces. */
static void leave_moved(struct kin_case *c, wide h, wide *tau, wide *a)
{
	int nv = c->analysis.tree.nv, rows = c->analysis.request.contact_rows, whole = c->reference->nv;
	const wide *v = c->in[4], *jvp = output_of(c, "jvp");
	wide q[KIN_ROWS], qd[KIN_ROWS], qdd[KIN_ROWS], f[KIN_ROWS], along[KIN_ROWS] = {0};

	memcpy(q, c->q, sizeof q);
	unmodel(c, v, along);
	for (int j = 0; j < whole; j++)
		reference_move(c->reference, j, h * along[j], q);
	unmodel(c, v + nv, along);
	for (int j = 0; j < whole; j++)
		qd[j] = c->qd[j] + h * along[j];
	unmodel(c, jvp, along);
	for (int j = 0; j < whole; j++)
		qdd[j] = c->qdd[j] + h * along[j];
	gather(c, f);
	for (int i = 0; i < rows; i++)
		f[i] += h * jvp[nv + i];
	leave(c, q, qd, qdd, f, tau, a);
}

/* d ID = dtau, d a = 0. */
static void check_jvp(struct kin_case *c)
{
	const wide h = WIDE_C(1e-9), *v = c->in[4];
	int nv = c->analysis.tree.nv, rows = c->analysis.request.contact_rows;
	wide tau[2][KIN_ROWS], a[2][KIN_ROWS], left[2][KIN_ROWS], size;

	leave_moved(c, h, tau[0], a[0]);
	leave_moved(c, -h, tau[1], a[1]);
	for (int i = 0; i < 2; i++)
		model(c, tau[i], left[i]);
	size = 5 * (1 + largest(output_of(c, "jvp"), nv + rows) + largest(tau[0], c->reference->nv) + largest(c->qdd, c->reference->nv));
	for (int i = 0; i < nv; i++)
		kin_expect(c, "d ID along jvp", i, 0, (left[0][i] - left[1][i]) / (2 * h), v[2 * nv + i], DIFFERED * size);
	for (int i = 0; i < rows; i++)
		kin_expect(c, "d acceleration along jvp", i, 0, (a[0][i] - a[1][i]) / (2 * h), 0, DIFFERED * size);
}

/* weights . jvp = vjp . v */
static void check_vjp(struct kin_case *c)
{
	int nv = c->analysis.tree.nv, rows = nv + c->analysis.request.contact_rows;
	const wide *v = c->in[4], *weights = c->in[5], *jvp = output_of(c, "jvp"), *vjp = output_of(c, "vjp");
	wide sum = 0, size = 0;

	for (int i = 0; i < rows; i++) {
		sum += weights[i] * jvp[i];
		size += wide_abs(weights[i] * jvp[i]);
	}
	for (int i = 0; i < 3 * nv; i++) {
		sum -= vjp[i] * v[i];
		size += wide_abs(vjp[i] * v[i]);
	}
	kin_expect(c, "vjp", 0, 0, sum, 0, TRANSPOSED * (size + WIDE_C(1e-12)));
}

/* Where tau stands still, jvp is the matrices times the direction. */
static void check_matrices(struct kin_case *c)
{
	const struct request *k = &c->analysis.request;
	int nv = c->analysis.tree.nv;
	struct kin_matrix by[2];

	memset(c->in[4] + 2 * nv, 0, (size_t)nv * sizeof(wide));
	kin_evaluate(c);
	for (int i = 0; i < k->stored_count; i++)
		if (k->wants[i].kind == WANT_DQDD_DQ || k->wants[i].kind == WANT_DQDD_DQD)
			by[k->wants[i].kind == WANT_DQDD_DQD] = kin_found(c, &k->wants[i], c->out);
	for (int i = 0; i < nv; i++) {
		wide sum = 0, size = 0;

		for (int j = 0; j < 2 * nv; j++) {
			sum += by[j / nv].x[i * nv + j % nv] * c->in[4][j];
			size += wide_abs(by[j / nv].x[i * nv + j % nv] * c->in[4][j]);
		}
		kin_expect(c, "dqdd_dq, dqdd_dqd", i, 0, output_of(c, "jvp")[i], sum, TRANSPOSED * (size + WIDE_C(1e-12)));
	}
	kin_matrix_free(&by[0]);
	kin_matrix_free(&by[1]);
}

/* ---- robots ---- */

/* "want qdd,contact.a,weld.b,..." of the links in lines of a scene. */
static void add_wants(char *scene)
{
	char forces[TEXT] = "qdd", *lines = strdup(scene), *rest = lines, *line;

	while ((line = strtok_r(rest, "\n", &rest))) {
		int is_contact = !strncmp(line, "contact ", 8), is_weld = !strncmp(line, "weld ", 5);

		for (char *name = strchr(line, ' '), *next; (is_contact || is_weld) && name; name = next) {
			next = strchr(++name, ',');
			snprintf(forces + strlen(forces), sizeof forces - strlen(forces), ",%s.%.*s", is_weld ? "weld" : "contact",
				next ? (int)(next - name) : (int)strlen(name), name);
		}
	}
	/* rows of products are those of contacts, which welds follow */
	snprintf(scene + strlen(scene), TEXT - strlen(scene), "want %s,momentum,dmomentum,dqdd_dq,dqdd_dqd\njvp %s\nvjp %s\n", forces,
		forces, forces);
	free(lines);
}

static int check(struct kin_case *c, const char *urdf, const char *scene, enum rneagen_base base)
{
	struct rneagen_options o = rneagen_options_default();

	o.scene = scene;
	o.base = base;
	if (!kin_open(c, urdf, NULL, &o, SEED))
		return 0;
	for (int s = 0; s < SAMPLES; s++) {
		kin_draw(c);
		kin_evaluate(c);
		check_found(c);
		ck_assert_int_ge(kin_compare(c, (double)(50 * NOISE)), 2); /* momentum and its rate, at the qdd found */
		check_jvp(c);
		check_vjp(c);
		check_matrices(c);
	}
	kin_close(c);
	return 1;
}

START_TEST(robots)
{
	const struct subject *s = &SUBJECTS[_i];
	struct kin_case *c = calloc(1, sizeof *c);
	char *urdf = robot_text(s->robot), scene[TEXT];

	snprintf(scene, sizeof scene, "%s", s->scene);
	add_wants(scene);
	c->added[c->added_count++] = (struct kin_added){"tip", "iiwa_link_ee", {0.1, -0.2, 0.3, 1, 2, 3}};
	c->more = s->accelerated;
	snprintf(c->what, sizeof c->what, "%s, row %d, seed %d", s->robot, _i, SEED);
	ck_assert(check(c, urdf, scene, s->base));
	printf("%s: off by %.2g of the tolerance\n", c->what, c->worst);
	free(urdf);
	free(c);
}
END_TEST

/* A step of refinement with its residual in f64 leaves forces and accelerations of a text in f32 a rounding off. */
START_TEST(refined)
{
	static const char scene[] = "contact lf_foot,rf_foot,lh_foot,rh_foot\nrefine 1:f64\n"
				    "want contact.lf_foot,contact.rf_foot,contact.lh_foot,contact.rh_foot,qdd\n";
	struct kin_case *c = calloc(1, sizeof *c);
	struct rneagen_options o = rneagen_options_default();
	char *urdf = robot_text("hyq");

	o.scene = scene;
	o.base = RNEAGEN_FLOATING;
	o.precision = RNEAGEN_F32;
	snprintf(c->what, sizeof c->what, "hyq in f32, refined, seed %d", SEED);
	ck_assert(kin_open(c, urdf, NULL, &o, SEED));
	for (int s = 0; s < 20; s++) {
		wide f[KIN_ROWS], qdd[KIN_ROWS], found[KIN_ROWS];
		int nv = c->analysis.tree.nv, rows = c->analysis.request.contact_rows;

		kin_draw(c);
		kin_round(c, 1);
		kin_evaluate(c);
		gather(c, f);
		memcpy(qdd, output_of(c, "qdd"), (size_t)nv * sizeof *qdd);
		kin_evaluate_rounded(c, 1);
		gather(c, found);
		for (int i = 0; i < rows; i++)
			kin_expect(c, "force", i, 0, found[i], f[i], 0x1p-23 * largest(f, rows));
		for (int i = 0; i < nv; i++)
			kin_expect(c, "qdd", i, 0, output_of(c, "qdd")[i], qdd[i], 0x1p-23 * largest(qdd, nv));
	}
	printf("%s: off by %.2g of the tolerance\n", c->what, c->worst);
	kin_close(c);
	free(urdf);
	free(c);
}
END_TEST

/* ---- random trees ---- */

/* A link that moves; the scene refuses the others. */
static const char *some_link(struct rng *rng, const struct reference *r)
{
	for (;;) {
		int drawn = rng_below(rng, r->nj);

		for (int i = drawn; i >= 0; i = r->joints[i].parent)
			if (r->joints[i].type != REFERENCE_FIXED)
				return r->joints[drawn].link;
	}
}

/* One or two links of a tree, which may stand or not: then it is refused. */
static void draw_scene(struct rng *rng, const struct reference *r, char *scene)
{
	const char *first = some_link(rng, r), *second = some_link(rng, r);
	int is_weld = rng_chance(rng, 0.3), has_both = strcmp(first, second) && rng_chance(rng, 0.5);

	snprintf(scene, TEXT, "%s %s\n%s%s%s%s%s", has_both || !is_weld ? "contact" : "weld", first, has_both && is_weld ? "weld " : "",
		has_both && is_weld ? second : "", has_both && is_weld ? "\n" : "", rng_chance(rng, 0.5) ? "frame world-aligned\n" : "",
		rng_chance(rng, 0.3) ? "params base\n" : "");
	add_wants(scene);
}

static int check_tree(uint64_t seed, double *worst)
{
	struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
	struct rng rng = rng_seed(seed);
	struct kin_case *c = calloc(1, sizeof *c);
	const struct reference_options ro = {.floating = seed % 3 > 0};
	char *urdf, scene[TEXT], message[256];
	struct reference *r;
	int is_checked;

	knobs.odd_names = 0;
	urdf = random_robot(seed, &knobs);
	r = reference_open(urdf, strlen(urdf), &ro, message, sizeof message);
	ck_assert_msg(r != NULL, "%s", message);
	draw_scene(&rng, r, scene);
	snprintf(c->what, sizeof c->what, "tree %llu", (unsigned long long)seed);
	is_checked = check(c, urdf, scene, ro.floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED);
	*worst = c->worst > *worst ? c->worst : *worst;
	reference_close(r);
	free(urdf);
	free(c);
	return is_checked;
}

START_TEST(trees)
{
	int checked = 0, count = exhaustive() ? 60 : sanitized() ? 15 : 30;
	double worst = 0;

	for (int i = 0; i < count; i++)
		checked += check_tree(FIRST + (uint64_t)i, &worst);
	printf("seeds from %d: %d of %d trees had links that can stand; off by %.2g of the tolerance\n", FIRST, checked, count, worst);
	ck_assert_int_ge(checked, count / 4);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("contacts");

	suite_add(suite, "robots", robots, SUBJECT_COUNT, 120);
	suite_add(suite, "refined", refined, 1, 120);
	suite_add(suite, "trees", trees, 1, 120);
	return suite_run(suite);
}
