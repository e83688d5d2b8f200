/* A request as a person reads it. */
#include "request/request.h"

static const char *body_name(const struct tree *t, int body)
{
	return body < 0 ? "(world)" : *t->bodies[body].joint ? t->bodies[body].joint : "(base)";
}

static void dump_given(const char *name, const struct row *rows, int count, struct text *out)
{
	for (int i = 0; i < count; i++)
		if (rows[i].is_given)
			text_printf(out, "given %s[%d] = %.17Lg\n", name, i, rows[i].value.x);
}

static void dump_inputs(const struct request *k, const struct tree *t, struct text *out)
{
	for (int i = 0; i < k->freed_count; i++) {
		const struct freed *f = &k->freed[i];

		text_printf(out, "in %s[%d] \"%s\"%s\n", f->argument, f->rows, f->word,
			f->per_batch ? ", the same for all samples" : "");
	}
	for (int i = 0; i < k->push_count; i++)
		text_printf(out, "in %s[6] \"%s\" on the body of joint \"%s\", in axes of the %s\n", k->pushes[i].argument,
			k->pushes[i].word, body_name(t, k->pushes[i].body), k->in_world ? "world" : "link");
	for (int i = 0; i < k->contact_count; i++)
		text_printf(out, "\"%s\" on the body of joint \"%s\" stands, %d rows\n", k->contacts[i].name,
			body_name(t, k->contacts[i].body), k->contacts[i].rows);
	for (int i = 0; i < k->range_count; i++)
		text_printf(out, "drawn %s[%d..%d] from %.17g to %.17g\n", k->ranges[i].argument, k->ranges[i].first,
			k->ranges[i].first + k->ranges[i].count - 1, k->ranges[i].lower, k->ranges[i].upper);
}

static void dump_own_terms(const char *what, const struct within *by_body, const struct tree *t, struct text *out)
{
	for (int i = 0; i < t->body_count; i++)
		if (by_body[i].x != 0)
			text_printf(out, "%s of joint \"%s\" %.17Lg\n", what, t->bodies[i].joint, by_body[i].x);
}

void request_dump(const struct request *k, const struct tree *t, struct text *out)
{
	text_printf(out, "request of \"%s\": %s, gravity %.17Lg %.17Lg %.17Lg\n", t->robot,
		k->is_plain	? "tau = ID(q, qd, qdd)"
		: k->is_forward ? "qdd = FD(q, qd, tau)"
				: "a scene's",
		t->gravity[0].x, t->gravity[1].x, t->gravity[2].x);
	if (k->refine_steps)
		text_printf(out, "steps of refinement: %d, residual in %s\n", k->refine_steps, request_refine_name(k->refine));
	dump_given("q", k->q, t->nq, out);
	dump_given("qd", k->qd, t->nv, out);
	dump_given("qdd", k->qdd, t->nv, out);
	dump_given("tau", k->tau, t->nv, out);
	dump_inputs(k, t, out);
	dump_own_terms("armature", k->own[OWN_ARMATURE], t, out);
	dump_own_terms("damping", k->own[OWN_DAMPING], t, out);
	dump_own_terms("friction", k->own[OWN_FRICTION], t, out);
	for (int i = k->stored_count; i < k->want_count; i++)
		text_printf(out, "made \"%s\"[%d] for products\n", k->wants[i].word, k->wants[i].rows);
	for (int i = 0; i < k->stored_count; i++)
		text_printf(out, "out %s[%d] \"%s\"\n", k->wants[i].argument, k->wants[i].rows, k->wants[i].word);
}
