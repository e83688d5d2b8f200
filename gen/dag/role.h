#ifndef RNEAGEN_ROLE_H
#define RNEAGEN_ROLE_H
/* What an array of a generated function means. The words stand in the table NAME_info, by which a program finds its arrays, and
   are those of RNEA_ROLES in the runtime's rnea.h; a new one goes there too, or programs take it for an unknown one. */

/* How many rows a role's array has, and what they are called: in "fext_hand_fx", "f" and "x" of force and moment. */
enum role_rows {
	ROWS_ANY,     /* numbered */
	ROWS_NQ,      /* a joint's position, by joint */
	ROWS_NV,      /* a joint's velocity, by joint */
	ROWS_BODIES,  /* 6 of each body */
	ROWS_VECTOR,  /* 3: x y z */
	ROWS_WRENCH,  /* 6: fx fy fz nx ny nz */
	ROWS_INERTIA, /* 10: m, m c, I about the frame's origin */
};

/* role, word, rows */
#define ROLES(X)                                                                                                       \
	X(UNKNOWN, "unknown", ROWS_ANY)                                                                                \
	X(JOINT_POSITION, "joint_position", ROWS_NQ)                                                                   \
	X(JOINT_VELOCITY, "joint_velocity", ROWS_NV)                                                                   \
	X(JOINT_ACCELERATION, "joint_acceleration", ROWS_NV)                                                           \
	X(JOINT_TORQUE, "joint_torque", ROWS_NV)                                                                       \
	X(GRAVITY_TORQUE, "gravity_torque", ROWS_NV)                                                                   \
	X(BIAS_TORQUE, "bias_torque", ROWS_NV)                                                                         \
	X(GRAVITY, "gravity", ROWS_VECTOR)                                                                             \
	X(LINK_WRENCH, "link_wrench", ROWS_WRENCH)                                                                     \
	X(LINK_MASS, "link_mass", ROWS_ANY)                                                                            \
	X(LINK_INERTIA, "link_inertia", ROWS_INERTIA)                                                                  \
	X(LINK_PAYLOAD, "link_payload", ROWS_INERTIA)                                                                  \
	X(JOINT_OFFSET, "joint_offset", ROWS_ANY)                                                                      \
	X(JOINT_ARMATURE, "joint_armature", ROWS_ANY)                                                                  \
	X(JOINT_DAMPING, "joint_damping", ROWS_ANY)                                                                    \
	X(JOINT_FRICTION, "joint_friction", ROWS_ANY)                                                                  \
	X(ARMATURE, "armature", ROWS_NV)                                                                               \
	X(DAMPING, "damping", ROWS_NV)                                                                                 \
	X(FRICTION, "friction", ROWS_NV)                                                                               \
	X(JOINT_WRENCH, "joint_wrench", ROWS_WRENCH)                                                                   \
	X(LINK_TWIST, "link_twist", ROWS_WRENCH)                                                                       \
	X(LINK_ACCELERATION, "link_acceleration", ROWS_WRENCH)                                                         \
	X(BODY_TWISTS, "body_twists", ROWS_BODIES)                                                                     \
	X(BODY_ACCELERATIONS, "body_accelerations", ROWS_BODIES)                                                       \
	X(BODY_WRENCHES, "body_wrenches", ROWS_BODIES)                                                                 \
	X(POWER, "power", ROWS_ANY)                                                                                    \
	X(KINETIC_ENERGY, "kinetic_energy", ROWS_ANY)                                                                  \
	X(POTENTIAL_ENERGY, "potential_energy", ROWS_ANY)                                                              \
	X(MASS_MATRIX, "mass_matrix", ROWS_ANY)                                                                        \
	X(DTAU_DQ, "dtau_dq", ROWS_ANY)                                                                                \
	X(DTAU_DQD, "dtau_dqd", ROWS_ANY)                                                                              \
	X(DTAU_DFREED, "dtau_dfreed", ROWS_ANY)                                                                        \
	X(TANGENT, "tangent", ROWS_ANY)                                                                                \
	X(COTANGENT, "cotangent", ROWS_ANY)                                                                            \
	X(JVP, "jvp", ROWS_ANY)                                                                                        \
	X(VJP, "vjp", ROWS_ANY)                                                                                        \
	X(MASS_MATRIX_INVERSE, "mass_matrix_inverse", ROWS_ANY)                                                        \
	X(DQDD_DQ, "dqdd_dq", ROWS_ANY)                                                                                \
	X(DQDD_DQD, "dqdd_dqd", ROWS_ANY)                                                                              \
	X(DQDD_DFREED, "dqdd_dfreed", ROWS_ANY)                                                                        \
	X(JOINT_ACCELERATION_BOUND, "joint_acceleration_bound", ROWS_NV)                                               \
	X(REGRESSOR, "regressor", ROWS_ANY)                                                                            \
	X(LINK_POSE, "link_pose", ROWS_ANY)                                                                            \
	X(LINK_JACOBIAN, "link_jacobian", ROWS_ANY)                                                                    \
	X(LINK_JACOBIAN_RATE, "link_jacobian_rate", ROWS_WRENCH)                                                       \
	X(CENTER_OF_MASS, "center_of_mass", ROWS_VECTOR)                                                               \
	X(CENTER_OF_MASS_VELOCITY, "center_of_mass_velocity", ROWS_VECTOR)                                             \
	X(CENTER_OF_MASS_JACOBIAN, "center_of_mass_jacobian", ROWS_ANY)                                                \
	X(MOMENTUM, "momentum", ROWS_WRENCH)                                                                           \
	X(MOMENTUM_MATRIX, "momentum_matrix", ROWS_ANY)                                                                \
	X(MOMENTUM_RATE, "momentum_rate", ROWS_WRENCH)                                                                 \
	X(CORIOLIS, "coriolis", ROWS_ANY)                                                                              \
	X(OPSPACE_INERTIA_INVERSE, "opspace_inertia_inverse", ROWS_ANY)                                                \
	X(OPSPACE_INERTIA, "opspace_inertia", ROWS_ANY)                                                                \
	X(CONTACT_ACCELERATION, "contact_acceleration", ROWS_ANY)                                                      \
	X(CONTACT_FORCE, "contact_force", ROWS_VECTOR)                                                                 \
	X(CONTACT_WRENCH, "contact_wrench", ROWS_WRENCH)

enum role {
#define ROLE_ENUM(role, word, rows) ROLE_##role,
	ROLES(ROLE_ENUM)
#undef ROLE_ENUM
	ROLE_COUNT
};

const char *role_word(enum role role);
enum role_rows role_rows(enum role role);

#endif
