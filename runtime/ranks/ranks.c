#include "ranks/ranks.h"

int ranks_agree(struct ranks *r, int status)
{
	const int *all = r->room;
	int worst = status;
	size_t speaker = 0;

	ranks_gather(r, &status, sizeof status, r->room);
	while (speaker < r->count && all[speaker] <= 0)
		speaker++;
	for (size_t i = 0; i < r->count; i++)
		worst = all[i] > worst ? all[i] : worst;
	r->is_at_fault |= r->index == speaker;
	ranks_release(r, r->index == speaker);
	return worst;
}

uint64_t ranks_tell(struct ranks *r, uint64_t value)
{
	ranks_gather(r, &value, sizeof value, r->room);
	return *(const uint64_t *)r->room;
}
