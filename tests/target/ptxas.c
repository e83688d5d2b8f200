#include "target/ptxas.h"
#include <stdio.h>
#include <string.h>

static void read_line(struct kernel_use *k, const char *line)
{
	int stack, stores, loads;
	const char *shared = strstr(line, " bytes smem");

	if (sscanf(line, " %d bytes stack frame, %d bytes spill stores, %d bytes spill loads", &stack, &stores,
		    &loads) == 3) {
		k->stack = stack > k->stack ? stack : k->stack;
		k->spill_stores += stores;
		k->spill_loads += loads;
	}
	sscanf(line, "ptxas info : Used %d registers", &k->registers);
	if (!shared || strncmp(line, "ptxas info", 10))
		return;
	while (shared > line && shared[-1] != ' ')
		shared--;
	sscanf(shared, "%d", &k->shared);
}

int ptxas_read(const char *log, struct kernel_use *kernels, int limit)
{
	int count = 0;

	while (*log) {
		size_t length = strcspn(log, "\n");
		char line[512];

		snprintf(line, sizeof line, "%.*s", (int)length, log);
		if (strstr(line, "Compiling entry function '") && count < limit) {
			kernels[count] = (struct kernel_use){.registers = -1};
			sscanf(strchr(line, '\'') + 1, "%255[^']", kernels[count++].name);
		} else if (count) {
			read_line(&kernels[count - 1], line);
		}
		log += length + (log[length] == '\n');
	}
	return count;
}
