#include "request/resolve.h"
#include "base/nearest.h"
#include <stdio.h>
#include <string.h>

/* Arrays that one kernel can take. */
enum { ARRAY_LIMIT = 64 };

static int is_motion(const struct request *k)
{
	for (int i = 0; i < k->want_count; i++)
		if (!want_is(k->wants[i].kind, IS_MOTION | IS_PRODUCT))
			return 0;
	return k->want_count && !k->is_forward;
}

/* ---- names ---- */

/* A kernel calls what it keeps of an array by the array's name with these behind it. */
static int is_kernels_own(const char *name)
{
	const char *last = strrchr(name, '_');

	return last && (!strcmp(last, "_here") || !strcmp(last, "_slice"));
}

const char *request_nearest_input(const struct resolver *x, const char *word)
{
	const struct request *k = x->k;
	size_t count = (size_t)(k->freed_count + k->push_count);
	const char **words = arena_alloc(x->a, count, sizeof *words);

	for (int i = 0; i < k->freed_count && words; i++)
		words[i] = k->freed[i].word;
	for (int i = 0; i < k->push_count && words; i++)
		words[k->freed_count + i] = k->pushes[i].word;
	return words ? nearest_name(word, words, count, sizeof *words) : NULL;
}

/* "payload.left hand" -> payload_left_hand; two that come out the same, or a kernel's own, differ by a number. */
const char *request_argument(const struct resolver *x, const char *word)
{
	const struct request *k = x->k;
	char *name = arena_string(x->a, word, strlen(word));
	struct text t;

	if (!name)
		return "";
	for (char *s = name; *s; s++)
		if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", *s))
			*s = '_';
	for (int again = 1;; again++) {
		int taken = again == 1 && is_kernels_own(name);

		text_init(&t, x->a);
		text_put(&t, name);
		if (again > 1)
			text_printf(&t, "_%d", again);
		for (int i = 0; i < k->freed_count; i++)
			taken |= !strcmp(k->freed[i].argument, text_string(&t));
		for (int i = 0; i < k->push_count; i++)
			taken |= !strcmp(k->pushes[i].argument, text_string(&t));
		for (int i = 0; i < k->want_count; i++)
			taken |= !strcmp(k->wants[i].argument, text_string(&t));
		for (int i = 0; i < k->by_count; i++)
			taken |= !strcmp(k->by[i].direction, text_string(&t));
		if (!taken || x->a->failed)
			return text_string(&t);
	}
}

/* The link of this name; it must be carried by a body. */
int request_find_link(const struct resolver *x, const struct scene_choice *c, const char *name)
{
	int link = scene_link(x->s, c, x->r, name, x->e);

	if (link < 0)
		return -1;
	if (x->t->links[link].body == -2)
		scene_refuse(x->s, c, x->e, "link '%.255s' is not part of this scene", name);
	else if (x->t->links[link].body == -1)
		scene_refuse(x->s, c, x->e, "link '%.255s' does not move in this scene", name);
	return x->e->code ? -1 : link;
}

/* The body that the joint of this name moves; "base" is the floating base. */
int request_find_body(const struct resolver *x, const struct scene_choice *c, const char *name)
{
	if (x->t->floating && !strcmp(name, "base")) {
		if (robot_joint(x->r, name) < 0)
			return 0;
		scene_refuse(x->s, c, x->e, "'base' is the floating base, and a joint of the robot: rename the joint");
		return -1;
	}
	if (scene_joint(x->s, c, x->r, name, x->e) < 0)
		return -1;
	for (int i = 0; i < x->t->body_count; i++)
		if (!strcmp(x->t->bodies[i].joint, name))
			return i;
	scene_refuse(x->s, c, x->e, "joint '%.255s' does not move in this scene", name);
	return -1;
}

/* ---- fold ---- */

int request_is_said(const struct resolver *x, const struct scene_choice *c)
{
	for (const struct scene_choice *k = NULL; (k = scene_next(x->s, c->key, k)) && k != c;)
		if (!strcmp(k->name, c->name))
			return 1;
	return 0;
}

/* Rows first to first + count - 1: one value for all, or one for each. */
static enum rneagen_code give(const struct resolver *x, const struct scene_choice *c, struct row *rows, int first, int count,
	int one_for_all)
{
	struct within *values = arena_alloc(x->a, (size_t)count, sizeof *values);
	int single = one_for_all && !strchr(c->value, ',');

	if (!values)
		return error_memory(x->e);
	if (scene_numbers(x->s, c, values, single ? 1 : count, x->e))
		return x->e->code;
	for (int i = 0; i < count; i++) {
		if (rows[first + i].is_given)
			return scene_refuse(x->s, c, x->e, "'%.255s' has a row that is given already", c->name);
		rows[first + i] = (struct row){1, values[single ? 0 : i]};
	}
	return RNEAGEN_OK;
}

/* q = 0 is no orientation. */
static int has_quaternion(const struct tree *t, int body)
{
	for (int i = 0; i < t->body_count; i++)
		if (t->bodies[i].type == JOINT_FLOATING && (body < 0 || body == i))
			return 1;
	return 0;
}

static enum rneagen_code fold(const struct resolver *x, const struct scene_choice *c)
{
	enum { GRAVITY = 4, BY_JOINT };
	static const struct kind_word kinds[] = {{"q", 0}, {"qd", 0}, {"qdd", 0}, {"tau", 0}, [GRAVITY] = {"gravity", 0},
		[BY_JOINT] = {"q", 1}, {"qd", 1}, {"qdd", 1}, {"tau", 1}};
	struct tree *t = x->t;
	struct row *const rows[] = {x->k->q, x->k->qd, x->k->qdd, x->k->tau};
	int kind = request_find_kind(x, c, kinds, sizeof kinds / sizeof *kinds), body, is_q;
	struct within gravity[3];

	if (kind < 0)
		return x->e->code;
	if (request_is_said(x, c))
		return scene_refuse(x->s, c, x->e, "'%.255s' is given already", c->name);
	if (kind == GRAVITY) {
		if (scene_numbers(x->s, c, gravity, 3, x->e))
			return x->e->code;
		for (int i = 0; i < 3; i++)
			t->gravity[i] = gravity[i];
		return RNEAGEN_OK;
	}
	if (kind < GRAVITY)
		return give(x, c, rows[kind], 0, kind == 0 ? t->nq : t->nv, kind != 0 || !has_quaternion(t, -1));
	is_q = kind == BY_JOINT;
	body = request_find_body(x, c, strchr(c->name, '.') + 1);
	if (body < 0)
		return x->e->code;
	if (t->bodies[body].follower)
		return scene_refuse(x->s, c, x->e, "'%.255s' follows another joint: fold that", t->bodies[body].joint);
	return give(x, c, rows[kind - BY_JOINT], is_q ? t->bodies[body].iq : t->bodies[body].iv,
		is_q ? joint_nq(t->bodies[body].type) : joint_nv(t->bodies[body].type), !is_q || !has_quaternion(t, body));
}

/* ---- forces from outside ---- */

static enum rneagen_code push(const struct resolver *x, const struct scene_choice *c)
{
	int link = request_find_link(x, c, c->name);
	const char *word = text_format(x->a, "fext.%s", c->name);

	if (link < 0)
		return x->e->code;
	if (request_is_said(x, c))
		return scene_refuse(x->s, c, x->e, "the wrench on '%.255s' is an input already", c->name);
	x->k->pushes[x->k->push_count] = (struct push){
		word, request_argument(x, word), x->t->links[link].body, x->t->links[link].X};
	x->k->push_count++;
	return RNEAGEN_OK;
}

/* ---- all of it ---- */

/* At most: q, qd and qdd, and what the scene adds; a product takes its vector. */
static int array_count(const struct request *k)
{
	int directions = request_wants(k, WANT_JVP) ? 1 + k->by_count : 0;

	return 3 + k->freed_count + k->push_count + directions + request_wants(k, WANT_VJP) +
	       (k->stored_count ? k->stored_count : k->want_count);
}

static enum rneagen_code check_arrays(const struct resolver *x)
{
	if (array_count(x->k) <= ARRAY_LIMIT)
		return RNEAGEN_OK;
	return error_set(x->e, RNEAGEN_LIMIT, "%s: the scene makes more than %d arrays, which is all that a kernel takes",
		x->s->file, ARRAY_LIMIT);
}

static enum rneagen_code each(const struct resolver *x, enum scene_key key,
	enum rneagen_code (*resolve)(const struct resolver *x, const struct scene_choice *c))
{
	for (const struct scene_choice *c = NULL; (c = scene_next(x->s, key, c));)
		if (resolve(x, c) || check_arrays(x))
			return x->e->code;
	return RNEAGEN_OK;
}

static int alloc(struct resolver *x)
{
	struct request *k = x->k;
	struct arena *a = x->a;
	size_t most = (size_t)x->s->count + 1, nq = (size_t)x->t->nq, nv = (size_t)x->t->nv, nb = (size_t)x->t->body_count;

	k->q = arena_alloc(a, nq, sizeof *k->q);
	k->qd = arena_alloc(a, nv, sizeof *k->qd);
	k->qdd = arena_alloc(a, nv, sizeof *k->qdd);
	k->tau = arena_alloc(a, nv, sizeof *k->tau);
	k->freed = arena_alloc(a, most, sizeof *k->freed);
	k->pushes = arena_alloc(a, most, sizeof *k->pushes);
	k->contacts = arena_alloc(a, most, sizeof *k->contacts);
	k->wants = arena_alloc(a, most + 2, sizeof *k->wants); /* jvp and vjp */
	k->by = arena_alloc(a, most, sizeof *k->by);
	k->jvp.of = arena_alloc(a, most, sizeof *k->jvp.of);
	k->vjp.of = arena_alloc(a, most, sizeof *k->vjp.of);
	k->frames = arena_alloc(a, most, sizeof *k->frames);
	k->ranges = arena_alloc(a, most, sizeof *k->ranges);
	for (int i = 0; i < OWN_TERMS; i++)
		k->own[i] = arena_alloc(a, nb, sizeof *k->own[i]);
	return !a->failed;
}

static int has_choice(const struct scene *s)
{
	static const enum scene_key keys[] = {SCENE_FOLD, SCENE_FREE, SCENE_WANT, SCENE_JVP, SCENE_VJP, SCENE_BY,
		SCENE_FEXT, SCENE_CONTACT, SCENE_WELD, SCENE_ARMATURE, SCENE_DAMPING, SCENE_FRICTION};

	for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
		if (scene_next(s, keys[i], NULL))
			return 1;
	return 0;
}

/* What is found is not given, and what is given not wanted. */
static enum rneagen_code check_forward(const struct resolver *x)
{
	static const enum scene_key keys[] = {SCENE_WANT, SCENE_JVP, SCENE_VJP};

	for (const struct scene_choice *c = NULL; (c = scene_next(x->s, SCENE_FOLD, c));) {
		const char *stem = arena_string(x->a, c->name, strcspn(c->name, "."));

		if (stem && !strcmp(stem, x->k->is_forward ? "qdd" : "tau"))
			return scene_refuse(x->s, c, x->e,
				x->k->is_forward ? "qdd is found from q, qd and tau: leave it out"
						 : "tau is an output here; where qdd is wanted, it is an input");
	}
	for (size_t i = 0; i < sizeof keys / sizeof *keys && x->k->is_forward; i++)
		for (const struct scene_choice *c = NULL; (c = scene_next(x->s, keys[i], c));) {
			if (!strcmp(c->name, "tau"))
				return scene_refuse(x->s, c, x->e, "tau is an input where qdd is wanted: leave it out");
			if (keys[i] == SCENE_WANT && (!strcmp(c->name, "jvp") || !strcmp(c->name, "vjp")))
				return scene_refuse(x->s, c, x->e, "'%s' is of tau, an input where qdd is wanted: take --%s qdd",
					c->name, c->name);
		}
	return RNEAGEN_OK;
}

/* Bodies that move with one coordinate have no articulated inertia of their own. */
static enum rneagen_code check_dynamics(const struct resolver *x)
{
	const struct scene_choice *c = scene_next(x->s, SCENE_DYNAMICS, NULL);

	if (x->k->dynamics == DYNAMICS_ARTICULATED && x->t->mimic_count)
		return scene_refuse(x->s, c, x->e,
			"articulated bodies do not serve joint '%.255s', which follows another: take factor",
			x->t->bodies[x->t->mimics[0].body].joint);
	return RNEAGEN_OK;
}

enum rneagen_code request_resolve(struct request *k, struct tree *t, const struct scene *s, const struct robot *r,
	struct arena *a, struct rneagen_error *e)
{
	struct resolver x = {t, k, s, r, a, e};
	const struct scene_choice *frame = scene_next(x.s, SCENE_FEXT_FRAME, NULL);
	const struct scene_choice *how = scene_next(x.s, SCENE_DERIVATIVES, NULL), *way = scene_next(x.s, SCENE_DYNAMICS, NULL);

	*x.k = (struct request){.is_plain = !has_choice(x.s)};
	if (!alloc(&x))
		return error_memory(e);
	x.k->dense = scene_next(x.s, SCENE_DENSE, NULL) != NULL;
	if (how)
		x.k->derivatives = !strcmp(how->value, "forward") ? DERIVATIVES_FORWARD : DERIVATIVES_RECURSION;
	if (way && strcmp(way->value, "auto"))
		x.k->dynamics = !strcmp(way->value, "factor") ? DYNAMICS_FACTOR : DYNAMICS_ARTICULATED;
	x.k->in_world = frame && !strcmp(frame->value, "world");
	request_forms(&x);
	if (each(&x, SCENE_ADD_FRAME, request_add_frame) || each(&x, SCENE_FOLD, fold) || request_own_terms(&x) ||
		each(&x, SCENE_CONTACT, request_contact) || each(&x, SCENE_WELD, request_contact) ||
		each(&x, SCENE_FREE, request_free) || each(&x, SCENE_FEXT, push) || each(&x, SCENE_WANT, request_want) ||
		request_products(&x) || check_arrays(&x) || each(&x, SCENE_RANGE, request_range))
		return e->code;
	if (!x.k->want_count)
		x.k->wants[x.k->want_count++] = (struct want){.kind = WANT_TAU, .word = "tau", .argument = "tau", .rows = t->nv};
	if (!x.k->stored_count)
		x.k->stored_count = x.k->want_count;
	x.k->is_motion = is_motion(x.k);
	if (check_arrays(&x) || check_forward(&x) || check_dynamics(&x) || request_check_contacts(&x))
		return e->code;
	return a->failed ? error_memory(e) : RNEAGEN_OK;
}
