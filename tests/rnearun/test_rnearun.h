#ifndef TEST_RNEARUN_H
#define TEST_RNEARUN_H
/* What the parts of test_rnearun share. */

#include "rnearun_command.h"

/* Files larger than memory, interruptions, full disks. */
TCase *case_limits(void);

#endif
