#!/usr/bin/env python3
"""MuJoCo's wheel: mj_rne with what it needs of the state (mj_kinematics, mj_comPos, mj_comVel), one sample at a time from
Python, in doubles. Armature, damping and the like are no part of mj_rne."""
import measure

mujoco, import_ms = measure.start("MuJoCo", "mujoco")
import numpy as np

LARGEST = 65536  # more is Python's loop alone


def addresses(model, bodies):
    """The places of the robot's joints in qpos and in qvel."""
    joints = [model.joint(body.joint) for body in bodies]
    return [int(j.qposadr[0]) for j in joints], [int(j.dofadr[0]) for j in joints]


def torques(model, bodies):
    data, out = mujoco.MjData(model), np.zeros(model.nv)
    qpos, qvel = addresses(model, bodies)

    def call(q, qd, qdd, tau):
        for i in range(len(q)):
            data.qpos[qpos], data.qvel[qvel], data.qacc[qvel] = q[i], qd[i], qdd[i]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 1, out)
            tau[i] = out[qvel]

    return call


def row(bench, call, n):
    inputs = bench.data["f64"].inputs("rnea", n)
    tau = np.empty_like(inputs[0])
    call(*inputs, tau)
    found = bench.data["f64"].errors("rnea", n, (tau,))
    us = measure.clock(lambda: call(*inputs, tau), bench.box)
    return {"error_max": found[0], "error_rms": found[1], "import_ms": import_ms, "method": "clock", "kernel_us": us,
            "call_us": us, "h2d_us": 0, "d2h_us": 0}


def main(bench):
    bench.version = mujoco.__version__
    call = torques(mujoco.MjModel.from_xml_path(bench.model.path), bench.model.bodies)
    for _, _, n in bench.steps(("rnea",), ("f64",)):
        if n <= LARGEST:
            bench.attempt(lambda: row(bench, call, n), route="mj_rne, Python's loop", function="rnea", device="cpu",
                          precision="f64", n=n, threads=1)


if __name__ == "__main__":
    main(measure.Bench("MuJoCo"))
