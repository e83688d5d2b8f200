/* For libFuzzer: the generator over any bytes. An input is four bytes of options (see the shifts below), then the texts
   of --order and --name with the lengths that bytes 2 and 3 give, then the URDF. */
#include "rneagen.h"
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { HEADER = 4 };

/* Memory for `left` blocks and then none; what is out must come back. */
struct ration {
	int left, out;
};

static void *ration_alloc(void *context, size_t size)
{
	struct ration *r = context;
	void *p = r->left ? malloc(size) : NULL;

	r->left -= r->left > 0;
	r->out += p != NULL;
	return p;
}

static void ration_release(void *context, void *block)
{
	struct ration *r = context;

	r->out -= block != NULL;
	free(block);
}

static void require(int holds, const char *what, const struct rneagen_error *e)
{
	if (holds)
		return;
	fprintf(stderr, "%s; code %d, message \"%s\"\n", what, (int)e->code, e->message);
	abort();
}

/* The next `length` bytes as a string of their own, or NULL for none. */
static char *take(const uint8_t **data, size_t *size, size_t length)
{
	char *s;

	if (!length || !(s = calloc(length + 1, 1)))
		return NULL;
	length = length < *size ? length : *size;
	memcpy(s, *data, length);
	*data += length;
	*size -= length;
	return s;
}

static struct rneagen_options options_from(const uint8_t head[HEADER])
{
	static const double gravities[][3] = {{0, 0, -9.81}, {0, 0, 0}, {0.3, 1.62, -0.1}, {1e300, -1e300, 1e-300}};
	struct rneagen_options o = rneagen_options_default();

	o.target = (enum rneagen_target)((head[0] & 3) % 3);
	o.precision = (enum rneagen_precision)(head[0] >> 2 & 3);
	o.layout = (enum rneagen_layout)(head[0] >> 4 & 1);
	o.trig = (enum rneagen_trig)((head[0] >> 5 & 3) % 3);
	o.base = (enum rneagen_base)(head[0] >> 7);
	o.mimic = (enum rneagen_mimic)(head[1] & 1);
	memcpy(o.gravity, gravities[head[1] >> 1 & 3], sizeof o.gravity);
	o.dump = (enum rneagen_dump)((head[1] >> 3 & 7) % 5);
	o.file = "fuzz.urdf";
	return o;
}

static int is_line(const char *s)
{
	for (; *s; s++)
		if ((unsigned char)*s < 0x20 || *s == 0x7f)
			return 0;
	return 1;
}

/* Printable ASCII: whatever a name holds, the text does not. */
static int is_plain(const char *s)
{
	for (; s && *s; s++)
		if ((*s < 0x20 || *s >= 0x7f) && *s != '\n' && *s != '\t')
			return 0;
	return 1;
}

static void check(const struct rneagen_options *o, const struct rneagen_result *r, const struct rneagen_error *e)
{
	static const struct rneagen_result empty;

	if (e->code) {
		require(!memcmp(r, &empty, sizeof empty), "a failure leaves a result", e);
		require(e->code < RNEAGEN_ERROR_COUNT && *e->message, "a failure without a message", e);
		require(is_line(e->message), "a message of more than one line", e);
		return;
	}
	require(!*e->message, "a success with a message", e);
	require(r->name && r->info && r->info_json && r->dot, "a success without its texts", e);
	require(!r->dump == (o->dump == RNEAGEN_DUMP_NONE), "a dump where one is asked for", e);
	require(!r->source == (r->dump != NULL), "a source, or a dump", e);
	require(!r->source || strstr(r->source, r->name) != NULL, "a source without its name", e);
	require(!r->header == (r->dump || o->target != RNEAGEN_TARGET_C), "a header for C, and only for C", e);
	require(is_plain(r->source) && is_plain(r->header), "a text with other characters than printable ASCII", e);
	for (size_t i = 0; i < r->warning_count; i++)
		require(*r->warnings[i] && is_line(r->warnings[i]), "a warning of more than one line", e);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct ration ration = {.left = -1};
	const struct rneagen_allocator allocator = {ration_alloc, ration_release, &ration};
	struct rneagen_options o;
	struct rneagen_result r;
	struct rneagen_error e;
	size_t order_length, name_length;
	char *order, *name;

	if (size < HEADER)
		return 0;
	o = options_from(data);
	if (data[1] >> 6 == 3) { /* short of memory */
		ration.left = data[0] % 64;
		o = options_from((const uint8_t[HEADER]){0});
	}
	o.allocator = &allocator;
	order_length = data[2];
	name_length = data[3];
	size -= HEADER;
	data += HEADER;
	o.order = order = take(&data, &size, order_length);
	o.name = name = take(&data, &size, name_length);
	rneagen_generate((const char *)data, size, &o, &r, &e);
	check(&o, &r, &e);
	if (!e.code)
		rneagen_result_free(&r);
	require(ration.out == 0, "memory is not given back", &e);
	free(order);
	free(name);
	return 0;
}
