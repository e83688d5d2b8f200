# Projects outside this one, against an installed copy.
include(CheckLanguage)
check_language(CUDA)
add_test(NAME outside_project COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/outside_project.sh ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}
	${CMAKE_CURRENT_BINARY_DIR}/outside "$<$<BOOL:${CMAKE_CUDA_COMPILER}>:${CMAKE_CUDA_COMPILER}>")
set(outside_environment "CC=${CMAKE_C_COMPILER}" "CXX=${CMAKE_CXX_COMPILER}" "CMAKE_GENERATOR=${CMAKE_GENERATOR}")
if(RNEAGEN_SANITIZE)
	list(APPEND outside_environment "SANITIZE=-fsanitize=address,undefined -fno-sanitize-recover=all")
endif()
set_tests_properties(outside_project PROPERTIES ENVIRONMENT "${outside_environment}" TIMEOUT ${HANGS})
