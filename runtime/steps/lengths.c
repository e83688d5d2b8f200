#include "steps/lengths.h"
#include <string.h>

enum { SETS_OF_A_FORM = 12 };

/* Its members may be more than a set has room for. */
struct wish {
	uint32_t members[2 * SET_MEMBERS];
	int count;
};

static void put(struct wish *w, uint32_t form)
{
	int at = w->count;

	if (form == FORM_ZERO || w->count == 2 * SET_MEMBERS)
		return;
	for (w->count++; at > 0 && w->members[at - 1] > form; at--)
		w->members[at] = w->members[at - 1];
	w->members[at] = form;
}

static void drop(struct wish *w, int at)
{
	memmove(&w->members[at], &w->members[at + 1], (size_t)(--w->count - at) * sizeof *w->members);
}

static const struct form *form_at(const struct lengths *x, uint32_t i)
{
	return &x->forms->list[i];
}

/* c x + s y beside c x' + s y': is it c y - s x, or the opposite? */
static int are_mates(const struct form *u, const struct form *v)
{
	return u->kind == FORM_TURN && v->kind == FORM_TURN && u->sine == v->sine && u->cosine == v->cosine &&
		v->a.form == u->b.form &&
	       v->b.form == u->a.form && (v->a.is_minus != u->b.is_minus) != (v->b.is_minus != u->a.is_minus);
}

static uint32_t set_of(struct lengths *x, struct wish w);

static uint32_t turned_back(struct lengths *x, struct wish w, int at)
{
	const struct form *u = form_at(x, w.members[at]);

	for (int k = 0; k < w.count; k++)
		if (k != at && are_mates(u, form_at(x, w.members[k]))) {
			drop(&w, k);
			at -= k < at;
			break;
		}
	drop(&w, at);
	put(&w, u->a.form);
	put(&w, u->b.form);
	return set_of(x, w);
}

/* The earlier term of each sum, and the later ones. */
static void split_sums(struct lengths *x, const struct wish *w, struct length_set *s)
{
	struct wish one = {.count = 0}, other = {.count = 0};

	for (int k = 0; k < w->count; k++) {
		const struct form *f = form_at(x, w->members[k]);
		int is_later = f->a.form > f->b.form;

		put(&one, f->kind != FORM_SUM ? w->members[k] : is_later ? f->b.form : f->a.form);
		if (f->kind == FORM_SUM)
			put(&other, is_later ? f->a.form : f->b.form);
	}
	s->one = set_of(x, one);
	s->other = set_of(x, other);
	if (!s->one || !s->other)
		s->one = s->other = 0;
}

static void find_rules(struct lengths *x, const struct wish *w, struct length_set *s)
{
	struct wish rest = *w;

	for (int k = w->count - 1; k >= 0; k--) {
		enum form_kind kind = form_at(x, w->members[k])->kind;

		if (kind == FORM_TURN)
			s->one = turned_back(x, *w, k);
		else if (kind == FORM_SUM)
			split_sums(x, w, s);
		else
			continue;
		break;
	}
	for (int k = w->count - 1; k >= 0 && w->count > 1; k--)
		if (form_at(x, w->members[k])->kind == FORM_SUM) {
			drop(&rest, k);
			s->apart = w->members[k];
			s->beside = set_of(x, rest);
			return;
		}
}

static uint32_t *place_of(const struct lengths *x, const struct wish *w)
{
	uint64_t hash = (uint64_t)w->count;

	for (int k = 0; k < w->count; k++)
		hash = (hash ^ w->members[k]) * 0x9e3779b97f4a7c15u;
	for (uint32_t at = (uint32_t)((hash >> 32) % x->table_size);; at = (at + 1) % x->table_size) {
		const struct length_set *s = x->table[at] ? &x->sets[x->table[at] - 1] : NULL;

		if (!s || (s->count == w->count && !memcmp(s->members, w->members, (size_t)w->count * sizeof *w->members)))
			return &x->table[at];
	}
}

/* 1 + the set; 0: it is too large, or there are too many. */
static uint32_t set_of(struct lengths *x, struct wish w)
{
	struct length_set s = {.count = w.count};
	uint32_t *at;

	if (w.count > SET_MEMBERS || x->count >= x->limit)
		return 0;
	at = place_of(x, &w);
	if (*at)
		return *at;
	memcpy(s.members, w.members, (size_t)w.count * sizeof *w.members);
	s.last = w.count ? w.members[w.count - 1] : FORM_ZERO;
	find_rules(x, &w, &s);
	if (x->count >= x->limit)
		return 0;
	x->sets[x->count++] = s;
	return *place_of(x, &w) = x->count;
}

int lengths_make(struct lengths *x, const struct forms *f, struct arena *a)
{
	uint32_t limit = SETS_OF_A_FORM * (uint32_t)f->count;

	*x = (struct lengths){.forms = f, .limit = limit, .table_size = 2 * limit + 7};
	x->sets = arena_take(a, limit, sizeof *x->sets);
	x->table = arena_alloc(a, x->table_size, sizeof *x->table);
	if (a->failed)
		return 0;
	for (uint32_t i = 0; i < f->count; i++)
		if (f->list[i].kind == FORM_TURN)
			set_of(x, (struct wish){{i}, 1});
	return 1;
}

uint32_t lengths_pair(struct lengths *x, uint32_t a, uint32_t b)
{
	struct wish w = {.count = 0};

	put(&w, a);
	put(&w, b);
	return set_of(x, w);
}

int lengths_close(struct lengths *x, struct arena *a)
{
	size_t count = x->forms->count;

	x->order = arena_alloc(a, (size_t)x->count + 1, sizeof *x->order);
	x->first = arena_alloc(a, count + 2, sizeof *x->first);
	x->value = arena_alloc(a, count, sizeof *x->value);
	x->norm = arena_alloc(a, (size_t)x->count + 1, sizeof *x->norm);
	if (a->failed)
		return 0;
	for (uint32_t i = 0; i < x->count; i++)
		x->first[x->sets[i].last + 2]++;
	for (size_t i = 2; i < count + 2; i++)
		x->first[i] += x->first[i - 1];
	for (uint32_t i = 0; i < x->count; i++)
		x->order[x->first[x->sets[i].last + 1]++] = i;
	return 1;
}

/* ---- a box ---- */

static struct span of_operand(const struct lengths *x, struct operand p)
{
	return span_signed(x->value[p.form], p.is_minus);
}

static struct span square(struct span a)
{
	struct span s = span_mul(a, a);

	return (struct span){fmax(s.lo, 0), s.hi};
}

/* Of an input that has no range nothing is known. */
static struct span input_of(struct span r)
{
	return r.lo <= r.hi ? r : (struct span){-(double)INFINITY, (double)INFINITY};
}

static struct span evaluate(const struct lengths *x, const struct form *f, struct span *const *rows)
{
	switch (f->kind) {
	case FORM_CONST:
		return f->constant;
	case FORM_INPUT:
		return input_of(rows[f->argument][f->row]);
	case FORM_SINE:
		return span_sin(of_operand(x, f->a));
	case FORM_COSINE:
		return span_cos(of_operand(x, f->a));
	case FORM_PRODUCT:
		if (f->a.form == f->b.form)
			return span_signed(square(x->value[f->a.form]), f->a.is_minus != f->b.is_minus);
		return span_mul(of_operand(x, f->a), of_operand(x, f->b));
	case FORM_SUM:
		return span_add(of_operand(x, f->a), of_operand(x, f->b));
	default:
		return span_add(span_mul(x->value[f->cosine], of_operand(x, f->a)),
			span_mul(x->value[f->sine], of_operand(x, f->b)));
	}
}

/* Of a few squares: more than all their roundings and the root's, of small ones too. */
static double root_of(double sum)
{
	return sqrt(sum + 8 * DBL_TRUE_MIN) * (1 + 0x1p-48);
}

static double norm_of(const struct lengths *x, const struct length_set *s)
{
	double sum = 0, norm;

	for (int k = 0; k < s->count; k++) {
		double size = span_size(x->value[s->members[k]]);

		sum += size * size;
	}
	norm = root_of(sum);
	if (s->beside) {
		double beside = x->norm[s->beside - 1], apart = span_size(x->value[s->apart]);

		norm = fmin(norm, root_of(beside * beside + apart * apart));
	}
	if (s->one)
		norm = fmin(norm, out_up(x->norm[s->one - 1] + (s->other ? x->norm[s->other - 1] : 0)));
	return norm;
}

void lengths_evaluate(struct lengths *x, struct span *const *rows)
{
	for (uint32_t i = 0; i < x->forms->count; i++) {
		x->value[i] = evaluate(x, form_at(x, i), rows);
		for (uint32_t k = x->first[i]; k < x->first[i + 1]; k++) {
			const struct length_set *s = &x->sets[x->order[k]];
			double norm = x->norm[x->order[k]] = norm_of(x, s);

			if (s->count == 1)
				x->value[i] = (struct span){fmax(x->value[i].lo, -norm), fmin(x->value[i].hi, norm)};
		}
	}
}
