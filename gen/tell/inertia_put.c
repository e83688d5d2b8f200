#include "tell/inertia_put.h"
#include "base/number.h"
#include "tree/lumps.h"

static void put_values(const struct inertia *I, struct text *out)
{
	text_printf(out, "%s", number_plain((double)I->mass.x).s);
	for (int i = 0; i < 3; i++)
		text_printf(out, ", %s", number_plain((double)I->h[i].x).s);
	for (int i = 0; i < 6; i++)
		text_printf(out, ", %s", number_plain((double)I->I[i].x).s);
}

/* By the tree as it was built: base parameters are others. */
void inertia_put_json(const struct analysis *a, struct text *out)
{
	const struct tree *t = &a->stated;
	struct lumps x;

	if (!request_wants(&a->request, WANT_REGRESSOR))
		return;
	if (!lumps_make(&x, t, out->arena)) {
		out->failed = 1;
		return;
	}
	text_put(out,
		"  \"inertial_parameters\": {\n    \"order\": [\"m\", \"hx\", \"hy\", \"hz\", \"Ixx\", \"Ixy\", \"Ixz\", \"Iyy\", \"Iyz\", "
		"\"Izz\"],\n    \"bodies\": [");
	for (int i = 0; i < x.count; i++) {
		const struct body *k = &t->bodies[x.body[i]];
		struct inertia I = lumps_inertia(&x, t, i);

		text_put(out, i ? ",\n      {\"link\": " : "\n      {\"link\": ");
		text_put_json(out, k->link);
		text_put(out, ", \"joint\": ");
		text_put_json(out, k->joint);
		text_printf(out, ", \"column\": %d,\n        \"values\": [", LUMP_PARAMETERS * i);
		put_values(&I, out);
		text_put(out, "]}");
	}
	text_put(out, "\n    ]\n  },\n");
}
