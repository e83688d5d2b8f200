/* Sine and cosine: a function that the text carries, so that its domain and error are known. */
#include "emit.h"
#include "template.h"

void emit_sincos(const struct emission *e, struct text *out)
{
	const struct slot slots[] = {{"F", emit_is_f32(e) ? "f" : ""}, {"T", emit_is_f32(e) ? "float" : "double"}};

	template_expand(out, template_sincos_library_in, slots, 2);
}
