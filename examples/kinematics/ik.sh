#!/usr/bin/env bash
# Builds the example ik and runs it: on the GPU, or on the host where there is no nvcc or no GPU, which it then says.
# usage: examples/kinematics/ik.sh [OPTION...]     options: examples/kinematics/ik.sh --help
exec "$(dirname "${BASH_SOURCE[0]}")/../build_and_run.sh" ik kinematics "$@"
