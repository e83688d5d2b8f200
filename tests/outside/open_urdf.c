/* open_urdf ROBOT.urdf: from a URDF to a robot in one call, through the installed header. */
#include <rneagen/urdf.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv)
{
	struct rnea_error e;
	struct rnea_robot *robot;
	enum rnea_code code;

	if (argc != 2)
		return 2;
	if (rnea_open_urdf("/nowhere.urdf", NULL, NULL, &robot, &e) != RNEA_READ)
		return 1;
	code = rnea_open_urdf(argv[1], NULL, NULL, &robot, &e);
	printf("rnea_open_urdf: %s; %s\n", rnea_code_text(code), e.message);
	if (!code && strcmp(rnea_info(robot)->name, "pendulum") != 0)
		return 1;
	rnea_close(robot);
	/* where there is no GPU and no compiler, saying so is the right answer */
	return code && code != RNEA_NO_DRIVER && code != RNEA_NO_DEVICE && code != RNEA_NO_COMPILER;
}
