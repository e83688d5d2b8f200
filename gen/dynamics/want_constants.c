/* Constants of a scene's robot: numbers, or inputs where the scene frees them. */
#include "dynamics/want.h"
#include <string.h>

static struct parameters *parameters_of(struct build *b, int body)
{
	struct parameters *p = b->parameters[body];

	if (p)
		return p;
	p = b->parameters[body] = arena_alloc(b->d->arena, 1, sizeof *p);
	if (p)
		*p = rigid_body_parameters(b->d, &b->t->bodies[body].inertia);
	return p;
}

static void add_inertia(struct build *b, const struct freed *f, int argument)
{
	struct parameters *p = parameters_of(b, f->body);

	if (!p)
		return;
	if (f->kind == FREED_MASS)
		rigid_body_add(b->d, p, dag_const(b->d, 1), &f->massless);
	for (int r = 0; r < f->rows; r++)
		rigid_body_add(b->d, p, dag_input(b->d, argument, r), &f->columns[r]);
}

/* Of one joint, or of all in rows of qd, which followers have none of. */
static void set_own(struct build *b, const struct freed *f, int argument)
{
	struct ref *own = b->own[f->kind - FREED_OWN];

	if (f->body >= 0)
		own[f->body] = dag_input(b->d, argument, 0);
	for (int i = 0; i < b->t->body_count && f->body < 0; i++)
		if (joint_nv(b->t->bodies[i].type) == 1 && !b->t->bodies[i].follower)
			own[i] = dag_input(b->d, argument, b->t->bodies[i].iv);
}

const char *want_of(const char *word)
{
	const char *point = strchr(word, '.');

	return point ? point + 1 : "";
}

static enum role role_of(const struct freed *f)
{
	static const enum role roles[FREED_KINDS] = {[FREED_GRAVITY] = ROLE_GRAVITY, [FREED_MASS] = ROLE_LINK_MASS,
		[FREED_INERTIA] = ROLE_LINK_INERTIA, [FREED_PAYLOAD] = ROLE_LINK_PAYLOAD, [FREED_OFFSET] = ROLE_JOINT_OFFSET,
		[FREED_ACCEL] = ROLE_CONTACT_ACCELERATION,
		[FREED_OWN + OWN_ARMATURE] = ROLE_JOINT_ARMATURE, [FREED_OWN + OWN_DAMPING] = ROLE_JOINT_DAMPING,
		[FREED_OWN + OWN_FRICTION] = ROLE_JOINT_FRICTION};
	static const enum role of_all[OWN_TERMS] = {
		[OWN_ARMATURE] = ROLE_ARMATURE, [OWN_DAMPING] = ROLE_DAMPING, [OWN_FRICTION] = ROLE_FRICTION};

	return f->body < 0 ? of_all[f->kind - FREED_OWN] : roles[f->kind];
}

static int argument_of(struct build *b, const struct freed *f)
{
	int argument = dag_find_argument(b->d, f->argument);

	if (argument >= 0)
		return argument;
	return dag_argument_of(b->d, (struct argument){.name = f->argument, .rows = f->rows, .per_batch = f->per_batch,
		.role = role_of(f), .of = want_of(f->word)});
}

static int alloc(struct build *b)
{
	struct arena *a = b->d->arena;
	size_t bodies = (size_t)b->t->body_count;

	b->offset = arena_alloc(a, (size_t)b->t->nq, sizeof *b->offset);
	b->gravity = arena_alloc(a, 3, sizeof *b->gravity);
	b->demanded = arena_alloc(a, (size_t)b->k->contact_rows, sizeof *b->demanded);
	b->parameters = arena_alloc(a, bodies, sizeof(struct parameters *));
	for (int i = 0; i < OWN_TERMS; i++)
		b->own[i] = arena_alloc(a, bodies, sizeof *b->own[i]);
	b->d->failed |= a->failed;
	return !a->failed;
}

int want_constants(struct build *b)
{
	if (!alloc(b))
		return 0;
	for (int i = 0; i < 3; i++)
		b->gravity[i] = dag_within(b->d, b->t->gravity[i]);
	for (int i = 0; i < b->k->freed_count; i++) {
		const struct freed *f = &b->k->freed[i];
		int argument = argument_of(b, f);

		if (f->kind >= FREED_OWN)
			set_own(b, f, argument);
		else if (f->kind == FREED_OFFSET)
			b->offset[b->t->bodies[f->body].iq] = dag_input(b->d, argument, 0);
		else if (f->kind != FREED_GRAVITY && f->kind != FREED_ACCEL)
			add_inertia(b, f, argument);
		for (int r = 0; r < f->rows && f->kind == FREED_ACCEL; r++)
			b->demanded[b->k->contacts[f->contact].first + r] = dag_input(b->d, argument, r);
		for (int r = 0; r < 3 && f->kind == FREED_GRAVITY; r++)
			b->gravity[r] = dag_input(b->d, argument, r);
	}
	return 1;
}
