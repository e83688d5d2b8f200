#include "floor.h"
#include <stdio.h>
#include <stdlib.h>

enum { FLOOR_SIZE = 8192 };

/* T type, N and M rows; a quaternion has one row more than its rates: it is added to the last. */
static const char FRAME[] =
	"#define T %s\n"
	"#define N %zu\n"
	"#define M %zu\n"
	"#if defined __CUDACC__\n"
	"#define RNEA_INFO __device__\n"
	"#ifndef RNEA_BLOCK\n"
	"#define RNEA_BLOCK 256\n"
	"#endif\n"
	"extern \"C\" {\n"
	"extern RNEA_INFO const char floor_info[];\n"
	"}\n"
	"#else\n"
	"#include <stddef.h>\n"
	"#define RNEA_INFO\n"
	"#endif\n"
	"RNEA_INFO const char floor_info[] =\n"
	"\t\"rneagen-info 1\\n\"\n"
	"\t\"name floor\\n\"\n"
	"\t\"precision %s\\n\"\n"
	"\t\"layout soa\\n\"\n"
	"\t\"trig accurate\\n\"\n"
	"\t\"base fixed\\n\"\n"
	"\t\"nq %zu\\nnv %zu\\nnb 1\\nblock 256\\n\"\n"
	"\t\"input q %zu %s sample\\ninput qd %zu %s sample\\ninput qdd %zu %s sample\\noutput tau %zu %s sample\\n\"\n"
	"\t\"operations 0 0 0 0 0 0\\n\";\n"
	"#if defined __CUDACC__\n"
	"extern \"C\" __global__ void __launch_bounds__(RNEA_BLOCK)\n"
	"floor_rnea_kernel(const T *__restrict__ q, const T *__restrict__ qd, const T *__restrict__ qdd, T *__restrict__ tau,\n"
	"\tsize_t count)\n"
	"{\n"
	"\tsize_t k = (size_t)blockIdx.x*blockDim.x + threadIdx.x;\n"
	"\tT more = 0;\n"
	"\tif (k >= count)\n"
	"\t\treturn;\n"
	"\tfor (size_t r = M; r < N; r++)\n"
	"\t\tmore += q[r*count + k];\n"
	"#pragma unroll 8\n"
	"\tfor (size_t r = 0; r < M; r++)\n"
	"\t\ttau[r*count + k] = q[(r < N ? r : 0)*count + k] + qd[r*count + k] + qdd[r*count + k] + (r == 0 ? more : 0);\n"
	"}\n"
	"#else\n"
	"static void row(const T *restrict q, const T *restrict qd, const T *restrict qdd, T *restrict tau, size_t n)\n"
	"{\n"
	"\tfor (size_t k = 0; k < n; k++)\n"
	"\t\ttau[k] = q[k] + qd[k] + qdd[k];\n"
	"}\n"
	"static void more(const T *restrict q, T *restrict tau, size_t n)\n"
	"{\n"
	"\tfor (size_t k = 0; k < n; k++)\n"
	"\t\ttau[k] += q[k];\n"
	"}\n"
	"void floor_rnea_slice(void *const *arrays, size_t count, size_t first, size_t end)\n"
	"{\n"
	"\tconst T *q = arrays[0], *qd = arrays[1], *qdd = arrays[2];\n"
	"\tT *tau = arrays[3];\n"
	"\tfor (size_t r = 0; r < M; r++)\n"
	"\t\trow(q + (r < N ? r : 0)*count + first, qd + r*count + first, qdd + r*count + first, tau + r*count + first,\n"
	"\t\t\tend - first);\n"
	"\tfor (size_t r = M; r < N; r++)\n"
	"\t\tmore(q + r*count + first, tau + first, end - first);\n"
	"}\n"
	"#endif\n";

char *floor_text(size_t nq, size_t nv, enum rnea_scalar scalar)
{
	const char *word = scalar == RNEA_F64 ? "f64" : "f32";
	char *text = malloc(FLOOR_SIZE);

	if (text)
		snprintf(text, FLOOR_SIZE, FRAME, scalar == RNEA_F64 ? "double" : "float", nq, nv, word, nq, nv, nq, word, nv,
			word, nv, word, nv, word);
	return text;
}
