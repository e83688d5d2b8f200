#define _POSIX_C_SOURCE 200809L
#include "rnearun/command.h"
#include "cli/pending.h"
#include "cli/waiting.h"
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int command_number(const char *name, const char *option, const char *word, unsigned long long least,
	unsigned long long most, unsigned long long *value)
{
	char *end;

	errno = 0;
	*value = strtoull(word, &end, 10);
	if (*word < '0' || *word > '9' || *end || errno || *value < least || *value > most)
		return option_refuse(
			name, "--%s takes a whole number from %llu to %llu, not '%s'", option, least, most, word);
	return 0;
}

static int take_backend(struct command *c, const char *word)
{
	static const struct option_choice backends[] = {
		{"cpu", RNEA_BACKEND_HOST}, {"cuda", RNEA_BACKEND_CUDA}, {"any", RNEA_BACKEND_ANY}, {NULL, 0}};
	int value = 0, bad = option_choose(c->name, "backend", word, backends, &value);

	if (!bad)
		c->open.backend = (enum rnea_backend)value;
	return bad;
}

/* An option of COMMAND_OPTIONS: 0; 2 and a message; -1: not one of them. */
static int take_common(struct command *c, int key, const char *word)
{
	unsigned long long n = 0;
	int bad = 0;

	switch (key) {
	case COMMAND_BACKEND:
		return take_backend(c, word);
	case COMMAND_DEVICE:
		bad = command_number(c->name, "device", word, 0, INT_MAX, &n);
		c->open.device = (int)n;
		c->has_device = 1;
		return bad;
	case COMMAND_THREADS:
		bad = command_number(c->name, "threads", word, 1, 65536, &n);
		c->open.threads = (unsigned)n;
		return bad;
	case COMMAND_QUIET:
		c->quiet = 1;
		return 0;
	default:
		return option_generate(c->name, &c->generate, key, word);
	}
}

static int fail_generator(const struct command *c, const struct rneagen_error *e)
{
	command_fail(c, e->message);
	return 1 + option_at_fault(e->code);
}

int command_note(const struct command *c, struct file_names *names, const char *what, const char *path)
{
	struct rneagen_error e = {0};

	return file_note(names, what, path, &e) ? fail_generator(c, &e) : -1;
}

/* Before work that takes minutes. */
static enum rneagen_code try_outputs(const struct file_names *written, struct rneagen_error *e)
{
	for (size_t i = 0; i < written->count && !e->code; i++)
		if (strcmp(written->list[i].path, "-"))
			pending_try(written->list[i].path, e);
	return e->code;
}

int command_check_files(const struct command *c)
{
	struct rneagen_error e = {0};

	for (size_t i = 0; c->ranks->are_shared && i < c->read.count; i++)
		if (!strcmp(c->read.list[i].path, "-"))
			return option_refuse(c->name,
				"%s%s-: every rank reads what it needs, and standard input is there for the first one alone; name a file",
				c->read.list[i].what, *c->read.list[i].what ? " " : "");
	if (file_check(&c->read, &c->written, &e) || try_outputs(&c->written, &e))
		return fail_generator(c, &e);
	return -1;
}

void command_free(struct command *c)
{
	option_free(&c->generate);
	file_forget(&c->read);
	file_forget(&c->written);
}

static int take_urdf(struct command *c, int argc, char **argv)
{
	if (optind == argc)
		return option_refuse(c->name, "no URDF named");
	if (optind + 1 < argc)
		return option_refuse(c->name, "one URDF at a time: '%s', '%s'", argv[optind], argv[optind + 1]);
	c->urdf = argv[optind];
	return *c->urdf ? command_note(c, &c->read, "", c->urdf) : option_refuse(c->name, "the name of the URDF is empty");
}

int command_parse(
	struct command *c, const struct command_kind *kind, void *own, struct ranks *ranks, int argc, char **argv)
{
	int key, bad;

	*c = (struct command){.name = kind->name, .generate = rneagen_options_default(), .ranks = ranks};
	c->generate.layout = RNEAGEN_AOS;
	while ((key = getopt_long(argc, argv, kind->letters, kind->options, NULL)) != -1) {
		if (key == OPTION_HELP)
			return file_put_stdout(kind->help) ? 1 : 0;
		if (key == ':' || key == '?')
			return option_refuse_key(c->name, key, argv[optind - 1], kind->options);
		if (option_file(key, optarg) && (bad = command_note(c, &c->read, "", optarg)) > 0)
			return bad;
		bad = take_common(c, key, optarg);
		if (bad < 0)
			bad = kind->take(own, c->name, key, optarg);
		if (bad)
			return bad;
	}
	c->quiet |= ranks->index != 0;
	return take_urdf(c, argc, argv);
}

void command_share(struct command *c)
{
	const struct ranks *r = c->ranks;
	int devices = r->are_shared && !c->has_device && c->open.backend != RNEA_BACKEND_HOST ? rnea_device_count(NULL) : 0;

	if (r->are_shared && !c->open.threads)
		c->open.threads = r->threads;
	if (devices)
		c->open.device = (int)(r->local % (size_t)devices);
}

int command_fail(const struct command *c, const char *message)
{
	if (c->ranks->count > 1)
		fprintf(stderr, "%s: rank %zu: %s\n", c->name, c->ranks->index, message);
	else
		fprintf(stderr, "%s: %s\n", c->name, message);
	return 1;
}

int command_flush(const struct command *c)
{
	struct rneagen_error e = {0};

	return file_put_stdout_error("", &e) ? command_fail(c, e.message) : 0;
}

/* The command's options with the name by which messages call the URDF. */
static struct rneagen_options named_options(const struct command *c)
{
	struct rneagen_options o = c->generate;

	o.file = strcmp(c->urdf, "-") ? c->urdf : "<stdin>";
	return o;
}

int command_analyse(const struct command *c, struct file_content *urdf, struct analysis *a)
{
	struct rneagen_options o = named_options(c);
	struct rneagen_error e = {0};

	*a = (struct analysis){0};
	*urdf = (struct file_content){0};
	if (file_read(c->urdf, urdf, &e) || analysis_open(a, urdf->bytes, urdf->length, &o, &e))
		return fail_generator(c, &e);
	return 0;
}

static void tell(const struct command *c, const struct rnea_build *build)
{
	if (*build->note)
		fprintf(stderr, "%s: %s\n", c->name, build->note);
	if (*build->unkept)
		fprintf(stderr, "%s: what was compiled is not kept for the next time: %s\n", c->name, build->unkept);
}

/* For the processor alone a text of target c: its long functions are in segments, for which a compiler takes a fraction of the
   time (gcc 12, gradients of g1_29dof, floating: less than a fifth). */
static int is_for_host(const struct command *c)
{
	return c->open.backend == RNEA_BACKEND_HOST || (c->open.backend == RNEA_BACKEND_ANY && rnea_device_count(NULL) < 1);
}

int command_generate(const struct command *c, const struct file_content *urdf, struct rneagen_result *text)
{
	struct rneagen_options o = named_options(c);
	struct rneagen_error e = {0};
	struct waiting waiting;

	o.tell = 0;
	if (is_for_host(c))
		o.target = RNEAGEN_TARGET_C;
	o.progress = waiting_for;
	o.progress_context = &waiting;
	waiting_begin(&waiting, c->name, c->quiet);
	rneagen_generate(urdf->bytes, urdf->length, &o, text, &e);
	waiting_end(&waiting);
	if (e.code)
		return fail_generator(c, &e);
	for (size_t i = 0; i < text->warning_count && !c->quiet; i++)
		fprintf(stderr, "%s: warning: %s\n", c->name, text->warnings[i]);
	return 0;
}

int command_open(const struct command *c, const char *text, struct rnea_robot **robot)
{
	struct rnea_error error;
	struct waiting waiting;

	waiting_begin(&waiting, c->name, c->quiet);
	waiting_for(&waiting, "compiling");
	rnea_open(text, strlen(text), &c->open, robot, &error);
	waiting_end(&waiting);
	if (error.code)
		return command_fail(c, error.message);
	if (!c->quiet && isatty(STDERR_FILENO))
		tell(c, rnea_build(*robot));
	return 0;
}
