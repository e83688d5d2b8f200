#define _POSIX_C_SOURCE 200809L
#include "rnearun/progress.h"
#include "core/seconds.h"
#include <stdio.h>
#include <unistd.h>

void progress_start(struct progress *p, const char *command, const char *unit, uint64_t total, int quiet)
{
	*p = (struct progress){.command = command, .unit = unit, .total = total, .terminal = isatty(STDERR_FILENO)};
	if (!quiet && total)
		p->start = seconds_now();
	p->shown = p->terminal ? 0 : p->start;
}

int progress_is_due(const struct progress *p, double since_start, double since_shown)
{
	if (p->terminal)
		return since_shown >= 0.1;
	return since_shown >= 5 && since_shown >= since_start / 10;
}

void progress_text(const struct progress *p, uint64_t done, const char *doing, double seconds, char *text, unsigned size)
{
	double rate = seconds > 0 ? (double)done / seconds : 0, left = rate > 0 ? (double)(p->total - done) / rate : 0;
	long s = left < 1e6 ? (long)(left + 0.5) : 1000000;
	char more[32] = "", time[32] = "";

	if (done && !*doing)
		snprintf(more, sizeof more, ", %.3g/s", rate);
	if (done)
		snprintf(time, sizeof time, ", %ld:%02ld left", s / 60, s % 60);
	snprintf(text, size, "%.0f %%, %.3g of %.3g %s%s%s%s%s", 100 * ((double)done / (double)p->total), (double)done,
		(double)p->total, p->unit, more, time, *doing ? ": " : "", doing);
}

void progress_show(struct progress *p, uint64_t done, const char *doing)
{
	double t = p->start > 0 ? seconds_now() : 0;
	char text[160];

	if (t == 0 || !progress_is_due(p, t - p->start, t - p->shown))
		return;
	p->shown = t;
	progress_text(p, done, doing, t - p->start, text, sizeof text);
	fprintf(stderr, p->terminal ? "\r\033[K%s: %s" : "%s: %s\n", p->command, text);
	fflush(stderr);
}

void progress_end(struct progress *p)
{
	if (p->terminal && p->shown > 0)
		fputs("\r\033[K", stderr);
	p->start = 0;
}
