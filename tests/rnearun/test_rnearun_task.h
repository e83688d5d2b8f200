#ifndef TEST_RNEARUN_TASK_H
#define TEST_RNEARUN_TASK_H
/* What the parts of test_rnearun_task share. */

#include "rnearun_command.h"

enum { SAMPLES = 200 };

/* Robot i (0: iiwa14) in a scene with a payload in each sample, gravity for the batch, an external force, no
   accelerations; torques and power. */
struct fixture;
struct fixture *fixture_new(int i, int f32);
void fixture_free(struct fixture *f);

/* in.npy of all, and q.npy, qd.npy, payload.npy, push.npy, g.npy. */
void write_inputs(const struct fixture *f);

/* The words of the scene, then more. */
void run_scene(const struct fixture *f, int status, const char *part, const char *const *more);
#define RUN_SCENE(f, status, part, ...) run_scene(f, status, part, (const char *const[]){__VA_ARGS__, NULL})

/* What is refused. */
TCase *case_refused(void);

#endif
