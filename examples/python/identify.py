#!/usr/bin/env python3
"""Masses, centres and inertias of an arm from measured torques, by least squares on the regressor: tau = Y pi.

usage: identify.py ROBOT.urdf

The arm that is measured is another than its URDF says: each link's mass, and its inertia with it, is up to 30 % off. Its
torques, with noise, are made from a URDF of that arm. What is found is held against that arm, and predicts the torques of a
motion that was not used. Exit status 1: it does not. A robot with a joint that floats is refused: on legs, say, unknown forces
of the ground are part of its torques.
"""
import re
import sys
import tempfile
from pathlib import Path

import numpy as np

import rneagen

SEED, SAMPLES, NOISE = 7, 1000, 0.05  # of a motion of 10 s; N m
SYMBOLS = "m hx hy hz Ixx Ixy Ixz Iyy Iyz Izz".split()


def draw_motion(rng, nv):
    """q, qd, qdd of each joint as five sines with a period of 10 s, up to 1.2 rad."""
    t, w = np.arange(SAMPLES)[:, None] * 10 / SAMPLES, 2 * np.pi / 10 * np.arange(1, 6)[:, None, None]
    size, phase = rng.uniform(0.2, 1, (5, 1, nv)), rng.uniform(0, 2 * np.pi, (5, 1, nv))
    size *= 1.2 / size.sum(0)
    angle = w * t + phase
    return {"q": (size * np.sin(angle)).sum(0), "qd": (w * size * np.cos(angle)).sum(0),
            "qdd": (-w * w * size * np.sin(angle)).sum(0)}


def along(robot, motion):
    """What the robot computes, of the inputs that it takes: where all joints slide, torques depend on qdd alone."""
    return robot(**{array.name: motion[array.name] for array in robot.inputs})


def another_arm(rng, urdf):
    """The URDF with other masses: what is measured."""
    def change(inertial):
        scale = rng.uniform(0.7, 1.3)
        return re.sub(r'\b(mass\s+value|i[xyz][xyz])(\s*=\s*")([^"]+)"',
                      lambda m: f'{m[1]}{m[2]}{float(m[3]) * scale!r}"', inertial[0])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / Path(urdf).name
        path.write_text(re.sub(r"<inertial>.*?</inertial>", change, Path(urdf).read_text(), flags=re.S))
        return rneagen.load(path)


def base_columns(Y):
    """Columns of Y that do not follow from those before them, and P with Y = Y[:, columns] P: torques tell no more of pi than
    P pi, each number of which is pi's of its column and sums of later ones (Gautier, Numerical calculation of the base inertial
    parameters of robots, 1991)."""
    Q, columns = np.empty((len(Y), 0)), []
    for j, column in enumerate(Y.T):
        rest = column - Q @ (Q.T @ column)
        rest -= Q @ (Q.T @ rest)
        if np.linalg.norm(rest) > 1e-8 * np.linalg.norm(Y, axis=0).max():
            columns.append(j)
            Q = np.column_stack([Q, rest / np.linalg.norm(rest)])
    return columns, np.linalg.lstsq(Y[:, columns], Y, rcond=None)[0]


def main(urdf):
    rng = np.random.default_rng(SEED)
    model, arm = rneagen.load(urdf), another_arm(rng, urdf)
    if model.nq != model.nv:
        sys.exit(f"{model.name}: a joint floats: this program is for robots on a base that stands")
    stated, true, regressor = model.inertial_parameters, arm.inertial_parameters, model.want("regressor")
    bodies = regressor.info["inertial_parameters"]["bodies"]  # those of followers too, which model.joints has not
    names = [f"{symbol} of {body['link']}" for body in bodies for symbol in SYMBOLS]
    fitted, other = draw_motion(rng, model.nv), draw_motion(rng, model.nv)
    torques, unseen = (along(arm, motion).ravel() + rng.normal(0, NOISE, SAMPLES * model.nv) for motion in (fitted, other))

    Y = along(regressor, fitted).reshape(-1, len(stated))  # [sample][nv][10 nb], samples below one another
    columns, P = base_columns(Y)
    found = np.linalg.lstsq(Y[:, columns], torques, rcond=None)[0]
    deviation = NOISE * np.sqrt(np.diag(np.linalg.inv(Y[:, columns].T @ Y[:, columns])))
    off = np.sqrt(np.mean(((found - P @ true) / deviation)**2))
    print(f"{len(columns)} of {len(stated)} parameters, or sums of them, move the torques; "
          f"condition {np.linalg.cond(Y[:, columns]):.0f}")
    print(f"{'':24}{'URDF':>10}{'found':>10}{'true':>10}  standard deviation")
    for i in np.argsort(-np.abs(P @ stated) / deviation)[:8]:
        print(f"{names[columns[i]]:24}{(P @ stated)[i]:10.4f}{found[i]:10.4f}{(P @ true)[i]:10.4f}{deviation[i]:10.4f}")

    Y = along(regressor, other).reshape(-1, len(stated))
    before, after = (np.sqrt(np.mean((torque - unseen)**2)) for torque in (Y @ stated, Y[:, columns] @ found))
    print(f"off by {off:.2f} standard deviations (rms). Torques of another motion are predicted within "
          f"{before:.2f} N m by the URDF, {after:.3f} by what was found; the noise is {NOISE}")
    return off < 1.5 and after < 1.1 * NOISE < 0.5 * before


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(int(not main(sys.argv[1])))
