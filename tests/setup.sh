# Sourced by examples/quickstart and tests/run: installs what a build needs, and builds.
# shellcheck shell=bash

# Packages of Debian 12 and Ubuntu 24.04, each with the command that tells whether what it brings is there.
setup_list() {
	cat <<-'END'
		build gcc command -v cc
		build g++ command -v c++
		build cmake command -v cmake
		build ninja-build command -v ninja
		build pkg-config command -v pkg-config
		build liburdfdom-dev pkg-config --exists urdfdom urdfdom_headers
		build libconsole-bridge-dev pkg-config --exists console_bridge
		build libexpat1-dev pkg-config --exists expat
		build libmd-dev pkg-config --exists libmd
		build check pkg-config --exists check
		tests clang command -v clang
		tests libclang-rt-dev setup_clang_runtime
		tests gcc-aarch64-linux-gnu command -v aarch64-linux-gnu-gcc
		tests libc6-dev-arm64-cross test -e /usr/aarch64-linux-gnu/include/stdio.h
		tests qemu-user command -v qemu-aarch64
		tests libmpfr-dev pkg-config --exists mpfr
		tests graphviz command -v dot
		tests gnuplot-nox command -v gnuplot
		tests locales test -e /usr/share/i18n/locales/de_DE
		tests mandoc command -v mandoc
		tests libjansson-dev pkg-config --exists jansson
		tests libopenmpi-dev command -v mpicc
		tests openmpi-bin command -v mpirun
		tests python3-numpy setup_numpy
		tests python3-dev setup_python_headers
	END
}

# clang's sanitizers and fuzzer
setup_clang_runtime() {
	compgen -G "$(clang -print-resource-dir)/lib/*/libclang_rt.fuzzer*"
}

setup_installed() {
	[[ $(dpkg-query -W -f '${db:Status-Status}' "$1") == installed ]]
}

setup_numpy() {
	python3 -c 'import numpy'
}

setup_python_headers() {
	python3 -c 'import os, sysconfig; os.stat(sysconfig.get_path("include") + "/Python.h")'
}

# setup_missing build|tests: prints the packages that are missing.
setup_missing() {
	local purpose package probe

	while read -r purpose package probe; do
		if [[ $purpose == "$1" ]] && ! $probe && ! setup_installed "$package"; then
			echo "$package" >&3
		fi
	done < <(setup_list) 3>&1 &>/dev/null
}

# setup_step TEXT COMMAND...: a line; what the command says goes to a log, which is named where it fails.
setup_step() {
	local log=$PWD/build/setup.log text=$1

	shift
	mkdir -p build
	echo "$text"
	printf '\n== %s: %s\n' "$text" "$*" >>"$log"
	if ! "$@" </dev/null >>"$log" 2>&1; then
		echo "failed: $*; the end of $log:" >&2
		tail -n 15 "$log" >&2
		return 1
	fi
}

# setup_install PACKAGE...: says why where it cannot.
setup_install() {
	local sudo=()

	if ! command -v apt-get >/dev/null; then
		echo "missing, and there is no apt-get to install it with: $*" >&2
		return 1
	fi
	if ((EUID != 0)); then
		if ! command -v sudo >/dev/null; then
			echo "missing; to be installed by root with: apt-get install $*" >&2
			return 1
		fi
		sudo=(sudo)
	fi
	setup_step "asking apt for its lists" "${sudo[@]}" apt-get -q update &&
		setup_step "installing: $*" "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends "$@"
}

# What every build needs; the script ends where it cannot be had.
setup_require() {
	local missing

	mapfile -t missing < <(setup_missing build)
	if ((${#missing[@]})); then
		setup_install "${missing[@]}" || exit 1
	fi
}

# What some tests need; they are skipped where it cannot be had.
setup_want() {
	local missing

	mapfile -t missing < <(setup_missing tests)
	if ((${#missing[@]})) && ! setup_install "${missing[@]}"; then
		echo "going on; tests that need these are skipped: ${missing[*]}"
	fi
}

# setup_build PRESET [OPTION...]: configures and builds.
setup_build() {
	local preset=$1 quiet=()

	shift
	[[ -t 1 ]] || quiet=(-- --quiet)
	echo "building: cmake --preset $preset && cmake --build --preset $preset${*:+ $*}"
	cmake --preset "$preset" >/dev/null &&
		cmake --build --preset "$preset" "$@" "${quiet[@]}"
}
