#include "trace.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void sum_times(struct summary *sum, const struct record *records, size_t count)
{
	double *seconds = calloc(count, sizeof *seconds);

	if (!seconds)
		return;
	for (size_t k = 0; k < count; k++)
		seconds[k] = records[k].seconds;
	qsort(seconds, count, sizeof *seconds, compare);
	sum->median = seconds[count / 2];
	sum->most = seconds[count - 1 - count / 1000];
	sum->worst = seconds[count - 1];
	free(seconds);
}

struct summary trace_summary(const struct record *records, size_t count, size_t settled)
{
	struct summary sum = {0};

	for (size_t k = 0; k < count; k++) {
		for (int j = 0; j < N; j++) {
			if (k >= settled)
				sum.error = fmax(sum.error, fabs(records[k].error[j]));
			sum.effort = fmax(sum.effort, fabs(records[k].effort[j]));
		}
		sum.limited += records[k].limited;
	}
	if (count)
		sum_times(&sum, records, count);
	return sum;
}

int trace_write(const char *path, const struct record *records, size_t count, double rate)
{
	FILE *f = fopen(path, "w");
	int failed;

	if (!f)
		return 1;
	for (size_t k = 0; k < count; k++) {
		fprintf(f, "%.3f", (double)k / rate);
		for (int j = 0; j < N; j++)
			fprintf(f, " %.5f", 1e3 * records[k].error[j]);
		for (int j = 0; j < N; j++)
			fprintf(f, " %.5f", records[k].effort[j]);
		fputc('\n', f);
	}
	failed = ferror(f);
	return fclose(f) || failed;
}
