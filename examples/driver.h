#ifndef DRIVER_H
#define DRIVER_H
/* Memory of GPU 0 from the CUDA driver: the few functions needed of cuda.h, found when the program runs, so that it
   starts on machines without a GPU. What returns int returns the driver's status, 0 if all is well. */

#include <stddef.h>

enum { DRIVER_ABSENT = 100 }; /* CUDA_ERROR_NO_DEVICE; here also: there is no driver */

struct driver {
	void *library;
	int device;
	int (*init)(unsigned flags);
	int (*get_device)(int *device, int ordinal);
	int (*retain)(void **context, int device);
	int (*release)(int device);
	int (*push)(void *context);
	int (*pop)(void **context);
	int (*synchronize)(void);
	int (*alloc)(unsigned long long *address, size_t size);
	int (*free)(unsigned long long address);
	int (*to_device)(unsigned long long to, const void *from, size_t size);
	int (*to_host)(void *to, unsigned long long from, size_t size);
};

/* Makes the primary context current, which librnea uses too. driver_stop is to be called only after a 0. */
int driver_start(struct driver *d);
void driver_stop(struct driver *d);

/* `size` bytes on the GPU, a copy of those at `from` unless that is NULL. Released with driver_free, also after an
   error; NULL is a no-op. */
int driver_array(const struct driver *d, void **array, const void *from, size_t size);
void driver_free(const struct driver *d, void *array);

/* Waits for what was launched, then copies. */
int driver_read(const struct driver *d, void *to, const void *array, size_t size);

#endif
