/* Products of the derivatives of outputs with vectors: of which outputs they are, and by which inputs besides the state. */
#include "request/resolve.h"
#include <string.h>

int request_is_plain_product(const struct request *k, const struct product *p)
{
	enum want_kind kind = p->count == 1 ? k->wants[p->of[0]].kind : WANT_JVP;

	return (kind == WANT_TAU || kind == WANT_QDD) && !k->by_count;
}

/* ---- by which inputs ---- */

/* "jvp_v.payload.hand" */
static const char *joined(const struct resolver *x, const char *before, const char *word)
{
	return text_format(x->a, "%s.%s", before, word);
}

static enum rneagen_code refuse_by(const struct resolver *x, const struct scene_choice *c)
{
	const char *meant = request_nearest_input(x, c->name);

	if (x->a->failed)
		return error_memory(x->e);
	if (!strcmp(c->name, "q") || !strcmp(c->name, "qd") || !strcmp(c->name, "qdd") || !strcmp(c->name, "tau"))
		return scene_refuse(x->s, c, x->e, "products are by q, qd, and qdd or tau anyway: leave out '%s'", c->name);
	return scene_refuse(x->s, c, x->e, "'%.255s' is no constant of --free and no wrench of --fext%s%s%s", c->name,
		meant ? "; did you mean '" : "", meant ? meant : "", meant ? "'?" : "");
}

static enum rneagen_code add_by(const struct resolver *x, const struct scene_choice *c)
{
	struct request *k = x->k;
	struct product_by by = {.word = NULL};

	for (int i = 0; i < k->freed_count; i++)
		if (!strcmp(k->freed[i].word, c->name))
			by = (struct product_by){k->freed[i].word, k->freed[i].argument, NULL, k->freed[i].rows,
				k->freed[i].per_batch};
	for (int i = 0; i < k->push_count; i++)
		if (!strcmp(k->pushes[i].word, c->name))
			by = (struct product_by){k->pushes[i].word, k->pushes[i].argument, NULL, 6, 0};
	if (!by.word)
		return refuse_by(x, c);
	for (int i = 0; i < k->by_count; i++)
		if (!strcmp(k->by[i].word, by.word))
			return scene_refuse(x->s, c, x->e, "'%.255s' is named twice", c->name);
	if (!request_wants(k, WANT_JVP) && !request_wants(k, WANT_VJP))
		return scene_refuse(x->s, c, x->e, "there is no product that could be by '%.255s': take --jvp or --vjp", c->name);
	by.direction = request_argument(x, joined(x, "jvp_v", by.word));
	k->by[k->by_count++] = by;
	return RNEAGEN_OK;
}

/* The outputs with the derivatives by these. */
static enum rneagen_code want_by(const struct resolver *x, int i)
{
	const char *word = joined(x, "vjp", x->k->by[i].word);
	struct want w = {.kind = WANT_VJP_BY, .word = word, .argument = request_argument(x, word),
		.rows = x->k->by[i].rows, .body = i};

	x->k->wants[x->k->want_count++] = w;
	return RNEAGEN_OK;
}

/* ---- of which outputs ---- */

/* The want with this product, which --want makes too: of tau then. */
static enum rneagen_code want_product(const struct resolver *x, enum scene_key key)
{
	enum want_kind kind = key == SCENE_JVP ? WANT_JVP : WANT_VJP;
	const struct scene_choice *c = scene_next(x->s, key, NULL);
	struct want w = {.kind = kind, .word = scene_word(key), .argument = scene_word(key)};

	if (!c)
		return RNEAGEN_OK;
	if (request_wants(x->k, kind))
		return scene_refuse(x->s, c, x->e, "--want %s is --%s tau: name tau here, and leave that out", w.word, w.word);
	return request_add_want(x, c, &w);
}

/* Which want it is; one more, made for this alone, where it is none of them. */
static int made(const struct resolver *x, const struct want *w)
{
	struct request *k = x->k;

	for (int i = 0; i < k->want_count; i++)
		if (request_is_same(&k->wants[i], w))
			return i;
	k->wants[k->want_count] = *w;
	k->is_forward |= want_is(w->kind, FINDS_QDD);
	return k->want_count++;
}

/* Of products one has another: a second derivative, the jvp of the vjp. */
static enum rneagen_code check_second(const struct resolver *x, const struct scene_choice *c, struct want *w)
{
	if (w->kind != WANT_VJP || c->key != SCENE_JVP)
		return scene_refuse(x->s, c, x->e, "'%.255s' is a product itself: second derivatives are those of --jvp vjp", c->name);
	if (!request_wants(x->k, WANT_VJP))
		return scene_refuse(x->s, c, x->e, "there is no vjp here: --vjp NAME,... says of which outputs");
	w->rows = 3 * x->t->nv;
	return RNEAGEN_OK;
}

static enum rneagen_code add_of(const struct resolver *x, const struct scene_choice *c, struct product *p)
{
	struct want w;
	int which;

	if (request_quantity(x, c, &w))
		return x->e->code;
	if (want_is(w.kind, IS_PRODUCT) && check_second(x, c, &w))
		return x->e->code;
	if (w.kind == WANT_QDD_BOUND)
		return scene_refuse(x->s, c, x->e, "'%.255s' is a bound, which has no derivative: take qdd", c->name);
	which = made(x, &w);
	for (int i = 0; i < p->count; i++)
		if (p->of[i] == which)
			return scene_refuse(x->s, c, x->e, "'%.255s' is named twice", c->name);
	p->of[p->count++] = which;
	p->rows += w.rows;
	return RNEAGEN_OK;
}

static enum rneagen_code add_all(const struct resolver *x, enum scene_key key, struct product *p)
{
	const struct scene_choice torques = {.key = key, .name = "tau"};

	for (const struct scene_choice *c = NULL; (c = scene_next(x->s, key, c));)
		if (add_of(x, c, p))
			return x->e->code;
	if (!p->count && request_wants(x->k, key == SCENE_JVP ? WANT_JVP : WANT_VJP))
		return add_of(x, &torques, p);
	return RNEAGEN_OK;
}

static const char *words_of(const struct resolver *x, const struct product *p)
{
	struct text t;

	text_init(&t, x->a);
	for (int i = 0; i < p->count && !request_is_plain_product(x->k, p); i++)
		text_printf(&t, "%s%s", i ? "," : "", x->k->wants[p->of[i]].word);
	return text_string(&t);
}

enum rneagen_code request_products(const struct resolver *x)
{
	struct request *k = x->k;

	if (want_product(x, SCENE_JVP) || want_product(x, SCENE_VJP))
		return x->e->code;
	for (const struct scene_choice *c = NULL; (c = scene_next(x->s, SCENE_BY, c));)
		if (add_by(x, c))
			return x->e->code;
	for (int i = 0; i < k->by_count && request_wants(k, WANT_VJP); i++)
		if (want_by(x, i))
			return x->e->code;
	k->stored_count = k->want_count;
	if (add_all(x, SCENE_JVP, &k->jvp) || add_all(x, SCENE_VJP, &k->vjp))
		return x->e->code;
	k->jvp.words = words_of(x, &k->jvp);
	k->vjp.words = words_of(x, &k->vjp);
	for (int i = 0; i < k->stored_count; i++) {
		struct want *w = &k->wants[i];

		w->rows = w->kind == WANT_JVP ? k->jvp.rows : w->kind == WANT_VJP ? 3 * x->t->nv : w->rows;
	}
	return RNEAGEN_OK;
}

enum rneagen_code request_refuse_constant(const struct request *k, const struct scene *s, int want, struct rneagen_error *e)
{
	static const enum scene_key keys[] = {SCENE_JVP, SCENE_VJP};
	const char *word = k->wants[want].word;

	for (int i = 0; i < 2; i++)
		for (const struct scene_choice *c = NULL; (c = scene_next(s, keys[i], c));)
			if (!strcmp(c->name, word))
				return scene_refuse(s, c, e,
					"'%.255s' does not vary with what --fold leaves: leave it out", word);
	return error_set(e, RNEAGEN_SCENE, "%s: '%.255s' does not vary", s->file, word);
}
