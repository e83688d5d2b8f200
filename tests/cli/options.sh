# Sourced by the tests of command lines: what --help, the manual page and the completions say.
# shellcheck shell=bash
# `program` is the command whose completion is asked for, `work` a folder for the lists.

fail() {
	echo "FAILED: $*" >&2
	exit 1
}

same() {
	diff -u "$2" "$3" >&2 || fail "$1"
}

# Lists have a line `--option` for each option and `--option word` for each word; in upper case what is only described.

# help_list COMMAND...: lines that begin "  -": options, each with what it takes, up to the description.
help_list() {
	"$@" --help | awk '/^  -/ {
		for (i = 1; i <= NF; i++) {
			if ($i ~ /^-/) {
				last = i
				option = $i
				sub(/,$/, "", option)
				if (split(option, part, "=") > 1)
					print part[1], part[2]
				else
					print option
			} else if (last == i - 1 && ($i ~ /\|/ || $i ~ /^[A-Z][A-Z0-9,.=]*$/ || index($0, $last " " $i "  "))) {
				n = split($i, word, "|")
				for (k = 1; k <= n; k++)
					print part[1], word[k]
			} else {
				break
			}
		}
	}' | sort -u
}

# manual_list FILE: .It Fl -target Cm cuda | c | header
manual_list() {
	awk '/^\.It Fl/ {
		kind = ""
		for (i = 2; i <= NF; i++) {
			if ($i ~ /^(Fl|Cm|Ar)$/) {
				kind = $i
			} else if ($i ~ /^(Ns|Oo|Oc|=|\||,)$/) {
				continue
			} else if (kind == "Fl") {
				option = "-" $i
				print option
			} else {
				print option, $i
			}
		}
	}' "$1" | sort -u
}

# bash_complete WORD...: what the completion of the last word may be, for $program
bash_complete() {
	COMP_WORDS=("$program" "$@") COMP_CWORD=$#
	"_$program"
	((${#COMPREPLY[@]} == 0)) || printf '%s\n' "${COMPREPLY[@]}"
}

# bash_list WORD...: what may follow the words
bash_list() {
	local option

	for option in $(bash_complete "$@" -); do
		if [[ $option == *=* ]]; then
			bash_complete "$@" "${option%%=*}" = "${option#*=}" | sed "s/^/${option%%=*} /"
		else
			echo "$option"
			bash_complete "$@" "$option" '' | sed "s/^/$option /"
		fi
	done
}

# zsh_list FUNCTION: the specifications that the zsh completion gives to _arguments there
zsh_list() (
	# shellcheck disable=SC2317 # the function calls it
	_arguments() { printf '%s\n' "$@"; }
	# shellcheck disable=SC2034 # the file asks which command it is for
	service=none
	# shellcheck source=/dev/null
	source gen/cli/completion.zsh
	"$1" | sed -n 's/^([^)]*)//; s/^\*//; /^-/p' | awk '{
		option = $0
		sub(/[=[].*/, "", option)
		print option
		if (match($0, /:\([a-z0-9 :\\-]*\)$/)) {
			n = split(substr($0, RSTART + 2, RLENGTH - 3), word, " ")
			for (k = 1; k <= n; k++) {
				gsub(/\\/, "", word[k]) # of a colon in a word
				print option, word[k]
			}
		}
	}'
)

words_of() {
	grep -v ' [A-Z]' "$1"
}

# expect WORDS... -- REPLY...: in a folder with files
expect() {
	local words=()

	while [[ $1 != '>' ]]; do
		words+=("$1")
		shift
	done
	shift
	[[ $(bash_complete "${words[@]}" | sort | xargs) == "$*" ]] || fail "completion of '${words[*]}' is not '$*'"
}
