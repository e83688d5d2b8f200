/* Errors of qdd in hard cases, by both ways and in both precisions, against a solve in quad precision, beside M's
   condition number. usage: hard_forward                          writes the results, as CSV, to standard output
	  hard_forward --check FILE [CASE...]   do they agree with the file's, within a half? By default the short ones
 */
#define _POSIX_C_SOURCE 200809L
#include "cases.h"
#include "quad.h"
#include "robots.h"
#include "support/exhaustive.h"
#include "support/scene_model.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 5, CONDITIONS = 3, WAYS = 2, PRECISIONS = 2 };

static const char *const WAY_NAMES[WAYS] = {"factor", "articulated"};

static char *chain(void)
{
	return robot_chain(64);
}

static const struct hard_case CASES[] = {
	{"iiwa14", "iiwa14", "an ordinary robot", "", "iiwa14.urdf", .samples = 300},
	{"hyq", "hyq with a floating base", "an ordinary robot", "", "hyq.urdf", .floating = 1, .samples = 100},
	{"finger", "a finger of 1 g on an arm of 100 kg", "M has elements of 1e-6 beside 1e2", "",
		.build = robot_finger, .samples = 300},
	{"chain", "64 links of 1 kg in a row", "M's eigenvalues spread with the length", "", .build = chain,
		.samples = 5},
	{"stretched", "iiwa14 stretched out", "axes of four joints coincide", "", "iiwa14.urdf",
		.states = STATES_STRETCHED, .samples = 300},
	{"needle", "a joint with 1e-8 kg m^2 on its axis", "a small inertia beside large ones", "",
		.build = robot_needle, .samples = 300},
	{"satellite", "an arm of 3 g on a free base of 1000 kg", "a mass ratio of 1e6", "", .build = robot_satellite,
		.floating = 1, .weightless = 1, .samples = 300},
	{"fist", "a hand's closed fist", "24 joints with light links, at their limits", "", "shadow_hand_right.urdf",
		.states = STATES_FIST, .samples = 30},
};
enum { CASE_COUNT = sizeof CASES / sizeof *CASES };

struct errors {
	double max, rms;
};

struct result {
	double condition;
	int nv;
	struct errors of[PRECISIONS][WAYS];
};

/* One state, torques that take its qdd, rounded, and the qdd that these make. */
struct trial {
	double q[ROWS], qd[ROWS], qdd[ROWS], tau[ROWS];
	__float128 exact[ROWS];
};

static void draw(const struct hard *h, struct quad *x, struct rng *rng, int f32, struct trial *t)
{
	__float128 tau[ROWS];

	hard_sample(h, rng, f32, t->q, t->qd, t->qdd);
	quad_rnea(x, t->q, t->qd, t->qdd, tau);
	for (int i = 0; i < h->model.tree.nv; i++)
		t->tau[i] = f32 ? (double)(float)tau[i] : (double)tau[i];
	if (!quad_forward(x, t->q, t->qd, t->tau, t->exact)) {
		fprintf(stderr, "%s: M is not positive definite\n", h->of->name);
		exit(1);
	}
}

static void evaluate(const struct dag *d, int f32, const struct trial *t, double *qdd)
{
	static float in[3][ROWS], out[ROWS];

	for (int i = 0; i < ROWS; i++) {
		in[0][i] = (float)t->q[i];
		in[1][i] = (float)t->qd[i];
		in[2][i] = (float)t->tau[i];
	}
	if (f32 ? !eval_f32(d, (const float *[]){in[0], in[1], in[2], NULL}, (float *[]){NULL, NULL, NULL, out}, NULL)
		: !eval_f64(d, (const double *[]){t->q, t->qd, t->tau, NULL}, (double *[]){NULL, NULL, NULL, qdd}, NULL))
		abort();
	for (int i = 0; i < ROWS && f32; i++)
		qdd[i] = (double)out[i];
}

static double error_of(const double *qdd, const __float128 *exact, int n)
{
	double off = 0, size = 0;

	for (int i = 0; i < n; i++) {
		off += pow((double)(qdd[i] - exact[i]), 2);
		size += pow((double)exact[i], 2);
	}
	return sqrt(off / size);
}

static void open_way(struct scene_model *m, const struct hard *h, const char *way)
{
	struct rneagen_options o = h->options;
	char scene[64];

	snprintf(scene, sizeof scene, "want qdd\ndynamics %s\n", way);
	o.scene = scene;
	if (scene_open(m, h->urdf, &o)) {
		fprintf(stderr, "%s: %s\n", h->of->name, m->error.message);
		exit(1);
	}
}

static void measure_precision(const struct hard *h, struct quad *x, struct scene_model *m, int f32, struct result *r)
{
	struct rng rng = rng_seed(SEED);
	static struct trial t;
	static double qdd[ROWS];

	for (int s = 0; s < h->of->samples; s++) {
		draw(h, x, &rng, f32, &t);
		if (s < CONDITIONS)
			r->condition = fmax(r->condition, quad_condition(x, t.q));
		for (int way = 0; way < WAYS; way++) {
			struct errors *o = &r->of[!f32][way];
			double error;

			evaluate(&m[way].dag, f32, &t, qdd);
			error = error_of(qdd, t.exact, r->nv);
			o->max = !(error <= o->max) ? error : o->max;
			o->rms += error * error / h->of->samples;
		}
	}
}

static struct result measure(const struct hard_case *c)
{
	struct scene_model m[WAYS];
	struct result r = {0};
	char message[256];
	struct hard h;
	struct quad *x;

	hard_open(&h, c);
	r.nv = h.model.tree.nv;
	x = quad_open(h.urdf, h.length, c->floating, 0, QUAD_DECIMALS, h.options.gravity, NULL, message, sizeof message);
	if (!x || r.nv > ROWS)
		abort();
	for (int way = 0; way < WAYS; way++)
		open_way(&m[way], &h, WAY_NAMES[way]);
	for (int f32 = 1; f32 >= 0; f32--)
		measure_precision(&h, x, m, f32, &r);
	for (int i = 0; i < PRECISIONS * WAYS; i++)
		r.of[i / WAYS][i % WAYS].rms = sqrt(r.of[i / WAYS][i % WAYS].rms);
	for (int way = 0; way < WAYS; way++)
		scene_close(&m[way]);
	quad_close(x);
	hard_close(&h);
	return r;
}

/* ---- results ---- */

static void put_case(FILE *out, const struct hard_case *c, const struct result *r)
{
	fprintf(out, "%s,\"%s\",\"%s\",%d,%d,%.1e", c->name, c->what, c->why, c->samples, r->nv, r->condition);
	for (int i = 0; i < PRECISIONS * WAYS; i++)
		fprintf(out, ",%.2e,%.2e", r->of[i / WAYS][i % WAYS].max, r->of[i / WAYS][i % WAYS].rms);
	fputc('\n', out);
	fflush(out);
}

static void put_head(FILE *out)
{
	fprintf(out, "# tests/hard/forward, seed %d\ncase,what,why,samples,nv,condition", SEED);
	for (int i = 0; i < PRECISIONS * WAYS; i++)
		fprintf(out, ",%s_%s_max,%s_%s_rms", i / WAYS ? "f64" : "f32", WAY_NAMES[i % WAYS],
			i / WAYS ? "f64" : "f32", WAY_NAMES[i % WAYS]);
	fputc('\n', out);
}

/* Equal but for numbers with an exponent, which may differ by a half: C libraries differ in the sine's last bit, and the largest
   error is one sample's. */
static int agree(const char *a, const char *b)
{
	while (*a || *b) {
		size_t n = strcspn(a, ",\n"), m = strcspn(b, ",\n");
		int is_number = memchr(a, '.', n) && memchr(a, 'e', n) && *a != '"';

		if (is_number ? !(fabs(atof(a) / atof(b) - 1) <= 0.5) : n != m || memcmp(a, b, n))
			return 0;
		a += n + (a[n] != 0);
		b += m + (b[m] != 0);
	}
	return 1;
}

static int check_case(const char *text, const struct hard_case *c)
{
	struct result r = measure(c);
	char start[64], *now, *line;
	size_t length;
	FILE *out = open_memstream(&now, &length);
	int differs;

	if (!out)
		abort();
	put_case(out, c, &r);
	fclose(out);
	snprintf(start, sizeof start, "\n%s,", c->name);
	line = strstr(text, start);
	line = line ? strndup(line + 1, strcspn(line + 1, "\n") + 1) : strdup("");
	differs = !agree(now, line);
	if (differs)
		printf("%s: measured\n%sin the results\n%s", c->name, now, line);
	free(now);
	free(line);
	return differs;
}

static int is_wanted(int i, char **names)
{
	for (char **name = names; *name; name++)
		if (!strcmp(*name, CASES[i].name))
			return 1;
	return !*names && (exhaustive() || CASES[i].samples >= 300);
}

static int check(const char *path, char **names)
{
	size_t length;
	char *text = read_file(path, &length);
	int count = 0, differ = 0;

	if (!text) {
		fprintf(stderr, "%s: cannot be read\n", path);
		return 1;
	}
	for (int i = 0; i < CASE_COUNT; i++)
		if (is_wanted(i, names)) {
			differ += check_case(text, &CASES[i]);
			count++;
		}
	free(text);
	printf("%d cases measured anew, seed %d: %d differ from %s\n", count, SEED, differ, path);
	return differ || !count;
}

int main(int argc, char **argv)
{
	if (argc > 2 && !strcmp(argv[1], "--check"))
		return check(argv[2], argv + 3);
	put_head(stdout);
	for (int i = 0; i < CASE_COUNT; i++) {
		struct result r = measure(&CASES[i]);

		put_case(stdout, &CASES[i], &r);
	}
	return 0;
}
