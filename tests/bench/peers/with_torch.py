#!/usr/bin/env python3
"""PyTorch on a CPU (--routes cpu), on a GPU operation by operation and in a CUDA graph (cuda), and what torch.compile
makes of the straight-line text (straight_f32, straight_f64; in one kernel: fused_f32, fused_f64) and of the matrices
(matrices_f32, matrices_f64). Several compile at a time, each route in a process of its own, for a reset throws away what was
compiled before, and a second route does not find its first compilation on disk; they take turns on the GPU by PEERS_LOCK."""
import os
import tempfile
import time

import gpu
import measure
import straight
from spatial import FUNCTIONS, Spatial

torch, import_ms = measure.start("PyTorch", "torch")
LARGE = 10       # seconds that must be left for a million samples on the processor
HINT = 1024      # the size that Inductor sees first; from larger ones it makes blocks that spill
FUSED = 100000   # operations that Inductor may join in a kernel, of which it takes 64 by default
COMPILING = 25   # seconds that must be left to compile
FOR_ONE = 15     # the same for a batch of one, which takes less
PROFILING = {"cuda": 6, "compile": 10}  # seconds that are kept for the profiler, and for waiting for the other programs


def dtype(precision):
    return torch.float32 if precision == "f32" else torch.float64


def matrices(bench, precision, device):
    return Spatial(torch, bench.model, lambda x: torch.tensor(x, dtype=dtype(precision), device=device))


def tensors(arrays, device):
    return [torch.from_numpy(x).to(device) for x in arrays]


def key(route, function, device, precision, n, **more):
    return {"route": route, "function": function, "device": device, "precision": precision, "n": n, **more}


def errors(found):
    return {"error_max": found[0], "error_rms": found[1], "import_ms": import_ms}


# ---- the processor ----


def on_cpu(bench):
    functions = {p: matrices(bench, p, "cpu") for p in measure.TYPES}
    for function, precision, n in bench.steps_of_processor():
        data = bench.data[precision]
        for threads in {1, max(bench.threads)}:
            def make():
                torch.set_num_threads(threads)
                inputs, call = tensors(data.inputs(function, n), "cpu"), functions[precision].function(function)
                outputs, us = measure.first_and_clock(lambda: call(*inputs), bench.box)
                return {**errors(data.errors(function, n, gpu.tuple_of(outputs))), "method": "clock", "kernel_us": us,
                        "call_us": us, "h2d_us": 0, "d2h_us": 0}

            needed = LARGE if n > measure.CACHED else 0
            bench.attempt(make, needed, **key("eager", function, "cpu", precision, n, threads=threads))


def operations(call):
    """How many operations that are more than a view call() asks of PyTorch: as many launches, or more."""
    from torch.utils._python_dispatch import TorchDispatchMode

    class Count(TorchDispatchMode):
        count = 0

        def __torch_dispatch__(self, function, types, arguments=(), keywords=None):
            self.count += not getattr(function, "is_view", False) and function is not torch.ops.aten._unsafe_view.default
            return function(*arguments, **(keywords or {}))

    with Count() as counted:
        call()
    return counted.count


# ---- the GPU, operation by operation, and the same in a graph ----


def on_cuda(bench, timer):
    functions, seen = {p: matrices(bench, p, gpu.DEVICE) for p in measure.TYPES}, {}
    for function, precision, n in bench.steps():
        data, call, kept = bench.data[precision], functions[precision].function(function), {}

        def eager():
            kept["inputs"] = inputs = tensors(data.inputs(function, n), gpu.DEVICE)
            outputs, cold = gpu.first_call(torch, lambda: call(*inputs))
            outputs, copies = gpu.tuple_of(outputs), (function, precision, n)
            kept["row"] = {**errors(data.errors(function, n, outputs)), **timer.copies(copies, data.inputs(function, n), outputs)}
            us = kept["eager"] = timer.events(lambda: call(*inputs))
            if (function, precision) not in seen:
                kept["row"] |= {"cold_ms": cold}
                seen[function, precision] = operations(lambda: call(*inputs))
            kept["row"]["launch_count"] = seen[function, precision]
            timer.profile_later(key("eager", function, "cuda", precision, n), lambda call=call: call(*inputs))
            return {**kept["row"], "method": "events", "kernel_us": us, "stream_us": us,
                    "call_us": timer.waited(lambda: call(*inputs))}

        def graph():
            us = timer.graph(lambda: call(*kept["inputs"]), kept["eager"])
            return {**kept["row"], "method": "graph", "kernel_us": us,
                    "call_us": timer.waited(timer.captured(lambda: call(*kept["inputs"])).replay)}

        if bench.attempt(eager, **key("eager", function, "cuda", precision, n)):
            bench.attempt(graph, **key("CUDA graph", function, "cuda", precision, n))


# ---- torch.compile ----


def compiled_row(bench, timer, case, call, inputs, host, axis, extra):
    """`case` is (function, precision, n); `call` has run."""
    function, precision, n = case
    outputs = gpu.tuple_of(call(*inputs))
    stacked = (torch.stack(outputs),) if axis else outputs
    row = {**extra, **errors(bench.data[precision].errors(function, n, stacked, axis)),
           **timer.copies(case, host, stacked)}
    us = timer.events(lambda: call(*inputs))
    return {**row, "method": "graph",
            "stream_us": us, "call_us": timer.waited(lambda: call(*inputs)), "kernel_us": timer.graph(lambda: call(*inputs), us)}


def compiled(bench, timer, make, cases, route, axis=0, note="", options=None):
    """Rows of torch.compile of make(precision)(function) for `cases`, whose third is n and fourth dynamic or not."""
    ready = {}
    for function, precision, n, dynamic in cases:
        def row():
            host = bench.data[precision].inputs(function, n)
            host = [x if axis == 0 else x.T.copy() for x in host]
            inputs, which, extra = tensors(host, gpu.DEVICE), (function, precision, dynamic, n == 1), {"note": note}
            if which not in ready:
                plain = make(precision, function)
                ready[which] = torch.compile(plain, dynamic=dynamic, options=options)
                extra["cold_ms"] = gpu.first_call(torch, lambda: ready[which](*inputs))[1]
                if (function, n) == (cases[0][0], cases[0][2]):  # once more with what is on disk
                    torch._dynamo.reset()
                    ready[which] = torch.compile(plain, dynamic=dynamic, options=options)
                    extra["cached_ms"] = gpu.first_call(torch, lambda: ready[which](*inputs))[1]
            else:
                ready[which](*inputs)
            with gpu.alone(os.environ.get("PEERS_LOCK")):
                made = compiled_row(bench, timer, (function, precision, n), ready[which], inputs, host, axis, extra)
                torch.cuda.empty_cache()  # the others need memory too
            return made

        which = key(route, function, "cuda", precision, n)
        known = (function, precision, dynamic, n == 1) in ready
        if bench.attempt(row, 0 if known else COMPILING if n > 1 else FOR_ONE, **which):
            inputs = tensors(bench.data[precision].inputs(function, n), gpu.DEVICE)
            inputs = [x if axis == 0 else x.T.contiguous() for x in inputs]
            call = ready[function, precision, dynamic, n == 1]
            timer.profile_later(which, lambda call=call, inputs=inputs: call(*inputs))


def sizes(bench):
    return sorted((n for n in bench.counts if n > 1), key=lambda n: n != HINT)


def with_straight(bench, timer, precision, route, options=None):
    call, count = straight.rnea(bench.model, torch.sin, torch.cos)
    cases = [("rnea", precision, n, True) for n in sizes(bench)]
    cases.insert(3, ("rnea", precision, 1, None))
    compiled(bench, timer, lambda *_: call, cases, f"torch.compile, {route}", -1, f"{count} statements", options)


def with_matrices(bench, timer, precision):
    functions = matrices(bench, precision, gpu.DEVICE)
    cases = [(f, precision, n, True) for f in FUNCTIONS for n in sizes(bench)]
    compiled(bench, timer, lambda _, function: functions.function(function), cases, "torch.compile, matrices")


def start_cuda(bench):
    """A timer and the milliseconds that the context took; without a GPU a row says so."""
    if not torch.cuda.is_available():
        bench.row(device="cuda", note="skipped: PyTorch finds no GPU")
        return None
    began = time.perf_counter()
    torch.zeros(1, device=gpu.DEVICE)
    torch.cuda.synchronize()
    return gpu.Timer(torch, bench.box), (time.perf_counter() - began) * 1e3


def main(bench):
    global import_ms
    bench.version = torch.__version__
    if bench.options.routes == "cpu":
        return on_cpu(bench)
    started = start_cuda(bench)
    if not started:
        return None
    timer, context_ms = started
    import_ms += context_ms
    bench.kept = PROFILING["cuda" if bench.wants("cuda") else "compile"]
    if bench.wants("cuda"):
        on_cuda(bench, timer)
    with tempfile.TemporaryDirectory() as cache:
        os.environ["TORCHINDUCTOR_CACHE_DIR"] = cache
        for precision in measure.TYPES:
            if bench.wants(f"straight_{precision}"):
                with_straight(bench, timer, precision, "statements")
            if bench.wants(f"fused_{precision}"):
                with_straight(bench, timer, precision, "one kernel", {"max_fusion_size": FUSED})
            if bench.wants(f"matrices_{precision}"):
                with_matrices(bench, timer, precision)
        timer.profiled(bench)
    return None


if __name__ == "__main__":
    torch.backends.cuda.matmul.allow_tf32 = False  # which would cost ten bits
    main(measure.Bench("PyTorch"))
