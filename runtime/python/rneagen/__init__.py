"""rneagen: inverse and forward dynamics of one robot, as straight-line code made from its URDF.

    import rneagen
    robot = rneagen.load("iiwa14.urdf")       # the scene by keywords: want=, lock={...}, tip=[...], base="floating", ...
    tau = robot(q, qd, qdd)                   # NumPy, PyTorch, CuPy or JAX; (nv,) or (..., nv); the same kind comes back
    H = robot.want("M", "bias")(q, qd)        # several outputs: a named tuple
    tau.sum().backward()                      # tensors of PyTorch have gradients: help(rneagen.torch)
    jax.grad(lambda q: robot(q, qd, qdd).sum())(q)  # of JAX too: help(rneagen.jax)
    rneagen.casadi.function(robot)            # a function of CasADi, with Hessians: help(rneagen.casadi)

SI units: m, kg, s, rad, N, N m. q has one entry for each joint that moves, depth-first, children by name; a floating
base comes first.

load         a Robot, which is called with arrays
generate     the text, CUDA C or C
report       every variant measured: speed and error
choose       the fastest that is close enough
"""
import importlib
from typing import TYPE_CHECKING

from ._commands import Choice, Text, choose, generate, report
from ._core import version as __version__
from ._errors import BackendError, Error, RobotError
from ._robot import Limits, Robot, load
from ._sparse import Sparse

__all__ = ["BackendError", "Choice", "Error", "Limits", "Robot", "RobotError", "Sparse", "Text", "__version__", "choose",
           "generate", "load", "report"]

if TYPE_CHECKING:
    from . import casadi as casadi, jax as jax, torch as torch
else:
    def __getattr__(name: str):
        """rneagen.casadi, rneagen.jax and rneagen.torch, which import what they are for, by their names alone. dir() has none of
        them: help() imports all that it has."""
        if name not in ("casadi", "jax", "torch"):
            raise AttributeError(f"module 'rneagen' has no attribute '{name}'")
        return importlib.import_module(f"rneagen.{name}")
