"""The two pictures of README.md, by gnuplot."""
import subprocess
import textwrap

import study

PARTS = (f"start-up / {study.CALLS}", "copies", "launches and gaps", "kernels")
CURVES = (  # title, colour, library, route, device; on the processor dashed
    ("generated, GPU", "black", "generated", "NVRTC", "cuda"),
    ("torch.compile, statements", "red", "PyTorch", "torch.compile, statements", "cuda"),
    ("torch.compile, one kernel", "dark-red", "PyTorch", "torch.compile, one kernel", "cuda"),
    ("JAX, statements, GPU", "blue", "JAX", "jit, statements", "cuda"),
    ("JAX, matrices, GPU", "skyblue", "JAX", "jit", "cuda"),
    ("PyTorch, graph", "orange", "PyTorch", "CUDA graph", "cuda"),
    ("PyTorch, eager, GPU", "magenta", "PyTorch", "eager", "cuda"),
    ("generated, processor", "black", "generated", "host backend", "cpu"),
    ("Pinocchio (f64)", "brown", "Pinocchio", "rneaInParallel", "cpu"),
    ("NumPy, statements", "dark-green", "NumPy", "straight", "cpu"),
    ("NumPy, matrices", "green", "NumPy", "matrices", "cpu"),
    ("PyTorch, eager, processor", "magenta", "PyTorch", "eager", "cpu"),
)


def gnuplot(path, commands):
    script = f"set terminal svg size 900,520 dynamic background 'white'\nset output '{path}'\n{commands}"
    subprocess.run(["gnuplot", "-d"], input=script, text=True, check=True)


def in_lines(name):
    """A bar is as wide as some 14 letters."""
    return ",\\n".join("\\n".join(textwrap.wrap(part, 14)) for part in name.split(", "))


def draw_shares(rows, path):
    parts = study.shares(rows)
    if not parts:
        return
    block = "$shares << END\n" + "\n".join(" ".join(f"{100 * x / sum(p):.2f}" for x in p) for _, *p in parts) + "\nEND\n"
    names = ", ".join(f'"{in_lines(name)}" {i}' for i, (name, *_) in enumerate(parts))
    columns = ", ".join(f"$shares using {i + 1} title '{part}'" for i, part in enumerate(PARTS))
    gnuplot(path, block + "set style data histograms\nset style histogram rowstacked\nset style fill solid 0.8 border -1\n"
            f"set boxwidth 0.7\nset bmargin 7\nset yrange [0:100]\nset key outside top center horizontal\nset xtics ({names})\n"
            f"set ylabel 'percent of a call of {study.SHARED} samples, f32'\nplot {columns}\n")


def points(rows, library, route, device):
    """{n: ns per sample}, of several threads the best."""
    found = {}
    for precision in ("f32", "f64"):
        for r in rows.find(library, route, device, precision=precision):
            if precision == "f32" or library == "Pinocchio":
                found[r["n"]] = min(found.get(r["n"], 1e300), r["kernel_us"] * 1e3 / r["n"])
    return found


def draw_times(rows, path):
    unit = points(rows, *CURVES[0][2:]).get(study.LARGE)
    blocks, curves = "", []
    for i, (title, colour, *which) in enumerate(CURVES):
        found = points(rows, *which)
        if found and unit:
            blocks += f"$c{i} << END\n" + "\n".join(f"{n:.0f} {found[n] / unit:.5g}" for n in sorted(found)) + "\nEND\n"
            dash = 2 if which[2] == "cpu" else 1
            curves.append(f"$c{i} using 1:2 with lines lw 2 dt {dash} lc rgb '{colour}' title '{title}'")
    if curves:
        gnuplot(path, blocks + "set logscale xy\nset grid\nset key outside right\nset xrange [1:2e6]\n"
                "set format '%.0s%c'\nset ytics add ('0.1' 0.1)\nset xlabel 'samples in a batch'\n"
                'set ylabel "time per sample of the whole RNEA in f32,\\ntimes that of the generated kernel at 1 M"\n'
                f"plot {', '.join(curves)}\n")


def draw(rows, folder):
    draw_shares(rows, folder / "shares.svg")
    draw_times(rows, folder / "times.svg")
