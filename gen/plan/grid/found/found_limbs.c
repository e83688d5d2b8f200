#include "plan/grid/found/found_limbs.h"
#include "plan/grid/found/found.h"
#include "plan/limbs/limb_limits.h"
#include <string.h>

/* Operations of the longest warps, both kernels together, as a share of those of the longest parts of the kernels beside
   them: up to this much for large batches, where these are three or more, or two of one part each; else for small ones. H200,
   us by kernels and by limbs, of 1, 256, 1024, 4096 and 8192 samples, in brackets the share: vjp of floating atlas in f32
   (0.33) 35 18, 34 21, 36 27, 36 30, 40 32, in f64 (0.31) 74 31, 76 35, 80 42, 81 48, 122 76, of floating hyq in f64 (0.41)
   14 14, 20 15, 20 19, 21 21, 21 22, of floating panda in f64 (0.44) 9.4 9.6, 10 10, 10 14, 11 16, 12 16; two kernels in
   parts: g1_29dof in f32 (0.35) 15 13, 15 15, 16 20, 16 23, 23 35, in f64 (0.41) 29 20, 29 25, 32 32, 30 38, 44 59, jvrc1 in
   f32 (0.43) 28 22, 27 26, 29 32, 28 35, 38 37; jvp of floating atlas in f32 (0.39) 42 26, 42 30, 46 36, 45 40, 48 41, in f64
   (0.30) 93 36, 93 42, 99 55, 99 80, 145 135, of atlas in f64 (0.47) 47 22, 47 26, 49 33, 52 37, 71 46, of floating hyq in
   f64 (0.44) 28 17, 29 18, 30 20, 30 23, 30 25. */
static const double SHARE_OF_TWO = 0.42, SHARE = 0.48;
enum { MOST_LARGE = 8192, MOST_SMALL_SINGLE = 128, MOST_SMALL_DOUBLE = 256 };

/* Limbs of the whole hold more at once. H200, us by kernels and by limbs, of 256, 1024, 4096 and 8192 samples: accelerations of
   atlas, welded by both feet, in f32 38 18, 38 22, 37 30, 41 60, in f64 74 34, 74 36, 74 63, 103 82, of g1_29dof in f64 67 38, 67 42,
   67 60, 88 97, of hyq in f64 on two feet 20 12, 20 13, 20 17, 20 17, on four 26 21, 25 23, 25 30, 26 36; the vjp of the last
   59 31, 59 32, 58 59, 59 87, in f32 30 20, 30 23, 30 31, 30 31. */
enum { MOST_WHOLE = 4096 };

/* The kernels beside: how many, of how many parts at most, and operations of the longest part of each, together. */
struct beside {
	int kernels, parts;
	unsigned operations;
};

static struct beside kernels_beside(const struct part *parts, int count)
{
	struct beside all = {0};

	for (int i = 0, end; i < count; i = end) {
		unsigned longest = 0;

		for (end = i; end < count && part_kernel(&parts[end]) == part_kernel(&parts[i]); end++) {
			unsigned operations = plan_flops(plan_operations(&parts[end].function.plan));

			longest = operations > longest ? operations : longest;
		}
		all.kernels++;
		all.parts = end - i > all.parts ? end - i : all.parts;
		all.operations += longest;
	}
	return all;
}

static unsigned most_samples(unsigned longest, const struct part *parts, int count, const struct rneagen_options *o)
{
	struct beside kernels = kernels_beside(parts, count);
	double share = longest / (double)kernels.operations;

	if (kernels.kernels > 2 ? share <= SHARE : kernels.parts == 1 && share <= SHARE_OF_TWO)
		return MOST_LARGE;
	return o->precision == RNEAGEN_F32 ? MOST_SMALL_SINGLE : MOST_SMALL_DOUBLE;
}

/* All warps, and lanes that make a sample again, read what is found before any of them writes over it: inputs come first, and
   then they wait for each other. So do the threads of one group; another one might make the last sample again. */
static void wait_for_readings(struct limbs *s)
{
	for (int w = 0; w < s->warps; w++) {
		struct plan *p = &s->plans[w];
		size_t inputs = 0;

		while (inputs < p->line_count && p->lines[inputs].kind == LINE_INPUT)
			inputs++;
		plan_add_line(p, LINE_JOIN, (struct ref){0}, 0);
		memmove(p->lines + inputs + 1, p->lines + inputs, (p->line_count - inputs - 1) * sizeof *p->lines);
		p->lines[inputs] = (struct line){.kind = LINE_JOIN};
	}
	s->groups = 1;
}

static int build(struct part *rounds, struct dag *dags, const struct parts_of *x, struct arena *a)
{
	const char *whole = x->whole->algorithm->name, *const names[FOUND_ROUNDS] = {text_format(a, "%s_start", whole), whole};
	static const char *const DOCS[FOUND_ROUNDS] = {"What is found first.", "The rest, where that is found."};

	for (int i = 0; i < FOUND_ROUNDS; i++) {
		struct function *p = &rounds[i].function;

		if (!part_build(&rounds[i], &dags[i], names[i], DOCS[i], x, a) || !limbs_choose(&p, 1, x->options, a))
			return 0;
	}
	return 1;
}

int found_limbs_make(struct part **rounds, const struct part *parts, int count, const struct parts_of *x, struct arena *a)
{
	struct part *made = arena_alloc(a, FOUND_ROUNDS, sizeof *made);
	struct limbs *start = &made[FOUND_START].function.limbs, *rest = &made[FOUND_REST].function.limbs;
	struct arena spare;
	struct dag dags[FOUND_ROUNDS];
	int done;

	*rounds = NULL;
	if (x->request->contact_count && (x->request->wants[0].kind == WANT_QDD || !contacts_weights_fit(x->tree, x->request)))
		return 1; /* the whole has limbs: its forces have no rows of their own */
	arena_init(&spare, x->options->allocator);
	done = made && found_rounds(dags, FOUND_ROUNDS, x, HANDED_FOUND, &spare) && build(made, dags, x, a);
	if (done && start->warps && rest->warps) {
		wait_for_readings(rest);
		start->most = rest->most = most_samples(start->longest + rest->longest, parts, count, x->options);
		*rounds = made;
	}
	done = done && !spare.failed;
	arena_free(&spare);
	return done;
}

void found_limbs_beside(struct limbs *whole, const struct part *parts, int count, const struct rneagen_options *o)
{
	unsigned most = most_samples(whole->longest, parts, count, o);

	whole->most = most < MOST_WHOLE ? most : MOST_WHOLE;
}
