#ifndef RNEA_INFO_OLD_H
#define RNEA_INFO_OLD_H
/* What the info table has since version 3, for tables of versions 1 and 2: the functions and the roles of their arrays, which
   were the same in every text. */

#include "rnea.h"

enum { INFO_OLD_FUNCTIONS = 3, INFO_OLD_ARRAYS = RNEA_ARGUMENT_LIMIT + 3 };

/* Which of the functions are named by a line `kernels`: a bit each. */
unsigned info_old_bit(const char *kernel);

/* Of the first of `functions`, which has been read, make the others that `kernels` names (0: there is no such line, and all
   may be there), and give arrays their roles. `arguments` are those of the first, with room for
   INFO_OLD_ARRAYS more. */
void info_old_complete(
	struct rnea_info *info, struct rnea_function *functions, struct rnea_argument *arguments, unsigned kernels);

#endif
