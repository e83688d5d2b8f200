#include "drawing.h"
#include <string.h>

static const char *draw_number(struct dice *d)
{
	if (dice_happen(d, 64))
		return DICE_WORD(d, "1e300", "-1e300", "1e-300", "5e-324", "1e999", "nan", "0x10", "1,5", "+-1", "1e");
	return DICE_WORD(d, "0", "0.5", "-1.25", "1.5708", "3.14159265358979", "1e-3", "2", "1e-9", "0.1", "-0", "+.5", "100");
}

void drawing_numbers(struct drawing *g, struct text *t, int count, int has_quaternion)
{
	for (int i = 0; i < count; i++) {
		static const char *const quaternions[2][4] = {{"0", "0", "0", "1"}, {"0.6", "0", "-0.8", "0"}};
		const char *number = has_quaternion && i >= 3 ? quaternions[count % 2][i - 3] : draw_number(g->d);

		text_printf(t, "%s%s", i ? "," : "", number);
	}
}

static int is_used(const struct drawing *g, const char *name)
{
	const char *used = text_string(&g->used);
	size_t n = strlen(name);

	for (const char *s = used; (s = strstr(s, name)) != NULL; s++)
		if ((s == used || s[-1] == '\1') && s[n] == '\1')
			return 1;
	return 0;
}

int drawing_is_new(struct drawing *g, const char *kind, const char *name)
{
	struct text t;

	text_init(&t, g->a);
	text_printf(&t, "%s %s", kind, name);
	if (is_used(g, text_string(&t)) && !dice_happen(g->d, 64))
		return 0;
	text_put(&g->used, text_string(&t));
	text_putc(&g->used, '\1');
	return 1;
}

static int needs_quotes(const char *value)
{
	size_t n = strlen(value);

	return n && (*value == '"' || strchr(value, '#') || strpbrk(value, "\n\r\t") || *value == ' ' || value[n - 1] == ' ');
}

void drawing_line(struct drawing *g, enum scene_key key, const char *value)
{
	int is_option = dice_happen(g->d, 8);
	struct text *t = &g->out;

	text_printf(t, "%s%s", is_option ? "--" : "", scene_word(key));
	if (value && (is_option || needs_quotes(value) || dice_happen(g->d, 16))) {
		text_put(t, " \"");
		for (const char *s = value; *s; s++)
			text_printf(t, *s == '"' || *s == '\\' ? "\\%c" : *s == '\n' ? "\\n" : "%c", *s);
		text_putc(t, '"');
	} else if (value) {
		text_printf(t, "%s%s", dice_happen(g->d, 16) ? "\t " : " ", value);
	}
	if (dice_happen(g->d, 16))
		text_put(t, DICE_WORD(g->d, " # a comment", "\r", "  ", "\n\n# a line\n"));
	text_putc(t, '\n');
}

struct text drawing_text(struct drawing *g)
{
	struct text t;

	text_init(&t, g->a);
	return t;
}
