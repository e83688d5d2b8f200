/* The pretended driver's memory: of the device, page-locked, and copies. All of it is memory. */
#define _GNU_SOURCE
#include "fake_cuda.h"
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { LOCKED_LIMIT = 256 };

/* CUDA_MEMCPY2D */
struct copy {
	size_t from_x, from_y;
	int from_type;
	const void *from_host;
	unsigned long long from_device;
	void *from_array;
	size_t from_pitch;
	size_t to_x, to_y;
	int to_type;
	void *to_host;
	unsigned long long to_device;
	void *to_array;
	size_t to_pitch;
	size_t width, height;
};

/* What the driver knows of: page-locked memory (type 1) and device memory (type 2). */
static struct {
	char *memory;
	size_t size;
	int type;
} known[LOCKED_LIMIT];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static int learn(void *memory, size_t size, int type)
{
	int status = FAKE_OUT_OF_MEMORY;

	pthread_mutex_lock(&lock);
	for (int i = 0; i < LOCKED_LIMIT && status; i++)
		if (!known[i].memory) {
			known[i].memory = memory;
			known[i].size = size;
			known[i].type = type;
			status = FAKE_SUCCESS;
		}
	pthread_mutex_unlock(&lock);
	return status;
}

/* The type of what `address` lies in; 0: not known. `forget` takes it off the list if it begins there. */
static int look_up(const void *address, int forget)
{
	const char *a = address;
	int type = 0;

	pthread_mutex_lock(&lock);
	for (int i = 0; i < LOCKED_LIMIT && !type; i++)
		if (known[i].memory &&
			(forget ? a == known[i].memory : a >= known[i].memory && a < known[i].memory + known[i].size)) {
			type = known[i].type;
			if (forget)
				known[i].memory = NULL;
		}
	pthread_mutex_unlock(&lock);
	return type;
}

static void *pointer(unsigned long long address)
{
	return (void *)address;
}

static void *take(size_t size, int type)
{
	void *memory = aligned_alloc(256, (size + 255) / 256 * 256);

	if (memory && learn(memory, size, type)) {
		free(memory);
		memory = NULL;
	}
	if (memory)
		memset(memory, 0x5a, size);
	fake_count_live(memory != NULL);
	return memory;
}

static int give_back(void *memory)
{
	if (!look_up(memory, 1))
		return FAKE_INVALID_VALUE;
	free(memory);
	fake_count_live(-1);
	return FAKE_SUCCESS;
}

int cuMemAlloc_v2(unsigned long long *address, size_t size)
{
	ENTER(1);
	*address = (unsigned long long)take(size, 2);
	return *address ? FAKE_SUCCESS : FAKE_OUT_OF_MEMORY;
}

int cuMemGetInfo_v2(size_t *available, size_t *total)
{
	ENTER(1);
	*available = *total = 1 << 28;
	return FAKE_SUCCESS;
}

int cuMemFree_v2(unsigned long long address)
{
	ENTER(1);
	return address ? give_back(pointer(address)) : FAKE_SUCCESS;
}

int cuMemAllocHost_v2(void **memory, size_t size)
{
	ENTER(1);
	*memory = take(size, 1);
	return *memory ? FAKE_SUCCESS : FAKE_OUT_OF_MEMORY;
}

int cuMemFreeHost(void *memory)
{
	ENTER(1);
	return give_back(memory);
}

int cuMemHostRegister_v2(void *memory, size_t size, unsigned flags)
{
	(void)flags;
	ENTER(1);
	return learn(memory, size, 1);
}

int cuMemHostUnregister(void *memory)
{
	ENTER(1);
	return look_up(memory, 1) ? FAKE_SUCCESS : FAKE_INVALID_VALUE;
}

int cuPointerGetAttributes(unsigned count, int *attributes, void **values, unsigned long long address)
{
	int type = look_up(pointer(address), 0);

	ENTER(1);
	for (unsigned i = 0; i < count; i++)
		*(int *)values[i] = attributes[i] == 2 ? type : 0;
	return FAKE_SUCCESS;
}

/* ---- copies ---- */

int cuMemcpyHtoD_v2(unsigned long long to, const void *from, size_t size)
{
	ENTER(1);
	memcpy(pointer(to), from, size);
	return FAKE_SUCCESS;
}

int cuMemcpyDtoH_v2(void *to, unsigned long long from, size_t size)
{
	ENTER(1);
	memcpy(to, pointer(from), size);
	return FAKE_SUCCESS;
}

int cuMemcpyDtoD_v2(unsigned long long to, unsigned long long from, size_t size)
{
	ENTER(1);
	memcpy(pointer(to), pointer(from), size);
	return FAKE_SUCCESS;
}

int cuMemsetD8_v2(unsigned long long to, unsigned char value, size_t size)
{
	ENTER(1);
	memset(pointer(to), value, size);
	return FAKE_SUCCESS;
}

int cuMemsetD8Async(unsigned long long to, unsigned char value, size_t size, void *stream)
{
	(void)stream;
	ENTER(1);
	memset(pointer(to), value, size);
	return FAKE_SUCCESS;
}

/* Whether `size` bytes lie in one piece of memory of that type. */
static int lies_in(const void *memory, size_t size, int type)
{
	int found = 0;

	pthread_mutex_lock(&lock);
	for (int i = 0; i < LOCKED_LIMIT && !found; i++)
		found = known[i].memory && known[i].type == type && (const char *)memory >= known[i].memory &&
			(const char *)memory + size <= known[i].memory + known[i].size;
	pthread_mutex_unlock(&lock);
	return found;
}

/* What is copied from or to must be page-locked, or nothing would overlap: the pretended driver insists. */
static int enqueue_copy(const struct copy *c, void *stream)
{
	struct fake_work w = {.is_copy = 1,
		.to = c->to_type == 1 ? c->to_host : pointer(c->to_device),
		.from = c->from_type == 1 ? c->from_host : pointer(c->from_device),
		.width = c->width,
		.height = c->height,
		.to_pitch = c->to_pitch,
		.from_pitch = c->from_pitch};

	if (!w.height || w.width > w.to_pitch || w.width > w.from_pitch || w.to_pitch > 0x7fffffff ||
		w.from_pitch > 0x7fffffff || c->from_x || c->from_y || c->to_x || c->to_y ||
		!lies_in(w.to, (w.height - 1) * w.to_pitch + w.width, c->to_type) ||
		!lies_in(w.from, (w.height - 1) * w.from_pitch + w.width, c->from_type))
		return FAKE_INVALID_VALUE;
	return fake_enqueue(stream, &w);
}

int cuMemcpyHtoDAsync_v2(unsigned long long to, const void *from, size_t size, void *stream)
{
	struct copy c = {.from_type = 1,
		.from_host = from,
		.from_pitch = size,
		.to_type = 2,
		.to_device = to,
		.to_pitch = size,
		.width = size,
		.height = 1};

	ENTER(1);
	return enqueue_copy(&c, stream);
}

int cuMemcpyDtoHAsync_v2(void *to, unsigned long long from, size_t size, void *stream)
{
	struct copy c = {.from_type = 2,
		.from_device = from,
		.from_pitch = size,
		.to_type = 1,
		.to_host = to,
		.to_pitch = size,
		.width = size,
		.height = 1};

	ENTER(1);
	return enqueue_copy(&c, stream);
}

int cuMemcpy2DAsync_v2(const struct copy *c, void *stream)
{
	ENTER(1);
	return enqueue_copy(c, stream);
}
