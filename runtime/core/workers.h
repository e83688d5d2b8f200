#ifndef RNEA_WORKERS_H
#define RNEA_WORKERS_H
/* Threads that share the pieces of a job with the thread that has it done. They are started when a job first wants them,
   sleep between jobs, and never wait for each other: who has the job done takes pieces like the others, from the first
   on, and waits in the end only for pieces that somebody else has begun. So a job takes no longer than with one thread,
   but for a piece, where the processors are busy and nobody comes to help. */

#include <stddef.h>

struct workers;

/* What is done with piece `piece` of a job; called by several threads at once. */
typedef void workers_piece(void *job, size_t piece);

/* Threads for jobs of at most `threads` threads, the caller's own counted; none is started yet. 0: one for each processor;
   at most four for each. NULL when memory runs out. */
struct workers *workers_open(unsigned threads);

/* Ends the threads. No job may be under way. NULL is a no-op. */
void workers_close(struct workers *w);

/* The most threads that a job can have. */
unsigned workers_limit(const struct workers *w);

/* Do all pieces, 0 to count - 1, in the calling thread and up to `threads` - 1 others, with the floating-point
   environment of the caller; done when it returns. Any number of threads may call this at the same time, and share the
   workers then. Where a thread cannot be started, and in a process that was forked since workers_open, others do its
   share. Allocates nothing once so many threads are there. */
void workers_run(struct workers *w, unsigned threads, workers_piece *piece, void *job, size_t count);

#endif
