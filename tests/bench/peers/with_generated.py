#!/usr/bin/env python3
"""The generated code through librnea: kernels compiled at run time (--routes cuda) and by nvcc (ahead), at several sizes of
a block (blocks), from the program's own arrays (host_arrays), and on the processor by 1, 2, ... threads (host)."""
import ctypes
import tempfile
import time
from pathlib import Path

import numpy as np

import gpu
import librnea
import measure

BLOCKS = (32, 64, 128, 256, 512, 1024)
NEXT = 5  # seconds that are kept for each route that follows
PASSES = ("rnea", "fpass", "bpass")


def text(bench, function, precision, layout="soa"):
    """The text that has this function."""
    stem = "robot" if function in PASSES else function
    return bench.folder / (f"{stem}_{precision}.cu" if layout == "soa" else f"{stem}_{precision}_{layout}.cu")


def rows(x):
    """[..., N] of [N, ...], in one piece: soa."""
    return np.ascontiguousarray(x.reshape(len(x), -1).T)


def key(route, function, device, precision, n, **more):
    return {"route": route, "function": function, "device": device, "precision": precision, "n": n, "launch_count": 1, **more}


def opened(bench, path, backend, cache, **options):
    """A robot and the row's columns of the time to open it, without the cache and with it."""
    library = bench.options.librnea
    first = librnea.Robot(library, path, backend, cache, **options)
    cold = first.build.seconds
    first.close()
    robot = librnea.Robot(library, path, backend, cache, **options)
    return robot, {"cold_ms": cold * 1e3, "cached_ms": robot.build.seconds * 1e3}


class Opened:
    """Robots by text and options, each opened twice; what the opening took is for the first row only."""

    def __init__(self, bench, backend, cache):
        self.bench, self.backend, self.cache, self.robots, self.failed = bench, backend, cache, {}, {}

    def robot(self, path, **options):
        which = (path, *sorted(options.items()))
        if which in self.failed:
            raise RuntimeError(self.failed[which])
        if which in self.robots:
            return self.robots[which], {}
        try:
            self.robots[which], took = opened(self.bench, path, self.backend, self.cache, **options)
        except RuntimeError as e:  # it would fail again, and take its time
            self.failed[which] = str(e)
            raise
        return self.robots[which], took


# ---- the processor ----


def host_threads(bench, function, n):
    return (1,) if n < 256 else bench.threads if function == "rnea" else {1, max(bench.threads)}


def on_host(bench, cache):
    robots = Opened(bench, librnea.RNEA_BACKEND_HOST, cache)
    for function, precision, n in bench.steps():
        for threads in host_threads(bench, function, n):
            def make():
                robot, took = robots.robot(text(bench, function, precision), threads=threads)
                inputs = [rows(x) for x in bench.data[precision].inputs(function, n)]
                outputs = [np.empty((r, n), inputs[0].dtype) for r in robot.output_rows(function)]
                call = robot.launcher(function, [x.ctypes.data for x in inputs + outputs], n)
                call()
                found = bench.data[precision].errors(function, n, outputs, -1)
                us = measure.clock(call, bench.box)
                return {**took, "import_ms": bench.import_ms, "error_max": found[0], "error_rms": found[1],
                        "method": "clock", "kernel_us": us,
                        "call_us": us, "h2d_us": 0, "d2h_us": 0}

            bench.attempt(make, **key("host backend", function, "cpu", precision, n, threads=threads))


# ---- the GPU ----


def arrays_of(torch, bench, function, precision, n, output_rows, aos=False):
    host = bench.data[precision].inputs(function, n)
    host = [np.ascontiguousarray(x) if aos else rows(x) for x in host]
    inputs = [torch.from_numpy(x).to(gpu.DEVICE) for x in host]
    shapes = [(n, r) if aos else (r, n) for r in output_rows]
    return host, inputs, [torch.empty(s, dtype=inputs[0].dtype, device=gpu.DEVICE) for s in shapes]


def kernel_row(bench, timer, case, host, outputs, make_call, axis, copied=True):
    """`make_call(stream)` launches in a stream; every launch overwrites `outputs`."""
    function, precision, n = case
    call = make_call(timer.stream.cuda_stream)
    timer.torch.cuda.synchronize()  # the arrays were filled in another stream
    us = timer.events(call)
    found = bench.data[precision].errors(function, n, outputs, axis)
    copies = timer.copies(case, host, outputs) if copied else {}
    return {"error_max": found[0], "error_rms": found[1], **copies, "method": "graph", "import_ms": bench.import_ms,
            "stream_us": us, "call_us": timer.waited(call), "kernel_us": timer.graph(call, us)}


def with_librnea(bench, timer, robots, case, aos=False, **options):
    function, precision, n = case
    robot, took = robots.robot(text(bench, function, precision, "aos" if aos else "soa"), **options)
    host, inputs, outputs = arrays_of(timer.torch, bench, function, precision, n, robot.output_rows(function), aos)
    addresses = [x.data_ptr() for x in inputs + outputs]
    row = kernel_row(bench, timer, case, host, outputs, lambda s: robot.launcher(function, addresses, n, s),
                     0 if aos else -1, not options)
    row["note"] = f"{robot.registers(function)} registers"
    return {**took, **row, "block": options.get("block") or robot.info.block}


def on_cuda(bench, timer, cache):
    robots = Opened(bench, librnea.RNEA_BACKEND_CUDA, cache)
    for case in bench.steps():
        bench.attempt(lambda: with_librnea(bench, timer, robots, case), **key("NVRTC", case[0], "cuda", *case[1:]))
        if case[0] == "rnea":
            bench.attempt(lambda: with_librnea(bench, timer, robots, case, True), **key("NVRTC, aos", case[0], "cuda", *case[1:]))


def by_nvcc(bench, timer, cache):
    """NAME_rnea_launch of a shared object that `run` had nvcc compile; how long that took is in a file beside it."""
    for _, precision, n in bench.steps(("rnea",)):
        def make():
            path, name = bench.folder / "aot" / f"robot_{precision}.so", (bench.folder / "name.txt").read_text().strip()
            seconds, began = float(path.with_suffix(".seconds").read_text()), time.perf_counter()
            launch = getattr(ctypes.CDLL(str(path)), f"{name}_rnea_launch")
            host, inputs, outputs = arrays_of(timer.torch, bench, "rnea", precision, n, [bench.model.n])
            addresses = [ctypes.c_void_p(x.data_ptr()) for x in inputs + outputs]

            def make_call(stream):
                arguments = (*addresses, ctypes.c_size_t(n), ctypes.c_void_p(stream))
                return lambda: checked(launch(*arguments))

            make_call(0)()
            timer.torch.cuda.synchronize()
            took = {"cold_ms": seconds * 1e3, "cached_ms": (time.perf_counter() - began) * 1e3}
            return {**took, **kernel_row(bench, timer, ("rnea", precision, n), host, outputs, make_call, -1)}

        bench.attempt(make, **key("nvcc", "rnea", "cuda", precision, n))


def checked(error):
    if error:
        raise RuntimeError(f"cudaError_t {error}")


def by_block(bench, timer, cache):
    robots = Opened(bench, librnea.RNEA_BACKEND_CUDA, cache)
    for _, precision, n in bench.steps(("rnea",)):
        for block in BLOCKS if n in measure.FIRST and n > 1 else ():
            bench.attempt(lambda: with_librnea(bench, timer, robots, ("rnea", precision, n), block=block),
                          **key("NVRTC, block", "rnea", "cuda", precision, n, block=block))


def from_host_arrays(bench, timer, cache):
    """rnea_run on pageable arrays: copies and kernel in one."""
    robots = Opened(bench, librnea.RNEA_BACKEND_CUDA, cache)
    for _, precision, n in bench.steps(("rnea",)):
        def make():
            robot, took = robots.robot(text(bench, "rnea", precision))
            inputs = [rows(x) for x in bench.data[precision].inputs("rnea", n)]
            tau = np.empty_like(inputs[0])
            call = robot.runner([x.ctypes.data for x in [*inputs, tau]], n)
            call()
            found = bench.data[precision].errors("rnea", n, (tau,), -1)
            return {**took, "error_max": found[0], "error_rms": found[1], "method": "clock",
                    "call_us": measure.clock(call, bench.box)}

        bench.attempt(make, **key("rnea_run", "rnea", "cuda", precision, n))


def timer_of(bench):
    """PyTorch's timer, for its memory, streams and events; None, having said why, without a GPU."""
    torch, _ = measure.start("generated", "torch")
    if not torch.cuda.is_available():
        bench.row(device="cuda", note="skipped: PyTorch finds no GPU")
        return None
    began = time.perf_counter()
    torch.zeros(1, device=gpu.DEVICE)
    torch.cuda.synchronize()
    bench.import_ms += (time.perf_counter() - began) * 1e3  # the CUDA context, which librnea finds there
    return gpu.Timer(torch, bench.box)


def main(bench, cache):
    began = time.perf_counter()
    ctypes.CDLL(bench.options.librnea)
    bench.import_ms = (time.perf_counter() - began) * 1e3
    if bench.wants("host"):
        on_host(bench, cache)
    parts = {"cuda": on_cuda, "ahead": by_nvcc, "host_arrays": from_host_arrays, "blocks": by_block}
    wanted = [part for route, part in parts.items() if bench.wants(route)]
    timer = timer_of(bench) if wanted else None
    for i, part in enumerate(wanted if timer else ()):
        bench.kept = NEXT * (len(wanted) - 1 - i)
        part(bench, timer, cache)


if __name__ == "__main__":
    bench = measure.Bench("generated")
    commit = Path(bench.folder / "commit.txt")
    bench.version = commit.read_text().strip() if commit.exists() else ""
    with tempfile.TemporaryDirectory() as cache:
        main(bench, cache)
