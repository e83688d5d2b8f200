#define _POSIX_C_SOURCE 200809L
#include "target/launch_library.h"
#include <check.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void *launch_library(const struct target *t, const char *stem, const char *before, const char *after)
{
	struct target_path source = target_path(stem, ".cc"), library = target_path(stem, ".so");
	const char *const argv[] = {FAKE_CXX, FAKE_CXX_FLAG, "-std=c++17", "-shared", "-fPIC", "-O0", "-w", "-Wno-psabi",
		"-pthread", "-o", library.s, source.s, NULL};
	char *text, *at;
	size_t length;
	FILE *f = open_memstream(&text, &length);
	void *handle;

	fprintf(f, "%s\n#if !defined FAKE_PARTS\n#define RNEA_NO_PART_KERNELS\n#endif\n", before);
	fprintf(f, "#include \"" TEST_DIR "/fake/fake_launch.h\"\n%s\n%s\n", t->text.source, after);
	fclose(f);
	if ((at = strstr(text, "extern __shared__")) != NULL)
		memcpy(at, "extern           ", strlen("extern __shared__")); /* memory of the launch, not of the kernel */
	target_write(source, text);
	free(text);
	target_compile(t, argv);
	handle = dlopen(library.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(handle != NULL, "%s", dlerror());
	unlink(library.s);
	unlink(source.s);
	return handle;
}
