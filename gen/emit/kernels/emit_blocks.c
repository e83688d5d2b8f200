/* What a kernel takes of a multiprocessor: threads of a block, registers, shared memory. Each rule has its measurement. */
#include "emit/emit.h"
#include "emit/kernels/emit_blocks.h"
#include "emit/kernels/emit_segments_kernel.h"
#include "plan/stage.h"

/* Threads, where nothing is staged. */
enum { BLOCK = 128 };

/* Of kernels of derivatives, which spill into the same 48 KiB: of each thread twice as much as in blocks of 128 (H100, 1 M
   samples: both gradients of panda in f64, 2 parts, 0.635 ns instead of 0.674; of iiwa14 in f32, which spills nothing, 0.199
   instead of 0.205). */
enum { DERIVATIVE_BLOCK = 64 };

/* Where launch bounds pay: see min_blocks. */
enum { ARM_BODIES = 12, MANY_BODIES = 24, FEW_ALIVE = 45, MANY_ALIVE = 60, MOST_ALIVE = 100, FEW_DOUBLE = 64, LATE_SINGLE = 140,
	FULL_SINGLE = 220, FULL_DOUBLE = 170, OVERFULL_DOUBLE = 340, OVERFULL_SINGLE = 1200 };

int emit_pitch(const struct emission *e, int rows)
{
	return stage_pitch(rows, e->options);
}

/* Words of shared memory that staging takes for one sample of the part that takes most. */
static int words_of(const struct emission *e, const struct part *parts, int count)
{
	int most = 0;

	for (int i = 0; i < count; i++) {
		int words = stretches_words(parts[i].function.stretches, &parts[i].function.dag, e->options);

		most = words > most ? words : most;
	}
	return most;
}

int emit_stage_words(const struct emission *e)
{
	return emit_is_apart(e) ? words_of(e, e->parts, e->part_count) : stage_words(&emit_main(e)->dag, e->options);
}

/* Parts in f64. H200, both gradients, ps for each of a million samples, the first kernel as it was, on the arrays themselves, and
   with slices: atlas 7540 and 6960, g1_29dof 7050 and 6760, of half a million jvrc1 23200 and 22270; 1024 samples, us: g1_29dof
   53.7 and 49.7, jvrc1 129 and 100. */
int emit_start_words(const struct emission *e)
{
	int words = e->relay ? words_of(e, e->relay->starts, e->relay->start_count) : 0;

	return words && !e->is_transposed && stage_has_room(words, e->options) ? words : 0;
}

int emit_slice_bytes(const struct emission *e)
{
	return emit_stage_words(e) * e->memory->bytes;
}

/* The most values at once of the body, or of a part of it. */
static int most_alive(const struct emission *e)
{
	return e->part_count ? parts_alive(e->parts, e->part_count) : plan_alive(&emit_main(e)->plan, e->arena);
}

/* Accelerations of which more floats wait than registers hold (H100, 1 M samples: floating atlas 0.93 ns instead of 1.29; but in
   f64 floating hyq 0.55 instead of 0.43). */
static int is_full_forward(const struct emission *e)
{
	return e->request->is_forward && e->arithmetic->bytes == 4 && most_alive(e) > FULL_SINGLE;
}

/* Does the kernel hold so much at once that it takes smaller blocks, and shared memory beside its registers? */
int emit_is_full(const struct emission *e)
{
	return request_wants_derivative(e->request) || is_full_forward(e);
}

/* A part must not write what stands in the others' places. Parts that share nothing have rows of their own; but a vjp has three
   rows of each joint, and the rows between them are the others': it needs the places of q, qd and qdd. */
static int may_stage_parts(const struct emission *e)
{
	return emit_is_apart(e) && (!request_wants_derivative(e->request) ||
		(e->options->layout == RNEAGEN_AOS && e->parts[0].function.stretches->period));
}

/* Does the main kernel fetch its slice into shared memory first? Segments and windows have shared memory of their own. */
int emit_is_staged(const struct emission *e)
{
	return !emit_is_operation(e) && (!e->part_count || may_stage_parts(e)) && !emit_main(e)->segments.count &&
		!emit_windows(e)->slots && stage_has_room(emit_stage_words(e), e->options);
}

const struct windows *emit_windows(const struct emission *e)
{
	return &emit_part(e, 0)->windows;
}

int emit_window_bytes(const struct emission *e)
{
	return emit_windows(e)->slots ? (emit_windows(e)->slots + 1) * WINDOW_PITCH * e->memory->bytes : 0;
}

/* Does the kernel ask for its inputs in advance? Where many values wait the compiler fetches an input only when there is a
   register for it, and a warp waits for memory many times. H100, 1 M samples, ps: qdd with gradients of iiwa14 260, 211, of hyq
   204, 197, of panda 325, 300, of ur5 176, 163; qdd of floating hyq 177, 159; gradients of panda 268, 253; in f64 those of hyq
   424, 384, with qdd 476, 441. What is left out: gradients of iiwa14 190, 192, of hyq 180, 181; qdd of hyq 77, 81, of atlas 278,
   280; tau of g1_29dof 192, 211; in f64, where registers spill, qdd with gradients of iiwa14 505, 560, of panda 1827, 1864. And
   parts: tau with vjp in f32 of g1_29dof 429, 401, of jvrc1 570, 524, but 16384 samples in 12.4 us instead of 11.8, and in 18.2
   instead of 17.0, of atlas 405, 402, and 11.2 instead of 10.2; gradients of atlas 1485, 1618, in f64 5174, 5621, of g1_29dof
   6404, 7173; qdd of jvrc1 454, 502. And few doubles, in 168 registers: gradients of hyq 356, 364, of solo12 357, 360, and 16384
   samples in 6.6 us instead of 7.3, in 6.6 instead of 7.5. */
int emit_is_prefetched(const struct emission *e)
{
	int alive;

	if (e->options->layout != RNEAGEN_SOA || emit_is_staged(e) || e->part_count || emit_main(e)->segments.count || e->wide)
		return 0;
	alive = plan_alive(&emit_main(e)->plan, e->arena);
	if (e->arithmetic->bytes == 8)
		return request_wants_derivative(e->request) && alive > FEW_DOUBLE && alive <= FULL_DOUBLE;
	if (e->request->is_forward && request_wants_derivative(e->request))
		return 1;
	return (e->request->is_forward || request_wants_derivative(e->request)) && alive > LATE_SINGLE && alive <= FULL_SINGLE;
}

/* A sample is taken for one of small angles and computed again if it was not: no test comes before the arithmetic, and no
   input is read twice (H100, 1 M samples: iiwa14 0.96 of the floor instead of 0.94, hyq 0.92 instead of 0.87;
   but atlas 0.86 instead of 0.88). The kernel then holds the body twice: a loop around one copy makes it fetch its inputs late
   (H100, ps: hyq 85 instead of 76, gradients of iiwa14, with the test first, 224 instead of 204). */
int emit_is_optimistic(const struct emission *e)
{
	return e->arithmetic->bytes == 4 && !emit_is_staged(e) && !emit_windows(e)->slots &&
		e->tree->body_count < MANY_BODIES;
}

/* Accelerations of an arm or a quadruped. Smaller blocks end more evenly (H100, 1 M samples, ps, blocks of 128 and of 64:
   iiwa14 44.0, 43.7, hyq 73.0, 72.2; by base parameters 42.2, 40.8 and 70.4, 69.4). */
static int is_small_forward(const struct emission *e)
{
	return e->request->is_forward && e->arithmetic->bytes == 4 && e->tree->body_count <= ARM_BODIES;
}

/* Bytes of a warp in the shared memory that bounds a block. */
static int warp_bytes(const struct emission *e)
{
	return emit_is_staged(e) ? WARP_THREADS * emit_slice_bytes(e) : emit_window_bytes(e);
}

int emit_block_size(const struct emission *e)
{
	int block = emit_is_full(e) || is_small_forward(e) ? DERIVATIVE_BLOCK : BLOCK;

	if (emit_main(e)->segments.count)
		return emit_segments_block(e, emit_main(e));

	while (block / WARP_THREADS * warp_bytes(e) > SHARED_BYTES)
		block /= 2;
	return block;
}

/* Accelerations in f64 of which very many wait, with derivatives or without. */
static int is_overfull_forward(const struct emission *e)
{
	return e->request->is_forward && e->arithmetic->bytes == 8 && most_alive(e) > OVERFULL_DOUBLE;
}

/* Derivatives in f64 that need no shared memory to spill into: what the compiler may give each of four blocks it then gives.
   Where fewer values are alive it gives 168 registers, of which six blocks have room (H100, 1 M samples, ps, so and in 254: hyq
   356 and 373, solo12 357 and 358). iiwa14, 137 values, takes 412 with a bound and 386 without. Of accelerations, where very many
   wait, the compiler's own choice is 168 registers, and it spills more: 7584 bytes instead of 6368 for floating hyq, 361 values
   alive; but of panda and of iiwa14 320 instead of 1008 and 192 instead of 720, for it then spills to shared memory.
   In f32 second derivatives of qdd are the longest texts. By its own choice it gives them 32 registers; with room for two blocks
   it takes 255, and stores 11 kB instead of 37 of atlas and of g1_29dof, 15 instead of 45 of floating hyq (1436 values alive). Of
   yumi, which has fewer (694), it takes 168, and stores 9 kB either way. */
static int min_derivative_blocks(const struct emission *e)
{
	int alive = plan_alive(&emit_main(e)->plan, e->arena);

	if (e->arithmetic->bytes != 8)
		return alive > OVERFULL_SINGLE ? 2 : 0;
	return (alive > FEW_DOUBLE && alive <= MOST_ALIVE) || is_overfull_forward(e) ? 4 : 0;
}

/* Humanoids in f32 soa gain from room for a third block (H100: 168 registers, no spill), arms of some 50 values from room
   for a sixth (80 registers instead of 93 on iiwa14, no spill: 0.93 of the floor instead of 0.90). Accelerations of few values
   gain from room for 14 blocks of 64 (hyq 72.2 ps, 71.1), others lose (iiwa14 43.7, 44.4). Hands lose too: 65536 samples of
   chain_75 take 134 us with room for a third block, 114 without. Elsewhere the compiler's own choice spills least: a bound makes
   it fetch all inputs first. */
static int min_blocks(const struct emission *e)
{
	int alive;

	if (!e->target->kernel || emit_is_staged(e) || emit_is_operation(e) || emit_hands(e))
		return 0;
	if (emit_main(e)->segments.count)
		return e->arithmetic->bytes == 4 ? 6 : 0;
	if (request_wants_derivative(e->request))
		return min_derivative_blocks(e);
	/* left to itself the compiler gives each thread of the longest texts 32 registers, and spills 43 kB of it; with room for
	   two blocks, and no more, it takes 255 (H100, 262144 samples of qdd, ns: g1_brainco 15.1, 13.5, floating 107, 25; a
	   million of floating jvrc1 53.7, 10.8) */
	if (is_overfull_forward(e))
		return 2;
	if (e->arithmetic->bytes != 4 || e->wide || (e->request->is_forward && e->tree->body_count > ARM_BODIES))
		return 0;
	if (e->tree->body_count > ARM_BODIES)
		return e->tree->body_count >= MANY_BODIES ? 3 : 0;
	alive = plan_alive(&emit_main(e)->plan, e->arena);
	if (e->request->is_forward)
		return alive < FEW_ALIVE ? 14 : 0;
	return alive >= FEW_ALIVE && alive <= MANY_ALIVE ? 6 : 0;
}

/* As many threads in blocks of any size; in blocks of a warp there may be no room for so many, and registers for all. */
const char *emit_min_blocks(const struct emission *e)
{
	int blocks = min_blocks(e);

	if (!blocks)
		return "0";
	return text_format(e->arena, "(RNEA_BLOCK < 64 ? 0 : %d/RNEA_BLOCK)", blocks * emit_block_size(e));
}
