/* In place of check.c where there was no jansson to read JSON with. */
#include "certify/check.h"

enum rneagen_code certificate_check(const struct check_input *in, struct text *report, struct rneagen_error *e)
{
	(void)report;
	return error_set(e, RNEAGEN_UNSUPPORTED,
		"%s: this rnearun cannot check certificates: it was built without jansson (Debian, Ubuntu: apt install libjansson-dev)",
		in->file);
}
