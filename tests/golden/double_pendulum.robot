robot "double_pendulum", 3 links, 2 joints, root link "ground"
link "ground", no inertial
link "lower", parent joint "elbow"
	mass 1
	com 0 0 -0.3, rpy 0 0 0
	inertia xx 0.02 xy 0 xz 0 yy 0.02 yz 0 zz 0.0005
link "upper", parent joint "shoulder"
	mass 2
	com 0 0 -0.5, rpy 0 0 0
	inertia xx 0.04 xy 0 xz 0 yy 0.04 yz 0 zz 0.001
joint "elbow", continuous, from "upper" to "lower"
	origin 0 0.1 -1, rpy 0 0 0
	axis 0 1 0
joint "shoulder", continuous, from "ground" to "upper"
	origin 0 0 0, rpy 0 0 0
	axis 0 1 0
