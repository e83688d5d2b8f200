/* The runtime alone answers. */
#include <rneagen/rnea.h>
#include <stdio.h>

int main(void)
{
	struct rnea_error e;
	struct rnea_robot *robot;
	enum rnea_code code = rnea_open("int x;\n", 7, NULL, &robot, &e);

	printf("rnea_open: %s; %s\n", rnea_code_text(code), e.message);
	rnea_close(robot);
	return code != RNEA_TEXT && code != RNEA_TABLE;
}
