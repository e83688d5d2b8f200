#!/usr/bin/env python3
"""JAX on the device that it finds: the matrices over batches (jit), over one sample with vmap (vmap), and the
straight-line text (straight). XLA compiles each size anew. On a processor doubles alone, and no vmap."""
import os
import tempfile
import time

os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
import measure

jax, import_ms = measure.start("JAX", "jax")
import jax.numpy as jnp
import numpy as np

import straight
from spatial import Spatial

jax.config.update("jax_enable_x64", True)
jax.config.update("jax_default_matmul_precision", "highest")  # no TF32, which would cost ten bits

MAIN = (1048576, 1024)   # sizes for which everything is measured
COMPILING = 8            # seconds that must be left to compile
LARGE = 20               # and for a million samples on a processor


def functions(bench):
    """{route: function of (name, precision)}; what varies is [N, ...], in straight [..., N]."""
    batched = {p: Spatial(jnp, bench.model, lambda x: jnp.asarray(x, measure.TYPES[p])) for p in measure.TYPES}
    written, _ = straight.rnea(bench.model, jnp.sin, jnp.cos)
    return {"jit": lambda name, p: jax.jit(batched[p].function(name)),
            "vmap and jit": lambda name, p: jax.jit(jax.vmap(batched[p].function(name))),
            "jit, statements": lambda name, p: jax.jit(written)}


def compile_twice(make, inputs, once):
    """The compiled call and the columns of the time to compile it: anew, and from JAX's cache on disk unless `once`."""
    began = time.perf_counter()
    call = make().lower(*inputs).compile()
    cold = time.perf_counter() - began
    if once:
        return call, {"cold_ms": cold * 1e3}
    jax.clear_caches()
    began = time.perf_counter()
    call = make().lower(*inputs).compile()
    return call, {"cold_ms": cold * 1e3, "cached_ms": (time.perf_counter() - began) * 1e3}


def launches(compiled):
    """The operations of the compiled program that are more than a change of shape."""
    entry, count = False, 0
    for line in compiled.as_text().splitlines():
        entry = line.startswith("ENTRY") or entry and line != "}"
        count += entry and any(f" {word}(" in line for word in ("fusion", "custom-call", "dot", "sort", "while", "call"))
    return count


def copies(inputs, outputs, box):
    host = jax.devices("cpu")[0]
    return {"h2d_us": measure.clock(lambda: jax.block_until_ready([jax.device_put(x) for x in inputs]), box / 2),
            "d2h_us": measure.clock(lambda: jax.block_until_ready([jax.device_put(x, host) for x in outputs]), box / 2)}


def queued(call, inputs, box):
    """Microseconds of a call among many that the device is given one after the other."""
    once = measure.clock(lambda: jax.block_until_ready(call(*inputs)), box / 2)
    count = max(1, min(1000, int(2000 / once)))

    def many():
        for _ in range(count):
            last = call(*inputs)
        jax.block_until_ready(last)

    many()
    return measure.clock(many, box) / count, once


def row(bench, make, case, device, axis):
    function, precision, n = case
    host = [x if axis == 0 else np.ascontiguousarray(x.T) for x in bench.data[precision].inputs(function, n)]
    inputs = [jax.device_put(x) for x in host]
    call, took = compile_twice(lambda: make(function, precision), inputs, device == "cpu" or n not in MAIN)
    outputs = call(*inputs)
    outputs = outputs if isinstance(outputs, tuple) else (outputs,)
    stacked = outputs if axis == 0 else (jnp.stack(outputs),)
    found = bench.data[precision].errors(function, n, stacked, axis)
    us, waited = queued(call, inputs, bench.box)
    moved = copies(host, outputs, bench.box) if device != "cpu" and function == "rnea" else {}
    return {**took, **moved, "import_ms": import_ms, "error_max": found[0], "error_rms": found[1], "method": "clock, queued",
            "kernel_us": us, "call_us": waited, "launch_count": launches(call)}


def main(bench):
    began = time.perf_counter()
    device = "cuda" if jax.devices()[0].platform in ("gpu", "cuda") else "cpu"
    jax.block_until_ready(jnp.zeros(1))
    global import_ms
    import_ms += (time.perf_counter() - began) * 1e3
    bench.version, routes = jax.__version__, functions(bench)
    bench.kept = COMPILING
    for case in bench.steps(precisions=("f64",), large=measure.CACHED) if device == "cpu" else bench.steps():
        for route, make in routes.items():
            if route == "jit" or case[0] == "rnea" and (case[2] in MAIN and device != "cpu" or "vmap" not in route):
                key = {"route": route, "device": device, **dict(zip(("function", "precision", "n"), case))}
                needed = LARGE if device == "cpu" and case[2] > measure.CACHED else 0
                bench.attempt(lambda: row(bench, make, case, device, -1 if "statements" in route else 0), needed, **key)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as cache:
        jax.config.update("jax_compilation_cache_dir", cache)
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0)
        jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
        main(measure.Bench("JAX"))
