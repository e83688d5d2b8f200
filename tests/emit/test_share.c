/* A share of a DAG's outputs, against the whole DAG whose other outputs are left out: fused they are the same, node by node,
   with their names, sections and outputs. It catches a node, a name or a section that a copy loses or moves. */
#include "support/merged.h"
#include "support/random_robot.h"
#include "support/rng.h"
#include "plan/grid/share.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROBOTS = 30, LINKS = 10, OWNERS = 5, SEED = 20261124 };

/* The whole with some outputs alone. */
static void leave_out(struct dag *d, const struct dag *whole, const int *owner, int first, int end, struct arena *a)
{
	size_t count = 0;

	*d = *whole;
	d->outputs = arena_alloc(a, whole->output_count, sizeof *d->outputs);
	d->sections = arena_alloc(a, whole->section_count, sizeof *d->sections);
	for (size_t s = 0; s < whole->section_count; s++) {
		d->sections[s] = whole->sections[s];
		d->sections[s].output = 0;
		for (size_t i = 0; i < whole->sections[s].output; i++)
			d->sections[s].output += owner[i] >= first && owner[i] < end;
	}
	for (size_t i = 0; i < whole->output_count; i++)
		if (owner[i] >= first && owner[i] < end)
			d->outputs[count++] = whole->outputs[i];
	d->output_count = count;
}

static const char *told(const struct dag *d, int strict, struct arena *a)
{
	struct dag fused;
	struct text t;

	dag_init(&fused, a);
	dag_fuse(&fused, d, strict);
	ck_assert(!fused.failed);
	text_init(&t, a);
	dag_dump(&fused, &t);
	for (size_t i = 0; i < fused.section_count; i++)
		text_printf(&t, "section %d %d %u %zu\n", fused.sections[i].kind, fused.sections[i].body,
			(unsigned)fused.sections[i].node, fused.sections[i].output);
	for (size_t i = 0; i < fused.output_count; i++)
		text_printf(&t, "output %d %d %u\n", fused.outputs[i].argument, fused.outputs[i].row,
			(unsigned)fused.outputs[i].value.i);
	for (size_t i = 0; i < fused.count; i++)
		text_printf(&t, "tag %s %d %d\n", fused.nodes[i].tag.quantity, fused.nodes[i].tag.component,
			fused.nodes[i].tag.body);
	ck_assert(!t.failed);
	return text_string(&t);
}

static void compare(const struct dag *whole, struct rng *rng, uint64_t seed, struct arena *a)
{
	int *owner = arena_alloc(a, whole->output_count, sizeof *owner);
	struct share x;

	for (size_t i = 0; i < whole->output_count; i++)
		owner[i] = rng_below(rng, OWNERS);
	ck_assert(share_begin(&x, whole, owner, a));
	for (int first = 0; first < OWNERS; first++)
		for (int end = first; end <= OWNERS; end++) {
			struct dag share, other;

			share_copy(&x, first, end, &share, a);
			leave_out(&other, whole, owner, first, end, a);
			ck_assert(!share.failed && share.count <= whole->count);
			ck_assert_msg(!strcmp(told(&share, first % 2, a), told(&other, first % 2, a)),
				"seed %llu: owners %d to %d", (unsigned long long)seed, first, end);
		}
}

START_TEST(shares)
{
	uint64_t seed = SEED + (uint64_t)_i;
	struct random_robot_knobs knobs = random_robot_knobs(seed, LINKS);
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_error e = {0};
	char *urdf = random_robot(seed, &knobs);
	struct rng rng = rng_seed(seed);
	struct robot robot;
	struct arena a;
	struct tree tree;
	struct request k;
	struct dag whole;

	o.scene = _i % 3 ? "want tau,dtau_dq,dtau_dqd,M,power\n" : "want tau,jvp,M,bias\n";
	o.base = _i % 2 ? RNEAGEN_FLOATING : RNEAGEN_FIXED;
	arena_init(&a, NULL);
	ck_assert_msg(!robot_read(&robot, urdf, strlen(urdf), "here", &a, &e) && !merged_tree(&tree, &k, &robot, &o, &a, &e),
		"%llu: %s", (unsigned long long)seed, e.message);
	dag_init(&whole, &a);
	algorithm_rnea.build(&whole, &tree, &k);
	ck_assert(!whole.failed);
	compare(&whole, &rng, seed, &a);
	arena_free(&a);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("share");

	printf("seed %d\n", SEED);
	suite_add(suite, "shares", shares, ROBOTS, 60);
	return suite_run(suite);
}
