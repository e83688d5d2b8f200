#!/usr/bin/env bash
# example_controller.sh CONTROLLER SOURCE ROBOT.urdf COUNTER TRACE: the arm follows within its limits; the damping is that of
# the URDF; the loop takes nothing from the heap, or else more ticks would take more. Leaves a trace for the plot.
set -euo pipefail
controller=$1 source=$2 urdf=$3 counter=$4 trace=$5

fail() {
	echo "example_controller: $*" >&2
	exit 1
}

# every damping, as the URDF writes them, in the order of its joints
damping=$(sed -n 's/.*<dynamics damping="\(.*\)".*/\1/p' "$urdf" | paste -sd, | sed 's/,/, /g')
grep -qF "DAMPING[N] = {$damping}" "$source" || fail "the damping of $source is not that of $urdf"

"$controller" 20 0.05 "$trace"
[[ $(wc -l <"$trace") == 20000 ]] || fail "$trace does not have 20000 rows"

# from far away torques are held at their limits, and the arm still arrives
"$controller" 4 0.35 "$trace.far" | tee "$trace.out"
grep -q 'at most 1.000 of the effort limit, held there in [1-9]' "$trace.out" || fail "no torque reached its limit"

# beyond a joint's limit the loop stops at once
status=0
"$controller" 4 1.5 "$trace.far" >"$trace.out" || status=$?
[[ $status == 1 ]] || fail "a start beyond a limit was not refused"
grep -q 'stopped after 0 ms: joint 6 is beyond its limit' "$trace.out" || fail "wrong message: $(<"$trace.out")"

if [[ -z $counter ]]; then
	echo "skipped: counting what the loop takes from the heap, for sanitizers do it themselves"
	exit 0
fi
taken() {
	LD_PRELOAD=$counter "$controller" "$1" 0.05 "$trace.far" 2>&1 >/dev/null | grep 'taken from the heap'
}
short=$(taken 2) long=$(taken 20)
[[ $short == "$long" && $short != *': 0' ]] || fail "2 s: $short; 20 s: $long"
