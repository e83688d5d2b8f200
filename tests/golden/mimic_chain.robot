robot "mimic_chain", 6 links, 5 joints, root link "frame"
link "arm", parent joint "motor"
	mass 2
	com 0.2 0.01 0, rpy 0 0 0
	inertia xx 0.003 xy 0.0005 xz 0 yy 0.03 yz 0 zz 0.03
link "forearm", parent joint "pinion"
	mass 1
	com 0.1 0 0.02, rpy 0 0 0
	inertia xx 0.001 xy 0 xz 0.0002 yy 0.006 yz 0 zz 0.006
link "frame", no inertial
link "gear_wheel", parent joint "gear"
	mass 0.6
	com 0.01 0 0.02, rpy 0 0 0
	inertia xx 0.0006 xy 0 xz 0 yy 0.001 yz 0 zz 0.0006
link "hand", parent joint "wrist"
	mass 0.3
	com 0.03 0.02 0, rpy 0 0 0
	inertia xx 0.0002 xy 0 xz 0 yy 0.0003 yz 0 zz 0.0003
link "rod", parent joint "rack"
	mass 0.4
	com 0.05 0 0, rpy 0 0 0
	inertia xx 0.0001 xy 0 xz 0 yy 0.0008 yz 0 zz 0.0008
joint "gear", revolute, from "frame" to "gear_wheel"
	origin -0.1 0 0.4, rpy 0 0 0
	axis 0 1 0
	limits: lower -10, upper 10, velocity 30, effort 10
	mimics "motor", multiplier -2.5, offset 0.1
joint "motor", revolute, from "frame" to "arm"
	origin 0.1 0 0.4, rpy 0 0 0
	axis 0 1 0
	limits: lower -3, upper 3, velocity 5, effort 40
joint "pinion", revolute, from "arm" to "forearm"
	origin 0.4 0 0, rpy 0 0 0
	axis 0 0 1
	limits: lower -4, upper 4, velocity 10, effort 10
	mimics "gear", multiplier 0.4, offset -0.3
joint "rack", prismatic, from "forearm" to "rod"
	origin 0.2 0 0, rpy 0 0.4 0
	axis 1 0 0
	limits: lower -0.3, upper 0.3, velocity 1, effort 20
	mimics "pinion", multiplier 0.05, offset 0.02
joint "wrist", revolute, from "rod" to "hand"
	origin 0.1 0 0, rpy 0 0 0
	axis 1 0 0
	limits: lower -3, upper 3, velocity 10, effort 5
