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
	plan_dump(&d->plans->functions->plan, out);
}

void dump_parts(const struct dumped *d, struct text *out)
{
	const struct plans *p = d->plans;

	if (p->relay)
		relay_dump(p->relay, out);
	parts_dump(p->parts, p->part_count, p->functions, &d->analysis->tree, out);
}

void dump_segments(const struct dumped *d, struct text *out)
{
	const struct plans *p = d->plans;

	for (int i = 0; i < p->function_count; i++)
		segments_dump(&p->functions[i], out);
	if (p->relay)
		segments_dump(&p->relay->start.function, out);
	if (p->relay)
		segments_dump(&p->relay->solve.function, out);
}

void dump_limbs(const struct dumped *d, struct text *out)
{
	const struct plans *p = d->plans;
	int in_parts = p->part_count && !parts_are_apart(p->parts, p->part_count);

	for (int i = 0; i < p->part_count && in_parts; i++)
		limbs_dump(&p->parts[i].function, out);
	for (int i = 0; i < FOUND_ROUNDS && p->rounds; i++)
		limbs_dump(&p->rounds[i].function, out);
	if (!in_parts && !p->rounds)
		limbs_dump(p->functions, out);
	if (p->relay)
		limbs_dump(&p->relay->start.function, out);
}

void dump_kernels(const struct dumped *d, struct text *out)
{
	kernels_dump(&d->plans->kernels, out);
}
