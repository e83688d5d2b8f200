/* Names that would break out of the comment or string that holds them: beside comments and strings the text is the same
   as with harmless ones, and the table NAME_info holds the name. */
#include "base/identifier.h"
#include "rneagen.h"
#include "support/generated.h"
#include "support/suite.h"
#include "base/text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct arena arena;

static void open_arena(void)
{
	arena_init(&arena, NULL);
}

static void close_arena(void)
{
	arena_free(&arena);
}

static struct rneagen_result generate(const char *urdf, enum rneagen_target target, const char *name)
{
	struct rneagen_options o = rneagen_options_default();

	o.target = target;
	o.name = name;
	return generated(urdf, &o);
}

static const char *const hostile[] = {"*/ evil(); /*", "*/", "/*", "//", "\"", "\"; evil(); \"", "\\", "\\\\", "a\\\nb",
	"\\n", "\n", "\r", "\t", "a\nb", "\n#error\n", "?" "?/", "?" "?'", "?" "?/\n", "\xc3\xa9", "\xe9\x96\xa2",
	"\xf0\x9f\xa4\x96", "\xc2\x85", "\xe2\x80\xa8", "\x7f", "%s%n%d", "%", "@NAME@", "@BODY@", "@", "'", "a'b",
	"\\x41", "\\101", "\\u0041", "#define x", "<b>&amp;", "0", " ", "-->", "]]>", "R\"(", "__LINE__", "r_rnea",
	"tau", "\\\"", "\"\\"};

static void put_attribute(struct text *t, const char *key, const char *value, const char *suffix)
{
	text_printf(t, " %s=\"", key);
	for (; *value; value++)
		if (strchr("&<>\"'", *value) || (unsigned char)*value < 0x20)
			text_printf(t, "&#%d;", *value);
		else
			text_putc(t, *value);
	text_printf(t, "%s\"", suffix);
}

/* base - joint - link - follower - link, with an axis that is warned of. */
static const char *named_robot(const char *name)
{
	static const char *const suffixes[] = {"", "1", "2"};
	struct text t;

	text_init(&t, &arena);
	text_put(&t, "<robot");
	put_attribute(&t, "name", name, "");
	text_put(&t, ">");
	for (int i = 0; i < 3; i++) {
		text_put(&t, "<link");
		put_attribute(&t, "name", name, suffixes[i]);
		text_put(&t, "><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>");
	}
	for (int i = 1; i < 3; i++) {
		text_put(&t, "<joint type='continuous'");
		put_attribute(&t, "name", name, suffixes[i]);
		text_put(&t, "><parent");
		put_attribute(&t, "link", name, suffixes[i - 1]);
		text_put(&t, "/><child");
		put_attribute(&t, "link", name, suffixes[i]);
		text_put(&t, "/><origin xyz='0 1 0'/><axis xyz='0 0 3'/>");
		if (i == 2) {
			text_put(&t, "<mimic");
			put_attribute(&t, "joint", name, "1");
			text_put(&t, "/>");
		}
		text_put(&t, "</joint>");
	}
	text_put(&t, "</robot>");
	return text_string(&t);
}

/* The length of the comment or string at s; 0 if there is code. */
static size_t comment_or_string(const char *s)
{
	const char *end = s;

	if (!strncmp(s, "/*", 2)) {
		end = strstr(s + 2, "*/");
		ck_assert_msg(end != NULL, "a comment without an end: %.40s", s);
		for (const char *in = s + 2; in < end; in++)
			ck_assert_msg(strncmp(in, "/*", 2) && strncmp(in, "\\\n", 2), "in a comment: %.60s", in);
		return (size_t)(end - s) + 2;
	}
	if (!strncmp(s, "//", 2))
		return strcspn(s, "\n");
	if (*s != '"')
		return 0;
	for (end++; *end != '"'; end++) {
		ck_assert_msg(*end && *end != '\n', "a string without an end: %.40s", s);
		end += *end == '\\';
	}
	return (size_t)(end - s) + 1;
}

/* What a compiler sees beside comments and strings, without the number of a header's guard, which is the head's. */
static const char *code_of(const char *s, const char *what)
{
	struct text t;

	for (const char *b = s; *b; b++) {
		if (*b != '?' && ((*b >= ' ' && *b <= '~') || *b == '\n' || *b == '\t'))
			continue;
		ck_assert_msg((*b >= ' ' && *b <= '~') || *b == '\n' || *b == '\t', "%s: byte %d", what, (unsigned char)*b);
		ck_assert_msg(strncmp(b, "?" "?", 2) || !strchr("=/'()!<>-", b[2]), "%s: a trigraph", what);
	}
	text_init(&t, &arena);
	while (*s) {
		size_t n = !strncmp(s, "_RNEA_H ", 8) ? strcspn(s, "\n") : comment_or_string(s);

		text_put(&t, n ? " " : "");
		if (!n)
			text_putc(&t, *s++);
		s += n;
	}
	return text_string(&t);
}

/* The value of all string literals, one after the other. */
static const char *strings_of(const char *s)
{
	struct text t;

	text_init(&t, &arena);
	while (*s) {
		size_t n = comment_or_string(s);

		for (size_t i = 1; *s == '"' && i + 1 < n; i++) {
			if (s[i] != '\\') {
				text_putc(&t, s[i]);
			} else if (s[i + 1] >= '0' && s[i + 1] <= '7') {
				text_putc(&t, (char)((s[i + 1] - '0') * 64 + (s[i + 2] - '0') * 8 + s[i + 3] - '0'));
				i += 3;
			} else {
				i++;
				text_putc(&t, s[i] == 'n' ? '\n' : s[i]);
			}
		}
		s += n ? n : 1;
	}
	return text_string(&t);
}

static void check_same(const char *got, const char *want, const char *name)
{
	int line = 1;

	for (const char *s = got, *t = want; *s && *s == *t; s++, t++)
		line += *s == '\n';
	ck_assert_msg(!strcmp(got, want), "'%s': line %d of the code differs", name, line);
}

static void check_table(const char *source, const char *name)
{
	char want[256];

	snprintf(want, sizeof want, " continuous %s1\n", name);
	for (char *c = want; c[1]; c++)
		*c = (unsigned char)*c < 0x20 ? '?' : *c;
	ck_assert_msg(strstr(strings_of(source), want) != NULL, "'%s' is not in the table", name);
}

static void check_hostile(const char *name, enum rneagen_target target)
{
	struct rneagen_result plain = generate(named_robot("plain"), target, "r"), odd = generate(named_robot(name), target, "r");

	check_same(code_of(odd.source, name), code_of(plain.source, "plain"), name);
	if (odd.header)
		check_same(code_of(odd.header, name), code_of(plain.header, "plain"), name);
	if (target != RNEAGEN_TARGET_HEADER)
		check_table(odd.source, name);
	rneagen_result_free(&plain);
	rneagen_result_free(&odd);
}

START_TEST(hostile_name)
{
	struct rneagen_result r = generate(named_robot(hostile[_i]), RNEAGEN_TARGET_C, NULL);

	ck_assert_msg(identifier_is(r.name), "%s from '%s'", r.name, hostile[_i]);
	rneagen_result_free(&r);
	check_hostile(hostile[_i], RNEAGEN_TARGET_C);
	if (_i < 4) {
		check_hostile(hostile[_i], RNEAGEN_TARGET_CUDA);
		check_hostile(hostile[_i], RNEAGEN_TARGET_HEADER);
	}
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("hostile names");
	TCase *c = tcase_create("names");

	tcase_set_timeout(c, 60);
	tcase_add_checked_fixture(c, open_arena, close_arena);
	tcase_add_loop_test(c, hostile_name, 0, sizeof hostile / sizeof *hostile);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
