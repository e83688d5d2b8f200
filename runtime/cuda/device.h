#ifndef RNEA_DEVICE_H
#define RNEA_DEVICE_H
/* One CUDA device through the driver API, which is opened at run time. */

#include "core/failure.h"
#include "core/library.h"
#include "core/source.h"
#include <stddef.h>
#include <stdint.h>

/* What is used of the driver API, as cuda.h declares it: CUresult and CUdevice are int, handles are pointers and a
   CUdeviceptr is an unsigned long long. Field, symbol, whether it must be there, parameters. */
#define DEVICE_FUNCTIONS(X)                                                                                            \
	X(init, "cuInit", 1, (unsigned flags))                                                                         \
	X(driver_get_version, "cuDriverGetVersion", 1, (int *version))                                                 \
	X(get_error_name, "cuGetErrorName", 1, (int status, const char **name))                                        \
	X(get_error_string, "cuGetErrorString", 1, (int status, const char **text))                                    \
	X(device_get_count, "cuDeviceGetCount", 1, (int *count))                                                       \
	X(device_get, "cuDeviceGet", 1, (int *device, int ordinal))                                                    \
	X(device_get_name, "cuDeviceGetName", 1, (char *name, int size, int device))                                   \
	X(device_get_attribute, "cuDeviceGetAttribute", 1, (int *value, int attribute, int device))                    \
	X(primary_ctx_retain, "cuDevicePrimaryCtxRetain", 1, (void **context, int device))                             \
	X(primary_ctx_release, "cuDevicePrimaryCtxRelease_v2", 1, (int device))                                        \
	X(ctx_get_current, "cuCtxGetCurrent", 1, (void **context))                                                     \
	X(ctx_push_current, "cuCtxPushCurrent_v2", 1, (void *context))                                                 \
	X(ctx_pop_current, "cuCtxPopCurrent_v2", 1, (void **context))                                                  \
	X(module_load_data_ex, "cuModuleLoadDataEx", 1,                                                                \
		(void **module, const void *image, unsigned count, int *options, void **values))                       \
	X(module_unload, "cuModuleUnload", 1, (void *module))                                                          \
	X(module_get_function, "cuModuleGetFunction", 1, (void **function, void *module, const char *name))            \
	X(module_get_global, "cuModuleGetGlobal_v2", 1,                                                                \
		(unsigned long long *address, size_t *size, void *module, const char *name))                           \
	X(memcpy_dtoh, "cuMemcpyDtoH_v2", 1, (void *to, unsigned long long from, size_t size))                         \
	X(func_get_attribute, "cuFuncGetAttribute", 1, (int *value, int attribute, void *function))                    \
	X(func_set_attribute, "cuFuncSetAttribute", 1, (void *function, int attribute, int value))                     \
	X(func_load, "cuFuncLoad", 0, (void *function))                                                                \
	X(occupancy_block, "cuOccupancyMaxPotentialBlockSize", 0,                                                      \
		(int *grid, int *block, void *function, size_t (*shared)(int block), size_t bytes, int limit))         \
	X(occupancy_blocks, "cuOccupancyMaxActiveBlocksPerMultiprocessor", 1,                                          \
		(int *blocks, void *function, int block, size_t shared))                                               \
	X(mem_alloc, "cuMemAlloc_v2", 1, (unsigned long long *address, size_t size))                                   \
	X(mem_free, "cuMemFree_v2", 1, (unsigned long long address))                                                   \
	X(memset_d8_async, "cuMemsetD8Async", 1,                                                                        \
		(unsigned long long to, unsigned char value, size_t size, void *stream))                               \
	X(mem_alloc_host, "cuMemAllocHost_v2", 1, (void **memory, size_t size))                                        \
	X(mem_free_host, "cuMemFreeHost", 1, (void *memory))                                                           \
	X(memcpy_htod_async, "cuMemcpyHtoDAsync_v2", 1,                                                                \
		(unsigned long long to, const void *from, size_t size, void *stream))                                  \
	X(memcpy_dtoh_async, "cuMemcpyDtoHAsync_v2", 1,                                                                \
		(void *to, unsigned long long from, size_t size, void *stream))                                        \
	X(memcpy_2d_async, "cuMemcpy2DAsync_v2", 1, (const struct device_copy *copy, void *stream))                    \
	X(pointer_get_attributes, "cuPointerGetAttributes", 1,                                                          \
		(unsigned count, int *attributes, void **values, unsigned long long address))                          \
	X(stream_create, "cuStreamCreate", 1, (void **stream, unsigned flags))                                         \
	X(stream_synchronize, "cuStreamSynchronize", 1, (void *stream))                                                \
	X(stream_destroy, "cuStreamDestroy_v2", 1, (void *stream))                                                     \
	X(tensor_map_encode_tiled, "cuTensorMapEncodeTiled", 0,                                                        \
		(void *map, int type, unsigned rank, void *array, const uint64_t *size, const uint64_t *pitch,         \
			const uint32_t *box, const uint32_t *step, int interleave, int swizzle, int promotion, int fill))  \
	X(launch_kernel, "cuLaunchKernel", 1,                                                                          \
		(void *function, unsigned gx, unsigned gy, unsigned gz, unsigned bx, unsigned by, unsigned bz,         \
			unsigned shared, void *stream, void **parameters, void **extra))

/* With so many blocks all multiprocessors have enough of them; the generated launch functions count on as many. */
enum { ENOUGH_BLOCKS = 512 };

/* CUDA_MEMCPY2D */
struct device_copy {
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

struct device_api {
#define DEVICE_FIELD(field, symbol, required, parameters) int(*field) parameters;
	DEVICE_FUNCTIONS(DEVICE_FIELD)
#undef DEVICE_FIELD
};

/* The values that cuda.h gives them. */
enum device_constant {
	DEVICE_STATUS_MEMORY = 2,
	DEVICE_STATUS_DEINITIALIZED = 4,
	DEVICE_STATUS_STUB = 34,
	DEVICE_STATUS_NO_DEVICE = 100,
	DEVICE_STATUS_BAD_DEVICE = 101,
	DEVICE_STATUS_BAD_CONTEXT = 201,
	DEVICE_STATUS_ECC = 214,
	DEVICE_STATUS_NOT_FOUND = 500,
	DEVICE_STATUS_ILLEGAL_ADDRESS = 700,
	DEVICE_STATUS_TIMEOUT = 702,
	DEVICE_STATUS_CONTEXT_DESTROYED = 709,
	DEVICE_STATUS_ASSERT = 710,
	DEVICE_STATUS_STACK = 714,
	DEVICE_STATUS_ILLEGAL_INSTRUCTION = 715,
	DEVICE_STATUS_MISALIGNED_ADDRESS = 716,
	DEVICE_STATUS_ADDRESS_SPACE = 717,
	DEVICE_STATUS_BAD_PC = 718,
	DEVICE_STATUS_LAUNCH_FAILED = 719,
	DEVICE_ATTRIBUTE_MAJOR = 75,
	DEVICE_ATTRIBUTE_MINOR = 76,
	DEVICE_ATTRIBUTE_MOST_SHARED = 97,
	DEVICE_JIT_ERROR_LOG = 5,
	DEVICE_JIT_ERROR_LOG_SIZE = 6,
	DEVICE_STREAM_NON_BLOCKING = 1,
	DEVICE_FUNC_MAX_THREADS = 0,
	DEVICE_FUNC_SHARED_BYTES = 1,
	DEVICE_FUNC_LOCAL_BYTES = 3,
	DEVICE_FUNC_REGISTERS = 4,
	DEVICE_FUNC_GIVEN_BYTES = 8,
	DEVICE_POINTER_TYPE = 2,
	DEVICE_POINTER_MANAGED = 8,
	DEVICE_MEMORY_HOST = 1,
	DEVICE_MEMORY_DEVICE = 2,
};

struct device {
	struct library library;
	struct device_api api;
	int handle;	/* CUdevice */
	void *context;	/* its primary context; NULL until it is retained */
	int arch;	/* 10 major + minor: 90 is sm_90 */
	size_t most_shared; /* bytes of shared memory that a launch may give to a block */
	int version;	/* of the driver: 13000 is 13.0 */
	int absent;	/* device_open failed because this machine has no driver or no device at all */
	char name[128]; /* "NVIDIA H100 80GB HBM3" */
};

struct device_kernel {
	char name[SOURCE_SYMBOL_SIZE];
	void *function; /* NULL: the module has no kernel of that name */
	size_t given_bytes; /* of shared memory, to each block by every launch */
	struct rnea_resources resources;
};

/* A driver call that did not return 0, as one of our codes; CONTEXT, with what to do about it, where the context is
   lost. `call` is for the message. */
enum rnea_code device_failed(const struct device *d, int status, const char *call, struct rnea_error *e);

/* How many devices the driver shows; 0 and an error where there is none. Errors: NO_DRIVER, NO_DEVICE, DRIVER. */
int device_count(struct rnea_error *e);

/* Find the driver library and retain the primary context of device `ordinal`. `d` is zeroed first, and is fit for
   device_close whatever the outcome. Errors: NO_DRIVER, NO_DEVICE, DRIVER, CONTEXT, DEVICE_MEMORY. */
enum rnea_code device_open(struct device *d, int ordinal, struct rnea_error *e);
void device_close(struct device *d);

/* Make the context current, unless it is; *pushed tells device_leave whether to undo that. */
enum rnea_code device_enter(const struct device *d, int *pushed, struct rnea_error *e);
void device_leave(const struct device *d, int pushed);

/* The functions below want the context to be current. */

/* Load a cubin, or PTX with its final NUL; `name` is for messages. */
enum rnea_code device_load(
	const struct device *d, const void *image, const char *name, void **module, struct rnea_error *e);
void device_unload(const struct device *d, void *module);

/* Copy the module's variable `symbol` to *text (malloc; a NUL is added) and its bytes to *size. Errors: TEXT where the
   module has none, MEMORY, DRIVER. */
enum rnea_code device_read(
	const struct device *d, void *module, const char *symbol, char **text, size_t *size, struct rnea_error *e);

/* Bytes of shared memory that a kernel may have of its own. */
enum { OWN_SHARED = 48 << 10 };

/* Look kernel->name up and load its code; a module without it is no error: kernel->function is then NULL. A block of it stages
   `stage` bytes: beyond 48 KiB launches give them, where the device has so many. */
enum rnea_code device_find(
	const struct device *d, void *module, struct device_kernel *kernel, size_t stage, struct rnea_error *e);

/* Blocks of `block` threads that one multiprocessor holds at once; 0: the kernel cannot run in such blocks. */
enum rnea_code device_resident(
	const struct device *d, const struct device_kernel *kernel, unsigned block, int *blocks, struct rnea_error *e);

/* Blocks of so many samples that a batch takes; one where it is empty. */
unsigned device_blocks(size_t count, size_t samples);

/* Enqueue a kernel: `grid` blocks, `parts` times. */
enum rnea_code device_launch(const struct device *d, const struct device_kernel *kernel, unsigned grid, unsigned parts,
	unsigned block, void **parameters, void *stream, struct rnea_error *e);

/* Memory of the device, and page-locked memory of the program. Freeing 0 or NULL is a no-op; nothing is reported. */
enum rnea_code device_alloc(const struct device *d, size_t size, unsigned long long *address, struct rnea_error *e);
enum rnea_code device_alloc_host(const struct device *d, size_t size, void **memory, struct rnea_error *e);

/* Make `size` bytes numbers that are nan, of either precision, in a stream. */
enum rnea_code device_fill_nan(
	const struct device *d, unsigned long long address, size_t size, void *stream, struct rnea_error *e);
void device_free(const struct device *d, unsigned long long address);
void device_free_host(const struct device *d, void *memory);

/* What the driver knows of a pointer: memory of the program that it has not locked, that it has locked, or memory that
   the program cannot touch. */
enum device_kind { DEVICE_KIND_PAGEABLE, DEVICE_KIND_LOCKED, DEVICE_KIND_DEVICE };
enum device_kind device_kind(const struct device *d, const void *pointer);

/* `lines` pieces of `width` bytes: `host_pitch` apart in the program's memory, which is page-locked, and one after the
   other on the device. */
struct device_lines {
	void *host;
	unsigned long long device;
	size_t lines, width, host_pitch;
};

/* Enqueue a copy of them. */
enum rnea_code device_copy_in(const struct device *d, const struct device_lines *l, void *stream, struct rnea_error *e);
enum rnea_code device_copy_out(
	const struct device *d, const struct device_lines *l, void *stream, struct rnea_error *e);

/* Wait for a stream. */
enum rnea_code device_wait(const struct device *d, void *stream, struct rnea_error *e);

/* A stream of our own, which no other stream waits for; synchronised and destroyed by device_finish. */
enum rnea_code device_stream(const struct device *d, void **stream, struct rnea_error *e);
enum rnea_code device_finish(const struct device *d, void *stream, struct rnea_error *e);

#endif
