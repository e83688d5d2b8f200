/* Lets a C++ compiler build CUDA C for the processor: put before a text by fake_nvrtc, run by fake_cuda.
   Enough of CUDA for the texts of rneagen and the kernels of the tests, and no more. */
#define _GLIBCXX_INCLUDE_NEXT_C_HEADERS /* C's own, where libstdc++ would put a long <cmath> before each text */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#undef _GLIBCXX_INCLUDE_NEXT_C_HEADERS
#include <utility>
#if FAKE_WAITS
#include <sys/mman.h>
#include <ucontext.h>
#endif

#define __CUDACC__ 1
#define __CUDACC_RTC__ 1
#define __CUDA_ARCH__ 700 /* before machines had instructions that a text would name in assembly */
#define __align__(bytes) __attribute__((aligned(bytes)))
#define __global__
#define __device__
#define __constant__
#define __host__
#define __forceinline__ inline
#define __launch_bounds__(...)
/* One block runs at a time; fake_nvrtc looks at the size. */
#define FAKE_SHARED_(line) static __attribute__((section("fake_shared" #line)))
#define FAKE_SHARED(line) FAKE_SHARED_(line)
#define __shared__ FAKE_SHARED(__LINE__)
#define __restrict__ __restrict
#define __grid_constant__
#define __sincosf sincosf
#define __trap abort
#define __fmaf_rn fmaf
#define __fadd_rn(a, b) ((float)(a) + (float)(b))
#define __fsub_rn(a, b) ((float)(a) - (float)(b))
#define __fmul_rn(a, b) ((float)(a) * (float)(b))
#define __fdiv_rn(a, b) ((float)(a) / (float)(b))
#define __fsqrt_rn sqrtf
#define __fma_rn fma
#define __dadd_rn(a, b) ((double)(a) + (double)(b))
#define __dsub_rn(a, b) ((double)(a) - (double)(b))
#define __dmul_rn(a, b) ((double)(a) * (double)(b))
#define __ddiv_rn(a, b) ((double)(a) / (double)(b))
#define __dsqrt_rn sqrt

struct fake_dim {
	unsigned x, y, z;
};

static fake_dim threadIdx, blockIdx, blockDim, gridDim; /* launches come one after another */

struct alignas(16) float4 {
	float x, y, z, w;
};
struct alignas(16) int4 {
	int x, y, z, w;
};
struct alignas(16) double2 {
	double x, y;
};

[[maybe_unused]] static float __fdividef(float a, float b)
{
	return a / b;
}

[[maybe_unused]] static int __ffs(int x)
{
	return __builtin_ffs(x);
}

/* Shared memory of a launch: fake_nvrtc makes `extern __shared__ T slices[]` refer to it. What was not given must stay
   as it is. */
enum { FAKE_MOST_SHARED = 227 << 10, FAKE_UNTOUCHED = 0xa5 };
extern "C" __attribute__((weak)) unsigned char fake_given_memory[] __asm__("slices");
static unsigned fake_given;
#define asm(...) (bytes = fake_given) /* the one instruction that texts name without volatile: how much of it there is */

[[maybe_unused]] static void fake_give(unsigned given)
{
	fake_given = given;
	for (unsigned i = given; fake_given_memory && i < FAKE_MOST_SHARED; i++)
		fake_given_memory[i] = FAKE_UNTOUCHED;
}

[[maybe_unused]] static void fake_check_given()
{
	for (unsigned i = fake_given; fake_given_memory && i < FAKE_MOST_SHARED; i++)
		if (fake_given_memory[i] != FAKE_UNTOUCHED)
			abort();
}

template <class... A, size_t... I>
static void fake_apply(void (*kernel)(A...), void **p, std::index_sequence<I...>)
{
	kernel(*(std::remove_const_t<A> *)p[I]...);
}

/* Blocks have no order. The last comes first here: what only holds in the other order fails. */
static fake_dim fake_from_last(unsigned b, unsigned grid, unsigned parts)
{
	const unsigned at = grid * parts - 1 - b;

	return {at % grid, at / grid, 0};
}

/* Threads that never wait for each other are run one after another. */
template <class... A> static void fake_run_serial(void (*kernel)(A...), void **p, unsigned grid, unsigned parts,
	unsigned block)
{
	blockDim = {block, 1, 1};
	gridDim = {grid, parts, 1};
	for (unsigned b = 0; b < grid * parts; b++)
		for (unsigned t = 0; t < block; t++) {
			blockIdx = fake_from_last(b, grid, parts);
			threadIdx = {t, 0, 0};
			fake_apply(kernel, p, std::index_sequence_for<A...>{});
		}
}

#if FAKE_WAITS
static constexpr unsigned FAKE_WARP = 32, FAKE_WARPS = 32, FAKE_THREADS = FAKE_WARP * FAKE_WARPS;
static constexpr size_t FAKE_STACK = 8 << 20;

/* A thread of a block that waits is a context of its own; one of them runs at a time, from one wait to the next. */
static ucontext_t fake_scheduler, fake_contexts[FAKE_THREADS];
static bool fake_is_done[FAKE_THREADS];
static unsigned fake_steps; /* threads that are done, and waits that are over */
static unsigned char *fake_stacks; /* kept for the next launch */

/* All of `size` threads come to it before one goes on. */
struct fake_barrier {
	unsigned size, come, round;

	void wait()
	{
		const unsigned mine = round;

		if (++come == size) {
			come = 0;
			round++;
			fake_steps++;
			return;
		}
		while (round == mine)
			swapcontext(&fake_contexts[threadIdx.x], &fake_scheduler);
	}
};
static fake_barrier fake_block_barrier, fake_warp_barriers[FAKE_WARPS]; /* of the threads of a block, of each warp */

[[maybe_unused]] static void __syncthreads()
{
	fake_block_barrier.wait();
}

[[maybe_unused]] static void __syncwarp()
{
	fake_warp_barriers[threadIdx.x / FAKE_WARP].wait();
}

/* Tiles: what a tensor map of fake_cuda.c says, and an engine that moves them at once. */
#define RNEAGEN_TILE_MAP
struct alignas(64) rneagen_tile_map {
	unsigned char *array;
	size_t count, rows;
	unsigned size, samples, tile_rows;
	unsigned char rest[128 - 40];
};
static_assert(sizeof(rneagen_tile_map) == 128, "as long as a CUtensorMap");
#if !defined RNEA_TILES
#define RNEA_TILES 1
#endif
static unsigned fake_tile_bytes; /* that have not come */

[[maybe_unused]] static void rneagen_tiles_begin(unsigned bytes)
{
	fake_tile_bytes = bytes;
}

[[maybe_unused]] static void rneagen_tile_in(void *slice, const rneagen_tile_map *m, int row)
{
	unsigned char *to = (unsigned char *)slice;
	const size_t first = (size_t)blockIdx.x * m->samples;

	for (unsigned r = 0; r < m->tile_rows; r++)
		for (unsigned k = 0; k < m->samples; k++, to += m->size) {
			const bool is_there = first + k < m->count && row + r < m->rows;

			for (unsigned b = 0; b < m->size; b++)
				to[b] = is_there ? m->array[((row + r) * m->count + first + k) * m->size + b] : 0;
		}
	fake_tile_bytes -= m->tile_rows * m->samples * m->size;
}

[[maybe_unused]] static void rneagen_tiles_come()
{
	__syncthreads();
	if (fake_tile_bytes)
		abort();
}

[[maybe_unused]] static void rneagen_tiles_leave()
{
	__syncthreads();
}

[[maybe_unused]] static void rneagen_tile_out(const void *slice, const rneagen_tile_map *m, int row)
{
	const unsigned char *from = (const unsigned char *)slice;
	const size_t first = (size_t)blockIdx.x * m->samples;

	for (unsigned r = 0; r < m->tile_rows; r++)
		for (unsigned k = 0; k < m->samples; k++, from += m->size)
			for (unsigned b = 0; b < m->size && first + k < m->count && row + r < m->rows; b++)
				m->array[((row + r) * m->count + first + k) * m->size + b] = from[b];
}

[[maybe_unused]] static void rneagen_tiles_end()
{
}

/* What makecontext takes has no argument. */
template <class... A> static void (*fake_waiting_kernel)(A...);
static void **fake_parameters;

template <class... A> static void fake_run_thread()
{
	const unsigned t = threadIdx.x;

	fake_apply(fake_waiting_kernel<A...>, fake_parameters, std::index_sequence_for<A...>{});
	fake_is_done[t] = true;
	fake_steps++;
}

static void fake_begin(unsigned t, void (*run)())
{
	getcontext(&fake_contexts[t]);
	fake_contexts[t].uc_stack.ss_sp = fake_stacks + t * FAKE_STACK;
	fake_contexts[t].uc_stack.ss_size = FAKE_STACK;
	fake_contexts[t].uc_link = &fake_scheduler;
	makecontext(&fake_contexts[t], run, 0);
	fake_is_done[t] = false;
}

/* Each thread up to where it waits, the last one first in every other block: what only holds in one order fails. Returns how many
   are done. Where none goes on, some wait for what does not come. */
static unsigned fake_turn(unsigned block, bool is_from_last)
{
	const unsigned before = fake_steps;
	unsigned done = 0;

	for (unsigned i = 0; i < block; i++) {
		const unsigned t = is_from_last ? block - 1 - i : i;

		threadIdx = {t, 0, 0};
		if (!fake_is_done[t])
			swapcontext(&fake_scheduler, &fake_contexts[t]);
		done += fake_is_done[t];
	}
	if (before == fake_steps)
		abort();
	return done;
}

template <class... A> static void fake_run_threads(void (*kernel)(A...), void **p, unsigned grid, unsigned parts,
	unsigned block)
{
	if (!fake_stacks)
		fake_stacks = static_cast<unsigned char *>(mmap(nullptr, FAKE_THREADS * FAKE_STACK, PROT_READ | PROT_WRITE,
			MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0));
	if (block > FAKE_THREADS || fake_stacks == MAP_FAILED)
		abort();
	fake_waiting_kernel<A...> = kernel;
	fake_parameters = p;
	blockDim = {block, 1, 1};
	gridDim = {grid, parts, 1};
	for (unsigned b = 0; b < grid * parts; b++) {
		blockIdx = fake_from_last(b, grid, parts);
		fake_block_barrier = {block, 0, 0};
		for (unsigned w = 0; w * FAKE_WARP < block; w++)
			fake_warp_barriers[w] = {block - w * FAKE_WARP < FAKE_WARP ? block - w * FAKE_WARP : FAKE_WARP, 0, 0};
		for (unsigned t = 0; t < block; t++)
			fake_begin(t, fake_run_thread<A...>);
		while (fake_turn(block, b % 2) < block)
			;
	}
}
#endif

template <class... A> static constexpr unsigned fake_count(void (*)(A...))
{
	return sizeof...(A);
}

template <class... A> static constexpr unsigned fake_last(void (*)(A...))
{
	unsigned last = 0;

	((last = sizeof(A)), ...);
	return last;
}

/* What fake_cuda looks up as fake_kernel_NAME. */
struct fake_kernel {
	void (*run)(void **parameters, unsigned grid, unsigned parts, unsigned block, unsigned given);
	unsigned count; /* parameters, 8 bytes each but the last */
	unsigned last_bytes;
	unsigned min_blocks; /* the launch bound of the text; 0: none */
	unsigned *most_given; /* bytes of shared memory that a launch may give */
};

#define FAKE_KERNEL(name, how)                                                                                         \
	static unsigned fake_most_given_##name = 48 << 10;                                                             \
	extern "C" const fake_kernel fake_kernel_##name;                                                               \
	const fake_kernel fake_kernel_##name = {                                                                       \
		[](void **p, unsigned grid, unsigned parts, unsigned block, unsigned given) {                          \
			fake_give(given);                                                                              \
			how(name, p, grid, parts, block);                                                              \
			fake_check_given();                                                                            \
		},                                                                                                     \
		fake_count(name),                                                                                      \
		fake_last(name),                                                                                       \
		FAKE_MIN_BLOCKS,                                                                                       \
		&fake_most_given_##name};
