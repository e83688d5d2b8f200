#ifndef RNEA_H
#define RNEA_H
/* librnea: run the inverse dynamics, tau = ID(q, qd, qdd), that rneagen wrote for one robot. There are two backends.
   CUDA: the text is compiled by NVRTC for the device at hand and launched through the CUDA driver; both libraries are
   found when the program runs, so a program linked with librnea starts on machines that have neither. HOST: the same
   text is compiled by the machine's C compiler to a shared object, vectorised across samples and run by several
   threads.

   SI units throughout: m, kg, s, rad; torques in N m, forces in N. No function prints, exits or keeps state between
   calls; different threads may open, launch and close at the same time. Where a function takes a `struct rnea_error *`,
   NULL means that the code alone is wanted; otherwise the struct is overwritten by every call (RNEA_OK and "" on
   success) and belongs to the caller.

   What was compiled is kept in a cache on disk; where that cannot be read or written everything works without it, and
   rnea_build()->unkept says why.

   Environment: RNEA_LIBCUDA and RNEA_NVRTC name the driver library and the NVRTC library to use instead of the ones
   that would be found; a name that is set and cannot be loaded is an error. RNEA_CC names the C compiler of the host
   backend (default: the first of cc, gcc, clang on PATH, or where PATH is not set in the system's own). RNEA_CACHE
   names the folder of the cache (default: $XDG_CACHE_HOME/rnea or ~/.cache/rnea); set and empty: no cache. */

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined __cplusplus && defined __GNUC__ && !defined __clang__
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow" /* functions and structs of one name, as C has them */
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default) /* of the shared library, these functions and no others can be seen */
#endif

/* code, what it means in general */
#define RNEA_ERRORS(X)                                                                                                 \
	X(OK, "no error")                                                                                              \
	X(MEMORY, "out of memory")                                                                                     \
	X(DEVICE_MEMORY, "the device is out of memory")                                                                \
	X(ARGUMENT, "an argument cannot be used")                                                                      \
	X(POINTER, "a device pointer is null or misaligned")                                                           \
	X(LIMIT, "the batch is larger than one launch can be")                                                         \
	X(READ, "the file cannot be read")                                                                             \
	X(URDF, "the URDF cannot be made into a text")                                                                 \
	X(TEXT, "the text was not written by rneagen")                                                                 \
	X(TABLE, "the info table of the text is damaged or does not match")                                            \
	X(NO_DRIVER, "the CUDA driver library cannot be loaded")                                                       \
	X(NO_DEVICE, "there is no such CUDA device")                                                                   \
	X(DRIVER, "a call of the CUDA driver failed")                                                                  \
	X(CONTEXT, "the CUDA context has died of an earlier error")                                                    \
	X(NO_COMPILER, "the compiler, NVRTC or the machine's own, cannot be found")                                    \
	X(COMPILER, "the compiler cannot do what is asked of it")                                                      \
	X(COMPILE, "the text does not compile")                                                                        \
	X(KERNEL, "the text has no such function")

enum rnea_code {
#define RNEA_ERROR_ENUM(code, text) RNEA_##code,
	RNEA_ERRORS(RNEA_ERROR_ENUM)
#undef RNEA_ERROR_ENUM
	RNEA_ERROR_COUNT
};

struct rnea_error {
	enum rnea_code code;
	char message[2048]; /* one line, no newline, names the file, argument or library; "" when code is RNEA_OK */
};

/* The general meaning of a code; "unknown error" for a value outside the enumeration. Never NULL; not to be freed. */
const char *rnea_code_text(enum rnea_code code);

/* ---- what a text says about itself ---- */

enum rnea_scalar { RNEA_F32, RNEA_F64 }; /* float, double */
enum rnea_layout { RNEA_SOA, RNEA_AOS }; /* array[row][sample], array[sample][row] */

enum { RNEA_HANDS_LIMIT = 8 };     /* the most kernels for hands */
enum { RNEA_ARGUMENT_LIMIT = 64 }; /* the most arrays one function can take */

/* What an array means, and its word in the table. "of" says what rnea_argument.of names: of a link, a joint, the
   constant that the torques are differentiated by, or the outputs that a product is of, by commas. Rows of vectors of
   all bodies are 6 for each, linear then angular. */
#define RNEA_ROLES(X)                                                                                                  \
	X(UNKNOWN, "unknown")			    /* the table does not say, or by a word of a later version */      \
	X(JOINT_POSITION, "joint_position")	    /* q */                                                            \
	X(JOINT_VELOCITY, "joint_velocity")	    /* qd */                                                           \
	X(JOINT_ACCELERATION, "joint_acceleration") /* qdd */                                                          \
	X(JOINT_TORQUE, "joint_torque")		    /* tau */                                                          \
	X(GRAVITY_TORQUE, "gravity_torque")	    /* of gravity alone: qd = qdd = 0 */                               \
	X(BIAS_TORQUE, "bias_torque")		    /* of gravity and velocities: qdd = 0 */                           \
	X(GRAVITY, "gravity")			    /* m/s^2, in the root link's frame */                              \
	X(LINK_WRENCH, "link_wrench")		    /* from outside, of a link */                                      \
	X(LINK_MASS, "link_mass")		    /* of a link */                                                    \
	X(LINK_INERTIA, "link_inertia")		    /* of a link: its ten inertial parameters */                       \
	X(LINK_PAYLOAD, "link_payload")		    /* of a link: ten inertial parameters on top of its own */         \
	X(JOINT_OFFSET, "joint_offset")		    /* of a joint: added to its q */                                   \
	X(JOINT_ARMATURE, "joint_armature")	    /* of a joint: its rotor's inertia, kg m^2 (kg) */                 \
	X(JOINT_DAMPING, "joint_damping")	    /* of a joint: N m s/rad (N s/m) */                                \
	X(JOINT_FRICTION, "joint_friction")	    /* of a joint: N m (N) */                                          \
	X(ARMATURE, "armature")			    /* of all joints with one row, in rows of qd */                    \
	X(DAMPING, "damping")			    /* the same */                                                     \
	X(FRICTION, "friction")			    /* the same */                                                     \
	X(JOINT_WRENCH, "joint_wrench")		    /* of a joint: what it carries */                                  \
	X(LINK_TWIST, "link_twist")		    /* of a link */                                                    \
	X(LINK_ACCELERATION, "link_acceleration")   /* of a link */                                                    \
	X(BODY_TWISTS, "body_twists")		    /* of all moving bodies */                                         \
	X(BODY_ACCELERATIONS, "body_accelerations") /* of all moving bodies */                                         \
	X(BODY_WRENCHES, "body_wrenches")	    /* of all moving bodies: their own */                              \
	X(POWER, "power")                                                                                              \
	X(KINETIC_ENERGY, "kinetic_energy")                                                                            \
	X(POTENTIAL_ENERGY, "potential_energy")                                                                        \
	X(MASS_MATRIX, "mass_matrix") /* M = dtau/dqdd */                                                              \
	X(DTAU_DQ, "dtau_dq")                                                                                          \
	X(DTAU_DQD, "dtau_dqd")                                                                                        \
	X(DTAU_DFREED, "dtau_dfreed") /* of a constant that the scene makes an input */                                \
	X(TANGENT, "tangent")	  /* 3 nv: a direction of q, qd, qdd (of q, qd, tau for qdd); or of another input */   \
	X(COTANGENT, "cotangent") /* weights of the outputs that vjp is of */                                          \
	X(JVP, "jvp")		  /* derivatives of outputs times the tangent */                                       \
	X(VJP, "vjp")		  /* 3 nv: the cotangent times derivatives of outputs; or by another input */          \
	X(MASS_MATRIX_INVERSE, "mass_matrix_inverse") /* dqdd/dtau */                                                  \
	X(DQDD_DQ, "dqdd_dq")                                                                                          \
	X(DQDD_DQD, "dqdd_dqd")                                                                                        \
	X(DQDD_DFREED, "dqdd_dfreed")				/* of a constant that the scene makes an input */      \
	X(JOINT_ACCELERATION_BOUND, "joint_acceleration_bound") /* how far each acceleration may be off */             \
	X(REGRESSOR, "regressor")		    /* dtau/dpi: ten columns a body, of its inertial parameters */     \
	X(LINK_POSE, "link_pose")		    /* of a link in the world: [R p] by rows, or p and a quaternion */ \
	X(LINK_JACOBIAN, "link_jacobian")	    /* of a link: its twist by qd */                                   \
	X(LINK_JACOBIAN_RATE, "link_jacobian_rate") /* of a link: the rate of its Jacobian times qd */                 \
	X(CENTER_OF_MASS, "center_of_mass")	    /* of all that moves, in the world */                              \
	X(CENTER_OF_MASS_VELOCITY, "center_of_mass_velocity")                                                          \
	X(CENTER_OF_MASS_JACOBIAN, "center_of_mass_jacobian")                                                          \
	X(MOMENTUM, "momentum")				      /* centroidal, in the world's axes */                    \
	X(MOMENTUM_MATRIX, "momentum_matrix")		      /* by qd */                                              \
	X(MOMENTUM_RATE, "momentum_rate")		      /* without gravity */                                    \
	X(CORIOLIS, "coriolis")				      /* C qd = bias - gravity, dM/dt = C + C' */              \
	X(OPSPACE_INERTIA_INVERSE, "opspace_inertia_inverse") /* of a link: J Minv J' */                               \
	X(OPSPACE_INERTIA, "opspace_inertia")		      /* of a link: its inverse */                             \
	X(CONTACT_ACCELERATION, "contact_acceleration")	      /* that a link has instead of standing */                \
	X(CONTACT_FORCE, "contact_force")		      /* on the origin of a link that stands */                \
	X(CONTACT_WRENCH, "contact_wrench")		      /* on a link that stands */

enum rnea_role {
#define RNEA_ROLE_ENUM(role, word) RNEA_ROLE_##role,
	RNEA_ROLES(RNEA_ROLE_ENUM)
#undef RNEA_ROLE_ENUM
	RNEA_ROLE_COUNT
};

/* One array of a signature. Sample k of row r is at [r * count + k] in soa and [k * rows + r] in aos: an array has rows x
   count scalars, or, per batch, as many as it has rows. The caller sees to it that it is so long: a pointer does not tell. A
   scene (--fold, --free, --want, --fext of rneagen) makes other arrays than q, qd, qdd and tau; a text may have no inputs at
   all. */
struct rnea_argument {
	const char *name;        /* "q", "qd", "qdd", "tau", ... */
	size_t rows;             /* scalars per sample; at least 1 */
	enum rnea_scalar scalar; /* of its elements; an array must be aligned to it, no more */
	int per_batch;           /* 1: rows scalars for the whole batch, whatever the count; 0: rows for every sample */
	enum rnea_role role;     /* of tables of versions 1 and 2: those of q, qd, qdd and tau, and of the two halves' arrays */
	const char *of; /* the link, joint, constant or outputs that the role speaks of, as the URDF and the scene name
			   it; "": none */
};

/* One joint with entries in q. Units by type: revolute and continuous rad, prismatic m, floating m and a unit
   quaternion x y z w, planar m m rad. */
struct rnea_joint {
	const char *name; /* as the URDF has it */
	const char *type; /* "revolute", "continuous", "prismatic", "planar", "floating" */
	size_t iq, nq;    /* its rows of q: iq to iq + nq - 1 */
	size_t iv, nv;    /* its rows of qd, qdd and tau: iv to iv + nv - 1 */
};

/* Operations per sample, each use counted once; a fused multiply-add is one `fma`. */
struct rnea_operations {
	size_t mul, add, sub, neg, fma, sincos;
};

/* Where the elements of a matrix stand: element k, row k of its array, is of this row and this column, as
   scipy.sparse.coo_matrix has them. What is not stored is zero; but of a `lower` one, which is symmetric, only elements with
   row >= col are stored. */
struct rnea_matrix {
	size_t argument;   /* of the function's arguments: its array, whose `rows` are how many elements are stored */
	size_t rows, cols; /* a row for each torque */
	int lower;
	const int *row, *col;
};

/* A kernel for small batches with the parameters of the one whose place it takes: rnea_launch and rnea_run choose. A block is of
   32 warps groups threads with groups bytes of shared memory given, and does 32 groups samples; groups is from 1 to `groups`, 1
   for up to 32 samples. */
struct rnea_limbs {
	unsigned warps;  /* that share out each sample; 0: there is no such kernel, or it did not compile */
	unsigned groups;
	/* of a group of 32 samples; more than 48 KiB have to be asked for (CU_FUNC_ATTRIBUTE_MAX_DYNAMIC_SHARED_SIZE_BYTES) */
	size_t bytes;
	size_t most;     /* samples of a batch up to which it is faster */
	unsigned parts;  /* of its grid along y */
};

/* Of a function's arguments the one that is moved by so many rows at once. */
struct rnea_tile {
	unsigned argument, rows;
};
enum { RNEA_TILE_LIMIT = 28 };

/* One function of the text, by which rnea_launch_kernel launches it. A text without a scene has "rnea", tau = ID(q, qd, qdd),
   and its halves: "fpass", q, qd, qdd -> v, a, f, the twists, accelerations and wrenches of the bodies, 6 nb rows each; and
   "bpass", q, f -> tau. A text with inputs or outputs of a scene's has "rnea" alone. */
struct rnea_function {
	const char *name;
	const struct rnea_argument *arguments; /* the inputs, then the outputs: the order of its signature */
	size_t input_count, output_count;
	struct rnea_operations operations;  /* in tables of versions 1 and 2 those of the first function for all */
	const struct rnea_matrix *matrices; /* matrix_count of them */
	size_t matrix_count;
	unsigned parts;     /* of a CUDA grid, along y: each makes some elements of the matrices, or some rows; 1: all (--parts) */
	size_t stage_bytes; /* of shared memory in which its kernel stages each sample; 0: none. Where a block of them takes more
	                       than 48 KiB, and at most 227, launches have to give it: rnea_launch does; given less, it is slower */
	/* of a kernel in segments: what a sample keeps in the block's own 48 KiB of shared memory; else 0 */
	size_t across_bytes;
	unsigned most_samples; /* of such a kernel: samples that a thread takes at most, as far as they have room. A grid of any size is
				  right; the fewer blocks, the more samples each thread takes. 1 of all other kernels */
	struct rnea_limbs limbs; /* of the kernel NAME_FUNCTION_limbs */
	/* A relay: rnea_launch and rnea_run launch three kernels with the same parameters, one after the other. The function's
	   own, which may have limbs, is the second. The first is NAME_FUNCTION_start_kernel, in blocks as long as the second's.
	   The third is NAME_FUNCTION_solve_kernel: a block does relay_samples samples, has relay_threads threads for each, and
	   relay_bytes bytes of shared memory given; the blocks along y share its work, and any number of them is right; it is
	   fast where all blocks run at once. */
	unsigned relay_threads; /* 0: there is one kernel */
	unsigned relay_samples;
	unsigned relay_room;    /* blocks of the third, along x and y, beyond which more along y gained nothing on an H100 */
	size_t relay_bytes;
	unsigned start_parts; /* blocks of the first along y: a grid without as many stops with an error (a trap); else 1 */
	struct rnea_limbs start_limbs; /* of the kernel NAME_FUNCTION_start_limbs, which takes the place of the first; without a relay
					  it runs before NAME_FUNCTION_limbs, for as many samples */
	/* In layout aos: the kernels write the outputs of transposed_samples samples at a time as [row][sample], and after all
	   of them rnea_launch and rnea_run launch NAME_FUNCTION_transpose_kernel, which puts each in its place: a block for
	   transposed_samples samples, with transposed_threads threads, and transposed_bytes of shared memory given; one block
	   along y for each output. 0: there is none */
	unsigned transposed_samples, transposed_threads;
	size_t transposed_bytes;
	/* Several kernels with the same parameters, one after the other, where the batch is larger than limbs.most: before the
	   function's own rnea_launch and rnea_run launch NAME_FUNCTION_hands_kernel, then NAME_FUNCTION_hands1_kernel and so on,
	   in the same blocks with the same shared memory, and so many along y of each, unless part kernels run, the first of
	   which are of hands; 0: there is no such kernel, and none after it */
	unsigned hands[RNEA_HANDS_LIMIT];
	/* From so many samples on rnea_launch launches, instead of the kernel with all parts along y, NAME_FUNCTION_part0_kernel,
	   NAME_FUNCTION_part1_kernel and so on, part_count of them, in blocks of part_block threads, one along y, for as many
	   samples; 0: never, there are no such kernels, or they did not compile. The slices of rnea_run are smaller. Where there
	   are tiles, one parameter more comes last: a struct of as many tensor maps (CUtensorMap), of 2 dimensions, samples and
	   rows, with boxes of part_block samples and so many rows. From compute capability 9.0 on rows have to begin at multiples
	   of 16 bytes for that: else the other kernel runs */
	size_t part_kernels;
	unsigned part_arch; /* compute capability from which on they pay, ten times */
	unsigned part_count, part_block, tile_count;
	struct rnea_tile tiles[RNEA_TILE_LIMIT];
	/* Threads that share a sample in its kernel, if RNEA_BLOCK is most_block or less: a block is of sample_threads RNEA_BLOCK
	   threads then, for RNEA_BLOCK samples; others stop with an error (a trap). 1 of all other kernels, and of hands and parts */
	unsigned sample_threads, most_block;
};

/* The parsed table. Every pointer belongs to the robot that it was asked of and is valid until rnea_close. What stands here of
   one function is the first one's, the one that rnea_launch and rnea_run launch. */
struct rnea_info {
	const char *name; /* the identifier that prefixes the functions of the text */
	enum rnea_scalar precision; /* of numbers in memory */
	const char *arithmetic;     /* "f32", "f64" or "f32x2": what is computed with */
	enum rnea_layout layout;
	const char *trig; /* "accurate", "bounded" or "fast" */
	const char *base; /* "fixed" or "floating" */
	size_t nq, nv;    /* rows of q; rows of qd, qdd and tau */
	size_t nb;        /* moving bodies: v, a and f of the passes have 6 rows for each */
	unsigned block;   /* samples of a block, 1 to 1024: of the text, or of rnea_options; threads too, but see sample_threads */
	const struct rnea_argument *arguments; /* the inputs, then the outputs */
	size_t input_count, output_count;
	const struct rnea_joint *joints; /* joint_count of them, in the order of q; may be none */
	size_t joint_count;
	struct rnea_operations operations;
	void *memory; /* private */
	const struct rnea_matrix *matrices; /* matrix_count of them */
	size_t matrix_count;
	unsigned parts;
	size_t stage_bytes;
	int is_guessed; /* private: what stands here of functions but the first may not be in the text */
	const struct rnea_function *functions; /* function_count of them, at least 1 */
	size_t function_count;
	unsigned version; /* of the table: 1 to 7 */
};

/* ---- opening and closing ---- */

struct rnea_robot; /* one text, compiled and loaded on one backend; may be shared by threads once open */

enum rnea_backend {
	RNEA_BACKEND_ANY,  /* CUDA; HOST if the text is C (target c), or if there is no driver or no device */
	RNEA_BACKEND_CUDA, /* this or an error; takes CUDA texts only */
	RNEA_BACKEND_HOST, /* this or an error; takes CUDA and C texts */
	RNEA_BACKEND_EVALUATOR /* nothing is compiled: rnea_open_evaluator, and rnea_open_urdf, open it */
};

/* For rnea_options.block: the block size, of 64, 128 and 256, with the most samples resident on a multiprocessor. Not for texts
   with sample_threads, whose most_block is mostly 32. */
#define RNEA_BLOCK_OCCUPANCY 0xffffffffu

/* Zero-initialise for the defaults; strings need to live only as long as the call. */
struct rnea_options {
	enum rnea_backend backend;
	const char *file;    /* what messages call the text; NULL: its robot's name with ".cu", or the file's path */
	int device;          /* CUDA ordinal, as CUDA_VISIBLE_DEVICES leaves them; default 0. HOST: not used */
	unsigned block; /* samples per block, 1 to 1024, or RNEA_BLOCK_OCCUPANCY; 0: what the text says. Kernels of small and of
			   large batches have blocks of their own. HOST: not used */
	unsigned threads;    /* HOST: how many one launch may use; CUDA: rnea_run, of which it takes 8 at most. 0: one for
				each processor */
	const char *cache;   /* folder of the cache; NULL: as the environment says; "": no cache */
	const char *const *compile; /* further options for the compiler, compile_count of them */
	size_t compile_count;
	char *log;       /* receives the compiler's whole log, cut to log_size bytes with its final NUL; NULL: not wanted */
	size_t log_size;
	int (*stop)(void *context); /* HOST: asked with stop_context, some times a second and after signals, while the compiler runs or
				       another process compiles the same; not 0: the compiler is killed, error COMPILER. NULL: nobody */
	void *stop_context;
};

/* Compile `length` bytes at `source` (written by rneagen for target cuda or c; need not be NUL-terminated), or take what
   was compiled before from the cache, and load it.
   CUDA: for the device's own architecture, or as PTX where NVRTC is older than the device, into the device's primary
   context (the one that the CUDA runtime, PyTorch and CuPy use). A kernel that spills registers under the text's own
   launch bounds is compiled again without them, and the better of the two is kept. Not to be called while a stream is
   being captured: it runs each kernel once over no samples, so that later launches find everything in place.
   HOST: for this processor, with -O3 -march=native where the compiler has it.
   `options` may be NULL. On success *robot is to be released with rnea_close; on failure it is NULL.
   Errors: ARGUMENT (source, robot or options), TEXT, TABLE, NO_DRIVER, NO_DEVICE, NO_COMPILER, COMPILER, COMPILE (the
   message has the compiler's first error with its line), DRIVER, CONTEXT, DEVICE_MEMORY, MEMORY. */
enum rnea_code rnea_open(const char *source, size_t length, const struct rnea_options *options,
	struct rnea_robot **robot, struct rnea_error *error);

/* The same for the text in the file at `path`. Errors: as rnea_open, and READ. */
enum rnea_code rnea_open_file(
	const char *path, const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *error);

/* What computes samples where nothing can be compiled. Its context outlives the robot. */
struct rnea_evaluator {
	void *context;
	/* Samples `first` to `end` - 1 of a batch of `count`, on `arrays` as rnea_launch takes them. Called by several threads at
	   once. Returns 0 when memory runs out. */
	int (*evaluate)(void *context, void *const *arrays, size_t count, size_t first, size_t end);
	void (*close)(void *context); /* called by rnea_close; may be NULL */
};

/* Open a text without compiling it: its table says what its main function takes, `evaluator` computes it, and the robot has no
   other function. Of `options`, file and threads are used. On failure evaluator->close is not called. Errors: ARGUMENT, TEXT,
   TABLE, MEMORY. */
enum rnea_code rnea_open_evaluator(const char *source, size_t length, const struct rnea_evaluator *evaluator,
	const struct rnea_options *options, struct rnea_robot **robot, struct rnea_error *error);

/* How many CUDA devices there are for rnea_options.device; 0 and an error where there is none. Errors: NO_DRIVER, NO_DEVICE,
   DRIVER. */
int rnea_device_count(struct rnea_error *error);

/* Unload and free. The caller sees to it that no launch of this robot is still running or captured in a graph that will
   be replayed. NULL is a no-op. */
void rnea_close(struct rnea_robot *robot);

/* What the text says about itself; never NULL. Belongs to `robot`. */
const struct rnea_info *rnea_info(const struct rnea_robot *robot);

/* How the robot came to be. */
struct rnea_build {
	enum rnea_backend backend; /* CUDA, HOST or EVALUATOR */
	const char *device;   /* "NVIDIA H100 80GB HBM3", or the processor's architecture: "x86_64" */
	const char *compiler; /* what compiled it, with its version or path; "" if it came from the cache */
	const char *target;   /* "sm_90", "compute_90" (PTX, finished by the driver), "native" */
	const char *note;     /* why RNEA_BACKEND_ANY took the host: what was looked for and where; else "" */
	int cached;           /* 1: nothing had to be compiled */
	double seconds;       /* that rnea_open took */
	unsigned min_blocks;  /* CUDA: the launch bound the rnea kernel was compiled with; 0: none */
	unsigned threads;     /* HOST, EVALUATOR: the most that a launch uses; a small batch uses fewer */
	const char *unkept;   /* why the cache did not keep what was compiled: "FOLDER: Read-only file system"; else "" */
};

/* Never NULL. Belongs to `robot`. */
const struct rnea_build *rnea_build(const struct rnea_robot *robot);

/* ---- launching ---- */

/* Functions were an enumeration once: sources that name its members still compile, and launch the same. Variables of type
   enum rnea_kernel do not compile: make them const char *. */
#define RNEA_KERNEL_RNEA "rnea"
#define RNEA_KERNEL_FPASS "fpass"
#define RNEA_KERNEL_BPASS "bpass"

/* What the device's compiler made of a kernel; all 0 on the host. */
struct rnea_resources {
	int registers;        /* per thread */
	size_t local_bytes;   /* per thread: stack and spilled registers */
	size_t shared_bytes;  /* per block: the kernel's own, and what launches give */
	unsigned max_block;   /* threads per block that can be launched at all */
	unsigned busy_block;  /* threads per block that keep the most threads resident; 0: the driver does not say */
};

/* The index of the array `name` in the order of info->arguments, or -1 if there is none of that name. A scene's word,
   "payload.left hand", does for its array, payload_left_hand; but not where there is a payload_left_hand_2 as well, which
   may be of the same word: -1, ask by the array's name then. */
int rnea_bind(const struct rnea_robot *robot, const char *name);

/* The index of the array of a role in the order of `function`'s arguments, or -1 if there is none, or no such function. `of`
   names the link, joint or constant; NULL: whatever it is. Of several, the first. Where an input and an output have the role,
   the input. */
int rnea_bind_role(const struct rnea_robot *robot, const char *function, enum rnea_role role, const char *of);

/* How many arrays `function` takes; 0 if the text does not have it. */
size_t rnea_argument_count(const struct rnea_robot *robot, const char *function);

/* Fill *resources for `function`. Errors: KERNEL (the text does not have it; the message lists what it has). */
enum rnea_code rnea_resources(const struct rnea_robot *robot, const char *function, struct rnea_resources *resources,
	struct rnea_error *error);

/* tau = ID(q, qd, qdd), or what else the text computes, for `count` samples. `arguments` holds one pointer for each array
   of info->arguments. Arrays must not overlap, unless both are only read. May be called by several threads at once. A
   count of 0 is a no-op, whatever the arguments.
   CUDA: enqueued on `stream` (a CUstream or cudaStream_t of the robot's device; NULL: the default stream), on device
   pointers; the array of pointers may be reused as soon as the call returns, the memory that they point to when the
   stream has passed. Allocates nothing, synchronises nothing, may be captured into a CUDA graph. What goes wrong while
   the kernel runs is reported by the stream, as CUDA does.
   HOST: done when the call returns, on pointers of the program's own; `stream` must be NULL. A batch is shared among
   threads of the robot's own, one more for every 50 us of work, by the table's operations: the batches of a control loop
   stay in the caller's thread. The threads are started by the first batch that is worth them, sleep between launches
   without spinning, and end in rnea_close; afterwards a launch allocates nothing. Where processors are busy the caller
   does what no other thread has begun. A process forked from the one that opened the robot uses the caller's thread alone.
   Errors: ARGUMENT (arguments is NULL, a stream on the host), POINTER (names the array), LIMIT (more than (2^31 - 1)
   blocks of samples), DRIVER, CONTEXT. */
enum rnea_code rnea_launch(const struct rnea_robot *robot, void *const *arguments, size_t count, void *stream,
	struct rnea_error *error);

/* The same for any function of the text, "fpass" for one; `arguments` in the order of its struct rnea_function. Errors: also
   KERNEL. */
enum rnea_code rnea_launch_kernel(const struct rnea_robot *robot, const char *function, void *const *arguments,
	size_t count, void *stream, struct rnea_error *error);

/* The same as rnea_launch for arrays in the program's own memory, on either backend; done when the call returns. CUDA:
   slices of the batch go through page-locked buffers and several streams, so that copies in both directions overlap with
   each other and with the kernel; arrays that are page-locked already (cuMemAllocHost, cuMemHostRegister) are copied
   from and to directly. The buffers are made by the first call, kept until rnea_close and not shared: each thread that
   calls at the same time has its own. Other arrays are copied into the buffers by up to 8 threads of the robot's own. Not
   to be called while a stream is being captured. On failure the outputs are undefined. Errors: as rnea_launch, and
   DEVICE_MEMORY, MEMORY. */
enum rnea_code rnea_run(
	const struct rnea_robot *robot, void *const *arguments, size_t count, struct rnea_error *error);

/* The same on arrays [sample][row], whatever the text's layout. On the host a text of layout soa is some times as fast
   as one of aos, also with what turning the arrays takes, since compilers make vectors of its samples. Errors: as
   rnea_run, and ARGUMENT (a text of layout soa on CUDA or by the evaluator: generate it with --layout aos). */
enum rnea_code rnea_run_aos(
	const struct rnea_robot *robot, void *const *arguments, size_t count, struct rnea_error *error);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#if defined __cplusplus && defined __GNUC__ && !defined __clang__
#pragma GCC diagnostic pop
#endif
#ifdef __cplusplus
}
#endif
#endif
