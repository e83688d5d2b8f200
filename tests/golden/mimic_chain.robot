robot "mimic_chain", 6 links, 5 joints, root link "frame"
link "arm", parent joint "motor"
	mass 2
	com 0.20000000000000001 0.01 0, rpy 0 0 0
	inertia xx 0.0030000000000000001 xy 0.00050000000000000001 xz 0 yy 0.029999999999999999 yz 0 zz 0.029999999999999999
link "forearm", parent joint "pinion"
	mass 1
	com 0.10000000000000001 0 0.02, rpy 0 0 0
	inertia xx 0.001 xy 0 xz 0.00020000000000000001 yy 0.0060000000000000001 yz 0 zz 0.0060000000000000001
link "frame", no inertial
link "gear_wheel", parent joint "gear"
	mass 0.59999999999999998
	com 0.01 0 0.02, rpy 0 0 0
	inertia xx 0.00059999999999999995 xy 0 xz 0 yy 0.001 yz 0 zz 0.00059999999999999995
link "hand", parent joint "wrist"
	mass 0.29999999999999999
	com 0.029999999999999999 0.02 0, rpy 0 0 0
	inertia xx 0.00020000000000000001 xy 0 xz 0 yy 0.00029999999999999997 yz 0 zz 0.00029999999999999997
link "rod", parent joint "rack"
	mass 0.40000000000000002
	com 0.050000000000000003 0 0, rpy 0 0 0
	inertia xx 0.0001 xy 0 xz 0 yy 0.00080000000000000004 yz 0 zz 0.00080000000000000004
joint "gear", revolute, from "frame" to "gear_wheel"
	origin -0.10000000000000001 0 0.40000000000000002, rpy 0 0 0
	axis 0 1 0
	limits: lower -10, upper 10, velocity 30, effort 10
	mimics "motor", multiplier -2.5, offset 0.10000000000000001
joint "motor", revolute, from "frame" to "arm"
	origin 0.10000000000000001 0 0.40000000000000002, rpy 0 0 0
	axis 0 1 0
	limits: lower -3, upper 3, velocity 5, effort 40
joint "pinion", revolute, from "arm" to "forearm"
	origin 0.40000000000000002 0 0, rpy 0 0 0
	axis 0 0 1
	limits: lower -4, upper 4, velocity 10, effort 10
	mimics "gear", multiplier 0.40000000000000002, offset -0.29999999999999999
joint "rack", prismatic, from "forearm" to "rod"
	origin 0.20000000000000001 0 0, rpy 0 0.40000000000000002 0
	axis 1 0 0
	limits: lower -0.29999999999999999, upper 0.29999999999999999, velocity 1, effort 20
	mimics "pinion", multiplier 0.050000000000000003, offset 0.02
joint "wrist", revolute, from "rod" to "hand"
	origin 0.10000000000000001 0 0, rpy 0 0 0
	axis 1 0 0
	limits: lower -3, upper 3, velocity 10, effort 5
