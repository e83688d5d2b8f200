/* A scene's text: its lines, lists, quotes and comments, the options that repeat it, and the name that was meant. */
#include "base/nearest.h"
#include "support/read.h"
#include "scene/scene.h"
#include "support/suite.h"
#include "support/urdf_text.h"
#include <string.h>

static const char robot[] = ROBOT("robot", BALL("base") BALL("hand") BALL("head") BALL("a,b")
	JOINT("elbow", "continuous", "base", "hand", "") JOINT("neck", "continuous", "base", "head", "")
		JOINT("x=y,z", "continuous", "base", "a,b", ""));

START_TEST(repeats_itself)
{
	static const char text[] = "tip a,b , head\nlock grip=0.5\nfree mass.hand:batch\nfree gravity\nfriction\nfriction-x";
	static const char *const options[] = {
		"--tip 'a,b , head'", "--lock grip=0.5", "--free mass.hand:batch", "--free gravity", "--friction"};
	struct arena a;
	struct scene s;
	struct rneagen_error e = {0};
	char *last;

	arena_init(&a, NULL);
	last = arena_string(&a, text, strlen(text) - strlen("\nfriction-x"));
	ck_assert_int_eq(scene_read(&s, last, "here", &a, &e), RNEAGEN_OK);
	ck_assert_int_eq(s.line_count, 5);
	ck_assert_ptr_null(s.lines[3].value);
	for (int i = 0; i < s.line_count; i++) {
		struct text t;

		text_init(&t, &a);
		scene_put_option(&s.lines[i], &t);
		ck_assert_str_eq(text_string(&t), options[i]);
	}
	ck_assert_int_eq(scene_read(&s, "friction 0.5\nlock it's=1", "here", &a, &e), RNEAGEN_OK);
	arena_free(&a);
}
END_TEST

/* By commas, unless all of it is one name. */
START_TEST(lists)
{
	static const char text[] = "want gravity,wrench.elbow, tau\nwant wrench.x=y,z\nfext a,b\nfext hand,head\nwant tau,power\n"
				   "free gravity:sample,mass.hand , offset.elbow:batch\nfree mass.a,b:batch\nfree offset.x=y,z";
	static const char *const names[] = {"gravity", "wrench.elbow", "tau", "wrench.x=y,z", "a,b", "hand",
		"head", "tau", "power", "gravity", "mass.hand", "offset.elbow", "mass.a,b", "offset.x=y,z"};
	static const char *const values[] = {"sample", NULL, "batch", "batch", NULL};
	enum { FREED = 9 };
	struct read r;
	struct scene s;

	read_memory(&r, robot, sizeof robot - 1, "here");
	ck_assert(!scene_read(&s, text, "here", &r.arena, &r.error) && !scene_expand(&s, &r.robot, &r.arena, &r.error));
	ck_assert_int_eq(s.count, sizeof names / sizeof *names);
	for (int i = 0; i < s.count; i++)
		ck_assert_str_eq(s.choices[i].name, names[i]);
	for (int i = 0; i < s.count - FREED; i++)
		ck_assert_pstr_eq(s.choices[FREED + i].value, values[i]);
	read_free(&r);
}
END_TEST

/* Between quotes there are no comments; lines with dashes are options, and not counted. */
START_TEST(quotes)
{
	static const char text[] = "lock \"#1 \\\"left\\\" \\\\ \\x=0.5\"# c\n--tip \"a #b,#c\"\nroot \" d \"\t#\nfriction \"\"";
	static const struct {
		const char *name, *value;
		int line, told;
	} lines[] = {{"#1 \"left\" \\ \\x", "0.5", 1, 1}, {"a #b,#c", NULL, 2, 0}, {" d ", NULL, 3, 2}, {"", NULL, 4, 3}};
	struct arena a;
	struct scene s;
	struct rneagen_error e = {0};

	arena_init(&a, NULL);
	ck_assert_msg(!scene_read(&s, text, "here", &a, &e), "%s", e.message);
	ck_assert_int_eq(s.line_count, 4);
	for (int i = 0; i < 4; i++) {
		ck_assert_str_eq(s.lines[i].name, lines[i].name);
		ck_assert_pstr_eq(s.lines[i].value, lines[i].value);
		ck_assert_int_eq(s.lines[i].line, lines[i].line);
		ck_assert_int_eq(s.lines[i].told, lines[i].told);
	}
	arena_free(&a);
}
END_TEST

START_TEST(nearest)
{
	static const char *const names[] = {"elbow", "elbow_2", "shoulder", "wrist", "ab"};
	static const struct {
		const char *word, *found;
	} words[] = {{"elbo", "elbow"}, {"elbow_3", "elbow_2"}, {"leblow", "elbow"}, {"wrsit", "wrist"},
		{"shuolder_", "shoulder"},
		{"finger", NULL}, {"Wrist", "wrist"}, {"ba", "ab"},
		{"should", "shoulder"}, {"ow_2", "elbow_2"}, {"left_shoulder_pitch", "shoulder"}, {"left_elbow_2_link", "elbow_2"}};
	char longer[600];

	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		const char *found = nearest_name(words[i].word, names, 5, sizeof *names);

		ck_assert_msg(found == words[i].found || (found && words[i].found && !strcmp(found, words[i].found)), "%s: %s",
			words[i].word, found ? found : "none");
	}
	memset(longer, 'x', sizeof longer - 1);
	longer[sizeof longer - 1] = '\0';
	ck_assert_ptr_null(nearest_name(longer, names, 5, sizeof *names));
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("scene_read");
	TCase *c = tcase_create("scene_read");

	tcase_add_test(c, repeats_itself);
	tcase_add_test(c, lists);
	tcase_add_test(c, quotes);
	tcase_add_test(c, nearest);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
