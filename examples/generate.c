/* generate ROBOT.urdf NAME: the library instead of the command. The text of a URDF goes in; NAME_rnea.c and
   NAME_rnea.h, the robot's inverse dynamics in C, come out. The text may come from anywhere: here it is a file. */
#include <rneagen/rneagen.h>
#include <stdio.h>
#include <stdlib.h>

/* The whole file, malloc'ed; NULL if it cannot be read. */
static char *read_file(const char *path, size_t *length)
{
	FILE *f = fopen(path, "rb");
	char *text = NULL;
	long size;

	if (f && !fseek(f, 0, SEEK_END) && (size = ftell(f)) >= 0 && !fseek(f, 0, SEEK_SET)) {
		text = malloc((size_t)size + 1);
		*length = text ? fread(text, 1, (size_t)size, f) : 0;
	}
	if (f)
		fclose(f);
	return text;
}

static int write_file(const char *name, const char *suffix, const char *text)
{
	char path[256];
	FILE *f;
	int failed;

	snprintf(path, sizeof path, "%.200s_rnea.%s", name, suffix);
	f = fopen(path, "wb");
	if (!f)
		return 1;
	failed = fputs(text, f) < 0;
	return fclose(f) || failed;
}

int main(int argc, char **argv)
{
	struct rneagen_options options = rneagen_options_default();
	struct rneagen_result result;
	struct rneagen_error error = {0};
	size_t length = 0;
	char *urdf = argc == 3 ? read_file(argv[1], &length) : NULL;
	int failed;

	if (!urdf) {
		fprintf(stderr, "usage: generate ROBOT.urdf NAME\n");
		return 2;
	}
	options.target = RNEAGEN_TARGET_C;
	options.precision = RNEAGEN_F64;
	options.file = argv[1]; /* for messages and the comment at the head of the text */
	options.name = argv[2];
	options.tell = RNEAGEN_TELL_INFO; /* result.info */

	/* on failure there is nothing to free but what is ours; the message names the file, and the link or joint */
	if (rneagen_generate(urdf, length, &options, &result, &error)) {
		fprintf(stderr, "generate: %s (%s)\n", error.message, rneagen_code_text(error.code));
		free(urdf);
		return 1;
	}
	for (size_t i = 0; i < result.warning_count; i++)
		fprintf(stderr, "generate: warning: %s\n", result.warnings[i]);
	fputs(result.info, stdout);
	failed = write_file(result.name, "c", result.source) || write_file(result.name, "h", result.header);
	if (failed)
		fprintf(stderr, "generate: %s_rnea.c and .h cannot be written\n", result.name);

	rneagen_result_free(&result); /* all strings of the result go with it */
	free(urdf);
	return failed;
}
