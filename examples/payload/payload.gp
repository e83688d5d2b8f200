# gnuplot -e "map='payload.dat'; plot_file='payload.svg'" payload.gp
set terminal svg size 800,600 background "white"
set output plot_file
set view map
set title "iiwa 14: misfit of candidate payloads along one trajectory, N m"
set xlabel "mass, kg"
set ylabel "height of the centre of mass, m"
set autoscale xfix
set autoscale yfix
set logscale cb
set cbtics (0.05, 0.1, 0.2, 0.5, 1)
set bmargin at screen 0.2
set key at screen 0.7,0.05 horizontal
splot map index 0 using 1:2:3 with pm3d title "", \
	map index 1 using 1:2:(0) with points pointtype 2 pointsize 1.2 linewidth 2 linecolor "cyan" title "least squares", \
	map index 2 using 1:2:(0) with points pointtype 6 pointsize 1.6 linewidth 2 linecolor "red" title "hidden"
