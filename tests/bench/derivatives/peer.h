#ifndef BENCH_PEER_H
#define BENCH_PEER_H
/* Pinocchio's functions, for a program in C. Results stay in the peer until its next call. */

#ifdef __cplusplus
extern "C" {
#endif

struct peer;

enum peer_result { PEER_TAU, PEER_DQ, PEER_DQD, PEER_M };

/* A model that Pinocchio wrote as a binary archive. NULL if it cannot be read, with a line on standard error; the caller
   gives the result to peer_close. */
struct peer *peer_open(const char *path);
void peer_close(struct peer *p);
int peer_nq(const struct peer *p);
int peer_nv(const struct peer *p);
const char *peer_version(void);

void peer_rnea(struct peer *p, const double *q, const double *qd, const double *qdd);
/* The upper triangle of M, by crba with the convention that is the faster, LOCAL or WORLD. */
void peer_crba_local(struct peer *p, const double *q);
void peer_crba_world(struct peer *p, const double *q);
/* computeRNEADerivatives: tau, d tau/d q, d tau/d qd and the upper triangle of M. */
void peer_derivatives(struct peer *p, const double *q, const double *qd, const double *qdd);

/* An element of what the last call computed; of tau, j is 0. */
double peer_element(const struct peer *p, enum peer_result result, int i, int j);

#ifdef __cplusplus
}
#endif
#endif
