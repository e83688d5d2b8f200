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

enum rneagen_code request_check_force(const struct resolver *x, const struct scene_choice *c, const struct want *w)
{
	const char *name = strchr(c->name, '.');
	const struct contact *stands = name ? request_find_contact(x->k, name + 1, 0) : NULL;
	const char *other = w->kind == WANT_WELD ? "contact" : "weld";

	if (!want_is(w->kind, OF_CONTACT) || (stands && stands->rows == want_type(w->kind)->rows))
		return RNEAGEN_OK;
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

		if (kind == WANT_QDD_BOUND || kind == WANT_MINV)
			return scene_refuse(x->s, first_contact(x), x->e, kind == WANT_MINV
				? "'%.255s' is of the robot that nothing holds: derivatives by tau of links that stand are of --jvp and --vjp"
				: "'%.255s' speaks of no links that stand: leave one of the two out", k->wants[i].word);
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
