#!/usr/bin/env bash
# example_contact.sh CONTACT SOURCE ROBOT.urdf: the feet carry the weight, which is that of the URDF's masses; a stance on
# three feet tips over and another does not.
set -euo pipefail
contact=$1 source=$2 urdf=$3

fail() {
	echo "example_contact: $*" >&2
	exit 1
}

mass=$(sed -n 's/.*<mass value="\(.*\)".*/\1/p' "$urdf" | awk '{ sum += $1 } END { printf "%.9g", sum }')
grep -qF "WEIGHT = $mass * 9.81" "$source" || fail "the weight of $source is not $mass * 9.81, that of $urdf"
out=$("$contact") || { printf '%s\n' "$out"; fail "the forces are not those of a robot that stands"; }
printf '%s\n' "$out"
[[ $(grep -c 'tips over$' <<<"$out") == 1 ]] || fail "not one stance of those tips over"
