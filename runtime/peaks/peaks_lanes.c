#include "peaks/peaks_lanes.h"
#include <math.h>

#if defined __x86_64__ && defined __GNUC__ && !defined __clang__ && !defined __SANITIZE_ADDRESS__ &&                   \
	!defined __SANITIZE_THREAD__
#define LANES_FAST __attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3", "no-math-errno")))
#else
#define LANES_FAST
#endif

LANES_FAST void lanes_run(const struct lanes_step *steps, size_t count, size_t width, lanes_vector *v)
{
	for (const struct lanes_step *s = steps; s < steps + count; s++) {
		lanes_vector *to = v + s->to * width;
		const lanes_vector *a = v + s->a * width, *b = v + s->b * width;

		switch (s->op) {
		case OP_NEG:
			for (size_t i = 0; i < width; i++)
				to[i] = -a[i];
			break;
		case OP_ADD:
			for (size_t i = 0; i < width; i++)
				to[i] = a[i] + b[i];
			break;
		case OP_SUB:
			for (size_t i = 0; i < width; i++)
				to[i] = a[i] - b[i];
			break;
		default: /* OP_MUL: peaks_marks.c knows no other */
			for (size_t i = 0; i < width; i++)
				to[i] = a[i] * b[i];
		}
	}
}

LANES_FAST void lanes_squares(size_t width, const lanes_vector *a, const lanes_vector *b, lanes_vector *most)
{
	lanes_vector m = *most;

	for (size_t i = 0; i < width; i++) {
		lanes_vector x = a[i] * a[i];

		if (b)
			x += b[i] * b[i];
		for (int k = 0; k < LANES_VECTOR; k++)
			m[k] = x[k] > m[k] ? x[k] : m[k];
	}
	*most = m;
}

LANES_FAST void lanes_coefficients(int m, int n, const double *v, double *c)
{
	const double *forth = v + 1 + m, *back = forth + n, *pair = back + n;
	double *squares = c + 1 + m + n, *pairs = squares + n;

	c[0] = v[0];
	for (int i = 0; i < m; i++)
		c[1 + i] = v[1 + i] - v[0];
	for (int j = 0; j < n; j++) {
		c[1 + m + j] = 0.5 * (forth[j] - back[j]);
		squares[j] = 0.5 * (forth[j] + back[j]) - v[0];
	}
	for (int j = 0; j < n; pairs += n - j - 1, pair += n - j - 1, j++)
		for (int k = j + 1; k < n; k++)
			pairs[k - j - 1] = pair[k - j - 1] - forth[j] - forth[k] + v[0];
}

LANES_FAST void lanes_lengths(int n, const double *a, const double *b, double *lengths)
{
	for (int i = 0; i < n; i++)
		lengths[i] = b ? sqrt(a[i] * a[i] + b[i] * b[i]) : fabs(a[i]);
}
