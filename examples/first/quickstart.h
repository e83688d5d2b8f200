#ifndef QUICKSTART_H
#define QUICKSTART_H

#include <stddef.h>

/* tau = ID(q, qd, qdd) for `count` samples on GPU 0 with the CUDA C in the file `text`; arrays are [row][sample] in the
   computer's memory. Returns GPU_SKIPPED with the reason in message[] where there is no GPU or no NVRTC. */
enum gpu_outcome { GPU_DONE, GPU_SKIPPED, GPU_FAILED };

struct gpu_job {
	const char *text;
	size_t count;
	const float *inputs[3]; /* q, qd, qdd */
	float *tau;
	double seconds;	    /* of one launch, data on the GPU */
	char message[2048]; /* "" where GPU_DONE */
};

enum gpu_outcome gpu_run(struct gpu_job *job);

/* Seconds since some moment. */
double seconds_now(void);

#endif
