/* rnearun check-certificate: is a certificate of rnearun prove true? */
#include "certify/run_check.h"
#include "certify/asked.h"
#include "certify/check.h"
#include "rnearun/command.h"
#include <stdio.h>
#include <stdlib.h>

static const char NAME[] = "rnearun check-certificate";

static const char HELP[] =
	"usage: rnearun check-certificate FILE [ROBOT.urdf] [--threads N]\n"
	"\n"
	"Checks what rnearun prove wrote with --certificate FILE, without any search and by other code than found it: the\n"
	"URDF and its text are those that are meant, and each bound follows from the steps that are recorded. ROBOT.urdf:\n"
	"unless the file that FILE names.\n"
	"\n"
	"  --threads N                of the processor (default: all)\n"
	"  --help\n"
	"\n"
	"exit status: 0 every bound in it holds, 1 it does not, or a file cannot be read, 2 the command line is at fault\n";

static int print(const struct text *report)
{
	struct rneagen_error e = {0};

	if (report->failed)
		error_memory(&e);
	else if (!file_put_stdout_error(text_string(report), &e))
		return 0;
	return fprintf(stderr, "%s: %s\n", NAME, e.message), 1;
}

static int check(const char *file, const char *urdf, unsigned threads)
{
	struct check_input in = {.file = file, .urdf = urdf, .threads = threads};
	struct rneagen_error e = {0};
	struct arena arena;
	struct text report;
	int status = 0;

	arena_init(&arena, NULL);
	text_init(&report, &arena);
	if (file_read(file, &in.certificate, &e) || certificate_check(&in, &report, &e)) {
		fprintf(stderr, "%s: %s\n", NAME, e.message);
		status = 1;
	} else
		status = print(&report);
	free(in.certificate.bytes);
	arena_free(&arena);
	return status;
}

int run_check(struct ranks *ranks, int argc, char **argv)
{
	static const struct option options[] = {
		{"threads", required_argument, NULL, COMMAND_THREADS}, {"help", no_argument, NULL, OPTION_HELP},
		{NULL, 0, NULL, 0}};
	unsigned long long threads = 0;
	int key;

	while ((key = getopt_long(argc, argv, ":", options, NULL)) != -1) {
		if (key == OPTION_HELP)
			return file_put_stdout(HELP) ? 1 : 0;
		if (key == ':' || key == '?')
			return option_refuse_key(NAME, key, argv[optind - 1], options);
		if (command_number(NAME, "threads", optarg, 1, 65536, &threads))
			return 2;
	}
	if (optind == argc || optind + 2 < argc)
		return option_refuse(NAME, optind == argc ? "no certificate named"
			: "it takes a certificate and a URDF, and no more");
	return ranks->index ? 0 : check(argv[optind], optind + 1 < argc ? argv[optind + 1] : NULL, (unsigned)threads);
}
