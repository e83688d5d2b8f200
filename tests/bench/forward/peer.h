#ifndef BENCH_FORWARD_PEER_H
#define BENCH_FORWARD_PEER_H
/* Pinocchio's functions at a state, q, qd and tau one after the other. Results stay in the peer until its next call. */
struct peer;

/* A model that Pinocchio wrote; it ends with an exception where it cannot be read, and lives as long as the program. */
struct peer *peer_open(const char *path);

void peer_aba(struct peer *p, const double *q, int world);
void peer_derivatives(struct peer *p, const double *q);

/* What the last call computed: qdd; its derivative by q, or by qd. */
double peer_qdd(const struct peer *p, int i);
double peer_by(const struct peer *p, int qd, int i, int j);

#endif
