# Module by module, properties, the command line.
rneagen_add_test(test_spatial)
rneagen_add_test(test_inertia)
rneagen_add_test(test_dag expression.c)
rneagen_add_test(test_tree read.c)
rneagen_add_test(test_golden)
rneagen_add_test(test_bodies read.c)
target_link_libraries(test_bodies PRIVATE reference)

# The evaluator again, with quad precision where the compiler has it.
rneagen_add_test(test_eval expression.c ${CMAKE_SOURCE_DIR}/gen/dag/eval.c)
include(CheckIncludeFile)
check_include_file(quadmath.h HAVE_QUADMATH)
if(HAVE_QUADMATH)
	target_compile_definitions(test_eval PRIVATE RNEAGEN_QUAD)
	target_link_libraries(test_eval PRIVATE quadmath)
endif()

foreach(name test_spatial test_inertia test_eval)
	target_link_libraries(${name} PRIVATE m)
endforeach()

# Properties of the evaluated DAG.
rneagen_add_test(test_properties torque.c model.c)
target_link_libraries(test_properties PRIVATE reference)
rneagen_add_test(test_invariance torque.c model.c)
target_link_libraries(test_invariance PRIVATE reference)
rneagen_add_test(test_passes model.c)
target_link_libraries(test_passes PRIVATE reference)

# What a scene says, and what it leaves.
rneagen_add_test(test_saving model.c)
target_link_libraries(test_saving PRIVATE reference)
rneagen_add_test(test_derive)
target_link_libraries(test_derive PRIVATE m)
rneagen_add_test(test_gradient torque.c model.c)
target_link_libraries(test_gradient PRIVATE reference)
rneagen_add_test(test_mass scene_model.c torque.c model.c)
target_link_libraries(test_mass PRIVATE reference)
rneagen_add_test(test_friction model.c)
target_link_libraries(test_friction PRIVATE reference)
rneagen_add_test(test_scene read.c)
rneagen_add_test(test_scene_read read.c)
rneagen_add_test(test_scene_drawn ${scene_trial})
rneagen_add_test(test_scene_trees scene_model.c torque.c model.c)
target_link_libraries(test_scene_trees PRIVATE reference)
rneagen_add_test(test_scene_constants scene_model.c torque.c model.c)
target_link_libraries(test_scene_constants PRIVATE reference)

# What inputs are drawn from.
rneagen_add_test(test_draw scene_model.c torque.c model.c)
target_link_libraries(test_draw PRIVATE reference m)

# What a scene takes and gives, and what is dropped of it.
add_library(task STATIC task.c task_check.c task_draw.c reference_oracle.c scene_model.c torque.c model.c)
target_link_libraries(task PUBLIC rneagen::rneagen reference PkgConfig::CHECK)
foreach(name test_drop test_task test_task_equal test_task_fold test_task_motion test_task_names)
	rneagen_add_test(${name})
	target_link_libraries(${name} PRIVATE task)
endforeach()

# The text.
rneagen_add_test(test_emit model.c)
target_link_libraries(test_emit PRIVATE reference)
rneagen_add_test(test_hostile)
rneagen_add_test(test_generate process.c)
target_link_libraries(test_generate PRIVATE reference)
rneagen_add_test(test_memory arena_each.c)
rneagen_add_test(test_growth)
rneagen_add_test(test_share)
target_link_libraries(test_share PRIVATE reference)
