/* Constants that the scene makes inputs. */
#include "request/resolve.h"
#include <string.h>

int request_alloc_nominal(struct freed *f, const struct resolver *x)
{
	f->nominal = arena_alloc(x->a, (size_t)f->rows, sizeof *f->nominal);
	return f->nominal != NULL;
}

/* What a unit of row r of a link's inertia, at X in the body, adds to the body's: mass; first moments; xx xy xz yy yz zz.
   h' = R h + m p,  I' = R I R^T + 2 (p . R h) 1 - R h p^T - p (R h)^T + m (p . p 1 - p p^T). */
static struct inertia unit_inertia(const struct placement *X, int r)
{
	struct inertia out = {.mass = within_exact(r == 0)};
	struct within u[3] = {0}; /* R h, or m p / 2 */

	for (int i = 0; i < 3; i++) {
		if (r < 4)
			u[i] = r == 0 ? within_mul(within_exact(0.5L), X->p[i]) : X->R.m[i][r - 1];
		out.h[i] = r == 0 ? X->p[i] : u[i];
	}
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			struct sum s = {0};

			sum_add(&s, within_neg(within_mul(u[i], X->p[j])));
			sum_add(&s, within_neg(within_mul(X->p[i], u[j])));
			for (int k = 0; k < 3 && i == j; k++)
				sum_add(&s, within_mul(within_exact(2), within_mul(u[k], X->p[k])));
			for (int k = 0; k < 3 && r >= 4; k++)
				for (int l = 0; l < 3; l++)
					if (inertia_index(k < l ? k : l, k < l ? l : k) == r - 4)
						sum_add(&s, within_mul(X->R.m[i][k], X->R.m[j][l]));
			out.I[inertia_index(i, j)] = sum_total(s);
		}
	return out;
}

/* A link's inertia about its own origin, with another mass; where the URDF says nothing, a mass there is a point. */
static struct inertia own_inertia(const struct link *l, const struct placement *X, struct within mass, int has_inertia)
{
	static const struct within none[6] = {0};
	struct inertia_sum s = {0};

	inertia_add(&s, X, mass, l->com, l->com_rpy, has_inertia ? l->inertia : none);
	return inertia_total(&s);
}

static void set_nominal(struct freed *f, const struct inertia *I)
{
	f->nominal[0] = I->mass.x;
	for (int i = 0; i < 3; i++)
		f->nominal[1 + i] = I->h[i].x;
	for (int i = 0; i < 6; i++)
		f->nominal[4 + i] = I->I[i].x;
}

static enum rneagen_code free_link(const struct resolver *x, const struct scene_choice *c, struct freed *f)
{
	const struct placement here = {.R = ROTATION_IDENTITY};
	int link = request_find_link(x, c, strchr(c->name, '.') + 1);
	const struct carried *at = &x->t->links[link < 0 ? 0 : link];
	struct inertia I;

	if (link < 0)
		return x->e->code;
	f->body = at->body;
	f->rows = f->kind == FREED_MASS ? 1 : FREED_ROWS;
	f->columns = arena_alloc(x->a, (size_t)f->rows, sizeof *f->columns);
	if (!f->columns || !request_alloc_nominal(f, x))
		return error_memory(x->e);
	if (f->kind == FREED_MASS) {
		f->columns[0] = own_inertia(&x->r->links[link], &at->X, within_exact(1), 0);
		f->massless = own_inertia(&x->r->links[link], &at->X, within_exact(0), 1);
		f->nominal[0] = x->r->links[link].mass.x;
		return RNEAGEN_OK;
	}
	for (int r = 0; r < FREED_ROWS; r++)
		f->columns[r] = unit_inertia(&at->X, r);
	I = own_inertia(&x->r->links[link], &here, x->r->links[link].mass, 1);
	if (f->kind == FREED_INERTIA)
		set_nominal(f, &I);
	return RNEAGEN_OK;
}

static enum rneagen_code free_offset(const struct resolver *x, const struct scene_choice *c, struct freed *f)
{
	f->body = request_find_body(x, c, strchr(c->name, '.') + 1);
	f->rows = 1;
	if (f->body < 0)
		return x->e->code;
	if (!request_alloc_nominal(f, x))
		return error_memory(x->e);
	if (x->t->bodies[f->body].follower || joint_nq(x->t->bodies[f->body].type) != 1)
		return scene_refuse(x->s, c, x->e, "an offset belongs to a joint with one row in q, which '%.255s' is not",
			strchr(c->name, '.') + 1);
	return RNEAGEN_OK;
}

/* Of a link that stands: the acceleration that it has instead. */
static enum rneagen_code free_acceleration(const struct resolver *x, const struct scene_choice *c, struct freed *f)
{
	const char *name = strchr(c->name, '.') + 1;
	const struct contact *of = request_find_contact(x->k, name, 0);

	if (!of)
		return scene_refuse(x->s, c, x->e, "'%.255s' does not stand in this scene: --contact %.255s", name, name);
	f->contact = (int)(of - x->k->contacts);
	f->body = of->body;
	f->rows = of->rows;
	return request_alloc_nominal(f, x) ? RNEAGEN_OK : error_memory(x->e);
}

static enum rneagen_code free_gravity(const struct resolver *x, struct freed *f)
{
	f->rows = 3;
	if (!request_alloc_nominal(f, x))
		return error_memory(x->e);
	for (int i = 0; i < 3; i++)
		f->nominal[i] = x->t->gravity[i].x;
	return RNEAGEN_OK;
}

/* A link's mass and its inertia, which has the mass in it, cannot both be free, nor a joint's term and that of all joints. */
static enum rneagen_code check_free(const struct resolver *x, const struct scene_choice *c, const struct freed *f)
{
	for (int i = 0; i < x->k->freed_count; i++) {
		const struct freed *other = &x->k->freed[i];
		const char *a = strchr(f->word, '.'), *b = strchr(other->word, '.');
		int both = (f->kind == FREED_MASS && other->kind == FREED_INERTIA) ||
			(f->kind == FREED_INERTIA && other->kind == FREED_MASS);

		if (!strcmp(f->word, other->word))
			return scene_refuse(x->s, c, x->e, "'%.255s' is free already", f->word);
		if (f->kind == other->kind && (!a || !b))
			return scene_refuse(x->s, c, x->e, "'%.255s' is part of '%.255s': free one of them", a ? f->word : other->word,
				a ? other->word : f->word);
		if (both && !strcmp(a, b))
			return scene_refuse(x->s, c, x->e, "the mass is part of the inertia: free one of '%.255s' and '%.255s'",
				f->word, other->word);
	}
	return RNEAGEN_OK;
}

enum rneagen_code request_free(const struct resolver *x, const struct scene_choice *c)
{
	static const struct kind_word kinds[] = {[FREED_GRAVITY] = {"gravity", 0}, [FREED_MASS] = {"mass", 1},
		[FREED_INERTIA] = {"inertia", 1}, [FREED_PAYLOAD] = {"payload", 1}, [FREED_OFFSET] = {"offset", 1},
		[FREED_ACCEL] = {"accel", 1},
		[FREED_OWN + OWN_ARMATURE] = {"armature", 0}, [FREED_OWN + OWN_DAMPING] = {"damping", 0},
		[FREED_OWN + OWN_FRICTION] = {"friction", 0}, [FREED_KINDS + OWN_ARMATURE] = {"armature", 1},
		[FREED_KINDS + OWN_DAMPING] = {"damping", 1}, [FREED_KINDS + OWN_FRICTION] = {"friction", 1}};
	int kind = request_find_kind(x, c, kinds, sizeof kinds / sizeof *kinds);
	struct freed f = {.word = c->name};

	if (kind < 0)
		return x->e->code;
	f.kind = (enum freed_kind)(kind < FREED_KINDS ? kind : kind - OWN_TERMS);
	f.per_batch = c->value ? !strcmp(c->value, "batch") : f.kind != FREED_PAYLOAD && f.kind != FREED_ACCEL;
	if (f.kind >= FREED_OWN)
		request_free_own(x, c, &f);
	else if (f.kind == FREED_GRAVITY)
		free_gravity(x, &f);
	else if (f.kind == FREED_OFFSET)
		free_offset(x, c, &f);
	else if (f.kind == FREED_ACCEL)
		free_acceleration(x, c, &f);
	else
		free_link(x, c, &f);
	if (x->e->code || check_free(x, c, &f))
		return x->e->code;
	f.argument = request_argument(x, c->name);
	x->k->freed[x->k->freed_count++] = f;
	return RNEAGEN_OK;
}
