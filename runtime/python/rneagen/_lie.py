"""How positions move by velocities, and back, for arrays of NumPy, PyTorch, JAX and CuPy. Joints whose q is coordinates alone
add; a floating joint's position p and unit quaternion u move by a twist (a, b) of its own frame, a and b constant along the way,

    p' = p + R(u) V a,  u' = u exp(b/2),  V = I + B [b] + C [b]^2,  B = (1 - cos t)/t^2,  C = (t - sin t)/t^3,  t = |b|

[b] x is the cross product b x x. Near t = 0 the fractions are their series, so that gradients are finite there. (Sola, Deray and
Atchuthan, A micro Lie theory, 2018.)"""
from __future__ import annotations

import importlib
from typing import Any

import numpy

from . import _arrays, _names

NEAR = 1e-3  # t^2 below which the series are exact to 1e-15


FEW = 300  # numbers of an array


def namespace(**given: Any):
    """The module that has the functions for arrays of these kinds, its cross product along the last axis, and the arrays with one
    type of numbers."""
    name, kind = _arrays.kind_of_all(given)
    kind = kind.partition(" ")[2]
    if kind not in ("NumPy", "PyTorch", "JAX", "cupy"):
        raise TypeError(f"{name}: an array of NumPy, PyTorch, JAX or CuPy is wanted")
    if kind == "PyTorch":  # a statement that torch.compile sees through
        import torch
        return torch, torch.linalg.cross, *alike(given, torch.is_autocast_enabled, lambda x, word: x.to(getattr(torch, word)))
    made = importlib.import_module({"NumPy": "numpy", "JAX": "jax.numpy", "cupy": "cupy"}[kind])
    if kind == "JAX":
        given = {name: made.asarray(x) for name, x in given.items()}
    # JAX has float32 for float, unless jax_enable_x64 is on
    cross = cross_of_numpy if made is numpy else made.cross
    return made, cross, *alike(given, None, lambda x, word: x.astype(float if word == "float64" else word))


def alike(given: dict[str, Any], is_autocast, to) -> list:
    """Whole numbers become float64, as does float32 beside it; where autocast is on, halves float32. Others are a TypeError."""
    words = {name: str(x.dtype).rpartition(".")[2] for name, x in given.items()}
    for name, word in words.items():
        if word.startswith(("int", "uint")):
            words[name] = "float64"
        elif word in ("float16", "bfloat16") and is_autocast and is_autocast(given[name].device.type):
            words[name] = "float32"
        elif word not in ("float32", "float64"):
            raise TypeError(f"{name}: its dtype is {given[name].dtype}; float32, float64 or whole numbers are wanted")
    common = max(words.values())
    return [x if str(x.dtype).endswith(common) else to(x, common) for x in given.values()]


def cross_of_numpy(u, v):
    """Of a few samples numpy.cross takes several times as long."""
    if v.size > FEW:
        return numpy.cross(u, v)
    return u[..., [1, 2, 0]] * v[..., [2, 0, 1]] - u[..., [2, 0, 1]] * v[..., [1, 2, 0]]


def total(x):
    return x.sum(-1)[..., None]


def turned(cross, u, v):
    """v rotated by the unit quaternion u."""
    across = cross(u[..., :3], v)
    return v + 2 * (u[..., 3:] * across + cross(u[..., :3], across))


def product(xp, cross, u, w):
    """Of quaternions x y z s."""
    a, s, b, t = u[..., :3], u[..., 3:], w[..., :3], w[..., 3:]
    return xp.concatenate((s * b + t * a + cross(a, b), s * t - total(a * b)), -1)


def inverse(xp, u):
    return xp.concatenate((-u[..., :3], u[..., 3:]), -1)


def unit(xp, u):
    return u / xp.sqrt(total(u * u))


def moved(xp, cross, q, v):
    """A floating joint's q by its twist."""
    a, b, u = v[..., :3], v[..., 3:], unit(xp, q[..., 3:])
    tt = total(b * b)
    is_near = tt < NEAR
    far = xp.where(is_near, xp.ones_like(tt), tt)
    t = xp.sqrt(far)
    half = xp.where(is_near, 0.5 - tt / 48 + tt * tt / 3840, xp.sin(t / 2) / t)  # sin(t/2)/t
    scalar = xp.where(is_near, 1 - tt / 8 + tt * tt / 384 - tt * tt * tt / 46080, xp.cos(t / 2))
    C = xp.where(is_near, 1 / 6 - tt / 120 + tt * tt / 5040, (t - xp.sin(t)) / (far * t))
    across = cross(b, a)
    step = a + 2 * half * half * across + C * cross(b, across)
    turn = xp.concatenate((half * b, scalar), -1)
    return xp.concatenate((q[..., :3] + turned(cross, u, step), unit(xp, product(xp, cross, u, turn))), -1)


def between(xp, cross, q0, q1):
    """The twist by which q0 becomes q1, turning by pi at most."""
    back = inverse(xp, unit(xp, q0[..., 3:]))
    r = product(xp, cross, back, unit(xp, q1[..., 3:]))
    r = xp.where(r[..., 3:] < 0, -r, r)
    w, s = r[..., :3], r[..., 3:]
    nn = total(w * w)
    is_near = nn < NEAR
    far = xp.where(is_near, xp.ones_like(nn), nn)
    near = xp.where(is_near, s, xp.ones_like(s))  # not 0, which would make gradients of what is not taken NaN
    n, x = xp.sqrt(far), nn / (near * near)
    b = w * xp.where(is_near, 2 / near * (1 - x / 3 + x * x / 5 - x * x * x / 7 + x * x * x * x / 9), 2 * xp.arctan2(n, s) / n)
    tt = total(b * b)
    is_near = tt < NEAR
    far = xp.where(is_near, xp.ones_like(tt), tt)
    t = xp.sqrt(far)
    D = xp.where(is_near, 1 / 12 + tt / 720 + tt * tt / 30240, (1 - t / 2 * xp.cos(t / 2) / xp.sin(t / 2)) / far)
    step = turned(cross, back, q1[..., :3] - q0[..., :3])
    across = cross(b, step)
    return xp.concatenate((step - across / 2 + D * cross(b, across), b), -1)


def joined(robot, xp, plain, floating):
    """Coordinates by `plain` of (rows of q, rows of v), floating joints by `floating`."""
    pieces, iq, iv = [], 0, 0
    for joint in robot.joints:
        if joint["nq"] == joint["nv"]:
            continue
        pieces += [plain(slice(iq, joint["iq"]), slice(iv, joint["iv"]))] if joint["iq"] > iq else []
        iq, iv = joint["iq"] + joint["nq"], joint["iv"] + joint["nv"]
        pieces.append(floating(slice(joint["iq"], iq), slice(joint["iv"], iv)))
    pieces += [plain(slice(iq, None), slice(iv, None))] if iq < robot.nq else []
    return xp.concatenate(pieces, -1) if len(pieces) > 1 else pieces[0]


def integrate(robot, q, v):
    _names.lead_of([("q", q, robot.nq), ("v", v, robot.nv)])
    xp, cross, q, v = namespace(q=q, v=v)
    move = robot._conversion.moved if robot._conversion else moved
    return joined(robot, xp, lambda i, k: q[..., i] + v[..., k], lambda i, k: move(xp, cross, q[..., i], v[..., k]))


def difference(robot, q0, q1):
    _names.lead_of([("q0", q0, robot.nq), ("q1", q1, robot.nq)])
    xp, cross, q0, q1 = namespace(q0=q0, q1=q1)
    differ = robot._conversion.between if robot._conversion else between
    return joined(robot, xp, lambda i, k: q1[..., i] - q0[..., i], lambda i, k: differ(xp, cross, q0[..., i], q1[..., i]))


def neutral(robot, dtype) -> numpy.ndarray:
    q = numpy.zeros(robot.nq, dtype)
    for joint in robot.joints:
        if joint["nq"] != joint["nv"]:
            q[joint["iq"] + (3 if robot._conversion else 6)] = 1
    return q
