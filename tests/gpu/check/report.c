#include "check.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FUNCTIONS = 3 }; /* the columns of the table */

static const char *of_environment(const char *name)
{
	const char *value = getenv(name);

	return value && *value ? value : "unknown";
}

static double of_floor(struct rate r)
{
	return r.launch > 0 ? r.floor / r.launch : 0;
}

static void put_row(const struct item *it)
{
	struct rnea_resources r;

	if (!it->robot) {
		printf("%-36.36s did not open\n", it->text);
		return;
	}
	rnea_resources(it->robot, "rnea", &r, NULL);
	printf("%-36.36s %4d %5zu %7.2f %7.2f %7.2f %8.1f %8.1f %5.2f %9.1e%s\n", it->text, r.registers, r.local_bytes,
		it->host * 1e6, it->latency[0] * 1e6, it->latency[1] * 1e6, it->large.launch * 1e12,
		it->large.floor * 1e12, of_floor(it->large), it->max_error, *it->failure ? " FAIL" : "");
}

/* As in --precision. */
static const char *precision_name(const struct rnea_info *info)
{
	const char *memory = info->precision == RNEA_F64 ? "f64" : "f32";

	return strcmp(info->arithmetic, memory) == 0 ? memory :
	       strcmp(info->arithmetic, "f32x2") == 0 ? info->arithmetic : "mixed";
}

static void put_csv_row(FILE *f, const struct item *it)
{
	const struct rnea_info *info;
	static const char *const functions[FUNCTIONS] = {"rnea", "fpass", "bpass"};
	struct rnea_resources k[FUNCTIONS] = {{0}};

	if (!it->robot) {
		fprintf(f, "%s,did not open\n", it->text);
		return;
	}
	info = rnea_info(it->robot);
	for (int i = 0; i < FUNCTIONS; i++)
		rnea_resources(it->robot, functions[i], &k[i], NULL);
	fprintf(f, "%s,%s,%s,%s,%s,%s,%s,%zu,%zu,%zu,%u,%u", it->text, *it->failure ? "FAIL" : "ok", info->name,
		precision_name(info), info->layout == RNEA_AOS ? "aos" : "soa", info->trig,
		info->base, info->nq, info->nv, info->nb, info->block, k[0].busy_block);
	fprintf(f, ",%zu,%zu",
		info->operations.mul + info->operations.add + info->operations.sub + 2 * info->operations.fma,
		info->operations.sincos);
	for (int i = 0; i < FUNCTIONS; i++)
		fprintf(f, ",%d,%zu", k[i].registers, k[i].local_bytes);
	fprintf(f, ",%zu,%.3f,%.4f,%.4f,%.3f,%.3f,%.4f,%.3e,%.3e", k[0].shared_bytes, it->seconds,
		it->latency[0] * 1e6, it->latency[1] * 1e6, it->large.launch * 1e12, it->large.floor * 1e12,
		of_floor(it->large), it->max_error, it->rms_error);
	fprintf(f, ",%.3f,%.1f,%.1f,%.3f,%.4f", it->host * 1e6, it->cold * 1e3, it->cached * 1e3,
		it->larger.launch * 1e12, of_floor(it->larger));
	fprintf(f, ",%.1f,%.1f,%.3f,%.3f,%.3f\n", it->run_one[0] * 1e6, it->run_one[1] * 1e6, it->run_many[0] * 1e3,
		it->run_many[1] * 1e3, it->copies * 1e3);
}

static int put_csv(const struct gpu *g, const struct settings *s, const struct floor *floor, const struct item *items,
	size_t count, const char *path)
{
	FILE *f = fopen(path, "w");
	time_t now = time(NULL);
	char date[32];

	if (!f) {
		fprintf(stderr, "%s: cannot be written\n", path);
		return 1;
	}
	strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", gmtime(&now));
	fprintf(f,
		"# device %s, driver %s (CUDA %d.%d), %s, commit %s, times over %zu samples, medians of %d replays\n",
		g->name, of_environment("RNEA_DRIVER"), g->driver / 1000, g->driver % 1000 / 10, date,
		of_environment("RNEA_COMMIT"), s->large, s->replays);
	fprintf(f, "# an empty kernel: %.3f us a launch in a graph, %.3f us of the host a launch in a stream\n",
		floor->empty_graph * 1e6, floor->empty_host * 1e6);
	fputs("text,result,robot,precision,layout,trig,base,nq,nv,nb,block,busy_block,flops,sincos,", f);
	fputs("registers,local_bytes,fpass_registers,fpass_local_bytes,bpass_registers,bpass_local_bytes,", f);
	fputs("shared_bytes,open_s,us_at_1,us_at_1024,ps_per_sample,floor_ps_per_sample,of_floor,", f);
	fputs("max_error,rms_error,host_us,cold_ms,cached_ms,ps_at_four_times,of_floor_at_four_times,", f);
	fputs("run_us_at_1,run_locked_us_at_1,run_ms,run_locked_ms,copies_ms\n", f);
	for (size_t i = 0; i < count; i++)
		put_csv_row(f, &items[i]);
	return fclose(f) != 0;
}

int report_latency(const struct floor *floor, const struct item *it, const char *path)
{
	FILE *f = *it->failure || !it->robot ? NULL : fopen(path, "a");
	const struct rnea_info *info;

	if (!f) {
		fprintf(stderr, "%s: %s\n", it->text, *it->failure ? it->failure : "cannot be written");
		return 1;
	}
	info = rnea_info(it->robot);
	fprintf(f, "%s,%s,%s,%s,%.4f,%.4f,%.4f\n", it->text, info->name, precision_name(info), info->layout == RNEA_AOS ? "aos" : "soa",
		floor->empty_graph * 1e6, it->latency[0] * 1e6, it->latency[1] * 1e6);
	return fclose(f) != 0;
}

int report(const struct gpu *g, const struct settings *s, const struct floor *f, const struct item *items, size_t count,
	const char *path)
{
	int failures = put_csv(g, s, f, items, count, path);

	printf("%s, driver %s, commit %s; times over %zu samples\n", g->name, of_environment("RNEA_DRIVER"),
		of_environment("RNEA_COMMIT"), s->large);
	printf("an empty kernel: %.2f us in a graph, %.2f us of the host in a stream\n", f->empty_graph * 1e6,
		f->empty_host * 1e6);
	printf("%-36s %4s %5s %7s %7s %7s %8s %8s %5s %9s\n", "text", "regs", "local", "host us", "us@1", "us@1024",
		"ps/smp", "floor", "of it", "error");
	for (size_t i = 0; i < count; i++)
		put_row(&items[i]);
	for (size_t i = 0; i < count; i++)
		if (items[i].cold > 0)
			printf("%-36.36s opens in %.0f ms, from the cache in %.0f ms\n", items[i].text,
				items[i].cold * 1e3, items[i].cached * 1e3);
	for (size_t i = 0; i < count; i++)
		if (*items[i].failure) {
			printf("FAIL %s: %s\n", items[i].text, items[i].failure);
			failures++;
		}
	printf("%zu texts, %d failures; written to %s\n", count, failures, path);
	return failures;
}
