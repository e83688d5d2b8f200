#!/usr/bin/env bash
# example_generate.sh GENERATE RNEAGEN ROBOT.urdf: the example writes what the command writes, and says what is wrong.
set -euo pipefail
generate=$1 rneagen=$2 urdf=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$generate" "$urdf" arm
mkdir command
"$rneagen" "$urdf" -o command/arm_rnea.c --name arm
cmp arm_rnea.c command/arm_rnea.c
cmp arm_rnea.h command/arm_rnea.h

echo '<robot name="r"><link name="a"/></robot>' >bad.urdf
status=0
"$generate" bad.urdf bad 2>message || status=$?
cat message
[[ $status == 1 && ! -e bad_rnea.c ]]
grep -q 'bad.urdf.*no movable joints' message
