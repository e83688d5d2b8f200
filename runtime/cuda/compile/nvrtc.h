#ifndef RNEA_NVRTC_H
#define RNEA_NVRTC_H
/* The NVRTC library: where it may be, and the functions of it that are used. */

#include "core/failure.h"
#include "core/library.h"
#include <stddef.h>

/* What is used of NVRTC, as nvrtc.h declares it: nvrtcResult is int, nvrtcProgram a pointer. Result, field, symbol,
   parameters. */
#define NVRTC_FUNCTIONS(X)                                                                                             \
	X(int, version, "nvrtcVersion", (int *major, int *minor))                                                      \
	X(const char *, get_error_string, "nvrtcGetErrorString", (int status))                                         \
	X(int, create_program, "nvrtcCreateProgram",                                                                   \
		(void **program, const char *source, const char *name, int header_count, const char *const *headers,   \
			const char *const *include_names))                                                             \
	X(int, destroy_program, "nvrtcDestroyProgram", (void **program))                                               \
	X(int, compile_program, "nvrtcCompileProgram", (void *program, int count, const char *const *options))         \
	X(int, get_log_size, "nvrtcGetProgramLogSize", (void *program, size_t *size))                                  \
	X(int, get_log, "nvrtcGetProgramLog", (void *program, char *log))                                              \
	X(int, get_cubin_size, "nvrtcGetCUBINSize", (void *program, size_t *size))                                     \
	X(int, get_cubin, "nvrtcGetCUBIN", (void *program, char *image))                                               \
	X(int, get_ptx_size, "nvrtcGetPTXSize", (void *program, size_t *size))                                         \
	X(int, get_ptx, "nvrtcGetPTX", (void *program, char *image))                                                   \
	X(int, get_arch_count, "nvrtcGetNumSupportedArchs", (int *count))                                              \
	X(int, get_archs, "nvrtcGetSupportedArchs", (int *archs))

struct nvrtc_api {
#define NVRTC_FIELD(result, field, symbol, parameters) result(*field) parameters;
	NVRTC_FUNCTIONS(NVRTC_FIELD)
#undef NVRTC_FIELD
};

/* The values that nvrtc.h gives them. */
enum nvrtc_status {
	NVRTC_STATUS_MEMORY = 1,
	NVRTC_STATUS_COMPILATION = 6,
};

struct nvrtc {
	struct library library;
	struct nvrtc_api api;
	int major, minor; /* 13, 0 */
};

/* Find NVRTC: RNEA_NVRTC alone if it is set; otherwise the library that the process has already loaded, CUDA_HOME and
   CUDA_PATH, /usr/local/cuda*, the wheels of pip in the environments in sight, the dynamic linker's path. `n` is zeroed
   first, and is fit for nvrtc_close whatever the outcome. Errors: NO_COMPILER (lists what was tried), COMPILER. */
enum rnea_code nvrtc_open(struct nvrtc *n, struct rnea_error *e);

/* Which NVRTC nvrtc_open would open: "path size mtime inode" of its file. It is found in the same search and not
   loaded, which takes longer than all else of an open from the cache; only where nothing is left but the dynamic
   linker's path it has to be. Returns 0, and "" as text, if there is none or the text does not fit into `size` bytes.
   A file that is there and does not load is found here and passed over by nvrtc_open. After nvrtc_open the library is
   loaded, and the identity is surely its: what was compiled is to be kept only if that is still the same text. */
int nvrtc_identity(char *text, size_t size);
void nvrtc_close(struct nvrtc *n);

#endif
