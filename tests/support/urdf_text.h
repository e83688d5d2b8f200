#ifndef TESTS_URDF_TEXT_H
#define TESTS_URDF_TEXT_H
/* Small robots as string literals. */

#define ROBOT(name, parts) "<robot name='" name "'>" parts "</robot>"
#define BARE(name) "<link name='" name "'/>"
#define LINK(name, mass, xyz, rpy, xx, xy, xz, yy, yz, zz)                                                                   \
	"<link name='" name "'><inertial><origin xyz='" xyz "' rpy='" rpy "'/><mass value='" mass "'/><inertia ixx='" xx        \
	"' ixy='" xy "' ixz='" xz "' iyy='" yy "' iyz='" yz "' izz='" zz "'/></inertial></link>"
#define POINT(name, mass, xyz) LINK(name, mass, xyz, "0 0 0", "0", "0", "0", "0", "0", "0")
#define BALL(name) LINK(name, "1", "0 0 0.5", "0 0 0", "0.1", "0", "0", "0.1", "0", "0.1")

/* `more`: origin, axis, mimic; limits are there. */
#define JOINT(name, type, parent, child, more)                                                                               \
	"<joint name='" name "' type='" type "'><parent link='" parent "'/><child link='" child                                \
	"'/><limit effort='1' velocity='1' lower='-1' upper='1'/>" more "</joint>"
#define ORIGIN(xyz, rpy) "<origin xyz='" xyz "' rpy='" rpy "'/>"
#define AXIS(xyz) "<axis xyz='" xyz "'/>"
#define MIMIC(joint, multiplier, offset)                                                                                     \
	"<mimic joint='" joint "' multiplier='" multiplier "' offset='" offset "'/>"

#endif
