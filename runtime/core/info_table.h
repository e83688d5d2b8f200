#ifndef RNEA_INFO_TABLE_H
#define RNEA_INFO_TABLE_H
/* The table that a generated text holds about itself: lines `key values`, the first `rneagen-info VERSION`.

   Of the text, each once (`arithmetic` at most once: where it does not stand, it is the precision):

	name NAME | precision f32|f64 | arithmetic WORD | layout soa|aos | trig WORD | base WORD | nq N | nv N | nb N | block N
	joint IQ NQ IV NV TYPE NAME               (one line each; the name goes to the end of the line)

   Of each function, from its line `function` to the next, in the order in which the text has them; the first is what
   rnea_launch launches:

	function NAME
	input NAME ROWS f32|f64 sample|batch ROLE [OF]
	output NAME ROWS f32|f64 sample|batch ROLE [OF]    (one line each, in the order of the signature)
	matrix NAME ROWS COLS general|lower       (an output's; after it its rows, from 0:)
	row NAME ROW COL COL ...                  (the columns of what is stored; in all, as many as the output has rows)
	parameters NAME COL LINK                  (of a regressor: the ten columns from COL on are the link's; to the end of the line)
	operations MUL ADD SUB NEG FMA SINCOS     (a sample; once)
	stage BYTES                               (of shared memory in which the kernel stages each sample, where it does)
	segments BYTES SAMPLES                    (of a kernel in segments: what a sample keeps in the block's own shared memory,
	                                          and how many samples a thread takes at most: as many as have room in 48 KiB)
	limbs WARPS GROUPS BYTES SAMPLES          (of its kernel of small batches, NAME_FUNCTION_limbs, where it has one: the warps
	                                          that share out a sample; groups of 32 samples in a block at most; shared memory
	                                          of a group, given by launches; samples of a batch up to which it is faster)
	whole_limbs WARPS GROUPS BYTES SAMPLES    (the same, where that kernel has one block along y, whatever `parts` says)
	parts N                                   (blocks of the kernel's grid along y, 2 and more, where it has such)
	relay BYTES THREADS ROOM [SAMPLES]        (a launch runs NAME_FUNCTION_start_kernel before its kernel, and after it
	                                          NAME_FUNCTION_solve_kernel, in blocks of so many samples, 32 where no number
	                                          stands, and threads for each, with shared memory given by launches; blocks beyond
	                                          which more along y gain nothing)
	start_limbs WARPS GROUPS BYTES SAMPLES    (as whole_limbs, of NAME_FUNCTION_start_limbs, which takes the first one's place;
	                                          where there is no relay it runs before NAME_FUNCTION_limbs, for as many samples)
	start_parts N                             (blocks of the relay's first kernel along y, 2 and more, where it has such)
	threads N BLOCK                           (of the kernel: so many for each sample, each of an alike limb; samples of a block
	                                          at most)
	transpose SAMPLES THREADS BYTES           (outputs are written as [row][sample] of so many samples at a time; after all
	                                          other kernels a launch runs NAME_FUNCTION_transpose_kernel, a block for these
	                                          samples, in blocks of so many threads, one along y for each output, with
	                                          shared memory given by launches)

	hands N ...                               (a launch runs NAME_FUNCTION_hands_kernel before its kernel, with so many blocks along
	                                          y, unless the kernel of small batches runs; where more numbers stand, before its kernel
	                                          NAME_FUNCTION_hands1_kernel, NAME_FUNCTION_hands2_kernel, ... too)
	part_kernels SAMPLES KERNELS THREADS ARCH (from so many samples on a launch runs NAME_FUNCTION_part0_kernel,
	                                          NAME_FUNCTION_part1_kernel, ..., in such blocks, instead of its kernel, hands among
	                                          them; from this compute capability on, ten times)
	tiles ARGUMENT ROWS ...                   (of each a tensor map: what these kernels take beside their parameters)

   ROLE is a word of RNEA_ROLES; OF is the link, joint or constant that it speaks of, and goes to the end of the line. A
   role that is not known is none.

   Versions 1 and 2 have no line `function` and no roles: what stands of a function is that of rnea, and a line

	kernels rnea|fpass|bpass ...              (at most once; where it does not stand, all three may be there)

   says which the text has. core/info_old.c makes functions of that. Version 2 has `parts`, version 1 does not: who
   knows nothing of parts would launch a text of parts and leave the rest unwritten. Version 3 has no `relay`,
   version 4 has it in its first function. Version 5 has `hands` there, version 6
   `start_parts`, version 7 more than one number of `hands`, version 8 `threads`, version 9 SAMPLES of `relay`, version 10
   `transpose`, version 11 `start_limbs` without a relay. A key that is not listed is passed over: what would change the
   meaning of the rest gets a new version. */

#include "core/failure.h"

/* Parse `length` bytes at `text`; a final NUL may be among them. On success *info is to be released with
   rnea_info_free, on failure it is empty. Errors: TABLE (the message has the line), MEMORY. */
enum rnea_code rnea_info_parse(const char *text, size_t length, struct rnea_info *info, struct rnea_error *e);

/* The same for the table of the text that defines NAME_info: it must call the robot `name`. */
enum rnea_code rnea_info_read(
	const char *text, size_t length, const char *name, struct rnea_info *info, struct rnea_error *e);
void rnea_info_free(struct rnea_info *info);

/* Function i is not in the text: leave it out, if the table only guesses that it is. Returns 0 where it must be there. */
int rnea_info_lacks(struct rnea_info *info, size_t i);

/* The kernel of small batches is not to be had: tell of none. */
void rnea_info_without_limbs(struct rnea_info *info);

/* Nor kernels of parts. */
void rnea_info_without_part_kernels(struct rnea_info *info);

/* The index of the function `name`, info->function_count where there is none. */
size_t rnea_info_function(const struct rnea_info *info, const char *name);

#endif
