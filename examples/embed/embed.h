#ifndef EMBED_H
#define EMBED_H
/* Trajectories as splines: SEGMENTS cubics for each of N joints, each cubic SECONDS long and looked at in STEPS
   moments. With t from the cubic's beginning, q = ((c3 t + c2) t + c1) t + c0; c_i of joint j in cubic s of trajectory
   k of `count` is coefficients[((s N + j) 4 + i) count + k], so that neighbouring threads read neighbouring words. */

#include <cstddef>
#include <vector>

constexpr int N = 7, SEGMENTS = 4, STEPS = 100, ROWS = SEGMENTS * N * 4;
constexpr float SECONDS = 0.4f, DT = SECONDS / STEPS;
#define EFFORTS 320, 320, 176, 176, 110, 40, 40 /* iiwa14.urdf: <limit effort>, N m */

/* `count` trajectories from rest to rest, some mild, some wild. */
std::vector<float> random_splines(size_t count);

/* The largest relative error of the costs, beside those by the C function in double precision. */
double worst_error(const std::vector<float> &coefficients, const std::vector<float> &costs);

#endif
