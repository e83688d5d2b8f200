#!/usr/bin/env bash
# build_and_run.sh TARGET FOLDER [OPTION...]: builds an example, and runs what is then in a folder of build/examples, from here: with
# kernels, or TARGET_host where there is no nvcc. The program itself goes to the host where there is no GPU, and says so.
set -euo pipefail
target=$1 folder=$2 from=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=/dev/null
source tests/setup.sh

rm -f build/setup.log
setup_require >&2
setup_step "configuring: cmake --preset default" cmake --preset default >&2 || exit 1
grep -q '^CMAKE_CUDA_COMPILER:.*/' build/CMakeCache.txt || target=${target}_host
setup_step "building, a minute or two: cmake --build --preset default --target $target" cmake --build --preset default --target "$target" >&2 || exit 1
program=$PWD/build/examples/$folder/$target
cd "$from"
exec "$program" "${@:3}"
