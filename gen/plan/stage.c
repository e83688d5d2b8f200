#include "plan/stage.h"

int stage_place(const struct dag *d, int argument)
{
	int qdd = dag_find_role(d, ROLE_JOINT_ACCELERATION, 0), tau = dag_find_role(d, ROLE_JOINT_TORQUE, 1);

	return qdd >= 0 && tau >= 0 && argument == tau ? qdd : argument;
}

int stage_has_place(const struct dag *d, int argument)
{
	return !d->arguments[argument].per_batch && stage_place(d, argument) == argument;
}
