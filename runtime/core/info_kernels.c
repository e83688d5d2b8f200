/* Lines of the info table that say how kernels are launched. */
#include "core/info_parser.h"
#include <stdint.h>

enum rnea_code info_limbs(struct parser *p, struct rnea_limbs *l, unsigned parts)
{
	l->parts = parts;
	if (info_count(p, &l->warps, 2, LIMBS_LIMIT) || info_count(p, &l->groups, 1, GROUPS_LIMIT) ||
		words_number(&p->w, &l->bytes, 0, GIVEN_LIMIT / l->groups))
		return p->w.error->code;
	return words_number(&p->w, &l->most, 1, SIZE_MAX / 2);
}

enum rnea_code info_hands(struct parser *p)
{
	int kernel = 0, most = p->version < VERSION_LEVELS ? 1 : RNEA_HANDS_LIMIT;

	while (!info_count(p, &p->f->hands[kernel], 1, PARTS_LIMIT) && p->w.line && ++kernel < most)
		;
	return p->w.error->code;
}

enum rnea_code info_part_kernels(struct parser *p)
{
	struct rnea_function *f = p->f;

	if (words_number(&p->w, &f->part_kernels, 1, SIZE_MAX / 2) || info_count(p, &f->part_count, 1, PARTS_LIMIT))
		return p->w.error->code;
	if (info_count(p, &f->part_block, 1, PART_BLOCK_LIMIT))
		return p->w.error->code;
	return info_count(p, &f->part_arch, 0, ARCH_LIMIT);
}

enum rnea_code info_relay(struct parser *p)
{
	struct rnea_function *f = p->f;

	if (words_number(&p->w, &f->relay_bytes, 1, GIVEN_LIMIT) || info_count(p, &f->relay_threads, 1, RELAY_LIMIT))
		return p->w.error->code;
	f->relay_samples = RELAY_SAMPLES;
	if (info_count(p, &f->relay_room, 1, ROOM_LIMIT) || p->version < VERSION_WIDE)
		return p->w.error->code;
	return info_count(p, &f->relay_samples, RELAY_SAMPLES, BLOCK_LIMIT / f->relay_threads);
}

enum rnea_code info_threads(struct parser *p)
{
	if (info_count(p, &p->f->sample_threads, 2, LIMBS_LIMIT))
		return p->w.error->code;
	return info_count(p, &p->f->most_block, 1, BLOCK_LIMIT / p->f->sample_threads);
}

enum rnea_code info_transpose(struct parser *p)
{
	struct rnea_function *f = p->f;

	if (info_count(p, &f->transposed_samples, 1, BLOCK_LIMIT) || info_count(p, &f->transposed_threads, 1, BLOCK_LIMIT))
		return p->w.error->code;
	return words_number(&p->w, &f->transposed_bytes, 1, GIVEN_LIMIT);
}
