#define _POSIX_C_SOURCE 200809L
#include "support/suite.h"
#include "reference/test_reference.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct reference *open_text(const char *urdf, const struct reference_options *o)
{
	char message[256] = "";
	struct reference *r = reference_open(urdf, strlen(urdf), o, message, sizeof message);

	ck_assert_msg(r != NULL, "%s\n%.500s", message, urdf);
	ck_assert_int_le(r->nq, ROWS);
	return r;
}

void sample_state(struct reference *r, struct rng *rng, struct state *s)
{
	reference_sample(r, rng, false, s->q, s->qd, s->qdd);
	for (int i = 0; i < r->nq; i++)
		s->wq[i] = (wide)s->q[i];
	for (int i = 0; i < r->nv; i++) {
		s->wqd[i] = (wide)s->qd[i];
		s->wqdd[i] = (wide)s->qdd[i];
	}
	reference_rnea(r, s->q, s->qd, s->qdd, s->tau);
}

void expect_near(const wide *a, const wide *b, int n, double tolerance, const char *what)
{
	wide size = 1;

	for (int i = 0; i < n; i++) {
		size = wide_abs(a[i]) > size ? wide_abs(a[i]) : size;
		size = wide_abs(b[i]) > size ? wide_abs(b[i]) : size;
	}
	for (int i = 0; i < n; i++)
		ck_assert_msg(wide_abs(a[i] - b[i]) <= (wide)tolerance * size, "%s: row %d of %d: %.17g, not %.17g (%g)",
		              what, i, n, (double)a[i], (double)b[i], (double)size);
}

static char *read_file(const char *path)
{
	FILE *file = fopen(path, "rb");
	char *text = calloc(1, 1 << 20);

	ck_assert_msg(file != NULL && text != NULL, "%s", path);
	ck_assert(fread(text, 1, (1 << 20) - 1, file) > 0);
	fclose(file);
	return text;
}

void each_real_robot(void (*test)(const char *name, const char *urdf))
{
	const char *folder = getenv("RNEAGEN_ROBOTS");
	DIR *dir = folder ? opendir(folder) : NULL;
	int robots = 0;

	if (!folder) {
		puts("skipped: RNEAGEN_ROBOTS is not set");
		return;
	}
	ck_assert_msg(dir != NULL, "%s", folder);
	for (struct dirent *e; (e = readdir(dir));) {
		char path[4096], *text;

		if (!strstr(e->d_name, ".urdf") || !strncmp(e->d_name, "xfail", 5))
			continue;
		snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
		text = read_file(path);
		test(e->d_name, text);
		free(text);
		robots++;
	}
	closedir(dir);
	ck_assert_int_gt(robots, 0);
}

int main(void)
{
	Suite *suite = suite_create("reference");

	suite_add_tcase(suite, closed_forms());
	suite_add_tcase(suite, oracle_agreement());
	suite_add_tcase(suite, properties());
	suite_add_tcase(suite, kinematics());
	suite_add_tcase(suite, equivalences());
	suite_add_tcase(suite, input_reading());
	return suite_run(suite);
}
