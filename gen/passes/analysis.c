#include "passes/analysis.h"
#include "draw/prune.h"
#include "emit/number_type.h"
#include "plan/plan.h"
#include <string.h>

enum rneagen_code pass_urdf_read(struct analysis *a)
{
	return robot_read(&a->robot, a->urdf, a->length, a->options.file, a->arena, a->error);
}

enum rneagen_code pass_scene_parse(struct analysis *a)
{
	if (scene_read(&a->scene, a->options.scene, a->options.file, a->arena, a->error) ||
		scene_expand(&a->scene, &a->robot, a->arena, a->error))
		return a->error->code;
	return adjust_read(&a->adjust, &a->scene, a->arena, a->error);
}

enum rneagen_code pass_scene_select(struct analysis *a)
{
	if (scene_select(&a->selection, &a->scene, &a->robot, a->options.mimic, a->arena, a->error))
		return a->error->code;
	return outcome_list(&a->outcome, &a->scene, &a->adjust, &a->selection, &a->robot, a->arena, a->error);
}

enum rneagen_code pass_robot_snap(struct analysis *a)
{
	a->snapped = a->adjust.snap == 0 ? a->robot : adjust_snap(&a->robot, a->adjust.snap, a->arena);
	return a->arena->failed ? error_memory(a->error) : RNEAGEN_OK;
}

enum rneagen_code pass_tree_build(struct analysis *a)
{
	if (tree_build(&a->tree, &a->snapped, &a->selection, &a->options, a->arena, a->error))
		return a->error->code;
	if (a->adjust.digits)
		tree_round(&a->tree, a->adjust.digits);
	a->stated = a->tree;
	return RNEAGEN_OK;
}

/* What a bound of qdd does not know of. */
static enum rneagen_code check_bound(struct analysis *a)
{
	if (!request_wants(&a->request, WANT_QDD_BOUND))
		return RNEAGEN_OK;
	if (a->options.trig == RNEAGEN_FAST)
		return error_set(a->error, RNEAGEN_USAGE,
			"--want qdd_bound and --trig fast exclude each other: the sine of a GPU's own unit has no bound beyond pi; take bounded");
	if (a->options.precision == RNEAGEN_F32X2)
		return error_set(a->error, RNEAGEN_USAGE,
			"--want qdd_bound and --precision f32x2 exclude each other: pairs of floats have no magnitudes in texts; take f64");
	if (a->adjust.prune != 0)
		return error_set(a->error, RNEAGEN_USAGE,
			"--want qdd_bound and --drop-below exclude each other: what is left out of M and of the torques differs");
	return RNEAGEN_OK;
}

/* The least domain of any precision. Outside it sine and cosine are NaN, so nothing is wrong in silence. */
#define BOUNDED_ANGLE 9990

static void choose_trig(struct analysis *a)
{
	int is_enough = request_bounds_angles(&a->request, &a->tree, BOUNDED_ANGLE);

	if (a->options.trig == RNEAGEN_TRIG_AUTO)
		a->options.trig = is_enough ? RNEAGEN_BOUNDED : RNEAGEN_ACCURATE;
	a->adjust.has_angles = is_enough && a->options.trig == RNEAGEN_BOUNDED;
}

enum rneagen_code pass_request_resolve(struct analysis *a)
{
	if (request_resolve(&a->request, &a->tree, &a->scene, &a->snapped, a->arena, a->error))
		return a->error->code;
	if (request_refine(&a->request, &a->scene, a->options.precision, a->error))
		return a->error->code;
	choose_trig(a);
	a->model = eval_model_of(&a->options, 0);
	a->request.arithmetic = &a->model;
	return check_bound(a);
}

static enum rneagen_code refuse_row(const struct analysis *a, int row)
{
	const struct tree_joint *j = tree_joint_of_row(&a->tree, row);

	if (a->tree.floating && j->body == 0)
		return error_set(a->error, RNEAGEN_TREE,
			"%s: M is singular: the floating base, link \"%.255s\", has no mass of its own: give it an inertia, or take --base fixed",
			a->options.file, a->tree.bodies[0].link);
	return error_set(a->error, RNEAGEN_TREE,
		"%s: M is singular: joint \"%.255s\" moves no mass of its own, or next to none: lock it (--lock)%s",
		a->options.file, j->name, j->nv == 1 ? ", or give it an armature (--armature)" : "");
}

static enum rneagen_code refuse_inverse(const struct analysis *a, const struct want *w)
{
	const char *name = strchr(w->word, '.');

	return error_set(a->error, RNEAGEN_TREE,
		"%s: %.255s: its inverse is singular in all states, since the joints do not move '%.255s' in all six directions: want "
		"opspace_inv%.255s", a->options.file, w->word, name + 1, name);
}

/* Another one on the same body; NULL: there is none. */
static const struct contact *contact_beside(const struct request *k, const struct contact *c)
{
	for (int i = 0; i < k->contact_count; i++)
		if (&k->contacts[i] != c && k->contacts[i].body == c->body)
			return &k->contacts[i];
	return NULL;
}

/* What holds what other contacts, before it, or the joints, hold already. */
static enum rneagen_code refuse_contact(const struct analysis *a, const struct contact *c)
{
	const struct contact *other = contact_beside(&a->request, c);

	if (other)
		return error_set(a->error, RNEAGEN_TREE,
			"%s: '%.255s' cannot stand beside '%.255s', which is on the same body: between them both hold their distance: "
			"take --weld %.255s alone", a->options.file, c->name, other->name, a->tree.bodies[c->body].link);
	return error_set(a->error, RNEAGEN_TREE,
		"%s: '%.255s' cannot stand so in any state: the joints do not move it in all %d directions, or other links that "
		"stand hold it already%s", a->options.file, c->name, c->rows, c->rows == 6 ? "; --contact holds its origin alone" : "");
}

static enum rneagen_code refuse_singular(const struct analysis *a, struct singular x)
{
	if (x.of == SINGULAR_CONTACT)
		return refuse_contact(a, &a->request.contacts[x.number]);
	return x.of == SINGULAR_WANT ? refuse_inverse(a, &a->request.wants[x.number]) : refuse_row(a, x.number);
}

/* In an arena of its own, which goes again. */
enum rneagen_code pass_dag_build(struct analysis *a)
{
	const struct algorithm *found[ALGORITHM_COUNT];

	arena_init(&a->raw_arena, &a->arena->allocator);
	dag_init(&a->raw, &a->raw_arena);
	algorithms_for(&a->request, found);
	found[0]->build(&a->raw, &a->tree, &a->request);
	dag_close(&a->raw);
	if (a->raw.singular.of)
		return refuse_singular(a, a->raw.singular);
	if (a->raw.constant)
		return request_refuse_constant(&a->request, &a->scene, a->raw.constant - 1, a->error);
	return a->raw.failed ? error_memory(a->error) : RNEAGEN_OK;
}

/* Why nothing is proved, as a message of the option's. */
static enum rneagen_code refuse_drop(struct analysis *a)
{
	char why[sizeof a->error->message];

	memcpy(why, a->error->message, sizeof why);
	*a->error = (struct rneagen_error){0};
	return scene_refuse(&a->scene, scene_next(&a->scene, SCENE_DROP_BELOW, NULL), a->error, "%.700s", why);
}

/* What --drop-below leaves out. */
enum rneagen_code pass_dag_prune(struct analysis *a)
{
	struct dag all = a->raw;
	enum rneagen_code code;

	if (a->adjust.prune == 0)
		return RNEAGEN_OK;
	dag_init(&a->raw, &a->raw_arena);
	code = prune_terms(&a->raw, &a->dropped, &all, &a->tree, &a->request, a->adjust.prune, a->adjust.is_sampled, a->error);
	dag_free(&all);
	dag_close(&a->raw);
	if (code)
		return code == RNEAGEN_SCENE || code == RNEAGEN_LIMIT ? refuse_drop(a) : code;
	return a->raw.failed ? error_memory(a->error) : RNEAGEN_OK;
}

enum rneagen_code pass_dag_fuse(struct analysis *a)
{
	dag_init(&a->dag, a->arena);
	dag_fuse(&a->dag, &a->raw, a->options.strict);
	return a->dag.failed ? error_memory(a->error) : RNEAGEN_OK;
}

enum rneagen_code analysis_run(struct analysis *a, enum analysis_pass first, enum analysis_pass last)
{
	static enum rneagen_code (*const passes[ANALYSIS_PASSES])(struct analysis *a) = {
		[PASS_URDF_READ] = pass_urdf_read, [PASS_SCENE_PARSE] = pass_scene_parse, [PASS_SCENE_SELECT] = pass_scene_select,
		[PASS_HOLDS_CHOOSE] = pass_holds_choose, [PASS_ROBOT_SNAP] = pass_robot_snap, [PASS_TREE_BUILD] = pass_tree_build,
		[PASS_PARAMS_CHOOSE] = pass_params_choose, [PASS_REQUEST_RESOLVE] = pass_request_resolve,
		[PASS_DAG_BUILD] = pass_dag_build, [PASS_DAG_PRUNE] = pass_dag_prune, [PASS_DAG_FUSE] = pass_dag_fuse};
	enum rneagen_code code = RNEAGEN_OK;

	for (enum analysis_pass i = first; i <= last && !code; i++)
		code = passes[i](a);
	if (last == PASS_DAG_FUSE)
		analysis_free_raw(a);
	return code;
}

void analysis_copy(struct analysis *x, const struct analysis *a, struct arena *arena, struct rneagen_error *e)
{
	*x = *a;
	x->arena = arena;
	x->error = e;
	x->raw_arena = x->own = (struct arena){0};
	x->raw = x->dag = (struct dag){0};
}

enum rneagen_code analysis_open(struct analysis *a, const char *urdf, size_t length, const struct rneagen_options *o,
	struct rneagen_error *e)
{
	*a = (struct analysis){.urdf = urdf, .length = length, .options = *o, .arena = &a->own, .error = e};
	*e = (struct rneagen_error){0};
	a->options.file = o->file ? o->file : "<input>";
	arena_init(&a->own, o->allocator);
	if (analysis_run(a, PASS_URDF_READ, PASS_DAG_FUSE) || analysis_warn(a))
		analysis_free(a);
	return e->code;
}

void analysis_free_raw(struct analysis *a)
{
	arena_free(&a->raw_arena);
	a->raw = (struct dag){0};
}

void analysis_free(struct analysis *a)
{
	analysis_free_raw(a);
	arena_free(&a->own);
	*a = (struct analysis){0};
}

enum rneagen_code analysis_warn(struct analysis *a)
{
	tree_warn(&a->tree, &a->robot, a->options.file, a->arena);
	outcome_warn(&a->outcome, &a->robot, a->options.file, a->arena);
	return a->arena->failed ? error_memory(a->error) : RNEAGEN_OK;
}

long analysis_flops(const struct analysis *a)
{
	const struct plan p = {.dag = &a->dag}; /* without lines */

	return (long)plan_flops(plan_operations(&p));
}
