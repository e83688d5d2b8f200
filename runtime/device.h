#ifndef RNEA_DEVICE_H
#define RNEA_DEVICE_H
/* One CUDA device through the driver API, which is opened at run time. */

#include "error.h"
#include "library.h"
#include <stddef.h>

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
	X(func_load, "cuFuncLoad", 0, (void *function))                                                                \
	X(occupancy_block, "cuOccupancyMaxPotentialBlockSize", 0,                                                      \
		(int *grid, int *block, void *function, size_t (*shared)(int block), size_t bytes, int limit))         \
	X(stream_create, "cuStreamCreate", 1, (void **stream, unsigned flags))                                         \
	X(stream_synchronize, "cuStreamSynchronize", 1, (void *stream))                                                \
	X(stream_destroy, "cuStreamDestroy_v2", 1, (void *stream))                                                     \
	X(launch_kernel, "cuLaunchKernel", 1,                                                                          \
		(void *function, unsigned gx, unsigned gy, unsigned gz, unsigned bx, unsigned by, unsigned bz,         \
			unsigned shared, void *stream, void **parameters, void **extra))

struct device_api {
#define DEVICE_FIELD(field, symbol, required, parameters) int(*field) parameters;
	DEVICE_FUNCTIONS(DEVICE_FIELD)
#undef DEVICE_FIELD
};

/* The values that cuda.h gives them. */
enum device_constant {
	DEVICE_STATUS_MEMORY = 2,
	DEVICE_STATUS_STUB = 34,
	DEVICE_STATUS_NO_DEVICE = 100,
	DEVICE_STATUS_BAD_DEVICE = 101,
	DEVICE_STATUS_NOT_FOUND = 500,
	DEVICE_ATTRIBUTE_MAJOR = 75,
	DEVICE_ATTRIBUTE_MINOR = 76,
	DEVICE_JIT_ERROR_LOG = 5,
	DEVICE_JIT_ERROR_LOG_SIZE = 6,
	DEVICE_STREAM_NON_BLOCKING = 1,
	DEVICE_FUNC_MAX_THREADS = 0,
	DEVICE_FUNC_SHARED_BYTES = 1,
	DEVICE_FUNC_LOCAL_BYTES = 3,
	DEVICE_FUNC_REGISTERS = 4,
};

struct device {
	struct library library;
	struct device_api api;
	int handle;     /* CUdevice */
	void *context;  /* its primary context; NULL until it is retained */
	int arch;       /* 10 major + minor: 90 is sm_90 */
	int version;    /* of the driver: 13000 is 13.0 */
	char name[128]; /* "NVIDIA H100 80GB HBM3" */
};

struct device_kernel {
	char name[288];
	void *function; /* NULL: the module has no kernel of that name */
	struct rnea_resources resources;
};

/* Find the driver library and retain the primary context of device `ordinal`. `d` is zeroed first, and is fit for
   device_close whatever the outcome. Errors: NO_DRIVER, NO_DEVICE, DRIVER, DEVICE_MEMORY. */
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
enum rnea_code device_read(const struct device *d, void *module, const char *symbol, char **text, size_t *size,
	struct rnea_error *e);

/* Look kernel->name up and load its code; a module without it is no error: kernel->function is then NULL. */
enum rnea_code device_find(
	const struct device *d, void *module, struct device_kernel *kernel, struct rnea_error *e);

/* Enqueue a kernel in one dimension. */
enum rnea_code device_launch(const struct device *d, const struct device_kernel *kernel, unsigned grid, unsigned block,
	void **parameters, void *stream, struct rnea_error *e);

/* A stream of our own, which no other stream waits for; synchronised and destroyed by device_finish. */
enum rnea_code device_stream(const struct device *d, void **stream, struct rnea_error *e);
enum rnea_code device_finish(const struct device *d, void *stream, struct rnea_error *e);

#endif
