#define _DEFAULT_SOURCE
#include "rnearun_command.h"
#include "support/process.h"
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *rnearun;

/* What the command says, freed by the caller; its status, and `part` in it. */
static struct process run(const char *const *argv, int status, const char *part)
{
	struct process p = process_run(argv);

	ck_assert_msg(p.status == status, "status %d, not %d: %s", p.status, status, p.output);
	ck_assert_msg(strstr(p.output, part) != NULL, "'%s' does not contain '%s'", p.output, part);
	return p;
}

void run_eval(int status, const char *part, const char *const *words)
{
	const char *argv[48] = {rnearun, "eval"};
	struct process p;

	for (int i = 0; words[i]; i++)
		argv[i + 2] = words[i];
	p = run(argv, status, part);
	if (!*part) /* no progress without a terminal */
		ck_assert_msg(!strstr(p.output, "samples") && !strstr(p.output, "no file"), "says '%s'", p.output);
	process_free(&p);
}

void run_shell(int status, const char *part, const char *script, const char *urdf)
{
	const char *const argv[] = {"sh", "-c", script, "sh", rnearun, urdf, NULL};
	struct process p = run(argv, status, part);

	process_free(&p);
}

int count_files(const char *begins)
{
	DIR *d = opendir(".");
	int n = 0;

	for (struct dirent *f; (f = readdir(d)) != NULL;)
		n += !strncmp(f->d_name, begins, strlen(begins));
	closedir(d);
	return n;
}

int run_in_folder(Suite *suite, const char *name)
{
	char folder[32], path[PATH_MAX + sizeof folder + 8], command[64];
	int failed;

	snprintf(folder, sizeof folder, "%s.XXXXXX", name);
	if (!mkdtemp(folder) || chdir(folder) || !realpath("..", path))
		return perror(folder), 1;
	snprintf(path + strlen(path), sizeof path - strlen(path), "/%s/cache", folder);
	setenv("RNEA_CACHE", path, 1);
	failed = suite_run(suite);
	snprintf(command, sizeof command, "rm -rf %s", folder);
	return failed | (chdir("..") || system(command));
}
