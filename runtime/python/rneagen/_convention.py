"""MuJoCo's convention of a floating base, on top of the library's, which is Pinocchio's. Arrays of NumPy, converted
at every call.

    pinocchio   q = x y z qx qy qz qw; qd = the twist in the base's frame, linear then angular; qdd its componentwise
                derivative; tau = force then moment, in the base's frame
    mujoco      q = x y z qw qx qy qz; qd = linear velocity in the world's frame, angular velocity in the base's; qdd
                its derivative, so the linear part is the classical acceleration; tau = force in the world's frame,
                moment in the base's

With R the base's rotation, v_world = R v, w the same: qdd_world = R (a + w x v), f_world = R f.
"""
from __future__ import annotations

from typing import Any, Sequence

import numpy

from ._gradient import FREED, PARTS

VECTORS = ("joint_torque", "gravity_torque")  # outputs that are forces
MATRICES = {"mass_matrix": "forward", "mass_matrix_inverse": "inverse"}
OTHERS = ("power", "kinetic_energy", "potential_energy", "link_twist", "link_acceleration", "joint_wrench", "body_twists",
          "link_pose", "center_of_mass", "center_of_mass_velocity", "momentum", "momentum_rate")


def rotation(q: numpy.ndarray) -> numpy.ndarray:
    """(..., 3, 3) of unit quaternions x y z w in q[..., 3:7]."""
    x, y, z, w = (q[..., i] for i in range(3, 7))
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return numpy.stack([numpy.stack(row, -1) for row in rows], -2)


def turn(R: numpy.ndarray, v: numpy.ndarray) -> numpy.ndarray:
    return numpy.einsum("...ij,...j->...i", R, v)


class MuJoCo:
    """Conversions of one robot's arrays."""

    def __init__(self, inputs: Sequence, outputs: Sequence):
        self.roles = {array.role: i for i, array in enumerate(inputs)}
        for array in (*inputs, *outputs):
            good = (*VECTORS, *MATRICES, *OTHERS, "joint_acceleration") if array.is_output else \
                (*PARTS, *FREED, "link_wrench")
            if array.role not in good:
                raise ValueError(f"convention 'mujoco' has no {array.word} of a floating base; take 'pinocchio'")
        has_acceleration = any(a.role == "joint_acceleration" for a in (*inputs, *outputs))
        if has_acceleration and not {"joint_position", "joint_velocity"} <= set(self.roles):
            raise ValueError("convention 'mujoco': accelerations need q and qd, which the scene leaves out; take 'pinocchio'")

    def inputs(self, arrays: Sequence[numpy.ndarray]) -> tuple[list[numpy.ndarray], numpy.ndarray | None, numpy.ndarray | None]:
        """As the library takes them, the rotation, and w x v."""
        arrays = [x.copy() for x in arrays]
        by_role = {role: arrays[i] for role, i in self.roles.items()}
        q, R, cross = by_role.get("joint_position"), None, None
        if q is not None:
            q[..., 3:7] = q[..., [4, 5, 6, 3]]
            R = rotation(q)
        inverse: Any = None if R is None else numpy.swapaxes(R, -1, -2)
        for role in ("joint_velocity", "joint_acceleration", "joint_torque"):
            if role in by_role and inverse is None:
                raise ValueError("convention 'mujoco' needs q, which the scene leaves out; take 'pinocchio'")
            if role in by_role:
                by_role[role][..., :3] = turn(inverse, by_role[role][..., :3])
        if "joint_velocity" in by_role:
            qd = by_role["joint_velocity"]
            cross = numpy.cross(qd[..., 3:6], qd[..., :3])
        if "joint_acceleration" in by_role and cross is not None:
            by_role["joint_acceleration"][..., :3] -= cross
        return arrays, R, cross

    def output(self, role: str, value, R, cross):
        if role in OTHERS:
            return value
        if R is None:
            raise ValueError("convention 'mujoco' needs q, which the scene leaves out; take 'pinocchio'")
        if role in MATRICES:
            value[..., :3, :] = numpy.einsum("...ij,...jk->...ik", R, value[..., :3, :])
            value[..., :, :3] = numpy.einsum("...ij,...kj->...ki", R, value[..., :, :3])
            return value
        if role == "joint_acceleration":
            value[..., :3] += cross
        value[..., :3] = turn(R, value[..., :3])
        return value

    def call(self, robot, arrays: Sequence[numpy.ndarray], out):
        robot._check(tuple(map(numpy.ascontiguousarray, arrays)))
        converted, R, cross = self.inputs(arrays)
        result = robot._run(tuple(numpy.ascontiguousarray(x) for x in converted), out)
        several = isinstance(result, tuple)
        values = [self.output(a.role, x, R, cross) for a, x in zip(robot.outputs, result if several else (result,))]
        return result if several else values[0]
