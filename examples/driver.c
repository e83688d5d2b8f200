#include "driver.h"
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

static int find(void *library, const char *symbol, void *slot)
{
	void *address = dlsym(library, symbol);

	memcpy(slot, &address, sizeof address);
	return address == NULL;
}

/* Not zero if something is not there. */
static int driver_find(struct driver *d)
{
	const char *name = getenv("RNEA_LIBCUDA");

	d->library = dlopen(name ? name : "libcuda.so.1", RTLD_NOW);
	return !d->library || find(d->library, "cuInit", &d->init) || find(d->library, "cuDeviceGet", &d->get_device) ||
	       find(d->library, "cuDevicePrimaryCtxRetain", &d->retain) ||
	       find(d->library, "cuDevicePrimaryCtxRelease_v2", &d->release) ||
	       find(d->library, "cuCtxPushCurrent_v2", &d->push) || find(d->library, "cuCtxPopCurrent_v2", &d->pop) ||
	       find(d->library, "cuCtxSynchronize", &d->synchronize) || find(d->library, "cuMemAlloc_v2", &d->alloc) ||
	       find(d->library, "cuMemFree_v2", &d->free) || find(d->library, "cuMemcpyHtoD_v2", &d->to_device) ||
	       find(d->library, "cuMemcpyDtoH_v2", &d->to_host);
}

int driver_start(struct driver *d)
{
	void *context;
	int status = driver_find(d) ? DRIVER_ABSENT : d->init(0);

	if (!status)
		status = d->get_device(&d->device, 0);
	if (!status)
		status = d->retain(&context, d->device);
	if (!status && (status = d->push(context)) != 0)
		d->release(d->device);
	return status;
}

void driver_stop(struct driver *d)
{
	void *context;

	d->pop(&context);
	d->release(d->device);
}

int driver_array(const struct driver *d, void **array, const void *from, size_t size)
{
	unsigned long long address = 0;
	int status = d->alloc(&address, size);

	*array = (void *)(size_t)address;
	return status || !from ? status : d->to_device(address, from, size);
}

void driver_free(const struct driver *d, void *array)
{
	if (array)
		d->free((size_t)array);
}

int driver_read(const struct driver *d, void *to, const void *array, size_t size)
{
	int status = d->synchronize();

	return status ? status : d->to_host(to, (size_t)array, size);
}
