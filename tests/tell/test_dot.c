/* The graph of --dot. Without arguments: its text. With Graphviz' dot as the argument: every own robot is drawn, and
   each node and edge of the drawing carries the name that the URDF gives it; 77 (skipped) when that is no program. */
#define _POSIX_C_SOURCE 200809L
#include "tell/dot.h"
#include "support/merged.h"
#include "support/read.h"
#include "support/suite.h"
#include <expat.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SKIPPED = 77 };

static const char *graphviz;

/* A robot, its tree and the graph of it. */
struct drawn {
	struct read from;
	struct tree tree;
	struct text dot;
};

static void draw(struct drawn *d, enum rneagen_base base, enum rneagen_mimic mimic)
{
	struct rneagen_options o = rneagen_options_default();
	struct arena *a = &d->from.arena;
	struct request k;

	ck_assert_msg(d->from.error.code == RNEAGEN_OK, "%s", d->from.error.message);
	o.base = base;
	o.mimic = mimic;
	text_init(&d->dot, a);
	if (merged_tree(&d->tree, &k, &d->from.robot, &o, a, &d->from.error) == RNEAGEN_OK)
		dot_graph(&d->tree, &d->dot);
	ck_assert(!d->dot.failed);
}

static int lacks(const struct drawn *d, const char *part)
{
	return !strstr(text_string(&d->dot), part);
}

START_TEST(golden)
{
	static const char *const names[] = {"mimic_chain", "planar_tilted"};

	for (int i = 0; i < 2; i++) {
		char name[64], *expected;
		size_t length;
		struct drawn d;

		snprintf(name, sizeof name, "%s.urdf", names[i]);
		read_robot(&d.from, TEST_DIR "/robots", name);
		draw(&d, RNEAGEN_FIXED, RNEAGEN_MIMIC_HONOUR);
		snprintf(name, sizeof name, "%s.dot", names[i]);
		expected = read_text(TEST_DIR "/golden", name, &length);
		ck_assert_str_eq(text_string(&d.dot), expected);
		free(expected);
		read_free(&d.from);
	}
}
END_TEST

START_TEST(base_and_followers)
{
	struct drawn d;

	read_robot(&d.from, TEST_DIR "/robots", "mimic_chain.urdf");
	draw(&d, RNEAGEN_FLOATING, RNEAGEN_MIMIC_INDEPENDENT);
	ck_assert(lacks(&d, "world"));
	ck_assert(lacks(&d, "dashed"));
	ck_assert(!lacks(&d, "\tb0 [peripheries=2, label=\"frame\\nbody 0, floating base\\nq[0..6]\\n"));
	ck_assert(!lacks(&d, "\tb0 -> b1 [label=\"gear\\nrevolute q[7]\\naxis 0 1 0\"];\n"));
	read_free(&d.from);
}
END_TEST

#define LINK(name) "<link name='" name "'/>"
#define JOINT(name, parent, child)                                                                                     \
	"<joint name='" name "' type='continuous'><parent link='" parent "'/><child link='" child                      \
	"'/><axis xyz='0 -1 0'/>"                                                                                      \
	"</joint>"

/* Names that Graphviz would resolve, or that would end its string. */
static const char hostile[] = "<robot name='\\G \"graph\"'>" LINK("base") LINK("line&#10;two&#13;&#9;") LINK("\\N\\")
	LINK("\";}") LINK("&lt;b&gt;&amp;lt;") LINK("#&#127;\xc3\xa9") JOINT("\\E", "base", "line&#10;two&#13;&#9;")
		JOINT("\\\"", "base", "\\N\\") JOINT("-- {", "base", "\";}")
			JOINT("&lt;TABLE&gt;", "base", "&lt;b&gt;&amp;lt;")
				JOINT("&amp;#65;", "base", "#&#127;\xc3\xa9") "</robot>";

START_TEST(labels_are_escaped)
{
	static const char *const parts[] = {"\"\\\\G \\\"graph\\\"\"", "label=\"line\\\\x0atwo\\\\x0d\\\\x09\\n",
		"label=\"\\\\N\\\\\\n", "label=\"\\\";}\\n", "label=\"<b>&amp;lt;\\n", "label=\"#\\\\x7f\xc3\xa9\\n",
		"label=\"\\\\E\\n", "label=\"\\\\\\\"\\n", "label=\"-- {\\n", "label=\"<TABLE>\\n",
		"label=\"&amp;#65;\\n"};
	struct drawn d;

	read_memory(&d.from, hostile, strlen(hostile), "hostile");
	draw(&d, RNEAGEN_FIXED, RNEAGEN_MIMIC_HONOUR);
	for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
		ck_assert_msg(!lacks(&d, parts[i]), "no %s in\n%s", parts[i], text_string(&d.dot));
	read_free(&d.from);
}
END_TEST

/* ---- what Graphviz makes of it ---- */

/* Walks over the SVG: a <g> per node and edge, its <title> "b1" or "b1->b2", then one <text> per line of the label;
   dashed edges have none. */
struct drawing {
	const struct drawn *from;
	char title[64], line[2048];
	char *into; /* where characters go; NULL: nowhere */
	size_t room;
	int lines, nodes, edges, joints;
};

static void svg_start(void *user, const XML_Char *element, const XML_Char **attributes)
{
	struct drawing *s = user;

	(void)attributes;
	if (!strcmp(element, "title")) {
		s->into = s->title;
		s->room = sizeof s->title - 1;
		s->lines = 0;
	} else if (!strcmp(element, "text")) {
		s->into = s->line;
		s->room = sizeof s->line - 1;
	} else {
		return;
	}
	*s->into = '\0';
}

static void svg_characters(void *user, const XML_Char *text, int length)
{
	struct drawing *s = user;

	for (int i = 0; i < length && s->into && s->room; i++) {
		if (text[i] == '\xa0' && s->into[-1] == '\xc2') { /* spaces come as U+00A0 */
			s->into[-1] = ' ';
			s->into[0] = '\0';
			continue;
		}
		*s->into++ = text[i];
		*s->into = '\0';
		s->room--;
	}
}

/* The name as it should be read: control characters as \xHH. */
static void shown(char *out, const char *name)
{
	for (; *name; name++)
		out += sprintf(
			out, (unsigned char)*name < 0x20 || *name == 0x7f ? "\\x%02x" : "%c", (unsigned char)*name);
	*out = '\0';
}

static const struct body *find_body(const struct tree *t, int number)
{
	for (int k = 0; k < t->body_count; k++)
		if (t->bodies[k].number == number)
			return &t->bodies[k];
	ck_abort_msg("no body %d", number);
	return NULL;
}

/* The first line of a label. */
static void check_name(struct drawing *s)
{
	const struct tree *t = &s->from->tree;
	const char *arrow = strstr(s->title, "->"), *name;
	char expected[4 * LIMIT_NAME_BYTES + 1];

	if (!strcmp(s->title, "robot")) {
		name = t->robot;
	} else if (!arrow) {
		name = strcmp(s->title, "world") ? find_body(t, atoi(s->title + 1))->link : t->root;
		s->nodes++;
	} else {
		name = find_body(t, atoi(arrow + 3))->joint;
		s->joints++;
	}
	shown(expected, name);
	ck_assert_str_eq(s->line, expected);
}

static void svg_end(void *user, const XML_Char *element)
{
	struct drawing *s = user;

	if (!strcmp(element, "text") && s->lines++ == 0)
		check_name(s);
	s->edges += !strcmp(element, "title") && strstr(s->title, "->");
	s->into = NULL;
}

static char *make_svg(const char *dot, size_t *length)
{
	char path[] = "/tmp/rneagen-dot-XXXXXX", command[2048];
	char *svg = calloc(1, 1 << 20);
	int fd = mkstemp(path), status;
	FILE *p;

	ck_assert(svg && fd >= 0);
	ck_assert_int_eq(write(fd, dot, strlen(dot)), (long)strlen(dot));
	close(fd);
	snprintf(command, sizeof command, "'%s' -Tsvg %s 2>&1", graphviz, path);
	p = popen(command, "r");
	ck_assert_ptr_nonnull(p);
	*length = fread(svg, 1, 1 << 20, p);
	status = pclose(p);
	unlink(path);
	ck_assert_msg(status == 0, "dot fails: %.*s\n%s", (int)*length, svg, dot);
	return svg;
}

static void check_drawing(const struct drawn *d)
{
	struct drawing s = {.from = d};
	const struct tree *t = &d->tree;
	XML_Parser parser = XML_ParserCreate(NULL);
	size_t length;
	char *svg = make_svg(text_string(&d->dot), &length);

	XML_SetUserData(parser, &s);
	XML_SetElementHandler(parser, svg_start, svg_end);
	XML_SetCharacterDataHandler(parser, svg_characters);
	ck_assert_msg(XML_Parse(parser, svg, (int)length, 1) == XML_STATUS_OK, "not SVG: %.500s", svg);
	ck_assert_int_eq(s.nodes, t->body_count + !t->floating);
	ck_assert_int_eq(s.joints, t->body_count - t->floating);
	ck_assert_int_eq(s.edges, s.joints + t->mimic_count);
	XML_ParserFree(parser);
	free(svg);
}

static void check_directory(const char *directory)
{
	int count;
	char **names = names_list(directory, &count);

	ck_assert_int_gt(count, 0);
	for (int i = 0; i < 2 * count; i++) {
		struct drawn d;

		read_robot(&d.from, directory, names[i / 2]);
		if (d.from.error.code == RNEAGEN_OK) {
			draw(&d, i % 2 ? RNEAGEN_FLOATING : RNEAGEN_FIXED, RNEAGEN_MIMIC_HONOUR);
			if (d.from.error.code == RNEAGEN_OK)
				check_drawing(&d);
		}
		read_free(&d.from);
	}
	names_free(names);
}

START_TEST(own_robots)
{
	check_directory(TEST_DIR "/robots");
}
END_TEST

START_TEST(hostile_names)
{
	struct drawn d;

	read_memory(&d.from, hostile, strlen(hostile), "hostile");
	draw(&d, RNEAGEN_FIXED, RNEAGEN_MIMIC_HONOUR);
	check_drawing(&d);
	read_free(&d.from);
}
END_TEST

START_TEST(robots_from_outside)
{
	const char *directory = getenv("RNEAGEN_ROBOTS");

	if (directory && *directory)
		check_directory(directory);
	else
		printf("skipped: RNEAGEN_ROBOTS is not set\n");
}
END_TEST

static Suite *dot_suite(void)
{
	Suite *suite = suite_create("dot");
	TCase *tc = tcase_create(graphviz ? "graphviz" : "text");

	tcase_set_timeout(tc, 240);
	if (graphviz) {
		tcase_add_test(tc, hostile_names);
		tcase_add_test(tc, own_robots);
		tcase_add_test(tc, robots_from_outside);
	} else {
		tcase_add_test(tc, golden);
		tcase_add_test(tc, base_and_followers);
		tcase_add_test(tc, labels_are_escaped);
	}
	suite_add_tcase(suite, tc);
	return suite;
}

int main(int argc, char **argv)
{

	graphviz = argc > 1 ? argv[1] : NULL;
	if (graphviz && access(graphviz, X_OK)) {
		printf("skipped: Graphviz' dot is not installed\n");
		return SKIPPED;
	}
	return suite_run(dot_suite());
}
