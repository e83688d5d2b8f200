"""What the programs with_*.py share: states and exact results, the order and the limits of measuring, rows."""
import argparse
import json
import os
import statistics
import sys
import time
from pathlib import Path

import numpy as np

import exact
from model import Model
from spatial import FUNCTIONS

COUNTS = (1048576, 1024, 1, 16384, 65536, 4096, 262144, 256, 64, 16)  # the most important first
COLUMNS = ("library", "version", "route", "function", "device", "precision", "n", "threads", "block", "method",
           "error_max", "error_rms", "import_ms", "cold_ms", "cached_ms", "h2d_us", "kernel_us", "stream_us",
           "call_us", "busy_us", "d2h_us", "launch_count", "note")
TYPES = {"f32": np.float32, "f64": np.float64}


class Data:
    """Inputs and exact results of one precision: the states of rnea_reference, again and again up to n."""

    def __init__(self, folder, model, precision):
        self.type, self.model = TYPES[precision], model
        wide = [np.load(folder / precision / f"{name}.npy") for name in ("q", "qd", "qdd", "tau")]
        *self.states, self.tau = (x.astype(exact.WIDE) for x in wide)
        self.passed = exact.fpass(model, *self.states)
        self.kept = {}

    def rounded(self, x):
        return x.astype(self.type).astype(exact.WIDE)

    def exact_inputs(self, function):
        q, qd, qdd = self.states
        v, _, f = (self.rounded(x) for x in self.passed)
        return {"rnea": (q, qd, qdd), "fpass": (q, qd, qdd), "bpass": (q, f), "cross_operator": (v[:, -1],),
                "mxS": (v[:, -1], qd[:, -1]), "vxIv": (v[:, -1],)}[function]

    def exact_outputs(self, function):
        if function == "rnea":
            return (self.tau,)
        if function == "fpass":
            return self.passed
        inputs = self.exact_inputs(function)
        result = getattr(exact, function)(*(() if function == "cross_operator" else (self.model,)), *inputs)
        return (result,)

    def inputs(self, function, n):
        """NumPy arrays [n, ...]."""
        if self.kept.get("key") != (function, n):
            arrays = self.exact_inputs(function)
            which = np.arange(n) % len(self.tau)
            self.kept = {"key": (function, n), "arrays": tuple(x.astype(self.type)[which] for x in arrays)}
        return self.kept["arrays"]

    def errors(self, function, n, outputs, axis=0):
        """(largest, root mean square) of ||x - exact|| / ||exact|| over the first and the last samples of the arrays
        `outputs`, whose samples lie along `axis`, 0 or -1; of several outputs the worst. Not a number counts as infinite."""
        count = min(n, len(self.tau))
        largest = rms = 0.0
        for x, right in zip(outputs, self.exact_outputs(function)):
            ends = [x[:count], x[n - count:]] if axis == 0 else [x[..., :count], x[..., n - count:]]
            got = np.concatenate([as_numpy(e, count, axis) for e in ends])
            which = np.concatenate([np.arange(count), np.arange(n - count, n)]) % len(self.tau)
            e = relative(got, right.reshape(len(right), -1)[which])
            largest, rms = max(largest, float(e.max())), max(rms, float(np.sqrt(np.mean(e**2))))
        return largest, rms


def as_numpy(x, count, axis):
    x = x.cpu() if hasattr(x, "cpu") else x.get() if hasattr(x, "get") else x
    x = np.asarray(x)
    return (x if axis == 0 else np.moveaxis(x.reshape(-1, count), -1, 0)).reshape(count, -1)


def relative(got, right):
    scale = np.linalg.norm(right.astype(np.float64), axis=1)
    e = np.linalg.norm((got.astype(exact.WIDE) - right).astype(np.float64), axis=1) / np.where(scale > 0, scale, 1)
    return np.where(np.isfinite(e), e, np.inf)


def clock(call, box):
    """Microseconds of call(), which has run before: the median of some 20 groups of calls within `box` seconds."""
    began = time.perf_counter()
    call()
    once = time.perf_counter() - began
    if once > box / 3:
        return once * 1e6
    group, times, end = max(1, int(box / 20 / once)), [], began + box
    while time.perf_counter() < end:
        began = time.perf_counter()
        for _ in range(group):
            call()
        times.append((time.perf_counter() - began) / group)
    return statistics.median(times) * 1e6


def first_and_clock(call, box):
    """What call() returns, and its clock(); a call of a second or more is not made again."""
    began = time.perf_counter()
    result = call()
    once = time.perf_counter() - began
    return result, once * 1e6 if once > 1 else clock(call, box)


class Bench:
    """The command line of every with_*.py, and its rows, one line of JSON each on standard output."""

    def __init__(self, library):
        parser = argparse.ArgumentParser()
        parser.add_argument("folder", type=Path)
        parser.add_argument("--routes", default="")
        parser.add_argument("--seconds", type=float, default=60)
        parser.add_argument("--box", type=float, default=0.1)
        parser.add_argument("--largest", type=int, default=max(COUNTS))
        parser.add_argument("--librnea", default="")
        self.options = parser.parse_args()
        self.library, self.version, self.box = library, "", self.options.box
        self.end = time.monotonic() + self.options.seconds
        self.folder = self.options.folder
        self.model = Model(next(self.folder.glob("*.urdf")))
        self.data = {precision: Data(self.folder, self.model, precision) for precision in TYPES}
        self.counts = [n for n in COUNTS if n <= self.options.largest]
        self.threads = [t for t in (1, 2, 4, 8, 16) if t <= (os.cpu_count() or 1)]

    def wants(self, route):
        return not self.options.routes or route in self.options.routes.split(",")

    def late(self):
        return time.monotonic() > self.end

    def row(self, **values):
        print(json.dumps({"library": self.library, "version": self.version, **values}), flush=True)

    def attempt(self, make, late=False, **key):
        """The row that make() fills, or one with the reason why there is none; `late`: also when the time is over. True:
        there is one."""
        if self.late() and not late:
            return False
        try:
            self.row(**{**key, **make()})
            return True
        except Exception as e:
            reason = (str(e).strip() or type(e).__name__).splitlines()[0][:150]
            self.row(**key, note=f"failed: {reason}")
            return False

    def steps_large_last(self):
        """steps() for a processor, on which a million samples of the matrices take seconds."""
        small, large = ([n for n in self.counts if (n > 65536) == last] for last in (False, True))
        for functions, counts in ((("rnea",), small), (FUNCTIONS[1:], small), (("rnea",), large), (FUNCTIONS[1:], large)):
            yield from self.steps(functions, counts=counts)

    def steps(self, functions=FUNCTIONS, precisions=("f32", "f64"), counts=None):
        """(function, precision, n): first all of rnea, then the others, each size of all of them, until the time is over."""
        counts = self.counts if counts is None else counts
        order = [(f, n) for f in functions if f == "rnea" for n in counts]
        order += [(f, n) for n in counts for f in functions if f != "rnea"]
        for function, n in order:
            for precision in precisions:
                if self.late():
                    self.row(function=function, precision=precision, n=n, note="not measured: out of time from here on")
                    return
                yield function, precision, n


def start(library, name):
    """The module `name` with its import time in ms; without it a row says so and the program ends."""
    began = time.perf_counter()
    try:
        module = __import__(name)
    except Exception as e:  # not installed, or not for this machine
        print(json.dumps({"library": library, "note": f"skipped: {str(e).splitlines()[0][:150]}"}), flush=True)
        sys.exit(0)
    return module, (time.perf_counter() - began) * 1e3
