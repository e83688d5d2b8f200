#ifndef FAKE_CUDA_H
#define FAKE_CUDA_H
/* Shared by the files of the pretended driver; see fake_cuda.c. */

#include <stddef.h>

enum { FAKE_PARAMETER_LIMIT = 80, FAKE_LAST_LIMIT = 4096 };

enum fake_status {
	FAKE_SUCCESS,
	FAKE_INVALID_VALUE = 1,
	FAKE_OUT_OF_MEMORY = 2,
	FAKE_NO_DEVICE = 100,
	FAKE_INVALID_DEVICE = 101,
	FAKE_INVALID_IMAGE = 200,
	FAKE_INVALID_CONTEXT = 201,
	FAKE_INVALID_HANDLE = 400,
	FAKE_NOT_FOUND = 500,
};

/* As fake_device.h lays it out. */
struct fake_kernel {
	void (*run)(void **parameters, unsigned grid, unsigned parts, unsigned block, unsigned given);
	unsigned count, last_bytes;
	unsigned min_blocks;
	unsigned *most_given;
};

struct fake_launch {
	const struct fake_kernel *kernel;
	unsigned grid, parts, block; /* parts: the grid along y */
	unsigned given; /* bytes of shared memory for each block */
	unsigned long long parameters[FAKE_PARAMETER_LIMIT];
	_Alignas(64) unsigned char last[FAKE_LAST_LIMIT]; /* the last parameter, which may be longer */
};

/* Nonzero if RNEA_FAKE_CUDA_FAIL says that `call` fails, or if it wants a current context and there is none. */
int fake_entry(const char *call, int wants_context);

/* Begin an entry point of the driver with it: what is wrong already is its result. */
#define ENTER(wants_context)                                                                                           \
	do {                                                                                                           \
		int entry_status = fake_entry(__func__, wants_context);                                                \
		if (entry_status)                                                                                      \
			return entry_status;                                                                           \
	} while (0)

/* One more, or fewer, thing that somebody has to give back. */
void fake_count_live(int change);

/* A piece of work that waits in a stream. */
struct fake_work {
	int is_copy;
	struct fake_launch launch;
	void *to;
	const void *from;
	size_t width, height, to_pitch, from_pitch;
};

/* Do it now, or when the stream is waited for, if fake_cuda_defer said so. */
int fake_enqueue(void *stream, const struct fake_work *work);

/* Tell RNEA_FAKE_CUDA_LAUNCHES which device is current. */
void fake_note_launch(void);

/* Run now; one launch at a time. */
void fake_run(const struct fake_launch *launch);

#endif
