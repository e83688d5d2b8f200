#!/usr/bin/env python3
"""Forward dynamics on this machine's GPU beside its processor, by rnearun eval: the same bits with --strict, else nearly the same
numbers; bounds that hold; and nothing found by the sanitizers of CUDA.
usage: tests/gpu/forward_check.py FOLDER        (of tests/gpu/prepare). Exit status 1: something is wrong."""
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np

SEED, SAMPLES = 5, 3000
TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# robot, nq and nv, type of the arrays, options, outputs; at most this far apart, of the largest element
CASES = [
    ("iiwa14", 7, 7, "f64", [], ["qdd", "Minv", "dqdd_dq", "dqdd_dqd"], 1e-12),
    ("hyq", 19, 18, "f64", ["--base", "floating"], ["qdd", "Minv"], 1e-12),
    ("hyq", 19, 18, "f32", ["--base", "floating", "--refine", "1"], ["qdd"], 1e-6),
    ("mimic_chain", 2, 2, "f64", [], ["qdd", "dqdd_dq"], 1e-12),
    ("iiwa14", 7, 7, "f32", [], ["qdd", "qdd_bound"], 0.1),
    ("panda", 8, 8, "f32", ["--strict"], ["qdd", "dqdd_dq"], 0),
    ("panda", 8, 8, "f64", ["--strict"], ["qdd", "Minv"], 0),
    ("iiwa14", 7, 7, "f32", ["--strict", "--refine", "1:f64"], ["qdd"], 0),
    ("atlas", 30, 30, "f32", ["--strict", "--dynamics", "articulated"], ["qdd"], 0),
    # relays: three kernels of one launch
    ("hyq", 19, 18, "f64", ["--base", "floating"], ["qdd", "dqdd_dq", "dqdd_dqd"], 1e-12),
    ("atlas", 30, 30, "f64", [], ["qdd", "dqdd_dq", "dqdd_dqd"], 1e-11),
    # the first of them in parts
    ("atlas", 30, 30, "f32", [], ["qdd", "dqdd_dq", "dqdd_dqd"], 1e-3),
    ("g1_29dof", 29, 29, "f64", [], ["qdd", "dqdd_dq", "dqdd_dqd"], 1e-11),
]
# robot, nq and nv, options, outputs
SANITIZED = [
    ("atlas", 30, 30, ["--dynamics", "articulated"], ["qdd"]),
    ("iiwa14", 7, 7, ["--refine", "1"], ["qdd", "qdd_bound", "dqdd_dq"]),
    ("hyq", 19, 18, ["--base", "floating"], ["qdd", "dqdd_dq", "dqdd_dqd"]),
    ("atlas", 30, 30, [], ["qdd", "dqdd_dq", "dqdd_dqd"]),
]


def states(rng, nq, nv, dtype, count):
    q = rng.uniform(-1, 1, (count, nq))
    if nq > nv:
        q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1)[:, None]
    given = {"q": q, "qd": rng.uniform(-1, 1, (count, nv)), "tau": rng.uniform(-5, 5, (count, nv))}
    return {name: x.astype(dtype) for name, x in given.items()}


def evaluate(folder, work, backend, robot, options, given, wanted, before=()):
    command = [*before, f"{folder}/rnearun/rnearun", "eval", f"{TOP}/tests/robots/{robot}.urdf", "--backend", backend, "--quiet",
               "--want", ",".join(wanted), *options]
    for name, x in given.items():
        np.save(f"{work}/{name}.npy", x)
        command += ["--input", f"{name}={work}/{name}.npy"]
    for name in wanted:
        command += ["--output", f"{name}={work}/out_{name}.npy"]
    environment = dict(os.environ, LD_LIBRARY_PATH=f"{folder}/rnearun", RNEA_CACHE="")
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode:
        print(" ".join(command), done.stdout[-600:], done.stderr[-600:])
        return None
    return [np.load(f"{work}/out_{name}.npy") for name in wanted]


def bounds_hold(folder, work, robot, given, gpu):
    exact = evaluate(folder, work, "cpu", robot, ["--precision", "f64"], {k: x.astype(float) for k, x in given.items()}, ["qdd"])
    return bool(exact is not None and (np.abs(gpu[0] - exact[0]) <= gpu[1]).all())


def check(folder, case):
    """What is said of a case, and whether it is good."""
    robot, nq, nv, precision, options, wanted, limit = case
    given = states(np.random.default_rng(SEED), nq, nv, np.float32 if precision == "f32" else np.float64, SAMPLES)
    options = [*options, "--precision", precision]
    title = " ".join([robot, *options, ",".join(wanted)])
    with tempfile.TemporaryDirectory() as work:
        gpu, cpu = (evaluate(folder, work, backend, robot, options, given, wanted) for backend in ("cuda", "cpu"))
        if gpu is None or cpu is None:
            return f"{title}: FAIL", False
        off = max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in zip(gpu, cpu))
        holds = "qdd_bound" not in wanted or bounds_hold(folder, work, robot, given, gpu)
    said = f"{title}: " + ("the same bits" if off == 0 else f"apart by {off:.1e}")
    if "qdd_bound" in wanted:
        said += "\n  its bounds " + ("hold" if holds else "DO NOT HOLD")
    good = off <= limit and holds
    return said + ("" if good else " FAIL"), good


def sanitize(folder, case):
    robot, nq, nv, options, wanted, tool = case
    given = states(np.random.default_rng(SEED), nq, nv, np.float32, 300)
    before = ["compute-sanitizer", "--tool", tool, "--error-exitcode", "9"]
    with tempfile.TemporaryDirectory() as work:
        clean = evaluate(folder, work, "cuda", robot, [*options, "--precision", "f32"], given, wanted, before) is not None
    return f"{tool} of {robot} {','.join(wanted)}: " + ("nothing found" if clean else "FAIL"), clean


def main():
    folder = os.path.abspath(sys.argv[1])
    jobs = [(check, case) for case in CASES]
    jobs += [(sanitize, (*case, tool)) for case in SANITIZED for tool in ("memcheck", "racecheck", "initcheck")]
    good = []
    # nothing is timed, and compilers take most of the time
    with ThreadPoolExecutor(8) as pool:
        for said, is_good in pool.map(lambda job: job[0](folder, job[1]), jobs):
            print(said, flush=True)
            good.append(is_good)
    print(f"seed {SEED}: {len(good) - sum(good)} failures")
    return 0 if all(good) else 1


sys.exit(main())
