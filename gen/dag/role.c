#include "dag/role.h"

const char *role_word(enum role role)
{
	static const char *const words[] = {
#define ROLE_WORD(role, word, rows) word,
		ROLES(ROLE_WORD)
#undef ROLE_WORD
	};

	return words[role];
}

enum role_rows role_rows(enum role role)
{
	static const enum role_rows rows[] = {
#define ROLE_ROWS(role, word, rows) rows,
		ROLES(ROLE_ROWS)
#undef ROLE_ROWS
	};

	return rows[role];
}
