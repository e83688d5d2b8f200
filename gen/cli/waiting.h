#ifndef RNEAGEN_WAITING_H
#define RNEAGEN_WAITING_H
/* What a command that takes long tells on standard error: what it makes now, and for how long it has run. On a terminal one
   line that changes, from two seconds on; else a line every five seconds, and later whenever a tenth of what had passed has
   passed again. A thread of its own tells it, for a pass may take minutes. */

#include <pthread.h>

struct waiting {
	const char *command, *doing; /* doing: under the mutex */
	int is_begun, is_over, is_terminal, is_shown; /* private */
	pthread_t thread;
	pthread_mutex_t mutex;
	pthread_cond_t over;
};

/* Begin; `quiet`: nothing is told, nor where no thread is to be had. */
void waiting_begin(struct waiting *w, const char *command, int quiet);

/* What is done from now on; NULL: nothing that is told, and the line of a terminal is cleared. `w` is a struct waiting. */
void waiting_for(void *w, const char *doing);

/* No more is told. */
void waiting_end(struct waiting *w);

#endif
