/* The command `rnearun`: a table of subcommands. */
#define _POSIX_C_SOURCE 200809L
#include "cli/files.h"
#include "cli/options.h"
#include "prove/run_prove.h"
#include "study/run_choose.h"
#include "rnearun/run_eval.h"
#include "study/run_report.h"
#include <signal.h>
#include <string.h>

static const char HELP[] =
	"usage: rnearun COMMAND ...\n"
	"\n"
	"Inverse dynamics tau = ID(q, qd, qdd) of the robot in a URDF, compiled for the machine at hand and run.\n"
	"\n"
	"  eval       torques for arrays on disk\n"
	"  report     speed and error of every variant\n"
	"  choose     the fastest variant that is close enough\n"
	"  prove      ranges of torques and of errors, for all states within the limits\n"
	"  --help, --version\n"
	"\n"
	"rnearun COMMAND --help tells about one. Exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is\n";

/* Each is given the command line from its own name on, and returns the exit status. */
static const struct subcommand {
	const char *name;
	int (*run)(int argc, char **argv);
} SUBCOMMANDS[] = {
	{"eval", run_eval},
	{"report", run_report},
	{"choose", run_choose},
	{"prove", run_prove},
};

enum { SUBCOMMAND_COUNT = sizeof SUBCOMMANDS / sizeof *SUBCOMMANDS };

int main(int argc, char **argv)
{
	const char *word = argc > 1 ? argv[1] : "";

	/* a file that grows too large is an error like any other */
	signal(SIGXFSZ, SIG_IGN);
	if (!strcmp(word, "--help"))
		return file_put_stdout(HELP) ? 1 : 0;
	if (!strcmp(word, "--version"))
		return file_put_stdout("rnearun " RNEAGEN_VERSION "\n") ? 1 : 0;
	for (int i = 0; i < SUBCOMMAND_COUNT; i++)
		if (!strcmp(word, SUBCOMMANDS[i].name))
			return SUBCOMMANDS[i].run(argc - 1, argv + 1);
	if (argc < 2)
		return option_refuse("rnearun", "no command named");
	return option_refuse("rnearun", *word == '-' ? "option '%s' is not known" : "command '%s' is not known", word);
}
