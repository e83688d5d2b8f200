/* The quantities that a scene asks for. */
#include "tree/pattern.h"
#include "request/resolve.h"
#include <string.h>

static const struct want_word {
	struct kind_word kind;
	const char *argument; /* NULL: made from the word */
	int rows;             /* 0: nv */
} WANTS[] = {
	[WANT_TAU] = {{"tau", 0}, "tau", 0},
	[WANT_GRAVITY] = {{"gravity", 0}, "tau_gravity", 0},
	[WANT_BIAS] = {{"bias", 0}, "tau_bias", 0},
	[WANT_WRENCH] = {{"wrench", 1}, NULL, 6},
	[WANT_TWIST] = {{"twist", 1}, NULL, 6},
	[WANT_ACCEL] = {{"accel", 1}, NULL, 6},
	[WANT_POWER] = {{"power", 0}, "power", 1},
	[WANT_KINETIC] = {{"kinetic", 0}, "kinetic", 1},
	[WANT_POTENTIAL] = {{"potential", 0}, "potential", 1},
	[WANT_REGRESSOR] = {{"regressor", 0}, "regressor", 0},
	[WANT_QDD] = {{"qdd", 0}, "qdd", 0},
	[WANT_QDD_BOUND] = {{"qdd_bound", 0}, "qdd_bound", 0},
	[WANT_DTAU_DQ] = {{"dtau_dq", 0}, "dtau_dq", 0},
	[WANT_DTAU_DQD] = {{"dtau_dqd", 0}, "dtau_dqd", 0},
	[WANT_MASS] = {{"M", 0}, "M", 0},
	[WANT_DTAU_DFREED] = {{"dtau_dNAME", 0}, NULL, 0}, /* see want_by_freed */
	[WANT_JVP] = {{"jvp", 0}, "jvp", 0},
	[WANT_VJP] = {{"vjp", 0}, "vjp", 0},
	[WANT_VJP_BY] = {{"vjp.NAME", 0}, NULL, 0}, /* see resolve_product.c */
	[WANT_MINV] = {{"Minv", 0}, "Minv", 0},
	[WANT_DQDD_DQ] = {{"dqdd_dq", 0}, "dqdd_dq", 0},
	[WANT_DQDD_DQD] = {{"dqdd_dqd", 0}, "dqdd_dqd", 0},
	[WANT_DQDD_DFREED] = {{"dqdd_dNAME", 0}, NULL, 0},
};
enum { WANT_COUNT = sizeof WANTS / sizeof *WANTS };

int request_is_solved(enum want_kind kind)
{
	return kind >= WANT_MINV;
}

int request_finds_qdd(enum want_kind kind)
{
	return kind == WANT_QDD || kind == WANT_QDD_BOUND || request_is_solved(kind);
}

static enum rneagen_code want_link(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	int link = request_find_link(x, c, strchr(c->name, '.') + 1);

	if (link < 0)
		return x->e->code;
	w->body = x->t->links[link].body;
	w->X = x->t->links[link].X;
	return RNEAGEN_OK;
}

/* "dtau_dpayload.hand": by what the scene frees. */
static enum rneagen_code want_by_freed(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	const char *freed = strstr(c->name, "_d") + strlen("_d");

	for (int i = 0; i < x->k->freed_count; i++)
		if (!strcmp(x->k->freed[i].word, freed)) {
			w->kind = c->name[1] == 'q' ? WANT_DQDD_DFREED : WANT_DTAU_DFREED;
			w->body = i;
			w->rows = x->t->nv * x->k->freed[i].rows;
			w->argument = request_argument(x, c->name);
			return RNEAGEN_OK;
		}
	if (!strcmp(freed, "qdd"))
		return scene_refuse(x->s, c, x->e, "the derivative by qdd is the mass matrix: want M");
	return scene_refuse(x->s, c, x->e, "'%.255s' is not free: no derivative by it; there is dtau_dq, dtau_dqd, and dtau_dNAME for what --free names",
		freed);
}

/* Elements that are stored. */
static enum rneagen_code want_matrix(const struct resolver *x, struct want *w)
{
	struct pattern p;

	if (!request_pattern(&p, x->t, w->kind, x->k->dense, x->a))
		return error_memory(x->e);
	w->rows = p.rows;
	return RNEAGEN_OK;
}

/* Rows of matrices; what is given does not vary. */
static enum rneagen_code want_derivative(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	int is_q = w->kind == WANT_DTAU_DQ || w->kind == WANT_DQDD_DQ, count = is_q ? x->t->nq : x->t->nv;
	const struct row *rows = is_q ? x->k->q : x->k->qd;

	if (request_is_product(w->kind))
		return RNEAGEN_OK;
	for (int i = 0; i < count && w->kind != WANT_MASS && w->kind != WANT_MINV; i++)
		if (rows[i].is_given)
			return scene_refuse(x->s, c, x->e, "row %d of %s is given: no derivative by it", i, is_q ? "q" : "qd");
	return want_matrix(x, w);
}

/* "dtau_dNAME", "dqdd_dNAME" */
static int is_by_freed(const char *word)
{
	static const char *const others[] = {"dtau_dq", "dtau_dqd", "dqdd_dq", "dqdd_dqd", "dqdd_dtau"};

	for (size_t i = 0; i < sizeof others / sizeof *others; i++)
		if (!strcmp(word, others[i]))
			return 0;
	return !strncmp(word, "dtau_d", 6) || !strncmp(word, "dqdd_d", 6);
}

int request_pattern(struct pattern *p, const struct tree *t, enum want_kind kind, int dense, struct arena *a)
{
	int symmetric = kind == WANT_MASS || kind == WANT_MINV;

	if (kind == WANT_REGRESSOR)
		return pattern_lumps(p, t, dense, a);
	return request_is_solved(kind) ? pattern_coupled(p, t, symmetric, dense, a) : pattern_make(p, t, symmetric, dense, a);
}

int request_is_matrix(enum want_kind kind)
{
	return kind == WANT_REGRESSOR || kind == WANT_DTAU_DQ || kind == WANT_DTAU_DQD || kind == WANT_MASS || (kind >= WANT_MINV && kind <= WANT_DQDD_DQD);
}

int request_is_same(const struct want *a, const struct want *b)
{
	int is_one = WANTS[a->kind].argument && !WANTS[a->kind].kind.has_name;

	return a->kind == b->kind && (is_one || !strcmp(a->word, b->word));
}

enum rneagen_code request_add_want(const struct resolver *x, const struct scene_choice *c, const struct want *w)
{
	for (int i = 0; i < x->k->want_count; i++)
		if (!strcmp(x->k->wants[i].word, w->word))
			return scene_refuse(x->s, c, x->e, "'%.255s' is wanted already", w->word);
	x->k->wants[x->k->want_count++] = *w;
	x->k->is_forward |= request_finds_qdd(w->kind);
	return RNEAGEN_OK;
}

enum rneagen_code request_quantity(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	struct kind_word kinds[WANT_COUNT];
	int kind;

	*w = (struct want){.word = c->name};
	if (is_by_freed(c->name))
		return want_by_freed(x, c, w);
	for (int i = 0; i < WANT_COUNT; i++)
		kinds[i] = WANTS[i].kind;
	kind = strcmp(c->name, "dqdd_dtau") ? request_find_kind(x, c, kinds, WANT_COUNT) : WANT_MINV;
	if (kind < 0)
		return x->e->code;
	w->kind = (enum want_kind)kind;
	w->rows = WANTS[kind].rows ? WANTS[kind].rows : x->t->nv;
	if (w->kind == WANT_WRENCH && (w->body = request_find_body(x, c, strchr(c->name, '.') + 1)) < 0)
		return x->e->code;
	if ((w->kind == WANT_TWIST || w->kind == WANT_ACCEL) && want_link(x, c, w))
		return x->e->code;
	if (w->kind >= WANT_DTAU_DQ && want_derivative(x, c, w))
		return x->e->code;
	if (w->kind == WANT_REGRESSOR && want_matrix(x, w))
		return x->e->code;
	w->argument = WANTS[kind].argument && kind != WANT_MINV ? WANTS[kind].argument : request_argument(x, c->name);
	return RNEAGEN_OK;
}

enum rneagen_code request_want(const struct resolver *x, const struct scene_choice *c)
{
	struct want w;

	return request_quantity(x, c, &w) ? x->e->code : request_add_want(x, c, &w);
}
