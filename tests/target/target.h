#ifndef TESTS_TARGET_H
#define TESTS_TARGET_H
/* A generated text, compiled by a C compiler and loaded. */

#include "target/array.h"
#include "rneagen.h"

#define TARGET_FUNCTIONS(T)                                                                                            \
	struct {                                                                                                       \
		void (*rnea)(const T *q, const T *qd, const T *qdd, T *tau);                                           \
		void (*batch)(const T *q, const T *qd, const T *qdd, T *tau, size_t count);                            \
		void (*fpass)(const T *q, const T *qd, const T *qdd, T *v, T *a, T *f);                                \
		void (*bpass)(const T *q, const T *f, T *tau);                                                         \
	}

struct target {
	struct rneagen_options options;
	struct rneagen_result text;
	char what[256]; /* for messages: robot, options, compiler */
	char stem[128]; /* of the files that target_open wrote, "" if it did not */
	int f32, f32_inside; /* numbers in memory, and those that are computed with: are they float? */
	void *library;
	TARGET_FUNCTIONS(float) single;
	TARGET_FUNCTIONS(double) wide;
	void (*sincos_single)(float x, float *s, float *c);
	void (*sincos_wide)(double x, double *s, double *c);
};

/* How a text becomes a shared object: the compiler and further flags, NULL-terminated. */
struct compiler {
	const char *command;
	const char *flags[8];
};

/* Why it cannot be used here, or NULL; with `fma` the processor has to run what it compiles for AVX2 and FMA. */
const char *compiler_lacks(const struct compiler *c, int fma);

/* Can it be used here? If not, that is said. */
int compiler_serves(const struct compiler *c, int fma);

/* The nvcc of NVCC, of PATH or of the toolkit's folder; NULL where there is none, which is said. */
const char *target_nvcc(void);

/* What every text must pass without a word. */
#define WARNING_FLAGS "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror"

/* A file in the folder where the tests build, which is made. */
struct target_path {
	char s[512];
};
struct target_path target_path(const char *name, const char *suffix);

void target_write(struct target_path path, const char *text);

/* tests/robots/NAME.urdf, or of "chain N" N bodies that slide along x, y and z in turn: many rows, and hardly any
   arithmetic. Freed by the caller; the test fails where it cannot be read. */
char *target_robot(const char *name, size_t *length);

/* Generate; the test fails with a message where that fails. `what` names the robot. */
void target_generate(
	struct target *t, const char *urdf, size_t length, const struct rneagen_options *o, const char *what);

/* Run a compiler on a file; the test fails with what it said where it fails or says anything. */
void target_compile(const struct target *t, const char *const *argv);

/* Generate for target C, compile, load. The files are called `stem` and stay when the test fails. */
void target_open(struct target *t, const char *urdf, size_t length, const struct rneagen_options *o,
	const struct compiler *c, const char *stem);
void target_close(struct target *t);

/* The address of a function of the library; the test fails where there is none. */
void target_symbol(const struct target *t, void *library, const char *name, void *function);

void target_rnea(const struct target *t, const struct array *q, const struct array *qd, const struct array *qdd,
	const struct array *tau);
void target_batch(const struct target *t, const struct array *q, const struct array *qd, const struct array *qdd,
	const struct array *tau, size_t count);
/* out: v, a, f */
void target_fpass(const struct target *t, const struct array *q, const struct array *qd, const struct array *qdd,
	const struct array out[3]);
void target_bpass(const struct target *t, const struct array *q, const struct array *f, const struct array *tau);
/* The text's own sine and cosine. */
void target_sincos(const struct target *t, double x, double *s, double *c);

#endif
