# Sourced by the tests of ik and rollout.
# shellcheck shell=bash
export OMP_WAIT_POLICY=passive # not to spin on a machine that is busy

fail() {
	echo "$(basename "$0" .sh): $*" >&2
	exit 1
}

# same_bits STRICT OTHER OPTIONS...: of each string of options the hash of a short run, as hash PROGRAM OPTION... prints it, is the
# same by 1 and 4 threads and by the program OTHER, if that is not empty, and not the same by another seed.
same_bits() {
	local strict=$1 other=$2 options one words

	for options in "${@:3}"; do
		read -ra words <<<"$options"
		one=$(OMP_NUM_THREADS=1 hash "$strict" "${words[@]}")
		echo "$options: $one"
		[ "$one" = "$(OMP_NUM_THREADS=4 hash "$strict" "${words[@]}")" ] || fail "$options: 4 threads have other bits than 1"
		[ "$one" != "$(hash "$strict" "${words[@]}" --seed 2)" ] || fail "$options: another seed has the same bits"
		[ -z "$other" ] || [ "$one" = "$(hash "$other" "${words[@]}")" ] || fail "$options: another compiler has other bits"
	done
}

# refused PROGRAM OPTIONS...: --help helps, and each string of options ends with exit status 2
refused() {
	local program=$1 options status words

	"$program" --help | grep -q "exit status" || fail "--help does not help"
	for options in "${@:2}"; do
		read -ra words <<<"$options"
		status=0
		"$program" "${words[@]}" >/dev/null 2>&1 || status=$?
		[ "$status" = 2 ] || fail "$options: exit status $status, not 2"
	done
}
