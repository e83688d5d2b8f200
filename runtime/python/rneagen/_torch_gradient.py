"""Gradients of a robot's outputs in PyTorch. Each is made by another text of the same scene, which is a robot too: so a gradient has an
operator, a rule for vmap and a compiled text of its own.

With w the gradient of the loss by an output:
    tau, qdd        the output vjp: w' d tau/d(q, qd, qdd), w' d qdd/d(q, qd, tau)
    gravity, bias   the same at qdd = 0, at qd = 0, of the rigid bodies alone
    M               sum over columns j of the vjp of M e_j: tau without gravity at qd = 0, qdd = e_j
    freed constants w' d tau/d constant, of the output dtau_dNAME
    wrenches        minus the link's twist at qd = w, for tau holds -J' f; of qdd, its twist at qd = M^-1 w
"""
from __future__ import annotations

from typing import Any, Sequence

import torch
from torch import Tensor

from . import _robot

FREED = ("gravity", "link_mass", "link_inertia", "link_payload", "joint_offset")
PARTS = {"joint_position": 0, "joint_velocity": 1, "joint_acceleration": 2, "joint_torque": 2}  # of vjp
RIGID = ("damping", "friction", "fext", "fext_frame", "refine", "dynamics")  # what gravity, bias and M have not
ABSENT: dict[str, tuple[str, ...]] = {"bias_torque": ("joint_acceleration", "joint_torque", "link_wrench")}  # what they do not depend on
ABSENT["gravity_torque"] = (*ABSENT["bias_torque"], "joint_velocity")
ABSENT["mass_matrix"] = (*ABSENT["gravity_torque"], "gravity")
SECOND = ("vjp", "jvp", "dtau_dq", "dtau_dqd", "dtau_dfreed", "dqdd_dq", "dqdd_dqd", "dqdd_dfreed")


class Gradients:
    """What register_autograd takes, of one robot."""

    def __init__(self, robot, function_for: Any):
        self.robot, self.function_for = robot, function_for
        self.is_forward = any(a.role == "joint_torque" for a in robot.inputs)
        self.floating = [joint for joint in robot.joints if joint["nq"] != joint["nv"]]
        self.made: dict[tuple, Any] = {}  # robots of gradients
        self.recipes: dict[tuple, tuple] = {}

    def keep(self, ctx, inputs: tuple, output: Any) -> None:
        ctx.set_materialize_grads(False)
        ctx.save_for_backward(*inputs)

    def backward(self, ctx, *grads: Tensor | None) -> tuple[Tensor | None, ...]:
        total: list[Tensor | None] = [None] * len(self.robot.inputs)
        for output, w in zip(self.robot.outputs, grads):
            if w is not None:
                parts = self.of_output(output, ctx.saved_tensors, w, ctx.needs_input_grad)
                total = [a if b is None else b if a is None else a + b for a, b in zip(total, parts)]
        return tuple(total)

    def of_output(self, output, tensors: Sequence[Tensor | None], w: Tensor, needs: Sequence[bool]) -> list[Tensor | None]:
        role, absent, inputs = output.role, ABSENT.get(output.role, ()), self.robot.inputs
        named = {a.name: x for a, x in zip(inputs, tensors) if a.role not in absent}
        needs = [need and a.role not in absent for a, need in zip(inputs, needs)]
        if role in SECOND:
            raise NotImplementedError(f"{self.robot.name}: second derivatives: {output.name} is a derivative, and has no gradient of its own")
        if role == "joint_acceleration" or role == "joint_torque" and not self.is_forward:
            return self.of_vector(output.name, named, w, needs, {})
        if role in ("gravity_torque", "bias_torque"):
            return self.of_vector(output.name, named, w, needs, self.rigid(output))
        if role == "mass_matrix":
            return self.of_matrix(output, named, w, needs)
        raise NotImplementedError(f"{self.robot.name}: {output.word} has no gradient; tau, qdd, gravity, bias and M have one")

    # ---- the robots ----

    def rigid(self, output) -> dict[str, Any]:
        """Keywords that leave the rigid bodies alone."""
        for keyword in ("fold", "scene"):
            if self.robot._options.get(keyword):
                raise NotImplementedError(f"{self.robot.name}: {output.word} has no gradient where the scene has {keyword}=")
        return dict.fromkeys(RIGID)

    def make(self, key: tuple, options: dict[str, Any]):
        """A robot with other keywords, made once."""
        if key not in self.made:
            self.made[key] = _robot.Robot(self.robot._urdf, self.robot._file, {**self.robot._options, "sparse": None, **options})
        return self.made[key]

    def run(self, robot, named: dict[str, Tensor | None], w: Tensor) -> dict[str, Tensor]:
        """Its outputs by word, from inputs by name; q, qd and qdd that are not there are 0."""
        tensors = [named[a.name] if a.name in named else w.new_zeros((*w.shape[:-1], *a.shape)) for a in robot.inputs]
        made = self.function_for(robot, tensors, False)(*tensors)
        return {robot.outputs[0].word: made} if len(robot.outputs) == 1 else dict(zip((a.word for a in robot.outputs), made))

    # ---- outputs ----

    def of_vector(self, name: str, named: dict[str, Tensor | None], w: Tensor, needs, options: dict[str, Any]) -> list[Tensor | None]:
        """Of tau and what is like it, or of qdd; `named` has the inputs."""
        inputs, w, key = self.robot.inputs, w.contiguous(), (name, *needs)
        if key not in self.recipes:
            self.recipes[key] = self.recipe(name, [a for a, need in zip(inputs, needs) if need], options)
        robot, words = self.recipes[key]
        found = self.run(robot, {**named, "vjp_v": w}, w) if robot else {}
        return [self.pick(a, w, found, words, named) if need else None for a, need in zip(inputs, needs)]

    def recipe(self, name: str, needed: Sequence, options: dict[str, Any]) -> tuple[Any, dict[str, str]]:
        """The robot that makes gradients by these inputs, and the words of its outputs for freed constants."""
        of = "qdd" if name == "qdd" else "tau"
        words = {a.name: f"d{of}_d{a.word}" for a in needed if a.role in FREED}
        is_needed = any(a.role in PARTS or of == "qdd" and a.role == "link_wrench" for a in needed)
        if not (is_needed or words):
            return None, words
        wanted = [*(["vjp"] if is_needed and of == "tau" else []), *words.values()]
        product = "qdd" if is_needed and of == "qdd" else None
        return self.make((name, is_needed, *words), {**options, "want": wanted or None, "vjp": product}), words

    def pick(self, array, w: Tensor, found: dict[str, Tensor], words: dict[str, str], named) -> Tensor:
        """The gradient by one input."""
        nv = self.robot.nv
        if array.role in PARTS:
            part = found["vjp"].narrow(-1, PARTS[array.role] * nv, nv)
            return self.of_position(named[array.name], part) if array.role == "joint_position" and self.floating else part
        if array.role in FREED:
            product = (w.unsqueeze(-2) @ found[words[array.name]]).squeeze(-2)
            return product.sum(tuple(range(product.dim() - 1))) if array.per_batch else product
        if array.role == "link_wrench":
            return self.of_wrench(array, w, found, named)
        raise NotImplementedError(f"{self.robot.name}: there is no gradient by {array.word}")

    def of_wrench(self, array, w: Tensor, found: dict[str, Tensor], named) -> Tensor:
        if self.robot._options.get("scene") or self.robot._options.get("fext_frame") not in (None, "link"):
            raise NotImplementedError(f"{self.robot.name}: there is no gradient by {array.word} in the world's axes; fext_frame='link' has one")
        v = found["vjp"].narrow(-1, 2 * self.robot.nv, self.robot.nv).contiguous() if self.is_forward else w
        robot = self.make(("twist", array.name), {"want": [f"twist.{array.of}"], "vjp": None, **dict.fromkeys(RIGID)})
        twist, = self.run(robot, {**named, "qd": v}, w).values()
        return twist if self.is_forward else -twist

    def of_matrix(self, output, named: dict[str, Tensor | None], w: Tensor, needs) -> list[Tensor | None]:
        """Of M, column by column, or row by row, for M is symmetric: one more axis of nv samples."""
        nv, lead, inputs = self.robot.nv, w.shape[:-2], self.robot.inputs
        options = {**self.rigid(output), "gravity": (0.0, 0.0, 0.0)}
        columns = {a.name: x if x is None or a.per_batch else x.unsqueeze(-2).expand(*lead, nv, *a.shape).contiguous()
                   for a, x in ((a, named[a.name]) for a in inputs if a.name in named)}
        columns["gravity"] = w.new_zeros(3)
        columns["qdd"] = torch.eye(nv, dtype=w.dtype, device=w.device).expand(*lead, nv, nv).contiguous()
        parts = self.of_vector(output.name, columns, w, needs, options)
        return [x if x is None or a.per_batch else x.sum(-2) for a, x in zip(inputs, parts)]

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
