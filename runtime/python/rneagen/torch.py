"""PyTorch: robots are called with tensors, of the processor or of a GPU, and are differentiated.

    tau = robot(q, qd, qdd)    # the tensors' own device and current stream; nothing waits, and nothing in one piece is copied
    tau.sum().backward()       # by the text of the vector-Jacobian product, compiled when it is first needed

Each robot is an operator of torch.library, named rneagen::ROBOT_HASH after its URDF and keywords, so torch.compile
keeps its graph in one piece, and torch.func.vmap, grad and jacrev work. Import this module before torch.compile sees
a robot, unless PyTorch was there when the robot was loaded.

Gradients are of all outputs but qdd_bound, which raises NotImplementedError when it is differentiated; by q, qd, qdd or tau,
what free= names, and wrenches of fext=. Those of several outputs are made in one sweep. Forward, torch.func.jvp, jacfwd and
torch.autograd.forward_ad have them too. Second ones are by the state: torch.func.hessian, gradients with create_graph=True,
jacrev of jacfwd; of gradients by the state there are those by what is free, forward. Where autocast is on, tensors of
float16 and bfloat16 are taken as float32.

The gradient by a quaternion is that of the function on unit quaternions: its part along the quaternion is zero. Where
q is not made unit outside, q / |q| belongs before the call, and then all is as torch.autograd.gradcheck has it. Other
numbers of q are as they stand.
"""
from __future__ import annotations

from typing import Any, Sequence

import torch
from numpy import ndarray
from torch import Tensor
from torch.autograd import forward_ad

from . import _arrays, _gradient, _robot
from ._errors import RobotError
from ._torch_operator import Operator, check_dense, is_plain, lock, names_of

HALVES = (torch.float16, torch.bfloat16)
_operators: dict[str, Operator] = {}
_modes = getattr(torch._C, "_len_torch_dispatch_stack", lambda: 1)
_is_autocast = getattr(torch._C, "_is_any_autocast_enabled", torch.is_autocast_enabled)
_is_tracing = getattr(torch._C, "_is_tracing", lambda: False)
_is_traced = getattr(torch.compiler, "is_dynamo_compiling", torch.compiler.is_compiling)
_compiler_looks_on = getattr(torch._C._dynamo.eval_frame, "get_eval_frame_callback", lambda: None)
_is_wrapped = getattr(torch._C._functorch, "is_functorch_wrapped_tensor", lambda x: False)
_is_batched = getattr(torch._C._functorch, "is_legacy_batchedtensor", lambda x: False)
_plain_call, _plain_wanting = _robot.Robot.__call__, _robot.Robot._wanting


def operator_of(robot) -> Operator:
    return _robot.operator_of(robot, "_torch", _operators, lock, lambda name: Operator(robot, name, function_for))


def derive(parent: str, derivation: str) -> None:
    """Make the operator of a derivative, where there is one of this name."""
    if _gradient.DERIVATION.fullmatch(derivation) and hasattr(torch.ops.rneagen, parent):
        try:
            operator_of(_operators[parent].gradients.derived(derivation))
        except (IndexError, StopIteration, RobotError):
            pass


def find(name: str) -> None:
    """What torch.ops.rneagen asks first for a name that it does not know: that of a robot that was not called yet, or of a
    derivative. Programs of torch.export, and graphs that torch.compile has kept from another run, come with such names."""
    with lock:
        if name not in Operator.defined:
            derive(*name.rpartition("__")[::2])
        for robot in [] if name in Operator.defined else list(_robot.ALIVE.values()):
            own = "" if robot._is_sparse else _robot.operator_name(robot)
            if name in (own, f"{own}_out"):
                operator = operator_of(robot)
                if name != own:
                    operator.op_out
                break
    raise AttributeError(name)


vars(torch.ops.rneagen)["__getattr__"] = find


@torch.compiler.assume_constant_result
def name_of(key: str, is_out: bool) -> str:
    """What torch.compile asks for: the name of the operator in torch.ops.rneagen."""
    operator = operator_of(_robot.ALIVE[key])
    return (operator.op_out if is_out else operator.op)._opname


def function_for(robot, tensors: Sequence[Any], is_out: bool):
    """What computes these: the operator, what torch.func takes, or where PyTorch's dispatcher has nothing to do the
    function alone."""
    operator = None if _is_traced() else robot.__dict__.get("_torch") or operator_of(robot)
    if operator and is_direct(tensors):
        return operator.run_out if is_out else operator.run
    if is_out:
        refuse_gradient("a call with out=", robot, tensors)
    if not operator:
        return getattr(torch.ops.rneagen, name_of(robot._key, is_out)).default
    check_dense(names_of(robot), tensors)
    if is_out:
        return operator.op_out
    made = operator.op if is_plain() else operator.function.apply
    return (lambda *tensors: made(*operator.gradients.guarded(tensors))) if operator.is_product else made


@torch.compiler.assume_constant_result
def is_transformed() -> bool:
    """What torch.compile asks for, which looks at transforms anew: is a derivative of torch.func under way, or one forward?"""
    stack = torch._C._functorch.get_interpreter_stack() or []
    return any(x.key() != torch._C._functorch.TransformType.Vmap for x in stack) or getattr(forward_ad, "_current_level", -1) >= 0


@torch.compiler.allow_in_graph
def transformed(key: str, *tensors: Tensor | None):
    """The call as torch.func's derivatives take it: an operator of torch.library has none forward."""
    return operator_of(_robot.ALIVE[key]).function.apply(*tensors)


@torch.compiler.disable
def beside_graph(robot, arrays: Sequence[Any], out: Any):
    """What runs beside a graph of torch.compile: it makes no graphs of its parts, in which no transform would be under way."""
    return call(robot, arrays, out)


def refuse_gradient(what: str, robot, tensors: Sequence[Tensor | None]) -> None:
    """Of inputs, then outputs: nobody would see what is written into a tensor."""
    if torch.is_grad_enabled():
        for name, x in zip(names_of(robot), tensors):
            if x is not None and x.requires_grad:
                raise ValueError(f"{name}: it requires a gradient, and {what} has none; {name}.detach() has the same numbers")
    if is_transformed() if _is_traced() else not is_plain() and any(map(is_followed, tensors)):
        raise ValueError(f"{what} has no derivatives, forward or by torch.func: leave out= out")


def is_followed(x: Tensor | None) -> bool:
    """Does a transform of torch.func see it, or has it a tangent?"""
    return x is not None and (_is_wrapped(x) or forward_ad.unpack_dual(x).tangent is not None)


def is_direct(tensors: Sequence[Any]) -> bool:
    """Plain tensors in memory, which need no gradient, and no mode that looks on: the dispatcher would take longer
    than a sample. A view that is negated when it is read, and one of many gradients at once, are not plain."""
    first, is_grad = tensors[0], torch.is_grad_enabled()
    for x in tensors:
        if x is not None and (type(x) is not Tensor or is_grad and x.requires_grad or x.is_neg() or _is_batched(x)):
            return False
    return not _modes() and not _is_tracing() and is_plain() and (first is None or first.is_cpu or first.is_cuda)


def widened(arrays: Sequence[Any]) -> list:
    """Numbers of half as many bits, which autocast leaves behind, as those of float32."""
    return [x.float() if isinstance(x, Tensor) and x.dtype in HALVES else x for x in arrays]


def call(robot, arrays: Sequence[Any], out: Any):
    """A call whose arrays are tensors."""
    if not _is_traced() and _compiler_looks_on():
        return beside_graph(robot, arrays, out)
    if _is_autocast():
        arrays = widened(arrays)
    if robot._conversion:
        return robot._conversion.call(arrays, out)
    if out is not None:
        outputs = _arrays.tuple_out(robot, out, "tensors")
        every = (*arrays, *outputs)
        function_for(robot, every, True)(*every)
        return out
    if _is_traced() and is_transformed():
        made = transformed(robot._key, *arrays)
    else:
        made = function_for(robot, arrays, False)(*arrays)
    return made if robot._outputs is None else robot._outputs(*made)


def constant(values: ndarray, shape: tuple[int, ...], like: Tensor) -> Tensor:
    """A tensor like `like` with values that are the same for all samples."""
    return torch.tensor(values, dtype=like.dtype, device=like.device).expand(shape).contiguous()


def bind(robot, arrays: Sequence[Any], out: Any):
    """A step on tensors, in the stream that is current now; it has no gradient."""
    _arrays.refuse_conversion(robot)
    outputs = None if out is None else _arrays.tuple_out(robot, out, "tensors")
    refuse_gradient("a bound step", robot, (*arrays, *(outputs or ())))
    return operator_of(robot).step(arrays, outputs, out)


def _call(self, *args, **kwargs):
    """Tensors go to the operator; all else as before. In Python, so that torch.compile sees through it."""
    first = args[0] if args else next(iter(kwargs.values()), None)
    if type(first) is ndarray or not isinstance(first, Tensor):
        return _plain_call(self, *args, **kwargs)
    if not kwargs and len(args) == len(self.inputs):
        arrays, out, every = args, None, args
    else:
        arrays, out = _arrays.arguments(self, args, kwargs)
        every = [*arrays, *(out if isinstance(out, tuple) else (out,))]
    for x in every:
        if x is None and arrays is args:
            _arrays.arguments(self, args, kwargs)  # not all inputs may be left out
        elif x is not None and not isinstance(x, Tensor):
            _arrays.adapter(self, arrays, out)
    return call(self, arrays, out)


@torch.compiler.assume_constant_result
def make_wanted(key: str, names: tuple[str, ...], sparse: bool, fold: tuple[str, ...], products: tuple) -> bool:
    _plain_wanting(_robot.ALIVE[key], names, sparse, fold, products)
    return True


def _wanting(self, names: tuple[str, ...], sparse: bool, fold: tuple[str, ...] = (), products: tuple = ()):
    """While torch.compile looks on, a robot is made behind its back, and then found."""
    if _is_traced():
        make_wanted(self._key, names, sparse, fold, products)
    return _plain_wanting(self, names, sparse, fold, products)


_robot.Robot._wanting = _wanting  # type: ignore[method-assign]
_call.__name__, _call.__doc__ = "__call__", _plain_call.__doc__
_robot.Robot.__call__ = _call  # type: ignore[method-assign]
