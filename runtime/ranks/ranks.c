#include "ranks/ranks.h"
#include <stdlib.h>

int ranks_agree(struct ranks *r, int status)
{
	int *all = calloc(r->count, sizeof *all), worst = status;
	size_t speaker = 0;

	if (!all)
		abort(); /* the others would wait for ever */
	ranks_gather(r, &status, sizeof status, all);
	while (speaker < r->count && all[speaker] <= 0)
		speaker++;
	for (size_t i = 0; i < r->count; i++)
		worst = all[i] > worst ? all[i] : worst;
	free(all);
	r->is_at_fault |= r->index == speaker;
	ranks_release(r, r->index == speaker);
	return worst;
}

uint64_t ranks_tell(struct ranks *r, uint64_t value)
{
	uint64_t *all = calloc(r->count, sizeof *all);

	if (!all)
		abort();
	ranks_gather(r, &value, sizeof value, all);
	value = all[0];
	free(all);
	return value;
}
