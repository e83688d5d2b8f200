"""What the results of run say, as the text of README.md."""
import csv
import math

CALLS = 100000   # over which the shares spread the start-up
SHARED = 16384  # samples a call, for the shares
LARGE = 1048576
SCALED = 262144  # for the numbers of threads: measure.SCALED
GPU_ROUTES = (  # what README.md calls it, library, the route
    ("generated, NVRTC", "generated", "NVRTC"),
    ("generated, nvcc", "generated", "nvcc"),
    ("torch.compile of the statements, all in one kernel", "PyTorch", "torch.compile, one kernel"),
    ("torch.compile of the statements", "PyTorch", "torch.compile, statements"),
    ("JAX, jit of the statements", "JAX", "jit, statements"),
    ("JAX, vmap and jit of the matrices", "JAX", "vmap and jit"),
    ("JAX, jit of the matrices", "JAX", "jit"),
    ("torch.compile of the matrices", "PyTorch", "torch.compile, matrices"),
    ("PyTorch, CUDA graph", "PyTorch", "CUDA graph"),
    ("PyTorch, eager", "PyTorch", "eager"),
    ("CuPy, matrices", "CuPy", "matrices"),
)
CPU_ROUTES = (  # and the threads; 0: the most that were measured
    ("generated, one thread", "generated", "host backend", 1),
    ("generated, all threads", "generated", "host backend", 0),
    ("Pinocchio, `rneaInParallel`, one thread", "Pinocchio", "rneaInParallel", 1),
    ("Pinocchio, `rneaInParallel`, all threads", "Pinocchio", "rneaInParallel", 0),
    ("Pinocchio, `rnea` in Python's loop", "Pinocchio", "rnea, Python's loop", 1),
    ("MuJoCo, `mj_rne` in Python's loop", "MuJoCo", "mj_rne, Python's loop", 1),
    ("NumPy, statements, slices in all threads", "NumPy", "straight, slices", 0),
    ("NumPy, statements, slices in all processes", "NumPy", "straight, processes", 0),
    ("NumPy, statements", "NumPy", "straight", 1),
    ("NumPy, matrices, slices in all threads", "NumPy", "matrices, slices", 0),
    ("NumPy, matrices, slices in all processes", "NumPy", "matrices, processes", 0),
    ("NumPy, matrices", "NumPy", "matrices", 1),
    ("PyTorch, eager, one thread", "PyTorch", "eager", 1),
    ("PyTorch, eager, all threads", "PyTorch", "eager", 0),
    ("JAX, jit of the statements", "JAX", "jit, statements", None),
    ("JAX, jit of the matrices", "JAX", "jit", None),
)
THREADED = (  # a process of one thread is the first of the threads
    ("generated", "generated", "host backend"),
    ("NumPy, statements in slices", "NumPy", "straight, slices"),
    ("NumPy, statements in slices, processes", "NumPy", "straight, processes"),
    ("NumPy, matrices in slices", "NumPy", "matrices, slices"),
    ("NumPy, matrices in slices, processes", "NumPy", "matrices, processes"),
    ("Pinocchio", "Pinocchio", "rneaInParallel"),
)
NUMBERS = ("n", "threads", "block", "error_max", "error_rms", "import_ms", "cold_ms", "cached_ms", "h2d_us", "kernel_us",
           "stream_us", "call_us", "busy_us", "d2h_us", "launch_count")


class Rows:
    def __init__(self, path):
        with open(path, newline="") as file:
            self.head = file.readline().lstrip("# ").strip()
            rows = [{k: number(v) if k in NUMBERS else v for k, v in row.items()} for row in csv.DictReader(file)]
        self.rows = [r for r in rows if r["method"] != "profiler"]
        for r in rows:
            if r["method"] == "profiler":
                self.add_profile(r)

    def add_profile(self, profile):
        """What the profiler saw, to the rows that it belongs to; a graph runs the kernels of the eager calls."""
        for r in self.rows:
            route = "eager" if r["route"] == "CUDA graph" else r["route"]
            if (r["library"], route) == (profile["library"], profile["route"]) and all(
                    r[k] == profile[k] for k in ("function", "device", "precision", "n")):
                r.update(busy_us=profile["busy_us"], launch_count=profile["launch_count"])

    def find(self, library, route, device, function="rnea", precision="f32", n=None, threads=None, block=None):
        """The rows with times."""
        wanted = {"library": library, "route": route, "device": device, "function": function, "precision": precision}
        wanted |= {k: v for k, v in (("n", n), ("threads", threads), ("block", block)) if v is not None}
        return [r for r in self.rows if (r["kernel_us"] or r["call_us"]) and all(r[k] == v for k, v in wanted.items())]

    def one(self, *arguments, **values):
        """The row, or {}. threads=0: that of the most threads."""
        most = values.get("threads") == 0
        found = self.find(*arguments, **{**values, "threads": None} if most else values)
        return max(found, key=lambda r: r["threads"] or 0) if most and found else found[0] if found else {}

    def startup_ms(self, library, route, precision="f32"):
        """(import, first call or compilation, the same from a cache): the first that is stated."""
        rows = self.find(library, route, "cuda", precision=precision)
        return [next((r[c] for r in rows if r[c]), None) for c in ("import_ms", "cold_ms", "cached_ms")]

    def launches(self, library, route, precision="f32"):
        """Those of SHARED samples: of more a library may split a batch."""
        return self.one(library, route, "cuda", precision=precision, n=SHARED).get("launch_count")


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


def short(x, digits=3):
    """Digits that mean something; "-": not measured."""
    if x is None:
        return "-"
    if x == 0 or not math.isfinite(x):
        return f"{x:g}"
    return f"{x:.{max(0, digits - 1 - math.floor(math.log10(abs(x))))}f}"


def whole(x):
    return "-" if x is None else f"{x:.0f}"


def error(x):
    return "-" if x is None else f"{x:.1e}"


def size(n):
    return f"{int(n) >> 20} M" if n >= LARGE else str(int(n))


def markdown(head, lines, left=1):
    rule = "|" + "|".join(["---"] * left + ["---:"] * (len(head) - left)) + "|"
    first, *rest = ("| " + " | ".join(line) + " |" for line in (head, *lines))
    return "\n".join([first, rule, *rest]) + "\n"


def total(*parts):
    return None if None in parts else sum(parts)


def with_copies(row):
    return total(row.get("h2d_us"), row.get("call_us"), row.get("d2h_us"))


# ---- the tables ----


def gpu_table(rows, precision):
    lines = []
    for name, library, route in GPU_ROUTES:
        at = {n: rows.one(library, route, "cuda", precision=precision, n=n) for n in (1, 1024, SHARED, LARGE)}
        if any(at.values()):
            loading, cold, cached = rows.startup_ms(library, route, precision)
            lines.append([name, short(total(loading, cold) and (loading + cold) / 1e3), short(cached and cached / 1e3),
                          whole(rows.launches(library, route, precision)), short(at[1].get("call_us")),
                          *(short(at[n].get("kernel_us")) for n in (1024, SHARED, LARGE)), short(with_copies(at[LARGE])),
                          error(at[LARGE].get("error_max") or at[1024].get("error_max"))])
    return markdown([f"{precision}, on the GPU", "start-up, s", "compiled before, s", "launches at 16384",
                     "1 sample, waited for, us", "1024, us", "16384, us", "1 M, us", "1 M with copies, us", "error max"], lines)


def six_table(rows, precision, n):
    """The six functions, as multiples of the generated kernel's time."""
    columns = [r for r in GPU_ROUTES if r[0] in ("JAX, jit of the matrices", "PyTorch, CUDA graph", "PyTorch, eager")]
    lines = []
    for function in ("cross_operator", "mxS", "vxIv", "fpass", "bpass", "rnea"):
        own = rows.one("generated", "NVRTC", "cuda", function, precision, n).get("kernel_us")
        other = [rows.one(library, route, "cuda", function, precision, n) for _, library, route in columns]
        other += [rows.one("generated", "host backend", "cpu", function, precision, n, threads=0),
                  rows.one("NumPy", "matrices", "cpu", function, precision, n)]
        lines.append([f"`{function}`", short(own), *(short(own and r.get("kernel_us") and r["kernel_us"] / own) for r in other)])
    return markdown([f"{precision}, {n} samples", "generated, GPU, us", *(f"{c[0]}, times that" for c in columns),
                     "generated, all processors", "NumPy, matrices, one thread"], lines)


def cpu_table(rows):
    sizes, first, lines = (1, 1024, SHARED, LARGE), {}, []
    for name, library, route, threads in CPU_ROUTES:
        at = {n: rows.one(library, route, "cpu", precision="f64", n=n, threads=threads) for n in sizes}
        first = first or {n: r.get("kernel_us") for n, r in at.items()}
        if any(at.values()):
            found = next(r["error_max"] for r in at.values() if r)
            lines.append([name, *(short(first[n] and r.get("kernel_us") and r["kernel_us"] / first[n], 2) for n, r in at.items()),
                          error(max((r["error_max"] for r in at.values() if r), default=found))])
    return markdown(["f64, on the processor, times the first", "1 sample", "1024", "16384", "1 M", "error max"], lines)


def thread_table(rows):
    """Speed-up over one thread."""
    counts = sorted({r["threads"] for r in rows.find("generated", "host backend", "cpu", n=SCALED) if r["threads"]})
    lines = []
    for name, library, route in THREADED:
        for precision in ("f32", "f64"):
            us = [rows.one(library, route, "cpu", precision=precision, n=SCALED, threads=t).get("kernel_us") for t in counts]
            if any(us):
                alone = rows.one(library, route.replace("processes", "slices"), "cpu", precision=precision, n=SCALED, threads=1)
                us[0] = alone.get("kernel_us")
                lines.append([f"{name}, {precision}", *(short(us[0] and u and us[0] / u, 2) for u in us)])
    return markdown([f"{SCALED} samples, times as fast as one thread", *(f"{int(t)}" for t in counts)], lines)


def block_table(rows):
    blocks, lines = (32, 64, 128, 256, 512, 1024), []
    for precision in ("f32", "f64"):
        for n in (1024, SHARED, LARGE):
            found = (rows.one("generated", "NVRTC, block", "cuda", "rnea", precision, n, block=b) for b in blocks)
            us = [r.get("kernel_us") for r in found]
            if any(us):
                lines.append([f"{precision}, {size(n)}", *(short(u) for u in us)])
    return markdown(["threads in a block; us", *(str(b) for b in blocks)], lines)


def shares(rows):
    """[(name, start-up, copies, launches, kernel)] in us of a call, of the routes where launches can be told from work."""
    result = []
    for name, library, route in GPU_ROUTES:
        row = rows.one(library, route, "cuda", n=SHARED)
        loading, cold, _ = rows.startup_ms(library, route)
        graph = rows.one("PyTorch", "CUDA graph", "cuda", n=SHARED) if route == "eager" else row if row.get("stream_us") else {}
        busy = row.get("busy_us") or (graph.get("kernel_us") if graph.get("method") == "graph" else None)
        spent = row.get("stream_us") or row.get("kernel_us")
        copies = total(row.get("h2d_us"), row.get("d2h_us"))
        if None not in (busy, spent, copies, loading):
            result.append((name, (loading + (cold or 0)) * 1e3 / CALLS, copies, max(0.0, spent - busy), busy))
    return result


def share_table(rows):
    lines = [[name, *(f"{100 * x / sum(parts):.0f} %" for x in parts), short(sum(parts))] for name, *parts in shares(rows)]
    return markdown([f"f32, {SHARED} samples a call", f"start-up / {CALLS}", "copies", "launches and gaps", "kernels",
                     "in all, us"], lines)


# ---- where the processor stops to be faster ----


def crossing(cpu, gpu, time):
    """The sizes between which the GPU becomes the faster one: (last that it loses, first from which it wins for good)."""
    sizes = sorted({r["n"] for r in cpu} & {r["n"] for r in gpu})
    best = {n: min(r["kernel_us"] for r in cpu if r["n"] == n) for n in sizes}
    spent = {n: next((time(r) for r in gpu if r["n"] == n), None) for n in sizes}
    lost = [n for n in sizes if spent[n] is not None and spent[n] > best[n]]
    won = [n for n in sizes if spent[n] is not None and n > max(lost, default=0)]
    return (max(lost) if lost else None), (min(won) if won else None)


def crossing_text(found):
    lost, won = found
    if lost is None:
        return "the GPU at any size" if won else "-"
    return f"between {size(lost)} and {size(won)}" if won else "the processor at any size"


def crossing_table(rows):
    pairs = (("generated", ("generated", "host backend"), ("generated", "NVRTC")),
             ("NumPy's matrices, PyTorch eager", ("NumPy", "matrices"), ("PyTorch", "eager")),
             ("NumPy's statements, torch.compile", ("NumPy", "straight"), ("PyTorch", "torch.compile, statements")),
             ("generated on the processor, PyTorch's graph", ("generated", "host backend"), ("PyTorch", "CUDA graph")),
             ("Pinocchio, generated on the GPU", ("Pinocchio", "rneaInParallel"), ("generated", "NVRTC")))
    lines = []
    for name, cpu, gpu in pairs:
        for precision in ("f32", "f64"):
            ours, theirs = rows.find(*cpu, "cpu", precision=precision), rows.find(*gpu, "cuda", precision=precision)
            if ours and theirs:
                lines.append([f"{name}, {precision}", crossing_text(crossing(ours, theirs, lambda r: r["call_us"])),
                              crossing_text(crossing(ours, theirs, with_copies))])
    return markdown(["processor (its best number of threads), GPU", "arrays on the GPU", "with copies there and back"], lines, 3)


# ---- the text ----


def finding(rows):
    """The study's question, in figures."""
    parts = {name: x for name, *x in shares(rows)}
    eager, graph = (rows.one("PyTorch", r, "cuda", n=SHARED) for r in ("eager", "CUDA graph"))
    own = rows.one("generated", "NVRTC", "cuda", n=SHARED)
    count = rows.launches("PyTorch", "eager")
    if not (eager and own and count and "PyTorch, eager" in parts):
        return ""
    large, kernel = (rows.one(*r, "cuda", n=LARGE).get("kernel_us") for r in (("PyTorch", "CUDA graph"), ("generated", "NVRTC")))
    _, copies, gaps, busy = parts["PyTorch, eager"]
    text = (f"**What makes the GPU versions slow.** At {SHARED} samples in f32 one RNEA of the matrices is {count:.0f} launches. "
            f"PyTorch spends {short(eager['kernel_us'])} us on it, of which the GPU computes for {short(busy)} us and waits for "
            f"the host for {100 * gaps / (gaps + busy):.0f} %; the copies take {short(copies)} us, the fused kernel, one launch, "
            f"{short(own['kernel_us'])} us.")
    if graph:
        text += f" A graph takes the host out of it: {short(graph['kernel_us'])} us."
    if kernel and large:
        text += (f" What is left is memory: every launch reads and writes whole batches of 6x6 matrices, and at 1 M samples, "
                 f"where launches no longer show, the graph takes {short(large / kernel)} times the fused kernel's time.")
    return text + "\n\n"


def compiled(rows, route):
    """(times the generated kernel's time at 1 M samples in f32, in f64, ms to compile, us of one sample that is waited for) of a
    route of torch.compile; None where one of them was not measured."""
    found = []
    for precision in ("f32", "f64"):
        own = rows.one("generated", "NVRTC", "cuda", precision=precision, n=LARGE)
        other = rows.one("PyTorch", f"torch.compile, {route}", "cuda", precision=precision, n=LARGE)
        found.append(own and other and short(other["kernel_us"] / own["kernel_us"], 2))
    found.append(rows.startup_ms("PyTorch", f"torch.compile, {route}")[1])
    found.append(rows.one("PyTorch", f"torch.compile, {route}", "cuda", n=1).get("call_us"))
    return found if all(found) else None


def rewritten(rows):
    """What torch.compile of the statements gives, and what not."""
    plain, joined = compiled(rows, "statements"), compiled(rows, "one kernel")
    own = rows.one("generated", "NVRTC", "cuda", n=1)
    if not plain or not own:
        return ""
    note = rows.one("PyTorch", "torch.compile, statements", "cuda", n=LARGE)["note"]
    text = (f"**Rewritten for torch.compile**, as {note} on scalars that a tracer wrote, the RNEA takes {plain[0]} times as long "
            f"as the generated one at 1 M samples in f32 and {plain[1]} times in f64: Inductor joins at most 64 operations, and "
            f"what lies between its kernels goes through memory. ")
    if joined:
        text += (f"With `max_fusion_size` raised it makes one kernel and comes near: {joined[0]} times in f32, {joined[1]} times "
                 f"in f64. Sizes are dynamic, and 1024 samples were compiled first, here and in the tables; from a first size of "
                 f"1 M Inductor makes blocks that spill. ")
    cold = " and ".join(f"{short(x[2] / 1e3)} s" for x in (plain, joined) if x)
    return text + (f"It compiles for {cold}, for each precision and again for a batch of one; one sample, waited for, takes "
                   f"{short((joined or plain)[3])} us from Python, the generated kernel {short(own['call_us'])} us. It has no C "
                   "interface, needs PyTorch wherever it runs, and somebody has to write the statements.\n\n")


def slices(rows):
    """How NumPy's threads were measured, where its processes were too."""
    if not rows.find("NumPy", "straight, processes", "cpu", precision="f64"):
        return ""
    return ("NumPy works on slices of the samples, in threads, or in processes that share the arrays. Threads wait for "
            "Python's lock\nbefore each operation. glibc is told to keep freed memory (MALLOC_TRIM_THRESHOLD_). "
            "Without that NumPy "
            "takes several times\nas long, because each array gets fresh pages.\n")


def section(rows):
    return f"""A study of 2023 timed NumPy, PyTorch, Julia and CUDA.jl on six functions of the iiwa 14. It left open why the GPU
versions were slow. Its published code does not compute what it times. PyTorch's forward pass returns after the first joint.
Nothing waits for the GPU before the clock is read. X(q) is made outside the timed code. Products run along the wrong axis.
CUDA.jl repeats the batch in every block. Here the same six functions are written for each library as its users would write
them, with X(q) inside. Each result is compared with the reference. Julia was not available; nothing is claimed about it.

Measured by `tests/bench/peers/run` in one run: {rows.head}.

- GPU times are of replayed CUDA graphs where the work can be captured. Otherwise they are of events around repeated calls;
  for JAX they are of the host's clock over queued calls.
- "Waited for" is what a Python program sees that needs each result before it goes on.
- Copies are from and to page-locked memory (JAX: pageable).
- "Start-up" is the import, the CUDA context and the first compilation. "Compiled before" is the compilation alone, when an
  earlier run has left its result on disk (nvcc: loading).
- "Matrices" are batches of 6x6 matrices. "Statements" are one assignment for each operation on scalars.
- A dash: not measured. [peers.csv](results/peers.csv) has every row, and says where a run was out of time.

{gpu_table(rows, "f32")}
{gpu_table(rows, "f64")}
{finding(rows)}![Shares of a call](results/shares.svg)

{share_table(rows)}
{rewritten(rows)}![Time per sample](results/times.svg)

{six_table(rows, "f32", SHARED)}
{six_table(rows, "f64", SHARED)}
**Threads and blocks.** The study left NumPy in threads and the sizes of blocks to later work. The processor is that of a virtual
machine. The same row differed by a factor of two between some runs, so only larger ratios between rows mean something. Where
the machine takes one processor away for some milliseconds, all threads wait for it. A call of a few microseconds then shows a
ratio in the thousands.
{slices(rows)}
{thread_table(rows)}
{block_table(rows)}
**The processor alone**, as these libraries are used from Python. The loops pay for Python's calls.

{cpu_table(rows)}
**Up to how many samples the processor is faster**, for a program that waits for each batch.

{crossing_table(rows)}"""
