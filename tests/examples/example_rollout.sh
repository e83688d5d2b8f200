#!/usr/bin/env bash
# example_rollout.sh ROLLOUT STRICT SOURCE TEXTS CLANG++ TRACE.csv: the arm comes to its goal and stays with it, in both
# precisions and by both integrators; 1 and 4 threads, and another compiler (CLANG++, if not empty) with other options, give
# the same bits of every cost. The program itself checks Philox's known answers, the joints' limits and the integrators' orders.
set -euo pipefail
export OMP_WAIT_POLICY=passive # not to spin on a machine that is busy
rollout=$1 strict=$2 source=$3 texts=$4 clang=$5 trace=$6

fail() {
	echo "example_rollout: $*" >&2
	exit 1
}

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

if [ -n "$clang" ]; then
	folder=$(mktemp -d)
	trap 'rm -rf "$folder"' EXIT
	"$clang" -std=c++17 -O3 -march=native -ffp-contract=off -I "$texts" "$source"/rollout{,_host}.cpp -o "$folder/other"
else
	echo "skipped: another compiler: there is no clang++"
fi
for options in "--integrator euler --precision f32" "--integrator rk4 --precision f64"; do
	read -ra words <<<"$options"
	one=$(OMP_NUM_THREADS=1 hash "$strict" "${words[@]}")
	echo "$options: $one"
	[ "$one" = "$(OMP_NUM_THREADS=4 hash "$strict" "${words[@]}")" ] || fail "$options: 4 threads have other bits than 1"
	[ "$one" != "$(hash "$strict" "${words[@]}" --seed 2)" ] || fail "$options: another seed has the same bits"
	[ -z "$clang" ] || [ "$one" = "$(hash "$folder/other" "${words[@]}")" ] || fail "$options: $clang has other bits"
done

"$rollout" --help | grep -q "exit status" || fail "--help does not help"
for options in "--rollouts 0" "--steps x" "--integrator heun" "--precision f16" "--seconds -1" "--trace" "more"; do
	read -ra words <<<"$options"
	status=0
	"$rollout" "${words[@]}" >/dev/null 2>&1 || status=$?
	[ "$status" = 2 ] || fail "$options: exit status $status, not 2"
done
