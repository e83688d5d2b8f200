"""fpass, bpass and the three spatial operations in extended precision, written with vectors of three and rotations, so
that nothing of spatial.py's matrices is in them. Arrays are [N, ...] of longdouble."""
import numpy as np

import model as robot

WIDE = np.longdouble


def rows(rotation, vectors):
    """rotation[N] vectors[N]"""
    return np.einsum("nij,nj->ni", rotation, vectors)


def turned(body, q):
    """The rotations from the body's coordinates to its parent's and the offsets, of Rodrigues' formula."""
    a, k = body.axis.astype(WIDE), robot.skew(body.axis).astype(WIDE)
    place = body.rotation.astype(WIDE)
    offset = np.broadcast_to(body.offset.astype(WIDE), (len(q), 3))
    if body.kind == "prismatic":
        return np.broadcast_to(place, (len(q), 3, 3)), offset + q[:, None] * (place @ a)
    s, c = np.sin(q)[:, None, None], np.cos(q)[:, None, None]
    return place @ (np.eye(3) + s * k + (1 - c) * (k @ k)), offset


def wrench(body, w, dw, acceleration):
    """Force and moment about the origin that give the body this motion: Newton about the centre of mass, and Euler."""
    h, inertia = body.moment.astype(WIDE), body.rotational.astype(WIDE)
    force = body.mass * acceleration + np.cross(dw, h) + np.cross(w, np.cross(w, h))
    moment = dw @ inertia + np.cross(w, w @ inertia) + np.cross(h, acceleration)
    return np.concatenate([force, moment], 1)


def fpass(model, q, qd, qdd):
    """v, a, f [N, n, 6]; a is the spatial acceleration, whose linear part is that of the origin less w x v."""
    zero, state, v, a, f = np.zeros((len(q), 3), WIDE), [], [], [], []
    up = zero + np.array([0, 0, robot.GRAVITY])
    for i, body in enumerate(model.bodies):
        place, offset = turned(body, q[:, i])
        w, dw, velocity, acceleration = state[body.parent] if body.parent >= 0 else (zero, zero, zero, up)
        back, axis = place.transpose(0, 2, 1), body.axis.astype(WIDE)
        velocity = rows(back, velocity + np.cross(w, offset))
        acceleration = rows(back, acceleration + np.cross(dw, offset) + np.cross(w, np.cross(w, offset)))
        w, dw = rows(back, w), rows(back, dw)
        own, gain = qd[:, i, None] * axis, qdd[:, i, None] * axis
        if body.kind == "revolute":
            dw = dw + gain + np.cross(w, own)
            w = w + own
        else:
            velocity, acceleration = velocity + own, acceleration + gain + 2 * np.cross(w, own)
        state.append((w, dw, velocity, acceleration))
        v.append(np.concatenate([velocity, w], 1))
        a.append(np.concatenate([acceleration - np.cross(w, velocity), dw], 1))
        f.append(wrench(body, w, dw, acceleration))
    return tuple(np.stack(x, 1) for x in (v, a, f))


def bpass(model, q, f):
    """tau [N, n]"""
    f, tau = f.copy(), np.zeros(q.shape, WIDE)
    for i in reversed(range(model.n)):
        body = model.bodies[i]
        force, moment = f[:, i, :3], f[:, i, 3:]
        tau[:, i] = (moment if body.kind == "revolute" else force) @ body.axis.astype(WIDE)
        if body.parent >= 0:
            place, offset = turned(body, q[:, i])
            force, moment = rows(place, force), rows(place, moment)
            f[:, body.parent] += np.concatenate([force, moment + np.cross(offset, force)], 1)
    return tau


def cross_operator(v):
    """Column j is v x e_j."""
    return np.stack([cross(v, np.broadcast_to(e, v.shape)) for e in np.eye(6)], 2)


def cross(v, m):
    """v x m of motions: (w x m_v + v x m_w, w x m_w)"""
    linear, w = v[:, :3], v[:, 3:]
    return np.concatenate([np.cross(w, m[:, :3]) + np.cross(linear, m[:, 3:]), np.cross(w, m[:, 3:])], 1)


def mxS(model, v, qd):
    return cross(v, qd[:, None] * robot.subspace(model.bodies[-1]).astype(WIDE))


def vxIv(model, v):
    """v x* h = (w x h_v, w x h_w + v x h_v) with h = I v of the last body"""
    body, linear, w = model.bodies[-1], v[:, :3], v[:, 3:]
    moment, inertia = body.moment.astype(WIDE), body.rotational.astype(WIDE)
    h = body.mass * linear + np.cross(w, moment)
    angular = w @ inertia + np.cross(moment, linear)
    return np.concatenate([np.cross(w, h), np.cross(w, angular) + np.cross(linear, h)], 1)
