"""Operators of torch.library that run a robot's text on tensors."""
from __future__ import annotations

from typing import Any, NamedTuple, Sequence

import torch
from torch import Tensor
from torch.autograd import forward_ad

from . import _arrays, _gradient, _robot, _torch_gradient

SCALARS = {torch.float32: "f32", torch.float64: "f64"}
DEVICES = ("cpu", "cuda", "meta")
PLANS = 256  # that are kept
lock = _robot.Lock()
_stream_of = getattr(torch._C, "_cuda_getCurrentRawStream", None) or (lambda i: torch.cuda.current_stream(i).cuda_stream)
_increment_version = getattr(torch._C, "_increment_version", torch.autograd.graph.increment_version)
_transforms_active = getattr(torch._C, "_are_functorch_transforms_active", lambda: False)


class Operator:
    """A robot as operators of torch.library: `op`, which makes its outputs; `op_out`, which writes into those it is given."""
    defined: set[str] = set()  # names, from the moment on at which PyTorch asks whether they are there

    def __init__(self, robot, name: str, function_for):
        self.robot, self.name, self.function_for = robot, name, function_for
        self.inputs, self.outputs = robot.inputs, robot.outputs
        self.tails = [(a.shape, a.per_batch) for a in self.inputs]
        self.several = len(self.outputs) > 1
        self.is_product = all(a.role in _gradient.PRODUCTS for a in self.outputs)
        self.plans: dict[tuple, Plan] = {}  # by shape, dtype and device of the first tensor: what all others are then
        self.defaults: dict[tuple, Tensor] = {}  # inputs that were left out
        self.gradients = _torch_gradient.Gradients(robot, function_for)
        self.defined.add(name)
        self.op = self._define()
        self.function = function_of(self)
        self._out: Any = None

    # ---- definition ----

    def _takes(self) -> str:
        return ", ".join(f"Tensor{'' if a.default is None else '?'} x{i}" for i, a in enumerate(self.inputs))

    def _define(self):
        made = f"({', '.join(['Tensor'] * len(self.outputs))})" if self.several else "Tensor"
        op = torch.library.custom_op(f"rneagen::{self.name}", self.run, mutates_args=(), schema=f"({self._takes()}) -> {made}")
        op.register_fake(self.fake)
        op.register_autograd(self.gradients.gradient, setup_context=self.gradients.keep)
        op.register_vmap(lambda info, in_dims, *tensors: self.batched(self.op, info, in_dims, tensors))
        return op._opoverload

    @property
    def op_out(self):
        with lock:
            if self._out is None:
                given = ", ".join(f"Tensor(a{i}!) out{i}" for i in range(len(self.outputs)))
                names = [f"out{i}" for i in range(len(self.outputs))]
                self.defined.add(f"{self.name}_out")
                op = torch.library.custom_op(f"rneagen::{self.name}_out", self.run_out, mutates_args=names,
                                             schema=f"({', '.join(filter(None, (self._takes(), given)))}) -> ()")
                op.register_fake(lambda *tensors: None)
                self._out = op._opoverload
            return self._out

    def fake(self, *tensors: Tensor | None):
        like, lead = self.check(tensors)
        made = tuple(like.new_empty((*lead, *a.shape)) for a in self.outputs)
        return made if self.several else made[0]

    def batched(self, call, info, in_dims, tensors: Sequence[Tensor | None]):
        """What vmap over these is: its axis becomes one more of the samples, of all constants that have it too. The outputs, and
        where their axes are."""
        gradients, size = self.gradients, info.batch_size
        _arrays.lead_of((a, tuple(n for i, n in enumerate(x.shape) if i != dim))
                        for a, x, dim in zip(self.inputs, tensors, in_dims) if x is not None)
        words = [gradients.constant_of(a) for a in self.inputs]
        apart = {word for a, word, dim in zip(self.inputs, words, in_dims) if a.per_batch and dim is not None}
        moved = [x if x is None or a.per_batch and word not in apart else
                 (x.expand(size, *x.shape) if dim is None else x.movedim(dim, 0)).contiguous()
                 for a, word, x, dim in zip(self.inputs, words, tensors, in_dims)]
        if apart:
            lead = _arrays.samples_of(self.inputs, moved) or (size,)
            moved = [x if x is None or not a.per_batch or word not in apart else
                     x.reshape(size, *[1] * (len(lead) - 1), *a.shape).expand(*lead, *a.shape).contiguous()
                     for a, word, x in zip(self.inputs, words, moved)]
            call = self.function_for(gradients.robot_apart(tuple(sorted(apart))), moved, False)
        return call(*moved), (0,) * len(self.outputs) if self.several else 0

    # ---- checks ----

    def check(self, tensors: Sequence[Tensor | None]) -> tuple[Tensor, torch.Size]:
        """The first tensor, and the axes of samples."""
        like: Any = None
        lead: Any = None
        for (tail, per_batch), x in zip(self.tails, tensors):
            if x is None:
                continue
            if like is None:
                like, dtype, index = x, x.dtype, x.get_device()
            shape = x.shape
            if lead is None and not per_batch:
                lead = shape[:len(shape) - len(tail)]
            if shape != (tail if per_batch else lead + tail) or x.dtype != dtype or x.get_device() != index:
                self.explain(tensors)
        if like is None:
            raise TypeError("out: a tensor, and no input is one; without any input, out is an array of NumPy")
        if dtype not in SCALARS or like.device.type not in DEVICES:
            self.explain(tensors)
        return like, torch.Size() if lead is None else lead

    def explain(self, tensors: Sequence[Tensor | None]) -> None:
        """Raise what is wrong with them."""
        given = [(a, x) for a, x in zip(self.inputs, tensors) if x is not None]
        first, like = given[0]

        def shapes():
            for array, x in given:
                check_tensor(array.name, x, first.name, like)
                yield array, tuple(x.shape)
        _arrays.lead_of(shapes())

    def one_piece(self, tensors: Sequence[Tensor | None]) -> Sequence[Tensor | None]:
        """With copies of tensors that lie in several pieces."""
        for x in tensors:
            if x is not None and not x.is_contiguous():
                return [x if x is None else x.contiguous() for x in tensors]
        return tensors

    def refuse_pieces(self, tensors: Sequence[Tensor | None]) -> None:
        for array, x in zip(self.inputs, tensors):
            if x is not None:
                check_pieces(array.name, x)

    def check_out(self, tensors: Sequence[Tensor], shapes: Sequence[torch.Size], outputs: Sequence[Tensor]) -> None:
        dtype, index = tensors[0].dtype, tensors[0].get_device()
        for array, shape, x in zip(self.outputs, shapes, outputs):
            if x.dtype is not dtype or x.get_device() != index:
                check_tensor("out", x, self.inputs[0].name, tensors[0])
            check_pieces("out", x)
            if x.shape != shape:
                raise ValueError(f"out: the shape of the tensor for {array.name} is {tuple(x.shape)}; {tuple(shape)} is wanted")
        spans = [(x.data_ptr(), x.nbytes) for x in (*tensors, *outputs)]
        for i in range(len(tensors), len(spans)):
            at, size = spans[i]
            for k in range(i):
                if -spans[k][1] < spans[k][0] - at < size:
                    name, other = ((*self.inputs, *self.outputs)[j].name for j in (i, k))
                    raise ValueError(f"out: the tensor for {name} overlaps {other}")

    # ---- runs ----

    def plan(self, like: Tensor, lead: torch.Size) -> "Plan":
        """What calls with tensors like this have in common; compiles."""
        robot, index = self.robot, like.get_device()
        precision = robot.precision_for(SCALARS[like.dtype])
        kernel = robot.kernel(precision, "cuda", index) if like.is_cuda else robot.kernel(precision)
        taken = [torch.Size(tail if per_batch else (*lead, *tail)) for tail, per_batch in self.tails]
        made = [torch.Size((*lead, *a.shape)) for a in self.outputs]
        is_given = [a.default is None for a in self.inputs]
        alike = next((i for i, shape in enumerate(taken) if is_given[i] and not self.several and shape == made[0]), -1)
        return Plan(kernel, lead.numel(), index, taken, taken[1:], made, alike)

    def fill(self, i: int, like: Tensor, shape: torch.Size) -> Tensor:
        """What input i is if it was left out: kept, so that nothing is copied to a GPU at the next call."""
        key = i, like.dtype, like.device
        if key not in self.defaults:
            self.defaults[key] = torch.tensor(self.inputs[i].default, dtype=like.dtype, device=like.device)
        return self.defaults[key].expand(shape).contiguous()

    def planned(self, tensors: Sequence[Tensor | None]) -> "Plan":
        """The plan for these tensors, which are in one piece each, and are checked."""
        first = tensors[0] if tensors else None
        if first is not None:
            shape, dtype, index = first.shape, first.dtype, first.get_device()
            found = self.plans.get((shape, dtype, index))
            if found is not None:
                for shape, x in zip(found.rest, tensors[1:]):
                    if x is None or x.shape != shape or x.dtype is not dtype or x.get_device() != index:
                        break
                else:
                    return found
        like, lead = self.check(tensors)
        plan = self.plan(like, lead)
        if first is not None and not self.tails[0][1]:
            if len(self.plans) >= PLANS:
                self.plans.clear()
            self.plans[like.shape, like.dtype, like.get_device()] = plan
        return plan

    def prepared(self, given: Sequence[Tensor | None]) -> tuple[Sequence[Tensor | None], "Plan"]:
        """The same in one piece each, and the plan for them. What is not dense fails in PyTorch, and is then explained."""
        try:
            tensors = self.one_piece(given)
            return tensors, self.planned(tensors)
        except RuntimeError:
            check_dense(names_of(self.robot), given)
            raise

    def complete(self, plan: "Plan", tensors: Sequence[Tensor | None]) -> tuple[Tensor, ...]:
        """With what was left out."""
        for x in tensors:
            if x is None:
                like: Any = next(x for x in tensors if x is not None)
                return tuple([self.fill(i, like, plan.taken[i]) if x is None else x for i, x in enumerate(tensors)])
        return tuple(tensors)  # type: ignore[arg-type]

    def launch(self, plan: "Plan", tensors: Sequence[Tensor]) -> None:
        try:
            plan.launch(tensors)
        except ValueError:
            self.explain_memory(tensors)
            raise

    def explain_memory(self, tensors: Sequence[Tensor]) -> None:
        """Raise what is wrong with tensors that have no address: cheap checks do not tell `meta` from the processor."""
        for name, x in zip(names_of(self.robot), tensors):
            check_tensor(name, x, self.inputs[0].name, tensors[0])
            if x.numel() and not x.data_ptr():
                raise ValueError(f"{name}: it has no memory: it was freed, or PyTorch has not written it; {name}.clone() is a "
                                 f"tensor that has")

    def run(self, *given: Tensor | None):
        tensors, plan = self.prepared(given)
        inputs = self.complete(plan, tensors)
        if plan.alike >= 0:  # faster than by its shape
            made = torch.empty_like(inputs[plan.alike])
            self.launch(plan, [*inputs, made])
            return made
        outputs = tuple([inputs[0].new_empty(shape) for shape in plan.made])
        self.launch(plan, [*inputs, *outputs])
        return outputs if self.several else outputs[0]

    def check_given(self, tensors: Sequence[Tensor | None], outputs: Sequence[Tensor]) -> tuple["Plan", tuple[Tensor, ...]]:
        """The plan, and all tensors."""
        tensors, plan = self.prepared(tensors)
        inputs = self.complete(plan, tensors)
        self.check_out(inputs, plan.made, outputs)
        return plan, (*inputs, *outputs)

    def run_out(self, *tensors: Tensor | None) -> None:
        given: Any = tensors[len(self.inputs):]
        plan, every = self.check_given(tensors[:len(self.inputs)], given)
        self.launch(plan, every)
        _increment_version(given)  # who has kept them for a gradient is told

    def step(self, tensors: Sequence[Tensor | None], outputs: Sequence[Tensor] | None, result: Any):
        """A step that launches again and returns `result`, or the outputs that are made here."""
        self.refuse_pieces(tensors)
        if outputs is None:
            made = self.run(*tensors)
            outputs = made if self.several else (made,)
            result = self.robot._join(list(outputs))
        plan, every = self.check_given(tensors, outputs)
        addresses, *rest = plan.where(every)
        # whoever takes a tensor's memory away leaves that of its view to the step, which then says so
        launch = plan.kernel.bind(addresses, *rest, result, (every, [x.detach() for x in every]))
        bound = list(addresses)

        def step():
            if [x.data_ptr() for x in every] != bound:
                moved = next(n for n, x, address in zip(names_of(self.robot), every, bound) if x.data_ptr() != address)
                raise RuntimeError(f"{moved}: its memory is another than when it was bound; bind it again")
            return launch()
        return step


class Plan(NamedTuple):
    """What calls with tensors of one shape, dtype and device have in common."""
    kernel: Any  # _core.Kernel
    samples: int
    gpu: int  # its number; -1: the processor
    taken: list[torch.Size]
    rest: list[torch.Size]  # of all inputs but the first
    made: list[torch.Size]
    alike: int  # the input that the only output is like; -1: none

    def where(self, tensors: Sequence[Tensor]) -> tuple[tuple[int, ...], int, int | None]:
        return tuple([x.data_ptr() for x in tensors]), self.samples, _stream_of(self.gpu) if self.gpu >= 0 else None

    def launch(self, tensors: Sequence[Any]) -> None:
        self.kernel.launch(*self.where(tensors))


def names_of(robot) -> list[str]:
    """What messages call the tensors of a call, inputs and then outputs."""
    return [*(a.name for a in robot.inputs), *("out" for _ in robot.outputs)]


def check_tensor(name: str, x: Tensor, first: str, like: Tensor) -> None:
    if x.dtype not in SCALARS:
        raise TypeError(f"{name}: its dtype is {x.dtype}; torch.float32 or torch.float64 is wanted")
    if x.device.type not in DEVICES:
        raise TypeError(f"{name}: it is on device {x.device}; cpu or cuda is wanted")
    if x.dtype != like.dtype:
        raise TypeError(f"{name}: its dtype is {x.dtype}, and that of {first} is {like.dtype}: all tensors have one")
    if x.device != like.device:
        raise ValueError(f"{name}: it is on {x.device}, and {first} on {like.device}")


def check_dense(names: Sequence[str], tensors: Sequence[Tensor | None]) -> None:
    for name, x in zip(names, tensors):
        if x is not None and (x.layout != torch.strided or x.is_nested):
            made = f"torch.stack({name}.unbind())" if x.is_nested else f"{name}.to_dense()"
            raise TypeError(f"{name}: a {'nested' if x.is_nested else x.layout} tensor; {made} is a plain one")


def check_pieces(name: str, x: Tensor) -> None:
    check_dense([name], [x])
    if not x.is_contiguous():
        raise ValueError(f"{name}: it is not contiguous in C order; {name}.contiguous() makes a copy that is")


def function_of(operator: Operator):
    """The operator as a torch.autograd.Function: torch.func.grad and its like take that alone."""

    def forward(*tensors):
        return operator.op(*tensors)

    def keep(ctx, inputs, output):
        gradients.keep(ctx, inputs, output)
        ctx.save_for_forward(*inputs)

    def jvp(ctx, *tangents):
        made = gradients.forward(operator.outputs, ctx.saved_tensors, tangents)
        return tuple(made) if operator.several else made[0]

    def vmap(info, in_dims, *tensors):
        return operator.batched(made.apply, info, in_dims, tensors)

    gradients = operator.gradients
    made: Any = type(operator.name, (torch.autograd.Function,), {
        "forward": staticmethod(forward), "setup_context": staticmethod(keep),
        "backward": staticmethod(gradients.gradient), "jvp": staticmethod(jvp), "vmap": staticmethod(vmap)})
    return made


def is_plain() -> bool:
    """Is no transform of torch.func and no derivative forward under way?"""
    return not _transforms_active() and getattr(forward_ad, "_current_level", -1) < 0
