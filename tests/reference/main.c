// rnea_reference ROBOT.urdf N SEED [--base floating] [--mimic independent] [--f32] --out DIR
// Writes N random states and their torques as NumPy arrays DIR/q.npy qd.npy qdd.npy tau.npy, float64 [N][rows].
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "reference/reference.h"
#include "reference/read.h"

struct request {
	const char *robot, *out;
	long long count;
	unsigned long long seed;
	struct reference_options options;
	bool f32;
};

enum { FILES = 4 };

static const char usage[] = "usage: rnea_reference ROBOT.urdf N SEED [--base fixed|floating] "
	"[--mimic follow|independent] [--order NAMES] [--f32] --out DIR\n";

static bool read_pair(struct request *r, const char *key, const char *value)
{
	if (!strcmp(key, "--out"))
		r->out = value;
	else if (!strcmp(key, "--order"))
		r->options.order = value;
	else if (!strcmp(key, "--base") && (!strcmp(value, "floating") || !strcmp(value, "fixed")))
		r->options.floating = !strcmp(value, "floating");
	else if (!strcmp(key, "--mimic") && (!strcmp(value, "independent") || !strcmp(value, "follow")))
		r->options.independent = !strcmp(value, "independent");
	else
		return false;
	return true;
}

static bool read_arguments(struct request *r, int argc, char **argv)
{
	if (argc < 4)
		return false;
	*r = (struct request){.robot = argv[1], .count = atoll(argv[2]), .seed = strtoull(argv[3], NULL, 0)};
	for (int i = 4; i < argc; i++) {
		if (!strcmp(argv[i], "--f32"))
			r->f32 = true;
		else if (i + 1 == argc || !read_pair(r, argv[i], argv[i + 1]))
			return false;
		else
			i++;
	}
	return r->out && r->count >= 0;
}

// Version 1.0: magic, length of the header, header padded with blanks to a multiple of 64 that ends in a newline.
static FILE *open_npy(const char *folder, const char *name, long long count, int rows)
{
	char path[4096], header[128];
	FILE *file;
	int n;

	snprintf(path, sizeof path, "%s/%s.npy", folder, name);
	file = fopen(path, "wb");
	if (!file) {
		fprintf(stderr, "%s: cannot be written\n", path);
		return NULL;
	}
	memset(header, ' ', sizeof header);
	memcpy(header, "\x93NUMPY\x01\x00\x76\x00", 10);
	n = snprintf(header + 10, sizeof header - 10, "{'descr': '<f8', 'fortran_order': False, 'shape': (%lld, %d), }",
	             count, rows);
	header[10 + n] = ' ';
	header[sizeof header - 1] = '\n';
	fwrite(header, 1, sizeof header, file);
	return file;
}

static void write_samples(const struct request *request, struct reference *r, FILE **files)
{
	struct rng rng = rng_seed(request->seed);
	double *q = raw_memory(NULL, (size_t)(r->nq + 3 * r->nv), sizeof *q);
	double *qd = q + r->nq, *qdd = qd + r->nv, *tau = qdd + r->nv;
	wide *exact = raw_memory(NULL, (size_t)r->nv, sizeof *exact);

	for (long long k = 0; k < request->count; k++) {
		reference_sample(r, &rng, request->f32, q, qd, qdd);
		reference_rnea(r, q, qd, qdd, exact);
		for (int i = 0; i < r->nv; i++)
			tau[i] = (double)exact[i];
		fwrite(q, sizeof *q, (size_t)r->nq, files[0]);
		fwrite(qd, sizeof *q, (size_t)r->nv, files[1]);
		fwrite(qdd, sizeof *q, (size_t)r->nv, files[2]);
		fwrite(tau, sizeof *q, (size_t)r->nv, files[3]);
	}
	free(q);
	free(exact);
}

static int write_all(const struct request *request, struct reference *r)
{
	static const char *const names[FILES] = {"q", "qd", "qdd", "tau"};
	FILE *files[FILES] = {NULL};
	int bad = 0;

	for (int i = 0; i < FILES && !bad; i++)
		bad = !(files[i] = open_npy(request->out, names[i], request->count, i ? r->nv : r->nq));
	if (!bad)
		write_samples(request, r, files);
	for (int i = 0; i < FILES; i++)
		if (files[i])
			bad |= ferror(files[i]) | fclose(files[i]);
	return bad != 0;
}

int main(int argc, char **argv)
{
	struct request request;
	struct reference *r;
	char message[256];
	int status;

	if (!read_arguments(&request, argc, argv)) {
		fputs(usage, stderr);
		return 2;
	}
	r = reference_open_file(request.robot, &request.options, message, sizeof message);
	if (!r) {
		fprintf(stderr, "%s: %s\n", request.robot, message);
		return 1;
	}
	status = write_all(&request, r);
	reference_close(r);
	return status;
}
