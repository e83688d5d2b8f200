/* The parser of the info table: what is right, and each way to be wrong. */
#include "test_runtime.h"
#include "core/info_table.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEAD "rneagen-info 1\n" NAMES
#define NAMES "name arm\nprecision f64\nlayout aos\ntrig bounded\nbase floating\n"
#define SIZES "nq 8\nnv 7\nnb 2\nblock 64\n"
#define ARRAYS "input q 8 f64 sample\ninput gravity 3 f32 batch\noutput tau 7 f64 sample\n"
#define MATRIX "output M 3 f64 sample\noutput g 2 f64 sample\n"                                                             \
	"matrix g 2 3 general\nrow g 0 2\nrow g 1 0\nmatrix M 2 2 lower\nrow M 0 0\nrow M 1 0 1\n"
#define COUNTS "operations 10 20 30 40 50 60\n"
#define JOINTS "joint 0 7 0 6 floating \njoint 7 1 6 1 revolute an odd  name\n"

static enum rnea_code parse(const char *text, struct rnea_info *info, struct rnea_error *e)
{
	*e = (struct rnea_error){0};
	return rnea_info_parse(text, strlen(text), info, e);
}

START_TEST(reads_everything)
{
	struct rnea_info i;
	struct rnea_error e;

	ck_assert_int_eq(parse(HEAD SIZES ARRAYS COUNTS JOINTS, &i, &e), RNEA_OK);
	ck_assert_str_eq(i.name, "arm");
	ck_assert(i.precision == RNEA_F64 && i.layout == RNEA_AOS && i.block == 64);
	ck_assert_str_eq(i.arithmetic, "f64"); /* the precision, as nothing else is said */
	ck_assert_str_eq(i.trig, "bounded");
	ck_assert_str_eq(i.base, "floating");
	ck_assert(i.nq == 8 && i.nv == 7 && i.nb == 2);
	ck_assert(i.input_count == 2 && i.output_count == 1 && i.joint_count == 2);
	ck_assert_str_eq(i.arguments[1].name, "gravity");
	ck_assert(i.arguments[1].rows == 3 && i.arguments[1].scalar == RNEA_F32 && i.arguments[1].per_batch);
	ck_assert(i.arguments[2].rows == 7 && i.arguments[2].scalar == RNEA_F64 && !i.arguments[2].per_batch);
	ck_assert_str_eq(i.joints[0].name, "");
	ck_assert_str_eq(i.joints[0].type, "floating");
	ck_assert_str_eq(i.joints[1].name, "an odd  name");
	ck_assert(i.joints[1].iq == 7 && i.joints[1].nq == 1 && i.joints[1].iv == 6 && i.joints[1].nv == 1);
	ck_assert(i.operations.mul == 10 && i.operations.add == 20 && i.operations.sub == 30);
	ck_assert(i.operations.neg == 40 && i.operations.fma == 50 && i.operations.sincos == 60);
	rnea_info_free(&i);
	ck_assert_ptr_null(i.memory);
}
END_TEST

START_TEST(reads_parts)
{
	struct rnea_info i;
	struct rnea_error e;

	ck_assert_int_eq(parse(HEAD SIZES ARRAYS COUNTS, &i, &e), RNEA_OK);
	ck_assert_uint_eq(i.parts, 1);
	rnea_info_free(&i);
	ck_assert_int_eq(parse("rneagen-info 2\n" NAMES SIZES "parts 3\n" ARRAYS COUNTS, &i, &e), RNEA_OK);
	ck_assert_uint_eq(i.parts, 3);
	rnea_info_free(&i);
}
END_TEST

/* Of any version; texts of before have none, and are staged all the same in memory of the kernel's own. */
START_TEST(reads_stage)
{
	struct rnea_info i;
	struct rnea_error e;

	ck_assert_int_eq(parse(HEAD SIZES ARRAYS COUNTS, &i, &e), RNEA_OK);
	ck_assert_uint_eq(i.stage_bytes, 0);
	rnea_info_free(&i);
	ck_assert_int_eq(parse(HEAD SIZES "stage 696\n" ARRAYS COUNTS, &i, &e), RNEA_OK);
	ck_assert_uint_eq(i.stage_bytes, 696);
	rnea_info_free(&i);
}
END_TEST

START_TEST(reads_kernels)
{
	struct rnea_info i;
	struct rnea_error e;

	ck_assert_int_eq(parse(HEAD SIZES ARRAYS COUNTS, &i, &e), RNEA_OK);
	ck_assert(i.is_guessed && i.function_count == 3);
	ck_assert_str_eq(i.functions[2].name, "bpass");
	ck_assert(i.functions[1].input_count == 2 && i.functions[1].output_count == 3 && i.functions[1].arguments[4].rows == 12);
	ck_assert(i.functions[2].arguments[0].rows == 8 && i.functions[2].arguments[0].role == RNEA_ROLE_JOINT_POSITION);
	rnea_info_free(&i);
	ck_assert_int_eq(parse(HEAD SIZES "kernels rnea\n" ARRAYS COUNTS, &i, &e), RNEA_OK);
	ck_assert(!i.is_guessed && i.function_count == 1);
	ck_assert_str_eq(i.functions[0].name, "rnea");
	ck_assert(i.functions[0].arguments == i.arguments && i.arguments[2].role == RNEA_ROLE_JOINT_TORQUE);
	rnea_info_free(&i);
	/* one of a later version, too */
	ck_assert_int_eq(parse(HEAD SIZES "kernels bpass rnea aba\n" ARRAYS COUNTS, &i, &e), RNEA_OK);
	ck_assert(!i.is_guessed && i.function_count == 2);
	ck_assert_str_eq(i.functions[1].name, "bpass");
	rnea_info_free(&i);
}
END_TEST

#define THREE "rneagen-info 3\n" NAMES SIZES
#define FIRST "function rnea\ninput q 8 f64 sample joint_position\ninput p 10 f64 batch link_payload left  hand\n"          \
	"output tau 7 f64 sample joint_torque\noutput M 3 f64 sample mass_matrix\nmatrix M 2 2 lower\nrow M 0 0\nrow M 1 0 1\n" \
	COUNTS
#define SECOND                                                                                                         \
	"function fd\ninput tau 7 f64 sample joint_torque\noutput x 2 f64 sample of_a_later_version\nstage 72\nparts " \
	"2\nlimbs 4 2 1408 4096\nrelay 49664 3 264\nstart_limbs 8 1 520 32\nstart_parts 2\nhands 3\n"                               \
	"part_kernels 16896 5 64 90\ntiles 0 7 1 2\nthreads 2 96\ntranspose 16 256 512\n"                              \
	"operations 1 2 3 4 5 6\n"

/* Since version 7 each kernel of hands has a number. */
START_TEST(reads_hands)
{
	struct rnea_info i;
	struct rnea_error e;

	ck_assert_msg(parse("rneagen-info 7\n" NAMES SIZES "function rnea\ninput q 8 f64 sample joint_position\n"
		"output tau 7 f64 sample joint_torque\nhands 3 1 2 1 1 1 1 4\n" COUNTS JOINTS, &i, &e) == RNEA_OK, "%s", e.message);
	ck_assert(i.functions->hands[0] == 3 && i.functions->hands[2] == 2 && i.functions->hands[RNEA_HANDS_LIMIT - 1] == 4);
	rnea_info_free(&i);
}
END_TEST

/* Any number of functions, each with its own of everything; a role that is not known is none. */
START_TEST(reads_functions)
{
	const struct rnea_function *f;
	struct rnea_info i;
	struct rnea_error e;

	ck_assert_msg(parse(THREE FIRST SECOND JOINTS, &i, &e) == RNEA_OK, "%s", e.message);
	f = i.functions;
	ck_assert(i.version == 3 && i.function_count == 2 && !i.is_guessed && i.joint_count == 2);
	ck_assert(i.arguments == f->arguments && i.input_count == 2 && i.output_count == 2 && i.operations.mul == 10);
	ck_assert(i.parts == 1 && i.stage_bytes == 0 && i.matrices == f->matrices && i.matrix_count == 1);
	ck_assert(f[0].arguments[0].role == RNEA_ROLE_JOINT_POSITION && f[0].arguments[3].role == RNEA_ROLE_MASS_MATRIX);
	ck_assert_str_eq(f[0].arguments[0].of, "");
	ck_assert(f[0].arguments[1].role == RNEA_ROLE_LINK_PAYLOAD && f[0].arguments[1].per_batch);
	ck_assert_str_eq(f[0].arguments[1].of, "left  hand");
	ck_assert_str_eq(f[1].name, "fd");
	ck_assert(f[1].input_count == 1 && f[1].output_count == 1 && f[1].arguments[1].role == RNEA_ROLE_UNKNOWN);
	ck_assert(f[0].limbs.warps == 0 && f[0].limbs.most == 0);
	ck_assert(f[1].limbs.warps == 4 && f[1].limbs.groups == 2 && f[1].limbs.bytes == 1408 && f[1].limbs.most == 4096);
	ck_assert(f[0].relay_threads == 0 && f[1].relay_threads == 3 && f[1].relay_samples == 32 && f[1].relay_room == 264 &&
		  f[1].relay_bytes == 49664);
	ck_assert(f[0].hands[0] == 0 && f[1].hands[0] == 3 && f[1].hands[1] == 0);
	ck_assert(f[0].start_limbs.warps == 0 && f[1].start_limbs.warps == 8 && f[1].start_limbs.groups == 1);
	ck_assert(f[1].start_limbs.bytes == 520 && f[1].start_limbs.most == 32);
	ck_assert(f[0].start_parts == 1 && f[1].start_parts == 2 && f[0].part_kernels == 0 && f[1].part_kernels == 16896);
	ck_assert(f[1].part_count == 5 && f[1].part_block == 64 && f[1].part_arch == 90 && f[0].tile_count == 0 && f[1].tile_count == 2);
	ck_assert(f[1].tiles[0].argument == 0 && f[1].tiles[0].rows == 7 && f[1].tiles[1].argument == 1 && f[1].tiles[1].rows == 2);
	ck_assert(f[0].sample_threads == 1 && f[0].most_block == 0 && f[1].sample_threads == 2 && f[1].most_block == 96);
	ck_assert(f[0].transposed_samples == 0 && f[1].transposed_samples == 16 && f[1].transposed_threads == 256 &&
		f[1].transposed_bytes == 512);
	ck_assert(f[1].stage_bytes == 72 && f[1].parts == 2 && f[1].operations.sincos == 6 && f[1].matrix_count == 0);
	rnea_info_free(&i);
}
END_TEST

START_TEST(reads_matrices)
{
	static const int row[] = {0, 1, 0, 1, 1}, col[] = {2, 0, 0, 0, 1};
	const struct rnea_matrix *m;
	struct rnea_info i;
	struct rnea_error e;

	ck_assert_int_eq(parse(HEAD SIZES ARRAYS COUNTS, &i, &e), RNEA_OK);
	ck_assert_uint_eq(i.matrix_count, 0);
	rnea_info_free(&i);
	ck_assert_msg(parse(HEAD SIZES ARRAYS MATRIX COUNTS, &i, &e) == RNEA_OK, "%s", e.message);
	m = i.matrices;
	ck_assert_uint_eq(i.matrix_count, 2);
	ck_assert(m[0].argument == 4 && m[0].rows == 2 && m[0].cols == 3 && !m[0].lower);
	ck_assert(m[1].argument == 3 && m[1].rows == 2 && m[1].cols == 2 && m[1].lower);
	ck_assert(!memcmp(m[0].row, row, 2 * sizeof *row) && !memcmp(m[0].col, col, 2 * sizeof *col));
	ck_assert(!memcmp(m[1].row, row + 2, 3 * sizeof *row) && !memcmp(m[1].col, col + 2, 3 * sizeof *col));
	rnea_info_free(&i);
}
END_TEST

START_TEST(arithmetic_of_its_own)
{
	struct rnea_info i;
	struct rnea_error e;

	ck_assert_int_eq(parse(HEAD "arithmetic f32x2\n" SIZES ARRAYS COUNTS JOINTS, &i, &e), RNEA_OK);
	ck_assert(i.precision == RNEA_F64);
	ck_assert_str_eq(i.arithmetic, "f32x2");
	rnea_info_free(&i);
	ck_assert_int_eq(parse(HEAD "arithmetic f32\narithmetic f32\n" SIZES ARRAYS COUNTS, &i, &e), RNEA_TABLE);
	ck_assert_int_eq(parse(HEAD "arithmetic\n" SIZES ARRAYS COUNTS, &i, &e), RNEA_TABLE);
}
END_TEST

START_TEST(accepts_variations)
{
	static const char *const texts[] = {
		HEAD SIZES ARRAYS COUNTS,			   /* no joint */
		HEAD ARRAYS SIZES JOINTS "operations 1 2 3 4 5 6", /* another order, no final newline */
		HEAD SIZES "later words that mean nothing here\n" ARRAYS "\n" COUNTS JOINTS,
	};
	struct rnea_info i;
	struct rnea_error e;

	for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
		ck_assert_msg(parse(texts[k], &i, &e) == RNEA_OK, "text %zu: %s", k, e.message);
		rnea_info_free(&i);
	}
	/* as a device variable has it: with the NUL of its literal */
	e = (struct rnea_error){0};
	ck_assert_int_eq(rnea_info_parse(texts[0], strlen(texts[0]) + 1, &i, &e), RNEA_OK);
	rnea_info_free(&i);
}
END_TEST

static const struct damage {
	const char *text, *message;
} damages[] = {
	{"", "does not start with \"rneagen-info\""},
	{"hello\n", "does not start with"},
	{"rneagen-info\n", "line 1: a number is missing"},
	{"rneagen-info one\n", "line 1: not a number: \"one\""},
	{"rneagen-info 1 2\n", "line 1: more than expected: \"2\""},
	{"rneagen-info 0\n", "it has version 0, and this library reads versions 1 to 11"},
	{"rneagen-info 12\n", "it has version 12, and this library reads versions 1 to 11"},
	{THREE, "it lists no functions"},
	{"rneagen-info 3\nfunction\n", "line 2: a word is missing"},
	{"rneagen-info 3\nfunction a b\n", "line 2: more than expected: \"b\""},
	{"rneagen-info 3\ninput q 8 f64 sample joint_position\n", "line 2: an array before the first function"},
	{"rneagen-info 3\nparts 2\n", "line 2: before the first function: the key \"parts\""},
	{"rneagen-info 3\nmatrix M 2 2 lower\n", "a matrix, and no output, of the name \"M\""},
	{"rneagen-info 3\nrow M 0 0\n", "a row of no matrix that is begun: \"M\""},
	{"rneagen-info 3\nfunction f\ninput q 8 f64 sample\n", "line 3: a word is missing"},
	{"rneagen-info 3\nfunction f\nfunction g\n", "the key \"operations\" is missing"},
	{"rneagen-info 3\nfunction f\n" COUNTS "function g\n", "it lists no outputs of f"},
	{"rneagen-info 3\n" FIRST "function rnea\n", "a second function of the name \"rnea\""},
	{"rneagen-info 3\n" FIRST SECOND "row M 1 1\n", "a row of no matrix that is begun: \"M\""},
	{THREE FIRST SECOND "output y 1 f64 sample power\noutput y 1 f64 sample power\n", "a second array of the name"},
	{THREE FIRST "function g\n" COUNTS, "it lists no outputs of g"},
	{"rneagen-info 2\n" NAMES SIZES ARRAYS COUNTS, "the key \"parts\" is missing"},
	{"rneagen-info 2\nparts 1\n", "line 2: the number is out of range"},
	{"rneagen-info 2\nparts 65536\n", "line 2: the number is out of range"},
	{"rneagen-info 2\nparts 2\nparts 2\n", "line 3: a second line of the key \"parts\""},
	{"rneagen-info 1\nkernels\n", "line 2: a word is missing"},
	{"rneagen-info 1\nkernels rnea  bpass\n", "line 2: a word is missing"},
	{"rneagen-info 1\nkernels rnea\nkernels rnea\n", "line 3: a second line of the key \"kernels\""},
	{"rneagen-info 1\n", "the key \"name\" is missing"},
	{HEAD ARRAYS COUNTS, "the key \"nq\" is missing"},
	{HEAD SIZES ARRAYS, "the key \"operations\" is missing"},
	{HEAD "name arm\n" SIZES ARRAYS COUNTS, "line 7: a second line of the key \"name\""},
	{"rneagen-info 1\nname\n", "line 2: a word is missing"},
	{"rneagen-info 1\nname two words\n", "line 2: more than expected: \"words\""},
	{"rneagen-info 1\nprecision f16\n", "line 2: not a known word: \"f16\""},
	{"rneagen-info 1\nlayout soaked\n", "line 2: not a known word: \"soaked\""},
	{"rneagen-info 1\nnq -1\n", "line 2: not a number: \"-1\""},
	{"rneagen-info 1\nnq +1\n", "line 2: not a number: \"+1\""},
	{"rneagen-info 1\nnq 0x7\n", "line 2: not a number: \"0x7\""},
	{"rneagen-info 1\nnq  7\n", "line 2: a number is missing"},
	{"rneagen-info 1\nnq\n", "line 2: a number is missing"},
	{"rneagen-info 1\nnq 0\n", "line 2: the number is out of range: \"0\""},
	{"rneagen-info 1\nnq 7 \n", "line 2: more than expected: \"\""},
	{"rneagen-info 1\nnq 7\r\n", "line 2: not a number: \"7 \""},
	{"rneagen-info 1\nnq 18446744073709551616\n", "line 2: the number is too large"},
	{"rneagen-info 1\nnq 99999999999999999999999\n", "line 2: the number is too large"},
	{"rneagen-info 1\nnv 18446744073709551615\n", "line 2: the number is out of range"},
	{"rneagen-info 1\nblock 0\n", "line 2: the number is out of range"},
	{"rneagen-info 1\nblock 1025\n", "line 2: the number is out of range"},
	{"rneagen-info 1\nstage 0\n", "line 2: the number is out of range"},
	{"rneagen-info 1\nstage 49153\n", "line 2: the number is out of range"},
	{"rneagen-info 1\nstage 8\nstage 8\n", "line 3: a second line of the key \"stage\""},
	{"rneagen-info 3\nfunction f\nlimbs 1 1 0 1\n", "line 3: the number is out of range"},
	{"rneagen-info 3\nfunction f\nlimbs 17 1 0 1\n", "line 3: the number is out of range"},
	{"rneagen-info 3\nfunction f\nlimbs 4 0 0 1\n", "line 3: the number is out of range"},
	{"rneagen-info 3\nfunction f\nlimbs 4 2 116225 1\n", "line 3: the number is out of range"}, /* a block has 227 KiB */
	{"rneagen-info 3\nfunction f\nlimbs 4 2 116224 0\n", "line 3: the number is out of range"},
	{"rneagen-info 4\nfunction f\nrelay 0 1 1\n", "line 3: the number is out of range"},
	{"rneagen-info 4\nfunction f\nrelay 232449 1 1\n", "line 3: the number is out of range"}, /* a block has 227 KiB */
	{"rneagen-info 4\nfunction f\nrelay 8 33 1\n", "line 3: the number is out of range"},
	{"rneagen-info 4\nfunction f\nrelay 8 1 0\n", "line 3: the number is out of range"},
	{"rneagen-info 4\nfunction f\nrelay 8 1\n", "line 3: a number is missing"},
	{"rneagen-info 8\nfunction f\nrelay 8 1 1 64\n", "line 3: more than expected: \"64\""}, /* since version 9 */
	{"rneagen-info 9\nfunction f\nrelay 8 1 1\n", "line 3: a number is missing"},
	{"rneagen-info 9\nfunction f\nrelay 8 1 1 31\n", "line 3: the number is out of range"},
	{"rneagen-info 9\nfunction f\nrelay 8 4 1 257\n", "line 3: the number is out of range"}, /* blocks have 1024 threads at most */
	{"rneagen-info 4\nfunction f\nstart_limbs 4 5 0 1\n", "line 3: the number is out of range"},
	{"rneagen-info 5\nfunction f\nhands 0\n", "line 3: the number is out of range"},
	{"rneagen-info 6\nfunction f\nhands 3 2\n", "line 3: more than expected: \"2\""}, /* since version 7 */
	{"rneagen-info 7\nfunction f\nhands 3 0\n", "line 3: the number is out of range"},
	{"rneagen-info 7\nfunction f\nhands 1 1 1 1 1 1 1 1 1\n", "line 3: more than expected: \"1\""},
	{"rneagen-info 6\nfunction f\nstart_parts 1\n", "line 3: the number is out of range"},
	{"rneagen-info 3\nfunction f\npart_kernels 0 1 64 0\n", "line 3: the number is out of range"},
	{"rneagen-info 3\nfunction f\npart_kernels 16896 1 64\n", "line 3: a number is missing"},
	{"rneagen-info 3\nfunction f\npart_kernels 16896 1 512 0\n", "line 3: the number is out of range"},
	{"rneagen-info 8\nfunction f\nthreads 1 32\n", "line 3: the number is out of range"},
	{"rneagen-info 8\nfunction f\nthreads 2 513\n", "line 3: the number is out of range"}, /* blocks have 1024 threads at most */
	{"rneagen-info 8\nfunction f\nthreads 2\n", "line 3: a number is missing"},
	{"rneagen-info 3\nfunction f\ntiles 0 7\n", "line 3: tiles come after the arrays"},
	{"rneagen-info 3\nfunction f\noutput tau 7 f64 sample joint_torque\ntiles 1 7\n", "line 4: the number is out of range"},
	{"rneagen-info 3\nfunction f\noutput tau 7 f64 sample joint_torque\ntiles 0 7 0\n", "line 4: a number is missing"},
	{"rneagen-info 4\nfunction f\nrelay 8\n", "line 3: a number is missing"},
	{HEAD SIZES COUNTS, "it lists no outputs"},
	{HEAD SIZES "input q 8 f64 sample\n" COUNTS, "it lists no outputs"},
	{"rneagen-info 1\noutput tau 7 f64 sample\ninput q 7 f64 sample\n", "line 3: an input after an output"},
	{"rneagen-info 1\ninput q 7 f64 sample\ninput q 7 f64 sample\n", "line 3: a second array of the name \"q\""},
	{"rneagen-info 1\ninput q 7 f64\n", "line 2: not a known word: \"\""},
	{"rneagen-info 1\ninput q 7 f64 sampled\n", "line 2: not a known word: \"sampled\""},
	{"rneagen-info 1\ninput q 7 i32 sample\n", "line 2: not a known word: \"i32\""},
	{"rneagen-info 1\ninput q 0 f64 sample\n", "line 2: the number is out of range"},
	{"rneagen-info 1\ninput q 7 f64 sample more\n", "line 2: more than expected: \"more\""},
	{"rneagen-info 1\ninput\n", "line 2: a word is missing"},
	{"rneagen-info 1\noperations 1 2 3 4 5\n", "line 2: a number is missing"},
	{"rneagen-info 1\noperations 1 2 3 4 5 6 7\n", "line 2: more than expected: \"7\""},
	{"rneagen-info 1\njoint 0 1 0 1 revolute\n", "line 2: the joint has no name"},
	{"rneagen-info 1\njoint 0 1 0 1\n", "line 2: a word is missing"},
	{"rneagen-info 1\njoint 0 1 0 one revolute x\n", "line 2: not a number: \"one\""},
	{HEAD SIZES ARRAYS COUNTS "joint 8 1 0 1 revolute far\n", "joint \"far\" lies outside of q or qd"},
	{HEAD SIZES ARRAYS COUNTS "joint 0 1 7 1 revolute far\n", "joint \"far\" lies outside of q or qd"},
	{HEAD SIZES ARRAYS "matrix M 2 2 lower\n", "a matrix, and no output, of the name \"M\""},
	{HEAD SIZES ARRAYS "matrix q 2 2 lower\n", "a matrix, and no output, of the name \"q\""},
	{HEAD SIZES ARRAYS "matrix\n", "a word is missing"},
	{HEAD SIZES ARRAYS "matrix tau 2 2\n", "not a known word: \"\""},
	{HEAD SIZES ARRAYS "matrix tau 0 2 lower\n", "the number is out of range: \"0\""},
	{HEAD SIZES ARRAYS "matrix tau 2 4294967296 lower\n", "the number is out of range: \"4294967296\""},
	{HEAD SIZES ARRAYS "matrix tau 2 2 upper\n", "not a known word: \"upper\""},
	{HEAD SIZES ARRAYS "matrix tau 2 2 lower 1\n", "more than expected: \"1\""},
	{HEAD SIZES ARRAYS "row tau 0 0\n", "a row of no matrix that is begun: \"tau\""},
	{HEAD SIZES ARRAYS MATRIX "matrix g 2 2 general\n", "a second matrix of the name \"g\""},
	{HEAD SIZES ARRAYS MATRIX "row g 1 1\n", "a row of no matrix that is begun: \"g\""},
	{HEAD SIZES ARRAYS "matrix tau 4 4 general\nrow tau 4 0\n", "the number is out of range: \"4\""},
	{HEAD SIZES ARRAYS "matrix tau 4 4 general\nrow tau 1 0\nrow tau 1 1\n", "the number is out of range: \"1\""},
	{HEAD SIZES ARRAYS "matrix tau 4 4 general\nrow tau 1 0 2 2\n", "the number is out of range: \"2\""},
	{HEAD SIZES ARRAYS "matrix tau 4 4 general\nrow tau 1 4\n", "the number is out of range: \"4\""},
	{HEAD SIZES ARRAYS "matrix tau 4 4 lower\nrow tau 1 2\n", "the number is out of range: \"2\""},
	{HEAD SIZES ARRAYS "matrix tau 4 4 lower\nrow tau 1 1 \n", "a number is missing"},
	{HEAD SIZES ARRAYS "matrix tau 4 4 general\nrow tau 1 0 1 2 3\n" COUNTS,
		"matrix \"tau\" has 4 elements, and its array 7 rows"},
	{HEAD SIZES ARRAYS "matrix tau 4 4 general\n" COUNTS, "matrix \"tau\" has 0 elements"},
};

START_TEST(refuses_damage)
{
	struct rnea_info i;
	struct rnea_error e;

	parse(damages[_i].text, &i, &e);
	assert_error(&e, RNEA_TABLE, damages[_i].message);
	ck_assert_ptr_null(i.memory);
}
END_TEST

START_TEST(refuses_a_nul)
{
	static const char text[] = HEAD SIZES "\0" ARRAYS COUNTS;
	struct rnea_info i;
	struct rnea_error e = {0};

	rnea_info_parse(text, sizeof text, &i, &e);
	assert_error(&e, RNEA_TABLE, "it holds a NUL");
}
END_TEST

START_TEST(refuses_too_many_arrays)
{
	char text[8192] = "rneagen-info 1\n", line[64];
	struct rnea_info i;
	struct rnea_error e;

	for (int k = 0; k <= RNEA_ARGUMENT_LIMIT; k++) {
		snprintf(line, sizeof line, "input q%d 1 f32 sample\n", k);
		strcat(text, line);
	}
	parse(text, &i, &e);
	assert_error(&e, RNEA_TABLE, "line 66: more arrays than a kernel can take");
}
END_TEST

/* Every prefix of a good table is refused or, cut in a name or a count, still a table; none is read past its end. */
START_TEST(survives_any_cut)
{
	static const char *const texts[] = {HEAD SIZES ARRAYS MATRIX COUNTS JOINTS, THREE FIRST SECOND JOINTS};
	const char *text = texts[_i];

	for (size_t n = 0; n <= strlen(text); n++) {
		char *cut = malloc(n ? n : 1);
		struct rnea_info i;
		struct rnea_error e = {0};

		memcpy(cut, text, n);
		if (rnea_info_parse(cut, n, &i, &e) == RNEA_OK)
			rnea_info_free(&i);
		else
			ck_assert_int_eq(e.code, RNEA_TABLE);
		free(cut);
	}
}
END_TEST

Suite *suite_info(void)
{
	Suite *s = suite_create("info");
	TCase *t = tcase_create("info");

	tcase_add_test(t, reads_everything);
	tcase_add_test(t, reads_parts);
	tcase_add_test(t, reads_stage);
	tcase_add_test(t, reads_kernels);
	tcase_add_test(t, reads_functions);
	tcase_add_test(t, reads_hands);
	tcase_add_test(t, reads_matrices);
	tcase_add_test(t, accepts_variations);
	tcase_add_test(t, arithmetic_of_its_own);
	tcase_add_loop_test(t, refuses_damage, 0, (int)(sizeof damages / sizeof *damages));
	tcase_add_test(t, refuses_a_nul);
	tcase_add_test(t, refuses_too_many_arrays);
	tcase_add_loop_test(t, survives_any_cut, 0, 2);
	suite_add_tcase(s, t);
	return s;
}
