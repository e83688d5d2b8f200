#include "tell/saving.h"
#include "analysis.h"
#include "hold.h"
#include "plan/plan.h"
#include <string.h>

/* With more lines than these the scene is compared with the full model alone. */
enum { MOST_LINES = 12 };

static int bytes_of(const struct dag *d, const struct rneagen_options *o)
{
	int bytes = o->precision == RNEAGEN_F32 || o->precision == RNEAGEN_MIXED ? 4 : 8, rows = 0;

	for (int i = 0; i < d->argument_count; i++)
		rows += d->arguments[i].per_batch ? 0 : d->arguments[i].rows;
	return rows * bytes;
}

static void note(struct saving *x, const struct plan *p, const struct rneagen_options *o, struct arena *a)
{
	x->is_known = 1;
	x->flops = (long)plan_flops(plan_operations(p));
	x->alive = plan_alive(p, a);
	x->bytes = bytes_of(p->dag, o);
}

/* In an arena of its own, which goes again. */
static enum rneagen_code count(struct saving *x, const struct robot *r, const struct rneagen_options *o, struct rneagen_error *e)
{
	struct rneagen_error refused = {0};
	struct arena a;
	struct tree t;
	struct dag d;
	struct plan p;

	arena_init(&a, o->allocator);
	if (!keep_build(&t, r, o, &a, &refused)) {
		if (!analysis_dag(&d, &t, o->strict, &a) || !plan_build(&p, &d, &t, &a))
			error_memory(e);
		else
			note(x, &p, o, &a);
	} else if (refused.code == RNEAGEN_MEMORY) {
		error_memory(e);
	}
	if (a.failed)
		error_memory(e);
	arena_free(&a);
	return e->code;
}

/* The text of the scene without its line of this index, and without ranges where these are not wanted either. */
static const char *without(const struct scene *s, const char *scene, int index, int ranges, struct arena *a)
{
	int line = 1, next = 0;
	struct text t;

	text_init(&t, a);
	for (const char *at = scene; *at; line++) {
		size_t length = strcspn(at, "\n");
		int is_choice = next < s->line_count && s->lines[next].line == line;

		if (!is_choice || (next != index && (ranges || s->lines[next].key != SCENE_RANGE)))
			text_printf(&t, "%.*s\n", (int)length, at);
		next += is_choice;
		at += length + (at[length] != '\0');
	}
	return text_string(&t);
}

/* A range of what the line makes an input goes with it. */
static enum rneagen_code add_without(struct tree *t, int index, const struct robot *r, const struct rneagen_options *o, struct arena *a,
	struct rneagen_error *e)
{
	struct saving *x = &t->savings[t->saving_count++];
	struct rneagen_options other = *o;

	x->line = index;
	for (int ranges = 1; ranges >= 0 && !x->is_known && !e->code; ranges--) {
		other.scene = without(&t->scene, o->scene, index, ranges, a);
		if (a->failed || (!ranges && !scene_next(&t->scene, SCENE_RANGE, NULL)))
			break;
		count(x, r, &other, e);
	}
	return a->failed ? error_memory(e) : e->code;
}

static enum rneagen_code add_full(struct tree *t, const struct robot *r, const struct rneagen_options *o, struct rneagen_error *e)
{
	struct saving *x = &t->savings[t->saving_count++];
	struct rneagen_options other = *o;

	other.scene = NULL;
	other.order = NULL; /* it need not name what the scene leaves out */
	x->line = SAVING_FULL;
	return count(x, r, &other, e);
}

enum rneagen_code saving_measure(struct tree *t, const struct plan *now, const struct robot *r, const struct rneagen_options *o,
	struct arena *a, struct rneagen_error *e)
{
	int lines = scene_choice_count(&t->scene);

	if (!lines)
		return RNEAGEN_OK;
	t->savings = arena_alloc(a, (size_t)lines + 2, sizeof *t->savings);
	if (!t->savings)
		return error_memory(e);
	if (add_full(t, r, o, e))
		return e->code;
	t->savings[t->saving_count].line = SAVING_SCENE;
	note(&t->savings[t->saving_count++], now, o, a);
	for (int i = 0; i < t->scene.line_count && lines > 1 && lines <= MOST_LINES; i++)
		if (t->scene.lines[i].key != SCENE_RANGE && add_without(t, i, r, o, a, e))
			return e->code;
	return a->failed ? error_memory(e) : RNEAGEN_OK;
}

/* ---- telling ---- */

static double floor_ps(const struct saving *x)
{
	return x->bytes / SAVING_BANDWIDTH * 1e12;
}

void saving_put_table(const struct tree *t, struct text *out)
{
	if (!t->saving_count)
		return;
	text_put(out, "\nof a sample        flops   alive   bytes   ps at 3 TB/s\n");
	for (int i = 0; i < t->saving_count; i++) {
		const struct saving *x = &t->savings[i];

		text_put(out, x->line == SAVING_FULL ? "  full model  " : x->line == SAVING_SCENE ? "  this scene  " : "  without it  ");
		if (x->is_known)
			text_printf(out, "%10ld %7d %7d %14.1f", x->flops, x->alive, x->bytes, floor_ps(x));
		else
			text_printf(out, "%10s %7s %7s %14s", "-", "-", "-", "-");
		if (x->line >= 0) {
			text_put(out, "   ");
			scene_put_option(&t->scene.lines[x->line], out);
		}
		text_putc(out, '\n');
	}
}

void saving_put_json(const struct tree *t, struct text *out)
{
	struct text option;

	if (!t->saving_count)
		return;
	text_put(out, "  \"savings\": [");
	for (int i = 0; i < t->saving_count; i++) {
		const struct saving *x = &t->savings[i];

		text_init(&option, out->arena);
		if (x->line >= 0)
			scene_put_option(&t->scene.lines[x->line], &option);
		out->failed |= option.failed;
		text_put(out, i ? ",\n    {\"without\": " : "\n    {\"without\": ");
		text_put_json(out, x->line == SAVING_FULL ? "the scene" : x->line == SAVING_SCENE ? "" : text_string(&option));
		if (x->is_known)
			text_printf(out, ", \"flops\": %ld, \"alive\": %d, \"bytes\": %d, \"floor_ps\": %.1f}", x->flops, x->alive, x->bytes,
				floor_ps(x));
		else
			text_put(out, ", \"flops\": null, \"alive\": null, \"bytes\": null, \"floor_ps\": null}");
	}
	text_put(out, "\n  ],\n");
}
