#ifndef RNEAGEN_EMIT_TILES_H
#define RNEAGEN_EMIT_TILES_H
/* Kernels of large batches whose rows a copy engine moves (plan/tiles/tiles.h). */

#include "emit/emit.h"

/* Those of them that move tiles (emit_tiles.c): what they call; what their launch does before; their line of the
   table; one of them, which has `direct` to do where there is no engine. */
struct tiled_kernel {
	const struct function *function;
	const struct part *part; /* NULL: it is none that has slices of its own */
	const char *name, *handed, *spill, *zeros, *direct;
};
void emit_tiles(const struct emission *e, struct text *out);
const char *emit_tiles_launch(const struct emission *e);
void emit_info_tiles(const struct emission *e, struct text *out);
void emit_tiled_kernel(const struct emission *e, const struct tiled_kernel *k, struct text *out);

#endif
