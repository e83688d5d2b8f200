#ifndef BENCH_KINEMATICS_PEER_H
#define BENCH_KINEMATICS_PEER_H
/* Pinocchio's functions at a q. Results stay in the peer until its next call. */
struct peer;

/* A model that Pinocchio wrote, and the number of the frame whose Jacobian is asked for; it ends with an exception
   where it cannot be read, and lives as long as the program. */
struct peer *peer_open(const char *path, int frame);

/* forwardKinematics, framesForwardKinematics, computeFrameJacobian (LOCAL), jacobianCenterOfMass, computeCentroidalMap */
void peer_poses(struct peer *p, const double *q);
void peer_frames(struct peer *p, const double *q);
void peer_jacobian(struct peer *p, const double *q);
void peer_com_jacobian(struct peer *p, const double *q);
void peer_momentum_matrix(struct peer *p, const double *q);

enum { POSES, FRAMES, JACOBIAN, COM_JACOBIAN, MOMENTUM_MATRIX, FUNCTIONS };

/* What the last call computed: row i, column j of [R p] of a joint, or a frame, or of the matrix. */
double peer_pose(const struct peer *p, int function, int number, int i, int j);
double peer_element(const struct peer *p, int function, int i, int j);

#endif
