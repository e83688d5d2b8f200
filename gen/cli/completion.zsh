#compdef rneagen rnearun rnearun-mpi
# Completion of rneagen and rnearun for zsh.

# Options of both, and of every command of rnearun.
_rneagen_model=(
	'--precision=[scalar type]:precision:(f32 f64 mixed f32x2)'
	'--trig=[sine and cosine]:trigonometry:(accurate bounded fast)'
	'--strict[the same bits from every compiler, CPU and GPU]'
	'--base=[fixed to the world, or moving freely]:base:(fixed floating)'
	'--gravity=[acceleration of gravity, m/s^2]:X,Y,Z:'
	'--mimic=[joints that follow others]:mimic:(honour independent)'
	'--order=[rows of q by joint name]:J1,J2,...:'
	'--scene=[what of the robot is modelled]:file:_files'
	'--root=[the subtree below a link]:link:'
	'*--tip=[the chains from the root to these links]:links:'
	'--beside=[what hangs beside the chains]:choice:(lock drop)'
	'*--lock=[hold a joint]:JOINT=VALUE:'
	'*--lock-all-but=[hold all other joints at zero]:joints:'
	'*--fold=[an input that is known]:NAME=VALUE:'
	'*--free=[a constant that becomes an input]:name:'
	'*--want=[what is computed]:names:'
	'--dense[matrices with all their zeros]'
	'--derivatives=[how dtau_dq and dtau_dqd are made]:method:(forward recursion)'
	'--dynamics=[how qdd is found]:method:(auto factor articulated)'
	'--params=[by which constants the model is computed]:constants:(urdf base auto)'
	'--pose=[how poses are written]:form:(rows quaternion)'
	'--frame=[the frame of Jacobians]:frame:(link world world-aligned)'
	'*--add-frame=[a frame on a link]:NAME=LINK,X,Y,Z,R,P,Y:'
	'*--jvp=[derivatives of outputs times a vector]:names:'
	'*--vjp=[a vector times derivatives of outputs]:names:'
	'*--by=[products also by these inputs]:names:'
	'--refine=[qdd after steps of refinement]:steps:(0 1 1\:f64 1\:f32x2 1\:same)'
	'*--fext=[external wrenches on these links]:links:'
	'--fext-frame=[the axes of external wrenches]:frame:(link world)'
	'*--contact=[links whose origins stand still]:links:'
	'*--weld=[links that stand still as a whole]:links:'
	'--armature=[rotor inertias]:file:_files'
	'--damping[of the URDF]'
	'--friction=-[of the URDF, smoothed]::width:'
	'--snap-angle=[angles this near a multiple of pi/2 are that]:rad:'
	'--round-constants=[significant digits of each constant]:digits:'
	'--drop-below=[leave out terms of less effect, FRACTION or FRACTION\:sampled]:fraction:'
	'*--range=[what an input is drawn from]:NAME=LO,HI:'
	'(- *)--help[print a summary of the options]'
)
_rnearun_common=(
	"${_rneagen_model[@]}"
	'--threads=[how many of the processor]:number:'
	'--quiet[neither progress nor warnings]'
)

# Of those that compare variants.
_rnearun_study=(
	"${_rnearun_common[@]}"
	'--device=[which GPU]:number:'
	'--backend=[where to compute]:backend:(cpu cuda all)'
	'--layout=[how batches lie in memory]:layout:(soa aos)'
	'--batch=[samples of one launch]:number:'
	'--samples=[states in which errors are measured]:number:'
	'--seed=[of the states]:number:'
	'--qd-range=[short for --range qd=-X,X]:number:'
	'--qdd-range=[short for --range qdd=-X,X]:number:'
	'1:robot:_files -g "*.urdf"'
)

_rneagen_command() {
	_arguments "${_rneagen_model[@]}" \
		'(-o --output)'{-o,--output}'[write to a file]:file:_files -g "*.(cu|c|h|hh|hpp|hxx|cuh)"' \
		'--target=[kernels, C functions, or inline functions]:target:(cuda c header)' \
		'--layout=[how batches lie in memory]:layout:(soa aos)' \
		'--segments=[stretches that run for several samples]:segments:(auto whole)' \
		'--limbs=[warps that share out a sample of a small batch]:warps:(auto none)' \
		'--parts=[matrices in parts of the grid]:parts:(auto)' \
		'--bounded=-[target c: also a function that bounds the error of each torque]::way:(running)' \
		'--only=[the algorithm without its halves and batches]:algorithm:(rnea fd kin)' \
		'--name=[prefix of every function]:identifier:' \
		'--info=-[tell about the robot]::format:(json)' \
		'--dot[print the tree as a graph for Graphviz]' \
		'--dump=[print what a pass has made]:pass:(robot scene tree params request dag plan parts segments limbs kernels passes)' \
		'--quiet[neither progress nor warnings]' \
		'(- *)--version[print the version]' \
		'1:robot:_files -g "*.urdf"'
}

_rnearun_eval() {
	_arguments "${_rnearun_common[@]}" \
		'--backend=[where to compute]:backend:(cpu cuda any)' \
		'--in=[rows of q, qd, qdd]:array:_files -g "*.npy"' \
		'--q=[positions]:array:_files -g "*.npy"' \
		'--qd=[velocities]:array:_files -g "*.npy"' \
		'--qdd=[accelerations]:array:_files -g "*.npy"' \
		'*--input=[one input of the scene]:name=file:' \
		'(-o --out)'{-o,--out}'[the torques]:array:_files -g "*.npy"' \
		'*--output=[one output of the scene]:name=file:' \
		'--slice=[samples at a time]:number:' \
		'--device=[which GPUs]:devices:(all)' \
		'--resume[go on where a run that ended early has come to]' \
		'1:robot:_files -g "*.urdf"'
}

_rnearun_report() {
	_arguments "${_rnearun_study[@]}" \
		'--format=[of what is printed]:format:(table json csv)' \
		'--plot=[draw speed against error]:picture:_files -g "*.svg"'
}

_rnearun_choose() {
	_arguments "${_rnearun_study[@]}" \
		'--max-error=[of all samples]:number:' \
		'--measured[judge by the measured errors alone, not by bounds]' \
		'--proved[judge by what holds for every state]' \
		'--seconds=[for the proof]:number:'
}

_rnearun_prove() {
	_arguments "${_rnearun_common[@]}" \
		'--seconds=[for proof and search]:number:' \
		'--format=[of what is printed]:format:(text json)' \
		'--envelope=[torques beside limits of effort]:table:_files -g "*.csv"' \
		'--picture=[the same drawn]:picture:_files -g "*.svg"' \
		'--certificate=[bounds, and the steps that they follow from]:file:_files -g "*.json"' \
		'1:robot:_files -g "*.urdf"'
}

_rnearun_check-certificate() {
	_arguments '--threads=[of the processor]:number:' --help '1:certificate:_files -g "*.json"' '2:robot:_files -g "*.urdf"'
}

_rnearun() {
	if ((CURRENT == 2)); then
		_values command 'eval[torques for arrays on disk]' 'report[speed and error of every variant]' \
			'choose[the fastest variant that is close enough]' \
			'prove[ranges of torques and errors for all states]' \
			'check-certificate[is what prove wrote true]' --help --version
	else
		shift words
		((CURRENT--))
		_call_function - _rnearun_$words[1]
	fi
}

case $service in
rneagen) _rneagen_command ;;
rnearun | rnearun-mpi) _rnearun ;;
esac
