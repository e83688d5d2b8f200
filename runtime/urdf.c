#include "urdf.h"
#include "core/failure.h"
#include "core/source.h"
#include "generate.h"
#include <stdlib.h>
#include <string.h>

static enum rnea_code check(
	const char *path, const struct rneagen_options *g, struct rnea_robot **robot, struct rnea_error *e)
{
	if (!robot)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no place for the robot (robot is NULL)");
	*robot = NULL;
	if (!path)
		return rnea_error_set(e, RNEA_ARGUMENT, "there is no file (path is NULL)");
	if (g->target != RNEAGEN_TARGET_CUDA)
		return rnea_error_set(e, RNEA_ARGUMENT,
			"%s: the target must be RNEAGEN_TARGET_CUDA, whose text serves both backends", path);
	if (g->dump != RNEAGEN_DUMP_NONE)
		return rnea_error_set(
			e, RNEA_ARGUMENT, "%s: a dump cannot be opened; it must be RNEAGEN_DUMP_NONE", path);
	return RNEA_OK;
}

struct rneagen_options rnea_urdf_options(const struct rneagen_options *generate, enum rnea_backend backend)
{
	struct rneagen_options g = *generate;

	g.tell = 0;
	if (backend != RNEA_BACKEND_HOST)
		return g;
	if (g.parts == RNEAGEN_PARTS_AUTO)
		g.parts = 1;
	if (g.target != RNEAGEN_TARGET_CUDA || g.parts != 1 || g.limbs > RNEAGEN_LIMBS_NONE)
		return g;
	if (g.precision == RNEAGEN_PRECISION_DEFAULT)
		g.precision = RNEAGEN_F32; /* as of kernels: the text's target is no choice of the caller's */
	g.target = RNEAGEN_TARGET_C;
	return g;
}

enum rnea_code rnea_open_urdf(const char *path, const struct rneagen_options *generate_options,
	const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *error)
{
	struct rneagen_options g = generate_options ? *generate_options : rneagen_options_default();
	struct rnea_error spare, *e = rnea_error_start(error, &spare);
	struct rneagen_result text;
	size_t length;
	char *urdf;

	g.file = path;
	if (check(path, &g, robot, e) || source_bytes(path, &urdf, &length, e))
		return e->code;
	g = rnea_urdf_options(&g, options ? options->backend : RNEA_BACKEND_ANY);
	if (options && options->backend == RNEA_BACKEND_EVALUATOR) {
		rnea_evaluate_urdf(urdf, length, &g, options, robot, e);
	} else if (!generate_text(urdf, length, &g, &text, e)) {
		rnea_open(text.source, strlen(text.source), options, robot, e);
		rneagen_result_free(&text);
	}
	free(urdf);
	return e->code;
}
