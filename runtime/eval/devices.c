#include "eval/devices.h"
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int eval_devices_take(struct eval_devices *d, const char *command, const char *word)
{
	*d = (struct eval_devices){.is_named = 1, .are_all = !strcmp(word, "all")};
	while (!d->are_all && word) {
		char number[16];
		size_t length = strcspn(word, ",");
		unsigned long long n = 0;

		if (length >= sizeof number)
			return option_refuse(command, "--device takes numbers of devices, not '%.*s'", (int)(length < 255 ? length : 255), word);
		snprintf(number, sizeof number, "%.*s", (int)length, word);
		if (command_number(command, "device", number, 0, INT_MAX, &n))
			return 2;
		if (d->count == EVAL_DEVICES)
			return option_refuse(command, "--device: more than %d", EVAL_DEVICES);
		d->list[d->count++] = (int)n;
		word = word[length] ? word + length + 1 : NULL;
	}
	return 0;
}

static void list_all(struct eval_devices *d)
{
	int n = rnea_device_count(NULL);

	for (d->count = 0; (int)d->count < n && d->count < EVAL_DEVICES; d->count++)
		d->list[d->count] = (int)d->count;
}

/* Of what is named, every so many-th; a rank for which there is none left shares one. */
static void share_out(struct eval_devices *d, const struct ranks *r)
{
	size_t kept = 0;
	int spare = d->list[r->local % d->count];

	for (size_t i = r->local; i < d->count; i += r->local_count)
		d->list[kept++] = d->list[i];
	if (!kept)
		d->list[kept++] = spare;
	d->count = kept;
}

void eval_devices_choose(struct eval_devices *d, enum rnea_backend backend, const struct ranks *r)
{
	int takes_own = r->are_shared && !d->is_named;

	if (backend == RNEA_BACKEND_HOST)
		d->count = 0;
	else if (d->are_all || takes_own)
		list_all(d);
	if (d->count && takes_own) {
		d->list[0] = d->list[r->local % d->count];
		d->count = 1;
	} else if (d->count) {
		share_out(d, r);
	} else {
		d->list[d->count++] = 0;
	}
}
