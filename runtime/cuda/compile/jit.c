#include "cuda/compile/jit.h"
#include "core/log.h"
#include "cuda/compile/nvrtc.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static enum rnea_code failed(const struct nvrtc *n, int status, const char *call, struct rnea_error *e)
{
	if (status == NVRTC_STATUS_MEMORY)
		return rnea_error_memory(e);
	return rnea_error_set(e, RNEA_COMPILER, "NVRTC %d.%d (%s): %s: %s", n->major, n->minor, n->library.path, call,
		n->api.get_error_string(status));
}

/* The architecture to compile for: the device's own, else the newest that is older, as PTX. */
static enum rnea_code choose_arch(const struct nvrtc *n, int arch, int *chosen, struct rnea_error *e)
{
	int count = 0, oldest = 0, *archs;
	int status = n->api.get_arch_count(&count);

	*chosen = 0;
	if (status || count < 1)
		return failed(n, status, "nvrtcGetNumSupportedArchs", e);
	if (!(archs = calloc((size_t)count, sizeof *archs)))
		return rnea_error_memory(e);
	if ((status = n->api.get_archs(archs)) != 0) {
		free(archs);
		return failed(n, status, "nvrtcGetSupportedArchs", e);
	}
	for (int i = 0; i < count; i++) {
		if (archs[i] <= arch && archs[i] > *chosen)
			*chosen = archs[i];
		if (oldest == 0 || archs[i] < oldest)
			oldest = archs[i];
	}
	free(archs);
	if (*chosen)
		return RNEA_OK;
	return rnea_error_set(e, RNEA_COMPILER,
		"NVRTC %d.%d (%s) compiles for sm_%d and later, the device is sm_%d; RNEA_NVRTC may name an older one",
		n->major, n->minor, n->library.path, oldest, arch);
}

/* NVRTC's log; "" if there is none to be had. */
static char *read_log(const struct nvrtc *n, void *program)
{
	size_t size = 0;
	char *log;

	if (n->api.get_log_size(program, &size) != 0)
		size = 0;
	if (!(log = calloc(size + 1, 1)))
		return NULL;
	if (size && n->api.get_log(program, log) != 0)
		log[0] = '\0';
	return log;
}

/* The first line of the log that says what is wrong, and the line after it, which quotes the text. */
static enum rnea_code compile_error(
	const struct nvrtc *n, int status, const char *log, const struct jit_request *r, struct rnea_error *e)
{
	enum rnea_code code = status == NVRTC_STATUS_COMPILATION ? RNEA_COMPILE : RNEA_COMPILER;
	struct log_error found;

	if (!log_find_error(log, &found))
		return rnea_error_set(e, code, "NVRTC %d.%d (%s): %s: %s", n->major, n->minor, n->library.path, r->file,
			*log ? log : n->api.get_error_string(status));
	return rnea_error_set(e, code, "NVRTC %d.%d: %.*s%s%.*s", n->major, n->minor, (int)found.line_length,
		found.line, found.quoted_length ? ": " : "", (int)found.quoted_length, found.quoted);
}

static enum rnea_code compile(
	const struct nvrtc *n, void *program, int arch, int is_ptx, const struct jit_request *r, struct rnea_error *e)
{
	char gpu[48];
	const char **options = calloc(r->option_count + 1, sizeof *options);
	char *log;
	int status;

	if (!options)
		return rnea_error_memory(e);
	snprintf(gpu, sizeof gpu, "--gpu-architecture=%s_%d", is_ptx ? "compute" : "sm", arch);
	options[0] = gpu;
	for (size_t i = 0; i < r->option_count; i++)
		options[i + 1] = r->options[i];
	status = n->api.compile_program(program, (int)r->option_count + 1, options);
	free(options);
	if (!(log = read_log(n, program)))
		return rnea_error_memory(e);
	if (r->log && r->log_size)
		snprintf(r->log, r->log_size, "%s", log);
	if (status == NVRTC_STATUS_MEMORY)
		rnea_error_memory(e);
	else if (status)
		compile_error(n, status, log, r, e);
	free(log);
	return e->code;
}

static enum rnea_code take_image(const struct nvrtc *n, void *program, struct jit_image *image, struct rnea_error *e)
{
	int status = image->is_ptx ? n->api.get_ptx_size(program, &image->size)
				   : n->api.get_cubin_size(program, &image->size);

	if (status)
		return failed(n, status, "the size of the image", e);
	if (!(image->data = malloc(image->size + 1)))
		return rnea_error_memory(e);
	image->data[image->size] = '\0';
	status = image->is_ptx ? n->api.get_ptx(program, image->data) : n->api.get_cubin(program, image->data);
	return status ? failed(n, status, "the image", e) : RNEA_OK;
}

static enum rnea_code build(
	const struct nvrtc *n, const struct jit_request *r, struct jit_image *image, struct rnea_error *e)
{
	void *program = NULL;
	int arch, status;

	if (choose_arch(n, r->arch, &arch, e))
		return e->code;
	image->arch = arch;
	image->is_ptx = arch != r->arch;
	snprintf(image->compiler, sizeof image->compiler, "NVRTC %d.%d (%s)", n->major, n->minor, n->library.path);
	if ((status = n->api.create_program(&program, r->source, r->file, 0, NULL, NULL)) != 0)
		return failed(n, status, "nvrtcCreateProgram", e);
	if (!compile(n, program, arch, image->is_ptx, r, e))
		take_image(n, program, image, e);
	n->api.destroy_program(&program);
	return e->code;
}

enum rnea_code jit_compile(const struct jit_request *r, struct jit_image *image, struct rnea_error *e)
{
	struct nvrtc n;

	memset(image, 0, sizeof *image);
	if (!nvrtc_open(&n, e))
		build(&n, r, image, e);
	nvrtc_close(&n);
	if (e->code)
		jit_free(image);
	return e->code;
}

void jit_free(struct jit_image *image)
{
	free(image->data);
	memset(image, 0, sizeof *image);
}
