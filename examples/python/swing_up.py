#!/usr/bin/env python3
"""Swing up a pole on a cart with the least force: a trajectory optimised by CasADi and IPOPT, through inverse dynamics.

usage: swing_up.py ROBOT.urdf [STEPS]

The robot goes from rest with its last joint turned by pi to rest at q = 0 within 2 s. The last joint has no motor; the
force of the others stays below the effort that the URDF states. The unknowns are q, qd and qdd at the ends of equal steps,
between which accelerations are linear. IPOPT takes exact second derivatives: those of the torques come from the
generated text, so that nothing of the model is differentiated by CasADi. Prints what was found; then the robot is
simulated with these forces, by forward dynamics in NumPy.
"""
import sys

import casadi
import numpy as np

import rneagen
import rneagen.casadi

SECONDS = 2.0


def optimise(robot, steps):
    """(q, qd, qdd, tau), each (rows, steps + 1), and what IPOPT tells of its way."""
    h, effort = SECONDS / steps, robot.limits.effort.copy()
    effort[-1] = 0
    inverse = rneagen.casadi.function(robot).map(steps + 1)
    problem = casadi.Opti()
    q, qd, qdd = (problem.variable(robot.nv, steps + 1) for _ in range(3))
    tau = inverse(q, qd, qdd)
    a, b = qdd[:, :-1], qdd[:, 1:]
    problem.minimize(h * casadi.sumsqr(tau))
    problem.subject_to(q[:, 1:] == q[:, :-1] + h * qd[:, :-1] + h * h * (2 * a + b) / 6)
    problem.subject_to(qd[:, 1:] == qd[:, :-1] + h * (a + b) / 2)
    for i in range(robot.nv):
        problem.subject_to(problem.bounded(-effort[i], tau[i, :], effort[i]) if effort[i] else tau[i, :] == 0)
        if np.isfinite(robot.limits.lower[i]):
            problem.subject_to(problem.bounded(robot.limits.lower[i], q[i, :], robot.limits.upper[i]))
    start = np.zeros(robot.nv)
    start[-1] = np.pi
    for end, position in ((0, start), (-1, 0)):
        problem.subject_to(q[:, end] == position)
        problem.subject_to(qd[:, end] == 0)
    problem.set_initial(q, start[:, None] * np.linspace(1, 0, steps + 1))
    problem.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    solved = problem.solve()
    return [solved.value(x) for x in (q, qd, qdd, tau)], solved.stats()


def simulate(robot, q, qd, tau, steps, each=20):
    """Where the robot is in the end, by Runge and Kutta's method; tau (rows, steps + 1) is linear between steps."""
    forward, h = robot.want("qdd"), SECONDS / steps / each

    def rate(q, qd, t):
        force = np.array([np.interp(t * steps / SECONDS, np.arange(steps + 1), row) for row in tau])
        return qd, forward(q, qd, force)

    for k in range(steps * each):
        t = k * h
        v1, a1 = rate(q, qd, t)
        v2, a2 = rate(q + h / 2 * v1, qd + h / 2 * a1, t + h / 2)
        v3, a3 = rate(q + h / 2 * v2, qd + h / 2 * a2, t + h / 2)
        v4, a4 = rate(q + h * v3, qd + h * a3, t + h)
        q, qd = q + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), qd + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return q


def main(urdf, steps=400):
    robot = rneagen.load(urdf, damping=True)
    (q, qd, qdd, tau), told = optimise(robot, steps)
    end = simulate(robot, q[:, 0], qd[:, 0], tau, steps)
    off = float(np.abs(end - q[:, -1]).max())
    print(f"{robot.name}, {steps} steps: {told['return_status']} after {told['iter_count']} iterations; forces up to "
          f"{np.abs(tau).max():.1f} N, travel {np.ptp(q[0]):.2f} m; simulated it ends {off:.3f} off")
    return bool(told["success"]) and off < 0.1


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(int(not main(sys.argv[1], *map(int, sys.argv[2:]))))
