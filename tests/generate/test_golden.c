/* The passes of the pipeline for two small robots, as they were when somebody last looked at them: tests/golden/.
   After a change that is meant: RNEAGEN_RENEW=1 test_golden writes them anew; then read what git diff shows. */
#include "rneagen.h"
#include "support/read.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const robots[] = {"double_pendulum", "mimic_chain"};
static const char *const passes[] = {[RNEAGEN_DUMP_ROBOT] = "robot", [RNEAGEN_DUMP_TREE] = "tree",
	[RNEAGEN_DUMP_DAG] = "dag", [RNEAGEN_DUMP_PLAN] = "plan", [RNEAGEN_DUMP_SCENE] = "scene",
	[RNEAGEN_DUMP_REQUEST] = "request", [RNEAGEN_DUMP_PARTS] = "parts", [RNEAGEN_DUMP_PASSES] = "passes"};
enum { PASSES = RNEAGEN_DUMP_PASSES };

/* By robot: for what there is to see of a scene. */
static const char *const scenes[] = {"fold qdd=0\nfree mass.lower:batch\nwant tau,M\nrange q.elbow=-0.5,0.25\n",
	"tip arm\nlock motor=0.5\ntip hand\nfree gravity:sample\nfext hand\narmature wrist=0.125\nwant tau,power\n"};

/* The first line that differs, for the message. */
static void compare(const char *path, const char *got, const char *want)
{
	int line = 1;

	ck_assert_msg(want != NULL, "%s is not there; RNEAGEN_RENEW=1 makes it", path);
	for (const char *g = got, *w = want; *g && *g == *w; g++, w++)
		line += *g == '\n';
	ck_assert_msg(!strcmp(got, want), "%s: line %d differs; if that is meant, RNEAGEN_RENEW=1 and look at git diff", path,
		line);
}

static void renew(const char *path, const char *text)
{
	FILE *f = fopen(path, "wb");

	ck_assert_msg(f && fputs(text, f) >= 0 && !fclose(f), "%s cannot be written", path);
	printf("renewed: %s\n", path);
}

START_TEST(pass)
{
	const char *robot = robots[_i / PASSES], *renewed = getenv("RNEAGEN_RENEW");
	enum rneagen_dump dump = (enum rneagen_dump)(RNEAGEN_DUMP_ROBOT + _i % PASSES);
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result r;
	struct rneagen_error e;
	char path[1024];
	size_t length;
	char *text;

	text = robot_text(robot);
	o.dump = dump;
	o.scene = dump >= RNEAGEN_DUMP_SCENE && dump <= RNEAGEN_DUMP_PARTS ? scenes[_i / PASSES] : NULL;
	ck_assert_msg(!rneagen_generate(text, strlen(text), &o, &r, &e), "%s", e.message);
	free(text);
	snprintf(path, sizeof path, TEST_DIR "/golden/%s.%s", robot, passes[dump]);
	if (renewed && !strcmp(renewed, "1")) {
		renew(path, r.dump);
	} else {
		text = read_file(path, &length);
		compare(path, r.dump, text);
		free(text);
	}
	rneagen_result_free(&r);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("golden");
	TCase *c = tcase_create("passes");

	setvbuf(stdout, NULL, _IOLBF, 0);
	tcase_add_loop_test(c, pass, 0, PASSES * sizeof robots / sizeof *robots);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
