#include "dynamics/registry.h"

#define ALGORITHM_ADDRESS(name) &algorithm_##name,
const struct algorithm *const ALGORITHMS[ALGORITHM_COUNT] = {ALGORITHM_LIST(ALGORITHM_ADDRESS)};
#undef ALGORITHM_ADDRESS

int algorithms_for(const struct request *k, const struct algorithm *found[ALGORITHM_COUNT])
{
	int count = 0;

	for (int i = 0; i < ALGORITHM_COUNT; i++)
		if (ALGORITHMS[i]->is_made_for(k))
			found[count++] = ALGORITHMS[i];
	return count;
}

static int rows_of(enum role role, const struct tree *t)
{
	static const int rows[] = {[ROWS_VECTOR] = 3, [ROWS_WRENCH] = 6, [ROWS_INERTIA] = 10, [ROWS_ANY] = 1};
	enum role_rows kind = role_rows(role);

	return kind == ROWS_NQ ? t->nq : kind == ROWS_NV ? t->nv : kind == ROWS_BODIES ? 6 * t->body_count : rows[kind];
}

void algorithm_declare(const struct algorithm *x, struct dag *d, const struct tree *t)
{
	for (const struct algorithm_array *a = x->arrays; a->name; a++)
		dag_argument_of(d, (struct argument){.name = a->name, .rows = rows_of(a->role, t), .is_output = a->is_output,
			.role = a->role, .of = ""});
}
