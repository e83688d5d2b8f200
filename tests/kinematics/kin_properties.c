/* What coriolis, opspace_inv and opspace have to be: matrices that have no one answer, or are solved for. */
#include "kinematics/kin_case.h"
#include "reference/forward.h"
#include <check.h>
#include <stdlib.h>
#include <string.h>

/* Rows of the whole robot by rows of what is modelled. */
static void rows_of(const struct kin_case *c, int *row)
{
	const struct tree *t = &c->analysis.tree;

	for (int i = 0; i < t->joint_count; i++)
		for (int k = 0; k < t->joints[i].nv; k++)
			row[t->joints[i].iv + k] = kin_joint(c, t->joints[i].name)->iv + k;
}

static void expect(struct kin_case *c, const char *what, int i, int j, wide found, wide want, wide size, double noise)
{
	kin_expect(c, what, i, j, found, want, noise * size + WIDE_C(1e-20));
}

/* dM/dt = C + C', C qd = ID(q, qd, 0) - ID(q, 0, 0). */
static void check_coriolis(struct kin_case *c, const struct kin_matrix *C, double noise)
{
	struct reference *r = c->reference;
	static const wide none[KIN_ROWS];
	wide *rate = calloc((size_t)(r->nv * r->nv), sizeof *rate), bias[KIN_ROWS], gravity[KIN_ROWS], largest = 0;
	int row[KIN_ROWS], n = C->lines;

	rows_of(c, row);
	reference_mass_rate(r, c->held, c->q, c->qd, rate);
	reference_rnea_wide(r, c->q, c->qd, none, bias);
	reference_rnea_wide(r, c->q, none, none, gravity);
	for (int i = 0; i < n * n; i++)
		largest = wide_abs(C->x[i]) > largest ? wide_abs(C->x[i]) : largest;
	for (int i = 0; i < n; i++) {
		wide product = 0, size = 0;

		for (int j = 0; j < n; j++) {
			expect(c, "C + C'", i, j, C->x[i * n + j] + C->x[j * n + i], rate[row[i] * r->nv + row[j]],
				C->size[i * n + j] + C->size[j * n + i] + largest, noise);
			product += C->x[i * n + j] * c->qd[row[j]];
			size += (C->size[i * n + j] + largest) * wide_abs(c->qd[row[j]]);
		}
		expect(c, "C qd", i, 0, product, bias[row[i]] - gravity[row[i]], size, noise);
	}
	free(rate);
}

static wide largest_of(const wide *x, int n)
{
	wide largest = 0;

	for (int i = 0; i < n; i++)
		largest = wide_abs(x[i]) > largest ? wide_abs(x[i]) : largest;
	return largest;
}

/* By the least pivot of M, and for the inverse by the condition of what is inverted. Returns 0 where these are too bad. */
static int check_opspace(struct kin_case *c, const struct want *w, const struct kin_matrix *found, double noise)
{
	const char *name = strchr(w->word, '.') + 1;
	const struct reference_frame f = kin_frame(c, name);
	wide inverse[36], copy[36], condition,
		least = reference_opspace_inverse(c->reference, &f, kin_axes(c), c->held, c->q, inverse);

	if (!(least > WIDE_C(1e-6)))
		return 0;
	if (w->kind == WANT_OPSPACE_INV) {
		for (int i = 0; i < 36; i++)
			expect(c, w->word, i / 6, i % 6, found->x[i], inverse[i], largest_of(inverse, 36),
				16 * noise / (double)least);
		return 1;
	}
	memcpy(copy, inverse, sizeof copy);
	condition = reference_condition(6, copy);
	if (!(condition > 0 && condition < WIDE_C(1e8)))
		return 0;
	for (int i = 0; i < 36; i++) {
		wide product = 0;

		for (int k = 0; k < 6; k++)
			product += found->x[i / 6 * 6 + k] * inverse[6 * k + i % 6];
		expect(c, w->word, i / 6, i % 6, product, i / 6 == i % 6, condition, 100 * noise / (double)least);
	}
	return 1;
}

int kin_check(struct kin_case *c, const struct want *w, wide *const *out, double noise)
{
	struct kin_matrix found;
	int count = 1;

	if (w->kind != WANT_CORIOLIS && w->kind != WANT_OPSPACE && w->kind != WANT_OPSPACE_INV)
		return 0;
	found = kin_found(c, w, out);
	if (w->kind == WANT_CORIOLIS)
		check_coriolis(c, &found, noise);
	else
		count = check_opspace(c, w, &found, noise);
	kin_matrix_free(&found);
	return count;
}
