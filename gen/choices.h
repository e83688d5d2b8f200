#ifndef RNEAGEN_CHOICES_H
#define RNEAGEN_CHOICES_H
/* Options that depend on each other, or on what the scene wants. */

#include "passes/analysis.h"

/* Before the scene is read: defaults, the name of everything, and options that exclude each other. USAGE, NAME, MEMORY. */
enum rneagen_code choices_resolve(struct analysis *a);

/* When the request is known: what excludes that, and which function --only leaves. USAGE. */
enum rneagen_code choices_check(struct analysis *a);

#endif
