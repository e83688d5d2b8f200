#include "reference/reference.h"
#include "reference/tree.h"

static void copy(wide *out, struct d6_vec v)
{
	for (int k = 0; out && k < 6; k++)
		out[k] = v.x[k];
}

void reference_link(const struct reference *r, int entry, wide *v, wide *a, wide *f)
{
	const struct reference_link *l = &r->links[entry];

	copy(v, l->v);
	copy(a, l->a);
	copy(f, l->f);
}

wide reference_kinetic(const struct reference *r, bool magnitudes)
{
	wide sum = 0;

	for (int i = 0; i < r->nj; i++) {
		const struct reference_link *l = &r->links[i];
		struct d6_vec p = d6_apply(magnitudes ? d6_abs(l->inertia) : l->inertia, l->v);

		for (int k = 0; k < 6; k++)
			sum += l->v.x[k] * p.x[k];
	}
	return sum / 2;
}

// Rows and columns of the ten parameters in the inertia [m 1, -[h]; [h], I].
static const struct {
	int row, column;
} AT[10] = {{0, 0}, {5, 1}, {3, 2}, {4, 0}, {3, 3}, {3, 4}, {3, 5}, {4, 4}, {4, 5}, {5, 5}};

void reference_inertia(const struct reference *r, int entry, wide p[10])
{
	for (int i = 0; i < 10; i++)
		p[i] = r->links[entry].inertia.m[AT[i].row][AT[i].column];
}

void reference_set_inertia(struct reference *r, int entry, const wide p[10])
{
	struct d6_mat *m = &r->links[entry].inertia;
	struct d3_mat h = d3_cross((struct d3_vec){{p[1], p[2], p[3]}});

	*m = (struct d6_mat){0};
	for (int i = 0; i < 3; i++) {
		m->m[i][i] = p[0];
		for (int j = 0; j < 3; j++) {
			m->m[3 + i][j] = h.m[i][j];
			m->m[i][3 + j] = -h.m[i][j];
		}
	}
	for (int i = 4; i < 10; i++)
		m->m[AT[i].row][AT[i].column] = m->m[AT[i].column][AT[i].row] = p[i];
}

void reference_set_push(struct reference *r, int entry, const wide w[6], bool in_ground)
{
	for (int k = 0; k < 6; k++)
		r->links[entry].push.x[k] = w[k];
	r->links[entry].push_in_world = in_ground;
}

void reference_set_own(struct reference *r, int entry, const struct reference_own *terms)
{
	r->links[entry].terms = *terms;
}
