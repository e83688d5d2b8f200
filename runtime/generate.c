#include "generate.h"
#include "core/failure.h"

enum rnea_code generate_refused(const struct rneagen_error *refused, struct rnea_error *e)
{
	if (refused->code == RNEAGEN_MEMORY)
		return rnea_error_memory(e);
	return rnea_error_set(e, RNEA_URDF, "%s", refused->message);
}

enum rnea_code generate_text(const char *urdf, size_t length, const struct rneagen_options *g, struct rneagen_result *text,
	struct rnea_error *e)
{
	struct rneagen_error refused = {.code = RNEAGEN_OK};

	return rneagen_generate(urdf, length, g, text, &refused) ? generate_refused(&refused, e) : RNEA_OK;
}
