#!/usr/bin/env bash
# Builds the example rollout and runs it: on the GPU, or on the host where there is no nvcc or no GPU, which it then says.
# usage: examples/rollout/rollout.sh [OPTION...]     options: examples/rollout/rollout.sh --help
set -euo pipefail
from=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=/dev/null
source tests/setup.sh

rm -f build/setup.log
setup_require >&2
setup_step "configuring: cmake --preset default" cmake --preset default >&2 || exit 1
target=rollout
grep -q '^CMAKE_CUDA_COMPILER:.*/' build/CMakeCache.txt || target=rollout_host
setup_step "building, a minute or two: cmake --build --preset default --target $target" cmake --build --preset default --target "$target" >&2 || exit 1
program=$PWD/build/examples/$target
cd "$from"
"$program" "$@"
