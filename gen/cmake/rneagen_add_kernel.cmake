# rneagen_add_kernel(<target> <robot.urdf>
#	[TARGET cuda|c|header]          default: cuda where the project has the language CUDA, else c
#	[NAME <name>]                   prefix of every function; default: the name of the file, made an identifier
#	[PRECISION f32|f64|mixed|f32x2] [LAYOUT soa|aos] [TRIG accurate|bounded|fast] [BASE fixed|floating]
#	[MIMIC honour|independent] [GRAVITY X,Y,Z] [ORDER J1,J2,...]
#	[SCENE <line>...]               what of the robot is modelled: each a line of a scene, "want gravity", "lock elbow=1.57"
#	[OPTIONS <word>...])            further words for the command `rneagen`; files of --scene and --armature are relative to this
#	                                CMakeLists.txt
#
# Generates the inverse dynamics of the robot when <target> is built, compiles the text into <target> with nvcc or the
# C compiler, and puts "<name>_rnea.h", which declares its functions (TARGET header: defines them), on the include path.
# The text is made again when the URDF, a file that OPTIONS name, or the generator changes. <target> is to be made in the same CMakeLists.txt. Where the project
# chooses no build type, and no -O, a C text is compiled with -O2: without it calls take eight times as long.
include_guard(GLOBAL)

function(rneagen_add_kernel target urdf)
	set(choices NAME PRECISION LAYOUT TRIG BASE MIMIC GRAVITY ORDER)
	cmake_parse_arguments(PARSE_ARGV 2 arg "" "TARGET;${choices}" "SCENE;OPTIONS")
	if(arg_UNPARSED_ARGUMENTS OR arg_KEYWORDS_MISSING_VALUES)
		list(JOIN arg_UNPARSED_ARGUMENTS " " words)
		string(STRIP "${words} ${arg_KEYWORDS_MISSING_VALUES}" words)
		list(JOIN choices " " known)
		message(FATAL_ERROR
			"rneagen_add_kernel(${target}): not understood: ${words}; "
			"keywords are TARGET ${known} SCENE OPTIONS; what a scene says is a line of SCENE, \"want M\"")
	endif()
	rneagen_check_target(${target})
	rneagen_choose_language("${arg_TARGET}" arg_TARGET)

	if(NOT arg_NAME)
		cmake_path(GET urdf STEM arg_NAME)
		string(MAKE_C_IDENTIFIER "${arg_NAME}" arg_NAME)
		string(REGEX REPLACE "^_+" "robot_" arg_NAME "${arg_NAME}") # such names are a compiler's
	endif()
	set(words --target ${arg_TARGET})
	foreach(choice IN LISTS choices)
		if(DEFINED arg_${choice})
			string(TOLOWER ${choice} option)
			list(APPEND words --${option} "${arg_${choice}}")
		endif()
	endforeach()
	set(scene "")
	if(arg_SCENE)
		set(scene ${CMAKE_CURRENT_BINARY_DIR}/rneagen/${target}/${arg_NAME}.scene)
		rneagen_write_scene(${scene} ${arg_SCENE})
		list(APPEND words --scene ${scene})
	endif()
	rneagen_check_name(${target} ${arg_NAME})
	rneagen_find_files(${target} arg_OPTIONS files)
	rneagen_generate(${target} "${urdf}" ${arg_TARGET} ${arg_NAME} "${scene};${files}" ${words} ${arg_OPTIONS})
endfunction()

# Of the options in a variable, those that name files: with whole paths, which a text depends on.
function(rneagen_find_files target options files)
	set(found)
	set(words)
	set(before)
	foreach(word IN LISTS ${options})
		if(word MATCHES "^(-o|--output)")
			message(FATAL_ERROR "rneagen_add_kernel(${target}): '${word}': where the text goes is not chosen by OPTIONS")
		endif()
		if(word MATCHES "^--(name|target)")
			string(TOUPPER ${CMAKE_MATCH_1} keyword)
			message(FATAL_ERROR "rneagen_add_kernel(${target}): '${word}' within OPTIONS: write ${keyword} and its word instead")
		endif()
		if(word MATCHES "^--(help|version|dump)")
			message(FATAL_ERROR "rneagen_add_kernel(${target}): '${word}' within OPTIONS is of the command line, and makes no text")
		endif()
		if(word MATCHES "^(--scene|--armature)=(.+)$")
			set(before ${CMAKE_MATCH_1})
			set(word ${CMAKE_MATCH_2})
			list(APPEND words ${before})
		endif()
		if(before MATCHES "^--scene$" OR (before MATCHES "^--armature$" AND NOT word MATCHES "="))
			cmake_path(ABSOLUTE_PATH word)
			list(APPEND found ${word})
		endif()
		list(APPEND words ${word})
		set(before ${word})
	endforeach()
	set(${options} ${words} PARENT_SCOPE)
	set(${files} ${found} PARENT_SCOPE)
endfunction()

# Two texts of one target are two files, and their functions have two prefixes.
function(rneagen_check_name target name)
	get_property(names TARGET ${target} PROPERTY RNEAGEN_NAMES)
	if(name IN_LIST names)
		message(FATAL_ERROR "rneagen_add_kernel(${target}): it has a text named '${name}' already: give this one another NAME")
	endif()
	set_property(TARGET ${target} APPEND PROPERTY RNEAGEN_NAMES ${name})
endfunction()

# A text is slow where nothing is optimised, and a project that says nothing did not ask for that.
function(rneagen_optimise source)
	if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang" AND NOT CMAKE_C_FLAGS MATCHES "-O")
		set_property(SOURCE ${source} APPEND PROPERTY COMPILE_OPTIONS $<$<CONFIG:>:-O2>)
	endif()
endfunction()

# A file that is written only when its lines change, so that what depends on it is not made again for nothing.
function(rneagen_write_scene file)
	list(JOIN ARGN "\n" lines)
	set(before)
	if(EXISTS ${file})
		file(READ ${file} before)
	endif()
	if(NOT before STREQUAL "${lines}\n")
		file(WRITE ${file} "${lines}\n")
	endif()
endfunction()

# A rule that makes a file is known to its own directory alone.
function(rneagen_check_target target)
	if(NOT TARGET ${target})
		message(FATAL_ERROR "rneagen_add_kernel: there is no target '${target}'")
	endif()
	get_target_property(type ${target} TYPE)
	if(type STREQUAL "INTERFACE_LIBRARY")
		message(FATAL_ERROR "rneagen_add_kernel: target '${target}' is an INTERFACE library, which compiles nothing: "
			"name the target that compiles the text")
	endif()
	get_target_property(directory ${target} SOURCE_DIR)
	if(NOT directory STREQUAL CMAKE_CURRENT_SOURCE_DIR)
		message(FATAL_ERROR "rneagen_add_kernel: target '${target}' is made elsewhere, in ${directory}")
	endif()
	if(NOT TARGET rneagen::command)
		message(FATAL_ERROR "rneagen_add_kernel: this rneagen was installed without its generator")
	endif()
endfunction()

function(rneagen_choose_language word result)
	get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
	if(NOT word)
		set(word c)
		if("CUDA" IN_LIST languages)
			set(word cuda)
		endif()
		message(STATUS "rneagen_add_kernel: TARGET ${word}, since none is named and the project has the language ${word}")
	endif()
	if(NOT word MATCHES "^(cuda|c|header)$")
		message(FATAL_ERROR "rneagen_add_kernel: TARGET is cuda, c or header, not '${word}'")
	endif()
	string(TOUPPER ${word} language)
	if(NOT word STREQUAL "header" AND NOT language IN_LIST languages)
		message(FATAL_ERROR "rneagen_add_kernel: TARGET ${word} needs the language ${language}: "
			"name it in project() or call enable_language(${language})")
	endif()
	set(${result} ${word} PARENT_SCOPE)
endfunction()

function(rneagen_generate target urdf kind name files)
	set(directory ${CMAKE_CURRENT_BINARY_DIR}/rneagen/${target})
	set(header ${directory}/${name}_rnea.h)
	set(source_cuda ${directory}/${name}_rnea.cu)
	set(source_c ${directory}/${name}_rnea.c)
	set(source_header ${header})
	set(source ${source_${kind}})
	set(outputs ${source} ${header})
	list(REMOVE_DUPLICATES outputs)
	set(declare)
	if(kind STREQUAL "cuda")
		set(declare COMMAND ${CMAKE_COMMAND} -D SOURCE=${source} -D HEADER=${header} -P
			${CMAKE_CURRENT_FUNCTION_LIST_DIR}/rneagen_declare.cmake)
	endif()
	cmake_path(ABSOLUTE_PATH urdf)
	file(MAKE_DIRECTORY ${directory})
	add_custom_command(OUTPUT ${outputs}
		COMMAND rneagen::command ${urdf} -o ${source} ${ARGN}
		${declare}
		DEPENDS ${urdf} ${files} $<TARGET_FILE:rneagen::command>
		COMMENT "rneagen: ${name}_rnea" VERBATIM)
	if(kind STREQUAL "c")
		rneagen_optimise(${source})
	endif()
	target_sources(${target} PRIVATE ${outputs})
	target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${directory}>)
	# by property: target_link_libraries() would impose its plain or keyword form on the caller
	if(UNIX)
		set_property(TARGET ${target} APPEND PROPERTY LINK_LIBRARIES m)
		set_property(TARGET ${target} APPEND PROPERTY INTERFACE_LINK_LIBRARIES $<LINK_ONLY:m>)
	endif()
endfunction()
