#include "norms/matrix_norm.h"
#include <math.h>
#include <string.h>

static int is_zero(const struct matrix *a)
{
	for (int r = 0; r < a->rows; r++)
		for (int k = 0; k < a->columns; k++)
			if (a->m[r][k] != 0)
				return 0;
	return 1;
}

/* ||A|| <= (trace of (A'A)^32)^(1/64), rounding included. */
double matrix_norm(const struct matrix *a)
{
	double g[NORMS_SET][NORMS_SET] = {{0}}, size = 1;

	for (int i = 0; i < a->columns; i++)
		for (int k = 0; k < a->columns; k++)
			for (int r = 0; r < a->rows; r++)
				g[i][k] += a->m[r][i] * a->m[r][k];
	for (int power = 0; power <= 5; power++) {
		double next[NORMS_SET][NORMS_SET] = {{0}}, trace = 0;

		for (int i = 0; i < a->columns; i++)
			trace += g[i][i];
		if (!(trace > 1e-200))
			return trace > 0 || !is_zero(a) ? (double)INFINITY : a->off * (1 + 0x1p-40);
		size *= pow(trace, 0.5 / (1 << power));
		for (int i = 0; i < a->columns && power < 5; i++)
			for (int k = 0; k < a->columns; k++)
				for (int l = 0; l < a->columns; l++)
					next[i][k] += g[i][l] / trace * (g[l][k] / trace);
		if (power < 5)
			memcpy(g, next, sizeof g);
	}
	return (size + a->off) * (1 + 1e-9);
}
