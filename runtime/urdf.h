#ifndef RNEA_URDF_H
#define RNEA_URDF_H
/* From a URDF to a robot that can be launched, in one call. The one part that needs both libraries: link rneagen::urdf. */

#include "rnea.h"
#include "rneagen.h"

#ifdef __cplusplus
extern "C" {
#endif

/* `generate` as a text for `backend` wants it: the text alone; for the host without parts, which it would make one after another,
   and of target c, whose long functions are in segments that a compiler takes a fraction of the time for, unless options are for
   kernels. */
struct rneagen_options rnea_urdf_options(const struct rneagen_options *generate, enum rnea_backend backend);

/* Generate the text for the URDF in the file at `path` and open it as rnea_open does. `generate` chooses what the text
   is (NULL: rneagen_options_default()); its target must be RNEAGEN_TARGET_CUDA, whose text serves both backends, and
   its dump RNEAGEN_DUMP_NONE; it is taken as rnea_urdf_options has it. `options` may be NULL. Messages call the URDF by
   `path` and the text by its robot's name. RNEA_BACKEND_EVALUATOR: by rnea_evaluate_urdf. Errors: READ, URDF (the
   generator's message: the link, joint or option at fault), and those of rnea_open. */
enum rnea_code rnea_open_urdf(const char *path, const struct rneagen_options *generate,
	const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *error);

/* The same by the generator's evaluator of expressions, which compiles nothing: the main function alone, ten to a
   hundred times as slow as compiled. `urdf` are `length` bytes; messages call them generate->file. Numbers in memory
   are as generate->precision says; f32x2 is computed in f64. Of `options`, threads is used. Errors: ARGUMENT, URDF, MEMORY. */
enum rnea_code rnea_evaluate_urdf(const char *urdf, size_t length, const struct rneagen_options *generate,
	const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *error);

#ifdef __cplusplus
}
#endif
#endif
