"""Robots as primitives of JAX: a call, which XLA makes by its foreign function interface (src/xla.c), and the
tangents of its outputs, which are linear in the tangents of the inputs, and whose transpose is the gradient."""
from __future__ import annotations

import dataclasses
import hashlib
from typing import Any, Sequence

import jax
import jax.numpy as jnp
import numpy
from jax.extend.core import Primitive
from jax.interpreters import ad, batching, mlir, partial_eval

from . import _arrays, _core, _gradient, _robot
from ._errors import BackendError

TARGET = "rneagen"
SCALARS = {numpy.dtype("float32"): "f32", numpy.dtype("float64"): "f64"}
lock = _robot.Lock()
_operators: dict[str, "Operator"] = {}


def register() -> None:
    """Give XLA the handlers, where this package was built with them."""
    for platform, handler in _core.xla_handlers().items():
        jax.ffi.register_ffi_target(TARGET, handler, platform=platform)


class Operator:
    """A robot as JAX's programs name it. It lives as long as the program, for JAX keeps what it traced."""

    def __init__(self, robot, name: str):
        self.robot, self.name = robot, name
        self.gradients = _gradient.Gradients(robot, LIBRARY)
        self.function = jax.jit(lambda *arrays: call_p.bind(*arrays, operator=self), inline=True)
        self.kept: dict[tuple[str, str], int] = {}

    def __repr__(self) -> str:
        return self.name

    def keep(self, platform: str, scalar: str) -> int:
        """Compile the text for arrays of "f32" or "f64" on this platform; the number by which XLA's programs name it."""
        with lock:
            if (platform, scalar) not in self.kept:
                precision = self.robot.precision_for(scalar)
                number = int.from_bytes(hashlib.sha256(f"{self.name} {precision}".encode()).digest()[:8], "little", signed=True)
                for device in [-1] if platform == "cpu" else [d.local_hardware_id for d in jax.local_devices(backend=platform)]:
                    kernel = self.robot.kernel(precision) if device < 0 else self.robot.kernel(precision, "cuda", device)
                    _core.xla_keep(number, kernel, device)
                self.kept[platform, scalar] = number
            return self.kept[platform, scalar]


def operator_of(robot) -> Operator:
    """BackendError where this package was built without handlers."""
    if not _core.xla_handlers():
        raise BackendError("this build of rneagen takes no arrays of JAX, for XLA's header was not there: build it again "
                           "where jaxlib is installed", "NO_XLA")
    return _robot.operator_of(robot, "_jax", _operators, lock, lambda name: Operator(robot, name))


# ---- shard_map ----


def varying(x) -> frozenset:
    """The axes of a mesh along which it differs, inside of shard_map."""
    aval = jax.typeof(x)
    return aval.vma if hasattr(aval, "vma") else getattr(getattr(aval, "mat", None), "varying", frozenset())


def alike(arrays: Sequence) -> Sequence:
    """Inside of shard_map all arrays differ along the same axes, which JAX wants of each primitive's."""
    if not any(isinstance(x, jax.core.Tracer) for x in arrays):
        return arrays
    axes = [varying(x) for x in arrays]
    every = frozenset().union(*axes)
    return [x if own == every else vary(x, tuple(every - own)) for x, own in zip(arrays, axes)]


def vary(x, axes: tuple):
    return jax.lax.pcast(x, axes, to="varying") if hasattr(jax.lax, "pcast") else jax.lax.pvary(x, axes)


# ---- a call ----


def compiled(function, *static: str):
    """A primitive computes by compiled programs alone: also where jax.disable_jit has all others run step by step."""
    program = jax.jit(function, static_argnames=static)

    def run(*args, **kwargs):
        with jax.disable_jit(False):
            return program(*args, **kwargs)
    return run


call_p = Primitive("rneagen_call")
call_p.multiple_results = True
call_p.def_impl(compiled(call_p.bind, "operator"))


def run(operator: Operator, arrays: Sequence) -> tuple:
    return tuple(operator.function(*alike(arrays)))


@call_p.def_abstract_eval
def shapes(*avals, operator):
    lead = _arrays.samples_of(operator.robot.inputs, avals)
    return [avals[0].update(shape=(*lead, *a.shape), weak_type=False) for a in operator.robot.outputs]


def lower(platform: str):
    def rule(ctx, *operands, operator):
        number = operator.keep(platform, SCALARS[ctx.avals_in[0].dtype])
        return jax.ffi.ffi_lowering(TARGET)(ctx, *operands, robot=numpy.int64(number))
    mlir.register_lowering(call_p, rule, platform=platform)


lower("cpu")
lower("cuda")


def size_of(args: Sequence, dims: Sequence) -> int:
    return next(x.shape[d] for x, d in zip(args, dims) if d is not None)


def to_front(array, x, dim, size: int):
    """vmap's axis becomes one more of the samples."""
    if array.per_batch and dim is None:
        return x
    return jnp.broadcast_to(x, (size, *x.shape)) if dim is None else jnp.moveaxis(x, dim, 0)


def spread(array, x, lead: tuple[int, ...]):
    """A constant, or its tangent, with the axis of vmap alone, with all axes of samples or without, for each sample."""
    own = x.reshape(lead[0], *[1] * (len(lead) - 1), *array.shape) if x.ndim == len(array.shape) + 1 else x
    return jnp.broadcast_to(own, (*lead, *array.shape))


def to_samples(operator: Operator, args: Sequence, dims: Sequence, size: int):
    """Of inputs under vmap: the operator that takes them, where constants that have vmap's axis are one for each sample;
    them; the axes of samples; and these constants."""
    inputs, word = operator.robot.inputs, operator.gradients.constant_of
    apart = {word(a) for a, d in zip(inputs, dims) if a.per_batch and d is not None}
    moved = [to_front(a, x, d, size) for a, x, d in zip(inputs, args, dims)]
    lead = _arrays.samples_of(inputs, moved) or (size,)
    if apart:
        moved = [spread(a, x, lead) if a.per_batch and word(a) in apart else x for a, x in zip(inputs, moved)]
        operator = operator_of(operator.gradients.robot_apart(tuple(sorted(apart))))
    return operator, moved, lead, apart


def batch(args, dims, *, operator):
    operator, moved, _, _ = to_samples(operator, args, dims, size_of(args, dims))
    outputs = run(operator, moved)
    return outputs, (0,) * len(outputs)


batching.primitive_batchers[call_p] = batch


def differentiate(primals, tangents, *, operator):
    outputs = call_p.bind(*primals, operator=operator)
    return outputs, tangents_of(operator, range(len(outputs)), outputs, primals, tangents)


ad.primitive_jvps[call_p] = differentiate


# ---- tangents of outputs ----

tangent_p = Primitive("rneagen_tangent")
tangent_p.multiple_results = True


def tangents_of(operator: Operator, of: Sequence[int], values: Sequence, primals: Sequence, tangents: Sequence) -> list:
    """Of these outputs, from the tangents that are not zero: by one call, but what has none is refused only where it is used."""
    given = tuple(i for i, d in enumerate(tangents) if type(d) is not ad.Zero)
    if not given:
        return [ad.Zero.from_primal_value(x) for x in values]
    outputs = operator.robot.outputs
    sound = tuple(i for i in of if outputs[i].role not in _gradient.REFUSED)
    found = {}
    for some in (*([sound] if sound else []), *((i,) for i in of if i not in sound)):
        found.update(zip(some, tangent_p.bind(*primals, *(tangents[i] for i in given), operator=operator, of=some, given=given)))
    return [found[i] for i in of]


def compute(*args, operator, of, given):
    """`given`: the inputs whose tangents stand after the inputs."""
    robot = operator.robot
    tangents: list[Any] = [None] * len(robot.inputs)
    for i, d in zip(given, args[len(robot.inputs):]):
        tangents[i] = d
    return operator.gradients.forward([robot.outputs[i] for i in of], args[:len(robot.inputs)], tangents)


tangent_p.def_impl(compiled(compute, "operator", "of", "given"))
mlir.register_lowering(tangent_p, mlir.lower_fun(compute, multiple_results=True))


@tangent_p.def_abstract_eval
def tangent_shapes(*avals, operator, of, given):
    lead = _arrays.samples_of(operator.robot.inputs, avals)
    return [avals[0].update(shape=(*lead, *operator.robot.outputs[i].shape), weak_type=False) for i in of]


def batch_tangent(args, dims, *, operator, of, given):
    inputs, count, word = operator.robot.inputs, len(operator.robot.inputs), operator.gradients.constant_of
    operator, moved, lead, apart = to_samples(operator, args[:count], dims[:count], size_of(args, dims))
    moved += [tangent_to_front(inputs[i], x, d, lead, word(inputs[i]) in apart)
              for i, x, d in zip(given, args[count:], dims[count:])]
    return tangent_p.bind(*moved, operator=operator, of=of, given=given), (0,) * len(of)


def tangent_to_front(array, x, dim, lead: tuple[int, ...], is_apart: bool):
    """As to_front; the tangent of a constant of the whole batch has all axes of samples then, and with `is_apart` always."""
    own = x.ndim - (dim is not None) == len(array.shape)
    if is_apart and own:
        return spread(array, x if dim is None else jnp.moveaxis(x, dim, 0), lead)
    if not array.per_batch or dim is None and not own:
        return to_front(dataclasses.replace(array, per_batch=False), x, dim, lead[0])
    if dim is None:
        return x
    return spread(array, jnp.moveaxis(x, dim, 0), lead)


batching.primitive_batchers[tangent_p] = batch_tangent


def transpose(weights, *args, operator, of, given):
    robot, count = operator.robot, len(operator.robot.inputs)
    by_output: list[Any] = [None] * len(robot.outputs)
    for i, w in zip(of, weights):
        by_output[i] = None if type(w) is ad.Zero else w
    wanted = {i: d.aval for i, d in zip(given, args[count:]) if ad.is_undefined_primal(d)}
    apart = tuple(robot.inputs[i].word for i, aval in wanted.items() if len(aval.shape) > len(robot.inputs[i].shape))
    parts = operator.gradients.backward(args[:count], by_output, [i in wanted for i in range(count)], apart)
    return [None] * count + [None if i not in wanted else ad.Zero(wanted[i]) if parts[i] is None else parts[i] for i in given]


ad.primitive_transposes[tangent_p] = transpose


def differentiate_tangent(args, tangents, *, operator, of, given):
    """They are linear in tangents; by the inputs they vary as the text does that computes them."""
    count = len(operator.robot.inputs)
    if any(type(d) is not ad.Zero for d in tangents[:count]):
        moved = [i for i, d in enumerate(tangents) if type(d) is not ad.Zero]

        def function(*some):
            every = dict(enumerate(args)) | dict(zip(moved, some))
            return compute(*every.values(), operator=operator, of=of, given=given)
        return jax.jvp(function, [args[i] for i in moved], [tangents[i] for i in moved])
    values = tangent_p.bind(*args, operator=operator, of=of, given=given)
    among: list[Any] = [ad.Zero.from_primal_value(x) for x in args[:count]]
    for i, d in zip(given, tangents[count:]):
        among[i] = d
    return values, tangents_of(operator, of, values, args[:count], among)


ad.primitive_jvps[tangent_p] = differentiate_tangent


def drop_unused(used: Sequence[bool], equation):
    """Outputs whose tangents a program does not use are of no text."""
    if not any(used):
        return [False] * len(equation.invars), None
    of = tuple(i for i, is_used in zip(equation.params["of"], used) if is_used)
    left = [x for x, is_used in zip(equation.outvars, used) if is_used]
    return [True] * len(equation.invars), equation.replace(outvars=left, params={**equation.params, "of": of})


partial_eval.dce_rules[tangent_p] = drop_unused

LIBRARY = _gradient.Library(
    run=lambda robot, arrays: run(operator_of(robot), arrays), zeros=lambda like, shape: jnp.zeros(shape, like.dtype),
    expand=jnp.broadcast_to, join=lambda parts: jnp.concatenate(parts, -1), cross=jnp.cross)
