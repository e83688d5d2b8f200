/* Ranks of MPI: the one file that needs it. */
#define _GNU_SOURCE /* sched_getaffinity, open_memstream */
#include "ranks/ranks.h"
#include <errno.h>
#include <fcntl.h>
#include <mpi.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { WRITE_BYTES = 1 << 30 }; /* MPI counts in int */

struct ranks_state {
	MPI_Comm all, local;
	pthread_mutex_t lock; /* one thread at a time calls MPI, which some builds of it ask for */
	FILE *spoken, *kept;  /* standard error; what is kept back, NULL in the first rank */
	char *text;           /* of kept */
	size_t length;
};

struct ranks_file {
	struct ranks *ranks;
	const char *path, *shown;
	MPI_File file;
};

/* ---- waiting ---- */

/* Till a request is done: MPI's own waiting keeps a processor busy that a compiler, or another rank, may want. */
static void finish(struct ranks *r, MPI_Request *request)
{
	struct timespec pause = {0, 20000};
	int done = 0;

	for (;;) {
		pthread_mutex_lock(&r->state->lock);
		MPI_Test(request, &done, MPI_STATUS_IGNORE);
		pthread_mutex_unlock(&r->state->lock);
		if (done)
			return;
		nanosleep(&pause, NULL);
		if (pause.tv_nsec < 5000000)
			pause.tv_nsec += pause.tv_nsec / 2;
	}
}

void ranks_gather(struct ranks *r, const void *mine, size_t size, void *all)
{
	MPI_Request request;

	pthread_mutex_lock(&r->state->lock);
	MPI_Iallgather(mine, (int)size, MPI_BYTE, all, (int)size, MPI_BYTE, r->state->all, &request);
	pthread_mutex_unlock(&r->state->lock);
	finish(r, &request);
}

static void meet(struct ranks *r, MPI_Comm among)
{
	MPI_Request request;

	pthread_mutex_lock(&r->state->lock);
	MPI_Ibarrier(among, &request);
	pthread_mutex_unlock(&r->state->lock);
	finish(r, &request);
}

void ranks_meet(struct ranks *r)
{
	meet(r, r->state->local);
}

/* ---- joining ---- */

/* Processors, each divided by the ranks that may use it: whole where MPI binds ranks to their own. */
static unsigned share_processors(MPI_Comm local)
{
	int mine[CPU_SETSIZE] = {0}, all[CPU_SETSIZE];
	double share = 0;
	cpu_set_t set;

	CPU_ZERO(&set);
	sched_getaffinity(0, sizeof set, &set);
	for (int i = 0; i < CPU_SETSIZE; i++)
		mine[i] = CPU_ISSET((size_t)i, &set) != 0;
	MPI_Allreduce(mine, all, CPU_SETSIZE, MPI_INT, MPI_SUM, local);
	for (int i = 0; i < CPU_SETSIZE; i++)
		share += mine[i] ? 1.0 / all[i] : 0;
	return share < 1 ? 1 : (unsigned)(share + 0.5);
}

/* From now on standard error is a text in memory: what MPI itself says, by number, still appears. */
static void keep_back(struct ranks_state *s)
{
	s->spoken = stderr;
	s->kept = open_memstream(&s->text, &s->length);
	if (s->kept)
		stderr = s->kept;
}

void ranks_release(struct ranks *r, int shows)
{
	struct ranks_state *s = r->state;

	if (!s->kept)
		return;
	fclose(s->kept);
	stderr = s->spoken;
	if (shows)
		fwrite(s->text, 1, s->length, stderr);
	fflush(stderr);
	free(s->text);
	keep_back(s);
}

static void count(MPI_Comm among, size_t *index, size_t *number)
{
	int i, n;

	MPI_Comm_rank(among, &i);
	MPI_Comm_size(among, &n);
	*index = (size_t)i;
	*number = (size_t)n;
}

void ranks_close(struct ranks *r)
{
	struct ranks_state *s = r->state;

	meet(r, s->all);
	if (s->kept) {
		fclose(s->kept);
		stderr = s->spoken;
		free(s->text);
	}
	MPI_Comm_free(&s->local);
	MPI_Comm_free(&s->all);
	MPI_Finalize();
	pthread_mutex_destroy(&s->lock);
	free(r->room);
	free(s);
}

/* In all ranks or in none; one that fails says so. */
static int make_room(struct ranks *r)
{
	int lacks, any;

	r->room = calloc(r->count, RANKS_ROOM);
	lacks = !r->room;
	MPI_Allreduce(&lacks, &any, 1, MPI_INT, MPI_MAX, r->state->all);
	if (!any)
		return 1;
	if (lacks)
		fprintf(stderr, "rnearun: rank %zu: out of memory\n", r->index);
	ranks_close(r);
	return 0;
}

int ranks_open(struct ranks *r, int *argc, char ***argv)
{
	struct ranks_state *s = calloc(1, sizeof *s);
	int level = MPI_THREAD_SINGLE;

	*r = (struct ranks){.are_shared = 1, .state = s};
	if (!s || MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &level) || level < MPI_THREAD_SERIALIZED) {
		fprintf(stderr, "rnearun: MPI does not start, or is built without MPI_THREAD_SERIALIZED\n");
		free(s);
		return 0;
	}
	pthread_mutex_init(&s->lock, NULL);
	MPI_Comm_dup(MPI_COMM_WORLD, &s->all);
	MPI_Comm_split_type(s->all, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &s->local);
	count(s->all, &r->index, &r->count);
	count(s->local, &r->local, &r->local_count);
	r->threads = share_processors(s->local);
	if (!make_room(r))
		return 0;
	if (r->index && freopen("/dev/null", "w", stdout))
		keep_back(s);
	return 1;
}

/* ---- files ---- */

static enum rneagen_code fail(const char *shown, int status, struct rneagen_error *e)
{
	char text[MPI_MAX_ERROR_STRING];
	int length = 0;

	MPI_Error_string(status, text, &length);
	return error_set(e, RNEAGEN_WRITE, "%s: cannot be written: %.*s", shown, length, text);
}

/* Each rank's own: no rank waits for another, and ranks write to no place of another's. */
enum rneagen_code ranks_file_open(
	struct ranks_file **f, struct ranks *r, const char *path, const char *shown, struct rneagen_error *e)
{
	int status;

	if (!(*f = malloc(sizeof **f)))
		return error_memory(e);
	**f = (struct ranks_file){r, path, shown, MPI_FILE_NULL};
	status = MPI_File_open(MPI_COMM_SELF, path, MPI_MODE_WRONLY, MPI_INFO_NULL, &(*f)->file);
	if (!status)
		return RNEAGEN_OK;
	fail(shown, status, e);
	free(*f);
	*f = NULL;
	return e->code;
}

enum rneagen_code ranks_file_sync(struct ranks_file *f, struct rneagen_error *e)
{
	int status;

	pthread_mutex_lock(&f->ranks->state->lock);
	status = MPI_File_sync(f->file);
	pthread_mutex_unlock(&f->ranks->state->lock);
	return status ? fail(f->shown, status, e) : RNEAGEN_OK;
}

enum rneagen_code ranks_file_close(struct ranks_file *f, struct rneagen_error *e)
{
	int status = f ? MPI_File_close(&f->file) : 0;

	if (status)
		fail(f->shown, status, e);
	free(f);
	return e->code;
}

/* Why a byte cannot be written: Open MPI tells of a full disk by a count that is too small, and MPICH of an error. */
static enum rneagen_code fail_write(
	const struct ranks_file *f, int status, const void *byte, uint64_t at, struct rneagen_error *e)
{
	int fd = open(f->path, O_WRONLY | O_CLOEXEC), fails = fd < 0 || pwrite(fd, byte, 1, (off_t)at) != 1, why = errno;

	if (fd >= 0)
		close(fd);
	if (!fails && status)
		return fail(f->shown, status, e);
	return error_set(e, RNEAGEN_WRITE, "%s: cannot be written: %s", f->shown,
		fails ? strerror(why) : "MPI-IO wrote less than it was given");
}

static enum rneagen_code write_part(struct ranks_file *f, const char *bytes, int size, uint64_t at, struct rneagen_error *e)
{
	MPI_Status info;
	int written = 0, status = MPI_File_write_at(f->file, (MPI_Offset)at, bytes, size, MPI_BYTE, &info);

	if (!status)
		MPI_Get_count(&info, MPI_BYTE, &written);
	if (written == size)
		return RNEAGEN_OK;
	/* where it failed at once, the last byte tells of a limit that the first is below */
	written = written > 0 && written < size ? written : size - 1;
	return fail_write(f, status, bytes + written, at + (uint64_t)written, e);
}

enum rneagen_code ranks_file_write(
	struct ranks_file *f, const void *bytes, size_t size, uint64_t at, struct rneagen_error *e)
{
	for (size_t done = 0; done < size && !e->code;) {
		size_t now = size - done < WRITE_BYTES ? size - done : WRITE_BYTES;

		pthread_mutex_lock(&f->ranks->state->lock);
		write_part(f, (const char *)bytes + done, (int)now, at + done, e);
		pthread_mutex_unlock(&f->ranks->state->lock);
		done += now;
	}
	return e->code;
}
