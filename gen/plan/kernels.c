/* What kernels take of a multiprocessor. Each rule has its measurement. */
#include "plan/kernels.h"
#include "plan/segments.h"
#include "plan/stage.h"
#include "plan/tiles/tiles.h"

/* Threads of a block, where nothing is staged. */
enum { BLOCK = 128 };

/* Of kernels of derivatives, which spill into the same 48 KiB: of each thread twice as much as in blocks of 128 (H100, 1 M
   samples: both gradients of panda in f64, 2 parts, 0.635 ns instead of 0.674; of iiwa14 in f32, which spills nothing, 0.199
   instead of 0.205). Of kernels in segments at most. */
enum { DERIVATIVE_BLOCK = 64, SEGMENTS_BLOCK = 64 };

/* Samples of a thread in segments (H100, 1 M samples, ps): g1_brainco in f32, 1, 2 and 4 take 1338, 742 and 643; in f64, 1 and 2
   take 3254 and 2487; romeo in f64, 2 and 4 take 526 and 546. */
enum { SEGMENT_SINGLE = 4, SEGMENT_DOUBLE = 2 };

/* Where launch bounds pay: see blocks_of. */
enum { ARM_BODIES = 12, MANY_BODIES = 24, FEW_ALIVE = 45, MANY_ALIVE = 60, MOST_ALIVE = 100, FEW_DOUBLE = 64, LATE_SINGLE = 140,
	FULL_SINGLE = 220, FULL_DOUBLE = 170, OVERFULL_DOUBLE = 340, OVERFULL_SINGLE = 1200 };

/* From how many samples on each part has a kernel of its own. */
enum {
	LEAST_SAMPLES = MULTIPROCESSORS * 128,  /* of matrices: one warp for each scheduler of an H100 */
	LEAST_TILED = 1 << 19,      /* of rows that move as tiles */
	LEAST_PRODUCT = MULTIPROCESSORS * 1920, /* of these, with a vjp or a jvp */
	/* where the base's acceleration comes first: 16384 and 262144 samples of floating atlas take 69 and 508 us without tiles,
	   57 and 415 with them (H200) */
	LEAST_BASE = 1 << 14,
	/* where links stand: 16384, 65536 and 262144 samples of accelerations without tiles and with them, f64, atlas welded by both
	   feet 144 129, 334 323, 1144 977, hyq on four feet 30 33, 93 91, 274 258, in f32 atlas 41 43, 110 111, 342 320 (H200) */
	LEAST_CONTACTS = 1 << 16
};

struct maker {
	const struct parts_of *x;
	const struct function *whole;
	const struct part *parts;
	int count; /* of parts; 0: the whole is one kernel */
	const struct relay *relay;
	const struct request *request;
	const struct rneagen_options *options;
	int bodies;
	int is_double, is_wide; /* the arithmetic has 8 bytes; some of it has more bits */
	int is_apart, has_columns; /* parts share nothing; or have the elements of matrices, and write as in soa */
	int has_derivatives;
	int alive;       /* values at once of the whole */
	int alive_most;  /* of it, or of a part */
};

/* ---- shared memory ---- */

/* What the kernel computes in a place along y of its grid: a part, or the whole; how many such places there are. */
static const struct function *function_of(const struct maker *m, int place)
{
	return m->count ? &m->parts[place].function : m->whole;
}

static int places(const struct maker *m)
{
	return m->count ? m->count : 1;
}

/* Words that slices take of the part that takes most. */
static int words_of(const struct part *parts, int count, const struct rneagen_options *o)
{
	int most = 0;

	for (int i = 0; i < count; i++) {
		int words = stretches_words(parts[i].function.stretches, &parts[i].function.dag, o);

		most = words > most ? words : most;
	}
	return most;
}

static int slice_words(const struct maker *m)
{
	return m->is_apart ? words_of(m->parts, m->count, m->options) : stage_words(&m->whole->dag, m->options);
}

/* A relay's first kernel in parts, in f64. H200, both gradients, ps for each of a million samples, as it was, on the arrays
   themselves, and with slices: atlas 7540 and 6960, g1_29dof 7050 and 6760, of half a million jvrc1 23200 and 22270; 1024
   samples, us: g1_29dof 53.7 and 49.7, jvrc1 129 and 100. */
static int start_words(const struct maker *m)
{
	int words = m->relay ? words_of(m->relay->starts, m->relay->start_count, m->options) : 0;

	return words && !m->x->is_transposed && stage_has_room(words, m->options) ? words : 0;
}

/* A part must not write what stands in the others' places. Parts that share nothing have rows of their own; but a vjp has three
   rows of each joint, and the rows between them are the others': it needs the places of q, qd and qdd. */
static int may_stage_parts(const struct maker *m)
{
	return m->is_apart && (!m->has_derivatives || (m->options->layout == RNEAGEN_AOS && m->parts[0].function.stretches->period));
}

/* Segments and windows have shared memory of their own. */
static int is_staged(const struct maker *m, int words)
{
	return (!m->count || may_stage_parts(m)) && !m->whole->segments.count && !function_of(m, 0)->windows.slots &&
		stage_has_room(words, m->options);
}

static void choose_memory(const struct maker *m, struct kernels *s)
{
	const struct segments *g = &m->whole->segments;
	int slots = function_of(m, 0)->windows.slots;

	s->slice_words = slice_words(m);
	s->slice_bytes = s->slice_words * stage_number_bytes(m->options);
	s->start_words = start_words(m);
	s->is_staged = is_staged(m, s->slice_words);
	s->window_bytes = slots ? (slots + 1) * WINDOW_PITCH * stage_number_bytes(m->options) : 0;
	s->segment_bytes = g->count ? segments_bytes(g, m->options, m->is_wide) : 0;
}

int kernels_segment_samples(const struct rneagen_options *o)
{
	return stage_arithmetic_bytes(o) == 4 ? SEGMENT_SINGLE : SEGMENT_DOUBLE;
}

/* ---- how inputs come ---- */

/* Does the kernel ask for its inputs in advance? Where many values wait the compiler fetches an input only when there is a
   register for it, and a warp waits for memory many times. H100, 1 M samples, ps: qdd with gradients of iiwa14 260, 211, of hyq
   204, 197, of panda 325, 300, of ur5 176, 163; qdd of floating hyq 177, 159; gradients of panda 268, 253; in f64 those of hyq
   424, 384, with qdd 476, 441. What is left out: gradients of iiwa14 190, 192, of hyq 180, 181; qdd of hyq 77, 81, of atlas 278,
   280; tau of g1_29dof 192, 211; in f64, where registers spill, qdd with gradients of iiwa14 505, 560, of panda 1827, 1864. And
   parts: tau with vjp in f32 of g1_29dof 429, 401, of jvrc1 570, 524, but 16384 samples in 12.4 us instead of 11.8, and in 18.2
   instead of 17.0, of atlas 405, 402, and 11.2 instead of 10.2; gradients of atlas 1485, 1618, in f64 5174, 5621, of g1_29dof
   6404, 7173; qdd of jvrc1 454, 502. And few doubles, in 168 registers: gradients of hyq 356, 364, of solo12 357, 360, and 16384
   samples in 6.6 us instead of 7.3, in 6.6 instead of 7.5. */
static int is_prefetched(const struct maker *m, int staged)
{
	int is_forward = m->request->is_forward;

	if (m->options->layout != RNEAGEN_SOA || staged || m->count || m->whole->segments.count || m->is_wide)
		return 0;
	if (m->is_double)
		return m->has_derivatives && m->alive > FEW_DOUBLE && m->alive <= FULL_DOUBLE;
	if (is_forward && m->has_derivatives)
		return 1;
	return (is_forward || m->has_derivatives) && m->alive > LATE_SINGLE && m->alive <= FULL_SINGLE;
}

/* No test comes before the arithmetic, and no input is read twice (H100, 1 M samples: iiwa14 0.96 of the floor instead of
   0.94, hyq 0.92 instead of 0.87; but atlas 0.86 instead of 0.88). The kernel then holds the body twice: a loop around one copy
   makes it fetch its inputs late (H100, ps: hyq 85 instead of 76, gradients of iiwa14, with the test first, 224 instead of 204).
   */
static int is_optimistic(const struct maker *m, int staged)
{
	return !m->is_double && !staged && !function_of(m, 0)->windows.slots && m->bodies < MANY_BODIES;
}

/* ---- blocks ---- */

/* Accelerations of which more floats wait than registers hold (H100, 1 M samples: floating atlas 0.93 ns instead of 1.29; but in
   f64 floating hyq 0.55 instead of 0.43). */
static int is_full_forward(const struct maker *m)
{
	return m->request->is_forward && !m->is_double && m->alive_most > FULL_SINGLE;
}

/* Accelerations of an arm or a quadruped. Smaller blocks end more evenly (H100, 1 M samples, ps, blocks of 128 and of 64:
   iiwa14 44.0, 43.7, hyq 73.0, 72.2; by base parameters 42.2, 40.8 and 70.4, 69.4). */
static int is_small_forward(const struct maker *m)
{
	return m->request->is_forward && !m->is_double && m->bodies <= ARM_BODIES;
}

/* In segments each sample has room for two. */
static int block_of(const struct maker *m, const struct kernels *s)
{
	int block = s->is_full || is_small_forward(m) ? DERIVATIVE_BLOCK : BLOCK;
	int warp_bytes = s->is_staged ? WARP_THREADS * s->slice_bytes : s->window_bytes;

	if (s->segment_bytes)
		return SEGMENTS_BLOCK * 2 * s->segment_bytes > SHARED_BYTES ? WARP_THREADS : SEGMENTS_BLOCK;
	while (block / WARP_THREADS * warp_bytes > SHARED_BYTES)
		block /= 2;
	return block;
}

/* Accelerations in f64 of which very many wait, with derivatives or without. */
static int is_overfull_forward(const struct maker *m)
{
	return m->request->is_forward && m->is_double && m->alive_most > OVERFULL_DOUBLE;
}

/* Derivatives in f64 that need no shared memory to spill into: what the compiler may give each of four blocks it then gives.
   Where fewer values are alive it gives 168 registers, of which six blocks have room (H100, 1 M samples, ps, so and in 254: hyq
   356 and 373, solo12 357 and 358). iiwa14, 137 values, takes 412 with a bound and 386 without. Of accelerations, where very many
   wait, the compiler's own choice is 168 registers, and it spills more: 7584 bytes instead of 6368 for floating hyq, 361 values
   alive; but of panda and of iiwa14 320 instead of 1008 and 192 instead of 720, for it then spills to shared memory.
   In f32 second derivatives of qdd are the longest texts. By its own choice it gives them 32 registers; with room for two blocks
   it takes 255, and stores 11 kB instead of 37 of atlas and of g1_29dof, 15 instead of 45 of floating hyq (1436 values alive). Of
   yumi, which has fewer (694), it takes 168, and stores 9 kB either way. */
static int derivative_blocks(const struct maker *m)
{
	if (!m->is_double)
		return m->alive > OVERFULL_SINGLE ? 2 : 0;
	return (m->alive > FEW_DOUBLE && m->alive <= MOST_ALIVE) || is_overfull_forward(m) ? 4 : 0;
}

/* In f32 in soa. Humanoids gain from room for a third block (H100: 168 registers, no spill), arms of some 50 values from room
   for a sixth (80 registers instead of 93 on iiwa14, no spill: 0.93 of the floor instead of 0.90). Accelerations of few values
   gain from room for 14 blocks of 64 (hyq 72.2 ps, 71.1), others lose (iiwa14 43.7, 44.4). Elsewhere the compiler's own choice
   spills least: a bound makes it fetch all inputs first. */
static int single_blocks(const struct maker *m)
{
	if (m->bodies > ARM_BODIES)
		return m->bodies >= MANY_BODIES && !m->request->is_forward ? 3 : 0;
	if (m->request->is_forward)
		return m->alive < FEW_ALIVE ? 14 : 0;
	return m->alive >= FEW_ALIVE && m->alive <= MANY_ALIVE ? 6 : 0;
}

/* Hands lose: 65536 samples of chain_75 take 134 us with room for a third block, 114 without. */
static int blocks_of(const struct maker *m, const struct kernels *s)
{
	if (!m->x->has_kernels || s->is_staged || (m->count && m->parts[0].is_before))
		return 0;
	if (s->segment_bytes)
		return m->is_double ? 0 : 6;
	if (m->has_derivatives)
		return derivative_blocks(m);
	/* left to itself the compiler gives each thread of the longest texts 32 registers, and spills 43 kB of it; with room for
	   two blocks, and no more, it takes 255 (H100, 262144 samples of qdd, ns: g1_brainco 15.1, 13.5, floating 107, 25; a
	   million of floating jvrc1 53.7, 10.8) */
	if (is_overfull_forward(m))
		return 2;
	return m->is_double || m->is_wide ? 0 : single_blocks(m);
}

/* ---- kernels of large batches ---- */

/* Words that tiles take of the part that takes most; 0: none has tiles. */
static int alone_words(const struct maker *m)
{
	int most = 0;

	for (int i = 0; i < places(m); i++) {
		const struct function *p = function_of(m, i);
		int words = p->tiles ? tiles_words(p, m->options) : 0;

		most = words > most ? words : most;
	}
	return most;
}

static int least_tiled(const struct maker *m)
{
	if (m->has_derivatives)
		return LEAST_PRODUCT;
	if (parts_division(m->parts, m->count) == DIVIDED_BASE_FIRST)
		return LEAST_BASE;
	return m->request->contact_count ? LEAST_CONTACTS : LEAST_TILED;
}

static int are_long(const struct maker *m)
{
	return m->count > 1 && plan_flops(parts_operations(m->parts, m->count, &m->whole->plan)) > TILES_COLUMNS;
}

/* Smaller batches leave multiprocessors idle that the one kernel gives other parts. Beyond, the blocks of one part do not share a
   multiprocessor with those of another, and each takes the registers that it needs. In f64 all parts take all registers there
   are: without tiles a million samples lose. Measurements: grid/README.md, Parts of matrices. */
static int alone_least(const struct maker *m, const struct kernels *s)
{
	if (!m->x->has_kernels || m->is_wide)
		return 0;
	if (!m->has_columns)
		return s->has_tiles ? least_tiled(m) : 0;
	return s->has_tiles || (s->serves_untiled && are_long(m)) ? LEAST_SAMPLES : 0;
}

static void choose_alone(const struct maker *m, struct kernels *s)
{
	int words = alone_words(m);

	s->has_tiles = m->x->has_kernels && words > 0 && !m->whole->segments.count;
	s->has_columns = m->has_columns;
	s->serves_untiled = m->has_columns && !m->is_double;
	s->alone_least = alone_least(m, s);
	s->alone_block = tiles_block(words * stage_number_bytes(m->options));
}

/* ---- all of it ---- */

struct kernels kernels_choose(
	const struct parts_of *x, const struct part *parts, int count, const struct relay *relay, struct arena *a)
{
	struct maker m = {.x = x, .whole = x->whole, .parts = parts, .count = count, .relay = relay, .request = x->request,
		.options = x->options, .bodies = x->tree->body_count, .is_double = stage_arithmetic_bytes(x->options) == 8,
		.is_wide = x->request->refine_steps && x->request->refine != REFINE_SAME, .is_apart = parts_are_apart(parts, count),
		.has_derivatives = request_wants_derivative(x->request), .alive = plan_alive(&x->whole->plan, a)};
	struct kernels s = {0};

	m.has_columns = count && !m.is_apart && x->options->layout == RNEAGEN_SOA;
	m.alive_most = count ? parts_alive(parts, count) : m.alive;
	choose_memory(&m, &s);
	s.is_prefetched = is_prefetched(&m, s.is_staged);
	s.is_optimistic = is_optimistic(&m, s.is_staged);
	s.is_full = m.has_derivatives || is_full_forward(&m);
	s.block = block_of(&m, &s);
	s.blocks = blocks_of(&m, &s);
	choose_alone(&m, &s);
	return s;
}

struct kernels kernels_plain(const struct rneagen_options *o)
{
	return (struct kernels){.block = BLOCK, .is_optimistic = stage_arithmetic_bytes(o) == 4};
}

void kernels_dump(const struct kernels *s, struct text *out)
{
	const struct {
		const char *what;
		int value;
	} lines[] = {{"threads of a block", s->block}, {"blocks that have room", s->blocks}, {"spills to shared memory", s->is_full},
		{"takes angles for small ones", s->is_optimistic}, {"asks for inputs in advance", s->is_prefetched},
		{"slice of a sample, bytes", s->is_staged ? s->slice_bytes : 0}, {"slice of a relay's first kernel, words", s->start_words},
		{"window of a warp, bytes", s->window_bytes}, {"across cuts, bytes", s->segment_bytes},
		{"each part has a kernel from so many samples on", s->alone_least},
		{"threads of a block there", s->alone_least ? s->alone_block : 0}, {"moves tiles there", s->has_tiles}};

	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		if (lines[i].value)
			text_printf(out, "%s: %d\n", lines[i].what, lines[i].value);
}
