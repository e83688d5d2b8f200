#include "emit/columns/segment_zeros.h"
#include "emit/emit_groups.h"

/* gcc 12 takes 1.4 s for 60 zeros among lines, 7 for 110, 21 for 160, and more than 13 minutes for 217: tau and regressor of
   floating panda. */
enum { FEWEST = 32 };

struct segment_zeros segment_zeros_of(const struct emission *e, const struct function *p, const struct plan *lines)
{
	struct segment_zeros z = {.dag = lines->dag,
		.outputs = arena_alloc(e->arena, lines->line_count, sizeof *z.outputs)};

	for (const struct line *l = lines->lines; z.outputs && l < lines->lines + lines->line_count; l++)
		if (emit_is_zero_store(lines, l))
			z.outputs[z.count++] = lines->dag->outputs[l->index];
	if (z.count < FEWEST || p->dag.loop_count) /* loops over columns have other arrays, and zeros of their own */
		z.count = 0;
	return z;
}

void segment_zeros_put(const struct emission *e, const struct function *p, const struct segment_zeros *z, struct text *out)
{
	struct text runs;

	for (int i = 0; i < p->dag.argument_count && z->count; i++) {
		const char *name = p->dag.arguments[i].name;
		int n = emit_zero_runs(e, z->dag, z->outputs, z->count, i, &runs);

		if (!n)
			continue;
		text_printf(out, "\tstatic const unsigned rneagen_zeros_%s[%d][2] = {%s};\n", name, n, text_string(&runs));
		text_printf(out, "\tfor (int rneagen_run = 0; rneagen_run < %d; rneagen_run++) {\n", n);
		text_printf(out, "\t\tconst unsigned *const rneagen_rows = rneagen_zeros_%s[rneagen_run];\n", name);
		text_put(out, "\t\tfor (unsigned rneagen_row = *rneagen_rows; rneagen_row < *rneagen_rows + rneagen_rows[1]; rneagen_row++)\n");
		text_printf(out, "\t\t\tfor (unsigned l = 0; l < lanes; l++)\n\t\t\t\tfirst_%s[rneagen_row*stride + l", name);
		if (emit_groups_layout(e, p) == RNEAGEN_AOS)
			text_printf(out, "*%d", p->dag.arguments[i].rows);
		text_put(out, "] = 0;\n\t}\n");
	}
}

static int has_argument(const struct segment_zeros *z, int argument)
{
	for (size_t k = 0; k < z->count; k++)
		if (z->outputs[k].argument == argument)
			return 1;
	return 0;
}

void segment_zeros_put_unused(const struct function *p, const struct segment_zeros *z, struct text *out)
{
	for (int i = 0; i < p->dag.argument_count; i++)
		if (has_argument(z, i))
			text_printf(out, "\t(void)%s;\n", p->dag.arguments[i].name);
}
