#!/usr/bin/env bash
# outside_project.sh SOURCE BUILD WORK [NVCC]: installs BUILD below WORK, moves what was installed, and builds the projects
# of tests/outside against it: by the CMake package and by pkg-config, in C and in C++, with nvcc if it is named.
set -euo pipefail
source=$1 build=$2 work=$3 nvcc=${4-}
export CFLAGS="-std=c11 -O1 -Wall -Wextra -Wconversion -Werror ${SANITIZE-}"
export CXXFLAGS="-std=c++17 -O1 -Wall -Wextra -Wconversion -Werror ${SANITIZE-}" LDFLAGS=${SANITIZE-}
prefix=$work/moved outside=$work/tests/outside
components="COMPONENTS;command"
unset CMAKE_PREFIX_PATH rneagen_DIR

fail() {
	echo "outside_project: $*" >&2
	exit 1
}

# project SOURCE NAME [OPTION...]: configure, build and test against the installed package.
project() {
	local from=$1 name=$2

	shift 2
	if ! { cmake -S "$from" -B "$work/$name" -D CMAKE_PREFIX_PATH="$prefix" "$@" &&
		cmake --build "$work/$name"; } >"$work/$name.log" 2>&1; then
		cat "$work/$name.log"
		fail "$name does not build"
	fi
	ctest --test-dir "$work/$name" --output-on-failure
}

# refused MESSAGE CALL: the use of rneagen_add_kernel fails and says why.
refused() {
	local log=$work/bad.log

	rm -rf "$work/bad"
	if cmake -S "$outside/bad" -B "$work/bad" -D CMAKE_PREFIX_PATH="$prefix" -D COMPONENTS="$components" -D CALL="$2" >"$log" 2>&1; then
		fail "not refused: $2"
	fi
	tr -s '[:space:]' ' ' <"$log" | grep -qF -- "$1" || { cat "$log"; fail "wrong message for: $2"; }
}

install_moved() {
	rm -rf "$work/installed" "$prefix"
	cmake --install "$1" --prefix "$work/installed" >/dev/null
	mv "$work/installed" "$prefix"
	[[ -s $prefix/share/doc/rneagen/LICENSE ]] || fail "no LICENSE"
	PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name rnea.pc)")
	export PKG_CONFIG_PATH
}

by_pkg_config() {
	local command flags

	command=$(pkg-config --variable=command rneagen)
	[[ $("$command" --version) == "rneagen $(pkg-config --modversion rneagen)" ]] || fail "versions differ"
	[[ $("${command%rneagen}rnearun" --version) == "rnearun $(pkg-config --modversion rneagen)" ]] || fail "versions differ"
	[[ $(pkg-config --modversion rneagen) == $(pkg-config --modversion rnea) ]] || fail "versions differ"
	mkdir -p "$work/pc"
	cd "$work/pc"
	"$command" "$work/tests/robots/pendulum.urdf" -o pendulum_rnea.c
	read -ra flags <<<"$(pkg-config --cflags --libs rneagen rnea)"
	# shellcheck disable=SC2086 # flags are words
	{
		${CC:-cc} $CFLAGS -I. "$outside/kernel.c" pendulum_rnea.c -lm -o kernel_c
		${CC:-cc} $CFLAGS -c pendulum_rnea.c
		${CXX:-c++} $CXXFLAGS -I. "$outside/kernel.cpp" pendulum_rnea.o -o kernel_cxx
		${CC:-cc} $CFLAGS "$outside/library.c" "${flags[@]}" -o library_c
		${CXX:-c++} $CXXFLAGS "$outside/library.cpp" "${flags[@]}" -o library_cxx
		read -ra flags <<<"$(pkg-config --cflags --libs rnea_urdf)"
		${CC:-cc} $CFLAGS "$outside/open_urdf.c" "${flags[@]}" -o open_urdf
	}
	./kernel_c && ./kernel_cxx
	# -lrnea is the shared library, in a folder that the loader does not know
	LD_LIBRARY_PATH=$(pkg-config --variable=libdir rnea)
	export LD_LIBRARY_PATH
	[[ $(ldd ./library_c) == *"$LD_LIBRARY_PATH/librnea.so."* ]] || fail "not linked with librnea.so"
	./library_c "$work/tests/robots/pendulum.urdf" && ./library_cxx "$work/tests/robots/pendulum.urdf"
	./open_urdf "$work/tests/robots/pendulum.urdf"
	unset LD_LIBRARY_PATH
}

# Another rotor, in a file that an option names, has other torques.
follows_its_files() {
	"$work/c/kernel_files" || fail "a file that an option names is not read"
	sed -i 's/0.06/0.5/' "$outside/rotors.txt"
	cmake --build "$work/c" >/dev/null
	! "$work/c/kernel_files" || fail "the rotors changed and the torques did not"
}

# A heavier pendulum has other torques, and nothing else is made again.
follows_the_urdf() {
	local urdf=$work/tests/robots/pendulum.urdf

	touch "$work/before"
	cmake --build "$work/c" >/dev/null
	[[ ! $work/c/kernel_c -nt $work/before ]] || fail "made again without cause"
	sed -i 's/<mass value="2"/<mass value="3"/' "$urdf"
	cmake --build "$work/c" >/dev/null
	! "$work/c/kernel_c" || fail "the URDF changed and its torques did not"
}

mkdir -p "$work/tests/robots"
rm -rf "$outside" "$work"/{c,cxx,bad,runtime,pc}
cp -r "$source/tests/outside" "$work/tests/"
cp "$source/tests/robots/pendulum.urdf" "$work/tests/robots/"

install_moved "$build"
project "$outside" c
project "$outside" cxx -D OUTSIDE_CXX=ON -D CMAKE_CUDA_COMPILER="$nvcc"
by_pkg_config
follows_its_files
follows_the_urdf
refused "there is no target 'none'" 'rneagen_add_kernel(none a.urdf)'
refused "target 'theirs' is made elsewhere" 'rneagen_add_kernel(theirs a.urdf)'
refused "not understood: PRECISON f32; keywords are TARGET NAME PRECISION" 'rneagen_add_kernel(mine a.urdf PRECISON f32)'
refused "it has a text named 'a' already: give this one another NAME" $'enable_language(C)
	add_library(two STATIC)
	rneagen_add_kernel(two a.urdf)
	rneagen_add_kernel(two a.urdf SCENE "want M")'
refused "target 'interface' is an INTERFACE library" 'rneagen_add_kernel(interface a.urdf TARGET header)'
refused "'--name=x' within OPTIONS: write NAME" 'rneagen_add_kernel(mine a.urdf TARGET header OPTIONS --name=x)'
refused "'--dump' within OPTIONS is of the command line" 'rneagen_add_kernel(mine a.urdf TARGET header OPTIONS --dump dag)'
refused "TARGET is cuda, c or header, not 'rust'" 'rneagen_add_kernel(mine a.urdf TARGET rust)'
refused "TARGET cuda needs the language CUDA" 'rneagen_add_kernel(mine a.urdf TARGET cuda)'
refused "TARGET c needs the language C" 'rneagen_add_kernel(mine a.urdf)'
refused "where the text goes is not chosen by OPTIONS" 'enable_language(C)
	rneagen_add_kernel(mine a.urdf OPTIONS -o a.c)'

cmake -S "$source" -B "$work/build" -D RNEAGEN_GENERATOR=OFF -D RNEAGEN_TESTS=OFF >/dev/null
cmake --build "$work/build" >/dev/null
install_moved "$work/build"
[[ ! -e $prefix/bin/rneagen ]] || fail "a generator was installed that was not to be built"
project "$outside/runtime" runtime
components=
refused "this rneagen was installed without its generator" 'rneagen_add_kernel(mine a.urdf)'
[[ -n $nvcc ]] || echo "skipped: the CUDA target, for there is no nvcc"
