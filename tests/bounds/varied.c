#include "varied.h"
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char WANTS[] = "want tau,dtau_dq,dtau_dqd,M\ndense\n";
static const char *const STATES[STATE] = {"q", "qd", "qdd"}, *const NAMES[OUTPUTS] = {"tau", "dtau_dq", "dtau_dqd", "M"};

static void number_arguments(struct varied *x)
{
	const struct dag *d = &x->model.dag;

	for (int a = 0; a < d->argument_count; a++) {
		const char *const *names = d->arguments[a].is_output ? NAMES : STATES;

		while (strcmp(names[x->number[a]], d->arguments[a].name))
			x->number[a]++;
	}
}

/* Where a row of what is left is in the whole. */
static int entry_of(const struct varied *x, int joint)
{
	for (int j = 0; j < x->table->nj; j++)
		if (!strcmp(x->table->joints[j].name, x->model.tree.joints[joint].name))
			return j;
	ck_abort_msg("%s: no joint '%s' in the reference", x->what, x->model.tree.joints[joint].name);
	return -1;
}

static void open_rows(struct varied *x)
{
	int nv = x->nv, whole = x->table->nv;

	for (int i = 0; i < x->model.tree.joint_count; i++)
		for (int k = 0; k < x->model.tree.joints[i].nv; k++)
			x->v_row[x->model.tree.joints[i].iv + k] = x->table->joints[entry_of(x, i)].iv + k;
	for (int o = 0; o < OUTPUTS; o++) {
		x->whole_of[o] = numbers_new(whole * whole, sizeof(__float128));
		x->want[o] = numbers_new(nv * nv, sizeof(__float128));
		x->exact[o] = numbers_new(nv * nv, sizeof(__float128));
		x->got[o] = numbers_new(nv * nv, sizeof(double));
		x->bound[o] = numbers_new(nv * nv, sizeof(double));
		x->got_f32[o] = numbers_new(nv * nv, sizeof(float));
	}
	x->size = numbers_new((int)x->model.dag.output_count, sizeof(double));
	number_arguments(x);
}

int varied_open(struct varied *x, const char *urdf, const struct rneagen_options *options, uint64_t seed, const char *lock,
	const char *what)
{
	struct rneagen_options o = *options;
	char message[256], scene[512];

	snprintf(scene, sizeof scene, "%s%s", lock, WANTS);
	o.scene = scene;
	*x = (struct varied){.what = what, .rng = rng_seed(seed), .held = -1};
	if (scene_open(&x->model, urdf, &o)) {
		ck_assert_msg(x->model.error.code == RNEAGEN_NO_JOINTS, "%s: %s", what, x->model.error.message);
		scene_close(&x->model);
		return 0;
	}
	x->nq = x->model.tree.nq;
	x->nv = x->model.tree.nv;
	if (x->nv > MOST_ROWS) {
		scene_close(&x->model);
		return 0;
	}
	x->table = scene_reference(urdf, &o);
	x->quad = quad_open(
		urdf, strlen(urdf), o.base == RNEAGEN_FLOATING, 0, QUAD_DECIMALS, o.gravity, NULL, message, sizeof message);
	ck_assert_msg(x->quad != NULL, "%s: %s", what, message);
	open_rows(x);
	return 1;
}

void varied_close(struct varied *x)
{
	for (int o = 0; o < OUTPUTS; o++) {
		free(x->whole_of[o]);
		free(x->want[o]);
		free(x->exact[o]);
		free(x->got[o]);
		free(x->bound[o]);
		free(x->got_f32[o]);
	}
	free(x->size);
	quad_close(x->quad);
	reference_close(x->table);
	scene_close(&x->model);
}

/* ---- states ---- */

/* Quaternions that are units in floats too, since otherwise it matters which way the reference multiplies. */
static void set_unit_quaternions(struct varied *x)
{
	for (int j = 0; j < x->table->nj; j++)
		for (int i = 3; i < 7 && x->table->joints[j].type == REFERENCE_FLOATING; i++)
			x->whole[0][x->table->joints[j].iq + i] = rng_chance(&x->rng, 0.5) ? 0.5 : -0.5;
}

/* What is held stands still; the rest is rounded, and the rows that are left are gathered. */
void varied_settle(struct varied *x)
{
	const struct reference_joint *held = x->held < 0 ? NULL : &x->table->joints[x->held];

	if (held) {
		x->whole[0][held->iq] = x->at;
		x->whole[1][held->iv] = x->whole[2][held->iv] = 0;
	}
	for (int a = 0; a < STATE; a++)
		for (int i = 0; i < (a ? x->table->nv : x->table->nq); i++)
			x->whole[a][i] = held && !a && i == held->iq ? x->at : (double)(float)x->whole[a][i];
	for (int i = 0; i < x->model.tree.joint_count; i++) {
		const struct tree_joint *k = &x->model.tree.joints[i];
		const struct reference_joint *from = &x->table->joints[entry_of(x, i)];

		for (int a = 0; a < STATE; a++)
			for (int r = 0; r < (a ? k->nv : k->nq); r++) {
				x->in[a][(a ? k->iv : k->iq) + r] = x->whole[a][(a ? from->iv : from->iq) + r];
				x->in_f32[a][(a ? k->iv : k->iq) + r] = (float)x->in[a][(a ? k->iv : k->iq) + r];
			}
	}
}

void varied_draw(struct varied *x)
{
	reference_sample(x->table, &x->rng, true, x->whole[0], x->whole[1], x->whole[2]);
	set_unit_quaternions(x);
	varied_settle(x);
}

/* ---- what is right ---- */

static void evaluate_exact(struct varied *x)
{
	__float128 in[STATE][ROWS];
	POINTERS(__float128) p;

	for (int a = 0; a < STATE; a++)
		for (int i = 0; i < (a ? x->nv : x->nq); i++)
			in[a][i] = (__float128)x->in[a][i];
	POINT(p, x, in, x->exact);
	ck_assert(eval_quad(&x->model.dag, p.in, p.out, NULL));
}

/* What the reference's differences may be off in row i of anything: a part of the magnitudes with a unit more of every rate,
   position and acceleration, which is above all derivatives by them. Constants that are taken for equal, or zero, are among
   it. */
static void refer_noise(struct varied *x)
{
	double more[STATE][ROWS], size[ROWS];

	for (int a = 0; a < STATE; a++)
		for (int i = 0; i < (a ? x->table->nv : x->table->nq); i++)
			more[a][i] = a ? fabs(x->whole[a][i]) + 1 : x->whole[a][i];
	quad_magnitude(x->quad, more[0], more[1], more[2], size);
	for (int i = 0; i < x->nv; i++)
		x->noise[i] = 0x1p-60 * size[x->v_row[i]];
}

double varied_half_units(const struct varied *x, int output, int row)
{
	return 0x1p7 * x->noise[output == TAU ? row : row / x->nv];
}

void varied_refer(struct varied *x)
{
	quad_rnea(x->quad, x->whole[0], x->whole[1], x->whole[2], x->whole_of[TAU]);
	quad_derivatives(x->quad, x->whole[0], x->whole[1], x->whole[2], x->whole_of[DQ], x->whole_of[DQD], x->whole_of[MASS]);
	for (int i = 0; i < x->nv; i++) {
		x->want[TAU][i] = x->whole_of[TAU][x->v_row[i]];
		for (int o = DQ; o < OUTPUTS; o++)
			for (int j = 0; j < x->nv; j++)
				x->want[o][i * x->nv + j] = x->whole_of[o][x->v_row[i] * x->table->nv + x->v_row[j]];
	}
	evaluate_exact(x);
	refer_noise(x);
}

int varied_rows(const struct varied *x, int output)
{
	return output == TAU ? x->nv : x->nv * x->nv;
}
