"""Times on a GPU, by PyTorch's events, graphs and profiler, for PyTorch's own work and for the generated kernels."""
import contextlib
import fcntl
import os
import statistics
import time

import measure

DEVICE = "cuda"
GRAPH_US = 200            # what one graph holds at least, in calls of up to GRAPH_CALLS
GRAPH_CALLS = 20
PROFILED = {"rnea": (1, 16384, 1048576)}  # sizes, of the other functions the second alone
COPIED_BYTES = 1 << 29    # more is not copied for a row


@contextlib.contextmanager
def alone(path):
    """The GPU for one of several programs that compile at the same time."""
    if not path:
        yield
        return
    with open(path, "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


class Timer:
    def __init__(self, torch, box):
        self.torch, self.box, self.copied, self.later = torch, box, {}, []
        self.stream = torch.cuda.Stream()

    def between(self, call, count):
        """Microseconds per call between two events around `count` calls in the current stream."""
        first, last = (self.torch.cuda.Event(enable_timing=True) for _ in range(2))
        first.record()
        for _ in range(count):
            call()
        last.record()
        last.synchronize()
        return first.elapsed_time(last) * 1e3 / count

    def many(self, call):
        """The median of between() over groups of a millisecond or more, within the box."""
        once = self.between(call, 3)
        count, times, end = max(1, min(2000, int(1000 / max(once, 0.5)))), [], time.perf_counter() + self.box
        while not times or time.perf_counter() < end:
            times.append(self.between(call, count))
        return statistics.median(times)

    def events(self, call):
        """Of calls one after the other in the stream, as the host enqueues them."""
        with self.torch.cuda.stream(self.stream):
            for _ in range(2):
                call()
            self.stream.synchronize()
            return self.many(call)

    def graph(self, call, estimate):
        """Of the same calls in a graph that is replayed, so that the host has no part in it."""
        count = max(1, min(GRAPH_CALLS, int(GRAPH_US / max(estimate, 1))))
        graph = self.captured(call, count)
        with self.torch.cuda.stream(self.stream):
            graph.replay()
            self.stream.synchronize()
            return self.many(graph.replay) / count

    def captured(self, call, count=1):
        torch = self.torch
        graph = torch.cuda.CUDAGraph()
        with torch.cuda.graph(graph, stream=self.stream):
            for _ in range(count):
                call()
        return graph

    def waited(self, call):
        """Of the host's clock, waiting for each call: what a program sees that needs the result."""
        with self.torch.cuda.stream(self.stream):
            times, end = [], time.perf_counter() + self.box / 2
            while len(times) < 3 or time.perf_counter() < end and len(times) < 1000:
                began = time.perf_counter()
                call()
                self.stream.synchronize()
                times.append(time.perf_counter() - began)
        return statistics.median(times) * 1e6

    def profile(self, call):
        """How long the GPU was busy in one call, and how many kernels and copies it ran."""
        profiler = self.torch.profiler
        with profiler.profile(activities=[profiler.ProfilerActivity.CUDA]) as p:
            call()
            self.torch.cuda.synchronize()
        spans = [e.time_range.elapsed_us() for e in p.events() if str(e.device_type).endswith("CUDA")]
        if not spans:
            raise RuntimeError("the profiler saw nothing of the GPU")
        return {"method": "profiler", "busy_us": sum(spans), "launch_count": len(spans)}

    def profile_later(self, key, call):
        """Remember call(), at some sizes, for profiled(): once a profiler has run, launches may take longer."""
        if key["n"] in PROFILED.get(key["function"], PROFILED["rnea"][1:2]):
            self.later.append((key, call))

    def profiled(self, bench):
        """The rows of what was remembered, in the seconds that were kept; first the size of which shares are told."""
        bench.kept = 0
        for key, call in sorted(self.later, key=lambda x: (x[0]["n"] != measure.SHOWN, x[0]["function"] != "rnea")):
            with alone(os.environ.get("PEERS_LOCK")):
                bench.attempt(lambda: self.profile(call), **key)

    def copies(self, key, inputs, outputs):
        """The copies of NumPy's `inputs` to the GPU and of the tensors `outputs` back, page-locked; once for a key."""
        torch = self.torch
        if sum(x.nbytes for x in inputs) + sum(x.numel() * x.element_size() for x in outputs) > COPIED_BYTES:
            return {}
        if key not in self.copied:
            there = [torch.from_numpy(x).pin_memory() for x in inputs]
            here = [torch.empty(x.shape, dtype=x.dtype, device=DEVICE) for x in there]
            back = [torch.empty(x.shape, dtype=x.dtype).pin_memory() for x in outputs]
            self.copied[key] = {"h2d_us": self.events(lambda: copy_all(here, there)),
                                "d2h_us": self.events(lambda: copy_all(back, outputs))}
        return self.copied[key]


def copy_all(targets, sources):
    for target, source in zip(targets, sources):
        target.copy_(source, non_blocking=True)


def tuple_of(x):
    return tuple(x) if isinstance(x, (tuple, list)) else (x,)


def first_call(torch, call):
    """call() and its milliseconds until the GPU is done."""
    began = time.perf_counter()
    result = call()
    torch.cuda.synchronize()
    return result, (time.perf_counter() - began) * 1e3
