"""JAX: robots are called with its arrays, on a processor or a GPU, and are transformed.

    tau = robot(q, qd, qdd)                              # arrays of JAX, or tracers; arrays of NumPy may stand among them
    jax.grad(lambda q: robot(q, qd, qdd).sum())(q)       # by the text of the vector-Jacobian product
    jax.jvp(lambda q: robot(q, qd, qdd), (q,), (dq,))    # by the text of the Jacobian-vector product

jit, vmap, grad, vjp, jvp, jacrev, jacfwd, scan, checkpoint and shard_map work. vmap's axis becomes one more of the
samples: there is no loop. float32 and float64 arrays are taken; the latter want jax.config.update("jax_enable_x64",
True).

XLA calls the text by its foreign function interface: on a processor with the threads that the robot was loaded with,
on a GPU in XLA's own stream. It cannot divide a call among devices: a bare call gathers inputs that are sharded, and
each device computes all of them. Inside jax.shard_map each computes its own.

Derivatives are of all outputs but qdd_bound, which raises NotImplementedError when it is differentiated; by q, qd, qdd or
tau, what free= names, and wrenches of fext=. Those of several outputs are made in one sweep. Second ones are by the state:
jax.hessian, jax.grad of jax.jvp, or jax.jvp of jax.grad, which may be by what is free too. Derivatives by a quaternion
are those of the function on unit quaternions: the part along the quaternion is left out.
"""
from __future__ import annotations

from typing import Any, Sequence

import jax
import jax.numpy as jnp

from . import _arrays
from ._errors import BackendError

OLDEST = (0, 6)
if jax.__version_info__ < OLDEST:
    raise BackendError(f"JAX {jax.__version__} is too old: rneagen takes {'.'.join(map(str, OLDEST))} and later", "NO_XLA")

from . import _jax_operator  # noqa: E402

_jax_operator.register()


def check(robot, arrays: Sequence) -> tuple[int, ...]:
    """The axes of samples; what is wrong is a ValueError or a TypeError that names the input."""
    given = [(a, x) for a, x in zip(robot.inputs, arrays) if x is not None]
    _arrays.check_dtypes(given)
    first, like = given[0]
    scalar = _jax_operator.SCALARS[like.dtype]
    if robot.scalar == "f64" and scalar == "f32" and not jax.config.jax_enable_x64:
        raise TypeError(f"{first.name}: its dtype is float32, and precision {robot._options['precision']!r} takes float64, "
                        "which JAX has after jax.config.update('jax_enable_x64', True)")
    robot.precision_for(scalar)
    return _arrays.lead_of((a, tuple(x.shape)) for a, x in given)


def constant(values, shape: tuple[int, ...], like):
    """An array like `like` with values that are the same for all samples."""
    return jnp.broadcast_to(jnp.asarray(values, like.dtype), shape)


def gathered(arrays: list) -> list:
    """Whole on each device, where types tell how they are divided among the devices of the mesh that is set."""
    if not hasattr(jax, "set_mesh") or jax.sharding.get_abstract_mesh().empty:
        return arrays
    return [jax.sharding.reshard(x, jax.sharding.PartitionSpec()) if x is not None and any(jax.typeof(x).sharding.spec) else x
            for x in arrays]


def call(robot, arrays: Sequence[Any], out: Any):
    """A call whose arrays are JAX's."""
    if out is not None:
        raise TypeError("out: arrays of JAX cannot be written; a call returns new ones")
    given = [None if x is None else x if isinstance(x, jax.Array) else jnp.asarray(x) for x in arrays]
    if robot._conversion:
        return robot._conversion.call(gathered(given), None)
    operator = robot.__dict__.get("_jax") or _jax_operator.operator_of(robot)
    lead = check(robot, given)
    dtype = next(x for x in given if x is not None).dtype
    whole = [jnp.asarray(_arrays.fill(a, lead, dtype)) if x is None else x for a, x in zip(robot.inputs, given)]
    return robot._join(_jax_operator.run(operator, gathered(whole)))


def bind(robot, arrays: Sequence[Any], out: Any):
    raise TypeError("bind: arrays of JAX cannot be written; jax.jit is what makes calls cheaper there")
