"""MuJoCo's convention of a floating base, on top of the library's, which is Pinocchio's. Arrays of NumPy, PyTorch, JAX
and CuPy are converted at every call by functions of their own library, which differentiates through them.

    pinocchio   q = x y z qx qy qz qw; qd = the twist in the base's frame, linear then angular; qdd its componentwise
                derivative; tau = force then moment, in the base's frame
    mujoco      q = x y z qw qx qy qz; qd = linear velocity in the world's frame, angular velocity in the base's; qdd
                its derivative, so the linear part is the classical acceleration; tau = force in the world's frame,
                moment in the base's

With R the base's rotation, v_world = R v, w the same: qdd_world = R (a + w x v), f_world = R f, M_world = T M T' with
T = diag(R, 1).
"""
from __future__ import annotations

from typing import Any, NamedTuple, Sequence

from . import _arrays, _lie, _names
from ._gradient import FREED, PARTS

VECTORS = ("joint_torque", "gravity_torque")  # outputs that are forces
MATRICES = ("mass_matrix", "mass_matrix_inverse")
OTHERS = ("power", "kinetic_energy", "potential_energy", "link_twist", "link_acceleration", "joint_wrench", "body_twists",
          "link_pose", "center_of_mass", "center_of_mass_velocity", "momentum", "momentum_rate", "contact_force",
          "contact_wrench")


def native_position(xp, q):
    """With the quaternion's scalar last."""
    return xp.concatenate((q[..., :3], q[..., 4:7], q[..., 3:4], q[..., 7:]), -1)


def mujoco_position(xp, q):
    """With the quaternion's scalar first."""
    return xp.concatenate((q[..., :3], q[..., 6:7], q[..., 3:6], q[..., 7:]), -1)


def with_linear(xp, x, change):
    """Rows x with their first three changed."""
    return xp.concatenate((change(x[..., :3]), x[..., 3:]), -1)


class Base(NamedTuple):
    """What conversions are made of."""
    xp: Any  # the module of the arrays' functions
    cross: Any  # its cross product along the last axis
    quaternion: Any  # x y z w, made unit: derivatives by it are those on unit quaternions
    coriolis: Any  # w x v, in the base's frame

    def to_world(self, v):
        return _lie.turned(self.cross, self.quaternion, v)

    def to_base(self, v):
        return _lie.turned(self.cross, _lie.inverse(self.xp, self.quaternion), v)

    def matrix_to_world(self, M):
        """T M T' of a symmetric M; NumPy's and CuPy's, which nobody else has, in its place."""
        xp, rows = self.xp, self._replace(quaternion=self.quaternion[..., None, :])
        left = rows.to_world(M[..., :3])
        own, below = rows.to_world(xp.swapaxes(left[..., :3, :], -1, -2)), left[..., 3:, :]
        if xp.__name__ in ("numpy", "cupy"):
            M[..., :3, :3], M[..., 3:, :3], M[..., :3, 3:] = own, below, xp.swapaxes(below, -1, -2)
            return M
        right = xp.concatenate((xp.swapaxes(below, -1, -2), M[..., 3:, 3:]), -2)
        return xp.concatenate((xp.concatenate((own, below), -2), right), -1)


def nonlinear_effects(robot, args: tuple, kwargs: dict[str, Any]):
    """tau of a robot at qdd = 0, of the other arrays by their place or name."""
    names = tuple(a.name for a in robot.inputs if a.role != "joint_acceleration")
    given = _names.given_of(robot, names, args, kwargs)
    if given.get("qd") is not None:
        xp, _, qd = _lie.namespace(qd=given["qd"])
        given["qdd"] = xp.zeros_like(qd)
    return robot(**given)


class MuJoCo:
    """Conversions of one robot's arrays; `native` is the robot of convention "pinocchio"."""

    def __init__(self, native):
        self.native = native
        self.roles = {array.role for array in native.inputs}
        self.refuse_others()

    def refuse_others(self) -> None:
        native = self.native
        floating = [joint["name"] for joint in native.joints if joint["nq"] != joint["nv"]]
        if len(floating) > 1 or not native._facts["free_base"]:
            raise ValueError("convention 'mujoco' has one joint that floats, in the world's own frame and ahead of all others, "
                             f"not '{floating[-1]}'; take 'pinocchio'")
        self.refuse_given()
        for array in (*native.inputs, *native.outputs):
            good = (*VECTORS, *MATRICES, *OTHERS, "joint_acceleration") if array.is_output else \
                (*PARTS, *FREED, "link_wrench", "contact_acceleration")
            if array.role not in good:
                raise ValueError(f"convention 'mujoco' has no {array.word} of a floating base; take 'pinocchio'")
            if array.is_output and array.role in MATRICES and native.sparse:
                raise ValueError("convention 'mujoco' has no sparse matrices of a floating base; take sparse=False")
        every = self.roles | {array.role for array in native.outputs}
        if "joint_acceleration" in every and not {"joint_position", "joint_velocity"} <= self.roles:
            raise ValueError("convention 'mujoco': accelerations need q and qd, which the scene leaves out; take 'pinocchio'")
        if every & {*VECTORS, *MATRICES, "joint_velocity"} and "joint_position" not in self.roles:
            raise ValueError("convention 'mujoco' needs q, which the scene leaves out; take 'pinocchio'")

    def refuse_given(self) -> None:
        """What fold= gives of the base is in the library's convention; velocities and forces that are all 0 are in both, and
        accelerations beside such velocities."""
        given, nv = self.native._facts["given"], self.native.nv
        still = {name for name, rows in given.items() if len(rows) == nv and not any(rows.values())}
        for name, rows in given.items():
            is_alike = name in still and name != "q" and (name != "qdd" or "qd" in still)
            if any(row < (7 if name == "q" else 6) for row in rows) and not is_alike:
                raise ValueError(f"convention 'mujoco': fold gives {name} of the floating base; take 'pinocchio'")

    # ---- calls ----

    def call(self, arrays: Sequence[Any], out: Any):
        """A call on arrays of one library, None for what was left out."""
        given = {a.role: x for a, x in zip(self.native.inputs, arrays) if x is not None and a.role in PARTS}
        self.check(arrays)
        base = self.base(given)
        converted = [x if x is None else self.input(a.role, x, base) for a, x in zip(self.native.inputs, arrays)]
        made = self.native(*converted) if out is None else self.native(*converted, out=out)
        several = made if isinstance(made, tuple) else (made,)
        values = [self.output(a.role, x, base) for a, x in zip(self.native.outputs, several)]
        if out is None:
            return self.native._join(values)
        for x, value in zip(several, values):
            x[...] = value
        return out

    def check(self, arrays: Sequence[Any]) -> None:
        """What the native robot would no longer see: shapes, and types of numbers, before they are converted."""
        given = [(a, x) for a, x in zip(self.native.inputs, arrays) if x is not None]
        if not given:
            return
        _arrays.check_dtypes(given)
        _arrays.lead_of((a, tuple(x.shape)) for a, x in given)

    def base(self, given: dict[str, Any]) -> Base | None:
        """Of the arrays by role."""
        if "joint_position" not in given:
            return None
        xp, cross, q = _lie.namespace(q=given["joint_position"])
        base = Base(xp, cross, _lie.unit(xp, native_position(xp, q)[..., 3:7]), None)
        if "joint_velocity" not in given:
            return base
        qd = given["joint_velocity"]
        return base._replace(coriolis=cross(qd[..., 3:6], base.to_base(qd[..., :3])))

    def input(self, role: str, x, base: Base | None):
        if base is None or role not in PARTS:
            return x
        if role == "joint_position":
            return native_position(base.xp, x)
        if role == "joint_acceleration":
            return with_linear(base.xp, x, lambda a: base.to_base(a) - base.coriolis)
        return with_linear(base.xp, x, base.to_base)

    def output(self, role: str, x, base: Base | None):
        if base is None or role in OTHERS:
            return x
        if role in MATRICES:
            return base.matrix_to_world(x)
        if role == "joint_acceleration":
            return with_linear(base.xp, x, lambda a: base.to_world(a + base.coriolis))
        return with_linear(base.xp, x, base.to_world)

    # ---- positions ----

    def moved(self, xp, cross, q, v):
        """The base's q by its velocity: the position adds, the quaternion moves as it does by a twist."""
        twist = xp.concatenate((xp.zeros_like(v[..., :3]), v[..., 3:]), -1)
        turned = mujoco_position(xp, _lie.moved(xp, cross, native_position(xp, q), twist))
        return with_linear(xp, turned, lambda p: p + v[..., :3])

    def between(self, xp, cross, q0, q1):
        """The velocity by which q0 becomes q1, turning by pi at most."""
        twist = _lie.between(xp, cross, native_position(xp, q0), native_position(xp, q1))
        return with_linear(xp, twist, lambda a: q1[..., :3] - q0[..., :3])
