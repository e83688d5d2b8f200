#compdef rneagen
# Completion of rneagen for zsh.

_arguments \
	'(-o --output)'{-o,--output}'[write to a file]:file:_files -g "*.(cu|c|h|cuh)"' \
	'--target=[kernels, C functions, or inline functions]:target:(cuda c header)' \
	'--precision=[scalar type]:precision:(f32 f64 mixed)' \
	'--layout=[how batches lie in memory]:layout:(soa aos)' \
	'--trig=[sine and cosine]:trigonometry:(accurate bounded fast)' \
	'--base=[fixed to the world, or moving freely]:base:(fixed floating)' \
	'--gravity=[acceleration of gravity, m/s^2]:X,Y,Z:' \
	'--mimic=[joints that follow others]:mimic:(honour independent)' \
	'--order=[rows of q by joint name]:J1,J2,...:' \
	'--name=[prefix of every function]:identifier:' \
	'--info=-[tell about the robot]::format:(json)' \
	'--dot[print the tree as a graph for Graphviz]' \
	'--dump=[print a stage of the pipeline]:stage:(robot tree dag plan)' \
	'(- *)--help[print a summary of the options]' \
	'(- *)--version[print the version]' \
	'1:robot:_files -g "*.urdf"'
