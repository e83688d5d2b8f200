#!/usr/bin/env python3
"""How a robot with legs accelerates while its feet stand, and what the ground gives: a batch of states in NumPy.

usage: stance.py ROBOT.urdf FOOT...

One text finds both: contact= names the links whose origins do not accelerate, and contact.FOOT is the force on each, in the
world's axes. Forces may pull here, and feet do not slip: that is for a simulator to decide. Two other texts check it: the feet
have no acceleration, and inverse dynamics with these forces from outside gives the torques back; exit status 1: it is not so.
"""
import sys

import numpy as np

import rneagen

SAMPLES, SEED = 1000, 3


class Stance:
    """A robot whose feet, links, are held in their places, not in their orientation."""

    def __init__(self, urdf, feet):
        self.robot = rneagen.load(urdf, base="floating", contact=feet, frame="world-aligned",
                                  want=["qdd", *(f"contact.{foot}" for foot in feet)])
        self.free = rneagen.load(urdf, base="floating", want="qdd")
        self.motion = rneagen.load(urdf, base="floating", want=[f"{what}.{foot}" for what in ("accel", "twist") for foot in feet])
        self.inverse = rneagen.load(urdf, base="floating", fext=feet, fext_frame="world")
        self.feet = len(feet)

    def accelerate(self, q, qd, tau):
        """qdd, and the ground's force on each foot in the world's axes, (..., feet, 3), N."""
        qdd, *forces = self.robot(q, qd, tau)
        return qdd, np.stack(forces, -2)

    def feet_acceleration(self, q, qd, qdd):
        """Of each foot, (..., feet, 3), m/s^2, in its axes, by the tour out from the base: a + w x v of its spatial acceleration
        (a, dw) and twist (v, w)."""
        made = self.motion(q, qd, qdd)
        pairs = zip(made[:self.feet], made[self.feet:])
        return np.stack([a[..., :3] + np.cross(twist[..., 3:], twist[..., :3]) for a, twist in pairs], -2)

    def torques(self, q, qd, qdd, force):
        """What moves so, with these forces."""
        wrenches = np.concatenate([force, np.zeros_like(force)], -1)
        return self.inverse(q, qd, qdd, *(np.ascontiguousarray(wrenches[..., i, :]) for i in range(self.feet)))


def main(urdf, *feet):
    stance = Stance(urdf, list(feet))
    q, qd, tau = stance.robot.random(SAMPLES, seed=SEED)
    tau[:, :6] = 0  # nothing drives the base
    qdd, force = stance.accelerate(q, qd, tau)
    error = np.linalg.norm(stance.torques(q, qd, qdd, force) - tau, axis=-1) / np.linalg.norm(tau, axis=-1)
    moves, moved = (np.linalg.norm(stance.feet_acceleration(q, qd, x), axis=-1) for x in (qdd, stance.free(q, qd, tau)))
    rest = (moves / moved).max()
    print(f"{stance.robot.name}, {len(feet)} feet, {SAMPLES} states: of its acceleration without ground a foot keeps {rest:.1e} "
          f"at most; inverse dynamics gives the torques back to within {error.max():.1e}")
    return max(rest, error.max())


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(int(not main(*sys.argv[1:]) < 1e-6))
