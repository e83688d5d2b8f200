# Completion of rneagen, rnearun and rnearun-mpi for bash.
# shellcheck shell=bash

_rneagen_scene='--scene --root --tip --beside --lock --lock-all-but --fold --free --want --dense --derivatives --dynamics --params --pose --frame --add-frame --refine --jvp --vjp --by --fext --fext-frame --contact --weld --armature --damping
	--friction --snap-angle --round-constants --drop-below --range'
_rneagen_options="-o --output --target --precision --layout --strict --bounded --bounded=running --only --parts --segments --limbs --trig --base --gravity --mimic --order --name --info
	--info=json --dot --dump --quiet --help --version $_rneagen_scene"

# The words that an option takes; returns 1 for an option that takes none, or any.
_rneagen_words() {
	case $1 in
	--target) echo cuda c header ;;
	--precision) echo f32 f64 mixed f32x2 ;;
	--layout) echo soa aos ;;
	--trig) echo accurate bounded fast ;;
	--base) echo fixed floating ;;
	--mimic) echo honour independent ;;
	--beside) echo lock drop ;;
	--fext-frame) echo link world ;;
	--pose) echo rows quaternion ;;
	--frame) echo link world world-aligned ;;
	--derivatives) echo forward recursion ;;
	--dynamics) echo auto factor articulated ;;
	--params) echo urdf base auto ;;
	--refine) echo 0 1 1:f64 1:f32x2 1:same ;;
	--parts) echo auto ;;
	--segments) echo auto whole ;;
	--limbs) echo auto none ;;
	--only) echo rnea fd kin ;;
	--info) echo json ;;
	--bounded) echo running ;;
	--dump) echo robot scene tree params request dag plan parts segments limbs kernels passes ;;
	--backend) [[ ${COMP_WORDS[1]} == eval ]] && echo cpu cuda any || echo cpu cuda all ;;
	--format) [[ ${COMP_WORDS[1]} == prove ]] && echo text json || echo table json csv ;;
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

# Sets current, option before it, and joined where they are one word; readline breaks --option=word into three.
_rneagen_current() {
	current=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]} joined=''
	if [[ $current == '=' ]]; then
		joined=1 current=''
	elif [[ $option == '=' ]]; then
		joined=1 option=${COMP_WORDS[COMP_CWORD - 2]}
	fi
	COMPREPLY=()
}

_rneagen() {
	local current option joined words

	_rneagen_current
	case $option in
	-o | --output) _rneagen_files "$current" .cu .c .h .hh .hpp .hxx .cuh ;;
	--gravity | --order | --name) ;;
	--scene | --armature) _rneagen_files "$current" '' ;;
	--root | --tip | --lock | --lock-all-but | --fold | --free | --want | --add-frame | --fext | --contact | --weld | --snap-angle | --round-constants | --drop-below | --range) ;;
	*)
		if { [[ ( $option != --info && $option != --bounded ) || -n $joined ]]; } && words=$(_rneagen_words "$option"); then
			mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
		elif [[ $current == -* ]]; then
			mapfile -t COMPREPLY < <(compgen -W "$_rneagen_options" -- "$current")
		else
			_rneagen_files "$current" .urdf
		fi
		;;
	esac
}

_rnearun_model="--threads --precision --strict --trig --base --gravity --mimic --order --quiet --help $_rneagen_scene"
_rnearun_common="--backend --device $_rnearun_model"
_rnearun_study="--layout --samples --seed --qd-range --qdd-range --batch $_rnearun_common"
_rnearun_report="--format --plot $_rnearun_study"
_rnearun_choose="--max-error --measured --proved --seconds $_rnearun_study"
_rnearun_prove="--seconds --format --envelope --picture --certificate $_rnearun_model"
_rnearun_check_certificate="--threads --help"
_rnearun_eval="--in --q --qd --qdd --input -o --out --output --slice --resume $_rnearun_common"

_rnearun() {
	local current option joined words options

	_rneagen_current
	if ((COMP_CWORD == 1)); then
		mapfile -t COMPREPLY < <(compgen -W 'eval report choose prove check-certificate --help --version' -- "$current")
		return
	fi
	case $option in
	--in | --q | --qd | --qdd | -o | --out) _rneagen_files "$current" .npy ;;
	--plot | --picture) _rneagen_files "$current" .svg ;;
	--envelope) _rneagen_files "$current" .csv ;;
	--certificate) _rneagen_files "$current" .json ;;
	--scene | --armature) _rneagen_files "$current" '' ;;
	--input | --output) ;; # NAME=FILE
	--device) [[ ${COMP_WORDS[1]} != eval ]] || mapfile -t COMPREPLY < <(compgen -W all -- "$current") ;;
	--root | --tip | --lock | --lock-all-but | --fold | --free | --want | --add-frame | --fext | --contact | --weld | --snap-angle | --round-constants | --drop-below | --range) ;;
	--gravity | --order | --threads | --slice | --samples | --seed | --qd-range | --qdd-range | --batch | --max-error | --seconds) ;;
	*)
		options=_rnearun_${COMP_WORDS[1]//-/_}
		if words=$(_rneagen_words "$option"); then
			mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
		elif [[ $current == -* ]]; then
			mapfile -t COMPREPLY < <(compgen -W "${!options-}" -- "$current")
		elif [[ ${COMP_WORDS[1]} == check-certificate ]]; then
			_rneagen_files "$current" .json .urdf
		else
			_rneagen_files "$current" .urdf
		fi
		;;
	esac
}

complete -F _rneagen rneagen
complete -F _rnearun rnearun rnearun-mpi
