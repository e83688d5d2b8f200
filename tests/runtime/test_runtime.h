#ifndef TEST_RUNTIME_H
#define TEST_RUNTIME_H
/* The suites of test_runtime and what they share. */

#include "rnea.h"
#include <check.h>

Suite *suite_info(void);
Suite *suite_open(void);
Suite *suite_launch(void);
Suite *suite_jit(void);
Suite *suite_nvrtc(void);
Suite *suite_run(void);
Suite *suite_choose(void);
Suite *suite_backend(void);
Suite *suite_hits(void);
Suite *suite_threads(void);

/* Choose the pretended driver and compiler, with nothing wrong with them; returns a handle for dlsym. */
void use_fakes(void);

/* Things taken from the pretended driver and not given back. */
int fake_live(void);

/* A function of the pretended driver, or of the pretended NVRTC. */
void fake_function(const char *library, const char *name, void *slot);

/* The same, and a cache in a folder of its own; without it again, when all that was taken must have been given back. */
void use_folder(void);
void drop_folder(void);

/* The pendulum computes on either way to launch it; closed afterwards. */
void pendulum_computes(struct rnea_robot *robot);

/* A whole file, or tests/runtime/pendulum.cu, NUL-terminated, malloc; `length` may be NULL. */
char *read_text(const char *path, size_t *length);
char *pendulum(size_t *length);

/* A copy of it, malloc, in which the first `from` is replaced by `to`. */
char *pendulum_with(const char *from, const char *to);

/* rnea_open of a NUL-terminated text. */
enum rnea_code open_text(
	const char *text, const struct rnea_options *o, struct rnea_robot **robot, struct rnea_error *e);

/* The error is `code`, its message is one line and contains `part`. */
void assert_error(const struct rnea_error *e, enum rnea_code code, const char *part);

/* From now on the allocation after `n` more fails, and every later one; a negative n ends that. */
void fail_allocation(long n);

/* Whether an allocation failed since. */
int allocation_failed(void);

#endif
