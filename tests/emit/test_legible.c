/* What a reader needs of a text: lines that fit a page, blank ones apart, a legend that explains every name of the statements, no
   rows times zero or one; and --only rnea, which leaves out what is not the algorithm. Reads the texts as strings, and shares
   nothing with what wrote them. Every robot by every third variant in turn; under the sanitizers by every fifth. */
#include "rneagen.h"
#include "support/exhaustive.h"
#include "support/read.h"
#include "support/suite.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MARGIN = 120, TAB = 8 };

static const struct variant {
	enum rneagen_target target;
	enum rneagen_precision precision;
	enum rneagen_base base;
	int strict, bounded, aos, only;
	const char *scene;
} VARIANTS[] = {
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32, RNEAGEN_FIXED, 0, 0, 0, 0, NULL},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F64, RNEAGEN_FLOATING, 1, 0, 1, 0, NULL},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32X2, RNEAGEN_FIXED, 0, 0, 0, 1, NULL},
	{RNEAGEN_TARGET_CUDA, RNEAGEN_F32, RNEAGEN_FIXED, 0, 0, 0, 0, "want tau,M,dtau_dq"},
	{RNEAGEN_TARGET_C, RNEAGEN_F64, RNEAGEN_FIXED, 0, 1, 0, 0, NULL},
	{RNEAGEN_TARGET_C, RNEAGEN_MIXED, RNEAGEN_FLOATING, 0, 1, 1, 1, NULL},
	{RNEAGEN_TARGET_C, RNEAGEN_F32, RNEAGEN_FIXED, 1, 1, 0, 0, "want gravity,bias,tau,power,kinetic,potential\nfree gravity"},
	{RNEAGEN_TARGET_C, RNEAGEN_F32X2, RNEAGEN_FIXED, 0, 0, 0, 0, "want gravity"},
	{RNEAGEN_TARGET_HEADER, RNEAGEN_F64, RNEAGEN_FLOATING, 1, 0, 0, 0, NULL},
	{RNEAGEN_TARGET_HEADER, RNEAGEN_F32, RNEAGEN_FIXED, 0, 0, 0, 0, "want jvp,vjp\nfold gravity=0,0,0"},
};

/* Returns 0 where the robot does not take the scene. */
static int generate(const char *path, const struct variant *v, struct rneagen_result *result)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error error;
	size_t length;
	char *urdf = read_file(path, &length);
	int done;

	ck_assert_msg(urdf != NULL, "%s", path);
	o.target = v->target;
	o.precision = v->precision;
	o.base = v->base;
	o.strict = v->strict;
	o.bounded = v->bounded;
	o.only = v->only;
	o.layout = v->aos ? RNEAGEN_AOS : RNEAGEN_SOA;
	o.scene = v->scene;
	o.name = "r";
	o.file = path;
	done = !rneagen_generate(urdf, length, &o, result, &error);
	free(urdf);
	return done;
}

static void for_all(void (*f)(const char *path, const char *name, void *context), void *context)
{
	const char *more = getenv("RNEAGEN_ROBOTS");

	ck_assert_int_gt(for_each_urdf(TEST_DIR "/robots", f, context), 20);
	if (more)
		for_each_urdf(more, f, context);
	else
		printf("skipped: robots from outside: RNEAGEN_ROBOTS is not set\n");
}

/* ---- lines ---- */

/* One word alone may be wider, after what indents it. */
static int is_word(const char *s, size_t length)
{
	size_t i = strspn(s, " \t*\"");

	while (i < length && s[i] != ' ')
		i++;
	return i == length;
}

static void check_lines(const char *text, const char *what)
{
	const char *blank = strstr(text, "\n\n\n");

	ck_assert_msg(!blank, "%s: two blank lines before: %.80s", what, blank);
	for (const char *s = text; *s; s += strcspn(s, "\n"), s += *s == '\n') {
		size_t length = strcspn(s, "\n"), column = 0;

		for (size_t i = 0; i < length; i++)
			column = s[i] == '\t' ? (column / TAB + 1) * TAB : column + 1;
		ck_assert_msg(column <= MARGIN || is_word(s, length), "%s: %zu columns: %.*s", what, column, (int)length, s);
	}
}

/* ---- names ---- */

enum { WORDS = 96, WORD = 80 }; /* in a legend */

struct legend {
	char words[WORDS][WORD];
	int count;
};

static void add_word(struct legend *l, const char *s, size_t length)
{
	ck_assert(l->count < WORDS && length < WORD);
	memcpy(l->words[l->count], s, length);
	l->words[l->count++][length] = '\0';
}

/* The words before two blanks, of each line from "Names in the statements" to "In the formulas". */
static void read_legend(struct legend *l, const char *text)
{
	const char *s = strstr(text, "* Names in the statements"), *end = strstr(text, "* In the formulas");

	l->count = 0;
	ck_assert(s && end && s < end);
	for (s = strchr(s, '\n') + 1; s < end; s = strchr(s, '\n') + 1) {
		const char *word = s + strspn(s, " *");
		const char *stop = strstr(word, "  ");

		while (!strncmp(s, " *   ", 5) && stop && word < stop) {
			size_t length = strcspn(word, " ");

			add_word(l, word, length);
			word += length + 1;
		}
	}
}

static int has_word(const struct legend *l, const char *word)
{
	for (int i = 0; i < l->count; i++)
		if (!strcmp(l->words[i], word))
			return 1;
	return 0;
}

/* A word that ends in dots stands for all that begin as it does. */
static int has_beginning(const struct legend *l, const char *name)
{
	for (int i = 0; i < l->count; i++) {
		size_t n = strlen(l->words[i]);

		if (n > 3 && !strcmp(l->words[i] + n - 3, "...") && n - 3 < strlen(name) && !strncmp(name, l->words[i], n - 3))
			return 1;
	}
	return 0;
}

static int is_keyword(const char *name)
{
	static const char *const words[] = {"const", "float", "double", "int", "struct", "return", "void", "f", "static",
		"unsigned", "short", "for", "i", "fabs", "HUGE_VAL", "l", "lanes"}; /* of a segment: its samples */

	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (!strcmp(name, words[i]))
			return 1;
	return 0;
}

/* Of a floating or planar joint: what its rows are called. */
static int is_row_of_joint(const char *s)
{
	static const char *const rows[] = {"x", "y", "z", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz", "t"};

	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (!strcmp(s, rows[i]))
			return 1;
	return !*s;
}

/* An argument of the function; a segment has it at the first of its samples. */
static int is_argument(const char *name, const char *parameters)
{
	char plain[2 * WORD + 2], first[2 * WORD + 8];

	snprintf(plain, sizeof plain, "*%s,", name);
	snprintf(first, sizeof first, "*first_%s,", name);
	return strstr(parameters, plain) || strstr(parameters, first);
}

/* f9y_wide_2: f9y_2 of several limbs or coordinates. */
static const char *without_wide(const struct legend *l, const char *name, char *narrow, size_t size)
{
	const char *suffix = strstr(name, "_wide");

	if (!suffix || (suffix[5] && suffix[5] != '_') || !has_word(l, "..._wide"))
		return name;
	snprintf(narrow, size, "%.*s%s", (int)(suffix - name), name, suffix + 5);
	return narrow;
}

/* w3x_2: a quantity of the legend, digits, a component, and a number where it comes again. */
static int is_explained(const struct legend *l, const char *name, const char *parameters)
{
	char base[2 * WORD], stem[2 * WORD + 3];
	const char *rest, *again = strrchr(name, '_');
	size_t n = strcspn(name, "0123456789");

	if (is_argument(name, parameters) || has_word(l, name) || is_keyword(name) || has_beginning(l, name))
		return 1;
	snprintf(base, sizeof base, "%.*s", (int)n, name);
	rest = name + n + strspn(name + n, "0123456789");
	if (again && again > name && isdigit((unsigned char)again[1]) && again[1 + strspn(again + 1, "0123456789")] == '\0' &&
		rest <= again)
		snprintf(stem, sizeof stem, "%.*s", (int)(again - rest), rest);
	else
		snprintf(stem, sizeof stem, "%s", rest);
	if (*rest && again >= rest && again && !has_word(l, "..._2"))
		return 0;
	if (has_word(l, base) && n && name[n] && (is_row_of_joint(stem)))
		return 1;
	for (const char *s = parameters; (s = strchr(s, '*')); s++) { /* payload_hand_m: a row of the array payload_hand */
		const char *array = s + 1 + (strncmp(s + 1, "first_", 6) ? 0 : 6);
		size_t length = strcspn(array, ",)");

		if (has_word(l, "ARRAY_...") && !strncmp(name, array, length) && name[length] == '_')
			return 1;
	}
	return 0;
}

/* The names of a body's statements: between its braces, comments aside. */
static void check_names(const struct legend *l, const char *body, const char *end, const char *parameters, const char *what)
{
	for (const char *s = body; s < end;) {
		char name[WORD * 2], narrow[WORD * 2];
		size_t length;

		if (!strncmp(s, "/*", 2)) {
			s = strstr(s, "*/") + 2;
		} else if (*s == '#') { /* a line of the preprocessor */
			s += strcspn(s, "\n");
		} else if (*s == '.' && isalpha((unsigned char)s[1])) { /* a member */
			s += 2;
		} else if (isdigit((unsigned char)*s)) {
			s += strspn(s, "0123456789.abcdefxp");
			s += (s[-1] == 'e' || s[-1] == 'p') && (*s == '-' || *s == '+') ? 1 + strspn(s + 1, "0123456789f") : 0;
		} else if (isalpha((unsigned char)*s) || *s == '_') {
			length = strspn(s, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789");
			snprintf(name, sizeof name, "%.*s", (int)length, s);
			ck_assert_msg(is_explained(l, without_wide(l, name, narrow, sizeof narrow), parameters),
				"%s: the legend does not explain '%s'", what, name);
			s += length;
		} else {
			s++;
		}
	}
}

/* What chooses among parts, or runs parts or segments, is no statement of the algorithm. */
static int has_statements(const char *body, const char *end)
{
	static const char *const runs[] = {"gridDim", "_part0_body(", "_one0("};

	for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
		const char *found = strstr(body, runs[i]);

		if (found && found < end)
			return 0;
	}
	return 1;
}

/* Of a body, a part's or a segment's included, and of the bounded function, which stands beside one. */
static int check_functions(const struct legend *l, const char *text, const char *function, const char *what)
{
	int seen = 0;

	for (const char *s = text; (s = strstr(s, function)); s++) {
		const char *body = strchr(s, ')') + 1, *end = strstr(body, "\n}\n");
		char parameters[8192];

		if (strncmp(body, "\n{\n", 3) || !end)
			continue;
		if (!strcmp(function, "_bounded(")) {
			body = strstr(body, "const ");
			body = strstr(body, "\n\tconst ");
			end = strstr(body, "\n\trnea(");
		} else if (!strcmp(function, "_segment")) {
			body = strstr(body, "l++) {") + strlen("l++) {");
		} else if (!has_statements(body, end)) {
			continue;
		}
		snprintf(parameters, sizeof parameters, "%.*s,", (int)(strchr(s, ')') - s), s);
		check_names(l, body, end, parameters, what);
		seen++;
	}
	return seen;
}

struct tour {
	int variant, robots;
};

/* Catches a line that is written without the margin in mind, or a second blank one, in any frame, statement, comment or table;
   and a quantity, an input, a macro or a helper that is new in the statements and not in the legend. */
static void check_text(const char *path, const char *name, void *context)
{
	static struct legend l;
	struct tour *tour = context;
	struct rneagen_result r;
	const int each = sanitized() ? 5 : 3;

	if (tour->robots++ % each != tour->variant % each || !generate(path, &VARIANTS[tour->variant], &r))
		return;
	check_lines(r.source, name);
	if (r.header)
		check_lines(r.header, name);
	ck_assert_msg(!strstr(r.source, "[0*stride]") && !strstr(r.source, "[1*stride]"), "%s", name);
	read_legend(&l, r.source);
	ck_assert_msg(check_functions(&l, r.source, "_body(", name) + check_functions(&l, r.source, "_segment", name) > 0, "%s",
		name);
	ck_assert_int_eq(check_functions(&l, r.source, "_bounded(", name), VARIANTS[tour->variant].bounded);
	rneagen_result_free(&r);
}

START_TEST(texts)
{
	struct tour tour = {.variant = _i};

	for_all(check_text, &tour);
}
END_TEST

/* ---- --only rnea ---- */

/* Catches a half or a batch that is left in, and a text that lost the algorithm itself. */
START_TEST(only_rnea)
{
	static const char *const halves[] = {"r_fpass", "r_bpass"},
		*const batches[] = {"_batch(", "_slice(", "_part(", "r_is_small"};
	struct variant v = {.target = (enum rneagen_target)_i, .precision = RNEAGEN_F32, .only = 1};
	struct rneagen_result r;

	ck_assert(generate(TEST_DIR "/robots/iiwa14.urdf", &v, &r));
	for (int i = 0; i < 2; i++)
		ck_assert_msg(!strstr(r.source, halves[i]), "%s", halves[i]);
	for (int i = 0; i < 4 && v.target == RNEAGEN_TARGET_C; i++)
		ck_assert_msg(!strstr(r.source, batches[i]) && !strstr(r.header, batches[i]), "%s", batches[i]);
	ck_assert(strstr(r.source, v.target == RNEAGEN_TARGET_HEADER ? "r_rnea(const float *q" : "r_rnea(const float q[7]") &&
		  strstr(r.source, " --only rnea"));
	ck_assert(v.target == RNEAGEN_TARGET_HEADER ||
		(strstr(r.source, "function rnea\\n") && !strstr(r.source, "function fpass")));
	rneagen_result_free(&r);
}
END_TEST

/* The head names the function that is left, and another one's name is refused. */
START_TEST(only_by_name)
{
	static const int asked[] = {RNEAGEN_ONLY_MAIN, RNEAGEN_ONLY_RNEA, RNEAGEN_ONLY_FD, RNEAGEN_ONLY_KIN};
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;
	struct rneagen_error e;
	size_t length;
	char *urdf = read_file(TEST_DIR "/robots/ur5.urdf", &length);

	o.scene = "want qdd";
	o.target = RNEAGEN_TARGET_C;
	for (int i = 0; i < 4; i++) {
		o.only = asked[i];
		if (asked[i] == RNEAGEN_ONLY_MAIN || asked[i] == RNEAGEN_ONLY_FD) {
			ck_assert(!rneagen_generate(urdf, length, &o, &r, &e) && strstr(r.source, " --only fd"));
			rneagen_result_free(&r);
			continue;
		}
		ck_assert_int_eq(rneagen_generate(urdf, length, &o, &r, &e), RNEAGEN_USAGE);
		ck_assert_str_eq(strstr(e.message, "with"), "with these outputs the function is fd: take --only fd");
	}
	free(urdf);
}
END_TEST

/* ---- joints ---- */

/* Catches limits in another order than the rows', or of a joint that has none. */
START_TEST(limits_by_rows)
{
	struct variant v = {.target = RNEAGEN_TARGET_C, .precision = RNEAGEN_F64};
	struct rneagen_result r;

	ck_assert(generate(TEST_DIR "/robots/iiwa14.urdf", &v, &r));
	ck_assert(strstr(r.header, "RNEA_TABLE char *const r_qd_joint[r_nv] = {\n\t\"iiwa_joint_1\", \"iiwa_joint_2\", "));
	ck_assert(strstr(r.header, "RNEA_TABLE double r_q_min[r_nq] = {\n\t-2.96705972839, -2.09439510239, "));
	ck_assert(strstr(r.header, "RNEA_TABLE double r_q_max[r_nq] = {\n\t2.96705972839, 2.09439510239, "));
	rneagen_result_free(&r);
	v.base = RNEAGEN_FLOATING;
	ck_assert(generate(TEST_DIR "/robots/cartpole.urdf", &v, &r));
	ck_assert(strstr(r.header, "r_q_joint[r_nq] = {\n\t\"\", \"\", \"\", \"\", \"\", \"\", \"\", \""));
	ck_assert(strstr(r.header, "r_q_min[r_nq] = {\n\t-HUGE_VAL, -HUGE_VAL, "));
	ck_assert(strstr(r.header, "r_tau_max[r_nv] = {\n\tHUGE_VAL, HUGE_VAL, "));
	rneagen_result_free(&r);
}
END_TEST

int main(void)
{
	int variants = (int)(sizeof VARIANTS / sizeof *VARIANTS);
	Suite *suite = suite_create("legible");

	suite_add(suite, "texts", texts, variants, 60);
	suite_add(suite, "only rnea", only_rnea, RNEAGEN_TARGET_COUNT, 10);
	suite_add(suite, "only by name", only_by_name, 1, 10);
	suite_add(suite, "joints", limits_by_rows, 1, 10);
	return suite_run(suite);
}
