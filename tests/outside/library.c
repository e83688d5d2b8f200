/* library ROBOT.urdf: both libraries through their installed headers; what one writes the other opens. */
#include <rneagen/rnea.h>
#include <rneagen/rneagen.h>
#include <stdio.h>
#include <string.h>

/* Where there is no GPU or no NVRTC, saying so is the right answer. */
static int open_text(const struct rneagen_result *text)
{
	struct rnea_error e;
	struct rnea_robot *robot;
	enum rnea_code code = rnea_open(text->source, strlen(text->source), NULL, &robot, &e);

	printf("rnea_open: %s; %s\n", rnea_code_text(code), e.message);
	if (!code && rnea_bind(robot, "tau") != 3)
		return 1;
	rnea_close(robot);
	return code && code != RNEA_NO_DRIVER && code != RNEA_NO_DEVICE && code != RNEA_NO_COMPILER;
}

int main(int argc, char **argv)
{
	static char urdf[65536];
	struct rneagen_options options = rneagen_options_default();
	struct rneagen_error e = {RNEAGEN_OK, ""};
	struct rneagen_result text;
	FILE *f = argc == 2 ? fopen(argv[1], "rb") : NULL;
	size_t length = f ? fread(urdf, 1, sizeof urdf, f) : 0;
	int bad;

	if (f)
		fclose(f);
	if (rneagen_generate("<robot", 6, &options, &text, &e) != RNEAGEN_XML)
		return 1;
	printf("rneagen_generate: %s\n", e.message);
	e.code = RNEAGEN_OK;
	if (rneagen_generate(urdf, length, &options, &text, &e)) {
		fprintf(stderr, "%s\n", e.message);
		return 1;
	}
	printf("rneagen_generate: %zu bytes for \"%s\"\n", strlen(text.source), text.name);
	bad = open_text(&text);
	rneagen_result_free(&text);
	return bad;
}
