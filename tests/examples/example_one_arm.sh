#!/usr/bin/env bash
# example_one_arm.sh ONE_ARM ROBOTS: one arm of a robot of our own; what cannot be a part is refused.
# example_one_arm.sh ONE_ARM: those of the folder RNEAGEN_ROBOTS. Exit status 77: it is not set.
set -euo pipefail
one_arm=$1 robots=${2-}

fail() {
	echo "example_one_arm: $*" >&2
	exit 1
}

# refused MESSAGE ARGUMENT...
refused() {
	local message=$1 out

	shift
	if out=$("$one_arm" "$@" 2>&1); then
		fail "not refused: $*"
	fi
	[[ $out == *"$message"* ]] || fail "wrong message for $*: $out"
}

if [[ $robots ]]; then
	"$one_arm" "$robots/atlas.urdf" utorso r_hand
	refused "'r_hand'" "$robots/atlas.urdf" utorso r_hnad
elif [[ ${RNEAGEN_ROBOTS-} ]]; then
	"$one_arm" "$RNEAGEN_ROBOTS/pr2.urdf" torso_lift_link r_wrist_roll_link
	"$one_arm" "$RNEAGEN_ROBOTS/baxter.urdf" torso left_wrist
else
	echo "skipped: PR2 and Baxter: RNEAGEN_ROBOTS is not set"
	exit 77
fi
