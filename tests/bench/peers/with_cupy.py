#!/usr/bin/env python3
"""CuPy: the matrices on a GPU, one of its kernels or of cuBLAS' after the other."""
import time

import measure

cupy, import_ms = measure.start("CuPy", "cupy")
import statistics

from spatial import Spatial


def between(call, count):
    """Microseconds per call between two events around `count` calls."""
    first, last = cupy.cuda.Event(), cupy.cuda.Event()
    first.record()
    for _ in range(count):
        call()
    last.record()
    last.synchronize()
    return cupy.cuda.get_elapsed_time(first, last) * 1e3 / count


def many(call, box):
    """The median of between() within `box` seconds."""
    times, count, end = [], max(1, min(1000, int(1000 / between(call, 2)))), time.perf_counter() + box
    while not times or time.perf_counter() < end:
        times.append(between(call, count))
    return statistics.median(times)


def waited(call):
    call()
    cupy.cuda.Device().synchronize()


def row(bench, function, case, seen):
    name, precision, n = case
    host = bench.data[precision].inputs(name, n)
    inputs = [cupy.asarray(x) for x in host]
    began = time.perf_counter()
    outputs = function(*inputs)
    cupy.cuda.Device().synchronize()
    cold = {} if (name, precision) in seen else {"cold_ms": (time.perf_counter() - began) * 1e3}
    seen.add((name, precision))
    outputs = outputs if isinstance(outputs, tuple) else (outputs,)
    found = bench.data[precision].errors(name, n, outputs)
    us = many(lambda: function(*inputs), bench.box)
    return {**cold, "import_ms": import_ms, "error_max": found[0], "error_rms": found[1], "method": "events", "kernel_us": us,
            "stream_us": us, "call_us": measure.clock(lambda: waited(lambda: function(*inputs)), bench.box),
            "h2d_us": measure.clock(lambda: waited(lambda: [cupy.asarray(x) for x in host]), bench.box),
            "d2h_us": measure.clock(lambda: [cupy.asnumpy(x) for x in outputs], bench.box)}


def main(bench):
    bench.version, seen = cupy.__version__, set()
    try:
        cupy.zeros(1)
    except Exception as e:
        bench.row(device="cuda", note=f"skipped: CuPy finds no GPU: {str(e).splitlines()[0][:100]}")
        return
    made = {p: Spatial(cupy, bench.model, lambda x: cupy.asarray(x, measure.TYPES[p])) for p in measure.TYPES}
    for case in bench.steps():
        bench.attempt(lambda: row(bench, made[case[1]].function(case[0]), case, seen), route="matrices",
                      **dict(zip(("function", "precision", "n"), case)), device="cuda")


if __name__ == "__main__":
    main(measure.Bench("CuPy"))
