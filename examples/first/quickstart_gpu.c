/* A text of rneagen on a GPU: librnea compiles and launches it; memory is the caller's, here from the CUDA driver. */
#include "../driver.h"
#include "quickstart.h"
#include "rnea.h"
#include <stdio.h>

enum { ROWS = 7, ARRAYS = 4, LAUNCHES = 100 };

/* Launches over arrays that lie on the GPU; returns the CUDA driver's status, or -1 with the job's message set. */
static int launch(const struct driver *d, const struct rnea_robot *robot, void *const *arrays, struct gpu_job *job)
{
	struct rnea_error e;
	double start = 0;
	int status = 0;

	/* the first launch is left out of the time */
	for (int i = 0; i <= LAUNCHES && !status; i++) {
		if (i == 1) {
			status = d->synchronize();
			start = seconds_now();
		}
		if (rnea_launch(robot, arrays, job->count, NULL, &e)) {
			snprintf(job->message, sizeof job->message, "%s", e.message);
			return -1;
		}
	}
	if (!status)
		status = d->synchronize();
	job->seconds = (seconds_now() - start) / LAUNCHES;
	return status;
}

/* The same for arrays in the computer's memory. */
static int copy_and_launch(const struct driver *d, const struct rnea_robot *robot, struct gpu_job *job)
{
	void *arrays[ARRAYS] = {NULL};
	size_t size = ROWS * job->count * sizeof(float);
	int status = 0;

	for (int i = 0; i < ARRAYS && !status; i++)
		status = driver_array(d, &arrays[i], i < 3 ? job->inputs[i] : NULL, size);
	if (!status)
		status = launch(d, robot, arrays, job);
	if (!status)
		status = driver_read(d, job->tau, arrays[3], size);
	for (int i = 0; i < ARRAYS; i++)
		driver_free(d, arrays[i]);
	return status;
}

static enum gpu_outcome run_robot(const struct rnea_robot *robot, struct gpu_job *job)
{
	struct driver d;
	int status = driver_start(&d);

	if (!status) {
		status = copy_and_launch(&d, robot, job);
		driver_stop(&d);
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
	const struct rnea_options options = {.backend = RNEA_BACKEND_CUDA};
	struct rnea_robot *robot;
	struct rnea_error e;
	enum rnea_code code = rnea_open_file(job->text, &options, &robot, &e);
	enum gpu_outcome outcome;

	if (code) {
		snprintf(job->message, sizeof job->message, "%s", e.message);
		return is_absence(code) ? GPU_SKIPPED : GPU_FAILED;
	}
	outcome = run_robot(robot, job);
	rnea_close(robot);
	return outcome;
}
