"""What the tests of ranks share: .npy files by themselves, programs and what they say."""
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile
from array import array
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.append(str(Path(__file__).parents[1] / "scripts"))
from checks import ALL, check, finish

RNEARUN, RNEARUN_MPI = sys.argv[1:3]
ROBOTS = Path(__file__).parents[1] / "robots"
PENDULUM, PANDA = (str(ROBOTS / f"{name}.urdf") for name in ("pendulum", "panda"))
HEADER = 128

# Open MPI starts as root, and more ranks than there are cores, only where it is told to (the last: Open MPI 5)
os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1",
                  PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe", OMPI_MCA_hwloc_base_binding_policy="none")
# libraries of MPI keep what they have taken
os.environ["ASAN_OPTIONS"] = "detect_leaks=0"


def skip_without_mpi():
    if RNEARUN_MPI == "-" or not shutil.which("mpirun"):
        print("skipped: there is no MPI: libopenmpi-dev and openmpi-bin, and cmake again")
        sys.exit(77)


def in_folder(tests):
    """Run the tests in a folder of their own, which holds the cache; ends the program."""
    seed = int(os.environ.get("SEED", random.randrange(1 << 32)))
    print(f"seed {seed} (SEED)")
    random.seed(seed)
    with tempfile.TemporaryDirectory(prefix="ranks.", dir=".") as folder:
        os.chdir(folder)
        os.environ["RNEA_CACHE"] = os.getcwd() + "/cache"
        # what Open MPI has in files goes with the folder where a launcher is killed
        os.environ["OMPI_MCA_btl_vader_backing_directory"] = os.environ["OMPI_MCA_orte_tmpdir_base"] = os.getcwd()
        for test in tests:
            test()
        os.chdir("..")
    finish()


def put_header(f, samples, columns, f32=False):
    text = f"{{'descr': '<f{4 if f32 else 8}', 'fortran_order': False, 'shape': ({samples}, {columns}), }}"
    f.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", HEADER - 10) + text.ljust(HEADER - 11).encode() + b"\n")


def put_array(path, samples, columns, f32=False):
    """Random numbers from -2 to 2."""
    with open(path, "wb") as f:
        put_header(f, samples, columns, f32)
        array("f" if f32 else "d", [random.uniform(-2, 2) for _ in range(samples * columns)]).tofile(f)


def put_sparse(path, samples, columns, last=0):
    """Zeros, that take no room on the disk; the last samples are random."""
    with open(path, "wb") as f:
        put_header(f, samples, columns)
        f.truncate(HEADER + 8 * samples * columns)
        f.seek(HEADER + 8 * (samples - last) * columns)
        array("d", [random.uniform(-2, 2) for _ in range(last * columns)]).tofile(f)


def run(words, status=0, says="", env=None):
    """Run a program to its end; what it said."""
    p = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **(env or {})}, stdin=subprocess.DEVNULL)
    check(p.returncode == status, f"{words}: status {p.returncode}, not {status}: {p.stderr}")
    check(says in p.stderr, f"{words}: '{says}' is not in '{p.stderr}'")
    return p


def own_lines(p):
    """What the command itself said."""
    return [line for line in p.stderr.splitlines() if line.startswith("rnearun")]


def one(*words, **how):
    return run([RNEARUN, "eval", *words, "--backend", "cpu"], **how)


def ranks(count, *words, backend="cpu", **how):
    return run(["mpirun", "-n", str(count), RNEARUN_MPI, "eval", *words, "--backend", backend], **how)


def ranks_by(count, script, *words, **how):
    """Each rank by a script of the shell, with $RANK, which ends in `exec "$@"`."""
    start = "RANK=${OMPI_COMM_WORLD_RANK:-${PMIX_RANK:-$PMI_RANK}}; "
    return run(["mpirun", "-n", str(count), "sh", "-c", start + script, "sh", RNEARUN_MPI, "eval", *words, "--backend", "cpu"],
               **how)


def same(path, other, what):
    check(Path(path).read_bytes() == Path(other).read_bytes(), f"{what}: {path} and {other} differ")


def files(begins):
    return sorted(name for name in os.listdir(".") if name.startswith(begins))


def check_files(begins, *names):
    check(files(begins) == sorted(names), f"there are {files(begins)}, and not {sorted(names)}")
