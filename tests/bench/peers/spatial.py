"""The six functions over a batch, with matrices, for any library that has NumPy's names: v is [N, 6], q is [N, n]. Without
the axis N they are functions of one sample, which JAX's vmap and the tracer of straight.py take."""
import numpy as np

import model as robot

FUNCTIONS = ("rnea", "fpass", "bpass", "vxIv", "mxS", "cross_operator")


def cross_generator():
    """[6, 36]: v @ generator, as a matrix, is the cross operator [[w]x [v]x; 0 [w]x]."""
    generator = np.zeros((6, 6, 6))
    for i, unit in enumerate(np.eye(3)):
        generator[i, :3, 3:] = robot.skew(unit)
        generator[i + 3, :3, :3] = generator[i + 3, 3:, 3:] = robot.skew(unit)
    return generator.reshape(6, 36)


class Spatial:
    def __init__(self, library, model, array):
        """`array` makes the library's array, of the wanted precision and on the wanted device, of a NumPy array."""
        self.library, self.bodies = library, []
        self.generator = array(cross_generator())
        self.base = array(np.array([0, 0, robot.GRAVITY, 0, 0, 0]))
        for body in model.bodies:
            parts = [array(m) for m in robot.transform_parts(body)]
            self.bodies.append((body.parent, body.kind, parts, array(robot.subspace(body)), array(robot.inertia6(body))))
        self.S, self.I = self.bodies[-1][3:]  # of the last body, for the functions that take one

    def product(self, m, v):
        return self.library.einsum("...ij,...j->...i", m, v)

    def product_transposed(self, m, v):
        return self.library.einsum("...ji,...j->...i", m, v)

    def cross_operator(self, v):
        return (v @ self.generator).reshape(v.shape[:-1] + (6, 6))

    def mxS(self, v, S, qd):
        """v x S qd"""
        return self.product(self.cross_operator(v), qd[..., None] * S)

    def vxIv(self, v, I):
        """v x* I v = -(v x)^T I v"""
        return -self.product_transposed(self.cross_operator(v), v @ I)

    def transforms(self, q):
        """X(q) of all bodies."""
        result = []
        for i, (_, kind, (A, B, C), _, _) in enumerate(self.bodies):
            x = q[..., i, None, None]
            turns = kind == "revolute"
            result.append(A + self.library.sin(x) * B + self.library.cos(x) * C if turns else A + x * B)
        return result

    def forward(self, X, qd, qdd):
        """v = X v_p + S qd, a = X a_p + S qdd + v x S qd, f = I a + v x* I v"""
        v, a, f = [], [], []
        for i, (parent, _, _, S, I) in enumerate(self.bodies):
            speed = qd[..., i]
            own = speed[..., None] * S
            if parent < 0:
                v.append(own)
                a.append(X[i] @ self.base + qdd[..., i, None] * S)
            else:
                v.append(self.product(X[i], v[parent]) + own)
                a.append(self.product(X[i], a[parent]) + qdd[..., i, None] * S + self.mxS(v[i], S, speed))
            f.append(a[i] @ I + self.vxIv(v[i], I))
        return v, a, f

    def backward(self, X, f):
        """tau = S . f, f_p += X^T f"""
        f, tau = list(f), [None] * len(self.bodies)
        for i in reversed(range(len(self.bodies))):
            parent, _, _, S, _ = self.bodies[i]
            tau[i] = f[i] @ S
            if parent >= 0:
                f[parent] = f[parent] + self.product_transposed(X[i], f[i])
        return self.library.stack(tau, -1)

    def fpass(self, q, qd, qdd):
        return tuple(self.library.stack(x, -2) for x in self.forward(self.transforms(q), qd, qdd))

    def bpass(self, q, f):
        return self.backward(self.transforms(q), [f[..., i, :] for i in range(len(self.bodies))])

    def rnea(self, q, qd, qdd):
        X = self.transforms(q)
        return self.backward(X, self.forward(X, qd, qdd)[2])

    def function(self, name):
        """The function `name` of the arguments that vary from sample to sample."""
        if name == "mxS":
            return lambda v, qd: self.mxS(v, self.S, qd)
        if name == "vxIv":
            return lambda v: self.vxIv(v, self.I)
        return getattr(self, name)
