"""What the programs with_*.py share: states and exact results, the order and the limits of measuring, rows."""
import argparse
import itertools
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
SHOWN = 16384    # samples for which the functions are compared
SCALED = 262144  # samples for which numbers of threads are compared
CACHED = 65536   # of more, a processor takes seconds for the matrices
FIRST = COUNTS[:4]  # the sizes of the tables
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
        parser.add_argument("--end", type=float, help="by the monotonic clock, in place of --seconds")
        parser.add_argument("--box", type=float, default=0.1)
        parser.add_argument("--largest", type=int, default=max(COUNTS))
        parser.add_argument("--librnea", default="")
        self.options = parser.parse_args()
        self.library, self.version, self.box = library, "", self.options.box
        self.end = self.options.end or time.monotonic() + self.options.seconds
        self.kept = 0  # seconds before the end that are for what comes last
        self.told = set()
        self.folder = self.options.folder
        self.model = Model(next(self.folder.glob("*.urdf")))
        self.data = {precision: Data(self.folder, self.model, precision) for precision in TYPES}
        self.counts = [n for n in COUNTS if n <= self.options.largest]
        self.threads = [t for t in (1, 2, 4, 8, 16) if t <= (os.cpu_count() or 1)]

    def wants(self, route):
        return not self.options.routes or route in self.options.routes.split(",")

    def late(self, needed=0):
        """Are there less than `needed` seconds until the end, what is kept left out?"""
        return time.monotonic() + needed > self.end - self.kept

    def row(self, **values):
        print(json.dumps({"library": self.library, "version": self.version, **values}), flush=True)

    def attempt(self, make, needed=0, **key):
        """The row that make() fills, or one with the reason why there is none. True: there is one."""
        if self.late(needed):
            self.tell(needed, **key)
            return False
        try:
            self.row(**{**key, **make()})
            return True
        except Exception as e:
            reason = (str(e).strip() or type(e).__name__).splitlines()[0][:150]
            self.row(**key, note=f"failed: {reason}")
            return False

    def tell(self, needed, route="", function="", precision="", **more):
        """Once for a route and function: there was no time to begin."""
        which = {"route": route, "function": function, "precision": precision}
        if needed and tuple(which.values()) not in self.told:
            self.told.add(tuple(which.values()))
            self.row(**which, note=f"not measured from n = {more['n']} on: less than {needed} s were left")

    def order(self, large):
        """(functions, sizes): what the tables show comes first; of sizes above `large` the whole RNEA after smaller ones."""
        few = [n for n in self.counts if n <= large]
        many = [n for n in self.counts if n > large]
        shown = [n for n in few if n in FIRST]
        rest = [n for n in few if n not in FIRST]
        yield from ((("rnea",), shown), (FUNCTIONS[1:], [n for n in shown if n == SHOWN]))
        yield from ((("rnea",), rest), (("rnea",), many))
        yield from ((FUNCTIONS[1:], [n for n in few if n != SHOWN]), (FUNCTIONS[1:], many))

    def steps(self, functions=FUNCTIONS, precisions=("f32", "f64"), large=max(COUNTS)):
        """(function, precision, n) in order(), until the time is over."""
        for which, counts in self.order(large):
            for n, function, precision in itertools.product(counts, which, precisions):
                if function in functions:
                    if self.late():
                        self.row(function=function, precision=precision, n=n, note="not measured: out of time from here on")
                        return
                    yield function, precision, n

    def steps_of_processor(self, functions=FUNCTIONS):
        """steps() where a million samples take seconds; doubles, of which there is a table, first."""
        return self.steps(functions, ("f64", "f32"), CACHED)


def start(library, name):
    """The module `name` with its import time in ms; without it a row says so and the program ends."""
    began = time.perf_counter()
    try:
        module = __import__(name)
    except Exception as e:  # not installed, or not for this machine
        print(json.dumps({"library": library, "note": f"skipped: {str(e).splitlines()[0][:150]}"}), flush=True)
        sys.exit(0)
    return module, (time.perf_counter() - began) * 1e3
