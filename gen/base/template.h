#ifndef RNEAGEN_TEMPLATE_H
#define RNEAGEN_TEMPLATE_H
/* The frames of the generated texts are real files in templates/, embedded at build time; @SLOT@ marks a place. */

#include "base/text.h"

struct slot {
	const char *name, *value;
};

/* Append the template with each @NAME@ replaced; a name that is not among the slots makes the text fail. A slot alone
   on its line whose value is empty takes the line with it. */
void template_expand(struct text *out, const char *tmpl, const struct slot *slots, size_t count);

/* The same up to the slot @end@, for what is too long to be made twice. Returns what follows that slot, "" on failure. */
const char *template_expand_to(struct text *out, const char *tmpl, const char *end, const struct slot *slots, size_t count);

/* The files of templates/, by name with '.' turned into '_' (made by embed.cmake). */
extern const char template_kernel_cu_in[], template_kernel_soa_in[], template_kernel_aos_in[], template_stage_aos_in[];
extern const char template_kernel_windowed_in[], template_windows_in[], template_stage_copy_in[], template_stage_bulk_in[], template_stage_come_in[],
	template_bounded_finite_in[];
extern const char template_kernel_soa_staged_in[], template_stage_in[], template_slices_in[],
	template_stage_launch_in[], template_store_in[], template_store_tiles_in[], template_prefetch_in[],
	template_parts_small_in[];
extern const char template_alone_in[], template_launch_alone_in[];
extern const char template_zeros_in[], template_zeros_table_in[], template_zeros_loop_in[];
extern const char template_function_c_in[], template_function_h_in[], template_header_h_in[], template_further_h_in[],
	template_body_in[], template_is_small_in[];
extern const char template_head_c_in[], template_part_in[], template_are_small_in[], template_any_in[];
extern const char template_part_small_in[], template_part_any_in[], template_part_each_in[], template_part_turned_in[], template_group_in[], template_group_segments_in[], template_few_in[], template_gather_in[], template_gather_aos_in[];
extern const char template_anew_in[], template_arithmetic_c_in[], template_arithmetic_cuda_in[], template_arithmetic_header_in[];
extern const char template_arithmetic_strict_c_in[], template_arithmetic_strict_cuda_in[], template_arithmetic_strict_flush_in[];
extern const char template_bounded_in[], template_bounded_sincos_in[], template_bounded_store_in[],
	template_bounded_quotient_in[], template_bounded_function_in[];
extern const char template_swept_in[], template_swept_function_in[];
extern const char template_parts_in[], template_kernel_apart_in[];
extern const char template_kernel_tiles_in[], template_tiles_in[], template_tiles_out_in[], template_tiles_leave_in[],
	template_tiles_launch_in[];
extern const char template_parts_apart_in[], template_launch_hands_in[], template_stage_rows_aos_in[], template_stage_join_in[];
extern const char template_segment_in[], template_segment_lanes_in[], template_segment_one_in[];
extern const char template_segments_one_in[], template_header_lanes_in[], template_header_lanes_end_in[];
extern const char template_segment_columns_in[], template_segment_columns_row_in[], template_segment_columns_put_in[];
extern const char template_kernel_solve_in[], template_kernel_columns_in[], template_launch_relay_in[];
extern const char template_kernel_segments_in[], template_kernel_segment_in[], template_kernel_segments_rounds_in[];
extern const char template_launch_segments_in[];
extern const char template_slice_in[], template_batch_in[];
extern const char template_sincos_f32_core_in[], template_sincos_f32_accurate_in[];
extern const char template_sincos_f32_bounded_in[], template_sincos_f32_fast_in[], template_sincos_f32_known_in[];
extern const char template_sincos_f64_core_in[], template_sincos_f64_accurate_in[];
extern const char template_sincos_f64_bounded_in[], template_sincos_f64_known_in[];
extern const char template_sincos_f32x2_core_in[], template_sincos_f32x2_accurate_in[];
extern const char template_sincos_f32x2_bounded_in[], template_sincos_f32x2_known_in[], template_f32x2_in[],
	template_f32x2_quotient_in[], template_reciprocal_in[];
extern const char template_joints_in[], template_independent_in[], template_function_one_in[], template_sincos_declaration_in[];
extern const char template_kernel_limbs_in[], template_limbs_join_in[], template_limb_in[];
extern const char template_limb_known_in[], template_launch_limbs_in[], template_limb_table_in[], template_limbs_first_in[];
extern const char template_limbs_room_in[];
extern const char template_kernel_again_in[], template_call_known_in[], template_call_any_in[], template_spill_in[];
extern const char template_columns_in[], template_segment_columns_c_in[], template_lanes_in[], template_lanes_call_in[];
extern const char template_each_in[], template_each_numbers_in[], template_numbers_in[];
extern const char template_segment_columns_many_in[], template_segment_zeros_in[];
extern const char template_way_back_in[], template_way_back_start_in[];
extern const char template_sines_in[], template_sines_bytes_in[], template_header_known_in[];
extern const char template_patterns_c_in[], template_patterns_cu_in[], template_arithmetic_strict_header_in[];
extern const char template_sincos_pair_accurate_in[], template_sincos_pair_bounded_in[], template_sincos_pair_known_in[];
extern const char template_arithmetic_strict_c_operations_in[], template_arithmetic_strict_cuda_operations_in[];

#endif
