#ifndef RUNTIME_RANKS_H
#define RUNTIME_RANKS_H
/* The processes that do a command together. one.c: there is one; mpi.c: MPI's ranks. All of them call ranks_gather, ranks_meet,
   ranks_agree and ranks_tell in the same order, from one thread; ranks_file_write may be called by several threads, at any time.
   Waiting for the others takes no processor time. */

#include "base/error.h"
#include <stddef.h>
#include <stdint.h>

struct ranks_state;

enum { RANKS_ROOM = 64 };

struct ranks {
	size_t index, count;       /* this one, of so many */
	size_t local, local_count; /* the same among those of this machine */
	unsigned threads;          /* its share of the processors; 0: all */
	int are_shared;            /* ranks of MPI, be it one: what they read and write are files with places */
	int is_at_fault;           /* ranks_agree: this is the first rank that failed */
	void *room;                /* RANKS_ROOM bytes for each rank, which ranks_agree and ranks_tell use; others may between them */
	struct ranks_state *state; /* private */
};

/* Join the others. Of all but the first rank, what is printed to standard output is dropped, and what is printed to
   standard error is kept back till ranks_agree. Returns 0 and a message where that fails. */
int ranks_open(struct ranks *r, int *argc, char ***argv);

/* Wait for all, and part. */
void ranks_close(struct ranks *r);

/* `size` bytes of each rank, in their order, to `all`, which has room for r->count times as many; to every rank. */
void ranks_gather(struct ranks *r, const void *mine, size_t size, void *all);

/* Wait for the ranks of this machine. */
void ranks_meet(struct ranks *r);

/* Do all go on? Statuses are -1, to go on, or an exit status: the largest is every rank's. Of what ranks have printed
   to standard error since the last time, that of the first which fails appears, and that of the first rank. */
int ranks_agree(struct ranks *r, int status);

/* The value that the first rank has. */
uint64_t ranks_tell(struct ranks *r, uint64_t value);

/* ---- a file that all write to ---- */

struct ranks_file;

/* Open the file at `path`, which messages call `shown`; both outlive *f. It is there: one rank has made it. On failure
   *f is NULL. Errors: WRITE, MEMORY. */
enum rneagen_code ranks_file_open(
	struct ranks_file **f, struct ranks *r, const char *path, const char *shown, struct rneagen_error *e);

/* What this rank has written is on the disk. Error: WRITE. */
enum rneagen_code ranks_file_sync(struct ranks_file *f, struct rneagen_error *e);

/* NULL is a no-op. Error: WRITE. */
enum rneagen_code ranks_file_close(struct ranks_file *f, struct rneagen_error *e);

/* Write at a byte of the file. Error: WRITE. */
enum rneagen_code ranks_file_write(
	struct ranks_file *f, const void *bytes, size_t size, uint64_t at, struct rneagen_error *e);

/* ---- of mpi.c and one.c, for ranks_agree ---- */

/* End what is kept back, and print it if `shows`. */
void ranks_release(struct ranks *r, int shows);

#endif
