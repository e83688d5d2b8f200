#!/usr/bin/env python3
"""Computed torque control of an arm at 1 kHz, and the arm itself, in NumPy.

usage: computed_torque.py ROBOT.urdf

The controller follows q = amplitude (1 - cos t) with tau = ID(q, qd, wanted + gains); the arm is forward dynamics of
the same file, integrated by the semi-implicit Euler method, and holds a kilogram that the controller does not know.
Prints how far the arm was off.
"""
import sys

import numpy as np

import rneagen


def main(urdf, seconds=4.0, step=1e-3):
    model = rneagen.load(urdf)
    arm = rneagen.load(urdf, want="qdd", free=[f"payload.{model.joints[-1]['link']}:batch"])

    nv = model.nv
    q, qd, wanted, tau, qdd = (np.zeros(nv) for _ in range(5))
    load = np.zeros(10)
    load[0] = 1.0  # kg, at the last link's origin
    inverse = model.bind(q, qd, wanted, tau)  # checked once: the loop below only computes
    forward = arm.bind(q, qd, tau, load, qdd)

    amplitude, stiffness = 0.3, 400.0
    worst, moments = 0.0, np.arange(0, seconds, step)
    for t in moments:
        error = amplitude * (1 - np.cos(t)) - q
        wanted[:] = amplitude * np.cos(t) + 2 * stiffness ** 0.5 * (amplitude * np.sin(t) - qd) + stiffness * error
        inverse()
        forward()
        qd += step * qdd
        q += step * qd
        worst = np.maximum(worst, np.abs(error).max())  # which keeps what is no number
    print(f"{model.name}: {len(moments)} steps, off by {worst:.4f} rad at most, by {np.abs(error).max():.4f} rad at the end")
    return worst


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(int(not main(sys.argv[1]) <= 0.2))
