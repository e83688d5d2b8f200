#include "study/floor.h"

/* Rows are numbered over all outputs, one array after another. Row r is the sum of row r of every input of samples that has
   one; row 0 has in addition the rows of inputs beyond the last output's, and the inputs that are the same for the whole
   batch. So every number is read once, and every one written once. */
struct floor {
	const struct argument *arrays;
	int count, rows; /* of all outputs */
	struct text *out;
};

/* Rows begin to end - 1 have the same inputs, and belong to one output, whose first row is `first`. */
struct stretch {
	int begin, end, output, first;
};

static int is_input(const struct floor *f, int i)
{
	return !f->arrays[i].is_output && !f->arrays[i].per_batch;
}

/* The stretch that begins at a row. */
static struct stretch stretch_at(const struct floor *f, int row)
{
	struct stretch s = {.begin = row};

	for (int i = 0, first = 0; i < f->count; i++) {
		if (!f->arrays[i].is_output)
			continue;
		if (first <= row) {
			s.output = i;
			s.first = first;
		}
		first += f->arrays[i].rows;
	}
	s.end = s.first + f->arrays[s.output].rows;
	for (int i = 0; i < f->count; i++)
		if (is_input(f, i) && f->arrays[i].rows > row && f->arrays[i].rows < s.end)
			s.end = f->arrays[i].rows;
	return s;
}

/* Does an input have a row that no output has? */
static int is_longer(const struct floor *f)
{
	for (int i = 0; i < f->count; i++)
		if (!f->arrays[i].is_output && (f->arrays[i].per_batch || f->arrays[i].rows > f->rows))
			return 1;
	return 0;
}

/* ---- the head ---- */

static const char HEAD[] =
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
	"\t\"rneagen-info 3\\n\"\n"
	"\t\"name floor\\n\"\n";

static void put_info(const struct floor *f, const char *word)
{
	text_put(f->out, HEAD);
	text_printf(f->out, "\t\"precision %s\\n\"\n", word);
	text_put(f->out, "\t\"layout soa\\n\"\n\t\"trig accurate\\n\"\n\t\"base fixed\\n\"\n");
	text_put(f->out, "\t\"nq 1\\nnv 1\\nnb 1\\nblock 256\\nfunction rnea\\n\"\n");
	for (int i = 0; i < f->count; i++) {
		const struct argument *a = &f->arrays[i];

		text_printf(f->out, "\t\"%s %s %d %s %s %s\\n\"\n", a->is_output ? "output" : "input", a->name, a->rows, word,
			a->per_batch ? "batch" : "sample", role_word(a->role));
	}
	text_put(f->out, "\t\"operations 0 0 0 0 0 0\\n\";\n");
}

/* ---- the kernel ---- */

static void put_kernel_stretch(const struct floor *f, struct stretch s)
{
	const char *plus = "";

	text_printf(f->out, "#pragma unroll 8\n\tfor (size_t r = %d; r < %d; r++)\n\t\ta%d[(r - %d)*count + k] = ", s.begin,
		s.end, s.output, s.first);
	for (int i = 0; i < f->count; i++)
		if (is_input(f, i) && f->arrays[i].rows > s.begin) {
			text_printf(f->out, "%sa%d[r*count + k]", plus, i);
			plus = " + ";
		}
	if (s.begin == 0)
		text_printf(f->out, "%s(r == 0 ? more : 0)", plus);
	else if (!*plus)
		text_put(f->out, "0");
	text_put(f->out, ";\n");
}

static void put_kernel(const struct floor *f)
{
	text_put(f->out, "extern \"C\" __global__ void __launch_bounds__(RNEA_BLOCK)\nfloor_rnea_kernel(");
	for (int i = 0; i < f->count; i++)
		text_printf(f->out, "%sT *__restrict__ a%d, ", f->arrays[i].is_output ? "" : "const ", i);
	text_put(f->out, "size_t count)\n{\n\tsize_t k = (size_t)blockIdx.x*blockDim.x + threadIdx.x;\n\tT more = 0;\n"
			 "\tif (k >= count)\n\t\treturn;\n");
	for (int i = 0; i < f->count; i++)
		if (!f->arrays[i].is_output && f->arrays[i].per_batch)
			text_printf(f->out, "\tfor (size_t r = 0; r < %d; r++)\n\t\tmore += a%d[r];\n", f->arrays[i].rows, i);
		else if (!f->arrays[i].is_output && f->arrays[i].rows > f->rows)
			text_printf(f->out, "\tfor (size_t r = %d; r < %d; r++)\n\t\tmore += a%d[r*count + k];\n", f->rows,
				f->arrays[i].rows, i);
	for (struct stretch s = {0}; s.end < f->rows;) {
		s = stretch_at(f, s.end);
		put_kernel_stretch(f, s);
	}
	text_put(f->out, "}\n");
}

/* ---- the slice ---- */

/* One row of a stretch, by a function of its own, so that the compiler knows that no two arrays overlap. */
static void put_row(const struct floor *f, struct stretch s)
{
	const char *plus = "";

	text_printf(f->out, "static void row_%d(", s.begin);
	for (int i = 0; i < f->count; i++)
		if (is_input(f, i) && f->arrays[i].rows > s.begin)
			text_printf(f->out, "const T *restrict a%d, ", i);
	text_put(f->out, "T *restrict out, size_t n)\n{\n\tfor (size_t k = 0; k < n; k++)\n\t\tout[k] = ");
	for (int i = 0; i < f->count; i++)
		if (is_input(f, i) && f->arrays[i].rows > s.begin) {
			text_printf(f->out, "%sa%d[k]", plus, i);
			plus = " + ";
		}
	text_put(f->out, *plus ? ";\n}\n" : "0;\n}\n");
}

static void put_slice_stretch(const struct floor *f, struct stretch s)
{
	text_printf(f->out, "\tfor (size_t r = %d; r < %d; r++)\n\t\trow_%d(", s.begin, s.end, s.begin);
	for (int i = 0; i < f->count; i++)
		if (is_input(f, i) && f->arrays[i].rows > s.begin)
			text_printf(f->out, "a%d + r*count + first, ", i);
	text_printf(f->out, "a%d + (r - %d)*count + first, end - first);\n", s.output, s.first);
}

/* What row 0 has in addition. */
static void put_slice_more(const struct floor *f, int output)
{
	for (int i = 0; i < f->count; i++)
		if (is_input(f, i) && f->arrays[i].rows > f->rows)
			text_printf(f->out, "\tfor (size_t r = %d; r < %d; r++)\n\t\tmore(a%d + r*count + first, 1, a%d + first, end - first);\n",
				f->rows, f->arrays[i].rows, i, output);
		else if (!f->arrays[i].is_output && f->arrays[i].per_batch)
			text_printf(f->out, "\tfor (size_t r = 0; r < %d; r++)\n\t\tmore(a%d + r, 0, a%d + first, end - first);\n",
				f->arrays[i].rows, i, output);
}

static void put_slice(const struct floor *f)
{
	for (struct stretch s = {0}; s.end < f->rows;) {
		s = stretch_at(f, s.end);
		put_row(f, s);
	}
	if (is_longer(f))
		text_put(f->out, "static void more(const T *restrict a, size_t step, T *restrict out, size_t n)\n{\n"
				 "\tfor (size_t k = 0; k < n; k++)\n\t\tout[k] += a[k*step];\n}\n");
	text_put(f->out, "void floor_rnea_slice(void *const *arrays, size_t count, size_t first, size_t end)\n{\n");
	for (int i = 0; i < f->count; i++)
		text_printf(f->out, "\t%sT *a%d = arrays[%d];\n", f->arrays[i].is_output ? "" : "const ", i, i);
	for (struct stretch s = {0}; s.end < f->rows;) {
		s = stretch_at(f, s.end);
		put_slice_stretch(f, s);
	}
	put_slice_more(f, stretch_at(f, 0).output);
	text_put(f->out, "}\n");
}

void floor_text(const struct argument *arrays, int count, enum rnea_scalar scalar, struct text *out)
{
	struct floor f = {.arrays = arrays, .count = count, .out = out};

	for (int i = 0; i < count; i++)
		f.rows += arrays[i].is_output ? arrays[i].rows : 0;
	text_printf(out, "#define T %s\n", scalar == RNEA_F64 ? "double" : "float");
	put_info(&f, scalar == RNEA_F64 ? "f64" : "f32");
	text_put(out, "#if defined __CUDACC__\n");
	put_kernel(&f);
	text_put(out, "#else\n");
	put_slice(&f);
	text_put(out, "#endif\n");
}
