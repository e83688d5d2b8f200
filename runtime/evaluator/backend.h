#ifndef RNEA_EVALUATOR_BACKEND_H
#define RNEA_EVALUATOR_BACKEND_H
/* The backend that compiles nothing: a text's table says what its main function takes, and the program's own function
   computes it. */

#include "core/backend.h"

/* Its open takes what rnea_open_evaluator was given, as backend_request.evaluator. */
extern const struct backend backend_evaluator;

#endif
