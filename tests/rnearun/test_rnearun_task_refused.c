/* rnearun eval with a scene, where words and files do not fit its arrays. */
#define _DEFAULT_SOURCE
#include "test_rnearun_task.h"
#include "states_file.h"
#include <string.h>
#include <unistd.h>

START_TEST(test_refused)
{
	struct fixture *f = fixture_new(0, 0);
	double x[SAMPLES * 9] = {0};

	write_inputs(f);
	file_put_array("g2.npy", x, 2, 3, 0);
	file_put_array("p9.npy", x, SAMPLES, 9, 0);
	file_put_array("p20.npy", x, 20, 10, 0);
	unlink("out.npy");
	RUN_SCENE(f, 2, "'payload.iiwa_link_8' is no input of this scene; did you mean 'payload.iiwa_link_7'?", "--in", "in.npy",
		"--input", "payload.iiwa_link_8=p.npy", "--out", "out.npy");
	RUN_SCENE(f, 2, "'tua' is no output of this scene; did you mean 'tau'?", "--in", "in.npy", "--output", "tua=out.npy");
	RUN_SCENE(f, 2, "'tau' is no input", "--in", "in.npy", "--input", "tau=q.npy", "--out", "out.npy");
	RUN_SCENE(f, 2, "--input takes NAME=FILE, not 'gravity'", "--in", "in.npy", "--input", "gravity", "--out", "out.npy");
	RUN_SCENE(f, 2, "--output takes NAME=FILE, not 'tau='", "--in", "in.npy", "--output", "tau=");
	RUN_SCENE(f, 2, "the scene has no input qdd; leave it out", "--q", "q.npy", "--qd", "qd.npy", "--qdd", "qd.npy", "--out",
		"out.npy");
	RUN_SCENE(f, 2, "--qd is missing", "--q", "q.npy", "--out", "out.npy");
	RUN_SCENE(f, 2, "--q is missing", "--out", "out.npy");
	RUN(2, "--input vjp_v=FILE is missing", IIWA, "--want", "vjp", "--q", "q.npy", "--qd", "qd.npy", "--qdd",
		"qd.npy", "--out", "out.npy");
	RUN_SCENE(f, 2, "'q' has a file already", "--q", "q.npy", "--qd", "qd.npy", "--input", "q=q.npy", "--out", "out.npy");
	RUN_SCENE(f, 2, "--output out.npy is the output out.npy as well", "--in", "in.npy", "--out", "out.npy",
		"--output", "tau=out.npy");
	RUN_SCENE(f, 2, "--output o.npy is the output o.npy as well", "--in", "in.npy", "--output", "power=o.npy",
		"--output", "tau=o.npy");
	RUN_SCENE(f, 2, "can be written once", "--in", "in.npy", "--out", "-", "--output", "tau=-");
	RUN_SCENE(f, 2, "can be read once", "--in", "-", "--input", "gravity=-", "--out", "out.npy");
	RUN_SCENE(f, 2, "--output in.npy is the input in.npy", "--in", "in.npy", "--output", "tau=in.npy", "--quiet");
	RUN_SCENE(f, 1, "q.npy: 7 columns, iiwa14 needs 30 (q 7, qd 7, payload.iiwa_link_7 10, fext.iiwa_link_ee 6)",
		"--in", "q.npy", "--out", "out.npy");
	RUN_SCENE(f, 1, "g2.npy: shape (2, 3), iiwa14 needs (3,) for gravity", "--in", "in.npy", "--input",
		"gravity=g2.npy", "--out", "out.npy");
	RUN_SCENE(f, 1, "p9.npy: 9 columns, iiwa14 needs 10 for payload.iiwa_link_7", "--input",
		"payload.iiwa_link_7=p9.npy", "--q", "q.npy", "--qd", "qd.npy", "--out", "out.npy");
	RUN_SCENE(f, 1, "other samples than q.npy", "--input", "payload.iiwa_link_7=p20.npy", "--q", "q.npy", "--qd",
		"qd.npy", "--out", "out.npy");
	RUN_SCENE(f, 1, "no/p.npy: cannot be written", "--in", "in.npy", "--output", "tau=out.npy", "--output", "power=no/p.npy");
	RUN_SCENE(f, 1, "/dev/full: cannot be written", "--in", "in.npy", "--output", "tau=out.npy", "--output",
		"power=/dev/full");
	ck_assert_int_eq(count_files("out.npy"), 0);
	fixture_free(f);
}
END_TEST

TCase *case_refused(void)
{
	TCase *c = tcase_create("refused");

	tcase_set_timeout(c, 120);
	tcase_add_test(c, test_refused);
	return c;
}
