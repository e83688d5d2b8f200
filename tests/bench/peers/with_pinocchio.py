#!/usr/bin/env python3
"""Pinocchio's wheel: rnea of one sample at a time from Python, and rneaInParallel over a batch by 1, 2, ... threads; in
doubles, which is all it has."""
import measure

pinocchio, import_ms = measure.start("Pinocchio", "pinocchio")
import numpy as np


def key(route, n, threads):
    return {"route": route, "function": "rnea", "device": "cpu", "precision": "f64", "n": n, "threads": threads}


def one_by_one(model):
    data, rnea = model.createData(), pinocchio.rnea

    def call(q, qd, qdd, tau):
        for i in range(len(q)):
            tau[i] = rnea(model, data, q[i], qd[i], qdd[i])

    return call


def timed(bench, n, call, inputs, tau, axis):
    _, us = measure.first_and_clock(call, bench.box)
    found = bench.data["f64"].errors("rnea", n, (tau,), axis)
    return {"error_max": found[0], "error_rms": found[1], "import_ms": import_ms, "method": "clock", "kernel_us": us,
            "call_us": us, "h2d_us": 0, "d2h_us": 0}


def loop_row(bench, model, n):
    inputs, call = bench.data["f64"].inputs("rnea", n), one_by_one(model)
    tau = np.empty_like(inputs[0])
    return timed(bench, n, lambda: call(*inputs, tau), inputs, tau, 0)


def parallel_row(bench, pool, n, threads):
    inputs = [np.asfortranarray(x.T) for x in bench.data["f64"].inputs("rnea", n)]
    tau = np.empty(inputs[0].shape, order="F")
    return timed(bench, n, lambda: pinocchio.rneaInParallel(threads, pool, *inputs, tau), inputs, tau, -1)


def main(bench):
    bench.version = pinocchio.__version__
    model = pinocchio.buildModelFromUrdf(bench.model.path)
    if list(model.names)[1:] != [b.joint for b in bench.model.bodies] or model.nq != bench.model.n:
        bench.row(note="skipped: its q has another order, or continuous joints as two numbers")
        return
    pool = pinocchio.ModelPool(model, max(bench.threads)) if hasattr(pinocchio, "rneaInParallel") else None
    for _, _, n in bench.steps(("rnea",), ("f64",), measure.CACHED):
        if n <= 65536:
            bench.attempt(lambda: loop_row(bench, model, n), **key("rnea, Python's loop", n, 1))
        for threads in bench.threads if pool else ():
            if threads == 1 or n >= 64:
                bench.attempt(lambda: parallel_row(bench, pool, n, threads), **key("rneaInParallel", n, threads))


if __name__ == "__main__":
    main(measure.Bench("Pinocchio"))
