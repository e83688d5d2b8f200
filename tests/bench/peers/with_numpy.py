#!/usr/bin/env python3
"""NumPy: with matrices, and straight-line over whole arrays; alone, and in slices by a pool of threads."""
import concurrent.futures
import os
import time

os.environ.update({name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")})
began = time.perf_counter()
import numpy

import_ms = (time.perf_counter() - began) * 1e3
import measure
import spatial
import straight

SLICE = 8192   # samples that a cache holds with all their intermediate arrays
WHOLE = 65536  # of more the intermediate arrays take gigabytes: slices are for that


def matrices(bench, precision):
    kind = measure.TYPES[precision]
    return spatial.Spatial(numpy, bench.model, lambda x: x.astype(kind))


def rows(x):
    """[n, N] of [N, n], in one piece."""
    return numpy.ascontiguousarray(x.T)


def alone(bench):
    functions = {p: matrices(bench, p) for p in measure.TYPES}
    for function, precision, n in bench.steps_large_last():
        data = bench.data[precision]

        def make():
            inputs, call = data.inputs(function, n), functions[precision].function(function)
            outputs, us = measure.first_and_clock(lambda: call(*inputs), bench.box)
            outputs = outputs if isinstance(outputs, tuple) else (outputs,)
            return result(data.errors(function, n, outputs), us)

        bench.attempt(make, **key("matrices", function, precision, n, 1))


def written_out(bench):
    call, count = straight.rnea(bench.model, numpy.sin, numpy.cos)
    for function, precision, n in bench.steps(("rnea",)):
        data = bench.data[precision]

        def make():
            inputs = [rows(x) for x in data.inputs(function, n)]
            outputs, us = measure.first_and_clock(lambda: call(*inputs), bench.box)
            return result(data.errors(function, n, (numpy.stack(outputs),), -1), us, count)

        if n <= WHOLE:
            bench.attempt(make, **key("straight", function, precision, n, 1))


def sliced(pool, call, inputs, tau, axis, threads):
    """call() of slices of the samples, in the threads of `pool`, into `tau`."""
    n = tau.shape[axis]
    size = max(1, min(SLICE, -(-n // threads)))

    def one(first):
        part = (slice(first, first + size),) if axis == 0 else (slice(None), slice(first, first + size))
        result = call(*(x[part] for x in inputs))
        tau[part] = result if axis == 0 else numpy.stack(result)

    list(pool.map(one, range(0, n, size)))
    return tau


def pooled(bench):
    functions, (written, _) = {p: matrices(bench, p) for p in measure.TYPES}, straight.rnea(bench.model, numpy.sin, numpy.cos)
    for _, precision, n in bench.steps(("rnea",), counts=sorted(bench.counts)):
        for threads in bench.threads if n >= 1024 else ():
            for route, axis in ("straight", -1), ("matrices", 0):
                data, call = bench.data[precision], written if axis else functions[precision].rnea

                def make():
                    inputs = data.inputs("rnea", n)
                    inputs = inputs if axis == 0 else [rows(x) for x in inputs]
                    tau = numpy.empty_like(inputs[0])
                    with concurrent.futures.ThreadPoolExecutor(threads) as pool:
                        _, us = measure.first_and_clock(lambda: sliced(pool, call, inputs, tau, axis, threads), bench.box)
                    return result(data.errors("rnea", n, (tau,), axis), us)

                bench.attempt(make, **key(f"{route}, slices", "rnea", precision, n, threads))


def key(route, function, precision, n, threads):
    return {"route": route, "function": function, "device": "cpu", "precision": precision, "n": n, "threads": threads}


def result(errors, us, launches=None):
    return {"method": "clock", "error_max": errors[0], "error_rms": errors[1], "import_ms": import_ms, "kernel_us": us,
            "call_us": us, "h2d_us": 0, "d2h_us": 0, "launch_count": launches}


if __name__ == "__main__":
    bench = measure.Bench("NumPy")
    bench.version = numpy.__version__
    for route, run in ("alone", alone), ("straight", written_out), ("pooled", pooled):
        if bench.wants(route):
            run(bench)
