#include "test_escape.h"
#include "base/arena.h"
#include "base/text.h"

START_TEST(escapes)
{
	static const struct {
		const char *s, *comment, *json;
	} rows[] = {
		{"", "", "\"\""},
		{"joint_1.a-b c", "joint_1.a-b c", "\"joint_1.a-b c\""},
		{"*/ evil(); /*", "*\\x2f evil(); \\x2f*", "\"*/ evil(); /*\""},
		{"a\nb\rc\td", "a\\x0ab\\x0dc\\x09d", "\"a\\u000ab\\u000dc\\u0009d\""},
		{"\"\\\"", "\"\\x5c\"", "\"\\\"\\\\\\\"\""},
		{"line\\", "line\\x5c", "\"line\\\\\""}, /* would continue a line comment */
		{"?\?/", "\\x3f\\x3f\\x2f", "\"?\?/\""}, /* a trigraph backslash */
		{"\x7f\x01", "\\x7f\\x01", "\"\\u007f\\u0001\""},
		{"\xc3\xa9", "\\xc3\\xa9", "\"\xc3\xa9\""},
	};

	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct text comment, json;
		struct arena a;

		arena_init(&a, NULL);
		text_init(&comment, &a);
		text_init(&json, &a);
		text_put_comment(&comment, rows[i].s);
		text_put_json(&json, rows[i].s);
		ck_assert_str_eq(text_string(&comment), rows[i].comment);
		ck_assert_str_eq(text_string(&json), rows[i].json);
		arena_free(&a);
	}
}
END_TEST

/* No byte that could end a comment or a line comes through. */
START_TEST(no_byte_leaves_a_comment)
{
	for (int c = 1; c < 256; c++) {
		const char s[] = {'*', (char)c, '\0'};
		struct arena a;
		struct text t;

		arena_init(&a, NULL);
		text_init(&t, &a);
		text_put_comment(&t, s);
		for (const char *p = text_string(&t); *p; p++)
			ck_assert(*p >= 0x20 && *p < 0x7f && *p != '/' && *p != '?');
		arena_free(&a);
	}
}
END_TEST

TCase *escape_case(void)
{
	TCase *tc = tcase_create("escapes");

	tcase_set_timeout(tc, 60);
	tcase_add_test(tc, escapes);
	tcase_add_test(tc, no_byte_leaves_a_comment);
	return tc;
}
