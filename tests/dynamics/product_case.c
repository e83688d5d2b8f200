#include "product_case.h"
#include <check.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { MOST_WORDS = 32 };

void say(char *to, size_t room, const char *fmt, ...)
{
	size_t length = strlen(to);
	va_list args;

	va_start(args, fmt);
	ck_assert_int_lt(vsnprintf(to + length, room - length, fmt, args), (int)(room - length));
	va_end(args);
}

/* ---- scenes ---- */

static const char *a_link(struct drawn_case *x, const struct tree *t)
{
	return t->bodies[rng_below(&x->rng, t->body_count)].link;
}

void draw_others(struct drawn_case *x, const struct tree *t)
{
	char *s = x->scene;
	size_t room = sizeof x->scene;
	const struct body *k = &t->bodies[rng_below(&x->rng, t->body_count)];

	if (rng_chance(&x->rng, 0.3))
		say(s, room, "free gravity%s\n", rng_chance(&x->rng, 0.5) ? ":sample" : "");
	if (rng_chance(&x->rng, 0.4))
		say(s, room, "free payload.%s\n", a_link(x, t));
	if (rng_chance(&x->rng, 0.3))
		say(s, room, "free %s.%s\n", rng_chance(&x->rng, 0.5) ? "mass" : "inertia", a_link(x, t));
	if (rng_chance(&x->rng, 0.3) && joint_nv(k->type) == 1 && !k->follower)
		say(s, room, "free offset.%s\n", k->joint);
	if (rng_chance(&x->rng, 0.4))
		say(s, room, "fext %s\nfext-frame %s\n", a_link(x, t), rng_chance(&x->rng, 0.5) ? "world" : "link");
	if (rng_chance(&x->rng, 0.3))
		say(s, room, "damping\nfriction 0.4\n");
	if (rng_chance(&x->rng, 0.3))
		say(s, room, "dense\n");
	if (rng_chance(&x->rng, 0.3))
		say(s, room, "derivatives %s\n", rng_chance(&x->rng, 0.5) ? "forward" : "recursion");
	if (rng_chance(&x->rng, 0.3))
		say(s, room, "params base\n");
	if (rng_chance(&x->rng, 0.3))
		say(s, room, "frame world%s\n", rng_chance(&x->rng, 0.5) ? "-aligned" : "");
	if (rng_chance(&x->rng, 0.3))
		say(s, room, "pose quaternion\n");
	if (x->is_forward && t->mimic_count == 0 && rng_chance(&x->rng, 0.5))
		say(s, room, "dynamics %s\n", rng_chance(&x->rng, 0.5) ? "articulated" : "factor");
}

/* Up to four of all words; L and J stand for a link and a joint. */
void draw_set(struct drawn_case *x, const struct tree *t)
{
	static const char *const both[] = {"gravity", "bias", "wrench.J", "twist.L", "accel.L", "power", "kinetic", "potential",
		"regressor", "M", "dtau_dq", "dtau_dqd", "pose.L", "jacobian.L", "djacobian.L", "com", "vcom", "com_jacobian",
		"momentum", "momentum_matrix", "dmomentum", "coriolis", "opspace_inv.L"};
	static const char *const forward[] = {"qdd", "Minv", "dqdd_dq", "dqdd_dqd"}, *const inverse[] = {"tau"};
	const char *words[MOST_WORDS];
	int count = 0;

	for (size_t i = 0; i < sizeof both / sizeof *both; i++)
		words[count++] = both[i];
	for (size_t i = 0; i < 4 && x->is_forward; i++)
		words[count++] = forward[i];
	if (!x->is_forward)
		words[count++] = inverse[0];
	for (int n = 1 + rng_below(&x->rng, 4); n > 0; n--) {
		int i = rng_below(&x->rng, count);
		const char *word = words[i], *point = strchr(word, '.'), *name = "";

		words[i] = words[--count];
		if (point && point[1] == 'L')
			name = a_link(x, t);
		if (point && point[1] == 'J')
			name = t->bodies[rng_below(&x->rng, t->body_count)].joint;
		say(x->of, sizeof x->of, "%s%.*s%s", *x->of ? "," : "", (int)(point ? point + 1 - word : (long)strlen(word)),
			word, point && !*name ? "base" : name);
	}
	if (x->is_forward && !strstr(x->of, "qdd") && !strstr(x->of, "Minv"))
		say(x->of, sizeof x->of, ",qdd");
}

/* ---- numbers ---- */

static void draw_given(struct drawn_case *x, const struct argument *a)
{
	struct given *g = &x->given[x->given_count++];

	ck_assert(x->given_count <= 4 + MOST_OTHERS && a->rows <= ROWS);
	snprintf(g->name, sizeof g->name, "%s", a->name);
	g->rows = a->rows;
	for (int i = 0; i < a->rows; i++) {
		g->at[i] = rng_uniform(&x->rng, -1.5, 1.5);
		g->along[i] = rng_uniform(&x->rng, -1, 1);
	}
	if (a->role == ROLE_LINK_MASS || a->role == ROLE_LINK_INERTIA || a->role == ROLE_LINK_PAYLOAD)
		for (int i = 0; i < a->rows; i++)
			g->at[i] = i == 0 ? rng_uniform(&x->rng, 1, 2) : i == 4 || i == 7 ||
				i == 9 ? rng_uniform(&x->rng, 2, 3) : g->at[i] / 10;
}

/* (u, s) o (w, 0)/2 */
static void turn(const real *u, const real *w, real *to)
{
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		to[i] = (u[3] * w[i] + u[j] * w[k] - u[k] * w[j]) / 2;
	}
	to[3] = -(u[0] * w[0] + u[1] * w[1] + u[2] * w[2]) / 2;
}

/* v rotated by the unit quaternion u: v + 2 s (u x v) + 2 u x (u x v) */
static void rotate(const real *u, const real *v, real *to)
{
	real a[3];

	for (int i = 0; i < 3; i++)
		a[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
	for (int i = 0; i < 3; i++)
		to[i] = v[i] + 2 * u[3] * a[i] + 2 * (u[(i + 1) % 3] * a[(i + 2) % 3] - u[(i + 2) % 3] * a[(i + 1) % 3]);
}

/* Unit quaternions, and how q moves along the first nv rows of v. */
static void draw_position(struct drawn_case *x, const struct tree *t)
{
	struct given *q = &x->given[0];

	for (int i = 0; i < t->joint_count; i++) {
		const struct tree_joint *k = &t->joints[i];
		real *u = q->at + k->iq + 3, norm = 0;

		for (int r = 0; r < k->nv && k->nq == k->nv; r++)
			q->along[k->iq + r] = x->v[k->iv + r];
		if (k->nq == k->nv)
			continue;
		for (int r = 0; r < 4; r++)
			norm += u[r] * u[r];
		for (int r = 0; r < 4; r++)
			u[r] /= sqrtl(norm);
		rotate(u, x->v + k->iv, q->along + k->iq);
		turn(u, x->v + k->iv + 3, q->along + k->iq + 3);
	}
}

void draw_numbers(struct drawn_case *x)
{
	const struct tree *t = &x->products.tree;
	const struct dag *d = &x->products.dag;
	static const char *const names[] = {"q", "qd", "qdd"};

	for (int i = 0; i < 3 * t->nv; i++)
		x->v[i] = rng_uniform(&x->rng, -1, 1);
	for (int i = 0; i < VALUES; i++)
		x->weights[i] = rng_uniform(&x->rng, -1, 1);
	for (int i = 0; i < 3; i++)
		draw_given(x, &(struct argument){.name = i == 2 && x->is_forward ? "tau" : names[i], .rows = i ? t->nv : t->nq});
	draw_position(x, t);
	for (int k = 1; k < 3; k++)
		memcpy(x->given[k].along, x->v + k * t->nv, (size_t)t->nv * sizeof(real));
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];

		if (!a->is_output && a->role > ROLE_JOINT_TORQUE && a->role != ROLE_TANGENT && a->role != ROLE_COTANGENT)
			draw_given(x, a);
	}
}
