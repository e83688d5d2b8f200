/* For libFuzzer: the generator over scenes that a grammar draws by the input's bytes (tests/fuzzing/scene_trial.h). Empty ones do
   not count as accepted. With FUZZ_SCENE_SHOW in the environment each scene is printed, with what became of it. */
#include "fuzz_check.h"
#include "scene_trial.h"
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
	(void)argc;
	(void)argv;
	scene_trial_open();
	return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct trial_result t;

	scene_trial(data, size, &t);
	count_execution(t.outcome == TRIAL_ACCEPTED && *t.scene);
	if (getenv("FUZZ_SCENE_SHOW"))
		fprintf(stderr, "%s%s\n", t.scene, t.outcome == TRIAL_ACCEPTED ? "accepted" : t.message);
	return 0;
}
