#define _DEFAULT_SOURCE
#include "target/array.h"
#include <check.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { PATTERN = 0x5a };

struct array array_new(int f32, size_t count)
{
	size_t page = (size_t)sysconf(_SC_PAGESIZE), bytes = count * (f32 ? sizeof(float) : sizeof(double));
	size_t used = (bytes + 64 + page - 1) / page * page;
	char *pages = mmap(NULL, used + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);

	ck_assert(pages != MAP_FAILED);
	ck_assert_int_eq(mprotect(pages + used, page, PROT_NONE), 0);
	memset(pages, PATTERN, used);
	return (struct array){f32, count, pages + used - bytes, pages, used - bytes, used + page};
}

void array_free(struct array *a)
{
	munmap(a->pages, a->size);
	a->pages = NULL;
}

double array_get(const struct array *a, size_t i)
{
	return a->f32 ? (double)((const float *)a->data)[i] : ((const double *)a->data)[i];
}

void array_set(const struct array *a, size_t i, double x)
{
	if (a->f32)
		((float *)a->data)[i] = (float)x;
	else
		((double *)a->data)[i] = x;
}

int array_intact(const struct array *a)
{
	for (size_t i = 0; i < a->before; i++)
		if (a->pages[i] != PATTERN)
			return 0;
	return 1;
}

int same_number(double a, double b)
{
	return (a != a && b != b) || !memcmp(&a, &b, sizeof a);
}
