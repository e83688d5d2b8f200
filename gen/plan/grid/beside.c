#include "plan/grid/beside.h"
#include "plan/grid/found/found_limbs.h"
#include "plan/limbs/limb_limits.h"

void limbs_beside(struct limbs *whole, const struct part *parts, int count, const struct rneagen_options *o)
{
	switch (parts_division(parts, count)) {
	case DIVIDED_BASE_FIRST:
		limbs_beside_base(whole, o);
		break;
	case DIVIDED_BY_SIDES:
		limbs_beside_sides(whole, o);
		break;
	case DIVIDED_IN_ROUNDS:
		found_limbs_beside(whole, parts, count, o);
		break;
	case DIVIDED_BY_LIMBS:
		limbs_beside_limbs(whole, count, o);
		break;
	case DIVIDED_BY_HANDS:
		limbs_beside_hands(whole, o);
		break;
	case DIVIDED_BY_COLUMNS:
	case DIVIDED_NOT:
		break;
	}
}
