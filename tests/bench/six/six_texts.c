/* usage: six_texts ROBOT.urdf FOLDER

   Write the spatial operations of a robot, one text each: FOLDER/OPERATION_PRECISION.cu and .c, where OPERATION is
   cross_operator, mxS or vxIv and PRECISION is f32 or f64. Arrays are soa, [row][sample]; twists, accelerations and
   wrenches are linear then angular, in the URDF frame of the link of the last joint that has an axis.

   operation        arrays, in the order of every signature
   cross_operator   v[6] in, crm[36] out: the motion cross operator of v as a 6x6 matrix, row by row
   mxS              v[6], qd[1] in, a[6] out: v x S qd, S being the joint's axis
   vxIv             v[6] in, f[6] out: v x* I v, I being the inertia of the link and all that is fixed to it

   librnea takes a text as it takes any: rnea_open_file, then rnea_launch or rnea_run (kernel "rnea", the only
   one) with these arrays in this order, which rnea_info lists. Without it: the kernel ROBOT_OPERATION_rnea_kernel(arrays,
   count) and, built by nvcc, ROBOT_OPERATION_rnea_launch(arrays, count, stream); in C ROBOT_OPERATION_rnea(arrays),
   _rnea_batch(arrays, count) and _rnea_slice(pointers, count, first, end). ROBOT is the robot's name as an identifier. */
#include "cli/files.h"
#include "operations.h"
#include <stdio.h>
#include <stdlib.h>

struct variant {
	const char *suffix;
	enum rneagen_target target;
	enum rneagen_precision precision;
};

static const struct variant VARIANTS[] = {{"f32.cu", RNEAGEN_TARGET_CUDA, RNEAGEN_F32},
	{"f64.cu", RNEAGEN_TARGET_CUDA, RNEAGEN_F64}, {"f32.c", RNEAGEN_TARGET_C, RNEAGEN_F32},
	{"f64.c", RNEAGEN_TARGET_C, RNEAGEN_F64}};

static enum rneagen_code write_text(const char *path, const struct file_content *urdf, const char *folder,
	enum operation operation, const struct variant *v, struct rneagen_error *e)
{
	struct rneagen_options o = rneagen_options_default();
	struct arena a;
	const char *text;
	char out[4096];

	o.file = path;
	o.scene = "params urdf"; /* each of the six in the links' own frames */
	o.target = v->target;
	o.precision = v->precision;
	if ((size_t)snprintf(out, sizeof out, "%s/%s_%s", folder, OPERATION_NAMES[operation], v->suffix) >= sizeof out)
		return error_set(e, RNEAGEN_WRITE, "%.255s...: the name of the folder is too long; take a shorter one", folder);
	arena_init(&a, NULL);
	if (!operation_text(urdf->bytes, urdf->length, operation, &o, &a, &text, e))
		file_write_pair(out, text, NULL, e);
	arena_free(&a);
	return e->code;
}

static enum rneagen_code write_all(const char *path, const char *folder, struct rneagen_error *e)
{
	struct file_content urdf = {0};

	if (file_read(path, &urdf, e))
		return e->code;
	for (int i = 0; i < OPERATION_COUNT; i++)
		for (size_t k = 0; k < sizeof VARIANTS / sizeof *VARIANTS && !e->code; k++)
			write_text(path, &urdf, folder, (enum operation)i, &VARIANTS[k], e);
	free(urdf.bytes);
	return e->code;
}

int main(int argc, char **argv)
{
	struct rneagen_error e = {0};

	if (argc != 3) {
		fprintf(stderr, "usage: six_texts ROBOT.urdf FOLDER\n");
		return 2;
	}
	if (write_all(argv[1], argv[2], &e)) {
		fprintf(stderr, "six_texts: %s\n", e.message);
		return 1;
	}
	return 0;
}
