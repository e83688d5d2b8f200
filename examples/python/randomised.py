#!/usr/bin/env python3
"""Train a controller on many robots at once, no two of which are alike (domain randomisation), with PyTorch.

usage: randomised.py ROBOT.urdf [cpu|cuda]

Each sample of the batch is a robot of its own: what it holds, its rotors and the damping of its joints are inputs of the
text (free=), drawn for each. All go from rest to a posture. The controller knows none of these: it takes the torques of
the bare robot's inverse dynamics, for an acceleration that the gains of each joint make of the error, its integral and the
velocity, within the limits of effort. The gains are learned by the gradient of the error through the whole motion. Prints
the error by the gains that it starts from and by the learned ones, on robots that it was not trained on.
"""
import sys

import torch

import rneagen

STEP = 0.01  # s


class Robots:
    """So many of one URDF, at rest, each with constants of its own."""

    def __init__(self, urdf, count, seed, device):
        plain = rneagen.load(urdf)
        last = plain.joints[-1]["link"]
        self.bare = rneagen.load(urdf, armature=dict.fromkeys(plain.joint_names, 0.1))
        self.forward = rneagen.load(urdf, want="qdd", free=[f"payload.{last}:sample", "armature:sample", "damping:sample"])
        draw = torch.Generator().manual_seed(seed)

        def drawn(rows, low, high):
            return low + (high - low) * torch.rand(count, rows, dtype=torch.float64, generator=draw).to(device)

        mass, ahead, radius = drawn(1, 0.5, 3), drawn(1, 0, 0.1), 0.05  # kg, m, m: a ball before the link
        moment, zero = 0.4 * mass * radius ** 2, torch.zeros_like(mass)
        across = moment + mass * ahead ** 2  # Steiner
        self.payload = torch.cat([mass, zero, zero, mass * ahead, across, zero, zero, across, zero, moment], -1)
        self.armature, self.damping = drawn(self.bare.nv, 0.05, 0.2), drawn(self.bare.nv, 0, 1)  # kg m^2, N m s/rad
        self.start, self.goal = (torch.from_numpy(self.bare.random(count, seed=2 * seed + i).q).to(device) / 2 for i in (0, 1))
        self.effort = torch.tensor(self.bare.limits.effort, device=device)

    def error(self, gains, steps):
        """The mean square of what is left of the way, over the second half of the motion, rad^2."""
        stiffness, integral, rate = gains.exp()
        q, qd, total, errors = self.start, torch.zeros_like(self.start), torch.zeros_like(self.start), []
        for k in range(steps):
            error = self.goal - q
            total = total + STEP * error
            tau = self.bare(q, qd, stiffness * error + integral * total - rate * qd)
            tau = self.effort * torch.tanh(tau / self.effort)
            qd = qd + STEP * self.forward(q, qd, tau, self.payload, self.armature, self.damping)
            q = q + STEP * qd
            errors += [error.square().mean()] if k >= steps // 2 else []
        return torch.stack(errors).mean()


def main(urdf, device="cpu", rounds=60, count=64, steps=150):
    train, test = (Robots(urdf, count, seed, device) for seed in (1, 2))
    nv = train.damping.shape[-1]
    gains = torch.tensor([[30.0], [10.0], [10.0]], dtype=torch.float64, device=device).log().repeat(1, nv).requires_grad_()
    optimiser = torch.optim.Adam([gains], lr=0.05)
    with torch.no_grad():
        before = test.error(gains, steps).sqrt().item()
    for _ in range(rounds):
        optimiser.zero_grad()
        train.error(gains, steps).log().backward()
        torch.nn.utils.clip_grad_norm_([gains], 1)
        optimiser.step()
    with torch.no_grad():
        after = test.error(gains, steps).sqrt().item()
    print(f"{train.bare.name} on {device}, {count} robots, {steps * STEP:.1f} s: error {before:.4f} rad before, "
          f"{after:.4f} after {rounds} rounds")
    return before, after


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    before, after = main(*sys.argv[1:])
    sys.exit(int(not after < before / 2))
