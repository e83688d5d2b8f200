# gnuplot -e "curve='trajectories.csv'; plot_file='trajectories.svg'" trajectories.gp
set terminal svg size 800,500 background "white"
set output plot_file
set datafile separator comma
set title "iiwa 14: the torque that trajectories take, while all of them are bent at once"
set xlabel "round"
set ylabel "integral of |tau / effort|^2, s"
set logscale y
set yrange [0.05:]
set ytics (0.05, 0.1, 0.2, 0.5, 1)
set grid ytics linecolor "gray80"
set key top right
plot curve using "round":"worst" with lines linewidth 2 linecolor "#d62728" title "worst", \
	curve using "round":"mean" with lines linewidth 2 linecolor "#1f77b4" title "mean", \
	curve using "round":"median" with lines linewidth 2 dashtype 2 linecolor "#2ca02c" title "median"
