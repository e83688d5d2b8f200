#include "scene_grammar.h"
#include "base/text.h"
#include <string.h>

const char *scene_garble(struct dice *d, const char *s, struct arena *a)
{
	size_t n = strlen(s), at = dice_below(d, n + 1);
	const char *line;
	struct text t;

	text_init(&t, a);
	text_putn(&t, s, at);
	switch (dice_below(d, 4)) {
	case 0:
		text_putc(&t, (char)(1 + dice_below(d, 255)));
		text_put(&t, s + (at < n ? at + 1 : at));
		break;
	case 1:
		line = strchr(s + at, '\n');
		text_put(&t, line ? line + 1 : "");
		break;
	case 2:
		text_put(&t, s + at);
		text_put(&t, s);
		break;
	default:
		text_put(&t, DICE_WORD(d, "=", ",", "\"", "\\", "#", " #", "\n", ".", ":batch", "root ", "lock ",
				     "\xc3\xa9", "*/", "%s", "1e999"));
		text_put(&t, s + at);
	}
	return t.failed ? NULL : text_string(&t);
}
