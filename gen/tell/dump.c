#include "tell/dump.h"
#include "plan/grid/found/found_limbs.h"
#include "plan/limbs/limbs.h"
#include "plan/segments.h"

void dump_robot(const struct dumped *d, struct text *out)
{
	robot_dump(&d->analysis->robot, out);
}

void dump_scene(const struct dumped *d, struct text *out)
{
	scene_dump(&d->analysis->scene, &d->analysis->selection, &d->analysis->robot, out);
}

void dump_tree(const struct dumped *d, struct text *out)
{
	tree_dump(&d->analysis->stated, out);
}

void dump_params(const struct dumped *d, struct text *out)
{
	tree_dump(&d->analysis->tree, out);
}

void dump_request(const struct dumped *d, struct text *out)
{
	request_dump(&d->analysis->request, &d->analysis->tree, out);
}

void dump_dag(const struct dumped *d, struct text *out)
{
	dag_dump(&d->analysis->dag, out);
}

void dump_plan(const struct dumped *d, struct text *out)
{
	plan_dump(&d->functions->plan, out);
}

void dump_parts(const struct dumped *d, struct text *out)
{
	if (d->relay)
		relay_dump(d->relay, out);
	parts_dump(d->parts, d->part_count, d->functions, &d->analysis->tree, out);
}

void dump_segments(const struct dumped *d, struct text *out)
{
	for (int i = 0; i < d->function_count; i++)
		segments_dump(&d->functions[i], out);
	if (d->relay)
		segments_dump(&d->relay->start.function, out);
	if (d->relay)
		segments_dump(&d->relay->solve.function, out);
}

void dump_limbs(const struct dumped *d, struct text *out)
{
	int in_parts = d->part_count && !parts_are_apart(d->parts, d->part_count);

	for (int i = 0; i < d->part_count && in_parts; i++)
		limbs_dump(&d->parts[i].function, out);
	for (int i = 0; i < FOUND_ROUNDS && d->rounds; i++)
		limbs_dump(&d->rounds[i].function, out);
	if (!in_parts && !d->rounds)
		limbs_dump(d->functions, out);
	if (d->relay)
		limbs_dump(&d->relay->start.function, out);
}
