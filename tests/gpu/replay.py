#!/usr/bin/env python3
"""What the time of a sample depends on in a Python program: launches of one kernel back to back by CuPy, over batch sizes, where
the arrays come from, how launches are queued, and what the arrays hold.

usage: replay.py FOLDER OUT.csv

FOLDER holds texts in f32 and soa, compiled by NVRTC. The table lists what takes over a tenth longer than the text's median
for angles within 3 rad. Exit status 77: no GPU, or no CuPy.
"""
import csv
import itertools
import os
import re
import statistics
import sys
import time
from pathlib import Path

try:
    import cupy
    cupy.zeros(1)
except Exception as e:  # whichever way it is not there
    print(f"skipped: {str(e).splitlines()[0]}")
    sys.exit(77)

SIZES = (262144, 393216, 524288, 700000, 786432, 1000000, 1048576, 1500000, 2097152)
LAUNCHES, REPEATS = 20, 5
COLUMNS = ("text", "n", "memory", "queue", "values", "ps", "ps_min", "ps_max")
VALUES = {  # of q, qd and qdd; beyond 1e4 an angle in f32 is reduced in another way
    "within 3": lambda n: cupy.random.uniform(-3, 3, n, cupy.float32),
    "normal": lambda n: cupy.random.standard_normal(n, cupy.float32),
    "zero": lambda n: cupy.zeros(n, cupy.float32),
    "beyond 1e4": lambda n: cupy.random.uniform(2e4, 1e7, n, cupy.float32),
    "one of 1e5 beyond": lambda n: cupy.where(cupy.random.uniform(0, 1, n, cupy.float32) < 1e-5, cupy.float32(1e7),
                                              cupy.float32(1)),
}


class Text:
    def __init__(self, path):
        source, began = path.read_text(), time.perf_counter()
        self.name = path.stem
        self.block, self.parts = (int((re.findall(rf'"{word} (\d+)\\n"', source) or [1])[0]) for word in ("block", "parts"))
        table = source.split('"function rnea\\n"')[1].split('"function ')[0]
        self.arrays = [(name, int(rows)) for name, rows in re.findall(r'"(?:input|output) (\w+) (\d+) f32 sample', table)]
        self.kernel = cupy.RawModule(code=source,
                                     backend="nvrtc").get_function(re.search(r"^(\w+_rnea_kernel)\(", source, re.M)[1])
        print(f"{self.name}: compiled in {time.perf_counter() - began:.1f} s, {self.kernel.num_regs} registers", flush=True)

    def launch(self, arrays, n):
        self.kernel(((n + self.block - 1) // self.block, self.parts), (self.block,), (*arrays, cupy.uint64(n)))


def make_arrays(text, n, memory, values):
    sizes = [rows * n for _, rows in text.arrays]
    if memory == "fresh":
        cupy.get_default_memory_pool().free_all_blocks()
    if memory == "slab":
        slab, at = cupy.empty(sum(sizes), cupy.float32), itertools.accumulate(sizes, initial=0)
        arrays = [slab[a:a + size] for a, size in zip(at, sizes)]
    else:
        arrays = [cupy.empty(size, cupy.float32) for size in sizes]
    for (name, _), x in zip(text.arrays, arrays):
        if name in ("q", "qd", "qdd"):
            x[:] = VALUES[values](x.size)
    return arrays


def make_call(text, arrays, n, queue):
    def call():
        for _ in range(LAUNCHES):
            text.launch(arrays, n)

    if queue == "stream":
        return call
    with cupy.cuda.Stream(non_blocking=True) as stream:
        stream.begin_capture()
        call()
        graph = stream.end_capture()
    return graph.launch


def measure(call):
    """Milliseconds of calls, by events."""
    times, first, last = [], cupy.cuda.Event(), cupy.cuda.Event()
    for i in range(REPEATS + 1):
        first.record()
        call()
        last.record()
        last.synchronize()
        times += [cupy.cuda.get_elapsed_time(first, last)] * (i > 0)
    return times


def cases():
    for n in SIZES:
        yield from ((n, memory, queue, "within 3") for memory, queue in
                    (("pool", "graph"), ("pool", "stream"), ("slab", "graph"), ("fresh", "graph")))
    for n in (262144, 786432, 1048576):
        yield from ((n, "pool", "graph", values) for values in list(VALUES)[1:])


def row(text, n, memory, queue, values):
    arrays = make_arrays(text, n, memory, values)
    cupy.cuda.Device().synchronize()  # they were filled in another stream
    times = measure(make_call(text, arrays, n, queue))
    ps = [t / LAUNCHES / n * 1e9 for t in (statistics.median(times), min(times), max(times))]
    return dict(zip(COLUMNS, (text.name, n, memory, queue, values, *(f"{x:.1f}" for x in ps))))


def tell(name, rows):
    usual = statistics.median(float(r["ps"]) for r in rows if r["values"] == "within 3")
    print(f"{name}: {usual:.0f} ps a sample")
    for r in rows:
        if float(r["ps_max"]) > 1.1 * usual:
            print(f"    {float(r['ps']) / usual:.2f} times that: " +
                  ", ".join(str(r[k]) for k in ("n", "memory", "queue", "values")))


def main(folder, out):
    with open(out, "w", newline="") as f:
        if os.environ.get("RNEA_DEVICE"):
            f.write("# device {RNEA_DEVICE}, driver {RNEA_DRIVER}, commit {RNEA_COMMIT}\n".format(**os.environ))
        table = csv.DictWriter(f, COLUMNS, lineterminator="\n")
        table.writeheader()
        for path in sorted(Path(folder).glob("*.cu")):
            text = Text(path)
            rows = [row(text, *case) for case in cases()]
            table.writerows(rows)
            tell(text.name, rows)


if __name__ == "__main__":
    main(*sys.argv[1:])
