/* Steps of refinement of the qdd found: how many, and what their residuals are computed in. */
#include "request/request.h"
#include <string.h>

enum { MOST_STEPS = 3 };

static const char *const NAMES[] = {[REFINE_SAME] = "same", [REFINE_F64] = "f64", [REFINE_F32X2] = "f32x2"};
enum { NAME_COUNT = sizeof NAMES / sizeof *NAMES };

const char *request_refine_name(enum refine refine)
{
	return NAMES[refine];
}

/* "1", "2:f64"; 0 for any other word. *named: NAME_COUNT where no type is named. */
static int read_choice(const char *word, int *steps, int *named)
{
	*steps = *word - '0';
	*named = NAME_COUNT;
	if (*steps < 0 || *steps > MOST_STEPS)
		return 0;
	if (!word[1])
		return 1;
	for (*named = 0; *named < NAME_COUNT; ++*named)
		if (word[1] == ':' && !strcmp(word + 2, NAMES[*named]))
			return 1;
	return 0;
}

/* Texts in f64 and mixed compute in f64. */
static int is_own(enum refine type, enum rneagen_precision precision)
{
	if (type == REFINE_SAME)
		return 1;
	return type == REFINE_F64 ? precision == RNEAGEN_F64 || precision == RNEAGEN_MIXED : precision == RNEAGEN_F32X2;
}

enum rneagen_code request_refine(
	struct request *k, const struct scene *s, enum rneagen_precision precision, struct rneagen_error *e)
{
	const struct scene_choice *c = scene_next(s, SCENE_REFINE, NULL);
	int is_float = precision == RNEAGEN_F32 || precision == RNEAGEN_PRECISION_DEFAULT, steps, named;

	if (!c)
		return RNEAGEN_OK;
	if (!read_choice(c->value, &steps, &named))
		return scene_refuse(s, c, e,
			"takes 0 to %d steps, and a type for the residual, f64, f32x2 or same: 1, 1:f64; not '%.255s'",
			MOST_STEPS, c->value);
	if (steps && !k->is_forward)
		return scene_refuse(s, c, e, "no qdd is found here that could be refined: take --want qdd, or leave it out");
	if (steps && scene_next(s, SCENE_DROP_BELOW, NULL))
		return scene_refuse(s, c, e,
			"refinement makes good what drop-below leaves out, so that no term is felt: leave one of the two out");
	if (named == NAME_COUNT)
		named = is_float ? REFINE_F64 : REFINE_SAME;
	if (!is_float && !is_own((enum refine)named, precision))
		return scene_refuse(s, c, e,
			named == REFINE_F32X2 ? "f32x2 has fewer bits than the text's own f64: take %d:same" :
			"f64 is what f32x2 does without: take %d:same, or --precision f64", steps);
	k->refine_steps = steps;
	k->refine = is_own((enum refine)named, precision) ? REFINE_SAME : (enum refine)named;
	return RNEAGEN_OK;
}
