/* What RNEA_FMA and, where the same bits are wanted everywhere, every other operation of the statements means. */
#include "emit/emit.h"
#include "emit/template.h"

const char *const emit_operation[OP_COUNT] = {
	[OP_NEG] = "neg", [OP_ADD] = "add", [OP_SUB] = "sub", [OP_MUL] = "mul", [OP_FMA] = "fma", [OP_DIV] = "div", [OP_SQRT] = "sqrt"};

static void expand(const struct emission *e, const char *tmpl, struct text *out)
{
	int f32 = e->arithmetic->bytes == 4;
	const struct slot slots[] = {{"F", e->arithmetic->suffix}, {"D", f32 ? "f" : "d"}, {"FMA_SUFFIX_UPPER", f32 ? "F" : ""}};

	template_expand(out, tmpl, slots, sizeof slots / sizeof *slots);
}

/* Only floats are flushed to zero. */
static void put_strict_cuda(const struct emission *e, struct text *out)
{
	expand(e, template_arithmetic_strict_cuda_in, out);
	if (e->arithmetic->bytes == 4)
		text_put(out, template_arithmetic_strict_flush_in);
}

/* A header is compiled for CPU and GPU: on the latter the operations themselves keep the caller's apart. */
static void put_strict_header(const struct emission *e, struct text *out)
{
	text_put(out, "#if defined __CUDA_ARCH__\n#define RNEA_APART RNEA_INLINE\n");
	put_strict_cuda(e, out);
	text_put(out, "#else\n");
	expand(e, template_arithmetic_strict_c_in, out);
	text_put(out, "#endif\n");
}

const char *emit_arithmetic(const struct emission *e, enum arithmetic_for compiler)
{
	static const char *const plain[] = {template_arithmetic_c_in, template_arithmetic_cuda_in, template_arithmetic_header_in};
	struct text t;

	text_init(&t, e->arena);
	if (!e->options->strict)
		expand(e, plain[compiler], &t);
	else if (compiler == ARITHMETIC_FOR_HEADER)
		put_strict_header(e, &t);
	else if (compiler == ARITHMETIC_FOR_C)
		expand(e, template_arithmetic_strict_c_in, &t);
	else
		put_strict_cuda(e, &t);
	return text_string(&t);
}
