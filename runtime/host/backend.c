#define _POSIX_C_SOURCE 200809L /* uname */
#include "host/backend.h"
#include "core/info_table.h"
#include "host/host.h"
#include "host/rows.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

struct state {
	const struct rnea_info *info; /* the robot's */
	struct host host;
	struct host_function *functions; /* one for each of the info's */
	struct utsname machine;
};

static void host_backend_close(void *state)
{
	struct state *s = state;

	host_close(&s->host);
	free(s->functions);
	free(s);
}

static enum rnea_code find_functions(
	struct state *s, const struct backend_request *r, struct rnea_info *info, struct rnea_error *e)
{
	if (!(s->functions = calloc(info->function_count, sizeof *s->functions)))
		return rnea_error_memory(e);
	for (size_t i = 0; i < info->function_count;) {
		const struct rnea_function *f = &info->functions[i];

		s->functions[i] = (struct host_function){host_find(&s->host, info->name, f->name), host_sample_ns(info, f)};
		if (s->functions[i].slice)
			i++;
		else if (!rnea_info_lacks(info, i))
			return rnea_error_set(e, RNEA_TEXT,
				"%s: compiled, but it has no %s_%s_slice: write the text again with this version of rneagen",
				r->file, info->name, f->name);
	}
	return RNEA_OK;
}

static enum rnea_code open_text(struct state *s, const struct backend_request *r, struct rnea_info *info, struct rnea_error *e)
{
	const struct rnea_options *o = r->options;
	const struct host_request request = {.source = r->source->text,
		.file = r->file,
		.name = r->source->name,
		.options = o->compile,
		.option_count = o->compile_count,
		.cache = r->cache,
		.unkept = r->unkept,
		.threads = o->threads,
		.log = o->log,
		.log_size = o->log_size,
		.stop = {o->stop, o->stop_context}};

	if (host_open(&s->host, &request, e) || rnea_info_read(s->host.info, strlen(s->host.info), r->source->name, info, e))
		return e->code;
	if (find_functions(s, r, info, e))
		rnea_info_free(info);
	return e->code;
}

static enum rnea_code host_backend_open(void **state, const struct backend_request *r, struct rnea_info *info,
	struct rnea_build *build, int *absent, struct rnea_error *e)
{
	struct state *s = calloc(1, sizeof *s);

	*absent = 0;
	if (!s)
		return rnea_error_memory(e);
	if (open_text(s, r, info, e)) {
		host_backend_close(s);
		return e->code;
	}
	if (uname(&s->machine) < 0)
		snprintf(s->machine.machine, sizeof s->machine.machine, "host");
	s->info = info;
	*state = s;
	*build = (struct rnea_build){.backend = RNEA_BACKEND_HOST,
		.device = s->machine.machine,
		.compiler = s->host.cached ? "" : s->host.compiler,
		.target = "native",
		.cached = s->host.cached,
		.threads = s->host.threads};
	return RNEA_OK;
}

static enum rnea_code host_launch(
	const void *state, size_t function, void *const *arrays, size_t count, void *stream, struct rnea_error *e)
{
	const struct state *s = state;

	(void)stream, (void)e;
	host_run(&s->host, &s->functions[function], arrays, count);
	return RNEA_OK;
}

static enum rnea_code host_backend_run(const void *state, void *const *arrays, size_t count, struct rnea_error *e)
{
	return host_launch(state, 0, arrays, count, NULL, e);
}

static enum rnea_code host_backend_run_aos(const void *state, void *const *arrays, size_t count, struct rnea_error *e)
{
	const struct state *s = state;

	return host_run_aos(&s->host, s->functions, s->info->functions, arrays, count) ? RNEA_OK : rnea_error_memory(e);
}

const struct backend backend_host = {.name = RNEA_BACKEND_HOST,
	.symbols = "slice",
	.open = host_backend_open,
	.close = host_backend_close,
	.launch = host_launch,
	.run = host_backend_run,
	.run_aos = host_backend_run_aos};
