#include "payload_arm.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* I about the origin = I about the centre + m (c'c 1 - c c') */
void payload_of(const struct body *b, double p[P])
{
	const double *c = b->centre, *i = b->inertia, m = b->mass;
	const double about_origin[P] = {m, m * c[0], m * c[1], m * c[2], i[0] + m * (c[1] * c[1] + c[2] * c[2]),
		i[1] - m * c[0] * c[1], i[2] - m * c[0] * c[2], i[3] + m * (c[0] * c[0] + c[2] * c[2]),
		i[4] - m * c[1] * c[2], i[5] + m * (c[0] * c[0] + c[1] * c[1])};

	memcpy(p, about_origin, sizeof about_origin);
}

static struct rneagen_options text_options(void)
{
	struct rneagen_options o = rneagen_options_default();

	o.precision = RNEAGEN_F64;
	o.layout = RNEAGEN_AOS; /* [sample][row] */
	return o;
}

static int is_ours(const struct rnea_robot *arm, size_t inputs)
{
	const struct rnea_info *info = rnea_info(arm);

	return info->nq == N && info->input_count == inputs;
}

struct rnea_robot *arm_open(const char *path, const char *link)
{
	struct rneagen_options o = text_options();
	struct rnea_robot *arm;
	struct rnea_error error;
	char scene[512];

	snprintf(scene, sizeof scene, "free payload.%.255s:sample\n", link);
	o.scene = scene;
	if (!rnea_open_urdf(path, &o, NULL, &arm, &error) && is_ours(arm, 4))
		return arm;
	fprintf(stderr, "payload: %s\n", error.code ? error.message : "the arm does not have seven joints");
	rnea_close(arm);
	return NULL;
}

/* The file with one link more, malloc'ed; NULL if it cannot be read. */
static char *loaded_urdf(const char *path, const char *link, const struct body *b)
{
	enum { READ_LIMIT = 1 << 20, MORE = 2048 };
	FILE *f = fopen(path, "rb");
	char *text = calloc(READ_LIMIT + MORE, 1), *end = NULL;

	if (f && text && fread(text, 1, READ_LIMIT - 1, f))
		end = strstr(text, "</robot>");
	if (end)
		snprintf(end, MORE,
			"<link name='hidden'><inertial><origin xyz='%.17g %.17g %.17g'/><mass value='%.17g'/>"
			"<inertia ixx='%.17g' ixy='%.17g' ixz='%.17g' iyy='%.17g' iyz='%.17g' izz='%.17g'/>"
			"</inertial></link><joint name='held' type='fixed'><parent link='%.255s'/><child link='hidden'/>"
			"</joint></robot>",
			b->centre[0], b->centre[1], b->centre[2], b->mass, b->inertia[0], b->inertia[1], b->inertia[2],
			b->inertia[3], b->inertia[4], b->inertia[5], link);
	if (f)
		fclose(f);
	if (end)
		return text;
	free(text);
	return NULL;
}

struct rnea_robot *arm_open_loaded(const char *path, const char *link, const struct body *b)
{
	struct rneagen_options o = text_options();
	struct rneagen_result text;
	struct rneagen_error refused;
	struct rnea_error error;
	struct rnea_robot *arm = NULL;
	char *urdf = loaded_urdf(path, link, b);

	if (!urdf) {
		fprintf(stderr, "payload: %s: cannot be read, or is no URDF\n", path);
	} else if (rneagen_generate(urdf, strlen(urdf), &o, &text, &refused)) {
		fprintf(stderr, "payload: %s\n", refused.message);
	} else {
		if (rnea_open(text.source, strlen(text.source), NULL, &arm, &error))
			fprintf(stderr, "payload: %s\n", error.message);
		rneagen_result_free(&text);
	}
	free(urdf);
	return arm;
}

/* Joint j swings at a frequency of its own, so that all of them are at rest at different moments. */
static void trajectory(size_t k, double q[N], double qd[N], double qdd[N])
{
	for (int j = 0; j < N; j++) {
		double rate = 1.1 + 0.37 * j, a = j % 2 ? 0.9 : 1.3, at = rate * 0.06 * (double)k + 0.8 * j;

		q[j] = a * sin(at);
		qd[j] = a * rate * cos(at);
		qdd[j] = -a * rate * rate * sin(at);
	}
}

int arm_torques(const struct rnea_robot *arm, const double (*payloads)[P], size_t count, double *tau)
{
	size_t samples = count * STATES;
	double *x[4] = {calloc(samples, sizeof(double[N])), calloc(samples, sizeof(double[N])),
		calloc(samples, sizeof(double[N])), calloc(samples, sizeof(double[P]))};
	void *loaded[] = {x[0], x[1], x[2], tau}, *freed[] = {x[0], x[1], x[2], x[3], tau};
	struct rnea_error error = {.code = RNEA_MEMORY, .message = "out of memory"};

	if (x[0] && x[1] && x[2] && x[3]) {
		for (size_t k = 0; k < samples; k++) {
			trajectory(k % STATES, x[0] + k * N, x[1] + k * N, x[2] + k * N);
			if (payloads)
				memcpy(x[3] + k * P, payloads[k / STATES], sizeof *payloads);
		}
		rnea_run(arm, payloads ? freed : loaded, samples, &error);
	}
	for (int i = 0; i < 4; i++)
		free(x[i]);
	if (error.code)
		fprintf(stderr, "payload: %s\n", error.message);
	return error.code != RNEA_OK;
}
