#!/usr/bin/env bash
# Builds the example ik and runs it: on the GPU, or on the host where there is no nvcc or no GPU, which it then says.
# usage: examples/kinematics/ik.sh [OPTION...]     options: examples/kinematics/ik.sh --help
set -euo pipefail
from=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=/dev/null
source tests/setup.sh

rm -f build/setup.log
setup_require >&2
setup_step "configuring: cmake --preset default" cmake --preset default >&2 || exit 1
target=ik
grep -q '^CMAKE_CUDA_COMPILER:.*/' build/CMakeCache.txt || target=ik_host
setup_step "building: cmake --build --preset default --target $target" cmake --build --preset default --target "$target" >&2 || exit 1
program=$PWD/build/examples/kinematics/$target
cd "$from"
"$program" "$@"
