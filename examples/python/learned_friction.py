#!/usr/bin/env python3
"""Learn what a model lacks: a small network of PyTorch is trained through inverse dynamics.

usage: learned_friction.py ROBOT.urdf [cpu|cuda]

"Measured" torques come from a robot with viscous and dry friction, and with a payload. The model knows neither. The
network gives each joint's friction from its velocity; the payload's ten numbers are learned beside it. The loss is
the error of the torques, and its gradient goes through rneagen's text. Prints the error of the torques before and
after, on states that it was not trained on.
"""
import sys

import torch

import rneagen


def measured(robot, payload, count, seed):
    """States, and the torques that were measured there."""
    q, qd, qdd = (torch.from_numpy(x).to(payload.device) for x in robot.random(count, seed=seed)[:3])
    return q, qd, qdd, robot(q, qd, qdd, payload) + 0.6 * qd + 1.5 * torch.tanh(qd / 0.1)


def main(urdf, device="cpu", steps=300):
    torch.manual_seed(1)
    last = rneagen.load(urdf).joints[-1]["link"]
    robot = rneagen.load(urdf, free=[f"payload.{last}:batch"])  # one payload for all samples: an input of ten numbers
    # 2 kg, 5 cm before the link
    held = torch.tensor([2.0, 0, 0, 0.1, 0.03, 0, 0, 0.03, 0, 0.01], dtype=torch.float64, device=device)
    train, test = measured(robot, held, 300, 1), measured(robot, held, 300, 2)

    friction = torch.nn.Sequential(torch.nn.Linear(1, 16), torch.nn.Tanh(), torch.nn.Linear(16, 1)).double().to(device)
    payload = torch.zeros(10, dtype=torch.float64, device=device, requires_grad=True)
    optimiser = torch.optim.Adam([*friction.parameters(), payload], lr=0.03)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, steps)

    def error(q, qd, qdd, right):
        tau = robot(q, qd, qdd, payload) + friction(qd.unsqueeze(-1)).squeeze(-1)
        return (tau - right).square().mean() / right.square().mean()

    with torch.no_grad():
        before = error(*test).sqrt().item()
    for _ in range(steps):
        optimiser.zero_grad()
        error(*train).backward()
        optimiser.step()
        schedule.step()
    with torch.no_grad():
        after = error(*test).sqrt().item()
    print(f"{robot.name} on {device}: error of the torques {before:.4f} before, {after:.4f} after {steps} steps; "
          f"the mass it holds: {payload[0].item():.2f} kg of {held[0].item():.2f}")
    return before, after


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    before, after = main(*sys.argv[1:])
    sys.exit(int(not after < before / 5))
