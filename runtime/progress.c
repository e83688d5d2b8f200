#define _POSIX_C_SOURCE 200809L
#include "progress.h"
#include "seconds.h"
#include <stdio.h>
#include <unistd.h>

void progress_start(struct progress *p, const char *command, const char *unit, uint64_t total, int quiet)
{
	*p = (struct progress){.command = command, .unit = unit, .total = total};
	if (!quiet && total && isatty(STDERR_FILENO))
		p->start = seconds_now();
}

void progress_text(const struct progress *p, uint64_t done, double seconds, char *text, unsigned size)
{
	double rate = seconds > 0 ? (double)done / seconds : 0, left = rate > 0 ? (double)(p->total - done) / rate : 0;
	long s = left < 1e6 ? (long)(left + 0.5) : 1000000;

	snprintf(text, size, "%.0f %%, %.3g of %.3g %s, %.3g/s, %ld:%02ld left",
		100 * ((double)done / (double)p->total), (double)done, (double)p->total, p->unit, rate, s / 60, s % 60);
}

void progress_show(struct progress *p, uint64_t done)
{
	double t = p->start > 0 ? seconds_now() : 0;
	char text[160];

	if (t == 0 || t - p->shown < 0.1)
		return;
	p->shown = t;
	progress_text(p, done, t - p->start, text, sizeof text);
	fprintf(stderr, "\r\033[K%s: %s", p->command, text);
	fflush(stderr);
}

void progress_end(struct progress *p)
{
	if (p->shown > 0)
		fputs("\r\033[K", stderr);
	p->start = 0;
}
