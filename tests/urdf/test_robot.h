#ifndef TEST_ROBOT_H
#define TEST_ROBOT_H
/* Pieces of URDF, and what else the parts of test_robot share. */

#include "support/read.h"
#include <check.h>
#include <string.h>

#define ORIGIN "<origin xyz='0.1 -2e-3 +.5' rpy='1.5707963267948966 0 -3.141592653589793'/>"
#define INERTIA "<inertia ixx='1' ixy='0.1' ixz='0.2' iyy='2' iyz='0.3' izz='2.5'/>"
#define INERTIAL "<inertial><origin xyz='1 2 3' rpy='0.1 0.2 0.3'/><mass value='4'/>" INERTIA "</inertial>"
#define LIMIT "<limit lower='-1' upper='2' effort='3' velocity='4'/>"
#define ENDS(p, c) "<parent link='" p "'/><child link='" c "'/>"
#define ROBOT(body) "<robot name='r'><link name='base'/><link name='arm'>" INERTIAL "</link>" body "</robot>"

static inline void read_string(struct read *r, const char *xml)
{
	read_memory(r, xml, strlen(xml), "test");
}

/* Robots as large as they may be and larger, and memory that runs out. */
TCase *case_limits(void);

#endif
