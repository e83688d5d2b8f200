#ifndef TESTS_LAUNCH_LIBRARY_H
#define TESTS_LAUNCH_LIBRARY_H

#include "target/target.h"

/* A text of CUDA with its NAME_rnea_launch, built by the C++ compiler for the processor (fake_launch.h), and loaded;
   closed by the caller. before, after: lines around the text; it has kernels of large batches if FAKE_PARTS is defined before. */
void *launch_library(const struct target *t, const char *stem, const char *before, const char *after);

#endif
