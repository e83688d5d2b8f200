#include "emit.h"
#include "template.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A block stages its samples in 48 KiB of shared memory, what every device gives without asking. */
enum { SHARED_BYTES = 48 << 10, BLOCK = 128, SMALLEST_BLOCK = 32 };

/* Where launch bounds pay: see min_blocks. */
enum { ARM_BODIES = 12, MANY_BODIES = 24, FEW_ALIVE = 45, MANY_ALIVE = 60 };

static int gcd(int a, int b)
{
	return b ? gcd(b, a % b) : a;
}

/* Words from one sample's rows to the next one's in shared memory. 32 banks of 4 bytes: even eight threads on a bank are
   cheaper than a gap that breaks the slice up (H100: hyq, 12 rows, 0.93 of the floor instead of 0.78). */
static int pitch(const struct emission *e, int rows)
{
	return e->options->layout == RNEAGEN_SOA || gcd(rows, 128 / e->memory->bytes) <= 8 ? rows : rows | 1;
}

/* Bytes of shared memory that staging takes for one sample. */
static int stage_bytes(const struct emission *e)
{
	return (pitch(e, e->tree->nq) + 2 * pitch(e, e->tree->nv)) * e->memory->bytes;
}

/* Does the rnea kernel fetch its slice into shared memory first? In aos, to move whole lines, wherever 32 samples have
   room; in soa in f64, where inputs that wait in registers leave few threads, as long as 64 have (H100: iiwa14 0.96 of
   the floor instead of 0.86, fetch 0.94 instead of 0.80; but jvrc1, where 32 just fit, 0.47 instead of 0.63). */
static int is_staged(const struct emission *e)
{
	if (emit_is_operation(e))
		return 0;
	if (e->options->layout == RNEAGEN_AOS)
		return SMALLEST_BLOCK * stage_bytes(e) <= SHARED_BYTES;
	return e->arithmetic->bytes == 8 && 2 * SMALLEST_BLOCK * stage_bytes(e) <= SHARED_BYTES;
}

/* Does a sample's first run stand unless an angle turns out to be large? Not where that run fills the registers. */
static int is_optimistic(const struct emission *e)
{
	return e->arithmetic->bytes == 4 && !is_staged(e) && e->tree->body_count < MANY_BODIES;
}

static int block_size(const struct emission *e)
{
	int block = BLOCK;

	while (is_staged(e) && block * stage_bytes(e) > SHARED_BYTES)
		block /= 2;
	return block;
}

/* The most values that are alive at once, if each is made where it stands and dies with its last use: about the registers
   that a kernel needs beside its addresses. */
static int most_alive(const struct emission *e)
{
	const struct dag *d = e->passes[PASS_RNEA].plan.dag;
	uint32_t *last = arena_alloc(e->arena, d->count, sizeof *last);
	int alive = 0, most = 0;

	for (uint32_t i = 0; last && i < d->count; i++)
		for (int k = 0; k < op_arity[d->nodes[i].op]; k++)
			last[d->nodes[i].arg[k].i] = i;
	for (uint32_t i = 0; last && i < d->count; i++) {
		const struct node *n = &d->nodes[i];

		alive += n->op != OP_CONST && last[i] > i;
		most = alive > most ? alive : most;
		for (int k = 0; k < op_arity[n->op]; k++) {
			uint32_t a = n->arg[k].i;

			if (last[a] == i && d->nodes[a].op != OP_CONST) {
				alive--;
				last[a] = 0;
			}
		}
	}
	return most;
}

/* Humanoids in f32 soa gain from room for a third block (H100: 168 registers, no spill), arms of some 50 values from room
   for a sixth (80 registers instead of 93 on iiwa14, no spill: 0.93 of the floor instead of 0.90). Elsewhere the compiler's
   own choice spills least: a bound makes it fetch all inputs first. */
static int min_blocks(const struct emission *e)
{
	int alive;

	if (e->options->target != RNEAGEN_TARGET_CUDA || e->arithmetic->bytes != 4 || is_staged(e) || emit_is_operation(e))
		return 0;
	if (e->tree->body_count > ARM_BODIES)
		return e->tree->body_count >= MANY_BODIES ? 3 : 0;
	alive = most_alive(e);
	return alive >= FEW_ALIVE && alive <= MANY_ALIVE ? 6 : 0;
}

static const char *number(const struct emission *e, int value)
{
	struct text t;

	text_init(&t, e->arena);
	text_printf(&t, "%d", value);
	return text_string(&t);
}

static const char *body_text(const struct emission *e, const struct pass *p)
{
	struct text t, body;

	text_init(&t, e->arena);
	text_init(&body, e->arena);
	emit_body(e, p, &body);
	const struct slot slots[] = {
		{"DOC", p->algorithm->doc}, {"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"PARAMS", emit_params(e, p, PARAMS_PLAIN)},
		{"BODY", text_string(&body)}, {"SMALL_PARAM", emit_has_small(e) ? ", const int small" : ""},
		{"RESULT", emit_has_small(e) ? "int" : "void"},
		{"RETURNS", emit_has_small(e) ? "   Returns whether all angles are small: if not, and `small`, the results mean nothing.\n" : ""},
	};
	template_expand(&t, template_body_in, slots, sizeof slots / sizeof *slots);
	t.failed |= body.failed;
	return t.failed ? NULL : text_string(&t);
}

/* The call of a body with these arguments and stride; in accurate mode behind one test of the sample's angles, where that
   pays: in the whole algorithm. */
static const char *call_text(const struct emission *e, const struct pass *p, const char *indent, const char *arguments,
	const char *q, const char *stride)
{
	const char *name = e->options->name, *pass = p->algorithm->name;
	struct text t;

	text_init(&t, e->arena);
	if (!emit_has_small(e)) {
		text_printf(&t, "%s%s_%s_body(%s, %s);\n", indent, name, pass, arguments, stride);
	} else if (p != &e->passes[PASS_RNEA]) {
		text_printf(&t, "%s%s_%s_body(%s, %s, 0);\n", indent, name, pass, arguments, stride);
	} else {
		text_printf(&t, "%sif (%s_is_small(%s, %s))\n", indent, name, q, stride);
		text_printf(&t, "%s\t%s_rnea_body(%s, %s, 1);\n%selse\n", indent, name, arguments, stride, indent);
		text_printf(&t, "%s\t%s_rnea_body(%s, %s, 0);\n", indent, name, arguments, stride);
	}
	return text_string(&t);
}

/* A sample is taken for one of small angles and computed again if it was not: no test comes before the arithmetic, and no
   input is read twice (H100, 1 M samples: iiwa14 0.96 of the floor instead of 0.94, hyq 0.92 instead of 0.87;
   but atlas 0.86 instead of 0.88). */
static const char *optimistic_call(const struct emission *e, const char *arguments)
{
	struct text t;

	text_init(&t, e->arena);
	text_printf(&t, "\tif (!%s_rnea_body(%s, %s, 1)) {\n", e->options->name, arguments, emit_stride(e));
	text_put(&t, "\t\tasm volatile(\"\" : \"+l\"(k)); /* another k, for all the compiler knows: it keeps nothing for later */\n");
	text_printf(&t, "\t\t%s_rnea_body(%s, %s, 0);\n\t}\n", e->options->name, arguments, emit_stride(e));
	return text_string(&t);
}

static const char *kernel_call(const struct emission *e, const struct pass *p, int staged)
{
	if (staged && e->options->layout == RNEAGEN_SOA)
		return call_text(e, p, "\t", "q_here, qd_here, qdd_here, qdd_here", "q_here", "RNEA_BLOCK");
	if (staged)
		return call_text(e, p, "\t\t", "q_here, qd_here, qdd_here, qdd_here", "q_here", "1");
	if (emit_has_small(e) && is_optimistic(e) && p == &e->passes[PASS_RNEA])
		return optimistic_call(e, emit_params(e, p, PARAMS_AT_SAMPLE));
	return call_text(e, p, "\t", emit_params(e, p, PARAMS_AT_SAMPLE), emit_q_at_sample(e), emit_stride(e));
}

static void put_kernel(const struct emission *e, const struct pass *p, struct text *out)
{
	int staged = is_staged(e) && p == &e->passes[PASS_RNEA];
	int q_pitch = pitch(e, e->tree->nq), v_pitch = pitch(e, e->tree->nv);
	const struct slot slots[] = {
		{"NAME", e->options->name}, {"PASS", p->algorithm->name}, {"T", e->memory->type},
		{"BOUNDS", p == &e->passes[PASS_RNEA] ? "RNEA_BLOCK, RNEA_MIN_BLOCKS" : "RNEA_BLOCK"},
		{"RESTRICT_PARAMS", emit_params(e, p, PARAMS_CUDA_RESTRICT)}, {"CALL", kernel_call(e, p, staged)},
		{"PITCH_Q", number(e, q_pitch)}, {"PITCH_V", number(e, v_pitch)}, {"NQ", number(e, e->tree->nq)},
		{"NV", number(e, e->tree->nv)},
	};

	template_expand(out, !staged ? template_kernel_soa_in : e->options->layout == RNEAGEN_AOS ? template_kernel_aos_in :
		template_kernel_soa_staged_in, slots, sizeof slots / sizeof *slots);
}

static const char *stage_text(const struct emission *e)
{
	const struct slot slots[] = {{"T", e->memory->type}};
	struct text t;

	text_init(&t, e->arena);
	if (is_staged(e))
		template_expand(&t, template_stage_in, slots, 1);
	if (is_staged(e) && e->options->layout == RNEAGEN_AOS)
		template_expand(&t, template_stage_aos_in, slots, 1);
	return text_string(&t);
}

static const char *enum_text(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	text_printf(&t, "enum { %s_nq = %d, %s_nv = %d, %s_nb = %d };", e->options->name, e->tree->nq, e->options->name,
		e->tree->nv, e->options->name, e->tree->body_count);
	return text_string(&t);
}

static const char *dimensions(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	text_printf(&t, "q[%d], qd[%d], qdd[%d] -> tau[%d].", e->tree->nq, e->tree->nv, e->tree->nv, e->tree->nv);
	return text_string(&t);
}

/* The arithmetic of the precision where it is not the compiler's, and the sine and cosine of the mode. */
static const char *sincos_text(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	emit_f32x2(e, &t);
	emit_sincos(e, &t);
	return text_string(&t);
}

/* Torques with their bounds, where they are wanted. */
static const char *bounded_text(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	if (e->options->bounded)
		emit_bounded(e, &t);
	return text_string(&t);
}

static const char *banner_text(const struct emission *e)
{
	struct text t;

	if (e->banner)
		return e->banner;
	text_init(&t, e->arena);
	emit_banner(e, &t);
	return text_string(&t);
}

static const char *info_text(const struct emission *e)
{
	struct text t;

	text_init(&t, e->arena);
	emit_info(e, &t);
	return text_string(&t);
}

/* The largest |q| for which no angle leaves the domain of the bounded functions: a follower turns by a multiple of q. */
static const char *small_limit(const struct emission *e)
{
	real most = 1;
	struct text t;

	for (int k = 0; k < e->tree->body_count; k++)
		if (fabsl(e->tree->bodies[k].multiplier) > most)
			most = fabsl(e->tree->bodies[k].multiplier);
	text_init(&t, e->arena);
	emit_number(e, e->memory, (real)e->arithmetic->domain * (most > 1 ? 0.999L / most : 1), &t); /* less the product's rounding */
	return text_string(&t);
}

/* The test of a sample's angles, in accurate mode. */
static void put_is_small(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {{"NAME", e->options->name}, {"T", e->memory->type}, {"F", e->memory->suffix},
		{"NQ", number(e, e->tree->nq)}, {"LIMIT", small_limit(e)}};

	int host_only = e->options->target == RNEAGEN_TARGET_CUDA && is_optimistic(e);

	if (!emit_has_small(e))
		return;
	text_put(out, host_only ? "#if !defined __CUDACC__\n" : "");
	template_expand(out, template_is_small_in, slots, sizeof slots / sizeof *slots);
	text_put(out, host_only ? "#endif\n" : "");
}

static void put_bodies(const struct emission *e, struct text *out)
{
	put_is_small(e, out);
	for (int i = 0; i < e->pass_count; i++) {
		const char *body = body_text(e, &e->passes[i]);

		if (body)
			text_put(out, body);
		else
			out->failed = 1;
	}
}

void emit_source(const struct emission *e, struct text *out)
{
	static const char *const frames[] = {[RNEAGEN_TARGET_CUDA] = template_kernel_cu_in,
		[RNEAGEN_TARGET_C] = template_function_c_in, [RNEAGEN_TARGET_HEADER] = template_header_h_in};
	const struct pass *p = e->passes;
	struct text bodies, kernels;

	text_init(&bodies, e->arena);
	text_init(&kernels, e->arena);
	put_bodies(e, &bodies);
	for (int i = 0; i < e->pass_count && e->options->target == RNEAGEN_TARGET_CUDA; i++)
		put_kernel(e, &p[i], &kernels);
	const struct slot slots[] = {
		{"BANNER", banner_text(e)}, {"NAME", e->options->name}, {"INFO", info_text(e)},
		{"ARITHMETIC_CUDA", emit_arithmetic(e, ARITHMETIC_FOR_CUDA)},
		{"ARITHMETIC_HEADER", emit_arithmetic(e, ARITHMETIC_FOR_HEADER)}, {"OUTER", e->options->strict ? "RNEA_APART" : "RNEA_INLINE"},
		{"UNDEF_STRICT", e->options->strict ? "#undef RNEA_ADD\n#undef RNEA_SUB\n#undef RNEA_MUL\n#undef RNEA_APART\n" : ""},
		{"BLOCK", number(e, block_size(e))}, {"MIN_BLOCKS", number(e, min_blocks(e))},
		{"SINCOS", sincos_text(e)}, {"BODIES", text_string(&bodies)}, {"STAGE", stage_text(e)},
		{"KERNELS", text_string(&kernels)}, {"PARAMS", emit_params(e, &p[PASS_RNEA], PARAMS_PLAIN)},
		{"ADDRESSES", emit_params(e, &p[PASS_RNEA], PARAMS_ADDRESSES)},
		{"RNEA_PARAMS", emit_params(e, &p[PASS_RNEA], PARAMS_PLAIN)},
		{"HEAD_C", emit_head_c(e)}, {"FUNCTIONS_C", emit_functions_c(e)}, {"BOUNDED", bounded_text(e)},
		{"RNEA_CALL", call_text(e, &p[PASS_RNEA], "\t", emit_params(e, &p[PASS_RNEA], PARAMS_NAMES), "q", "1")}, {"ANY_ANGLE", emit_has_small(e) ? ", 0" : ""},
		{"RNEA_NAMES", emit_params(e, &p[PASS_RNEA], PARAMS_NAMES)},
		{"FPASS_PARAMS", emit_params(e, &p[PASS_FPASS], PARAMS_PLAIN)},
		{"FPASS_NAMES", emit_params(e, &p[PASS_FPASS], PARAMS_NAMES)},
		{"BPASS_PARAMS", emit_params(e, &p[PASS_BPASS], PARAMS_PLAIN)},
		{"BPASS_NAMES", emit_params(e, &p[PASS_BPASS], PARAMS_NAMES)},
		{"PROTOTYPES", emit_prototypes(e)}, {"ENUM", enum_text(e)}, {"DIMENSIONS", dimensions(e)},
	};

	template_expand(out, frames[e->options->target], slots, sizeof slots / sizeof *slots);
	out->failed |= bodies.failed | kernels.failed | e->arena->failed;
}

void emit_declarations(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {
		{"BANNER", banner_text(e)}, {"NAME", e->options->name}, {"ENUM", enum_text(e)}, {"PROTOTYPES", emit_prototypes(e)}};

	template_expand(out, template_function_h_in, slots, sizeof slots / sizeof *slots);
	out->failed |= e->arena->failed;
}

/* `block N` and, as the runtime and the user read them, what the functions take and give. */
void emit_info_shape(const struct emission *e, struct text *out)
{
	const struct argument *a = e->passes[PASS_RNEA].dag.arguments;

	text_printf(out, "block %d\n", block_size(e));
	for (int i = 0; i < e->passes[PASS_RNEA].dag.argument_count; i++)
		text_printf(out, "%s %s %d %s sample\n", a[i].is_output ? "output" : "input", a[i].name, a[i].rows,
			e->memory->name);
}
