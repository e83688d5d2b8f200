#include "tell/saving.h"
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

/* Of another scene of the robot; by the URDF's constants, or as the scene says. */
static enum rneagen_code count(struct saving *x, const struct analysis *of, const struct rneagen_options *o, int by_urdf)
{
	struct rneagen_error refused = {0};
	struct arena spare;
	struct analysis other;
	struct plan p;

	arena_init(&spare, o->allocator);
	analysis_copy(&other, of, &spare, &refused);
	other.options = *o;
	other.params = (struct params_choice){.is_left = by_urdf};
	if (!analysis_run(&other, PASS_SCENE_PARSE, PASS_DAG_FUSE)) {
		if (plan_build(&p, &other.dag, &other.tree, &spare))
			note(x, &p, o, &spare);
	}
	if (spare.failed || refused.code == RNEAGEN_MEMORY)
		error_memory(of->error);
	arena_free(&spare);
	return of->error->code;
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
static enum rneagen_code add_without(struct savings *s, const struct analysis *a, int index)
{
	struct saving *x = &s->of[s->count++];
	struct rneagen_options other = a->options;

	x->line = index;
	for (int ranges = 1; ranges >= 0 && !x->is_known && !a->error->code; ranges--) {
		other.scene = without(&a->scene, a->options.scene, index, ranges, a->arena);
		if (a->arena->failed || (!ranges && !scene_next(&a->scene, SCENE_RANGE, NULL)))
			break;
		count(x, a, &other, !a->params.is_base && a->scene.lines[index].key != SCENE_PARAMS);
	}
	return a->arena->failed ? error_memory(a->error) : a->error->code;
}

static enum rneagen_code add_full(struct savings *s, const struct analysis *a)
{
	struct saving *x = &s->of[s->count++];
	struct rneagen_options other = a->options;

	other.scene = NULL;
	other.order = NULL; /* it need not name what the scene leaves out */
	x->line = SAVING_FULL;
	return count(x, a, &other, !a->params.is_base);
}

/* Not of ranges, nor of the URDF's constants, which save nothing. */
static int is_listed(const struct scene_choice *c)
{
	return c->key != SCENE_RANGE && (c->key != SCENE_PARAMS || strcmp(c->value, "urdf"));
}

enum rneagen_code saving_measure(struct savings *x, const struct analysis *a, const struct plan *now)
{
	int lines = scene_choice_count(&a->scene);

	*x = (struct savings){.of = arena_alloc(a->arena, (size_t)lines + 2, sizeof *x->of)};
	if (!x->of)
		return error_memory(a->error);
	if (!lines)
		return RNEAGEN_OK;
	if (add_full(x, a))
		return a->error->code;
	x->of[x->count].line = SAVING_SCENE;
	note(&x->of[x->count++], now, &a->options, a->arena);
	for (int i = 0; i < a->scene.line_count && lines > 1 && lines <= MOST_LINES; i++)
		if (is_listed(&a->scene.lines[i]) && add_without(x, a, i))
			return a->error->code;
	return a->arena->failed ? error_memory(a->error) : RNEAGEN_OK;
}

/* ---- telling ---- */

static double floor_ps(const struct saving *x)
{
	return x->bytes / SAVING_BANDWIDTH * 1e12;
}

void saving_put_table(const struct savings *all, const struct scene *s, struct text *out)
{
	if (!all->count)
		return;
	text_put(out, "\nof a sample        flops   alive   bytes   ps at 3 TB/s\n");
	for (int i = 0; i < all->count; i++) {
		const struct saving *x = &all->of[i];

		text_put(out, x->line == SAVING_FULL ? "  full model  " : x->line == SAVING_SCENE ? "  this scene  "
			: "  without it  ");
		if (x->is_known)
			text_printf(out, "%10ld %7d %7d %14.1f", x->flops, x->alive, x->bytes, floor_ps(x));
		else
			text_printf(out, "%10s %7s %7s %14s", "-", "-", "-", "-");
		if (x->line >= 0) {
			text_put(out, "   ");
			scene_put_option(&s->lines[x->line], out);
		}
		text_putc(out, '\n');
	}
}

void saving_put_json(const struct savings *all, const struct scene *s, struct text *out)
{
	struct text option;

	if (!all->count)
		return;
	text_put(out, "  \"savings\": [");
	for (int i = 0; i < all->count; i++) {
		const struct saving *x = &all->of[i];

		text_init(&option, out->arena);
		if (x->line >= 0)
			scene_put_option(&s->lines[x->line], &option);
		out->failed |= option.failed;
		text_put(out, i ? ",\n    {\"without\": " : "\n    {\"without\": ");
		text_put_json(out, x->line == SAVING_FULL ? "the scene" : x->line == SAVING_SCENE ? "" : text_string(&option));
		if (x->is_known)
			text_printf(out, ", \"flops\": %ld, \"alive\": %d, \"bytes\": %d, \"floor_ps\": %.1f}", x->flops,
				x->alive, x->bytes, floor_ps(x));
		else
			text_put(out, ", \"flops\": null, \"alive\": null, \"bytes\": null, \"floor_ps\": null}");
	}
	text_put(out, "\n  ],\n");
}
