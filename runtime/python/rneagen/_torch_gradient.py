"""Gradients of a robot's outputs in PyTorch: those of _gradient.py, as register_autograd takes them."""
from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from . import _gradient


class Gradients(_gradient.Gradients):
    """What register_autograd takes, of one robot."""

    def __init__(self, robot, function_for: Any):
        def run(robot, tensors: list) -> Any:
            made = function_for(robot, tensors, False)(*tensors)
            return (made,) if len(robot.outputs) == 1 else made

        super().__init__(robot, _gradient.Library(
            run=run, zeros=lambda like, shape: like.new_zeros(shape), expand=lambda x, shape: x.expand(shape).contiguous(),
            join=lambda parts: torch.cat(parts, -1), cross=torch.linalg.cross))

    def keep(self, ctx, inputs: tuple, output: Any) -> None:
        ctx.set_materialize_grads(False)
        ctx.save_for_backward(*inputs)

    def gradient(self, ctx, *grads: Tensor | None) -> tuple[Tensor | None, ...]:
        return tuple(self.backward(ctx.saved_tensors, grads, ctx.needs_input_grad))
