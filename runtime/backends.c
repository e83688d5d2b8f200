#include "backends.h"

const struct backend *const backends[] = {&backend_cuda, &backend_host};
const size_t backend_count = sizeof backends / sizeof *backends;
