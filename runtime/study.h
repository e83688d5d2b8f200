#ifndef RUNTIME_STUDY_H
#define RUNTIME_STUDY_H
/* One robot in many variants: what each computes wrong, and how long it takes. For the commands report and choose. */

#include "analysis.h"
#include "bench.h"
#include "command.h"
#include "files.h"
#include "judge.h"

enum { STUDY_WORDS = 8, STUDY_BATCHES = 16, STUDY_PRECISIONS = 8 };

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

/* NAN, or a negative number of registers, where there is nothing to say. */
struct study_row {
	enum rnea_backend backend;
	enum rneagen_precision precision;
	enum rneagen_trig trig;
	enum rneagen_layout layout;
	size_t batch;
	double ns, spread, floor_ratio;
	struct judge_errors errors;
	double bound_max, model_change;
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

struct study {
	const struct command *command;
	const struct study_options *options;
	struct file_content urdf;
	struct analysis analysis;
	struct study_backend backends[STUDY_WORDS];
	int backend_count;
	struct judge *judges[STUDY_PRECISIONS]; /* by enum rneagen_precision; NULL: not yet */
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
	"                             several, by commas (default: all); so the next two\n"                            \
	"  --trig accurate|bounded|fast\n"                                                                             \
	"  --layout soa|aos\n"                                                                                         \
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

/* Read the URDF and find the backends; the GPU's own sine leaves the default where --strict is asked for. On failure prints a message and returns the exit status, 1 or 2; else 0. The
   study is given to study_close in either case. */
int study_open(struct study *s, const struct command *c, struct study_options *o);
void study_close(struct study *s);

/* The judge of a precision, made when it is first asked for; NULL when memory runs out. */
const struct judge *study_judge(struct study *s, enum rneagen_precision precision);

/* Fill row->bound_max for the variant that `row` begins with: NAN where no bound is known. Error: MEMORY. */
enum rneagen_code study_bound(struct study *s, struct study_row *row);

/* Compile the variant that `row` begins with and fill the rest, for each batch of the options: batch_count rows that
   follow each other. Errors: UNSUPPORTED, with the runtime's message, MEMORY. */
enum rneagen_code study_measure(struct study *s, struct study_backend *b, struct study_row *row);

/* How many variants the options ask for; the backend and first fields of number i, in order. */
int study_variants(const struct study *s);
struct study_backend *study_variant(struct study *s, int i, struct study_row *row);

#endif
