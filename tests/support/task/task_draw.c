/* Choices drawn at random. */
#include "support/task/task.h"
#include <math.h>

void case_draw_locks(struct task_case *c)
{
	int left = 0;

	for (int j = 0; j < c->r->nj; j++)
		left += case_has_rows(c, j);
	for (int j = 1; j < c->r->nj; j++)
		if (case_has_rows(c, j) && left > 1 && rng_chance(&c->rng, 0.25)) {
			case_lock(c, j);
			left--;
		}
}

/* On a chain to a tip, or to the joint that one there follows. */
static void close_chain(const struct task_case *c, char *chain)
{
	for (int again = 1; again;) {
		again = 0;
		for (int j = 0; j < c->r->nj; j++)
			for (int up = chain[j] ? c->r->joints[j].driver : 0; up > 0 && !chain[up]; up = c->r->joints[up].parent)
				again = chain[up] = 1;
	}
}

/* What is on no chain stays at zero. */
static void hold(struct task_case *c, int entry)
{
	const struct reference_joint *j = &c->r->joints[entry];

	for (int i = 0; i < j->nq; i++)
		c->q[j->iq + i] = i == 6;
	for (int i = 0; i < j->nv; i++)
		c->qd[j->iv + i] = c->qdd[j->iv + i] = 0;
	c->held[entry] = 1;
}

void case_draw_tips(struct task_case *c)
{
	char chain[ROWS] = {0};
	int link = case_pick(c, case_has_joint), left = 0;

	for (int up = link; up > 0; up = c->r->joints[up].parent)
		chain[up] = 1;
	close_chain(c, chain);
	for (int j = 0; j < c->r->nj; j++)
		left += (chain[j] || j == 0) && case_has_rows(c, j);
	if (!left)
		return;
	case_say(c, "tip %s\n", c->r->joints[link].link);
	for (int j = 1; j < c->r->nj; j++)
		if (!chain[j] && case_has_rows(c, j))
			hold(c, j);
}

void case_draw_folds(struct task_case *c)
{
	for (int which = 0; which < 3; which++) {
		int all = rng_chance(&c->rng, 0.25);

		if (all)
			case_give_all(c, which, which && rng_chance(&c->rng, 0.6) ? 0 : (double)NAN);
		for (int j = 0; j < c->r->nj && !all; j++)
			if (case_has_rows(c, j) && rng_chance(&c->rng, 0.25))
				case_give(c, j, which);
	}
	if (rng_chance(&c->rng, 0.3))
		case_gravity(c);
}

void case_draw_frees(struct task_case *c, int nominal)
{
	int joint = case_pick(c, case_has_one_row), mass = case_pick(c, case_moves), inertia = case_pick(c, case_moves);

	if (rng_chance(&c->rng, 0.4))
		case_free_gravity(c, nominal);
	if (rng_chance(&c->rng, 0.4))
		case_free_mass(c, mass, nominal);
	if (rng_chance(&c->rng, 0.4) && inertia != mass)
		case_free_inertia(c, inertia, nominal);
	if (rng_chance(&c->rng, 0.4))
		case_add_payload(c, case_pick(c, case_moves), nominal);
	if (rng_chance(&c->rng, 0.4) && joint >= 0)
		case_free_offset(c, joint, nominal);
}

void case_draw_pushes(struct task_case *c)
{
	c->in_world = rng_chance(&c->rng, 0.5);
	if (c->in_world || rng_chance(&c->rng, 0.5))
		case_say(c, "fext-frame %s\n", c->in_world ? "world" : "link");
	for (int i = 1 + rng_below(&c->rng, 2); i; i--)
		case_push(c, case_pick(c, case_moves));
}

/* Each of all joints, of one, or of none. */
static void draw_free_own(struct task_case *c)
{
	for (enum task_term term = TASK_ARMATURE; term < TASK_TERMS; term++) {
		int joint = case_pick(c, case_slides);

		if (joint > 0 && rng_chance(&c->rng, 0.4))
			case_free_own(c, term, case_pick(c, case_has_one_row) >= 0 && rng_chance(&c->rng, 0.5) ? -1 : joint);
	}
}

void case_draw_own(struct task_case *c)
{
	if (rng_chance(&c->rng, 0.5))
		draw_free_own(c);
	for (int i = 1; i < c->r->nj; i++)
		if (case_slides(c, i) && rng_chance(&c->rng, 0.5))
			case_armature(c, i);
	if (rng_chance(&c->rng, 0.6))
		case_damping(c);
	if (rng_chance(&c->rng, 0.5))
		case_friction(c, rng_chance(&c->rng, 0.5) ? 0 : 0.125);
}

void case_draw_wants(struct task_case *c)
{
	for (int i = 1 + rng_below(&c->rng, 4); i; i--) {
		enum task_kind kind = (enum task_kind)rng_below(&c->rng, TASK_KINDS);

		case_want(c, kind, case_pick(c, kind == TASK_WRENCH ? case_has_joint : case_moves));
	}
}
