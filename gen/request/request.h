#ifndef RNEAGEN_REQUEST_H
#define RNEAGEN_REQUEST_H
/* What the scene makes of inputs and outputs: rows that it gives, constants that it frees, forces from outside, terms of
   the joints' own, and the quantities that it asks for. */

#include "rneagen.h"
#include "request/want_type.h"
#include "scene/scene.h"
#include "tree/tree.h"

/* A row of q, qd, qdd or tau that the scene may give. */
struct row {
	int is_given;
	struct within value;
};

/* What a joint with one row in qd bears beside the links; a follower has its own, too. */
enum own_term { OWN_ARMATURE, OWN_DAMPING, OWN_FRICTION, OWN_TERMS };

/* The last ones are the joints' own terms, in their order. */
enum freed_kind { FREED_GRAVITY, FREED_MASS, FREED_INERTIA, FREED_PAYLOAD, FREED_OFFSET, FREED_ACCEL,
	FREED_OWN };
enum { FREED_KINDS = FREED_OWN + OWN_TERMS, FREED_ROWS = 10 };

/* A constant that becomes an input. Mass, inertia and payload are linear in the body's ten inertial parameters. */
struct freed {
	enum freed_kind kind;
	const char *word;     /* as the scene has it: "payload.hand" */
	const char *argument; /* as the text has it: "payload_hand" */
	int rows, per_batch;
	int body;                    /* that carries the link, or that the joint moves; -1: all joints, in rows of qd */
	int contact;                 /* FREED_ACCEL: which one has that acceleration */
	real *nominal;               /* by row: what the URDF says */
	struct inertia *columns;     /* in the body frame, what a unit of each row adds */
	struct inertia massless;        /* a link's inertia about its centre, which its mass does not change */
};

/* A wrench from outside on a link: force, then moment about the link's origin. */
struct push {
	const char *word;     /* "fext.foot" */
	const char *argument;
	int body;
	struct placement X; /* the link's frame in the body's */
};

/* What the scene says that rows of an input are drawn from. Levels: of a whole input, of a joint, of one row; the highest
   counts. */
enum { REQUEST_RANGE_LEVELS = 3 };

struct request_range {
	const char *argument; /* of the text */
	int first, count, level;
	double lower, upper;
};

/* A link that stands: the origin of its frame, 3 rows, or all of it, 6; linear, then angular. */
struct contact {
	const char *name; /* of the link or frame */
	int body;
	struct placement X; /* the frame in the body's */
	int rows, first;    /* of all contacts' rows the first that is its own */
};

struct want {
	enum want_kind kind;
	const char *word, *argument;
	int rows;
	int body; /* OF_FREED: the number of the freed constant; VJP_BY: of the input */
	struct placement X; /* OF_LINK: the frame in the body's */
};

/* A frame that the scene adds to a link. */
struct added_frame {
	const char *name;
	int link;
	struct placement X; /* in the link's */
};

/* [R p], three rows of four; or p, and a quaternion x y z w. */
enum pose_form { POSE_ROWS, POSE_QUATERNION };

/* In whose axes, and about which point, what moves is told: the link's axes and origin; the world's; the world's axes and the
   link's origin. */
enum want_frame { FRAME_LINK, FRAME_WORLD, FRAME_WORLD_ALIGNED };

/* A product of derivatives with vectors: of the wants that it is of, one after another. */
struct product {
	int *of, count;
	int rows;          /* of all of them */
	const char *words; /* by commas; "" where it is plain */
};

/* An input by which products are taken besides the state: what is freed, a wrench from outside. */
struct product_by {
	const char *word, *argument; /* "payload.hand", "payload_hand" */
	const char *direction;       /* the argument with its part of the direction: "jvp_v_payload_hand" */
	int rows, per_batch;
};

/* By differentiating the torques' expressions; by a recursion over composite bodies; by whichever takes less. */
enum derivatives { DERIVATIVES_CHEAPER, DERIVATIVES_FORWARD, DERIVATIVES_RECURSION };

/* M qdd = tau - bias by factors of M, by articulated bodies, or by whichever takes less. */
enum dynamics { DYNAMICS_CHEAPER, DYNAMICS_FACTOR, DYNAMICS_ARTICULATED };

struct eval_model;
/* What the residual of a step of refinement is computed in: the text's numbers, or numbers with more bits. */
enum refine { REFINE_SAME, REFINE_F64, REFINE_F32X2 };

struct request {
	int is_plain;               /* tau = ID(q, qd, qdd) and nothing else */
	const struct eval_model *arithmetic; /* of the text, of which a bound speaks */
	struct row *q, *qd, *qdd, *tau; /* nq, nv, nv and nv of them */
	struct freed *freed;
	int freed_count;
	struct push *pushes;
	int push_count, in_world;   /* wrenches in axes of the world, else of the link */
	struct contact *contacts;
	int contact_count, contact_rows; /* rows of all of them; their forces are found with qdd */
	struct want *wants;
	int want_count;
	int stored_count;           /* the first of them are outputs; the rest is made for products alone */
	struct product jvp, vjp;
	struct product_by *by;
	int by_count;
	struct added_frame *frames;
	int frame_count;
	enum pose_form pose;
	enum want_frame frame;      /* of jacobian, djacobian, opspace and contacts */
	struct request_range *ranges;
	int range_count;
	int dense;                  /* matrices have their zeros */
	int is_forward;             /* tau is an input, and qdd is found */
	int is_motion;              /* no output is or takes a force */
	enum dynamics dynamics;
	int refine_steps;           /* of the qdd found */
	enum refine refine;
	enum derivatives derivatives; /* how d tau/d q and d tau/d qd are made */
	struct within *own[OWN_TERMS]; /* by body; kg m^2 (kg), N m s (N s/m), N m (N) */
	struct within friction_width;         /* rad/s, m/s */
};

/* What a scene asks of the tree that was made for it; gravity that it folds goes into the tree. Errors: SCENE, LIMIT, MEMORY. */
enum rneagen_code request_resolve(struct request *k, struct tree *t, const struct scene *s, const struct robot *r,
	struct arena *a, struct rneagen_error *e);

/* What `refine` asks of a text of this precision, into a request that is resolved. Errors: SCENE. */
enum rneagen_code request_refine(
	struct request *k, const struct scene *s, enum rneagen_precision precision, struct rneagen_error *e);

/* "f64", "f32x2"; "same". */
const char *request_refine_name(enum refine refine);

void request_dump(const struct request *k, const struct tree *t, struct text *out);

/* What the scene says of a row of an input, by the narrowest name that covers it; NULL: nothing. */
const struct request_range *request_range_of(const struct request *k, const char *argument, int row);

/* Do ranges that the scene states keep every joint's angle within `most` of 0, what is added to it and followers' included?
   Limits of the URDF do not count. 0 where there is no angle. */
int request_bounds_angles(const struct request *k, const struct tree *t, double most);

/* Has every row its value? */
int request_has_all(const struct row *rows, int count);

/* The constant, or the wrench from outside, that is this input of the text; NULL: there is none. What the scene calls it, or else
   the input's own name. */
const struct freed *request_freed(const struct request *k, const char *argument);
const struct push *request_push(const struct request *k, const char *argument);
const char *request_input_word(const struct request *k, const char *argument);

/* What the scene calls an input or output of the text: "jvp_v.payload.hand" of jvp_v_payload_hand. */
void request_put_word(const struct request *k, const char *name, int is_output, struct text *out);

/* Is a quantity of this kind made, as an output or for a product; or any with one of these traits? */
int request_wants(const struct request *k, enum want_kind kind);
int request_wants_any(const struct request *k, unsigned traits);

/* Is it a matrix? Derivatives by what is free are not counted. */
int request_is_matrix(const struct request *k, const struct want *w);

struct pattern;

/* Which elements of a matrix are stored. Returns 0 when memory runs out. */
int request_pattern(struct pattern *p, const struct tree *t, const struct want *w, int dense, struct arena *a);

/* The same with nothing wanted but the qdd found, for which *qdd is the room. */
struct request request_of_accelerations(const struct request *k, struct want *qdd);

/* Is any derivative, M included? */
int request_wants_derivative(const struct request *k);

/* The contact whose force a want is. */
const struct contact *request_contact_of(const struct request *k, const struct want *w);

/* Is it of the torques alone, or of the qdd found, and by the state? */
int request_is_plain_product(const struct request *k, const struct product *p);

/* The error that a want which a product is of does not vary with what is not given. */
enum rneagen_code request_refuse_constant(const struct request *k, const struct scene *s, int want, struct rneagen_error *e);

#endif
