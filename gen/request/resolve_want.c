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
	[WANT_DTAU_DQ] = {{"dtau_dq", 0}, "dtau_dq", 0},
	[WANT_DTAU_DQD] = {{"dtau_dqd", 0}, "dtau_dqd", 0},
	[WANT_MASS] = {{"M", 0}, "M", 0},
	[WANT_DTAU_DFREED] = {{"dtau_dNAME", 0}, NULL, 0}, /* see want_by_freed */
	[WANT_JVP] = {{"jvp", 0}, "jvp", 0},
	[WANT_VJP] = {{"vjp", 0}, "vjp", 0},
};
enum { WANT_COUNT = sizeof WANTS / sizeof *WANTS };

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
	const char *freed = c->name + strlen("dtau_d");

	for (int i = 0; i < x->k->freed_count; i++)
		if (!strcmp(x->k->freed[i].word, freed)) {
			w->kind = WANT_DTAU_DFREED;
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

/* Rows of matrices and products; what is given does not vary. */
static enum rneagen_code want_derivative(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	int is_q = w->kind == WANT_DTAU_DQ, count = is_q ? x->t->nq : x->t->nv, nv = x->t->nv;
	const struct row *rows = is_q ? x->k->q : x->k->qd;
	struct pattern p;

	if (w->kind == WANT_JVP || w->kind == WANT_VJP) {
		w->rows = w->kind == WANT_VJP ? 3 * nv : nv;
		return RNEAGEN_OK;
	}
	for (int i = 0; i < count && w->kind != WANT_MASS; i++)
		if (rows[i].is_given)
			return scene_refuse(x->s, c, x->e, "row %d of %s is given: no derivative by it", i, is_q ? "q" : "qd");
	if (!pattern_make(&p, x->t, w->kind == WANT_MASS, x->k->dense, x->a))
		return error_memory(x->e);
	w->rows = p.rows;
	return RNEAGEN_OK;
}

static enum rneagen_code add_want(const struct resolver *x, const struct scene_choice *c, const struct want *w)
{
	for (int i = 0; i < x->k->want_count; i++)
		if (!strcmp(x->k->wants[i].word, w->word))
			return scene_refuse(x->s, c, x->e, "'%.255s' is wanted already", w->word);
	x->k->wants[x->k->want_count++] = *w;
	return RNEAGEN_OK;
}

enum rneagen_code request_want(const struct resolver *x, const struct scene_choice *c)
{
	struct kind_word kinds[WANT_COUNT];
	struct want w = {.word = c->name};
	int kind;

	if (!strncmp(c->name, "dtau_d", 6) && strcmp(c->name, "dtau_dq") && strcmp(c->name, "dtau_dqd"))
		return want_by_freed(x, c, &w) ? x->e->code : add_want(x, c, &w);
	for (int i = 0; i < WANT_COUNT; i++)
		kinds[i] = WANTS[i].kind;
	kind = request_find_kind(x, c, kinds, WANT_COUNT);
	if (kind < 0)
		return x->e->code;
	w.kind = (enum want_kind)kind;
	w.rows = WANTS[kind].rows ? WANTS[kind].rows : x->t->nv;
	if (w.kind == WANT_WRENCH && (w.body = request_find_body(x, c, strchr(c->name, '.') + 1)) < 0)
		return x->e->code;
	if ((w.kind == WANT_TWIST || w.kind == WANT_ACCEL) && want_link(x, c, &w))
		return x->e->code;
	if (w.kind >= WANT_DTAU_DQ && want_derivative(x, c, &w))
		return x->e->code;
	w.argument = WANTS[kind].argument ? WANTS[kind].argument : request_argument(x, c->name);
	return add_want(x, c, &w);
}
