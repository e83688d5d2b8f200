#ifndef RNEA_INFO_PARSER_H
#define RNEA_INFO_PARSER_H
/* The info table while it is read; info_array.c has the lines about arrays, info_kernels.c those
   about launches, info_table.c all others. */

#include "core/info_table.h"
#include "core/words.h"

/* Who knows nothing of parts, of functions, of relays, of hands, of threads of a sample, of a relay's wide blocks, or of outputs
   that are transposed must not launch a text that has them: each was a version more. */
enum {
	VERSION = 1,
	VERSION_PARTS = 2,
	VERSION_FUNCTIONS = 3,
	VERSION_RELAY = 4,
	VERSION_HANDS = 5,
	VERSION_STARTS = 6,
	VERSION_LEVELS = 7,
	VERSION_THREADS = 8,
	VERSION_WIDE = 9,
	VERSION_TRANSPOSED = 10,
	VERSION_ROUNDS = 11,
	VERSION_LAST = VERSION_ROUNDS,
	BLOCK_LIMIT = 1024,
	PARTS_LIMIT = 65535,
	STAGE_LIMIT = 48 << 10,
	SAMPLES_LIMIT = 32,
	LIMBS_LIMIT = 16,
	GROUPS_LIMIT = 4,
	RELAY_LIMIT = 32,
	RELAY_SAMPLES = 32,
	PART_BLOCK_LIMIT = 256,
	ARCH_LIMIT = 999,
	TILE_ROWS_LIMIT = 256,
	GIVEN_LIMIT = 227 << 10,
	ROOM_LIMIT = 1 << 16
};

/* The keys that stand once: in the text; from KEY_OPERATIONS on for each function. */
enum key {
	KEY_NAME,
	KEY_PRECISION,
	KEY_ARITHMETIC,
	KEY_LAYOUT,
	KEY_TRIG,
	KEY_BASE,
	KEY_NQ,
	KEY_NV,
	KEY_NB,
	KEY_BLOCK,
	KEY_KERNELS,
	KEY_OPERATIONS,
	KEY_PARTS,
	KEY_STAGE,
	KEY_SEGMENTS,
	KEY_LIMBS,
	KEY_RELAY,
	KEY_START_LIMBS,
	KEY_START_PARTS,
	KEY_WHOLE_LIMBS,
	KEY_HANDS,
	KEY_PART_KERNELS,
	KEY_TILES,
	KEY_THREADS,
	KEY_TRANSPOSE,
	KEY_COUNT
};

struct parser {
	struct words w; /* of the text: what is not read yet */
	size_t version;
	int seen[KEY_COUNT];
	unsigned kernels;
	struct rnea_info *info;
	struct rnea_function *functions, *f; /* f: the one that is being read; NULL: none is begun */
	struct rnea_argument *arguments;     /* of all functions, one after the other; those of `f` are the last */
	struct rnea_joint *joints;
	struct rnea_matrix *matrices;
	size_t argument_count, matrix_count;
	int *row, *col; /* of the elements of all matrices */
	size_t element_count;
};

/* "f32" or "f64". */
enum rnea_code info_scalar(struct parser *p, enum rnea_scalar *scalar);

/* A number that is no size, between limits. */
enum rnea_code info_count(struct parser *p, unsigned *value, size_t least, size_t most);

/* The rest of a line `input`, `output`, `matrix` or `row`. */
enum rnea_code info_argument(struct parser *p, int is_output);
enum rnea_code info_matrix(struct parser *p);
enum rnea_code info_row(struct parser *p);

/* Of a line `tiles`: an argument and a number of rows for each, to its end. */
enum rnea_code info_tiles(struct parser *p);

/* How kernels are launched (info_kernels.c). `parts`: of the limbs' kernel along y of its grid; 0: as many as the function has,
   which may be told later. Of hands a number for each kernel, to the end of the line. */
enum rnea_code info_limbs(struct parser *p, struct rnea_limbs *l, unsigned parts);
enum rnea_code info_hands(struct parser *p);
enum rnea_code info_part_kernels(struct parser *p);
enum rnea_code info_relay(struct parser *p);
enum rnea_code info_threads(struct parser *p);
enum rnea_code info_transpose(struct parser *p);

/* How many elements of the matrix have been read. */
size_t info_stored(const struct parser *p, const struct rnea_matrix *m);

#endif
