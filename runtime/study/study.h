#ifndef RUNTIME_STUDY_H
#define RUNTIME_STUDY_H
/* One robot in many variants: what each computes wrong, and how long it takes. For the commands report and choose. */

#include "passes/analysis.h"
#include "study/bench.h"
#include "rnearun/command.h"
#include "cli/files.h"
#include "study/judge.h"
#include "rnearun/progress.h"

enum { STUDY_WORDS = 8, STUDY_BATCHES = 16, STUDY_PRECISIONS = 8, STUDY_TRIGS = 3, STUDY_LAYOUTS = 2 };

struct study_list {
	int values[STUDY_WORDS], count;
};

/* What the command line asks for. */
struct study_options {
	struct study_list backends, precisions, trigs, layouts; /* of enum rnea_backend, rneagen_precision, ... */
	int backend_asked;                                      /* a backend that is not there is an error */
	int precision_asked, trig_asked;                        /* else --strict leaves out what it excludes */
	int compiles_anew;                                      /* what was compiled before is not used */
	size_t batches[STUDY_BATCHES];
	int batch_count;
	struct draw_options sample;
};

/* One variant; what was measured is NAN, or a negative number of registers, where there is nothing to say. */
struct study_row {
	enum rnea_backend backend;
	enum rneagen_precision precision;
	enum rneagen_trig trig;
	unsigned same; /* bits 1 << trig: other trigonometries that are the same code here, of which this is the first */
	enum rneagen_layout layout;
	size_t batch;
	double ns, least, spread; /* of one sample: the median of the runs, the least; the quartiles' distance over the median */
	double floor_ratio;
	struct judge_errors errors;
	double bound_max, model_change;
	double proved; /* by study_prove */
	int registers;
	size_t spill_bytes;
	unsigned parts;
	double compile_ms;
};

struct study_backend {
	enum rnea_backend backend;
	struct bench *bench;
	struct rnea_robot *floors[2]; /* by enum rnea_scalar */
	char device[128], compiler[640], target[64];
	unsigned threads;
};

/* What the variants of a precision are held against. By a precision's own analysis, since constants may be chosen by it. */
struct study_precision {
	struct analysis analysis;
	struct judge judge;
};

struct study {
	const struct command *command;
	const struct study_options *options;
	struct file_content urdf;
	struct analysis analysis; /* of what is the same in all precisions: arrays, ranges */
	struct study_backend backends[STUDY_WORDS];
	int backend_count;
	struct study_row *variants; /* variant_count of them: that nothing was measured of yet */
	int variant_count;
	struct progress progress;
	struct study_precision *precisions[STUDY_PRECISIONS]; /* by enum rneagen_precision; NULL: not yet */
	double bounds[STUDY_PRECISIONS][STUDY_WORDS][2]; /* by precision, trig, and whether on a GPU; 0: not yet */
	double model_change; /* by constants that the scene changes; NAN: none */
	struct rneagen_error error;
};

const char *study_backend_name(enum rnea_backend backend);

/* Rows for getopt_long, before COMMAND_OPTIONS, of whose options they replace some: the first row of a name counts. */
#define STUDY_OPTIONS                                                                                                  \
	{"backend", required_argument, NULL, STUDY_BACKEND}, {"precision", required_argument, NULL, STUDY_PRECISION},  \
	{"trig", required_argument, NULL, STUDY_TRIG}, {"layout", required_argument, NULL, STUDY_LAYOUT},              \
	{"batch", required_argument, NULL, STUDY_BATCH}, {"samples", required_argument, NULL, STUDY_SAMPLES},          \
	{"seed", required_argument, NULL, STUDY_SEED}, {"qd-range", required_argument, NULL, OPTION_QD_RANGE},         \
	{"qdd-range", required_argument, NULL, OPTION_QDD_RANGE}
enum { STUDY_BACKEND = COMMAND_OWN, STUDY_PRECISION, STUDY_TRIG, STUDY_LAYOUT, STUDY_BATCH, STUDY_SAMPLES, STUDY_SEED,
	STUDY_OWN };

/* Their lines of --help. */
#define STUDY_HELP                                                                                                     \
	"  --backend cpu|cuda|all     several, by commas (default: all that are there)\n"                              \
	"  --precision f32|f64|mixed|f32x2\n"                                                                          \
	"                             several, by commas (default: all, f32x2 on GPUs alone); so the next two\n"       \
	"  --trig accurate|bounded|fast\n"                                                                             \
	"  --layout soa|aos\n"                                                                                         \
	"  --device N                 which GPU (default 0)\n"                                                         \
	"  --samples N                samples of all inputs in which errors are measured (default 1000)\n"             \
	"  --seed N                   of the samples (default 1)\n"                                                    \
	"  --qd-range X               short for --range qd=-X,X\n"                                                     \
	"  --qdd-range X              short for --range qdd=-X,X\n"

/* Everything, the samples of STUDY_HELP; no batch. */
struct study_options study_options_default(void);

/* Take an option of STUDY_OPTIONS: 0; 2 and a message; -1 if `key` is none. */
int study_take(struct study_options *o, const char *name, int key, const char *word);

/* A positive finite number; 2 and a message if it is none. */
int study_number(const char *name, const char *option, const char *word, double *value);

/* Read the URDF, find the backends and list the variants; the GPU's own sine leaves the default where --strict is asked for,
   and f32x2 on the processor unless it is asked for. On failure prints a message and returns the exit status, 1 or 2; else 0.
   The study is given to study_close in either case. */
int study_open(struct study *s, const struct command *c, struct study_options *o);
void study_close(struct study *s);

/* The part of study_open that fills s->variants, in the order of the options. Errors: those of generating, MEMORY. */
enum rneagen_code study_plan(struct study *s);

/* "cpu f64 bounded soa"; the trigonometries that are the same code, "fast". */
void study_name(const struct study_row *row, char *text, size_t size);
void study_same(const struct study_row *row, const char *between, char *text, size_t size);

/* Show that `done` variants are done and this one is at work. */
void study_show(struct study *s, int done, const struct study_row *row);

/* What a variant's text is generated with, and how it is opened. */
struct rneagen_options study_generate(const struct study *s, const struct study_row *row);
struct rnea_options study_open_options(const struct study *s, enum rnea_backend backend);

/* The runtime's message as the study's. */
enum rneagen_code study_fail(struct study *s, const struct rnea_error *e);

/* The judge of a precision, made when it is first asked for; NULL when memory runs out. */
const struct judge *study_judge(struct study *s, enum rneagen_precision precision);

/* Fill row->bound_max for the variant that `row` begins with: NAN where no bound is known. Error: MEMORY. */
enum rneagen_code study_bound(struct study *s, struct study_row *row);

/* Fill `proved` of all variants: for every state within the limits, the bound of an output array's error, as a norm, over the
   largest norm that the array has in the samples; NAN where none is known. Errors: as prove_errors. */
enum rneagen_code study_prove(struct study *s, double seconds);

/* Compile the variant that `row` begins with, and fill its errors, registers and what compiling took. The caller closes the
   robot, which is NULL on failure. Errors: UNSUPPORTED, with the runtime's message, MEMORY. */
enum rneagen_code study_build(struct study *s, struct study_row *row, struct rnea_robot **robot);

/* Fill the times of batches of `batch` samples, and take the larger errors of these and of the row's, where the judge's samples
   are among them. Errors: as study_build. */
enum rneagen_code study_time(struct study *s, const struct rnea_robot *robot, struct study_row *row, size_t batch);

#endif
