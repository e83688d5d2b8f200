/* one_arm ROBOT.urdf ROOT TIP: one arm out of the file of a whole robot. The arm is the chain from link ROOT to link TIP;
   what hangs beside it or beyond it is held at zero and keeps its mass, what is not below ROOT is not there. Both, the
   arm and the whole robot, are generated, compiled and run by librnea, on the GPU where there is one: how much there is
   to compute, and whether the arm's torques are those that the whole robot has while the rest of it is held still. */
#include <math.h>
#include <rneagen/urdf.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 1000, ARRAYS = 4 }; /* states; q, qd, qdd, tau */

static const double LIMIT = 1e-12; /* of the largest torque */

/* One model with its arrays, [sample][row]. */
struct model {
	struct rnea_robot *robot;
	const struct rnea_info *info;
	void *array[ARRAYS]; /* of doubles */
};

/* `scene`: what of the robot is modelled; NULL: all of it. Returns 1 and says why if that cannot be had. */
static int model_open(struct model *m, const char *path, const char *scene)
{
	struct rneagen_options generate = rneagen_options_default();
	struct rnea_error error;

	generate.precision = RNEAGEN_F64;
	generate.layout = RNEAGEN_AOS;
	generate.scene = scene;
	if (rnea_open_urdf(path, &generate, NULL, &m->robot, &error)) {
		fprintf(stderr, "one_arm: %s\n", error.message);
		return 1;
	}
	m->info = rnea_info(m->robot);
	for (size_t i = 0; i < ARRAYS; i++) {
		m->array[i] = calloc(COUNT * m->info->arguments[i].rows, sizeof(double));
		if (!m->array[i]) {
			fprintf(stderr, "one_arm: out of memory\n");
			return 1;
		}
	}
	return 0;
}

static void model_close(struct model *m)
{
	rnea_close(m->robot);
	for (size_t i = 0; i < ARRAYS; i++)
		free(m->array[i]);
}

/* Row `row` of array i in sample k. */
static double *element(const struct model *m, size_t i, size_t k, size_t row)
{
	return (double *)m->array[i] + k * m->info->arguments[i].rows + row;
}

static size_t operations(const struct model *m)
{
	const struct rnea_operations *o = &m->info->operations;

	return o->mul + o->add + o->sub + 2 * o->fma;
}

/* From -1 to 1: the upper bits of a linear congruential generator, Knuth's MMIX. */
static double draw(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (double)(*state >> 11) / (double)(UINT64_C(1) << 52) - 1;
}

static const struct rnea_joint *find(const struct model *m, const char *name)
{
	for (size_t j = 0; j < m->info->joint_count; j++)
		if (!strcmp(m->info->joints[j].name, name))
			return &m->info->joints[j];
	return NULL;
}

/* The same random states in both; all other joints of the whole robot stay at zero. Returns 1 if a joint is missing. */
static int fill(struct model *arm, struct model *whole)
{
	uint64_t state = 1;

	for (size_t j = 0; j < arm->info->joint_count; j++) {
		const struct rnea_joint *a = &arm->info->joints[j], *w = find(whole, a->name);

		if (!w || a->nq != 1) {
			fprintf(stderr, "one_arm: joint '%s' is not an angle or a length of both models\n", a->name);
			return 1;
		}
		for (size_t i = 0; i < ARRAYS - 1; i++)
			for (size_t k = 0; k < COUNT; k++) {
				double x = (i ? 2 : 3) * draw(&state);

				*element(arm, i, k, i ? a->iv : a->iq) = x;
				*element(whole, i, k, i ? w->iv : w->iq) = x;
			}
	}
	return 0;
}

/* The largest difference of the arm's torques as a part of the largest torque; not a number counts as infinite. */
static double difference(const struct model *arm, const struct model *whole)
{
	double most = 0, largest = 0;

	for (size_t j = 0; j < arm->info->joint_count; j++) {
		const struct rnea_joint *a = &arm->info->joints[j], *w = find(whole, a->name);

		for (size_t k = 0; k < COUNT; k++) {
			double x = *element(arm, 3, k, a->iv), y = *element(whole, 3, k, w->iv);

			if (!isfinite(x - y))
				return INFINITY;
			most = fmax(most, fabs(x - y));
			largest = fmax(largest, fabs(y));
		}
	}
	return most / largest;
}

static int compare(struct model *arm, struct model *whole)
{
	struct rnea_error error;
	double off;

	if (fill(arm, whole))
		return 1;
	if (rnea_run(arm->robot, arm->array, COUNT, &error) ||
		rnea_run(whole->robot, whole->array, COUNT, &error)) {
		fprintf(stderr, "one_arm: %s\n", error.message);
		return 1;
	}
	off = difference(arm, whole);
	printf("%s: %zu joints, %zu operations; the arm: %zu joints, %zu operations, %.1f times less\n", whole->info->name,
		whole->info->joint_count, operations(whole), arm->info->joint_count, operations(arm),
		(double)operations(whole) / (double)operations(arm));
	printf("%d states on %s, the rest held still: torques differ by %.1e of the largest\n", COUNT,
		rnea_build(arm->robot)->device, off);
	return !(off < LIMIT) || operations(arm) >= operations(whole);
}

int main(int argc, char **argv)
{
	struct model arm = {0}, whole = {0};
	char scene[1024];
	int failed;

	if (argc != 4 || snprintf(scene, sizeof scene, "root %s\ntip %s\n", argv[2], argv[3]) >= (int)sizeof scene) {
		fprintf(stderr, "usage: one_arm ROBOT.urdf ROOT TIP, with names of links\n");
		return 2;
	}
	failed = model_open(&arm, argv[1], scene) || model_open(&whole, argv[1], NULL) || compare(&arm, &whole);
	model_close(&arm);
	model_close(&whole);
	return failed;
}
