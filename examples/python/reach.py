#!/usr/bin/env python3
"""Find a motion that an arm's motors can make: a trajectory is optimised through inverse dynamics, by jax.grad.

usage: reach.py ROBOT.urdf [STEPS]

The arm holds 6 kg and goes from one posture to another in 0.8 s, through a third one on its way; its motors give half
the effort that the URDF states. The straight path between the postures asks for more. The unknowns are coefficients
of polynomials that are added to it and are at rest at both ends. The cost is the mean square of the torques, each as
a share of what its motor gives; shares above 1, and the distance from the posture in between, are penalties. All
samples of the path are one call, and the gradient is one more. Prints the cost, the largest share and the distance,
before and after, at four times as many samples as were optimised.
"""
import sys

import jax
import jax.numpy as jnp
import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

import rneagen

jax.config.update("jax_enable_x64", True)
SECONDS, SAMPLES, SHAPES = 0.8, 61, 6


def derivatives(polynomials, count):
    """At `count` times of the path: values, first and second derivatives, (3, count, polynomials)."""
    t = np.linspace(0, 1, count)
    return np.stack([np.stack([(p.deriv(k) if k else p)(t) / SECONDS ** k for p in polynomials], -1) for k in range(3)])


def shapes(count):
    """The straight path's way from 0 to 1, and what may be added to it: (3, count, 1), (3, count, SHAPES)."""
    bump = Polynomial([0, 1, -1]) ** 3  # it and two derivatives are zero at both ends
    more = [bump * Chebyshev.basis(k, [0, 1]).convert(kind=Polynomial) for k in range(SHAPES)]
    even = np.linalg.inv(np.linalg.qr(derivatives(more, 501)[2])[1]) * 501 ** 0.5  # a coefficient of 1: 1 rad/s^2, no two alike
    return derivatives([Polynomial([0, 0, 0, 10, -15, 6])], count), derivatives(more, count) @ even


def main(urdf, steps=400):
    last = rneagen.load(urdf).joints[-1]["link"]
    robot = rneagen.load(urdf, free=[f"payload.{last}:batch"])
    held = np.array([6.0, 0, 0, 0.6, 0.08, 0, 0, 0.08, 0, 0.02])  # kg, kg m, kg m^2: 10 cm before the link
    most = 0.5 * robot.limits.effort
    start = 0.9 * (-1.0) ** np.arange(robot.nq)
    start, goal, between = start, -start, 0.3 * np.cos(np.arange(robot.nq))

    def path(added, count):
        way, more = shapes(count)
        return tuple(more[k] @ added + (start if k == 0 else 0) + way[k] * (goal - start) for k in range(3))

    def cost(added, count=SAMPLES):
        q, qd, qdd = path(added, count)
        share = robot(q, qd, qdd, held) / most
        above = jnp.maximum(jnp.abs(share) - 0.95, 0)
        return (share ** 2).mean() + 1000 * (above ** 2).mean() + 100 * ((q[count // 2] - between) ** 2).sum()

    def told(added):
        q, qd, qdd = path(np.asarray(added), 4 * SAMPLES + 1)  # arrays of NumPy: the same robot, without JAX
        share = np.abs(robot(q, qd, qdd, held) / most).max()
        return float(cost(added, len(q))), float(share), float(np.abs(q[len(q) // 2] - between).max())

    @jax.jit
    def optimise(added):
        """Adam."""
        def step(state, k):
            added, mean, square = state
            g = jax.grad(cost)(added)
            mean, square = 0.9 * mean + 0.1 * g, 0.99 * square + 0.01 * g * g
            rate = 2 * (1 - k / steps) / (1 - 0.9 ** (k + 1))
            return (added - rate * mean / (jnp.sqrt(square / (1 - 0.99 ** (k + 1))) + 1e-9), mean, square), None
        return jax.lax.scan(step, (added, 0 * added, 0 * added), jnp.arange(steps))[0][0]

    nothing = jnp.zeros((SHAPES, robot.nq))
    before, after = told(nothing), told(optimise(nothing))
    for when, (value, share, off) in (("before", before), (f"after {steps} steps", after)):
        print(f"{robot.name}, {when}: cost {value:.3f}; torques up to {share:.2f} of what the motors give; "
              f"{off:.3f} rad off in between")
    return before, after


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    before, after = main(sys.argv[1], *map(int, sys.argv[2:]))
    sys.exit(int(not (after[0] < before[0] / 20 and after[1] <= 1 < before[1] and after[2] < 0.02)))
