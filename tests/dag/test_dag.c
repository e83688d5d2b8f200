/* The rules of the expression DAG: what is built, and what comes out. Notation: expression.h. */
#include "support/expression.h"
#include "support/suite.h"
#include <stdlib.h>
#include <string.h>

static struct arena arena;
static struct dag dag, fused;

static void open(void)
{
	arena_init(&arena, NULL);
	expression_init(&dag, &arena);
}

static void close(void)
{
	arena_free(&arena);
}

struct row {
	const char *built, *want;
};

static const struct row rules[] = {
	/* constants meet */
	{"n 2", "-2"}, {"n 0", "0"}, {"+ 2 3", "5"}, {"- 2 3", "-1"}, {"* 2 3", "6"}, {"* -2 3", "-6"}, {"s 0", "0"},
	{"c 0", "1"}, {"+ 0.1 -0.1", "0"}, {"- -0 0", "0"}, {"* -0 2", "0"}, {"n -0", "0"},
	/* the noise of doubles is zero, what is small is not */
	{"+ 1 -1.0000000000000002", "0"}, {"- 1 1.0000000000000002", "0"}, {"- 1 1.0000152587890625", "-1.52587890625e-05"},
	{"+ 0x1p-100 0x1p-100", "1.57772181044202361082e-30"}, {"- 0.25 -0.25", "0.5"},
	/* the sign */
	{"n n x", "x"}, {"n x", "n x"}, {"n + x y", "n + x y"}, {"n - x y", "n - x y"}, {"- y x; n - x y", "- y x"},
	{"- x y; n - x y", "n - x y"}, {"n * x y", "n * x y"}, {"n * 2 x", "n * 2 x"},
	/* sums */
	{"+ x 0", "x"}, {"+ 0 x", "x"}, {"+ x y", "+ x y"}, {"+ y x", "+ x y"}, {"+ x 2", "+ 2 x"}, {"+ 2 x", "+ 2 x"},
	{"+ n x n y", "n + x y"}, {"+ x n y", "- x y"}, {"+ n x y", "- y x"}, {"+ -2 x", "- x 2"}, {"+ x -2", "- x 2"},
	{"+ x x", "+ x x"}, {"+ x n x", "0"}, {"+ n x x", "0"}, {"+ n x 2", "- 2 x"}, {"+ n x -2", "- -2 x"},
	{"+ n x 0", "n x"}, {"+ 2 n x", "- 2 x"}, {"+ -2 n x", "- -2 x"},
	/* differences */
	{"- x x", "0"}, {"- x 0", "x"}, {"- 0 x", "n x"}, {"- 0 n x", "x"}, {"- x y", "- x y"}, {"- y x", "- y x"},
	{"- x n y", "+ x y"}, {"- n x y", "n + x y"}, {"- n x n y", "- y x"}, {"- x -2", "+ 2 x"}, {"- x 2", "- x 2"},
	{"- 2 x", "- 2 x"}, {"- -2 x", "- -2 x"}, {"- x y; - y x", "n - x y"}, {"- n x 2", "n + 2 x"},
	{"- n x -2", "n - x 2"}, {"- 0 - x y", "n - x y"},
	/* products */
	{"* x 0", "0"}, {"* 0 x", "0"}, {"* 0 n x", "0"}, {"* s x 0", "0"}, {"* x 1", "x"}, {"* 1 x", "x"}, {"* x -1", "n x"},
	{"* -1 n x", "x"}, {"* x y", "* x y"}, {"* y x", "* x y"}, {"* x 2", "* 2 x"}, {"* x x", "* x x"}, {"* n x y", "n * x y"},
	{"* x n y", "n * x y"}, {"* n x n y", "* x y"}, {"* -2 x", "n * 2 x"}, {"* x -2", "n * 2 x"}, {"* -2 n x", "* 2 x"},
	{"* 2 n x", "n * 2 x"}, {"* 2 * 3 x", "* 6 x"}, {"* 0.5 * 2 x", "x"}, {"* -2 * 3 x", "n * 6 x"},
	{"* 2 * -3 x", "n * 6 x"}, {"* -2 * -3 x", "* 6 x"}, {"* 2 * x 3", "* 6 x"}, {"* 0 * 3 x", "0"},
	{"* 0x1p-100 x", "* 7.88860905221011805412e-31 x"},
	/* what is not touched: no re-association, nothing distributed, products of products as they came */
	{"+ + x y z", "+ z + x y"}, {"+ x + y z", "+ x + y z"}, {"+ 2 + 3 x", "+ 2 + 3 x"}, {"- - x y y", "- - x y y"},
	{"- + x y x", "- + x y x"}, {"+ - x y y", "+ y - x y"}, {"* * x y z", "* z * x y"}, {"* x * y z", "* x * y z"},
	{"* * 2 x * 3 y", "* * 2 x * 3 y"}, {"* x * 2 y", "* x * 2 y"}, {"* 2 + 3 x", "* 2 + 3 x"},
	{"+ * x y * x z", "+ * x y * x z"}, {"+ * 2 x * 3 x", "+ * 2 x * 3 x"}, {"- + 2 x 2", "- + 2 x 2"},
	/* sine and cosine */
	{"s x", "s x"}, {"c x", "c x"}, {"s n x", "n s x"}, {"c n x", "c x"}, {"+ * s x s x * c x c x", "+ * s x s x * c x c x"},
	/* a*b + c is kept as it is, a and b in order */
	{"f x y z", "f x y z"}, {"f y x z", "f x y z"}, {"f x 2 z", "f 2 x z"},
};

START_TEST(rule)
{
	const struct row *r = &rules[_i];
	struct text t;

	text_init(&t, &arena);
	expression_print(&dag, expression_build(&dag, r->built), &t);
	ck_assert_msg(!strcmp(text_string(&t), r->want), "%s gives %s, not %s", r->built, text_string(&t), r->want);
	ck_assert(!dag.failed);
}
END_TEST

/* Two ways to write one value. */
static const struct row shared[] = {
	{"+ x y", "+ y x"}, {"* x y", "* y x"}, {"* 2 x", "* x 2"}, {"- x y", "+ x n y"}, {"- x y", "+ n y x"},
	{"s + x y", "s + y x"}, {"n * x y", "* n x y"}, {"n * x y", "* y n x"}, {"* 6 x", "* 2 * x 3"}, {"- x 2", "+ -2 x"},
	{"0", "- x x"}, {"0", "-0"}, {"0", "* 0 y"}, {"0.5", "* 0.25 2"}, {"f x y z", "f y x z"}, {"+ c x c y", "+ c n y c n x"},
};

START_TEST(equal_values_share_a_node)
{
	const struct row *r = &shared[_i];
	struct ref first = expression_build(&dag, r->built), second = expression_build(&dag, r->want);

	ck_assert_msg(ref_equal(first, second), "%s and %s: nodes %u and %u", r->built, r->want, first.i, second.i);
}
END_TEST

START_TEST(different_values_do_not_share)
{
	static const char *const all[] = {"x", "y", "+ x y", "- x y", "- y z", "* x y", "s x", "c x", "f x y z", "f x z y", "1",
		"1.0000000000000000001", "0.1", "n x", "+ 1 x", "0"};
	struct ref refs[sizeof all / sizeof *all];

	for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
		refs[i] = expression_build(&dag, all[i]);
		for (size_t k = 0; k < i; k++)
			ck_assert_msg(!ref_equal(refs[i], refs[k]), "%s and %s", all[i], all[k]);
	}
}
END_TEST

START_TEST(sharing_survives_growth)
{
	struct ref refs[5000];
	size_t count;

	for (int i = 0; i < 5000; i++)
		refs[i] = dag_add(&dag, dag_const(&dag, i + 1), dag_input(&dag, 0, i % 4));
	count = dag.count;
	for (int i = 0; i < 5000; i++)
		ck_assert_uint_eq(dag_add(&dag, dag_input(&dag, 0, i % 4), dag_const(&dag, i + 1)).i, refs[i].i);
	ck_assert_uint_eq(dag.count, count);
	for (size_t i = 0; i < dag.count; i++)
		for (int k = 0; k < op_arity[dag.nodes[i].op]; k++)
			ck_assert_uint_lt(dag.nodes[i].arg[k].i, i);
}
END_TEST

START_TEST(tags_name_and_do_not_share)
{
	struct ref a = expression_build(&dag, "+ x y");

	dag_tag(&dag, a, "w", 3, 'x');
	dag_tag(&dag, a, "dw", 4, 'y');
	dag_tag(&dag, dag_const(&dag, 7), "w", 1, 'z');
	ck_assert_str_eq(dag.nodes[a.i].tag.quantity, "w");
	ck_assert_int_eq(dag.nodes[a.i].tag.body, 3);
	ck_assert_str_eq(dag.nodes[dag_const(&dag, 7).i].tag.quantity, "");
	ck_assert_uint_eq(expression_build(&dag, "+ y x").i, a.i);
}
END_TEST

/* ---- fuse ---- */

static const struct row fusions[] = {
	/* a product of one use joins its sum */
	{"+ x * y z", "f y z x"}, {"+ * y z x", "f y z x"}, {"- x * y z", "f z n y x"}, {"- * y z x", "f y z n x"},
	{"- x * 2 y", "f -2 y x"}, {"- * 2 y x", "f 2 y n x"}, {"+ 3 * x y", "f x y 3"}, {"- 3 * x y", "f y n x 3"},
	{"- * x y 3", "f x y -3"}, {"+ * x y * z w", "f z w * x y"}, {"- * x y * z w", "f w n z * x y"},
	{"+ x + * y z * y w", "+ x f y w * y z"}, {"+ + x * y z * y w", "f y w f y z x"}, {"s + x * y z", "s f y z x"},
	{"+ * x x y", "f x x y"},
	/* one that is shared, or is an output itself, does not */
	{"* y z; + x * y z", "* y z; + x * y z"}, {"+ x * y z; + w * y z", "+ x * y z; + w * y z"},
	{"+ * x y * x y", "+ * x y * x y"}, {"* * x y * x y", "* * x y * x y"}, {"+ s * x y * x y", "+ * x y s * x y"},
	{"+ * x y * y x", "+ * x y * x y"},
	/* of two, the one that is free */
	{"* z w; + * x y * z w", "* z w; f x y * z w"}, {"* x y; - * x y * z w", "* x y; f w n z * x y"},
	{"* z w; - * x y * z w", "* z w; f x y n * z w"},
	/* signs where they cost nothing */
	{"n - x y", "- y x"}, {"n * 2 x", "* -2 x"}, {"n * x y", "n * x y"}, {"n + x y", "n + x y"}, {"n x", "n x"},
	{"- x y; n - x y", "- x y; n - x y"}, {"* 2 x; n * 2 x", "* 2 x; n * 2 x"}, {"n - x * y z", "n f z n y x"},
	/* the rest passes */
	{"x", "x"}, {"0", "0"}, {"2", "2"}, {"+ x y", "+ x y"}, {"* c x s y", "* c x s y"}, {"+ 2 + 3 x", "+ 2 + 3 x"},
};

START_TEST(fusion)
{
	const struct row *r = &fusions[_i];
	struct text t;

	text_init(&t, &arena);
	expression_build(&dag, r->built);
	dag_init(&fused, &arena);
	dag_fuse(&fused, &dag, 0);
	expression_print_outputs(&fused, &t);
	ck_assert_msg(!strcmp(text_string(&t), r->want), "%s gives %s, not %s", r->built, text_string(&t), r->want);
}
END_TEST

/* Every product joined to every sum. */
static const struct row joins[] = {
	{"* x y; + * x y z", "* x y; f x y z"}, {"+ * x y z; + * x y w", "f x y z; f x y w"}, {"+ * x y * x y", "f x y * x y"},
	{"- z * x y; * x y", "f y n x z; * x y"}, {"- * x y z; * x y", "f x y n z; * x y"},
	{"n * x y; + z * x y", "n * x y; f x y z"}, {"+ x * y z", "f y z x"}, {"+ x y", "+ x y"},
};

START_TEST(fusion_of_every_product)
{
	const struct row *r = &joins[_i];
	struct text t;

	text_init(&t, &arena);
	expression_build(&dag, r->built);
	dag_init(&fused, &arena);
	dag_fuse(&fused, &dag, 1);
	expression_print_outputs(&fused, &t);
	ck_assert_msg(!strcmp(text_string(&t), r->want), "%s gives %s, not %s", r->built, text_string(&t), r->want);
}
END_TEST

START_TEST(fuse_drops_dead_code)
{
	uint32_t uses[64];

	expression_build(&dag, "* c x + y z");
	expression_build(&dag, "+ x * y z");
	dag.outputs[0] = dag.outputs[1];
	dag.output_count = 1;
	dag_init(&fused, &arena);
	dag_fuse(&fused, &dag, 0);
	ck_assert_uint_eq(fused.count, 1 + 3 + 1); /* the constant 0, x y z, their FMA */
	ck_assert_uint_eq(fused.output_count, 1);
	dag_uses(&fused, uses);
	for (size_t i = 1; i < fused.count; i++)
		ck_assert_uint_eq(uses[i], 1);
	dag_uses(&dag, uses);
	ck_assert_uint_eq(uses[dag_cos(&dag, dag_input(&dag, 0, 0)).i], 0);
}
END_TEST

/* Sections and outputs stand where they stood, among the nodes that are left. */
START_TEST(fuse_keeps_places)
{
	struct ref product, sum;

	dag_section(&dag, SECTION_OUT, 0);
	product = expression_build(&dag, "* x y");
	dag_section(&dag, SECTION_OUT, 1);
	expression_build(&dag, "s w"); /* dead: its output is taken back */
	dag.output_count--;
	dag_section(&dag, SECTION_BACK, 1);
	sum = dag_add(&dag, product, dag_input(&dag, 0, 2));
	dag_output(&dag, 1, 7, dag_cos(&dag, sum));
	dag_section(&dag, SECTION_END, 0);
	dag_init(&fused, &arena);
	dag_fuse(&fused, &dag, 0);
	ck_assert_uint_eq(fused.section_count, 4);
	for (size_t i = 0; i < 4; i++) {
		ck_assert_int_eq(fused.sections[i].kind, dag.sections[i].kind);
		ck_assert_int_eq(fused.sections[i].body, dag.sections[i].body);
		ck_assert_uint_eq(fused.sections[i].output, dag.sections[i].output);
	}
	/* nodes: 0; x y z, x*y | | sum, cos | end; w was dead */
	ck_assert_uint_eq(fused.sections[0].node, 4);
	ck_assert_uint_eq(fused.sections[1].node, 5);
	ck_assert_uint_eq(fused.sections[2].node, 5);
	ck_assert_uint_eq(fused.sections[3].node, 7);
	ck_assert_uint_eq(fused.output_count, 2);
	ck_assert_int_eq(fused.outputs[1].row, 7);
	ck_assert_int_eq(fused.outputs[1].argument, 1);
	ck_assert_str_eq(fused.arguments[0].name, "in");
	ck_assert_int_eq(fused.arguments[1].is_output, 1);
}
END_TEST

START_TEST(fuse_keeps_names)
{
	dag_tag(&dag, expression_build(&dag, "+ x * y z"), "w", 2, 'z');
	dag_init(&fused, &arena);
	dag_fuse(&fused, &dag, 0);
	ck_assert_str_eq(fused.nodes[fused.outputs[0].value.i].tag.quantity, "w");
	ck_assert_int_eq(fused.nodes[fused.outputs[0].value.i].tag.body, 2);
}
END_TEST

START_TEST(dump_is_readable)
{
	struct text t;

	dag_tag(&dag, expression_build(&dag, "+ x * 2.5 s y"), "dw", 12, 'z');
	text_init(&t, &arena);
	dag_dump(&dag, &t);
	ck_assert_str_eq(text_string(&t), "0 CONST 0\n1 INPUT in[0]\n2 INPUT in[1]\n3 INPUT in[2]\n4 INPUT in[3]\n5 CONST 2.5\n"
					  "6 SIN 2\n7 MUL 5 6\n8 ADD 1 7  # dw12z\nout[0] = 8\n");
}
END_TEST

/* As many nodes as the limit, and what is there already; then an empty one. */
START_TEST(too_many_nodes_fail)
{
	struct dag d;
	struct ref x;

	dag_init(&d, &arena);
	dag_limit(&d, 5000);
	for (int i = 1; i < 5000; i++)
		x = dag_input(&d, 0, i);
	ck_assert(!d.failed && d.count == 5000);
	ck_assert(ref_equal(dag_input(&d, 0, 4999), x) && !d.failed);
	dag_input(&d, 0, 5000);
	ck_assert(d.failed && d.count == 5000);
	dag_free(&d);
	ck_assert(d.failed && !d.nodes && !d.count);
	dag_init(&d, &arena);
	ck_assert(!d.failed && ref_equal(dag_const(&d, 0), (struct ref){0}));
	dag_close(&d);
	ck_assert(!d.failed && d.count == 1 && !dag_find(&d, OP_INPUT, x, x, x, 0).i);
	dag_const(&d, 0);
	ck_assert(d.failed);
}
END_TEST

START_TEST(too_many_arguments_fail)
{
	for (int i = dag.argument_count; i < DAG_ARGUMENTS; i++)
		dag_argument(&dag, "more", 1, 0);
	ck_assert(!dag.failed);
	dag_argument(&dag, "one too many", 1, 0);
	ck_assert(dag.failed);
}
END_TEST

/* ---- numbers that are not exactly their value ---- */

static struct within numbered(struct ref r)
{
	return dag_number(&dag, &dag.nodes[r.i]);
}

/* Of two that may be the same, that which is known better; two that cannot be are two. */
START_TEST(what_may_be_the_same_is)
{
	const struct within coarse = {.x = 0.1L, .near = 0.1L, .e = 1e-12L}, fine = {.x = 0.1L, .near = 0.1L + 1e-14L, .e = 1e-15L},
		other = {.x = 0.1L, .near = 0.1L + 1e-9L, .e = 1e-15L};
	struct ref a = dag_within(&dag, coarse);
	size_t count = dag.count;

	ck_assert(numbered(a).e == coarse.e);
	ck_assert(ref_equal(dag_within(&dag, fine), a) && numbered(a).near == fine.near && numbered(a).e == fine.e);
	ck_assert(ref_equal(dag_within(&dag, coarse), a) && numbered(a).e == fine.e);
	ck_assert(dag.count == count);
	ck_assert(!ref_equal(dag_within(&dag, other), a) && numbered(a).e == fine.e && dag.count == count + 1);
	ck_assert(ref_equal(dag_within(&dag, other), dag_within(&dag, other)) && !ref_equal(dag_const(&dag, 0.1L), a));
	for (int i = 0; i < 5000; i++) /* the table grows */
		dag_const(&dag, 2 + i);
	count = dag.count;
	ck_assert(ref_equal(dag_within(&dag, fine), a) && !ref_equal(dag_within(&dag, other), a) && dag.count == count);
}
END_TEST

/* Folding carries what its operands are off; taken for zero is zero; a factor that cannot be one stays. */
/* No rule looks at a number that a limb has for itself: its twin's may have another sign. */
START_TEST(limbs_numbers_keep_their_magnitude)
{
	struct within own = within_exact(-2), all = within_exact(-2);
	struct ref x;

	own.limb = 1;
	own.kind = 7;
	x = dag_abs(&dag, dag_within(&dag, own));
	ck_assert_int_eq(dag.nodes[x.i].op, OP_ABS);
	x = dag_abs(&dag, dag_within(&dag, all));
	ck_assert(dag.nodes[x.i].op == OP_CONST && dag.nodes[x.i].value == 2);
}
END_TEST

START_TEST(folding_carries_errors)
{
	const struct within tenth = {.x = 0.1L, .near = 0.1L, .e = 1e-20L}, fifth = {.x = 0.23L, .near = 0.23L, .e = 2e-20L},
		almost = {.x = 1, .near = 1 + 1e-17L, .e = 1e-19L}, one = {.x = 1, .near = 1, .e = 1e-19L};
	struct ref x = dag_input(&dag, 0, 0), a = dag_within(&dag, tenth), b = dag_within(&dag, fifth);

	ck_assert(numbered(dag_add(&dag, a, b)).e >= 3e-20L && numbered(dag_sub(&dag, b, a)).e >= 3e-20L);
	ck_assert(numbered(dag_mul(&dag, a, b)).e >= 4e-21L && numbered(dag_neg(&dag, b)).e == numbered(b).e);
	ck_assert(numbered(dag_div(&dag, a, b)).e >= 8e-20L && numbered(dag_sqrt(&dag, b)).e > 2e-20L);
	ck_assert(numbered(dag_sin(&dag, a)).e >= 1e-20L && numbered(dag_cos(&dag, a)).e > 0);
	ck_assert(numbered(dag_sub(&dag, a, a)).e == 0 &&
		  numbered(dag_within(&dag, (struct within){.near = 1e-30L, .e = 1e-30L})).e == 0);
	ck_assert(numbered(dag.nodes[dag_mul(&dag, b, dag_mul(&dag, b, x)).i].arg[0]).e >= 8e-21L);
	ck_assert(ref_equal(dag_mul(&dag, dag_within(&dag, one), x), x));
	ck_assert(!ref_equal(dag_mul(&dag, dag_within(&dag, almost), x), x));
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("dag");
	TCase *c = tcase_create("rules");

	tcase_add_checked_fixture(c, open, close);
	tcase_add_loop_test(c, rule, 0, sizeof rules / sizeof *rules);
	tcase_add_loop_test(c, equal_values_share_a_node, 0, sizeof shared / sizeof *shared);
	tcase_add_test(c, different_values_do_not_share);
	tcase_add_test(c, sharing_survives_growth);
	tcase_add_test(c, tags_name_and_do_not_share);
	tcase_add_loop_test(c, fusion, 0, sizeof fusions / sizeof *fusions);
	tcase_add_loop_test(c, fusion_of_every_product, 0, sizeof joins / sizeof *joins);
	tcase_add_test(c, fuse_drops_dead_code);
	tcase_add_test(c, fuse_keeps_places);
	tcase_add_test(c, fuse_keeps_names);
	tcase_add_test(c, dump_is_readable);
	tcase_add_test(c, too_many_nodes_fail);
	tcase_add_test(c, too_many_arguments_fail);
	tcase_add_test(c, what_may_be_the_same_is);
	tcase_add_test(c, limbs_numbers_keep_their_magnitude);
	tcase_add_test(c, folding_carries_errors);
	suite_add_tcase(suite, c);
	return suite_run(suite);
}
