/* A pretended CUDA driver for machines without a GPU, chosen by RNEA_LIBCUDA: device memory is memory, a module is a
   shared object made by fake_nvrtc.c, a launch runs at once, on the processor. This file: devices, contexts, modules;
   fake_cuda_memory.c: memory; fake_cuda_stream.c: streams, graphs, events.

   Environment: RNEA_FAKE_CUDA_FAIL="CALL=STATUS" makes that call return STATUS; RNEA_FAKE_CUDA_DEVICES and
   RNEA_FAKE_CUDA_ARCH (default 1 and 90); RNEA_FAKE_CUDA_MAX_BLOCK (default 1024) is what kernels can run with;
   RNEA_FAKE_CUDA_LOCAL="A B" (default 0 0): bytes of local memory of kernels with a launch bound, and without;
   RNEA_FAKE_CUDA_RESIDENT="A B C" (default all 2048): threads resident in blocks of 64, 128 and 256, as far as 228 KiB of shared
   memory have room for what launches give; RNEA_FAKE_CUDA_SHARED (default 232448): bytes of it that a launch may give to a block.
   RNEA_FAKE_CUDA_LAUNCHES=FILE: each launch appends the number of its device to it, one digit.
   Who asks a module for what it lacks is aborted, as compute-sanitizer ends with errors then; RNEA_FAKE_CUDA_MAY_MISS=1: is only
   told. */
#define _GNU_SOURCE
#include "fake_cuda.h"
#include <dlfcn.h>
#include <elf.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { DEVICE_LIMIT = 8, STACK_LIMIT = 16 };

static char contexts[DEVICE_LIMIT]; /* only their addresses matter */
static _Thread_local void *stack[STACK_LIMIT];
static _Thread_local int depth;
static atomic_int live;
static atomic_long calls_left = -1; /* before the one that fails */
static atomic_int fail_status;
static const char *_Atomic failed_call;
static pthread_mutex_t running = PTHREAD_MUTEX_INITIALIZER;

/* ---- for the tests ---- */

/* Contexts, modules, streams, graphs, events and memory that were taken and not given back. */
int fake_cuda_live(void)
{
	return live + depth;
}

/* The call after `n` more fails with `status`, and only that one; a negative n ends that. cuCtxPopCurrent, after which
   nobody looks, is not counted. */
void fake_cuda_fail(long n, int status)
{
	fail_status = status;
	failed_call = NULL;
	calls_left = n;
}

/* The call that failed since, or NULL. */
const char *fake_cuda_failed(void)
{
	return failed_call;
}

static int variable(const char *name, int otherwise)
{
	const char *value = getenv(name);

	return value ? atoi(value) : otherwise;
}

void fake_count_live(int change)
{
	live += change;
}

int fake_entry(const char *call, int wants_context)
{
	const char *fail = getenv("RNEA_FAKE_CUDA_FAIL");
	size_t length = strlen(call);

	if (fail && strncmp(fail, call, length) == 0 && fail[length] == '=')
		return atoi(fail + length + 1);
	if (calls_left >= 0 && strcmp(call, "cuCtxPopCurrent_v2") != 0 && calls_left-- == 0) {
		failed_call = call;
		return fail_status;
	}
	return wants_context && !depth ? FAKE_INVALID_CONTEXT : FAKE_SUCCESS;
}

void fake_run(const struct fake_launch *launch)
{
	unsigned long long values[FAKE_PARAMETER_LIMIT];
	_Alignas(64) unsigned char last[FAKE_LAST_LIMIT];
	void *parameters[FAKE_PARAMETER_LIMIT];

	memcpy(values, launch->parameters, sizeof values);
	memcpy(last, launch->last, sizeof last);
	for (unsigned i = 0; i < launch->kernel->count; i++)
		parameters[i] = i + 1 < launch->kernel->count ? (void *)&values[i] : last;
	pthread_mutex_lock(&running);
	launch->kernel->run(parameters, launch->grid, launch->parts, launch->block, launch->given);
	pthread_mutex_unlock(&running);
}

/* ---- devices and contexts ---- */

int cuInit(unsigned flags)
{
	(void)flags;
	ENTER(0);
	return variable("RNEA_FAKE_CUDA_DEVICES", 1) ? FAKE_SUCCESS : FAKE_NO_DEVICE;
}

int cuDriverGetVersion(int *version)
{
	ENTER(0);
	*version = 13000;
	return FAKE_SUCCESS;
}

int cuGetErrorName(int status, const char **name)
{
	*name = status == FAKE_NO_DEVICE	? "CUDA_ERROR_NO_DEVICE"
		: status == FAKE_OUT_OF_MEMORY	? "CUDA_ERROR_OUT_OF_MEMORY"
		: status == FAKE_INVALID_IMAGE	? "CUDA_ERROR_INVALID_IMAGE"
		: status == FAKE_INVALID_HANDLE ? "CUDA_ERROR_INVALID_HANDLE"
						: NULL;
	return *name ? FAKE_SUCCESS : FAKE_INVALID_VALUE;
}

int cuGetErrorString(int status, const char **text)
{
	*text = status == FAKE_NO_DEVICE ? "no CUDA-capable device is detected" : NULL;
	return *text ? FAKE_SUCCESS : FAKE_INVALID_VALUE;
}

int cuDeviceGetCount(int *count)
{
	ENTER(0);
	*count = variable("RNEA_FAKE_CUDA_DEVICES", 1);
	return FAKE_SUCCESS;
}

int cuDeviceGet(int *device, int ordinal)
{
	ENTER(0);
	*device = ordinal;
	return ordinal < variable("RNEA_FAKE_CUDA_DEVICES", 1) ? FAKE_SUCCESS : FAKE_INVALID_DEVICE;
}

int cuDeviceGetName(char *name, int size, int device)
{
	ENTER(0);
	snprintf(name, (size_t)size, "pretended device %d", device);
	return FAKE_SUCCESS;
}

int cuDeviceGetAttribute(int *value, int attribute, int device)
{
	int arch = variable("RNEA_FAKE_CUDA_ARCH", 90);

	(void)device;
	ENTER(0);
	*value = attribute == 75   ? arch / 10
		 : attribute == 76 ? arch % 10
		 : attribute == 16 ? 4
		 : attribute == 97 ? variable("RNEA_FAKE_CUDA_SHARED", 227 << 10)
				   : 1 << 20;
	return FAKE_SUCCESS;
}

/* What fake_device.h makes of one. */
struct tile_map {
	void *array;
	size_t count, rows;
	unsigned size, samples, tile_rows;
};

/* As a driver refuses them. */
int cuTensorMapEncodeTiled(struct tile_map *map, int type, unsigned rank, void *array, const unsigned long long *size,
	const unsigned long long *pitch, const unsigned *box, const unsigned *step, int interleave, int swizzle, int promotion, int fill)
{
	unsigned bytes = type == 7 ? 4 : 8;

	if ((type != 7 && type != 8) || rank != 2 || (size_t)array % 16 || pitch[0] % 16 || pitch[0] != size[0] * bytes || !size[0] ||
		!size[1] || size[0] >> 32 || box[0] > 256 || box[1] > 256 || !box[0] || !box[1] || box[0] * bytes % 16 || step[0] != 1 ||
		step[1] != 1 || interleave || swizzle || promotion || fill)
		return FAKE_INVALID_VALUE;
	*map = (struct tile_map){array, size[0], size[1], bytes, box[0], box[1]};
	return FAKE_SUCCESS;
}

int cuDevicePrimaryCtxRetain(void **context, int device)
{
	ENTER(0);
	*context = &contexts[device];
	fake_count_live(1);
	return FAKE_SUCCESS;
}

int cuDevicePrimaryCtxRelease_v2(int device)
{
	(void)device;
	fake_count_live(-1);
	return FAKE_SUCCESS;
}

int cuCtxGetCurrent(void **context)
{
	ENTER(0);
	*context = depth ? stack[depth - 1] : NULL;
	return FAKE_SUCCESS;
}

int cuCtxPushCurrent_v2(void *context)
{
	ENTER(0);
	stack[depth++] = context;
	return FAKE_SUCCESS;
}

int cuCtxPopCurrent_v2(void **context)
{
	ENTER(1);
	*context = stack[--depth];
	return FAKE_SUCCESS;
}

void fake_note_launch(void)
{
	const char *path = getenv("RNEA_FAKE_CUDA_LAUNCHES");
	FILE *f = path && depth ? fopen(path, "ab") : NULL;

	if (!f)
		return;
	putc('0' + (int)((char *)stack[depth - 1] - contexts), f);
	fclose(f);
}

int cuCtxSynchronize(void)
{
	ENTER(1);
	return FAKE_SUCCESS;
}

/* ---- modules ---- */

/* A shared object ends with its section headers; 0 if the image is no such thing, or is a cubin. */
static size_t image_size(const void *image)
{
	const Elf64_Ehdr *head = image;

	if (memcmp(head->e_ident, ELFMAG, SELFMAG) != 0 || head->e_machine == EM_CUDA)
		return 0;
	return head->e_shoff + (size_t)head->e_shnum * head->e_shentsize;
}

int cuModuleLoadDataEx(void **module, const void *image, unsigned count, int *options, void **values)
{
	char path[] = "/tmp/fake_cuda_XXXXXX";
	size_t size = image_size(image);
	int file;

	ENTER(1);
	for (unsigned i = 0; i < count && !size; i++)
		if (options[i] == 5)
			strcpy(values[i], "not an image of this machine\nand a second line");
	if (!size || (file = mkstemp(path)) < 0)
		return FAKE_INVALID_IMAGE;
	*module = write(file, image, size) == (ssize_t)size ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
	close(file);
	unlink(path);
	if (!*module)
		return FAKE_INVALID_IMAGE;
	fake_count_live(1);
	return FAKE_SUCCESS;
}

int cuModuleUnload(void *module)
{
	ENTER(1);
	dlclose(module);
	fake_count_live(-1);
	return FAKE_SUCCESS;
}

static int missed(const char *call, const char *name)
{
	if (!variable("RNEA_FAKE_CUDA_MAY_MISS", 0)) {
		fprintf(stderr, "pretended driver: %s of %s, which the module lacks\n", call, name);
		abort();
	}
	return FAKE_NOT_FOUND;
}

int cuModuleGetFunction(void **function, void *module, const char *name)
{
	char symbol[512];

	ENTER(1);
	snprintf(symbol, sizeof symbol, "fake_kernel_%s", name);
	*function = dlsym(module, symbol);
	return *function ? FAKE_SUCCESS : missed(__func__, name);
}

int cuModuleGetGlobal_v2(unsigned long long *address, size_t *size, void *module, const char *name)
{
	const Elf64_Sym *symbol = NULL;
	void *found;
	Dl_info info;

	ENTER(1);
	found = dlsym(module, name);
	if (!found || !dladdr1(found, &info, (void **)&symbol, RTLD_DL_SYMENT))
		return missed(__func__, name);
	*address = (unsigned long long)found;
	*size = symbol->st_size;
	return FAKE_SUCCESS;
}

int cuFuncGetAttribute(int *value, int attribute, void *function)
{
	const struct fake_kernel *kernel = function;
	const char *local = getenv("RNEA_FAKE_CUDA_LOCAL");
	int bytes[2] = {0, 0};

	ENTER(1);
	if (local)
		sscanf(local, "%d %d", &bytes[0], &bytes[1]);
	*value = attribute == 0	  ? variable("RNEA_FAKE_CUDA_MAX_BLOCK", 1024)
		 : attribute == 3 ? bytes[kernel->min_blocks == 0]
		 : attribute == 4 ? 42
				  : 8 * attribute;
	return FAKE_SUCCESS;
}

int cuFuncSetAttribute(void *function, int attribute, int value)
{
	const struct fake_kernel *kernel = function;

	ENTER(1);
	if (attribute != 8 || value < 0 || value > variable("RNEA_FAKE_CUDA_SHARED", 227 << 10))
		return FAKE_INVALID_VALUE;
	*kernel->most_given = (unsigned)value;
	return FAKE_SUCCESS;
}

int cuFuncLoad(void *function)
{
	(void)function;
	ENTER(1);
	return FAKE_SUCCESS;
}

int cuOccupancyMaxPotentialBlockSize(
	int *grid, int *block, void *function, size_t (*shared)(int block), size_t bytes, int limit)
{
	(void)function;
	(void)shared;
	(void)bytes;
	(void)limit;
	ENTER(1);
	*grid = 8;
	*block = 256;
	return FAKE_SUCCESS;
}

int cuOccupancyMaxActiveBlocksPerMultiprocessor(int *blocks, void *function, int block, size_t shared)
{
	const char *resident = getenv("RNEA_FAKE_CUDA_RESIDENT");
	int threads[3] = {2048, 2048, 2048}, room;

	(void)function;
	ENTER(1);
	if (resident)
		sscanf(resident, "%d %d %d", &threads[0], &threads[1], &threads[2]);
	*blocks = threads[block <= 64 ? 0 : block <= 128 ? 1 : 2] / block;
	room = (int)((228 << 10) / (shared + 1024));
	if (*blocks > room)
		*blocks = room;
	return FAKE_SUCCESS;
}
