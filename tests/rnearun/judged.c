#include "judged.h"
#include <check.h>
#include <stdlib.h>

void judged_open(struct judged *x, const char *path, enum rneagen_base base, const char *scene, enum rneagen_precision precision,
	const struct draw_options *samples)
{
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e;
	size_t length;
	char *urdf = read_file(path, &length);

	o.base = base;
	model_open(&x->model, urdf, length, &o, path);
	o.scene = scene;
	ck_assert_msg(!analysis_open(&x->analysis, urdf, length, &o, &e), "%s", e.message);
	ck_assert(judge_open(&x->judge, &x->analysis, precision, samples, 2));
	free(urdf);
}

void judged_close(struct judged *x)
{
	judge_free(&x->judge);
	analysis_free(&x->analysis);
	model_close(&x->model);
}

struct states states_of(const struct drawn *x)
{
	const struct drawn_array *a = x->arrays;

	return (struct states){(size_t)a[DRAWN_Q].rows, (size_t)a[DRAWN_QD].rows, a[DRAWN_Q].values, a[DRAWN_QD].values,
		a[DRAWN_DRIVE].values};
}
