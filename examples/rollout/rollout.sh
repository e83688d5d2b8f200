#!/usr/bin/env bash
# Builds the example rollout and runs it: on the GPU, or on the host where there is no nvcc or no GPU, which it then says.
# usage: examples/rollout/rollout.sh [OPTION...]     options: examples/rollout/rollout.sh --help
exec "$(dirname "${BASH_SOURCE[0]}")/../build_and_run.sh" rollout rollout "$@"
