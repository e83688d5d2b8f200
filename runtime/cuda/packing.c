#include "cuda/packing.h"
#include <string.h>

/* A job has one thread more for every THREAD_BYTES, which take about 25 us, up to THREADS; they take PIECE_BYTES at a
   time. */
enum { THREADS = 8, THREAD_BYTES = 1 << 18, PIECE_BYTES = 1 << 15 };

static size_t line_pieces(const struct device_lines *l)
{
	return (l->width + PIECE_BYTES - 1) / PIECE_BYTES;
}

void packing_add(struct packing *p, const struct device_lines *l, char *locked)
{
	size_t k = p->count++;

	p->lines[k] = *l;
	p->locked[k] = locked;
	p->first[k + 1] = p->first[k] + l->lines * line_pieces(l);
	p->bytes += l->lines * l->width;
}

static void copy_piece(void *packing, size_t piece)
{
	const struct packing *p = packing;
	size_t k = 0, line, at, size;
	const struct device_lines *l;
	char *host, *locked;

	while (piece >= p->first[k + 1])
		k++;
	l = &p->lines[k];
	line = (piece - p->first[k]) / line_pieces(l);
	at = (piece - p->first[k]) % line_pieces(l) * PIECE_BYTES;
	size = l->width - at < PIECE_BYTES ? l->width - at : PIECE_BYTES;
	host = (char *)l->host + line * l->host_pitch + at;
	locked = p->locked[k] + line * l->width + at;
	memcpy(p->in ? locked : host, p->in ? host : locked, size);
}

void packing_run(struct packing *p, struct workers *w)
{
	size_t threads = 1 + p->bytes / THREAD_BYTES;

	workers_run(w, threads < THREADS ? (unsigned)threads : THREADS, copy_piece, p, p->first[p->count]);
}
