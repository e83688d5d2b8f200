#ifndef RNEAGEN_ERROR_H
#define RNEAGEN_ERROR_H
/* Error codes and messages: one row per code, one struct that carries the message out. */

#if defined __GNUC__
#define RNEAGEN_PRINTF(f, a) __attribute__((format(printf, f, a)))
#else
#define RNEAGEN_PRINTF(f, a)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* code, what it means in general */
#define RNEAGEN_ERRORS(X)                                                                                              \
	X(OK, "no error")                                                                                              \
	X(MEMORY, "out of memory")                                                                                     \
	X(USAGE, "an option, or its value, is not understood")                                                         \
	X(READ, "the input cannot be read")                                                                            \
	X(WRITE, "the output cannot be written")                                                                       \
	X(LIMIT, "the input is larger than a documented limit")                                                        \
	X(XML, "the input is not well-formed XML")                                                                     \
	X(XACRO, "the input is an unexpanded xacro file")                                                              \
	X(URDF, "the input is not a valid URDF")                                                                       \
	X(NUMBER, "a number in the URDF cannot be used")                                                               \
	X(TREE, "links and joints do not form one tree")                                                               \
	X(MIMIC, "a mimic relation cannot be resolved")                                                                \
	X(UNSUPPORTED, "the model uses something that is not supported")                                               \
	X(NO_JOINTS, "no movable joints")                                                                              \
	X(NAME, "a name does not fit")                                                                                 \
	X(SCENE, "the scene is not understood, or does not fit the robot")                                             \
	X(TEMPLATE, "a template of the generator does not fit what fills it")

enum rneagen_code {
#define RNEAGEN_ERROR_ENUM(code, text) RNEAGEN_##code,
	RNEAGEN_ERRORS(RNEAGEN_ERROR_ENUM)
#undef RNEAGEN_ERROR_ENUM
	RNEAGEN_ERROR_COUNT
};

struct rneagen_error {
	enum rneagen_code code;
	char message[768]; /* one line, no newline, names the link, joint or option; "" when code is RNEAGEN_OK */
};

/* The general meaning of a code; "unknown error" for a value outside the enumeration. */
const char *rneagen_code_text(enum rneagen_code code);

/* Record a failure and return its code. The first failure is kept: a later one does not overwrite it.
   Control characters in the formatted message are replaced by '?', so that it stays one line. */
enum rneagen_code error_set(struct rneagen_error *e, enum rneagen_code code, const char *fmt, ...) RNEAGEN_PRINTF(3, 4);

/* error_set(e, RNEAGEN_MEMORY, ...) */
enum rneagen_code error_memory(struct rneagen_error *e);

#ifdef __cplusplus
}
#endif
#endif
