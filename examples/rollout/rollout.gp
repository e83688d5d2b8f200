# gnuplot -e "trace='rollout.csv'; plot_file='rollout.svg'" rollout.gp
set terminal svg size 900,600 background "white"
set output plot_file
set datafile separator comma
set multiplot layout 2,1
set grid
set key outside right
set xlabel "s"
set ylabel "distance of q from the goal, rad"
set title "Panda: sampling control along a moving goal"
set logscale y
plot trace using "seconds":"error" with lines linewidth 2 linecolor "#1f77b4" title "error"
unset title
unset logscale y
set ylabel "q, and the goal (dashed), rad"
plot for [j=1:7] trace using "seconds":sprintf("goal%d", j) with lines dashtype 2 linecolor j notitle, \
	for [j=1:7] trace using "seconds":sprintf("q%d", j) with lines linecolor j title sprintf("q%d", j)
