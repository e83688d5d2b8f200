/* Alike limbs that have threads of their own in a kernel, instead of turns of a loop. */
#include "plan/lanes/each.h"
#include "plan/stage.h"

/* Operations of the whole beyond which limbs have threads, and with a product in f32. H200, 1 M samples in aos, ps, in turns
   and in threads, in brackets us of 16384. f64: torques of g1_brainco, 7232 operations, 1310 and 828 (26.0 and 16.3), jvrc1,
   3572, 352 and 446 (11.1 and 9.8), g1_29dof 280 and 354 (10.0 and 8.3), atlas 264 and 351 (9.4 and 8.2), romeo 267 and 330,
   yumi 150 and 158, but g1_d_wheeled, 3484, 451 and 386 (13.7 and 9.4); with the vjp jvrc1, 8950, 1657 and 1276 (31 and 25),
   g1_d_wheeled, 8421, 2089 and 972 (35 and 21), g1_29dof, 7108, 1081 and 744 (25 and 16), atlas, 6645, 991 and 774 (22 and 17),
   romeo, 6481, 823 and 652 (18.8 and 15.4), pr2, 5959, 603 and 674 (16.7 and 14.9), simple_humanoid, 4461, 557 and 540 (15.0
   and 13.3), baxter, 5044, 393 and 403 (12.7 and 9.2). f32: torques of g1_brainco 450 and 386 (15.6 and 9.7), jvrc1 186 and 209
   (7.7 and 7.2), g1_29dof 145 and 168 (7.0 and 6.9); with the vjp g1_brainco, 18186, whose motion is made again, 2464 and 2124
   (38 and 27), where it is kept 2630 and 4166 (45 and 43), jvrc1 469 and 556 (16.2 and 11.8), g1_29dof 345 and 453 (12.8 and
   9.6), atlas 330 and 456 (12.1 and 9.9), romeo 376 and 372 (12.4 and 9.9). Threads of a block have registers while the first
   limb's go on alone, so that fewer slices are under way. */
enum { LEAST_THREADS = 6200, LEAST_FULL = 12000 };

/* Shared memory that a kernel has beside its slices and what limbs leave; samples of a block of 1024 threads. */
enum { OTHER_BYTES = 256, MOST_BLOCK = 512 };

int each_left_by(const struct plan *p, size_t line)
{
	unsigned op = p->lines[line].kind == LINE_VALUE ? p->dag->nodes[p->lines[line].value.i].op : 0;

	return op >= OP_LANE0 ? (int)(op - OP_LANE0) : -1;
}

/* Numbers that cross. */
static int count_left(const struct plan *p)
{
	int count = 0;

	for (size_t i = 0; i < p->line_count; i++)
		count += each_left_by(p, i) > 0;
	return count;
}

int each_most_block(const struct function *p, const struct parts_of *x)
{
	int is_full = request_wants_derivative(x->request) && x->options->precision == RNEAGEN_F32;
	int bytes = stage_number_bytes(x->options), words, block;

	if (!p->loops->is_apart || plan_flops(plan_operations(&x->whole->plan)) <= (is_full ? LEAST_FULL : LEAST_THREADS))
		return 0;
	words = stretches_words(p->stretches, &p->dag, x->options) + count_left(&p->plan);
	block = (SHARED_BYTES - OTHER_BYTES) / (words * bytes) / WARP_THREADS * WARP_THREADS;
	return block < MOST_BLOCK ? block : MOST_BLOCK;
}
