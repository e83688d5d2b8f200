"""PyTorch: robots are called with tensors, of the processor or of a GPU, and are differentiated.

    tau = robot(q, qd, qdd)         # the tensors' own device and current stream; nothing is copied, nothing waits
    tau.sum().backward()            # by the text of the vector-Jacobian product, compiled when it is first needed

Each robot is an operator of torch.library, named rneagen::ROBOT_HASH after its URDF and keywords, so torch.compile keeps its graph in
one piece, and torch.func.vmap, grad and jacrev work. Import this module before torch.compile sees a robot, unless PyTorch was there when
the robot was loaded.

Outputs with gradients: tau, qdd, gravity, bias and M; by q, qd, qdd or tau, what free= names, and wrenches of fext= in their link's axes.
Others raise NotImplementedError when they are differentiated, as second derivatives do.

The gradient by a quaternion is that of the function on unit quaternions: its part along the quaternion is zero. Where q is not made
unit outside, q / |q| belongs before the call, and then all is as torch.autograd.gradcheck has it. Other numbers of q are as they stand.
"""
from __future__ import annotations

import hashlib
import re
import threading
from typing import Any, Sequence

import torch
from torch import Tensor

from . import _arrays, _robot, _torch_gradient

SCALARS = {torch.float32: "f32", torch.float64: "f64"}
_operators: dict[str, "Operator"] = {}
_lock = threading.RLock()
_stream_of = getattr(torch._C, "_cuda_getCurrentRawStream", None) or (lambda i: torch.cuda.current_stream(i).cuda_stream)
_plain_call = _robot.Robot.__call__
_transforms_active = getattr(torch._C, "_are_functorch_transforms_active", lambda: False)


def identity(robot) -> str:
    """The same for robots that compute the same: of the name, the URDF and the keywords."""
    options = {k: v for k, v in robot._generator.items() if k != "file"}
    own = {k: robot._options.get(k) for k in ("backend", "device", "threads", "block", "cache")}
    digest = hashlib.sha256(robot._urdf + repr((sorted(options.items()), sorted(own.items()))).encode()).hexdigest()
    words = "_".join([robot.name, *(a.name for a in robot.outputs)])
    return re.sub(r"\W", "_", words, flags=re.ASCII)[:60] + "_" + digest[:12]


class Operator:
    """A robot as operators of torch.library: `op`, which makes its outputs; `op_out`, which writes into those it is given."""

    def __init__(self, robot, name: str):
        self.robot, self.name = robot, name
        self.inputs, self.outputs = robot.inputs, robot.outputs
        self.tails = [(a.shape, a.per_batch) for a in self.inputs]
        self.several = len(self.outputs) > 1
        self.kernels: dict[tuple, Any] = {}  # by dtype and index of a GPU
        self.defaults: dict[tuple, Tensor] = {}  # inputs that were left out
        self.gradients = _torch_gradient.Gradients(robot)
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
        op.register_autograd(self.gradients.backward, setup_context=self.gradients.keep)
        op.register_vmap(self.batched)
        return op._opoverload

    @property
    def op_out(self):
        with _lock:
            if self._out is None:
                given = ", ".join(f"Tensor(a{i}!) out{i}" for i in range(len(self.outputs)))
                names = [f"out{i}" for i in range(len(self.outputs))]
                op = torch.library.custom_op(f"rneagen::{self.name}_out", self.run_out, mutates_args=names,
                                             schema=f"({', '.join(filter(None, (self._takes(), given)))}) -> ()")
                op.register_fake(lambda *tensors: None)
                self._out = op._opoverload
            return self._out

    def fake(self, *tensors: Tensor | None):
        like, lead = self.check(tensors)
        made = tuple(like.new_empty((*lead, *a.shape)) for a in self.outputs)
        return made if self.several else made[0]

    def moved(self, info, in_dims, tensors: Sequence[Tensor | None]):
        """What vmap over these is: its axis becomes one more of the samples. The tensors, and the axes of the outputs."""
        moved: list[Tensor | None] = []
        for array, x, dim in zip(self.inputs, tensors, in_dims):
            if x is None or dim is None and array.per_batch:
                moved.append(x)
            elif array.per_batch:
                raise NotImplementedError(f"vmap over {array.name}, which is one for all samples: free='{array.word}:sample' makes it one for each")
            else:
                moved.append((x.expand(info.batch_size, *x.shape) if dim is None else x.movedim(dim, 0)).contiguous())
        return moved, (0,) * len(self.outputs) if self.several else 0

    def batched(self, info, in_dims, *tensors: Tensor | None):
        moved, dims = self.moved(info, in_dims, tensors)
        return self.op(*moved), dims

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
            if shape != (tail if per_batch else lead + tail) or x.dtype != dtype or x.get_device() != index or not x.is_contiguous():
                self.explain(tensors)
        if dtype not in SCALARS:
            self.explain(tensors)
        return like, torch.Size() if lead is None else lead

    def explain(self, tensors: Sequence[Tensor | None]) -> None:
        """Raise what is wrong with them."""
        given = [(a, x) for a, x in zip(self.inputs, tensors) if x is not None]
        first, like = given[0]
        lead: Any = None
        for array, x in given:
            check_tensor(array.name, x, first.name, like)
            shape, own = tuple(x.shape), len(array.shape)
            axes = shape[:len(shape) - own]
            if len(shape) < own or shape[len(shape) - own:] != array.shape or array.per_batch and axes:
                raise ValueError(f"{array.name}: its shape is {shape}; {array.shape} is wanted" +
                                 (", for all samples" if array.per_batch else ", or axes of samples before it"))
            if not array.per_batch and lead is None:
                lead, name = axes, array.name
            elif not array.per_batch and axes != lead:
                raise ValueError(f"{array.name}: its shape is {shape}; {(*lead, *array.shape)} goes with {name}")

    def check_out(self, like: Tensor, lead: torch.Size, tensors: Sequence[Tensor | None], outputs: Sequence[Tensor]) -> None:
        for array, x in zip(self.outputs, outputs):
            check_tensor("out", x, self.inputs[0].name, like)
            if tuple(x.shape) != (*lead, *array.shape):
                raise ValueError(f"out: the shape of the tensor for {array.name} is {tuple(x.shape)}; {(*lead, *array.shape)} is wanted")
        spans = [(a.name, x.data_ptr(), x.data_ptr() + x.nbytes) for a, x in zip((*self.inputs, *self.outputs), (*tensors, *outputs))
                 if x is not None]
        for i, (name, begin, end) in enumerate(spans[-len(outputs):], len(spans) - len(outputs)):
            for other, first, last in spans[:i]:
                if begin < last and first < end:
                    raise ValueError(f"out: the tensor for {name} overlaps {other}")

    # ---- runs ----

    def kernel(self, like: Tensor):
        """The text for tensors like this, compiled."""
        index, robot = like.get_device(), self.robot
        precision = robot.precision_for(SCALARS[like.dtype])
        kernel = robot.kernel(precision, "cuda", index) if like.is_cuda else robot.kernel(precision)
        self.kernels[like.dtype, index] = kernel
        return kernel

    def fill(self, i: int, like: Tensor, lead: torch.Size) -> Tensor:
        """What input i is if it was left out: kept, so that nothing is copied to a GPU at the next call."""
        array, key = self.inputs[i], (i, like.dtype, like.device)
        if key not in self.defaults:
            self.defaults[key] = torch.tensor(array.default, dtype=like.dtype, device=like.device)
        return self.defaults[key] if array.per_batch else self.defaults[key].expand(*lead, *array.shape).contiguous()

    def prepare(self, tensors: Sequence[Tensor | None], outputs: Sequence[Tensor] | None):
        """(kernel, addresses, count, stream, outputs, all tensors)."""
        like, lead = self.check(tensors)
        if None in tensors:
            tensors = [self.fill(i, like, lead) if x is None else x for i, x in enumerate(tensors)]
        if outputs is None:
            outputs = [torch.empty_like(like) if like.shape == lead + a.shape else like.new_empty(lead + a.shape) for a in self.outputs]
        else:
            self.check_out(like, lead, tensors, outputs)
        index = like.get_device()
        kernel = self.kernels.get((like.dtype, index)) or self.kernel(like)
        every = (*tensors, *outputs)
        return kernel, tuple([x.data_ptr() for x in every]), lead.numel(), _stream_of(index) if index >= 0 else None, outputs, every

    def run(self, *tensors: Tensor | None):
        kernel, addresses, count, stream, outputs, _ = self.prepare(tensors, None)
        kernel.launch(addresses, count, stream)
        return tuple(outputs) if self.several else outputs[0]

    def run_out(self, *tensors: Tensor | None) -> None:
        n = len(self.inputs)
        kernel, addresses, count, stream, _, _ = self.prepare(tensors[:n], tensors[n:])  # type: ignore[arg-type]
        kernel.launch(addresses, count, stream)


def check_tensor(name: str, x: Tensor, first: str, like: Tensor) -> None:
    if x.dtype not in SCALARS:
        raise TypeError(f"{name}: its dtype is {x.dtype}; torch.float32 or torch.float64 is wanted")
    if x.device.type not in ("cpu", "cuda", "meta"):
        raise TypeError(f"{name}: it is on device {x.device}; cpu or cuda is wanted")
    if x.dtype != like.dtype:
        raise TypeError(f"{name}: its dtype is {x.dtype}, and that of {first} is {like.dtype}: all tensors have one")
    if x.device != like.device:
        raise ValueError(f"{name}: it is on {x.device}, and {first} on {like.device}")
    if not x.is_contiguous():
        raise ValueError(f"{name}: it is not contiguous in C order; {name}.contiguous() makes a copy that is")


def function_of(operator: Operator):
    """The operator as a torch.autograd.Function: torch.func.grad and its like take that alone."""

    def forward(*tensors):
        return operator.op(*tensors)

    def jvp(ctx, *tangents):
        raise NotImplementedError(f"{operator.robot.name}: derivatives go backward: torch.func.jacrev in place of jacfwd, vjp in place of jvp")

    def vmap(info, in_dims, *tensors):
        moved, dims = operator.moved(info, in_dims, tensors)
        return made.apply(*moved), dims

    gradients = operator.gradients
    made: Any = type(operator.name, (torch.autograd.Function,), {
        "forward": staticmethod(forward), "setup_context": staticmethod(gradients.keep), "backward": staticmethod(gradients.backward),
        "jvp": staticmethod(jvp), "vmap": staticmethod(vmap)})
    return made


def is_plain() -> bool:
    """Is no transform of torch.func and no derivative forward under way?"""
    return not _transforms_active() and torch.autograd.forward_ad._current_level < 0


# ---- robots ----


def operator_of(robot) -> Operator:
    """The robot's operators, made when they are first needed. They live as long as the program."""
    found = robot.__dict__.get("_torch")
    if found is None:
        if robot._conversion:
            raise TypeError(f"convention {robot.convention!r} is for arrays of NumPy")
        if robot._is_sparse:
            raise TypeError("sparse matrices are for arrays of NumPy; take sparse=False")
        name = identity(robot)
        with _lock:
            found = _operators.get(name) or _operators.setdefault(name, Operator(robot, name))
        robot._torch = found
    return found


@torch.compiler.assume_constant_result
def name_of(robot, is_out: bool) -> str:
    """What torch.compile asks for: the name of the operator in torch.ops.rneagen."""
    operator = operator_of(robot)
    return (operator.op_out if is_out else operator.op)._opname


def op_of(robot, is_out: bool = False):
    if torch.compiler.is_compiling():
        return getattr(torch.ops.rneagen, name_of(robot, is_out)).default
    operator = operator_of(robot)
    return operator.op_out if is_out else operator.op if is_plain() else operator.function.apply


def refuse_gradient(what: str, robot, arrays: Sequence[Tensor | None]) -> None:
    for array, x in zip(robot.inputs, arrays):
        if x is not None and x.requires_grad and torch.is_grad_enabled():
            raise ValueError(f"{array.name}: it requires a gradient, and {what} has none; {array.name}.detach() has the same numbers")


def tuple_out(robot, out: Any) -> tuple[Tensor, ...]:
    outputs = out if isinstance(out, tuple) else (out,)
    if len(outputs) != len(robot.outputs):
        raise TypeError(f"out: a tuple of {len(robot.outputs)} tensors is wanted, one for each output")
    return outputs


def call(robot, arrays: Sequence[Any], out: Any):
    """A call whose arrays are tensors."""
    if out is not None:
        refuse_gradient("a call with out=", robot, arrays)
        op_of(robot, True)(*arrays, *tuple_out(robot, out))
        return out
    made = op_of(robot)(*arrays)
    return made if robot._outputs is None else robot._outputs(*made)


def bind(robot, arrays: Sequence[Any], out: Any):
    """A step on tensors, in the stream that is current now; it has no gradient."""
    refuse_gradient("a bound step", robot, arrays)
    operator = operator_of(robot)
    kernel, addresses, count, stream, outputs, every = operator.prepare(arrays, None if out is None else tuple_out(robot, out))
    return kernel.bind(addresses, count, stream, robot._join(list(outputs)) if out is None else out, every)


def _call(self, *args, **kwargs):
    """Tensors go to the operator; all else as before. In Python, so that torch.compile sees through it."""
    if not kwargs and args and len(args) == len(self.inputs) and all([isinstance(x, Tensor) for x in args]):
        return call(self, args, None)
    if any([isinstance(x, Tensor) for x in args]) or any([isinstance(x, Tensor) for x in kwargs.values()]):
        arrays, out = _arrays.arguments(self, args, kwargs)
        every = [*arrays, *(out if isinstance(out, tuple) else (out,))]
        if not all([x is None or isinstance(x, Tensor) for x in every]):
            _arrays.adapter(self, arrays, out)
        return call(self, arrays, out)
    return _plain_call(self, *args, **kwargs)


_call.__name__, _call.__doc__ = "__call__", _plain_call.__doc__
_robot.Robot.__call__ = _call  # type: ignore[method-assign]
