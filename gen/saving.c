#include "saving.h"
#include "analysis.h"
#include "keep.h"
#include "plan.h"
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
		if (!analysis_dag(&d, &t, o->strict, &a) || !plan_build(&p, &d, &t, &a)) {
			error_memory(e);
		} else {
			x->is_known = 1;
			x->flops = analysis_flops(&d, &t, &a);
			x->alive = plan_alive(&p, &a);
			x->bytes = bytes_of(&d, o);
		}
	} else if (refused.code == RNEAGEN_MEMORY) {
		error_memory(e);
	}
	if (a.failed)
		error_memory(e);
	arena_free(&a);
	return e->code;
}

/* The text of a scene without its line of this number, from 1. */
static const char *without_line(const char *scene, int line, struct arena *a)
{
	const char *begin = scene, *end;
	struct text t;

	for (int i = 1; i < line; i++)
		begin = strchr(begin, '\n') + 1;
	end = strchr(begin, '\n');
	text_init(&t, a);
	for (const char *s = scene; s < begin; s++)
		text_putc(&t, *s);
	text_put(&t, end ? end + 1 : "");
	return text_string(&t);
}

static enum rneagen_code add(struct tree *t, int line, const char *scene, const struct robot *r, const struct rneagen_options *o,
	struct rneagen_error *e)
{
	struct saving *x = &t->savings[t->saving_count++];
	struct rneagen_options other = *o;

	other.scene = scene;
	x->line = line;
	if (line == SAVING_FULL)
		other.order = NULL; /* it need not name what the scene leaves out */
	return count(x, r, &other, e);
}

enum rneagen_code saving_measure(
	struct tree *t, const struct robot *r, const struct rneagen_options *o, struct arena *a, struct rneagen_error *e)
{
	int lines = t->scene.line_count;

	if (!lines)
		return RNEAGEN_OK;
	t->savings = arena_alloc(a, (size_t)lines + 2, sizeof *t->savings);
	if (!t->savings)
		return error_memory(e);
	if (add(t, SAVING_FULL, NULL, r, o, e) || add(t, SAVING_SCENE, o->scene, r, o, e))
		return e->code;
	for (int i = 0; i < lines && lines > 1 && lines <= MOST_LINES; i++)
		if (add(t, i, without_line(o->scene, t->scene.lines[i].line, a), r, o, e))
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
