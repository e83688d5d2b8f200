/* The centre of mass and the momentum of all that moves. */
#include "kinematics/kinematics.h"

void centroid_outputs(const struct kinematics *x)
{
	(void)x;
}
