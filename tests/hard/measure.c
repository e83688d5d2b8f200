/* Errors of the hard cases.
   usage: hard_measure                          writes the results, as CSV, to standard output
          hard_measure --check FILE [CASE...]   (by default, of the short ones every third, or with RNEAGEN_ALL=1 all) do they
                                               agree with the file's, the numbers within a quarter?
          hard_measure --base ...               the same by base parameters
   In all gen/eval's bound must hold in every sample; else the exit status is 1. */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"
#include "support/exhaustive.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put_outcome(FILE *out, const struct outcome *o)
{
	if (o->overflowed)
		fprintf(out, ",inf,inf,inf,inf,inf,inf,inf,inf");
	else
		fprintf(out, ",%.2e,%.2e,%.2e,%.2e,%.2f,%.1f,%.1f,%.2f", o->max, o->rms, o->model, o->arithmetic, o->terms,
			o->of_max, o->typical, o->least);
}

/* Returns how many torques were beyond their bound. */
static int put_case(FILE *out, const struct hard_case *c)
{
	unsigned flops;
	struct outcome f32 = bench_measure(c, 1, &flops), f64 = bench_measure(c, 0, &flops);

	fprintf(out, "%s,\"%s\",\"%s\",\"%s\",%d,%u", c->name, c->what, c->why, c->mends, c->samples, flops);
	put_outcome(out, &f32);
	put_outcome(out, &f64);
	fputc('\n', out);
	fflush(out);
	return f32.broken + f64.broken;
}

static void put_head(FILE *out)
{
	static const char *const columns[] = {"max", "rms", "model", "arithmetic", "terms", "bound", "typical", "least"};

	fprintf(out, "# tests/hard/measure, seed %d\ncase,what,why,mends,samples,flops", BENCH_SEED);
	for (int i = 0; i < 16; i++)
		fprintf(out, ",%s_%s", i < 8 ? "f32" : "f64", columns[i % 8]);
	fputc('\n', out);
}

/* Equal but for numbers with a point, which may differ by a quarter: C libraries differ in the sine's last bit, and the
   largest error is one sample's. */
static int agree(const char *a, const char *b)
{
	while (*a || *b) {
		size_t n = strcspn(a, ",\n"), m = strcspn(b, ",\n");
		int number = memchr(a, '.', n) && *a != '"';

		if (number && !(fabs(atof(a) - atof(b)) <= 0.25 * fabs(atof(b)) + 0.02))
			return 0;
		if (number && strchr("eE", a[4]) && !(fabs(atof(a) / atof(b) - 1) <= 0.25))
			return 0;
		if (!number && (n != m || memcmp(a, b, n)))
			return 0;
		a += n + (a[n] != 0);
		b += m + (b[m] != 0);
	}
	return 1;
}

/* The file's line of the case: "" where there is none. */
static void find_line(const char *text, const char *name, char *line, size_t size)
{
	size_t length = strlen(name);

	*line = '\0';
	for (; *text; text += strcspn(text, "\n") + 1)
		if (!strncmp(text, name, length) && text[length] == ',') {
			snprintf(line, size, "%.*s\n", (int)strcspn(text, "\n"), text);
			return;
		}
}

/* The case by the URDF's constants, or by others. */
static struct hard_case by_params(const struct hard_case *c, const char *scene)
{
	struct hard_case x = *c;

	x.scene = scene;
	return x;
}

static int check_case(const char *text, const struct hard_case *c)
{
	char line[4096], *now;
	size_t length;
	FILE *out = open_memstream(&now, &length);
	int broken;

	if (!out)
		abort();
	broken = put_case(out, c);
	fclose(out);
	find_line(text, c->name, line, sizeof line);
	if (!agree(now, line)) {
		printf("%s: measured\n%sin the results\n%s", c->name, now, line);
		broken++;
	}
	free(now);
	return broken;
}

static int wanted(int i, char **names)
{
	const char *name = HARD_CASES[i].name;

	if (!*names)
		return exhaustive() || (i % 3 == 0 && !hard_is_long(&HARD_CASES[i]));
	for (; *names; names++)
		if (!strcmp(*names, name))
			return 1;
	return 0;
}

static int check(const char *path, char **names, const char *scene)
{
	size_t length;
	char *text = read_file(path, &length);
	int count = 0, broken = 0;

	if (!text) {
		fprintf(stderr, "%s: cannot be read\n", path);
		return 1;
	}
	for (int i = 0; i < HARD_CASE_COUNT; i++)
		if (wanted(i, names)) {
			struct hard_case c = by_params(&HARD_CASES[i], scene);

			broken += check_case(text, &c);
			count++;
		}
	free(text);
	printf("%d cases measured anew, seed %d: %d differ from %s or break the bound\n", count, BENCH_SEED, broken, path);
	return broken || !count;
}

int main(int argc, char **argv)
{
	int is_base = argc > 1 && !strcmp(argv[1], "--base"), broken = 0;
	const char *scene = is_base ? "params base\n" : "params urdf\n";

	argv += is_base;
	argc -= is_base;
	if (argc > 2 && !strcmp(argv[1], "--check"))
		return check(argv[2], argv + 3, scene);
	put_head(stdout);
	for (int i = 0; i < HARD_CASE_COUNT; i++) {
		struct hard_case c = by_params(&HARD_CASES[i], scene);

		broken += put_case(stdout, &c);
	}
	return broken != 0;
}
