#include "core/info_old.h"
#include <string.h>

enum { PASS_ARRAYS = 3 };

static const char *const names[INFO_OLD_FUNCTIONS] = {"rnea", "fpass", "bpass"};

unsigned info_old_bit(const char *kernel)
{
	for (unsigned i = 0; i < INFO_OLD_FUNCTIONS; i++)
		if (strcmp(kernel, names[i]) == 0)
			return 1u << i;
	return 0;
}

static void give_roles(struct rnea_argument *arguments, size_t count)
{
	static const struct {
		const char *name;
		enum rnea_role role;
	} roles[] = {{"q", RNEA_ROLE_JOINT_POSITION}, {"qd", RNEA_ROLE_JOINT_VELOCITY}, {"qdd", RNEA_ROLE_JOINT_ACCELERATION},
		{"tau", RNEA_ROLE_JOINT_TORQUE}};

	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < sizeof roles / sizeof *roles; k++)
			if (strcmp(arguments[i].name, roles[k].name) == 0)
				arguments[i].role = roles[k].role;
}

static struct rnea_argument array(const struct rnea_info *info, const char *name, size_t rows, enum rnea_role role)
{
	return (struct rnea_argument){.name = name, .rows = rows, .scalar = info->precision, .role = role, .of = ""};
}

static void make_fpass(const struct rnea_info *info, struct rnea_function *f, struct rnea_argument *a)
{
	memcpy(a, info->arguments, info->input_count * sizeof *a);
	a += info->input_count;
	a[0] = array(info, "v", 6 * info->nb, RNEA_ROLE_BODY_TWISTS);
	a[1] = array(info, "a", 6 * info->nb, RNEA_ROLE_BODY_ACCELERATIONS);
	a[2] = array(info, "f", 6 * info->nb, RNEA_ROLE_BODY_WRENCHES);
	f->input_count = info->input_count;
	f->output_count = PASS_ARRAYS;
}

static void make_bpass(const struct rnea_info *info, struct rnea_function *f, struct rnea_argument *a)
{
	a[0] = array(info, "q", info->nq, RNEA_ROLE_JOINT_POSITION);
	a[1] = array(info, "f", 6 * info->nb, RNEA_ROLE_BODY_WRENCHES);
	a[2] = array(info, "tau", info->nv, RNEA_ROLE_JOINT_TORQUE);
	f->input_count = PASS_ARRAYS - 1;
	f->output_count = 1;
}

void info_old_complete(struct rnea_info *info, struct rnea_function *functions, struct rnea_argument *arguments, unsigned kernels)
{
	size_t used = info->input_count + info->output_count;

	give_roles(arguments, used);
	functions->name = names[0];
	info->is_guessed = !kernels;
	for (unsigned i = 1; i < INFO_OLD_FUNCTIONS; i++) {
		struct rnea_function *f = &functions[info->function_count];

		if ((kernels && !(kernels >> i & 1)) || info->input_count + PASS_ARRAYS > RNEA_ARGUMENT_LIMIT)
			continue;
		*f = (struct rnea_function){
			.name = names[i], .arguments = arguments + used, .operations = info->operations, .parts = 1,
				.most_samples = 1,
				.sample_threads = 1};
		(i == 1 ? make_fpass : make_bpass)(info, f, arguments + used);
		used += f->input_count + f->output_count;
		info->function_count++;
	}
}
