/* The command `rnearun`: a table of subcommands. */
#define _POSIX_C_SOURCE 200809L
#include "base/nearest.h"
#include "cli/files.h"
#include "cli/options.h"
#include "cli/pending.h"
#include "core/scratch.h"
#include "certify/run_check.h"
#include "proved/run_prove.h"
#include "study/run_choose.h"
#include "eval/run_eval.h"
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
	"  check-certificate  is what prove wrote with --certificate true?\n"
	"  --help, --version\n"
	"\n"
	"mpirun -n N rnearun-mpi COMMAND ... is the same by N ranks of MPI.\n"
	"rnearun COMMAND --help tells about one. Exit status: 0 done, 1 the robot or a file is at fault, 2 the command line is\n";

/* Each is given the command line from its own name on, and returns the exit status. */
static const struct subcommand {
	const char *name;
	int (*run)(struct ranks *ranks, int argc, char **argv);
} SUBCOMMANDS[] = {
	{"eval", run_eval},
	{"report", run_report},
	{"choose", run_choose},
	{"prove", run_prove},
	{"check-certificate", run_check},
};

enum { SUBCOMMAND_COUNT = sizeof SUBCOMMANDS / sizeof *SUBCOMMANDS };

static int run(struct ranks *ranks, int argc, char **argv)
{
	const char *word = argc > 1 ? argv[1] : "", *meant;

	if (!strcmp(word, "--help") || !strcmp(word, "-h"))
		return file_put_stdout(HELP) ? 1 : 0;
	if (!strcmp(word, "--version"))
		return file_put_stdout("rnearun " RNEAGEN_VERSION "\n") ? 1 : 0;
	for (int i = 0; i < SUBCOMMAND_COUNT; i++)
		if (!strcmp(word, SUBCOMMANDS[i].name))
			return SUBCOMMANDS[i].run(ranks, argc - 1, argv + 1);
	if (argc < 2)
		return option_refuse("rnearun", "no command named");
	meant = nearest_name(word, SUBCOMMANDS, SUBCOMMAND_COUNT, sizeof *SUBCOMMANDS);
	if (*word != '-' && meant)
		return option_refuse_meant("rnearun", "command", word, "", meant);
	return option_refuse("rnearun", *word == '-' ? "option '%s' is not known" : "command '%s' is not known", word);
}

int main(int argc, char **argv)
{
	struct ranks ranks;
	int status;

	/* a file that grows too large is an error like any other */
	signal(SIGXFSZ, SIG_IGN);
	if (!ranks_open(&ranks, &argc, &argv))
		return 1;
	/* what the library has for a compiler goes too when a signal ends the command */
	pending_also(scratch_abandon);
	status = ranks_agree(&ranks, run(&ranks, argc, argv));
	ranks_close(&ranks);
	/* mpirun tells of the rank that ends with another status than 0 */
	return ranks.is_at_fault ? status : 0;
}
