#ifndef RNEAGEN_STAGE_H
#define RNEAGEN_STAGE_H
/* A kernel's shared memory: how much there is, which arrays have a place in it where it stages its samples, and the windows
   through which outputs leave where they have none. */

#include "plan/device.h"
#include "plan/plan.h"

/* Words from one slot of a window to the next: a row's elements, and a sample's, are in different banks. */
enum { WINDOW_PITCH = WARP_THREADS + 1 };

/* Bytes of a number in memory; of one in a register. */
int stage_number_bytes(const struct rneagen_options *o);
int stage_arithmetic_bytes(const struct rneagen_options *o);

/* Are these the same numbers, f32 or f64? A value that waits in memory has all its bits then. */
int stage_is_plain(const struct rneagen_options *o);

/* Whose place an array takes: its own, but tau that of qdd: a joint's qdd is read before its torque is written. */
int stage_place(const struct dag *d, int argument);

/* Has it a place of its own? Not what all samples share. */
int stage_has_place(const struct dag *d, int argument);

/* Words from one sample's rows to the next one's; words of a sample; do the arrays, or so many words
   of a sample, have room? */
int stage_pitch(int rows, const struct rneagen_options *o);
int stage_words(const struct dag *d, const struct rneagen_options *o);
int stage_fits(const struct dag *d, const struct rneagen_options *o);
int stage_has_room(int words, const struct rneagen_options *o);

/* In layout aos: is it better to stage all arrays than to have windows? */
int stage_holds_all(const struct dag *d, const struct rneagen_options *o);

/* In layout aos, outputs that have no room go through windows: functions, all of one text, share out the outputs. A slot of a
   window holds an element of a warp's samples. Where all slots are taken, the lines of matrices leave that are complete, all
   together, and what is always zero leaves with its neighbours: so few stretches of memory begin or end within a sector. Returns
   0 when memory runs out. */
int windows_choose(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a);

/* Is the output always zero? */
int output_is_zero(const struct dag *d, const struct output *o);

#endif
