#!/usr/bin/env bash
# example_ik.sh IK STRICT SOURCE TEXTS CLANG++ MAP.dat: nearly all goals are reached in few steps, in both precisions, within 1 mm,
# 0.01 rad and the limits of the joints, which the program itself compares in f64; 1 and 4 threads, and another compiler (CLANG++, if
# not empty), give the same bits of every angle; the map has reach before the arm and none beyond it.
set -euo pipefail
# shellcheck source=/dev/null
source "$(dirname "${BASH_SOURCE[0]}")/same_bits.sh"
ik=$1 strict=$2 source=$3 texts=$4 clang=$5 map=$6

# hash PROGRAM OPTION...: over all angles and steps of a few searches
hash() {
	"$1" --cpu --csv --targets 300 "${@:2}" | cut -d, -f14
}

# a step that is no step of least squares, or a Jacobian of another frame, takes ten times as many
for precision in f32 f64; do
	said=$("$ik" --cpu --csv --targets 4000 --precision "$precision") || fail "$said"
	printf '%s\n' "$said"
	awk -F, '{ exit !($3 >= 0.999 * $2 && $4 > 5 && $4 < 40) }' <<<"$said" || fail "$precision: $said: too few are reached, or by too many steps"
done

"$ik" --cpu --map "$map" --cells 10 --rotations 6 --tries 20 || fail "no map"
awk 'NF == 3 && $1 * $1 + ($2 - 0.333) ^ 2 > 1.3 { far += $3 } NF == 3 { cells++; all += $3 }
	END { exit !(cells == 100 && far == 0 && all > 15 && all < 70) }' "$map" || fail "$map is no map of an arm"

other=
if [ -n "$clang" ]; then
	folder=$(mktemp -d)
	trap 'rm -rf "$folder"' EXIT
	other=$folder/other
	"$clang" -std=c++17 -O1 -ffp-contract=off -I "$texts" "$source"/ik{,_host}.cpp -o "$other"
else
	echo "skipped: another compiler: there is no clang++"
fi
same_bits "$strict" "$other" "--precision f32" "--precision f64"
refused "$ik" "--targets 0" "--tries x" "--precision f16" "--cells -1" "--map" "more"
