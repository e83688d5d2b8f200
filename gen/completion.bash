# Completion of rneagen for bash.
# shellcheck shell=bash

_rneagen_options='-o --output --target --precision --layout --trig --base --gravity --mimic --order --name --info
	--info=json --dot --dump --help --version'

# The words that an option takes; returns 1 for an option that takes none, or any.
_rneagen_words() {
	case $1 in
	--target) echo cuda c header ;;
	--precision) echo f32 f64 mixed ;;
	--layout) echo soa aos ;;
	--trig) echo accurate bounded fast ;;
	--base) echo fixed floating ;;
	--mimic) echo honour independent ;;
	--info) echo json ;;
	--dump) echo robot tree dag plan ;;
	*) return 1 ;;
	esac
}

# _rneagen_files BEGINNING SUFFIX...: folders, and files with one of the suffixes
_rneagen_files() {
	local begins=$1 suffix

	shift
	compopt -o filenames 2>/dev/null || true
	mapfile -t COMPREPLY < <(
		compgen -d -- "$begins"
		for suffix in "$@"; do
			compgen -f -X "!*$suffix" -- "$begins"
		done
	)
}

_rneagen() {
	local current=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]} joined='' words

	# readline breaks --option=word into three words
	if [[ $current == '=' ]]; then
		joined=1 current=''
	elif [[ $option == '=' ]]; then
		joined=1 option=${COMP_WORDS[COMP_CWORD - 2]}
	fi
	COMPREPLY=()
	case $option in
	-o | --output) _rneagen_files "$current" .cu .c .h .cuh ;;
	--gravity | --order | --name) ;;
	*)
		if { [[ $option != --info || -n $joined ]]; } && words=$(_rneagen_words "$option"); then
			mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
		elif [[ $current == -* ]]; then
			mapfile -t COMPREPLY < <(compgen -W "$_rneagen_options" -- "$current")
		else
			_rneagen_files "$current" .urdf
		fi
		;;
	esac
}

complete -F _rneagen rneagen
