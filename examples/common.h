#ifndef COMMON_H
#define COMMON_H
/* What the programs rollout and ik share: messages, options of a command line, a hash of results, and the GPU. */

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

/* The program's name, for messages. */
extern const char *const PROGRAM;

/* Returns whether something is wrong, having said what. */
inline int wrong(bool is_right, const char *what)
{
	if (!is_right)
		fprintf(stderr, "%s: wrong: %s\n", PROGRAM, what);
	return !is_right;
}

/* The value of an option that takes one, or NULL. */
inline const char *value_of(const char *name, char **argv, int *i)
{
	return !strcmp(argv[*i], name) && argv[*i + 1] ? argv[++*i] : NULL;
}

/* An option that takes no value, and whether it is there. */
struct flag {
	const char *name;
	bool *is_set;
};

/* Returns whether argv's word is one of the flags, which is then set. */
inline bool read_flag(const char *word, std::initializer_list<flag> flags)
{
	for (const flag &f : flags)
		if (!strcmp(word, f.name))
			return *f.is_set = true;
	return false;
}

/* A whole number from 1 to `most`; 0 if it is none. */
inline unsigned long long whole(const char *text, unsigned long long most)
{
	char *end;
	const unsigned long long x = strtoull(text, &end, 10);

	return *text >= '0' && *text <= '9' && !*end && x <= most ? x : 0;
}

/* A sum that changes when a bit of `x` does: as Fowler, Noll and Vo's, by words. */
inline void hash(uint64_t *sum, const double *x, size_t count)
{
	uint64_t word;

	for (size_t i = 0; i < count; i++) {
		memcpy(&word, &x[i], sizeof word);
		*sum = (*sum ^ word) * 0x100000001b3;
		*sum ^= *sum >> 32;
	}
}

/* Why there is no GPU to use, or NULL; its name. In gpu.h. */
const char *gpu_lacks();
const char *gpu_name();

#endif
