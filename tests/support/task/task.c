#define _POSIX_C_SOURCE 200809L
#include "support/task/task.h"
#include <check.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static float draw(struct task_case *c, double low, double high)
{
	return (float)rng_uniform(&c->rng, low, high);
}

/* Rounded to floats, quaternions are no units. */
static void make_units(const struct reference *r, double *q)
{
	for (int j = 0; j < r->nj; j++) {
		double *u = q + r->joints[j].iq + 3, sum = 0;

		for (int i = 0; i < 4 && r->joints[j].nq == 7; i++)
			sum += u[i] * u[i];
		for (int i = 0; i < 4 && r->joints[j].nq == 7; i++)
			u[i] /= sqrt(sum);
	}
}

struct task_case *case_new(char *urdf, const struct rneagen_options *o, uint64_t seed)
{
	struct task_case *c = calloc(1, sizeof *c);

	ck_assert(c != NULL);
	c->options = *o;
	c->options.scene = c->scene;
	c->urdf = urdf;
	c->rng = rng_seed(seed + 4000);
	c->r = scene_reference(urdf, o);
	c->oracle = oracle_open(c->r, urdf, strlen(urdf));
	reference_sample(c->r, &c->rng, true, c->q, c->qd, c->qdd);
	make_units(c->r, c->q);
	return c;
}

void case_close(struct task_case *c)
{
	oracle_close(&c->oracle);
	reference_close(c->r);
	free(c->urdf);
	free(c);
}

struct task_case *case_random(uint64_t seed, int links, int flags)
{
	struct rneagen_options o = rneagen_options_default();
	struct task_case *c;

	o.base = seed % 3 ? RNEAGEN_FIXED : RNEAGEN_FLOATING;
	o.mimic = seed % 5 ? RNEAGEN_MIMIC_HONOUR : RNEAGEN_MIMIC_INDEPENDENT;
	o.gravity[1] = 1.25;
	o.gravity[2] = -9.75;
	c = case_new(torque_robot(seed, links, flags | (seed % 4 ? 0 : ALWAYS_MIMIC)), &o, seed);
	if (c->r->nv)
		return c;
	case_close(c);
	return NULL;
}

/* The value of the last line, which has ended, goes into quotes where it would read as something else. */
static void quote_last(struct task_case *c)
{
	char *end = strchr(c->scene, '\0') - 1, *value = end, *copy, *to;

	while (value > c->scene && value[-1] != '\n')
		value--;
	value += strcspn(value, " \n");
	if (*value != ' ' || (value[1] != '"' && !strchr(value, '#')))
		return;
	ck_assert_int_lt(2 * (end - value) + 4, c->scene + sizeof c->scene - value);
	*end = '\0';
	copy = strdup(++value);
	to = value;
	*to++ = '"';
	for (const char *s = copy; *s; *to++ = *s++)
		if (*s == '"' || *s == '\\')
			*to++ = '\\';
	strcpy(to, "\"\n");
	free(copy);
}

void case_say(struct task_case *c, const char *format, ...)
{
	size_t used = strlen(c->scene);
	va_list ap;

	va_start(ap, format);
	ck_assert_int_lt((int)used + vsnprintf(c->scene + used, sizeof c->scene - used, format, ap), (int)sizeof c->scene);
	va_end(ap);
	if (*c->scene && strchr(c->scene, '\0')[-1] == '\n')
		quote_last(c);
}

/* ---- entries ---- */

int case_moves(const struct task_case *c, int entry)
{
	for (; entry >= 0; entry = c->r->joints[entry].parent)
		if (c->r->joints[entry].type != REFERENCE_FIXED && !c->held[c->r->joints[entry].driver])
			return 1;
	return 0;
}

int case_has_rows(const struct task_case *c, int entry)
{
	return c->r->joints[entry].nq > 0 && !c->held[entry];
}

int case_pick(struct task_case *c, int (*good)(const struct task_case *c, int entry))
{
	int first = rng_below(&c->rng, c->r->nj);

	for (int i = 0; i < c->r->nj; i++)
		if (good(c, (first + i) % c->r->nj))
			return (first + i) % c->r->nj;
	return -1;
}

int case_has_one_row(const struct task_case *c, int entry)
{
	return case_has_rows(c, entry) && c->r->joints[entry].nq == 1;
}

/* A joint that moves and has one row, its own or its driver's. */
int case_slides(const struct task_case *c, int entry)
{
	return case_has_one_row(c, c->r->joints[entry].driver);
}

int case_has_joint(const struct task_case *c, int entry)
{
	return case_has_rows(c, c->r->joints[entry].driver);
}

const char *case_joint(const struct task_case *c, int entry)
{
	return entry ? c->r->joints[entry].name : "base";
}

/* ---- given ---- */

static void say_values(struct task_case *c, const double *x, int count)
{
	for (int i = 0; i < count; i++)
		case_say(c, "%s%.17g", i ? "," : "", x[i]);
	case_say(c, "\n");
}

void case_lock(struct task_case *c, int entry)
{
	const struct reference_joint *j = &c->r->joints[entry];

	case_say(c, "lock %s=", j->name);
	say_values(c, c->q + j->iq, j->nq);
	memset(c->qd + j->iv, 0, (size_t)j->nv * sizeof *c->qd);
	memset(c->qdd + j->iv, 0, (size_t)j->nv * sizeof *c->qdd);
	c->held[entry] = 1;
}

void case_give(struct task_case *c, int entry, int which)
{
	static const char *const words[] = {"q", "qd", "qdd"};
	const struct reference_joint *j = &c->r->joints[entry];
	double *const rows[] = {c->q + j->iq, c->qd + j->iv, c->qdd + j->iv};
	char *const given[] = {c->q_given + j->iq, c->qd_given + j->iv, c->qdd_given + j->iv};
	int count = which ? j->nv : j->nq;

	if (!(which == 0 && count == 7) && rng_chance(&c->rng, 0.5))
		memset(rows[which], 0, (size_t)count * sizeof(double));
	case_say(c, "fold %s.%s=", words[which], case_joint(c, entry));
	say_values(c, rows[which], count);
	memset(given[which], 1, (size_t)count);
}

/* One number for all rows takes the held ones along, which stand still anyway. */
void case_give_all(struct task_case *c, int which, double value)
{
	static const char *const words[] = {"q", "qd", "qdd"};
	double *const rows[] = {c->q, c->qd, c->qdd};
	char *const given[] = {c->q_given, c->qd_given, c->qdd_given};
	int count = 0;

	for (int j = 0; j < c->r->nj; j++) {
		const struct reference_joint *x = &c->r->joints[j];
		int first = which ? x->iv : x->iq, n = which ? x->nv : x->nq;

		for (int i = first; i < first + n && case_has_rows(c, j); i++, count++) {
			rows[which][i] = isnan(value) ? rows[which][i] : value;
			given[which][i] = 1;
			if (isnan(value))
				case_say(c, "%s%s%s%.17g", count ? "" : "fold ", count ? "," : words[which],
					count ? "" : "=", rows[which][i]);
		}
	}
	if (isnan(value))
		case_say(c, "\n");
	else
		case_say(c, "fold %s=%.17g\n", words[which], value);
}

void case_gravity(struct task_case *c)
{
	double g[3];

	for (int i = 0; i < 3; i++) {
		g[i] = rng_chance(&c->rng, 0.3) ? 0 : (double)draw(c, -10, 10);
		c->r->gravity[i] = (wide)g[i];
	}
	case_say(c, "fold gravity=");
	say_values(c, g, 3);
}

/* ---- freed ---- */

/* NULL where the word is there already. */
static struct task_in *add_in(struct task_case *c, int rows, const char *key, const char *kind, const char *name)
{
	struct task_in *x = &c->in[c->in_count];
	const char *when = rng_chance(&c->rng, 0.5) ? "" : rng_chance(&c->rng, 0.5) ? ":sample" : ":batch";

	ck_assert_int_lt(c->in_count, TASK_WORDS);
	snprintf(x->word, sizeof x->word, "%s%s%s", kind, name ? "." : "", name ? name : "");
	for (int i = 0; i < c->in_count; i++)
		if (!strcmp(c->in[i].word, x->word))
			return NULL;
	x->rows = rows;
	x->is_push = !strcmp(key, "fext");
	x->per_batch = !x->is_push && (*when ? when[1] == 'b' : strcmp(kind, "payload") != 0);
	case_say(c, "%s %s%s\n", key, x->is_push ? name : x->word, x->is_push ? "" : when);
	c->in_count++;
	return x;
}

void case_free_gravity(struct task_case *c, int nominal)
{
	struct task_in *x = add_in(c, 3, "free", "gravity", NULL);

	for (int i = 0; x && i < 3; i++) {
		x->value[i] = nominal ? (double)(float)c->r->gravity[i] : (double)draw(c, -10, 10);
		c->r->gravity[i] = (wide)x->value[i];
	}
}

/* The mass at the centre of mass changes: m' = m + s, h' = h + s c, I' = I + s (c.c 1 - c c^T). */
void case_free_mass(struct task_case *c, int entry, int nominal)
{
	struct task_in *x = add_in(c, 1, "free", "mass", c->r->joints[entry].link);
	const struct raw_link *l = c->oracle.raw.links;
	wide p[10], s, r[3];

	if (!x)
		return;
	while (strcmp(l->name, c->r->joints[entry].link))
		l++;
	x->value[0] = nominal ? (double)(float)l->mass : (double)draw(c, 0, 5);
	s = (wide)x->value[0] - l->mass;
	reference_inertia(c->r, entry, p);
	for (int i = 0; i < 3; i++)
		r[i] = l->xyz[i];
	p[0] += s;
	for (int i = 0, k = 4; i < 3; i++) {
		p[1 + i] += s * r[i];
		for (int j = i; j < 3; j++, k++)
			p[k] += s * ((i == j ? r[0] * r[0] + r[1] * r[1] + r[2] * r[2] : 0) - r[i] * r[j]);
	}
	reference_set_inertia(c->r, entry, p);
}

static void draw_inertia(struct task_case *c, double *p)
{
	for (int i = 0; i < 10; i++)
		p[i] = (double)draw(c, i == 0 || i == 4 || i == 7 || i == 9 ? 0 : -0.5, 2);
}

/* Ten parameters in the place of the link's, or beside them. */
static void free_parameters(struct task_case *c, int entry, int nominal, const char *word, int is_beside)
{
	struct task_in *x = add_in(c, 10, "free", word, c->r->joints[entry].link);
	wide p[10];

	if (!x)
		return;
	reference_inertia(c->r, entry, p);
	draw_inertia(c, x->value);
	for (int i = 0; i < 10; i++) {
		if (nominal)
			x->value[i] = is_beside ? 0 : (double)(float)p[i];
		p[i] = (is_beside ? p[i] : 0) + (wide)x->value[i];
	}
	reference_set_inertia(c->r, entry, p);
}

void case_free_inertia(struct task_case *c, int entry, int nominal)
{
	free_parameters(c, entry, nominal, "inertia", 0);
}

void case_add_payload(struct task_case *c, int entry, int nominal)
{
	free_parameters(c, entry, nominal, "payload", 1);
}

void case_free_offset(struct task_case *c, int entry, int nominal)
{
	struct task_in *x = add_in(c, 1, "free", "offset", case_joint(c, entry));

	if (!x)
		return;
	x->value[0] = nominal ? 0 : (double)draw(c, -0.5, 0.5);
	c->offset[c->r->joints[entry].iq] = x->value[0];
}

/* ---- forces from outside, terms of the joints' own, wants ---- */

void case_push(struct task_case *c, int entry)
{
	struct task_in *x = add_in(c, 6, "fext", "fext", c->r->joints[entry].link);

	for (int i = 0; x && i < 6; i++) {
		x->value[i] = (double)draw(c, -20, 20);
		c->push[entry][i] = (wide)x->value[i];
	}
}

static const char *const TERMS[TASK_TERMS] = {"armature", "damping", "friction"};

int task_is_own(const struct task_in *in, enum task_term *term)
{
	size_t length = strcspn(in->word, ".");

	for (*term = TASK_ARMATURE; *term < TASK_TERMS; ++*term)
		if (strlen(TERMS[*term]) == length && !strncmp(TERMS[*term], in->word, length))
			return !in->is_push;
	return 0;
}

wide *case_own(struct task_case *c, enum task_term term, int entry)
{
	struct reference_own *own = &c->own[entry];

	return term == TASK_ARMATURE ? &own->armature : term == TASK_DAMPING ? &own->damping : &own->friction;
}

static void set_own(struct task_case *c, enum task_term term, int entry, wide value)
{
	if (!c->own_free[term][entry])
		*case_own(c, term, entry) = value;
}

static void free_term(struct task_case *c, enum task_term term, int entry, double value)
{
	set_own(c, term, entry, (wide)value);
	c->own_free[term][entry] = 1;
	if (!(c->own[entry].width > 0))
		c->own[entry].width = WIDE_C(0.01);
}

/* Of all joints: rows of a joint with more are not read. */
void case_free_own(struct task_case *c, enum task_term term, int entry)
{
	int rows = entry >= 0;
	struct task_in *x;

	for (int i = 0; i < c->r->nj && entry < 0; i++)
		rows += case_has_rows(c, i) ? c->r->joints[i].nv : 0;
	x = add_in(c, rows, "free", TERMS[term], entry >= 0 ? case_joint(c, entry) : NULL);
	if (!x)
		return;
	x->is_of_all = entry < 0;
	for (int i = 0; i < ROWS; i++)
		x->value[i] = (double)draw(c, 0, 2);
	if (entry >= 0)
		free_term(c, term, entry, x->value[0]);
	for (int i = 0; i < c->r->nj && entry < 0; i++)
		if (case_has_one_row(c, i))
			free_term(c, term, i, x->value[c->r->joints[i].iv]);
}

void case_armature(struct task_case *c, int entry)
{
	double value = (double)draw(c, 0, 2);

	case_say(c, "armature %s=%.17g\n", case_joint(c, entry), value);
	set_own(c, TASK_ARMATURE, entry, (wide)value);
}

void case_damping(struct task_case *c)
{
	case_say(c, "damping\n");
	for (int i = 1; i < c->r->nj; i++)
		if (case_slides(c, i))
			set_own(c, TASK_DAMPING, i, (wide)c->oracle.raw.joints[c->oracle.source[i]].damping);
}

/* 0: the width that goes without saying. */
void case_friction(struct task_case *c, double width)
{
	case_say(c, width > 0 ? "friction %.17g\n" : "friction\n", width);
	for (int i = 1; i < c->r->nj; i++)
		if (case_slides(c, i)) {
			set_own(c, TASK_FRICTION, i, (wide)c->oracle.raw.joints[c->oracle.source[i]].friction);
			c->own[i].width = width > 0 ? (wide)width : WIDE_C(0.01);
		}
}

void case_want(struct task_case *c, enum task_kind kind, int entry)
{
	static const char *const words[TASK_KINDS] = {
		"tau", "gravity", "bias", "wrench", "twist", "accel", "power", "kinetic", "potential"};
	struct task_out *out = &c->out[c->out_count];
	const char *name = kind == TASK_WRENCH ? case_joint(c, entry) : c->r->joints[entry].link;

	*out = (struct task_out){.kind = kind, .entry = entry};
	snprintf(out->word, sizeof out->word, kind >= TASK_WRENCH && kind <= TASK_ACCEL ? "%s.%s" : "%s", words[kind], name);
	for (int i = 0; i < c->out_count; i++)
		if (!strcmp(c->out[i].word, out->word))
			return;
	case_say(c, "want %s\n", out->word);
	c->out_count++;
}
