#include "support/pairs.h"
#include "support/rng.h"
#include <check.h>
#include <string.h>

enum { LEVELS = 40, TRIES = 60 };

/* Pairs that no row has had yet: [a][level of a][b][level of b], a < b. */
struct open_pairs {
	char is[PAIRS_FACTORS][LEVELS][PAIRS_FACTORS][LEVELS];
	int count;
};

static void open_all(struct open_pairs *o, const struct pairs *p)
{
	memset(o, 0, sizeof *o);
	for (int a = 0; a < p->factors; a++)
		for (int b = a + 1; b < p->factors; b++)
			for (int i = 0; i < p->levels[a]; i++)
				for (int k = 0; k < p->levels[b]; k++, o->count++)
					o->is[a][i][b][k] = 1;
}

/* How many open pairs a row has; they are closed if it is taken. */
static int gain(struct open_pairs *o, const struct pairs *p, const int *row, int take)
{
	int n = 0;

	for (int a = 0; a < p->factors; a++)
		for (int b = a + 1; b < p->factors; b++) {
			char *is = &o->is[a][row[a]][b][row[b]];

			n += *is;
			if (take)
				*is = 0;
		}
	return n;
}

/* The first open pair is in every row that is tried, so that each row closes one. */
static void begin_row(const struct open_pairs *o, const struct pairs *p, struct rng *r, int *row)
{
	for (int a = 0; a < p->factors; a++)
		row[a] = rng_below(r, p->levels[a]);
	for (int a = 0; a < p->factors; a++)
		for (int b = a + 1; b < p->factors; b++)
			for (int i = 0; i < p->levels[a]; i++)
				for (int k = 0; k < p->levels[b]; k++)
					if (o->is[a][i][b][k]) {
						row[a] = i;
						row[b] = k;
						return;
					}
}

void pairs_draw(struct pairs *p, uint64_t seed)
{
	static struct open_pairs open;
	struct rng r = rng_seed(seed);

	for (int a = 0; a < p->factors; a++)
		ck_assert_int_le(p->levels[a], LEVELS);
	open_all(&open, p);
	for (p->count = 0; open.count > 0; p->count++) {
		int best = 0;

		ck_assert_int_lt(p->count, PAIRS_ROWS);
		for (int i = 0; i < TRIES; i++) {
			int row[PAIRS_FACTORS], n;

			begin_row(&open, p, &r, row);
			n = gain(&open, p, row, 0);
			if (n > best) {
				best = n;
				memcpy(p->rows[p->count], row, sizeof row);
			}
		}
		open.count -= gain(&open, p, p->rows[p->count], 1);
	}
}
