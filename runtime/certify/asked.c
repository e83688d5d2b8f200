#include "certify/asked.h"
#include "emit/number_type.h"
#include <sha2.h>
#include <string.h>

static void take_joint(struct asked_box *b, const struct analysis *x, int argument, int i)
{
	const struct tree_joint *t = &x->tree.joints[i];
	const struct joint *j = tree_joint_of(x->tree.source, &x->tree, i);
	enum role role = x->dag.arguments[argument].role;

	if (role == ROLE_JOINT_POSITION && t->nq == 1 && t->type == JOINT_CONTINUOUS)
		b->rows[argument][t->iq] = (struct span){-OUT_PI, OUT_PI};
	else if (role == ROLE_JOINT_POSITION && t->type == JOINT_PLANAR)
		b->rows[argument][t->iq + 2] = (struct span){-OUT_PI, OUT_PI};
	else if (role == ROLE_JOINT_POSITION && t->nq == 1 && j && j->has_limits)
		b->rows[argument][t->iq] = (struct span){j->lower, j->upper};
	for (int r = 0; r < t->nv && role == ROLE_JOINT_VELOCITY && j && j->has_rates && j->velocity > 0; r++)
		b->rows[argument][t->iv + r] = (struct span){-j->velocity, j->velocity};
}

static void take_ranges(struct asked_box *b, const struct analysis *x, int argument)
{
	const struct argument *of = &x->dag.arguments[argument];

	if (of->role == ROLE_LINK_INERTIA || of->role == ROLE_LINK_PAYLOAD) /* it is the mass' (left_out.h) */
		return;
	for (int row = 0; row < of->rows; row++) {
		const struct request_range *r = request_range_of(&x->request, of->name, row);

		if (r)
			b->rows[argument][row] = (struct span){r->lower, r->upper};
	}
}

int asked_box(struct asked_box *b, const struct analysis *x, struct arena *a)
{
	const struct dag *d = &x->dag;

	*b = (struct asked_box){.position = dag_find_role(d, ROLE_JOINT_POSITION, 0)};
	for (int i = 0; i < d->argument_count; i++) {
		if (d->arguments[i].is_output ||
			!(b->rows[i] = arena_alloc(a, (size_t)d->arguments[i].rows, sizeof(struct span))))
			continue;
		for (int r = 0; r < d->arguments[i].rows; r++)
			b->rows[i][r] = (struct span){1, 0};
		for (int k = 0; k < x->tree.joint_count; k++)
			take_joint(b, x, i, k);
		take_ranges(b, x, i);
	}
	b->q_rows = b->position >= 0 ? d->arguments[b->position].rows : 0;
	b->position = b->position >= 0 ? b->position : DAG_ARGUMENTS;
	b->rows[DAG_ARGUMENTS] = arena_alloc(a, 1, sizeof(struct span));
	return !a->failed;
}

int asked_copy(struct asked_box *to, const struct asked_box *from, const struct dag *d, struct arena *a)
{
	*to = *from;
	for (int i = 0; i < d->argument_count; i++) {
		size_t rows = (size_t)d->arguments[i].rows;

		to->rows[i] = from->rows[i] ? arena_alloc(a, rows, sizeof(struct span)) : NULL;
		if (to->rows[i])
			memcpy(to->rows[i], from->rows[i], rows * sizeof(struct span));
	}
	return !a->failed;
}

void asked_hash(const void *bytes, size_t length, char hash[HASH_TEXT])
{
	SHA256Data(bytes, length, hash);
}

/* What a text of this precision is generated with. */
static struct rneagen_options text_options(const struct analysis *x, enum rneagen_precision precision)
{
	struct rneagen_options o = x->options;

	o.target = RNEAGEN_TARGET_C;
	o.layout = RNEAGEN_AOS;
	o.precision = precision;
	o.tell = 0;
	o.dump = RNEAGEN_DUMP_NONE;
	return o;
}

enum rneagen_code asked_text_hash(const struct analysis *x, enum rneagen_precision precision, char hash[HASH_TEXT],
	struct rneagen_error *e)
{
	struct rneagen_options o = text_options(x, precision);
	struct rneagen_result text;

	if (rneagen_generate(x->urdf, x->length, &o, &text, e))
		return e->code;
	asked_hash(text.source, strlen(text.source), hash);
	rneagen_result_free(&text);
	return RNEAGEN_OK;
}

struct eval_model asked_model(const struct analysis *x, enum rneagen_precision precision)
{
	struct rneagen_options o = text_options(x, precision);

	return eval_model_of(&o, 0);
}
