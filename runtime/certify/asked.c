#include "certify/asked.h"
#include "emit/number_type.h"
#include <sha2.h>
#include <string.h>

static int has_type(const struct analysis *a, enum joint_type type)
{
	for (int i = 0; i < a->tree.joint_count; i++)
		if (a->tree.joints[i].type == type)
			return 1;
	return 0;
}

static int has_planar(const struct analysis *a)
{
	return has_type(a, JOINT_PLANAR);
}

static int has_floating(const struct analysis *a)
{
	return has_type(a, JOINT_FLOATING);
}

static int has_bodies(const struct analysis *a)
{
	return dag_find_role(&a->dag, ROLE_LINK_INERTIA, 0) >= 0 || dag_find_role(&a->dag, ROLE_LINK_PAYLOAD, 0) >= 0;
}

static int has_friction(const struct analysis *a)
{
	for (int i = 0; i < a->tree.body_count; i++)
		if (a->request.friction[i].x != 0)
			return 1;
	return 0;
}

/* For some robots alone where `needed` says so. */
static const struct assumption {
	int (*needed)(const struct analysis *a);
	const char *text;
} ASSUMPTIONS[] = {
	{NULL, "rigid bodies as the URDF's decimals state them, angles within 5e-15 rad of a multiple of pi/2 being that; limits are the doubles "
	       "nearest to the file's decimals"},
	{NULL, "rotations between joints are exact rotations: where the generator takes one of their elements for zero, or for equal to another, "
	       "within the rounding of the file's decimals, outputs change by some 1e-15 of their terms, and ranges are 2^-30 of themselves wider"},
	{NULL, "all inputs are within their ranges, in any combination; a continuous joint has any angle that --trig takes"},
	{has_planar, "a planar joint has any angle that --trig takes, unless a range is given"},
	{has_floating, "quaternions: the square of the length of each is within 1e-6 of 1; it is any orientation"},
	{has_bodies, "the ten numbers of a freed inertia or payload are each within the range that is listed, in any combination"},
	{has_friction, "friction is the smooth one of the text: c qd / sqrt(qd^2 + width^2)"},
	{NULL, "ranges are of the exact outputs; a text's result is within error_bound of these"},
	{NULL, "rounding to nearest, subnormal numbers kept; products may be joined to sums or not; sine and cosine are the text's own"},
	{NULL, "nothing overflows: where it may, error_bound is null, and no_bound names the quantity and the range to narrow"},
	{NULL, "the double and extended arithmetic of the processor that proves is that of IEEE 754, and its sine and cosine in extended "
	       "precision are good to 2^-60"}};

size_t asked_assumptions(const struct analysis *x, const char *list[ASSUMPTIONS_MOST])
{
	size_t count = 0;

	for (size_t i = 0; i < sizeof ASSUMPTIONS / sizeof *ASSUMPTIONS; i++)
		if (!ASSUMPTIONS[i].needed || ASSUMPTIONS[i].needed(x))
			list[count++] = ASSUMPTIONS[i].text;
	return count;
}

/* above pi: stands for every angle */
static const double PI_ABOVE = 0x1.921fb54442d19p+1;

static void take_joint(struct asked_box *b, const struct analysis *x, int argument, int i)
{
	const struct tree_joint *t = &x->tree.joints[i];
	const struct joint *j = tree_joint_of(x->tree.source, &x->tree, i);
	enum role role = x->dag.arguments[argument].role;

	if (role == ROLE_JOINT_POSITION && t->nq == 1 && t->type == JOINT_CONTINUOUS)
		b->rows[argument][t->iq] = (struct span){-PI_ABOVE, PI_ABOVE};
	else if (role == ROLE_JOINT_POSITION && t->nq == 1 && j && j->has_limits)
		b->rows[argument][t->iq] = (struct span){j->lower, j->upper};
	for (int r = 0; r < t->nv && role == ROLE_JOINT_VELOCITY && j && j->has_rates && j->velocity > 0; r++)
		b->rows[argument][t->iv + r] = (struct span){-j->velocity, j->velocity};
}

static void take_range(struct asked_box *b, const struct dag *d, const struct request_range *r)
{
	int argument = dag_find_argument(d, r->argument);

	for (int row = r->first; argument >= 0 && b->rows[argument] && row < r->first + r->count; row++)
		b->rows[argument][row] = (struct span){r->lower, r->upper};
}

int asked_box(struct asked_box *b, const struct analysis *x, struct arena *a)
{
	const struct dag *d = &x->dag;

	*b = (struct asked_box){.position = dag_find_role(d, ROLE_JOINT_POSITION, 0)};
	for (int i = 0; i < d->argument_count; i++) {
		if (d->arguments[i].is_output || !(b->rows[i] = arena_alloc(a, (size_t)d->arguments[i].rows, sizeof(struct span))))
			continue;
		for (int r = 0; r < d->arguments[i].rows; r++)
			b->rows[i][r] = (struct span){1, 0};
		for (int k = 0; k < x->tree.joint_count; k++)
			take_joint(b, x, i, k);
	}
	for (int level = 0; level < REQUEST_RANGE_LEVELS && !a->failed; level++)
		for (int k = 0; k < x->request.range_count; k++)
			if (x->request.ranges[k].level == level)
				take_range(b, d, &x->request.ranges[k]);
	b->q_rows = b->position >= 0 ? d->arguments[b->position].rows : 0;
	b->position = b->position >= 0 ? b->position : DAG_ARGUMENTS;
	b->rows[DAG_ARGUMENTS] = arena_alloc(a, 1, sizeof(struct span));
	return !a->failed;
}

enum rneagen_code asked_check(const struct asked_box *b, const struct analysis *x, struct arena *a, struct rneagen_error *e)
{
	const struct dag *d = &x->dag;
	uint32_t *uses = arena_alloc(a, d->count, sizeof *uses);

	if (!uses)
		return error_memory(e);
	dag_uses(d, uses);
	for (size_t i = 0; i < d->count; i++) {
		const struct node *n = &d->nodes[i];
		const struct span *r = uses[i] && n->op == OP_INPUT ? &b->rows[n->arg[0].i][n->arg[1].i] : NULL;

		if (r && !(r->lo <= r->hi))
			return error_set(e, RNEAGEN_UNSUPPORTED, "%s: certificates know joints with limits, and ranges that are given; no range is known of %s[%d]",
				x->options.file, d->arguments[n->arg[0].i].name, (int)n->arg[1].i);
	}
	return RNEAGEN_OK;
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

enum rneagen_code asked_text_hash(const struct analysis *x, enum rneagen_precision precision, char hash[HASH_TEXT], struct rneagen_error *e)
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
