"""Gradients of a robot's outputs in PyTorch. They are made by another text of the same scene, which is a robot too: so a gradient has an
operator, a rule for vmap and a compiled text of its own.

With w the gradients of the loss by the outputs, one after another, that text's output vjp is w' d outputs/d(q, qd, qdd), or by tau in
place of qdd where that is found; of what is free and of wrenches, where gradients by these are needed, it has an output each.
"""
from __future__ import annotations

import re
from typing import Any, Sequence

import torch
from torch import Tensor

from . import _robot
from ._errors import RobotError

PARTS = {"joint_position": 0, "joint_velocity": 1, "joint_acceleration": 2, "joint_torque": 2}  # of vjp
REFUSED = {"vjp": "second derivatives: it is a derivative", "jvp": "second derivatives: it is a derivative",
           "joint_acceleration_bound": "it is a bound"}  # by role


class Gradients:
    """What register_autograd takes, of one robot."""

    def __init__(self, robot, function_for: Any):
        self.robot, self.function_for = robot, function_for
        self.is_forward = any(a.role == "joint_torque" for a in robot.inputs)
        self.floating = [joint for joint in robot.joints if joint["nq"] != joint["nv"]]
        self.made: dict[tuple, Any] = {}  # robots of gradients, by what they are of and by

    def keep(self, ctx, inputs: tuple, output: Any) -> None:
        ctx.set_materialize_grads(False)
        ctx.save_for_backward(*inputs)

    def backward(self, ctx, *grads: Tensor | None) -> tuple[Tensor | None, ...]:
        inputs = self.robot.inputs
        of = [(a, w) for a, w in zip(self.robot.outputs, grads) if w is not None]
        needed = [a for a, need in zip(inputs, ctx.needs_input_grad) if need]
        if not of or not needed:
            return (None,) * len(inputs)
        named = {a.name: x for a, x in zip(inputs, ctx.saved_tensors)}
        found = self.products(of, [a.word for a in needed if a.role not in PARTS], named)
        return tuple(self.pick(a, found, named) if a in needed else None for a in inputs)

    # ---- the robots ----

    def products(self, of: Sequence[tuple], by: list[str], named: dict[str, Tensor | None]) -> dict[str, Tensor]:
        """vjp of these outputs with these weights, and what it is by other inputs: by word."""
        for a, _ in of:
            if a.role in REFUSED:
                raise NotImplementedError(f"{self.robot.name}: {a.word} has no gradient: {REFUSED[a.role]}")
        robot, words = self.make(tuple(a.word for a, _ in of), tuple(by))
        a, w = of[0]
        lead = w.shape[:w.dim() - len(a.shape)]
        weights = {a.word: w.reshape(*lead, a.rows) for a, w in of}
        if "qdd" in words and "qdd" not in weights:
            weights["qdd"] = w.new_zeros((*lead, self.robot.nv))
        if robot is None:
            return {"vjp": w.new_zeros((*lead, 3 * self.robot.nv))}
        return self.run(robot, {**named, "vjp_v": torch.cat([weights[word] for word in words], -1)}, lead, w)

    def make(self, of: tuple[str, ...], by: tuple[str, ...]):
        """The robot of these products, made once, and the words of what it is of. An output that the scene has made constant is left
        out: None where nothing is left."""
        if (of, by) not in self.made:
            words = [*of, "qdd"] if self.is_forward and "qdd" not in of else [*of]  # else tau would be no input
            robot = None
            while words and robot is None:
                try:
                    robot = self.robot._with(want=None, jvp=None, vjp=words, by=list(by) or None, sparse=None)
                except RobotError as error:
                    constant = re.search("'(.*)' does not vary", str(error))
                    if not constant:
                        raise
                    words.remove(constant[1])
            self.made[of, by] = robot, words
        return self.made[of, by]

    def run(self, robot, named: dict[str, Tensor | None], lead: torch.Size, like: Tensor) -> dict[str, Tensor]:
        """Its outputs by word, from inputs by name; what is not there is 0."""
        tensors = [named[a.name] if a.name in named else like.new_zeros((*lead, *a.shape)) for a in robot.inputs]
        made = self.function_for(robot, tensors, False)(*tensors)
        return {robot.outputs[0].word: made} if len(robot.outputs) == 1 else dict(zip((a.word for a in robot.outputs), made))

    def pick(self, array, found: dict[str, Tensor], named: dict[str, Tensor | None]) -> Tensor | None:
        """The gradient by one input."""
        nv = self.robot.nv
        if array.role in PARTS:
            part = found["vjp"].narrow(-1, PARTS[array.role] * nv, nv)
            return self.of_position(named[array.name], part) if array.role == "joint_position" and self.floating else part
        product = found.get(f"vjp.{array.word}")
        if product is None:
            return None
        return product.sum(tuple(range(product.dim() - 1))) if array.per_batch else product

    # ---- quaternions ----

    def of_position(self, q: Tensor, part: Tensor) -> Tensor:
        """From the tangent space to the numbers of q: a floating joint's position p and quaternion u = (v, s) move by R a and
        u (b, 0)/2 with a twist (a, b), whose transposed inverses are R and 2 u (b, 0)/|u|^2."""
        pieces, at = [], 0
        for joint in self.floating:
            iq, iv = joint["iq"], joint["iv"]
            v, s = q[..., iq + 3:iq + 6], q[..., iq + 6:iq + 7]
            a, b = part[..., iv:iv + 3], part[..., iv + 3:iv + 6]
            across = torch.linalg.cross(v, a)
            twice = 2 / (q[..., iq + 3:iq + 7] ** 2).sum(-1, keepdim=True)
            pieces += [part[..., at:iv], a + 2 * (s * across + torch.linalg.cross(v, across)), twice * (s * b + torch.linalg.cross(v, b)),
                       -twice * (v * b).sum(-1, keepdim=True)]
            at = iv + 6
        return torch.cat([*pieces, part[..., at:]], -1)
