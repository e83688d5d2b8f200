/* For libFuzzer: the generator over any bytes. An input is four bytes of options (see the shifts below), then the texts
   of --order and --name with the lengths that bytes 2 and 3 give, then the URDF. */
#include "fuzz_check.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { HEADER = 4 };

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
	o.dump = (enum rneagen_dump)(head[1] >> 3 & 7);
	o.file = "fuzz.urdf";
	o.tell = RNEAGEN_TELL_ALL;
	return o;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct ration ration = {.left = -1};
	const struct rneagen_allocator allocator = ration_allocator(&ration);
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
	check_result(&o, &r, &e);
	count_execution(!e.code);
	if (!e.code)
		rneagen_result_free(&r);
	require(ration.out == 0, "memory is not given back", &e);
	free(order);
	free(name);
	return 0;
}
