#include "range/extreme.h"
#include <math.h>
#include <string.h>

/* Of so many rates at most all corners are tried; with these, each of the others has its best apart from the rest of them.
   Of rates beyond ROOM magnitudes are added. */
enum { CORNER_RATES = 12, ROOM = 24 };

/* Products of rates that are apart may be taken by their magnitudes where they are this part of all. */
#define SLIGHT 0x1p-30

/* sign * sum b_j v_j + sum_{j<k} c_jk v_j v_k + sum c_jj v_j^2, c_jj >= 0 */
struct corners {
	int n;
	int order[ROOM], corner_count; /* those of which corners are tried come first */
	double linear[ROOM], pair[ROOM][ROOM], square[ROOM];
	double lower[ROOM], upper[ROOM];
	double rest; /* what is added for products of the others, and for other rates */
};

/* Squares that neither vanish nor overflow. Where they do, each number of the direction is taken for 1. */
static int are_normal(double squares)
{
	return squares > 0x1p-900 && squares < 0x1p1000;
}

static double drives_above(const struct field *f, const double *c, int sign, double *size, double *x)
{
	double sum = sign * c[0], squares[FIELD_BALLS + 1] = {0};

	*size = fabs(c[0]);
	for (int i = 0; i < f->drive_count; i++)
		squares[f->drives[i].ball] += c[1 + i] * c[1 + i];
	for (int i = 0; i < f->drive_count; i++) {
		double m = sign * c[1 + i], at = m > 0 ? f->drives[i].range.upper : f->drives[i].range.lower;

		if (f->drives[i].ball)
			at = are_normal(squares[f->drives[i].ball]) ? m / sqrt(squares[f->drives[i].ball]) : m > 0 ? 1 : -1;
		sum += m * at;
		*size += fabs(m) * interval_size(f->drives[i].range);
		if (x)
			x[i] = at;
	}
	return sum;
}

/* What the rates can add at most, by magnitudes. */
static double rates_size(const struct field *f, const double *c)
{
	double sum = 0;

	for (int j = 0; j < f->rate_count; j++) {
		double of_j = fabs(c[1 + f->drive_count + j]);

		for (int k = j; k < f->rate_count; k++)
			of_j += fabs(c[field_pair(f, j, k)]) * interval_size(f->rates[k].range);
		sum += of_j * interval_size(f->rates[j].range);
	}
	return sum;
}

/* A concave square is replaced by its tangent where it is largest: c v^2 <= c (2 p v - p^2). */
static void add_square(struct corners *s, int j, double c, struct interval r)
{
	double p = r.lower > 0 ? r.lower : r.upper < 0 ? r.upper : 0;

	if (c >= 0) {
		s->square[j] = c;
		return;
	}
	s->linear[j] += 2 * c * p;
	s->rest -= c * p * p;
}

static double reach_of(const struct corners *s, int j)
{
	return fmax(fabs(s->lower[j]), fabs(s->upper[j]));
}

/* The magnitudes of a rate's products with those from `first` on. */
static double products_of(const struct corners *s, int j, int first)
{
	double sum = 0;

	for (int i = first; i < s->n; i++)
		sum += fabs(s->pair[j][s->order[i]]) * reach_of(s, s->order[i]);
	return sum * reach_of(s, j);
}

/* Corners of those first that have the most to do with the others, until the others have nothing to do with each other. */
static void choose_corners(struct corners *s, double size)
{
	for (s->corner_count = 0;; s->corner_count++) {
		double all = 0, most = 0;
		int at = s->corner_count, j;

		for (int i = s->corner_count; i < s->n; i++) {
			double sum = products_of(s, s->order[i], s->corner_count);

			all += sum;
			at = sum > most ? i : at;
			most = fmax(most, sum);
		}
		if (s->corner_count == CORNER_RATES || !(all > SLIGHT * size)) {
			s->rest += 0.5 * all * (1 + 0x1p-40);
			break;
		}
		j = s->order[at];
		s->order[at] = s->order[s->corner_count];
		s->order[s->corner_count] = j;
	}
	for (int i = s->corner_count; i < s->n; i++)
		for (int k = s->corner_count; k < s->n; k++)
			s->pair[s->order[i]][s->order[k]] = 0;
}

static void set_corners(struct corners *s, const struct field *f, const double *c, int sign, double size)
{
	s->n = f->rate_count < ROOM ? f->rate_count : ROOM;
	s->rest = 0;
	for (int j = 0; j < f->rate_count; j++) {
		struct interval r = f->rates[j].range;

		for (int k = j + 1; k < f->rate_count; k++) {
			double pair = sign * c[field_pair(f, j, k)];

			if (k < s->n)
				s->pair[j][k] = s->pair[k][j] = pair;
			else
				s->rest += fabs(pair) * interval_size(r) * interval_size(f->rates[k].range);
		}
		if (j >= s->n) {
			s->rest += (fabs(c[1 + f->drive_count + j]) + fabs(c[field_pair(f, j, j)]) * interval_size(r)) * interval_size(r);
			continue;
		}
		s->order[j] = j;
		s->pair[j][j] = s->square[j] = 0;
		s->lower[j] = r.lower;
		s->upper[j] = r.upper;
		s->linear[j] = sign * c[1 + f->drive_count + j];
		add_square(s, j, sign * c[field_pair(f, j, j)], r);
	}
	choose_corners(s, size);
}

/* Is v as good as -v? Then the first rate has one value. */
static int is_even(const struct corners *s)
{
	for (int j = 0; j < s->n; j++)
		if (s->linear[j] != 0 || s->lower[j] != -s->upper[j])
			return 0;
	return s->corner_count > 0;
}

/* What the others add, each at its better end. */
static double add_others(const struct corners *s, const double *slope, double *v)
{
	double sum = 0;

	for (int i = s->corner_count; i < s->n; i++) {
		int j = s->order[i];
		double low = (slope[j] + s->square[j] * s->lower[j]) * s->lower[j],
		       high = (slope[j] + s->square[j] * s->upper[j]) * s->upper[j];

		v[j] = low > high ? s->lower[j] : s->upper[j];
		sum += low > high ? low : high;
	}
	return sum;
}

/* All corners in the order of Gray's code: one rate changes at a time. */
static double walk(struct corners *s, double *best)
{
	double v[ROOM] = {0}, slope[ROOM], value = 0, most = -(double)INFINITY;
	int n = is_even(s) ? s->corner_count - 1 : s->corner_count;

	for (int i = 0; i < s->corner_count; i++)
		v[s->order[i]] = s->lower[s->order[i]];
	for (int j = 0; j < s->n; j++) {
		slope[j] = s->linear[j];
		for (int i = 0; i < s->corner_count; i++)
			slope[j] += s->pair[j][s->order[i]] * v[s->order[i]];
		value += (0.5 * (slope[j] + s->linear[j]) + s->square[j] * v[j]) * v[j];
	}
	for (unsigned i = 0;;) {
		double all = value + add_others(s, slope, v), to, step;
		int at = 0, j;

		if (all > most && best)
			memcpy(best, v, (size_t)s->n * sizeof *v);
		most = fmax(most, all);
		if (++i >= 1u << n)
			return most;
		while (!(i >> at & 1))
			at++;
		j = s->order[s->corner_count - 1 - at];
		to = v[j] == s->lower[j] ? s->upper[j] : s->lower[j];
		step = to - v[j];
		value += step * (slope[j] + s->square[j] * (to + v[j]));
		v[j] = to;
		for (int k = 0; k < s->n; k++)
			slope[k] += s->pair[j][k] * step;
	}
}

/* With 2^12 corners one after the other, a slope is off by at most 2^-40 of all magnitudes, and the value by 2^12 of that twice.
   */
static double closed(double value, double size)
{
	return value + 0x1p-26 * size;
}

double extreme_above(const struct field *f, const double *c, int sign, double floor)
{
	struct corners s;
	double size, of_drives = drives_above(f, c, sign, &size, NULL), of_rates = rates_size(f, c);
	double simple = closed(of_drives + of_rates, size + of_rates);

	if (simple <= floor || f->rate_count == 0)
		return simple;
	set_corners(&s, f, c, sign, of_rates);
	return fmin(simple, closed(of_drives + s.rest + walk(&s, NULL), size + of_rates));
}

double extreme_corner(const struct field *f, const double *c, int sign, double *x)
{
	struct corners s;
	double size, value = drives_above(f, c, sign, &size, x);

	for (int j = 0; j < f->rate_count; j++)
		x[f->drive_count + j] = f->rates[j].range.upper;
	set_corners(&s, f, c, sign, rates_size(f, c));
	return value + (s.n ? walk(&s, x + f->drive_count) : 0);
}
