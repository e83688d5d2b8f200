# The runtime library, with a pretended driver and a pretended NVRTC where there is no GPU.
find_package(Threads REQUIRED)
add_library(fake_cuda SHARED fake_cuda.c fake_cuda_memory.c fake_cuda_stream.c)
target_link_libraries(fake_cuda PRIVATE ${CMAKE_DL_LIBS} Threads::Threads)
add_library(fake_nvrtc SHARED fake_nvrtc.c)
target_compile_definitions(fake_nvrtc PRIVATE FAKE_CXX="${CMAKE_CXX_COMPILER}"
	FAKE_HEADER="${CMAKE_CURRENT_SOURCE_DIR}/fake_device.h")
# the same, under the name by which a process knows that it has NVRTC already
add_library(fake_nvrtc_12 SHARED fake_nvrtc.c)
target_compile_definitions(fake_nvrtc_12 PRIVATE FAKE_CXX="${CMAKE_CXX_COMPILER}"
	FAKE_HEADER="${CMAKE_CURRENT_SOURCE_DIR}/fake_device.h")
set_target_properties(fake_nvrtc_12 PROPERTIES NO_SONAME ON)
target_link_options(fake_nvrtc_12 PRIVATE -Wl,-soname,libnvrtc.so.12)

add_executable(test_runtime test_runtime.c test_runtime_backend.c test_runtime_batch.c test_runtime_choose.c
	test_runtime_hits.c test_runtime_info.c test_runtime_jit.c test_runtime_launch.c test_runtime_nvrtc.c
	test_runtime_open.c test_runtime_run.c test_runtime_threads.c)
add_dependencies(test_runtime fake_cuda fake_nvrtc fake_nvrtc_12)
target_link_libraries(test_runtime PRIVATE rnea::rnea PkgConfig::CHECK Threads::Threads ${CMAKE_DL_LIBS} m)
target_link_options(test_runtime PRIVATE -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc)
target_compile_definitions(test_runtime PRIVATE TEST_DIR="${CMAKE_CURRENT_SOURCE_DIR}"
	FAKE_CUDA="$<TARGET_FILE:fake_cuda>" FAKE_NVRTC="$<TARGET_FILE:fake_nvrtc>"
	FAKE_NVRTC_12="$<TARGET_FILE:fake_nvrtc_12>")
add_test(NAME test_runtime COMMAND test_runtime)

add_executable(test_runtime_cache test_runtime_cache.c test_runtime_cache_entry.c test_runtime_cache_fault.c
	test_runtime_cache_folder.c test_runtime_cache_race.c)
target_link_libraries(test_runtime_cache PRIVATE rnea::rnea PkgConfig::CHECK Threads::Threads)
target_link_options(test_runtime_cache PRIVATE
	-Wl,--wrap=malloc,--wrap=realloc,--wrap=write,--wrap=read,--wrap=close,--wrap=renameat,--wrap=openat
	-Wl,--wrap=clock_gettime)
add_test(NAME test_runtime_cache COMMAND test_runtime_cache)

# The host backend, with the machine's own C compiler.
add_executable(test_runtime_host test_runtime_host.c test_runtime_host_compiler.c test_runtime_host_load.c
	test_runtime_host_names.c test_runtime_host_run.c test_runtime_host_texts.c test_runtime_workers.c)
target_link_libraries(test_runtime_host PRIVATE reference rnea::rnea PkgConfig::CHECK Threads::Threads ${CMAKE_DL_LIBS} m)
target_link_options(test_runtime_host PRIVATE
	-Wl,--wrap=malloc,--wrap=calloc,--wrap=memfd_create,--wrap=mkdtemp,--wrap=cache_get
	-Wl,--wrap=pthread_create,--wrap=pthread_join)
target_compile_definitions(test_runtime_host PRIVATE TEST_DIR="${CMAKE_CURRENT_SOURCE_DIR}")
add_test(NAME test_runtime_host COMMAND test_runtime_host)

# From a URDF in one call, against the reference.
if(TARGET rnea::urdf)
	foreach(test IN ITEMS test_runtime_urdf test_runtime_task)
		add_executable(${test} ${test}.c)
		add_dependencies(${test} fake_cuda fake_nvrtc)
		target_link_libraries(${test} PRIVATE rnea::urdf reference PkgConfig::CHECK m)
		target_compile_definitions(${test} PRIVATE TEST_DIR="${CMAKE_CURRENT_SOURCE_DIR}"
			FAKE_CUDA="$<TARGET_FILE:fake_cuda>" FAKE_NVRTC="$<TARGET_FILE:fake_nvrtc>")
		add_test(NAME ${test} COMMAND ${test})
	endforeach()
endif()

# What runs on a GPU, with small batches on the pretended one.
add_subdirectory(gpu)
if(TARGET gpu_check)
	add_test(NAME gpu_emulated COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/gpu/emulated $<TARGET_FILE:gpu_check>
		${CMAKE_CURRENT_BINARY_DIR}/gpu_texts)
	set_tests_properties(gpu_emulated PROPERTIES ENVIRONMENT "RNEAGEN=$<TARGET_FILE:rneagen-command>;\
RNEA_REFERENCE=$<TARGET_FILE:rnea_reference>;RNEARUN=$<TARGET_FILE:rnearun>;RNEA_LIBCUDA=$<TARGET_FILE:fake_cuda>;RNEA_NVRTC=$<TARGET_FILE:fake_nvrtc>")
endif()
add_test(NAME shared_symbols COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/shared_symbols $<TARGET_FILE:rnea_shared> $<TARGET_FILE:rnea>
	${PROJECT_SOURCE_DIR}/runtime/rnea.h ${CMAKE_C_COMPILER})
