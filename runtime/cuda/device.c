#include "cuda/device.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is to be done where a status means that the context, and all that was in it, is lost; NULL: it is not. */
static const char *lost_context(int status)
{
	switch (status) {
	case DEVICE_STATUS_DEINITIALIZED:
		return "the driver has shut down in this process";
	case DEVICE_STATUS_BAD_CONTEXT:
	case DEVICE_STATUS_CONTEXT_DESTROYED:
		return "the context was destroyed, by a reset of the device perhaps: close this robot and open it "
		       "again";
	case DEVICE_STATUS_ECC:
	case DEVICE_STATUS_ILLEGAL_ADDRESS:
	case DEVICE_STATUS_TIMEOUT:
	case DEVICE_STATUS_ASSERT:
	case DEVICE_STATUS_STACK:
	case DEVICE_STATUS_ILLEGAL_INSTRUCTION:
	case DEVICE_STATUS_MISALIGNED_ADDRESS:
	case DEVICE_STATUS_ADDRESS_SPACE:
	case DEVICE_STATUS_BAD_PC:
	case DEVICE_STATUS_LAUNCH_FAILED:
		return "a kernel, of whatever library, ran before this call and killed the context: start the process "
		       "anew";
	default:
		return NULL;
	}
}

enum rnea_code device_failed(const struct device *d, int status, const char *call, struct rnea_error *e)
{
	const char *name = NULL, *text = NULL, *lost = lost_context(status);
	enum rnea_code code = lost ? RNEA_CONTEXT : RNEA_DRIVER;

	if (status == DEVICE_STATUS_MEMORY)
		code = RNEA_DEVICE_MEMORY;
	else if (status == DEVICE_STATUS_NO_DEVICE || status == DEVICE_STATUS_BAD_DEVICE)
		code = RNEA_NO_DEVICE;
	else if (status == DEVICE_STATUS_STUB)
		code = RNEA_NO_DRIVER;
	d->api.get_error_name(status, &name);
	d->api.get_error_string(status, &text);
	return rnea_error_set(e, code, "CUDA driver (%s): %s: error %d, %s: %s%s%s", d->library.path, call, status,
		name ? name : "unnamed", text ? text : "no description", lost ? "; " : "", lost ? lost : "");
}

static enum rnea_code find_library(struct device *d, struct rnea_error *e)
{
	const char *chosen = getenv("RNEA_LIBCUDA");
	struct library *l = &d->library;

	if (chosen && *chosen) {
		library_try(l, chosen);
	} else {
		d->absent = 1; /* until load_api has what it needs */
		library_try(l, "libcuda.so.1");
		library_try(l, "/usr/lib/wsl/lib/libcuda.so.1");
		library_try(l, "/usr/local/nvidia/lib64/libcuda.so.1");
	}
	if (l->handle)
		return RNEA_OK;
	return rnea_error_set(e, RNEA_NO_DRIVER, "no CUDA driver; tried %s%s%s", l->tried,
		chosen && *chosen ? " (from RNEA_LIBCUDA)" : "",
		chosen && *chosen ? "" : " (RNEA_LIBCUDA names another)");
}

static enum rnea_code load_api(struct device *d, struct rnea_error *e)
{
	const char *missing = NULL;

#define DEVICE_LOAD(field, symbol, required, parameters)                                                               \
	if (!library_symbol(&d->library, symbol, &d->api.field) && required)                                           \
		missing = symbol;
	DEVICE_FUNCTIONS(DEVICE_LOAD)
#undef DEVICE_LOAD
	if (missing)
		return rnea_error_set(e, RNEA_NO_DRIVER,
			"CUDA driver (%s): it has no function %s; a newer driver is needed", d->library.path, missing);
	d->absent = 0;
	return RNEA_OK;
}

static enum rnea_code choose(struct device *d, int ordinal, struct rnea_error *e)
{
	int count = 0, major = 0, minor = 0, most_shared = 0;
	int status = d->api.device_get_count(&count);

	if (status)
		return device_failed(d, status, "cuDeviceGetCount", e);
	d->absent = count == 0;
	if (ordinal < 0 || ordinal >= count)
		return rnea_error_set(e, RNEA_NO_DEVICE, "no CUDA device %d: the driver (%s) shows %d", ordinal,
			d->library.path, count);
	if ((status = d->api.device_get(&d->handle, ordinal)) != 0)
		return device_failed(d, status, "cuDeviceGet", e);
	if ((status = d->api.device_get_name(d->name, (int)sizeof d->name, d->handle)) != 0)
		return device_failed(d, status, "cuDeviceGetName", e);
	status = d->api.device_get_attribute(&major, DEVICE_ATTRIBUTE_MAJOR, d->handle);
	if (!status)
		status = d->api.device_get_attribute(&minor, DEVICE_ATTRIBUTE_MINOR, d->handle);
	if (!status)
		status = d->api.device_get_attribute(&most_shared, DEVICE_ATTRIBUTE_MOST_SHARED, d->handle);
	if (status)
		return device_failed(d, status, "cuDeviceGetAttribute", e);
	d->arch = 10 * major + minor;
	d->most_shared = (size_t)most_shared;
	return RNEA_OK;
}

/* The driver, ready to be asked. */
static enum rnea_code begin(struct device *d, struct rnea_error *e)
{
	int status;

	memset(d, 0, sizeof *d);
	if (find_library(d, e) || load_api(d, e))
		return e->code;
	if ((status = d->api.init(0)) == 0)
		return RNEA_OK;
	d->absent = status == DEVICE_STATUS_NO_DEVICE || status == DEVICE_STATUS_STUB;
	return device_failed(d, status, "cuInit", e);
}

int device_count(struct rnea_error *e)
{
	struct device d;
	int count = 0, status;

	if (!begin(&d, e) && (status = d.api.device_get_count(&count)) != 0)
		device_failed(&d, status, "cuDeviceGetCount", e);
	else if (!e->code && !count)
		rnea_error_set(e, RNEA_NO_DEVICE, "no CUDA device: the driver (%s) shows none", d.library.path);
	library_close(&d.library);
	return e->code ? 0 : count;
}

enum rnea_code device_open(struct device *d, int ordinal, struct rnea_error *e)
{
	int status;

	if (begin(d, e))
		return e->code;
	if ((status = d->api.driver_get_version(&d->version)) != 0)
		return device_failed(d, status, "cuDriverGetVersion", e);
	if (choose(d, ordinal, e))
		return e->code;
	if ((status = d->api.primary_ctx_retain(&d->context, d->handle)) != 0) {
		d->context = NULL;
		return device_failed(d, status, "cuDevicePrimaryCtxRetain", e);
	}
	return RNEA_OK;
}

void device_close(struct device *d)
{
	if (d->context)
		d->api.primary_ctx_release(d->handle);
	d->context = NULL;
	library_close(&d->library);
}

enum rnea_code device_enter(const struct device *d, int *pushed, struct rnea_error *e)
{
	void *current = NULL;
	int status;

	*pushed = 0;
	if ((status = d->api.ctx_get_current(&current)) != 0)
		return device_failed(d, status, "cuCtxGetCurrent", e);
	if (current == d->context)
		return RNEA_OK;
	if ((status = d->api.ctx_push_current(d->context)) != 0)
		return device_failed(d, status, "cuCtxPushCurrent", e);
	*pushed = 1;
	return RNEA_OK;
}

void device_leave(const struct device *d, int pushed)
{
	void *context;

	if (pushed)
		d->api.ctx_pop_current(&context);
}

/* The first line of the driver's own log, if it wrote one. */
static void first_line(char *log)
{
	log[strcspn(log, "\n")] = '\0';
}

enum rnea_code device_load(
	const struct device *d, const void *image, const char *name, void **module, struct rnea_error *e)
{
	char log[512] = "";
	char call[960];
	int options[] = {DEVICE_JIT_ERROR_LOG, DEVICE_JIT_ERROR_LOG_SIZE};
	void *values[] = {log, (void *)(sizeof log - 1)}; /* the driver takes the size itself where a pointer stands */
	int status = d->api.module_load_data_ex(module, image, 2, options, values);

	if (!status)
		return RNEA_OK;
	*module = NULL;
	first_line(log);
	snprintf(call, sizeof call, "cuModuleLoadDataEx of %.300s%s%s", name, *log ? ": " : "", log);
	return device_failed(d, status, call, e);
}

void device_unload(const struct device *d, void *module)
{
	if (module)
		d->api.module_unload(module);
}

enum rnea_code device_read(
	const struct device *d, void *module, const char *symbol, char **text, size_t *size, struct rnea_error *e)
{
	unsigned long long address = 0;
	int status = d->api.module_get_global(&address, size, module, symbol);

	*text = NULL;
	if (status == DEVICE_STATUS_NOT_FOUND)
		return rnea_error_set(e, RNEA_TEXT, "the text defines no device variable %s", symbol);
	if (status)
		return device_failed(d, status, "cuModuleGetGlobal", e);
	if (!(*text = malloc(*size + 1)))
		return rnea_error_memory(e);
	(*text)[*size] = '\0';
	if ((status = d->api.memcpy_dtoh(*text, address, *size)) == 0)
		return RNEA_OK;
	free(*text);
	*text = NULL;
	return device_failed(d, status, "cuMemcpyDtoH", e);
}

static int read_resources(const struct device *d, struct device_kernel *kernel)
{
	static const int wanted[] = {
		DEVICE_FUNC_REGISTERS, DEVICE_FUNC_LOCAL_BYTES, DEVICE_FUNC_SHARED_BYTES, DEVICE_FUNC_MAX_THREADS};
	int got[4] = {0}, grid = 0, block = 0;

	for (int i = 0; i < 4; i++) {
		int status = d->api.func_get_attribute(&got[i], wanted[i], kernel->function);

		if (status)
			return status;
	}
	if (!d->api.occupancy_block || d->api.occupancy_block(&grid, &block, kernel->function, NULL, kernel->given_bytes, 0) != 0)
		block = 0;
	kernel->resources = (struct rnea_resources){.registers = got[0],
		.local_bytes = (size_t)got[1],
		.shared_bytes = (size_t)got[2] + kernel->given_bytes,
		.max_block = (unsigned)got[3],
		.busy_block = (unsigned)block};
	return 0;
}

/* Have launches give the kernel what it stages in, unless that is its own or more than there is. */
static int give(const struct device *d, struct device_kernel *kernel, size_t stage)
{
	kernel->given_bytes = stage > OWN_SHARED && stage <= d->most_shared ? stage : 0;
	return kernel->given_bytes ? d->api.func_set_attribute(kernel->function, DEVICE_FUNC_GIVEN_BYTES, (int)stage) : 0;
}

enum rnea_code device_find(
	const struct device *d, void *module, struct device_kernel *kernel, size_t stage, struct rnea_error *e)
{
	int status = d->api.module_get_function(&kernel->function, module, kernel->name);

	if (status)
		kernel->function = NULL;
	if (status == DEVICE_STATUS_NOT_FOUND)
		return RNEA_OK;
	if (status)
		return device_failed(d, status, "cuModuleGetFunction", e);
	/* CUDA_MODULE_LOADING=LAZY would put this off until the first launch */
	if (d->api.func_load && (status = d->api.func_load(kernel->function)) != 0)
		return device_failed(d, status, "cuFuncLoad", e);
	if ((status = give(d, kernel, stage)) != 0)
		return device_failed(d, status, "cuFuncSetAttribute", e);
	if ((status = read_resources(d, kernel)) != 0)
		return device_failed(d, status, "cuFuncGetAttribute", e);
	return RNEA_OK;
}

enum rnea_code device_resident(
	const struct device *d, const struct device_kernel *kernel, unsigned block, int *blocks, struct rnea_error *e)
{
	int status = d->api.occupancy_blocks(blocks, kernel->function, (int)block, kernel->given_bytes);

	if (!status)
		return RNEA_OK;
	*blocks = 0;
	return device_failed(d, status, "cuOccupancyMaxActiveBlocksPerMultiprocessor", e);
}

unsigned device_blocks(size_t count, size_t samples)
{
	return count ? (unsigned)(count / samples + (count % samples != 0)) : 1;
}

enum rnea_code device_launch(const struct device *d, const struct device_kernel *kernel, unsigned grid, unsigned parts,
	unsigned block, void **parameters, void *stream, struct rnea_error *e)
{
	int status = d->api.launch_kernel(kernel->function, grid, parts, 1, block, 1, 1, (unsigned)kernel->given_bytes, stream,
		parameters, NULL);
	char call[SOURCE_SYMBOL_SIZE + 32];

	if (!status)
		return RNEA_OK;
	snprintf(call, sizeof call, "cuLaunchKernel of %s", kernel->name);
	return device_failed(d, status, call, e);
}
