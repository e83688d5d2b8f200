#define _POSIX_C_SOURCE 200809L
#include "scene_trial.h"
#include "fuzz_check.h"
#include "cli/options.h"
#include "urdf/robot.h"
#include "scene_grammar.h"
#include "support/urdf_text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char FILE_NAME[] = "fuzz robot.urdf", COMMAND[] = "fuzz";

/* Small ones of every kind of joint. */
static const char *const ROBOTS[] = {"double_pendulum", "mimic_chain", "planar_tilted", "floating_joint", "gantry", "fixed_tree",
	"all_zero_torque", "massless_middle", "root_with_mass", "cartpole", "robotiq_2f_85"};
enum { FILES = sizeof ROBOTS / sizeof *ROBOTS, COUNT = FILES + 1 };

/* Names that quotes, lists and shells may mistake. */
static const char ODD[] = ROBOT("odd */ &apos;names&apos;",
	BARE("base") BALL(" a ") BALL("#1") BALL("a,b") BALL("x=y") BALL("it&apos;s")
	BALL("&quot;q&quot;") BALL("a\\nb") BALL("x:sample") BALL("mass.x # y&#9;")
	JOINT(" j ", "continuous", "base", " a ", ORIGIN("0 0 1", "1.5708 0 0")) JOINT("#4 ", "revolute", " a ",
		"#1", AXIS("1 1 0"))
	JOINT("j,k", "prismatic", "#1", "a,b", ORIGIN("0 1 0", "0.1 0.2 0.3")) JOINT("f=x", "fixed", "a,b", "x=y", "")
	JOINT("\\", "continuous", "base", "it&apos;s", ORIGIN("1 0 0", "0 0 0"))
	JOINT("&quot;", "continuous", "it&apos;s", "&quot;q&quot;", MIMIC("\\", "-2", "0.5"))
	JOINT("a&#10;b", "revolute", "base", "a\\nb", "<dynamics damping='0.5' friction='0.25'/>")
	JOINT("fixed", "fixed", "base", "x:sample", "") JOINT("q:batch", "fixed", "a\\nb", "mass.x # y&#9;", ""));

static struct {
	char *urdf;
	size_t length;
	struct arena arena;
	struct robot robot;
} robots[COUNT];

void scene_trial_open(void)
{
	for (int i = 0; i < COUNT; i++) {
		struct rneagen_error e = {0};
		char path[1024];
		FILE *f = NULL;

		if (i < FILES) {
			snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", ROBOTS[i]);
			f = fopen(path, "rb");
		}
		robots[i].urdf = i < FILES ? calloc(1, 1 << 16) : strdup(ODD);
		robots[i].length = f ? fread(robots[i].urdf, 1, (1 << 16) - 1, f) : strlen(ODD);
		require(i == FILES || f, "a robot cannot be read", &e);
		if (f)
			fclose(f);
		arena_init(&robots[i].arena, NULL);
		robot_read(&robots[i].robot, robots[i].urdf, robots[i].length, FILE_NAME, &robots[i].arena, &e);
		require(!e.code, "a robot is refused", &e);
	}
}

void scene_trial_close(void)
{
	for (int i = 0; i < COUNT; i++) {
		arena_free(&robots[i].arena);
		free(robots[i].urdf);
	}
}

/* ---- options ---- */

/* Often the one with odd names. */
static size_t draw_robot(struct dice *d)
{
	size_t draw = dice_below(d, COUNT + COUNT / 2);

	return draw < COUNT ? draw : COUNT - 1;
}

/* What goes together, but for --parts, which depends on the scene. */
static struct rneagen_options draw_options(struct dice *d)
{
	static const double gravities[][3] = {{0, 0, -9.81}, {0, 0, 0}, {0.573, 1.62, -1e-5}, {1e300, -1e300, 1e-300}};
	struct rneagen_options o = rneagen_options_default();
	size_t gravity = dice_below(d, 16);
	int may_segment;

	o.file = FILE_NAME;
	o.tell = RNEAGEN_TELL_ALL;
	o.target = (enum rneagen_target)dice_below(d, 3);
	o.precision = (enum rneagen_precision)dice_below(d, 5);
	o.layout = (enum rneagen_layout)dice_below(d, 2);
	o.base = (enum rneagen_base)(dice_below(d, 5) == 4);
	o.mimic = (enum rneagen_mimic)(dice_below(d, 4) == 3);
	o.strict = o.precision != RNEAGEN_F32X2 && dice_below(d, 4) == 3;
	o.trig = (enum rneagen_trig)dice_below(d, o.strict ? 2 : 3);
	o.bounded = o.target == RNEAGEN_TARGET_C && o.precision != RNEAGEN_F32X2 && dice_below(d, 4) == 3;
	o.parts = dice_below(d, 32) == 31 ? 2 : RNEAGEN_PARTS_AUTO;
	may_segment = o.target != RNEAGEN_TARGET_HEADER && o.parts == RNEAGEN_PARTS_AUTO;
	o.segments = dice_below(d, 8) == 7 && may_segment ? 30 : RNEAGEN_SEGMENTS_AUTO;
	memcpy(o.gravity, gravities[gravity > 2 ? gravity == 15 ? 3 : 0 : gravity], sizeof o.gravity);
	return o;
}

/* ---- the command at a text's head ---- */

/* The lines after "Made by", up to " * from a URDF", without what begins them, and with their bytes. */
static char *read_command(const char *source)
{
	const char *s = strstr(source, "Made by\n *   "), *end = s ? strstr(s, "\n * from a URDF") : NULL;
	char *command = end ? malloc((size_t)(end - s) + 1) : NULL, *to = command;

	if (!command)
		return NULL;
	for (s += strlen("Made by\n *   "); s < end; s++) {
		unsigned byte;

		if (!strncmp(s, "\n *     ", 8)) {
			*to++ = ' ';
			s += 7;
		} else if (*s == '\\' && sscanf(s, "\\x%2x", &byte) == 1) {
			*to++ = (char)byte;
			s += 3;
		} else {
			*to++ = *s;
		}
	}
	*to = '\0';
	return command;
}

/* The words of a shell, in place: blanks end them, single quotes keep what they hold, \' is a quote. */
static int split_words(char *s, char **words, int most)
{
	int count = 0;

	while (count < most - 1) {
		char *to;

		s += strspn(s, " ");
		if (!*s)
			break;
		words[count++] = to = s;
		for (int quoted = 0; *s && (quoted || *s != ' '); s++) {
			if (*s == '\'')
				quoted = !quoted;
			else if (*s == '\\' && !quoted)
				*to++ = *++s;
			else
				*to++ = *s;
		}
		s += *s == ' ';
		*to = '\0';
	}
	words[count] = NULL;
	return count;
}

/* Read the words as the command does; 0 if one of them is refused. */
static int read_options(struct rneagen_options *o, int count, char **words)
{
	enum { NAME = OPTION_OWN, BOUNDED };
	static const struct option options[] = {OPTIONS_TEXT, OPTIONS_MODEL, {"name", required_argument, NULL, NAME},
		{"bounded", no_argument, NULL, BOUNDED}, {NULL, 0, NULL, 0}};
	int key;

	optind = 0; /* getopt begins anew */
	while ((key = getopt_long(count, words, "+:", options, NULL)) != -1) {
		if (key == NAME)
			o->name = optarg;
		else if (key == BOUNDED)
			o->bounded = 1;
		else if (key == ':' || key == '?' || option_generate(COMMAND, o, key, optarg))
			return 0;
	}
	return optind == count;
}

/* The command makes the same text again. */
static void check_again(const struct rneagen_result *first, const char *urdf, size_t length)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e = {0};
	struct rneagen_result r;
	char *command = read_command(first->source), *words[256];
	int count = command ? split_words(command, words, 256) : 0;

	require(count > 2 && !strcmp(words[0], "rneagen") && !strcmp(words[1], FILE_NAME), "no command at the head", &e);
	require(read_options(&o, count - 1, words + 1), "the command at the head is refused", &e);
	o.file = FILE_NAME;
	rneagen_generate(urdf, length, &o, &r, &e);
	require(!e.code, "the command at the head fails", &e);
	require(!strcmp(first->source, r.source), "the command at the head makes another text", &e);
	require(!first->header || !strcmp(first->header, r.header), "the command at the head makes another header", &e);
	rneagen_result_free(&r);
	option_free(&o);
	free(command);
}

/* ---- a trial ---- */

static void tell(struct trial_result *t, const char *scene, const struct rneagen_error *e)
{
	snprintf(t->scene, sizeof t->scene, "%s", scene);
	snprintf(t->message, sizeof t->message, "%s", e->message);
	t->outcome = e->code ? TRIAL_REFUSED : TRIAL_ACCEPTED;
}

enum trial scene_trial(const uint8_t *data, size_t size, struct trial_result *result)
{
	struct dice d = {data, size};
	size_t robot = draw_robot(&d);
	struct ration ration = {.left = dice_below(&d, 32) == 31 ? (int)dice_below(&d, 64) : -1};
	struct rneagen_allocator allocator = ration_allocator(&ration);
	struct rneagen_options o = draw_options(&d);
	int again = dice_below(&d, 2) == 0;
	struct trial_result spare, *t = result ? result : &spare;
	struct rneagen_result r;
	struct rneagen_error e;
	struct arena a;

	arena_init(&a, NULL);
	o.scene = scene_draw(&d, &robots[robot].robot, &o, &o.order, &t->garbled, &a);
	if (o.scene) {
		o.allocator = &allocator;
		rneagen_generate(robots[robot].urdf, robots[robot].length, &o, &r, &e);
		check_result(&o, &r, &e);
		if (!e.code && again)
			check_again(&r, robots[robot].urdf, robots[robot].length);
		if (!e.code)
			rneagen_result_free(&r);
		require(ration.out == 0, "memory is not given back", &e);
		tell(t, o.scene, &e);
	} else {
		tell(t, "", &(struct rneagen_error){.code = RNEAGEN_MEMORY});
	}
	arena_free(&a);
	return t->outcome;
}
