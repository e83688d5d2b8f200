#!/usr/bin/env bash
# example_trajectories.sh TRAJECTORIES HEADER ROBOT.urdf TEXT.cu CURVE.csv OTHER.cu: the costs fall and the derivatives
# are right, which the program sees itself; the limits of HEADER are the URDF's; OTHER, without derivatives, is refused.
set -euo pipefail
trajectories=$1 header=$2 urdf=$3 text=$4 curve=$5 other=$6

fail() {
	echo "example_trajectories: $*" >&2
	exit 1
}

# limits ATTRIBUTE MACRO
limits() {
	local has wants

	wants=$(sed -n "s/.*<limit .*$1=\"\([^\"]*\)\".*/\1/p" "$urdf" | paste -sd' ')
	has=$(sed -e ':join; /\\$/ { N; s/\\\n//; b join; }' "$header" | sed -n "s/^#define $2\b//p" | tr -d ',' | xargs)
	[ "$(wc -w <<<"$wants")" = 7 ] || fail "$urdf does not have seven limits '$1'"
	[ "$has" = "$wants" ] || fail "$2 of $header is '$has', $1 of $urdf '$wants'"
}

limits effort EFFORTS
limits upper ANGLES
limits velocity SPEEDS
"$trajectories" "$text" 16 "$curve" || fail "a cost does not fall, or a number is wrong"
awk -F, '/^#/ { next } !lines++ { bad = $2 != "mean"; next } lines > 2 { bad = bad || $2 > last } { last = $2 }
	END { exit bad || lines < 20 }' "$curve" ||
	fail "the mean cost of $curve does not fall"
! said=$("$trajectories" "$other" 2>&1) || fail "$other was taken, which has no derivatives"
[[ $said == *"$other"*"--want tau,dtau_dq,dtau_dqd,M"* ]] || fail "$other was refused by '$said'"
