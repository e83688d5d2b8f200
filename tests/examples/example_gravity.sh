#!/usr/bin/env bash
# example_gravity.sh GRAVITY TEXT: the arm stays where it is left; the compensator's text is short, and neither keeps nor
# allocates anything.
set -euo pipefail
gravity=$1 text=$2

fail() {
	echo "example_gravity: $*" >&2
	exit 1
}

"$gravity"
lines=$(wc -l <"$text")
((lines < 250)) || fail "$text has $lines lines, not fewer than 250"
if grep -nP 'malloc|calloc|realloc|alloca|\bstatic (?!R|const\b)' "$text"; then
	fail "$text keeps or allocates something"
fi
echo "$text: $lines lines, $(grep -oE '[0-9]+ flops' "$text")"
