"""Gradients of a robot's outputs in PyTorch: those of _gradient.py, as register_autograd takes them."""
from __future__ import annotations

from typing import Any, Sequence

import torch
from torch import Tensor

from . import _gradient


class Without(torch.autograd.Function):
    """An input by which there is no second derivative, as it stands: an error where one by it is asked for, and not before."""
    generate_vmap_rule = True

    @staticmethod
    def forward(x: Tensor, error: Exception) -> Tensor:
        return x.view_as(x)

    @staticmethod
    def setup_context(ctx, inputs: tuple, output: Tensor) -> None:
        ctx.error = inputs[1]

    @staticmethod
    def backward(ctx, grad: Tensor):
        raise ctx.error

    @staticmethod
    def jvp(ctx, tangent: Tensor, _: None) -> Tensor:
        return tangent.view_as(tangent)


NODE = f"{Without.__name__}Backward"


class Gradients(_gradient.Gradients):
    """What register_autograd takes, of one robot."""

    def __init__(self, robot, function_for: Any):
        def run(robot, tensors: list) -> Any:
            made = function_for(robot, tensors, False)(*tensors)
            return (made,) if len(robot.outputs) == 1 else made

        super().__init__(robot, _gradient.Library(
            run=run, zeros=lambda like, shape: like.new_zeros(shape), expand=lambda x, shape: x.expand(shape).contiguous(),
            join=lambda parts: torch.cat(parts, -1), cross=torch.linalg.cross))

    def guarded(self, tensors: Sequence[Tensor | None]) -> list[Tensor | None]:
        """Of a robot of products: autograd asks for gradients by all that require one, though one may be wanted of
        the state alone."""
        return [x if x is None or not x.requires_grad or a.role in (*_gradient.PARTS, *_gradient.DIRECTIONS) else
                Without.apply(x, self.no_second(a)) for a, x in zip(self.robot.inputs, tensors)]

    def keep(self, ctx, inputs: tuple, output: Any) -> None:
        ctx.set_materialize_grads(False)
        ctx.save_for_backward(*inputs)

    def gradient(self, ctx, *grads: Tensor | None) -> tuple[Tensor | None, ...]:
        tensors = ctx.saved_tensors
        needs = [need and type(x.grad_fn).__name__ != NODE for x, need in zip(tensors, ctx.needs_input_grad)]
        return tuple(self.backward(tensors, grads, needs))
