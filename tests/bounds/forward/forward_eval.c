#include "forward_eval.h"
#include "bounds/worst.h"
#include "dag/eval.h"
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int forward_eval_open(struct forward_eval *x, const char *urdf, const char *reference, const struct forward_scene *s,
	const char *what)
{
	struct analysis *a = &x->analysis;
	char *text;

	*x = (struct forward_eval){.scene = *s};
	arena_init(&x->arena, NULL);
	*a = (struct analysis){.urdf = urdf, .length = strlen(urdf), .arena = &x->arena, .error = &x->error,
		.options = rneagen_options_default()};
	text = arena_alloc(&x->arena, strlen(s->more) + 64, 1);
	ck_assert_ptr_nonnull(text);
	sprintf(text, "want qdd%s\n%s", s->swept ? "" : ",qdd_bound", s->more);
	a->options.file = what;
	a->options.base = s->floating ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	a->options.precision = s->precision;
	a->options.scene = text;
	if (analysis_run(a, PASS_URDF_READ, PASS_DAG_FUSE)) {
		printf("refused: %s\n", x->error.message);
		analysis_free_raw(a);
		arena_free(&x->arena);
		return 0;
	}
	solved_open(&x->solved, reference ? reference : urdf, s->floating, s->width, s->armature, what);
	ck_assert(x->solved.nq <= FORWARD_ROWS);
	return 1;
}

void forward_eval_close(struct forward_eval *x)
{
	solved_close(&x->solved);
	arena_free(&x->arena);
}

static void evaluate(struct forward_eval *x, struct rng *rng, const double *(*more)(const char *name))
{
	static const char *const names[] = {"q", "qd", "tau"};
	const struct dag *d = &x->analysis.dag;
	int is_single = x->scene.precision == RNEAGEN_F32;
	static float single[DAG_ARGUMENTS][FORWARD_ROWS];
	const float *in_f32[DAG_ARGUMENTS];
	const double *in[DAG_ARGUMENTS];
	double *out[DAG_ARGUMENTS], *to_bound[DAG_ARGUMENTS];
	float *out_f32[DAG_ARGUMENTS];

	for (int a = 0; a < d->argument_count; a++) {
		const struct argument *g = &d->arguments[a];

		in_f32[a] = single[a];
		out_f32[a] = single[a];
		out[a] = strcmp(g->name, "qdd") ? x->bound : x->qdd;
		in[a] = NULL;
		for (int i = 0; i < 3 && !g->is_output; i++)
			if (!strcmp(g->name, names[i]))
				in[a] = x->in[i];
		if (!in[a] && !g->is_output)
			in[a] = more(g->name);
		for (int i = 0; i < g->rows && !g->is_output; i++)
			single[a][i] = (float)in[a][i];
	}
	for (int a = 0; a < d->argument_count; a++)
		to_bound[a] = x->bound;
	ck_assert(!x->scene.swept || eval_bound(d, &x->analysis.model, in, to_bound));
	if (x->scene.worst) {
		worst_evaluate(d, &x->analysis.model, rng, in, out);
		return;
	}
	ck_assert(is_single ? eval_f32(d, in_f32, out_f32, NULL) : eval_f64(d, in, out, NULL));
	for (int a = 0; a < d->argument_count; a++)
		for (int i = 0; i < d->arguments[a].rows && d->arguments[a].is_output && x->scene.precision != RNEAGEN_F64; i++)
			out[a][i] = is_single ? (double)out_f32[a][i] : (double)(float)out[a][i];
}

void forward_eval_run(struct forward_eval *x, struct rng *rng, const double *(*more)(const char *name), int is_referred)
{
	struct solved *s = &x->solved;

	solved_draw(s, rng, x->in[0], x->in[1], x->in[2]);
	solved_torques(s, x->in[0], x->in[1], x->in[2], x->want);
	for (int i = 0; i < s->nv; i++)
		x->in[2][i] = (double)(float)x->want[i];
	evaluate(x, rng, more);
	if (is_referred)
		solved_accelerations(s, x->in[0], x->in[1], x->in[2], x->want);
}
