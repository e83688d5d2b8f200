#ifndef RUNTIME_PROGRESS_H
#define RUNTIME_PROGRESS_H
/* What tells on standard error how far a command is: one line that changes where that is a terminal, else a line every few
   seconds, later ones further apart. */

#include <stdint.h>

struct progress {
	const char *command, *unit;
	uint64_t total;
	int terminal;
	double start, shown; /* private: seconds; start 0: nothing is shown */
};

/* Begin; `quiet`: nothing is shown. */
void progress_start(struct progress *p, const char *command, const char *unit, uint64_t total, int quiet);

/* Show that `done` of the total are done, if it is time to, and what is being done; "": nothing in particular. */
void progress_show(struct progress *p, uint64_t done, const char *doing);

/* Clear the line of a terminal. */
void progress_end(struct progress *p);

/* Is it time to show something, so many seconds after the start and after the last time? On a terminal ten times a second;
   else after 5 seconds, and after a tenth of what has passed. */
int progress_is_due(const struct progress *p, double since_start, double since_shown);

/* What is shown, without the ends of the line: "43 %, 4.3e+08 of 1e+09 samples, 1.2e+07/s, 0:47 left"; "25 %, 3 of 12
   variants, 0:12 left: cpu f64 accurate soa". */
void progress_text(const struct progress *p, uint64_t done, const char *doing, double seconds, char *text, unsigned size);

#endif
