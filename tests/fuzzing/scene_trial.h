#ifndef TESTS_SCENE_TRIAL_H
#define TESTS_SCENE_TRIAL_H
/* A drawn scene generated to the end, and half of them again from the command that their text has at its head. */

#include <stddef.h>
#include <stdint.h>

enum trial { TRIAL_REFUSED, TRIAL_ACCEPTED };

struct trial_result {
	enum trial outcome;
	int garbled;            /* the scene was changed after it was drawn */
	char scene[4096];       /* what was drawn, cut if it is longer */
	char message[768];      /* why it was refused */
};

/* Read the robots that scenes are drawn for: call once, before. */
void scene_trial_open(void);
void scene_trial_close(void);

/* Robot, options and scene depend on the bytes alone. What must hold and does not ends the program with a message. `result`
   may be NULL. */
enum trial scene_trial(const uint8_t *data, size_t size, struct trial_result *result);

#endif
