/* The targets: a record each. */
#include "emit/target_type.h"
#include "base/template.h"
#include <stddef.h>

static const struct kernel_frames KERNEL_CUDA = {.direct = template_kernel_soa_in, .staged_aos = template_kernel_aos_in,
	.staged_soa = template_kernel_soa_staged_in, .again = template_kernel_again_in, .parts = template_parts_in,
	.apart = template_kernel_apart_in,
	.spill = template_spill_in, .slices = template_slices_in, .stage = template_stage_in,
	.stage_aos = template_stage_aos_in, .stage_rows_aos = template_stage_rows_aos_in, .stage_join = template_stage_join_in,
	.stage_join_threads = template_stage_join_threads_in,
	.stage_launch = template_stage_launch_in, .stage_start = template_stage_start_in,
	.stage_copy = template_stage_copy_in, .stage_bulk = template_stage_bulk_in, .stage_come = template_stage_come_in,
	.windowed = template_kernel_windowed_in, .windows = template_windows_in,
	.store = template_store_in, .store_tiles = template_store_tiles_in, .prefetch = template_prefetch_in,
	.zeros = template_zeros_in, .compiler = "__CUDACC__"};

static const char *const SUFFIXES_CUDA[] = {".cu", NULL}, *const SUFFIXES_C[] = {".c", NULL},
			 *const SUFFIXES_HEADER[] = {".h", ".hh", ".hpp", ".hxx", ".cuh", NULL};

const struct target_type TARGET_CUDA = {.suffixes = SUFFIXES_CUDA, .precision = RNEAGEN_F32,
	.frame = template_kernel_cu_in, .arithmetic = template_arithmetic_cuda_in,
	.strict_arithmetic = template_arithmetic_strict_cuda_in, .patterns = template_patterns_cu_in, .kernel = &KERNEL_CUDA,
	.has_unit = 1, .has_batches = 1, .aliases = ".",
	.note = " * Compiled as C, without CUDA, this text holds the functions of target c instead of kernels.\n"};

const struct target_type TARGET_C = {.suffixes = SUFFIXES_C, .precision = RNEAGEN_F64, .frame = template_function_c_in,
	.declarations = template_function_h_in, .arithmetic = template_arithmetic_c_in,
	.strict_arithmetic = template_arithmetic_strict_c_in, .patterns = template_patterns_c_in, .has_batches = 1,
	.aliases = "; tau may be qdd itself.", .note = ""};

const struct target_type TARGET_HEADER = {.suffixes = SUFFIXES_HEADER, .precision = RNEAGEN_F32,
	.frame = template_header_h_in, .arithmetic = template_arithmetic_header_in,
	.strict_arithmetic = template_arithmetic_strict_header_in, .has_unit = 1, .is_header = 1, .aliases = ".", .note = ""};

const struct target_type *target_type_of(enum rneagen_target target)
{
	static const struct target_type *const targets[] = {
#define TARGET_ENTRY(upper, word) [RNEAGEN_TARGET_##upper] = &TARGET_##upper,
		RNEAGEN_TARGETS(TARGET_ENTRY)
#undef TARGET_ENTRY
	};

	return targets[target];
}

const char *emit_target_name(enum rneagen_target target)
{
	static const char *const names[] = {
#define TARGET_NAME(upper, word) word,
		RNEAGEN_TARGETS(TARGET_NAME)
#undef TARGET_NAME
	};

	return names[target];
}
