"""CasADi: a robot as a function in C, with exact first and second derivatives.

    f = rneagen.casadi.function(robot)                     # a casadi.Function: f(q, qd, qdd), or f(q=q, qd=qd, qdd=qdd)["tau"]
    rneagen.casadi.write(robot, "iiwa14_casadi.c")         # the same as a C file, for acados and for programs in C
    rneagen.casadi.integrate(robot, q, qd * dt)            # expressions: how positions move, and difference(robot, q0, q1)

Inputs and outputs are those of one sample, columns (n, 1) and matrices, by the names of robot.inputs and robot.outputs. Matrices
are sparse, as the robot is. Nothing calls back into Python: functions may be mapped over threads.

CasADi makes Jacobians by jac_NAME, gradients by adj1_NAME, and Hessians of weighted outputs, hessian(dot(lam, f(x)), x), by
jac_adj1_NAME. Other derivatives of derivatives, jacobian(jacobian(f(x), x), x) for one, and third ones CasADi refuses:
"Derivatives cannot be calculated". There are no finite differences.

With a floating base, outputs are functions of the seven numbers of q with the quaternion divided by its length, and derivatives
are by these numbers. They have no part along the quaternion. A quaternion of zeros makes results that are no numbers. So it is
with integrate and difference.
"""
from __future__ import annotations

import atexit
import os
import re
import secrets
import shutil
import tempfile
from pathlib import Path
from typing import Any

from . import _core, _lie, _robot
from ._casadi_c import identifier, is_taken
from ._casadi_model import Model
from ._casadi_text import File
from ._errors import translated

_lock = _robot.Lock()
_folders: dict[int, str] = {}  # of shared objects, which CasADi may load again as long as this program runs; by process


def text(robot, name: str | None = None, derivatives: int = 2, forward: bool = False) -> str:
    """The C file; see write."""
    return _text(robot, _name(robot, name), derivatives, forward)


def write(robot, path: str | os.PathLike, name: str | None = None, derivatives: int = 2, forward: bool = False) -> str:
    """Write a C file with the function `name`, unless given the robot's name, and its derivatives, in CasADi's C interface: NAME,
    NAME_n_in, NAME_name_in, NAME_sparsity_in, NAME_work, ... It needs no header of CasADi's or ours: cc -O2 -fPIC -shared FILE.c
    -o FILE.so -lm. Returns the name. The file appears whole or not at all.

    derivatives=2   the highest order: 1 leaves out Hessians, 0 Jacobians and gradients too
    forward=False   also fwd1_NAME, a derivative along a direction; CasADi then makes Jacobians by it, one column or
                    group of columns at a time, which takes longer than jac_NAME

    Raises ValueError for a robot that CasADi cannot take: of precision f32 or mixed, a floating base of convention "mujoco";
    unless derivatives=0 for outputs that have none, qdd_bound and products; unless derivatives=1 for what is free (mass.LINK,
    gravity, ...) where second derivatives by two such numbers are not always zero, for texts have none. Torques have none,
    but by offset.JOINT and by gravity beside masses."""
    name = _name(robot, name)
    _put(path, _text(robot, name, derivatives, forward))
    return name


def function(robot, name: str | None = None, derivatives: int = 2, forward: bool = False, **options: Any):
    """A casadi.Function of a robot of rneagen.load, by the file of `write`, compiled by the C compiler that the package takes
    (RNEA_CC) for this processor, and kept in its cache (RNEA_CACHE). `options` are those of casadi.external.

        f = rneagen.casadi.function(robot.want("tau", "M"), name="arm")
        tau, M = f(q, qd, qdd)

    An input that is left out is what CasADi takes for it, zeros, or the URDF's value where one number tells it (mass.LINK,
    payload.LINK); gravity and inertia.LINK left out make results that are no numbers. Raises what write does, BackendError where
    there is no C compiler, and ImportError where there is no CasADi."""
    casadi = _casadi()
    name = _name(robot, name)
    cache = {k: robot._options[k] for k in ("cache",) if robot._options.get(k) is not None}
    made = translated(_core.compile, _text(robot, name, derivatives, forward), {"file": f"{name}.c", **cache})
    return casadi.external(name, _kept(name, made), options)


# ---- positions, by the formulas of _lie.py ----


def integrate(robot, q: Any, v: Any) -> Any:
    """robot.integrate of q (nq, 1) and v (nv, 1), of SX, MX or DM: an expression, whose derivatives are finite also where nothing
    moves."""
    return _joined(robot, {"q": (q, robot.nq), "v": (v, robot.nv)}, lambda q, v: q + v, _moved)


def difference(robot, q0: Any, q1: Any) -> Any:
    """robot.difference of q0 and q1 (nq, 1): the velocity (nv, 1) by which integrate makes q1 of q0."""
    return _joined(robot, {"q0": (q0, robot.nq), "q1": (q1, robot.nq)}, lambda q0, q1: q1 - q0, _between)


def _joined(robot, given: dict[str, tuple[Any, int]], plain, floating) -> Any:
    """Coordinates by `plain`, floating joints by `floating`."""
    casadi, columns = _casadi(), []
    if robot._conversion:
        raise TypeError(f"convention {robot.convention!r}: positions move by velocities of convention 'pinocchio'")
    for name, (x, rows) in given.items():
        x = x if isinstance(x, (casadi.SX, casadi.MX)) else casadi.DM(x)
        if x.shape != (rows, 1):
            raise ValueError(f"{name}: its shape is {x.shape}; {(rows, 1)} is wanted")
        columns.append((x, *(("iv", "nv") if name == "v" else ("iq", "nq"))))
    return casadi.vertcat(*((floating if joint["nq"] != joint["nv"] else plain)(
        *(x[joint[i]:joint[i] + joint[n]] for x, i, n in columns)) for joint in robot.joints))


def _turned(u, v):
    casadi = _casadi()
    across = casadi.cross(u[:3], v)
    return v + 2 * (u[3] * across + casadi.cross(u[:3], across))


def _product(u, w):
    casadi = _casadi()
    return casadi.vertcat(u[3] * w[:3] + w[3] * u[:3] + casadi.cross(u[:3], w[:3]), u[3] * w[3] - casadi.dot(u[:3], w[:3]))


def _unit(u):
    return u / _casadi().norm_2(u)


def _near(xx):
    """Is it so small that series are taken; and it, or 1 there, so that what is not taken is finite."""
    is_near = xx < _lie.NEAR
    return is_near, _casadi().if_else(is_near, 1, xx)


def _moved(q, v):
    casadi = _casadi()
    a, b, u = v[:3], v[3:], _unit(q[3:])
    tt = casadi.dot(b, b)
    is_near, far = _near(tt)
    t = casadi.sqrt(far)
    half = casadi.if_else(is_near, 0.5 - tt / 48 + tt**2 / 3840, casadi.sin(t / 2) / t)
    scalar = casadi.if_else(is_near, 1 - tt / 8 + tt**2 / 384 - tt**3 / 46080, casadi.cos(t / 2))
    C = casadi.if_else(is_near, 1 / 6 - tt / 120 + tt**2 / 5040, (t - casadi.sin(t)) / (far * t))
    across = casadi.cross(b, a)
    step = a + 2 * half**2 * across + C * casadi.cross(b, across)
    return casadi.vertcat(q[:3] + _turned(u, step), _unit(_product(u, casadi.vertcat(half * b, scalar))))


def _between(q0, q1):
    casadi = _casadi()
    u = _unit(q0[3:])
    back = casadi.vertcat(-u[:3], u[3])
    r = _product(back, _unit(q1[3:]))
    r = casadi.if_else(r[3] < 0, -r, r)
    w, s, nn = r[:3], r[3], casadi.dot(r[:3], r[:3])
    is_near, far = _near(nn)
    near = casadi.if_else(is_near, s, 1)
    n, x = casadi.sqrt(far), nn / near**2
    b = w * casadi.if_else(is_near, 2 / near * (1 - x / 3 + x**2 / 5 - x**3 / 7 + x**4 / 9), 2 * casadi.atan2(n, s) / n)
    tt = casadi.dot(b, b)
    is_near, far = _near(tt)
    t = casadi.sqrt(far)
    D = casadi.if_else(is_near, 1 / 12 + tt / 720 + tt**2 / 30240, (1 - t / 2 * casadi.cos(t / 2) / casadi.sin(t / 2)) / far)
    step = _turned(back, q1[:3] - q0[:3])
    across = casadi.cross(b, step)
    return casadi.vertcat(step - across / 2 + D * casadi.cross(b, across), b)


# ---- files ----


def _casadi():
    try:
        import casadi
    except ImportError as error:
        raise ImportError(f"rneagen.casadi.function needs CasADi: pip install casadi ({error}); write() makes the C file without",
                          name=error.name) from None
    return casadi


def _name(robot, name: str | None) -> str:
    if name is None:
        name = identifier(robot.name) or "robot"
        return f"robot_{name}" if name[0].isdigit() or is_taken(name) else name
    if not re.fullmatch("[A-Za-z](_?[A-Za-z0-9])*_?", name, re.ASCII) or is_taken(name):
        raise ValueError(f"name: {name!r} is no name of a function of CasADi: letters, digits and single underscores, first a "
                         "letter, and no word of C, of its <math.h> or of CasADi")
    return name


def _text(robot, name: str, derivatives: int, forward: bool) -> str:
    if derivatives not in (0, 1, 2):
        raise ValueError(f"derivatives takes 0, 1 or 2, not {derivatives!r}")
    if forward and not derivatives:
        raise ValueError("forward=True is a first derivative: take it with derivatives=1 or 2")
    return str(File(Model(robot, derivatives), name, derivatives, forward))


def _put(path: str | os.PathLike, text: str) -> None:
    """The whole file or nothing: what is there stays till the text is written. Devices and pipes are written in place."""
    try:
        if os.fspath(path).startswith("/dev/") or (os.path.exists(path) and not os.path.isfile(path)):
            Path(path).write_text(text, encoding="utf-8")
            return
        target = Path(os.path.realpath(path))
        part = target.with_name(f".{secrets.token_hex(8)}.part")
        try:
            with open(part, "x", encoding="utf-8") as file:
                file.write(text)
            os.replace(part, target)
        except BaseException:
            part.unlink(missing_ok=True)
            raise
    except OSError as error:
        raise OSError(error.errno, error.strerror, os.fspath(path)) from None


def _remove(folder: str, owner: int) -> None:
    """Unless this is a fork of the program that made it."""
    if os.getpid() == owner:
        shutil.rmtree(folder, ignore_errors=True)


def _kept(name: str, data: bytes) -> str:
    """A path of a new file with this shared object; it lives as long as the program."""
    owner = os.getpid()
    with _lock:
        if owner not in _folders:
            _folders[owner] = tempfile.mkdtemp(prefix="rneagen-casadi-")
            atexit.register(_remove, _folders[owner], owner)
    descriptor, path = tempfile.mkstemp(".so", f"{name[:100]}-", _folders[owner])
    with open(descriptor, "wb") as file:
        file.write(data)
    return path
