# gnuplot -e "trace='controller.dat'; plot_file='controller.svg'" controller.gp
set terminal svg size 900,600 background "white"
set output plot_file
set multiplot layout 2,1
set grid
set key outside right
set xlabel "s"
set ylabel "tracking error, mrad"
set title "iiwa 14, computed torque at 1 kHz"
set yrange [-1:1]
plot for [j=1:7] trace every 20 using 1:1+j with lines linecolor j title sprintf("A%d", j)
unset title
set ylabel "torque, part of the limit"
set yrange [-1.05:1.05]
plot for [j=1:7] trace every 20 using 1:8+j with lines linecolor j title sprintf("A%d", j)
