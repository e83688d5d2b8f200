# What stands around the generator: the graph, the manual page, the completions.
rneagen_add_test(test_dot read.c)
target_link_libraries(test_dot PRIVATE EXPAT::EXPAT)
find_program(GRAPHVIZ_DOT dot)
add_test(NAME test_dot_graphviz COMMAND test_dot "${GRAPHVIZ_DOT}")
set_tests_properties(test_dot_graphviz PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT ${HANGS})

# tests/fuzz builds these in the preset `fuzz`; a minute of them is a test where asked for.
set(scene_trial scene_trial.c scene_grammar.c scene_garble.c fuzz_check.c ${CMAKE_SOURCE_DIR}/gen/cli/options.c ${CMAKE_SOURCE_DIR}/gen/cli/files.c
	${CMAKE_SOURCE_DIR}/gen/cli/pending.c)
if(RNEAGEN_FUZZ)
	add_executable(fuzz_urdf fuzz_urdf.c fuzz_mutate.c fuzz_check.c)
	add_executable(fuzz_scene fuzz_scene.c ${scene_trial})
	target_compile_definitions(fuzz_scene PRIVATE TEST_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
	foreach(name fuzz_urdf fuzz_scene)
		target_link_libraries(${name} PRIVATE rneagen::rneagen -fsanitize=fuzzer)
	endforeach()
endif()
add_test(NAME fuzz_minute COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/fuzz_minute)
set_tests_properties(fuzz_minute PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT ${HANGS})

# Generation in eight threads at once.
rneagen_add_test(test_threads read.c ${CMAKE_SOURCE_DIR}/gen/cli/files.c ${CMAKE_SOURCE_DIR}/gen/cli/pending.c)
target_link_libraries(test_threads PRIVATE Threads::Threads)
set_tests_properties(test_threads PROPERTIES TIMEOUT ${HANGS})

# --help, the manual page and the completions say the same; the manual page has no fault.
add_test(NAME test_options COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_options $<TARGET_FILE:rneagen-command>)
add_test(NAME test_run_options COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_run_options $<TARGET_FILE:rnearun>)
add_test(NAME test_scene_command COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_scene_command $<TARGET_FILE:rneagen-command>
	$<TARGET_FILE:rnearun>)
add_test(NAME test_files COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_files $<TARGET_FILE:rneagen-command> $<TARGET_FILE:rnearun>)
add_test(NAME test_manual COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_manual)
set_tests_properties(test_manual PROPERTIES SKIP_RETURN_CODE 77)
# the README's table and picture are what the results say
add_test(NAME readme_table COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/gpu/table --check ${PROJECT_SOURCE_DIR}/README.md)
add_test(NAME readme_scenes COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/gpu/table --scenes --check ${PROJECT_SOURCE_DIR}/README.md)
add_test(NAME readme_gradients COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/gpu/table --gradients --check ${PROJECT_SOURCE_DIR}/README.md)
add_test(NAME readme_trajectories COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/gpu/table --trajectories --check
	${PROJECT_SOURCE_DIR}/README.md)
add_test(NAME test_picture COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_picture)
set_tests_properties(test_picture PROPERTIES SKIP_RETURN_CODE 77)

# The command that evaluates arrays: its files.
rneagen_add_test(test_npy test_npy_bad.c ${CMAKE_SOURCE_DIR}/runtime/rnearun/npy.c ${CMAKE_SOURCE_DIR}/runtime/rnearun/npy_header.c)
add_executable(test_rnearun test_rnearun.c test_rnearun_limits.c rnearun_command.c states_file.c process.c)
target_link_libraries(test_rnearun PRIVATE PkgConfig::CHECK m)
target_compile_definitions(test_rnearun PRIVATE TEST_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
add_test(NAME test_rnearun COMMAND test_rnearun $<TARGET_FILE:rnearun> $<TARGET_FILE:rnea_reference>)
add_test(NAME test_rnearun_numpy COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_rnearun_numpy $<TARGET_FILE:rnearun>)
set_tests_properties(test_rnearun test_rnearun_numpy PROPERTIES TIMEOUT ${HANGS} SKIP_RETURN_CODE 77
	ENVIRONMENT "RNEA_LIBCUDA=$<TARGET_FILE:fake_cuda>;RNEA_NVRTC=$<TARGET_FILE:fake_nvrtc>")

# The commands that compare variants: what they judge by, and themselves.
rneagen_add_test(test_judge judged.c model.c ${CMAKE_SOURCE_DIR}/runtime/study/judge.c)
target_link_libraries(test_judge PRIVATE reference m)
rneagen_add_test(test_judge_task judged.c model.c ${CMAKE_SOURCE_DIR}/runtime/study/judge.c)
target_link_libraries(test_judge_task PRIVATE reference m)
add_test(NAME test_rnearun_report COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_rnearun_report $<TARGET_FILE:rnearun>
	$<TARGET_FILE:fake_cuda> $<TARGET_FILE:fake_nvrtc>)
set_tests_properties(test_rnearun_report PROPERTIES TIMEOUT ${HANGS})
rneagen_add_test(test_choice ${CMAKE_SOURCE_DIR}/runtime/study/choice.c)
target_link_libraries(test_choice PRIVATE rnea::rnea m)
rneagen_add_test(test_progress ${CMAKE_SOURCE_DIR}/runtime/rnearun/progress.c)
set(plot_sources)
foreach(source runtime/study/plot runtime/study/plot_labels runtime/study/study_options runtime/rnearun/command runtime/study/judge
		gen/cli/files gen/cli/options gen/cli/pending)
	list(APPEND plot_sources ${CMAKE_SOURCE_DIR}/${source}.c)
endforeach()
rneagen_add_test(test_plot ${plot_sources})
target_link_libraries(test_plot PRIVATE rnea::rnea m)
rneagen_add_test(test_floor ${CMAKE_SOURCE_DIR}/runtime/study/floor.c)
add_dependencies(test_floor fake_cuda fake_nvrtc)
target_link_libraries(test_floor PRIVATE rnea::rnea m)
set_tests_properties(test_floor PROPERTIES
	ENVIRONMENT "RNEA_LIBCUDA=$<TARGET_FILE:fake_cuda>;RNEA_NVRTC=$<TARGET_FILE:fake_nvrtc>")

# rnearun eval over the arrays that a scene makes.
add_executable(test_rnearun_task test_rnearun_task.c test_rnearun_task_refused.c rnearun_command.c states_file.c process.c)
target_link_libraries(test_rnearun_task PRIVATE reference PkgConfig::CHECK m)
target_compile_definitions(test_rnearun_task PRIVATE TEST_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
add_test(NAME test_rnearun_task COMMAND test_rnearun_task $<TARGET_FILE:rnearun>)
set_tests_properties(test_rnearun_task PROPERTIES TIMEOUT ${HANGS}
	ENVIRONMENT "RNEA_LIBCUDA=$<TARGET_FILE:fake_cuda>;RNEA_NVRTC=$<TARGET_FILE:fake_nvrtc>")

# derivatives beside Pinocchio's, where its Python package is
set(pinocchio_robots)
foreach(name iiwa14 ur5 hyq fetch double_pendulum skew_axis prismatic_skew allegro_right angles cartpole
		fixed_tree massless_middle negative_axes nonunit_axis rotated_inertial shuffled_order pendulum root_with_mass gantry)
	list(APPEND pinocchio_robots ${CMAKE_CURRENT_SOURCE_DIR}/robots/${name}.urdf)
endforeach()
add_test(NAME test_gradient_pinocchio
	COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/test_gradient_pinocchio $<TARGET_FILE:rneagen-command> ${pinocchio_robots})
set_tests_properties(test_gradient_pinocchio PROPERTIES TIMEOUT ${HANGS} SKIP_RETURN_CODE 77)
