/* The part of device.h that moves data: memory, copies, streams. */
#include "cuda/device.h"
#include <limits.h>

enum rnea_code device_alloc(const struct device *d, size_t size, unsigned long long *address, struct rnea_error *e)
{
	int status = d->api.mem_alloc(address, size);

	if (!status)
		return RNEA_OK;
	*address = 0;
	return device_failed(d, status, "cuMemAlloc", e);
}

enum rnea_code device_alloc_host(const struct device *d, size_t size, void **memory, struct rnea_error *e)
{
	int status = d->api.mem_alloc_host(memory, size);

	if (!status)
		return RNEA_OK;
	*memory = NULL;
	return device_failed(d, status, "cuMemAllocHost", e);
}

enum rnea_code device_fill_nan(
	const struct device *d, unsigned long long address, size_t size, void *stream, struct rnea_error *e)
{
	int status = d->api.memset_d8_async(address, 0xff, size, stream);

	return status ? device_failed(d, status, "cuMemsetD8Async", e) : RNEA_OK;
}

void device_free(const struct device *d, unsigned long long address)
{
	if (address)
		d->api.mem_free(address);
}

void device_free_host(const struct device *d, void *memory)
{
	if (memory)
		d->api.mem_free_host(memory);
}

enum device_kind device_kind(const struct device *d, const void *pointer)
{
	unsigned long long address = (unsigned long long)(size_t)pointer;
	int attributes[] = {DEVICE_POINTER_TYPE, DEVICE_POINTER_MANAGED};
	unsigned type = 0, managed = 0; /* what the driver has never heard of has neither */
	void *values[] = {&type, &managed};

	if (d->api.pointer_get_attributes(2, attributes, values, address) != 0)
		return DEVICE_KIND_PAGEABLE;
	if (type == DEVICE_MEMORY_HOST)
		return DEVICE_KIND_LOCKED;
	return type == DEVICE_MEMORY_DEVICE && !managed ? DEVICE_KIND_DEVICE : DEVICE_KIND_PAGEABLE;
}

/* ---- copies ---- */

/* Lines that follow one another are one line. */
static struct device_lines joined(const struct device_lines *l)
{
	struct device_lines j = *l;

	if (l->lines > 1 && l->host_pitch == l->width) {
		j.width = l->lines * l->width;
		j.lines = 1;
	}
	return j;
}

/* All lines by one call; in: to the device. */
static int copy_plane(const struct device *d, const struct device_lines *l, int in, void *stream)
{
	const struct device_copy copy = {.from_type = in ? DEVICE_MEMORY_HOST : DEVICE_MEMORY_DEVICE,
		.from_host = in ? l->host : NULL,
		.from_device = in ? 0 : l->device,
		.from_pitch = in ? l->host_pitch : l->width,
		.to_type = in ? DEVICE_MEMORY_DEVICE : DEVICE_MEMORY_HOST,
		.to_host = in ? NULL : l->host,
		.to_device = in ? l->device : 0,
		.to_pitch = in ? l->width : l->host_pitch,
		.width = l->width,
		.height = l->lines};

	return d->api.memcpy_2d_async(&copy, stream);
}

static int copy_line(const struct device *d, const struct device_lines *l, size_t i, int in, void *stream)
{
	unsigned long long device = l->device + i * l->width;
	char *host = (char *)l->host + i * l->host_pitch;

	return in ? d->api.memcpy_htod_async(device, host, l->width, stream)
		  : d->api.memcpy_dtoh_async(host, device, l->width, stream);
}

static enum rnea_code copy_lines(
	const struct device *d, const struct device_lines *l, int in, void *stream, struct rnea_error *e)
{
	struct device_lines j = joined(l);
	int is_plane = j.lines > 1 && j.host_pitch <= INT_MAX; /* the driver takes no larger pitch */
	int status = is_plane ? copy_plane(d, &j, in, stream) : 0;

	for (size_t i = 0; i < j.lines && !is_plane && !status; i++)
		status = copy_line(d, &j, i, in, stream);
	return status ? device_failed(d, status, is_plane ? "cuMemcpy2DAsync" : in ? "cuMemcpyHtoDAsync" : "cuMemcpyDtoHAsync", e)
		      : RNEA_OK;
}

enum rnea_code device_copy_in(const struct device *d, const struct device_lines *l, void *stream, struct rnea_error *e)
{
	return copy_lines(d, l, 1, stream, e);
}

enum rnea_code device_copy_out(const struct device *d, const struct device_lines *l, void *stream, struct rnea_error *e)
{
	return copy_lines(d, l, 0, stream, e);
}

/* ---- streams ---- */

enum rnea_code device_stream(const struct device *d, void **stream, struct rnea_error *e)
{
	int status = d->api.stream_create(stream, DEVICE_STREAM_NON_BLOCKING);

	if (!status)
		return RNEA_OK;
	*stream = NULL;
	return device_failed(d, status, "cuStreamCreate", e);
}

enum rnea_code device_wait(const struct device *d, void *stream, struct rnea_error *e)
{
	int status = d->api.stream_synchronize(stream);

	return status ? device_failed(d, status, "cuStreamSynchronize", e) : RNEA_OK;
}

enum rnea_code device_finish(const struct device *d, void *stream, struct rnea_error *e)
{
	int destroyed;

	device_wait(d, stream, e);
	if ((destroyed = d->api.stream_destroy(stream)) != 0)
		device_failed(d, destroyed, "cuStreamDestroy", e);
	return e->code;
}
