#!/usr/bin/env python3
"""NumPy: with matrices, and straight-line over whole arrays; alone, in slices by a pool of threads, and by one of
processes that share the arrays: threads wait for Python's lock before every operation."""
import concurrent.futures
import itertools
import mmap
import multiprocessing
import os
import time

os.environ.update({name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")})
began = time.perf_counter()
import numpy

import_ms = (time.perf_counter() - began) * 1e3
import measure
import spatial
import straight

SLICE = 2048   # samples whose intermediate arrays, all alive at once, are 16 MB at most
LARGE = 10     # seconds that must be left for a million samples
WHOLE = 65536  # of more the intermediate arrays take gigabytes: slices are for that


def matrices(bench, precision):
    kind = measure.TYPES[precision]
    return spatial.Spatial(numpy, bench.model, lambda x: x.astype(kind))


def rows(x):
    """[n, N] of [N, n], in one piece."""
    return numpy.ascontiguousarray(x.T)


def alone(bench):
    functions = {p: matrices(bench, p) for p in measure.TYPES}
    for function, precision, n in bench.steps_of_processor():
        data = bench.data[precision]

        def make():
            inputs, call = data.inputs(function, n), functions[precision].function(function)
            outputs, us = measure.first_and_clock(lambda: call(*inputs), bench.box)
            outputs = outputs if isinstance(outputs, tuple) else (outputs,)
            return result(data.errors(function, n, outputs), us)

        bench.attempt(make, LARGE if n > measure.CACHED else 0, **key("matrices", function, precision, n, 1))


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


# ---- in slices ----

task = ()  # of which part() makes one slice; the processes of a pool have it from when they were forked


def part(first):
    call, inputs, tau, axis, size = task
    here = (slice(first, first + size),) if axis == 0 else (slice(None), slice(first, first + size))
    made = call(*(x[here] for x in inputs))
    tau[here] = made if axis == 0 else numpy.stack(made)


def shared_like(x):
    """Zeros that forked processes write for all to see."""
    return numpy.frombuffer(mmap.mmap(-1, x.nbytes), x.dtype).reshape(x.shape)


def pool_of(kind, workers):
    if kind == "slices":
        pool = concurrent.futures.ThreadPoolExecutor(workers)
        return pool, lambda firsts: list(pool.map(part, firsts))
    pool = multiprocessing.get_context("fork").Pool(workers)
    return pool, lambda firsts: pool.map(part, firsts, chunksize=1)


def in_slices(bench, kind, call, axis, precision, n, workers):
    """The row of a pool that is there before the clock starts."""
    global task
    inputs = bench.data[precision].inputs("rnea", n)
    inputs = inputs if axis == 0 else [rows(x) for x in inputs]
    tau, size = shared_like(inputs[0]), max(1, min(SLICE, -(-n // workers)))
    task = call, inputs, tau, axis, size
    pool, run = pool_of(kind, workers)
    with pool:
        run(range(workers))  # its threads and processes have begun
        _, us = measure.first_and_clock(lambda: run(range(0, n, size)), bench.box)
    return result(bench.data[precision].errors("rnea", n, (tau,), axis), us)


def pools(bench):
    """(n, kind, workers): first what the tables show. One worker is one thread."""
    most = max(bench.threads)
    few = [("slices", 1), ("slices", most), ("processes", most)]
    every = [(kind, t) for kind in ("processes", "slices") for t in bench.threads]
    sizes = [n for n in sorted(bench.counts) if n >= 1024]
    small = [n for n in sizes if n in measure.FIRST and n <= measure.CACHED]
    large = [n for n in sizes if n in measure.FIRST and n > measure.CACHED]
    scaled = [n for n in sizes if n == measure.SCALED]
    rest = [n for n in sizes if n not in (*small, *large, *scaled)]
    for counts, workers in (small, few), (scaled, every), (large, few), (rest, few), (small, every):
        for n in counts:
            yield from ((n, *w) for w in workers if w != ("processes", 1))


def pooled(bench):
    functions, (written, _) = {p: matrices(bench, p) for p in measure.TYPES}, straight.rnea(bench.model, numpy.sin, numpy.cos)
    for (n, kind, workers), precision in itertools.product(pools(bench), ("f64", "f32")):
        for route, axis in ("straight", -1), ("matrices", 0):
            if bench.late():
                bench.row(function="rnea", precision=precision, n=n, note="not measured: out of time from here on")
                return
            call = written if axis else functions[precision].rnea
            bench.attempt(lambda: in_slices(bench, kind, call, axis, precision, n, workers),
                          LARGE if n > measure.CACHED and workers == 1 else 0,
                          **key(f"{route}, {kind}", "rnea", precision, n, workers))


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
