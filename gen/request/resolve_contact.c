/* Links that stand, and the forces that hold them. */
#include "request/resolve.h"
#include <string.h>

const struct contact *request_find_contact(const struct request *k, const char *name, int rows)
{
	for (int i = 0; i < k->contact_count; i++)
		if (!strcmp(k->contacts[i].name, name) && (!rows || k->contacts[i].rows == rows))
			return &k->contacts[i];
	return NULL;
}

enum rneagen_code request_contact(const struct resolver *x, const struct scene_choice *c)
{
	struct request *k = x->k;
	struct contact *to = &k->contacts[k->contact_count];

	if (request_find_contact(k, c->name, 0))
		return scene_refuse(x->s, c, x->e, "'%.255s' stands already", c->name);
	*to = (struct contact){.name = c->name, .rows = c->key == SCENE_WELD ? 6 : 3, .first = k->contact_rows};
	if (request_find_frame(x, c, c->name, &to->body, &to->X))
		return x->e->code;
	k->contact_count++;
	k->contact_rows += to->rows;
	return RNEAGEN_OK;
}

const struct contact *request_contact_of(const struct request *k, const struct want *w)
{
	return want_is(w->kind, OF_CONTACT) ? request_find_contact(k, strchr(w->word, '.') + 1, w->rows) : NULL;
}

static int are_equal(const struct placement *a, const struct placement *b)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			if (a->p[i].x != b->p[i].x || a->R.m[i][j].x != b->R.m[i][j].x)
				return 0;
	return 1;
}

/* The contact that has the want's place by another name: a joint's, or another link's on the same spot. */
static const struct contact *find_place(const struct request *k, const struct want *w)
{
	for (int i = 0; i < k->contact_count; i++)
		if (k->contacts[i].body == w->body && are_equal(&k->contacts[i].X, &w->X))
			return &k->contacts[i];
	return NULL;
}

enum rneagen_code request_check_force(const struct resolver *x, const struct scene_choice *c, const struct want *w)
{
	const char *name = strchr(c->name, '.');
	const struct contact *stands = name ? request_find_contact(x->k, name + 1, 0) : NULL, *alias;
	const char *other = w->kind == WANT_WELD ? "contact" : "weld";

	if (!want_is(w->kind, OF_CONTACT) || (stands && stands->rows == want_type(w->kind)->rows))
		return RNEAGEN_OK;
	alias = stands ? NULL : find_place(x->k, w);
	if (alias)
		return scene_refuse(x->s, c, x->e, "'%.255s' stands as '%.255s': want %s.%.255s", name + 1, alias->name,
			alias->rows == 6 ? "weld" : "contact", alias->name);
	if (stands)
		return scene_refuse(x->s, c, x->e, "'%.255s' stands by --%s: want %s.%.255s", name + 1, other, other, name + 1);
	return scene_refuse(x->s, c, x->e, "'%.255s' does not stand in this scene: --%s %.255s", name + 1,
		want_type(w->kind)->word, name + 1);
}

/* ---- what contacts do not serve ---- */

static const struct scene_choice *first_contact(const struct resolver *x)
{
	const struct scene_choice *c = scene_next(x->s, SCENE_CONTACT, NULL);

	return c ? c : scene_next(x->s, SCENE_WELD, NULL);
}

/* Quantities that are of the robot without contacts. */
static enum rneagen_code check_wants(const struct resolver *x)
{
	const struct request *k = x->k;

	for (int i = 0; i < k->want_count; i++) {
		enum want_kind kind = k->wants[i].kind;

		if (kind == WANT_MINV)
			return scene_refuse(x->s, first_contact(x), x->e, "'%.255s' is of the robot that nothing holds: derivatives by tau "
				"of links that stand are of --jvp and --vjp", k->wants[i].word);
		if (kind == WANT_QDD_BOUND || want_is(kind, IS_OPSPACE))
			return scene_refuse(x->s, first_contact(x), x->e, "'%.255s' speaks of no links that stand: leave one of the two out",
				k->wants[i].word);
	}
	return RNEAGEN_OK;
}

static enum rneagen_code check_options(const struct resolver *x)
{
	const struct request *k = x->k;
	const struct scene_choice *c = first_contact(x);

	if (!k->is_forward)
		return scene_refuse(x->s, c, x->e, "a link that stands changes accelerations alone: take --want qdd; torques take its "
			"force as an input, --fext");
	if (k->frame == FRAME_WORLD)
		return scene_refuse(x->s, c, x->e, "contacts are in the link's axes or the world's at the link's origin: take --frame "
			"world-aligned, or link");
	if (k->derivatives == DERIVATIVES_RECURSION)
		return scene_refuse(x->s, c, x->e, "the recursion does not serve links that stand: take --derivatives forward");
	return RNEAGEN_OK;
}

enum rneagen_code request_check_contacts(const struct resolver *x)
{
	if (!x->k->contact_count)
		return RNEAGEN_OK;
	if (check_options(x) || check_wants(x))
		return x->e->code;
	x->k->derivatives = DERIVATIVES_FORWARD;
	return RNEAGEN_OK;
}
