#!/usr/bin/env bash
# example_rollout.sh ROLLOUT STRICT SOURCE TEXTS CLANG++ TRACE.csv: the arm comes to its goal and stays with it, in both
# precisions and by both integrators; 1 and 4 threads, and another compiler (CLANG++, if not empty) with other options, give
# the same bits of every cost. The program itself checks Philox's known answers, the joints' limits and the integrators' orders.
set -euo pipefail
# shellcheck source=/dev/null
source "$(dirname "${BASH_SOURCE[0]}")/same_bits.sh"
rollout=$1 strict=$2 source=$3 texts=$4 clang=$5 trace=$6

# below VALUE LIMIT WHAT
below() {
	awk -v value="$1" -v limit="$2" 'BEGIN { exit !(value != "" && value + 0 < limit) }' || fail "$3: ${1:-none}, not below $2"
}

# hash PROGRAM OPTION...: over all costs and speeds of a short run
hash() {
	"$1" --cpu --csv --rollouts 24 --seconds 0.1 "${@:2}" | cut -d, -f11
}

# a controller whose plan is not moved, or not by the cheapest, ends 0.9 rad away
said=$("$rollout" --cpu --rollouts 256 --seconds 2 --trace "$trace") || fail "$said"
printf '%s\n' "$said"
below "$(sed -n 's/.* \([0-9.]*\) in the last second/\1/p' <<<"$said")" 0.12 "distance from the goal"
[ "$(grep -vc '^#' "$trace")" = 201 ] || fail "$trace does not have a line for each tick"
said=$("$rollout" --cpu --csv --rollouts 128 --seconds 1 --integrator rk4 --precision f64) || fail "$said"
below "$(cut -d, -f10 <<<"$said")" 0.4 "distance from the goal in the first second, f64"

other=
if [ -n "$clang" ]; then
	folder=$(mktemp -d)
	trap 'rm -rf "$folder"' EXIT
	other=$folder/other
	"$clang" -std=c++17 -O3 -march=native -ffp-contract=off -I "$texts" "$source"/rollout{,_host}.cpp -o "$other"
else
	echo "skipped: another compiler: there is no clang++"
fi
same_bits "$strict" "$other" "--integrator euler --precision f32" "--integrator rk4 --precision f64"
refused "$rollout" "--rollouts 0" "--steps x" "--integrator heun" "--precision f16" "--seconds -1" "--trace" "more"
