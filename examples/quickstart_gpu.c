/* A text of rneagen on a GPU: librnea compiles and launches it; memory is the caller's, here from the CUDA driver. */
#include "quickstart.h"
#include "rnea.h"
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 7, ARRAYS = 4, LAUNCHES = 100 };

/* The few functions needed of cuda.h, found when the program runs, so that it starts on machines without a GPU. */
struct cuda {
	void *library;
	int (*get_device)(int *device, int ordinal);
	int (*retain)(void **context, int device);
	int (*release)(int device);
	int (*set_current)(void *context);
	int (*synchronize)(void);
	int (*alloc)(unsigned long long *address, size_t size);
	int (*free)(unsigned long long address);
	int (*to_device)(unsigned long long to, const void *from, size_t size);
	int (*to_host)(void *to, unsigned long long from, size_t size);
};

static int find(void *library, const char *symbol, void *slot)
{
	void *address = dlsym(library, symbol);

	memcpy(slot, &address, sizeof address);
	return address == NULL;
}

/* Not zero if something is not there. */
static int cuda_open(struct cuda *c)
{
	const char *name = getenv("RNEA_LIBCUDA");

	c->library = dlopen(name ? name : "libcuda.so.1", RTLD_NOW);
	return !c->library || find(c->library, "cuDeviceGet", &c->get_device) ||
	       find(c->library, "cuDevicePrimaryCtxRetain", &c->retain) ||
	       find(c->library, "cuDevicePrimaryCtxRelease_v2", &c->release) ||
	       find(c->library, "cuCtxSetCurrent", &c->set_current) ||
	       find(c->library, "cuCtxSynchronize", &c->synchronize) || find(c->library, "cuMemAlloc_v2", &c->alloc) ||
	       find(c->library, "cuMemFree_v2", &c->free) || find(c->library, "cuMemcpyHtoD_v2", &c->to_device) ||
	       find(c->library, "cuMemcpyDtoH_v2", &c->to_host);
}

/* Launches over arrays that lie on the GPU; returns the CUDA driver's status, or -1 with the job's message set. */
static int launch(const struct cuda *c, const struct rnea_robot *robot, void *const *arrays, struct gpu_job *job)
{
	struct rnea_error e;
	double start = 0;
	int status = 0;

	/* the first launch is left out of the time */
	for (int i = 0; i <= LAUNCHES && !status; i++) {
		if (i == 1) {
			status = c->synchronize();
			start = seconds_now();
		}
		if (rnea_launch(robot, arrays, job->count, NULL, &e)) {
			snprintf(job->message, sizeof job->message, "%s", e.message);
			return -1;
		}
	}
	if (!status)
		status = c->synchronize();
	job->seconds = (seconds_now() - start) / LAUNCHES;
	return status;
}

/* The same for arrays in the computer's memory. */
static int copy_and_launch(const struct cuda *c, const struct rnea_robot *robot, struct gpu_job *job)
{
	unsigned long long memory[ARRAYS] = {0};
	void *arrays[ARRAYS];
	size_t size = ROWS * job->count * sizeof(float);
	int status = 0;

	for (int i = 0; i < ARRAYS && !status; i++) {
		status = c->alloc(&memory[i], size);
		arrays[i] = (void *)(size_t)memory[i];
		if (!status && i < 3)
			status = c->to_device(memory[i], job->inputs[i], size);
	}
	if (!status)
		status = launch(c, robot, arrays, job);
	if (!status)
		status = c->to_host(job->tau, memory[3], size);
	for (int i = 0; i < ARRAYS; i++)
		c->free(memory[i]);
	return status;
}

static enum gpu_outcome run_robot(const struct rnea_robot *robot, struct gpu_job *job)
{
	struct cuda c;
	void *context;
	int device = 0, status = cuda_open(&c);

	if (!status)
		status = c.get_device(&device, 0);
	if (!status)
		status = c.retain(&context, device);
	if (!status) {
		status = c.set_current(context);
		if (!status)
			status = copy_and_launch(&c, robot, job);
		c.release(device);
	}
	if (status && !*job->message)
		snprintf(job->message, sizeof job->message, "the CUDA driver answers with status %d", status);
	return status ? GPU_FAILED : GPU_DONE;
}

static int is_absence(enum rnea_code code)
{
	return code == RNEA_NO_DRIVER || code == RNEA_NO_DEVICE || code == RNEA_NO_COMPILER;
}

enum gpu_outcome gpu_run(struct gpu_job *job)
{
	struct rnea_robot *robot;
	struct rnea_error e;
	enum rnea_code code = rnea_open_file(job->text, NULL, &robot, &e);
	enum gpu_outcome outcome;

	if (code) {
		snprintf(job->message, sizeof job->message, "%s", e.message);
		return is_absence(code) ? GPU_SKIPPED : GPU_FAILED;
	}
	outcome = run_robot(robot, job);
	rnea_close(robot);
	return outcome;
}
