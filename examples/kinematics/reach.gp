# gnuplot -e "map='reach.dat'; plot_file='reach.svg'" reach.gp
set terminal svg size 760,640 background "white"
set output plot_file
set size ratio -1
set xlabel "x, m"
set ylabel "z, m"
set cblabel "share of all rotations that the hand reaches"
set cbrange [0:1]
set palette defined (0 "#ffffff", 0.02 "#dbe9f6", 0.3 "#6aaed6", 0.6 "#2070b4", 1 "#08306b")
set title "Panda: where its hand can be, y = 0"
set xrange [-1:1]
set yrange [-0.6:1.4]
set object 1 circle at 0,0 size 0.02 front fillcolor "#d62728" fillstyle solid noborder
set label 1 "base" at 0.04,0 front textcolor "#ffffff"
plot map using 1:2:3 with image notitle
