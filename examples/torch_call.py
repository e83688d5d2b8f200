#!/usr/bin/env python3
"""Torques of a batch that lies on the GPU in PyTorch tensors or CuPy arrays: no copy, on the current stream.

usage: torch_call.py LIBRNEA.so TEXT.cu TEXT_C.so [COUNT]

TEXT.cu is a robot's text for CUDA in f32, TEXT_C.so its text for C in f64, compiled to a shared object, against which
the result is held; both with `--layout aos`, so that arrays are [sample][row]. Exit status 77: no GPU, or neither
PyTorch nor CuPy.
"""
import ctypes
import random
import sys
from ctypes import POINTER, c_char, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p

# ---- what is used of rnea.h, by its names; tests/examples/torch_call_layout compares with the compiler's layout ----

RNEA_OK, RNEA_F32, RNEA_AOS, RNEA_BACKEND_CUDA = 0, 0, 1, 1


class rnea_error(ctypes.Structure):
    _fields_ = [("code", c_int), ("message", c_char * 2048)]


class rnea_options(ctypes.Structure):
    _fields_ = [("backend", c_int), ("file", c_char_p), ("device", c_int), ("block", c_uint), ("threads", c_uint),
                ("cache", c_char_p), ("compile", POINTER(c_char_p)), ("compile_count", c_size_t), ("log", c_char_p),
                ("log_size", c_size_t), ("stop", c_void_p), ("stop_context", c_void_p)]


class rnea_argument(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("rows", c_size_t), ("scalar", c_int), ("per_batch", c_int),
                ("role", c_int), ("of", c_char_p)]


class rnea_info(ctypes.Structure):  # as far as it is used; only librnea makes one
    _fields_ = [("name", c_char_p), ("precision", c_int), ("arithmetic", c_char_p), ("layout", c_int),
                ("trig", c_char_p), ("base", c_char_p), ("nq", c_size_t), ("nv", c_size_t), ("nb", c_size_t), ("block", c_uint),
                ("arguments", POINTER(rnea_argument))]


FUNCTIONS = {  # name: what is returned, what is taken
    "rnea_open_file": (c_int, c_char_p, POINTER(rnea_options), POINTER(c_void_p), POINTER(rnea_error)),
    "rnea_info": (POINTER(rnea_info), c_void_p),
    "rnea_launch": (c_int, c_void_p, POINTER(c_void_p), c_size_t, c_void_p, POINTER(rnea_error)),
    "rnea_close": (None, c_void_p),
}


class Robot:
    def __init__(self, library, text, device=0):
        self.library, self.handle, self.error = ctypes.CDLL(library), c_void_p(), rnea_error()
        for name, (returned, *taken) in FUNCTIONS.items():
            function = getattr(self.library, name)
            function.restype, function.argtypes = returned, taken
        options = rnea_options(backend=RNEA_BACKEND_CUDA, device=device)
        self.check(self.library.rnea_open_file(text.encode(), options, self.handle, self.error))
        self.info = self.library.rnea_info(self.handle).contents
        if self.info.precision != RNEA_F32 or self.info.layout != RNEA_AOS:
            raise ValueError(f"{text}: generate it with --precision f32 --layout aos")

    def check(self, code):
        if code != RNEA_OK:
            raise RuntimeError(self.error.message.decode())

    def address(self, array, i, count):
        """The device pointer of any array that follows the CUDA array interface, as PyTorch's and CuPy's do."""
        wanted, what = self.info.arguments[i], array.__cuda_array_interface__
        shape = (count, wanted.rows)
        if what["shape"] != shape or what["typestr"] != "<f4" or what.get("strides"):
            raise ValueError(f"{wanted.name.decode()}: {shape} floats in one piece are wanted")
        return what["data"][0]

    def torques(self, q, qd, qdd, tau, stream):
        """Enqueue tau = ID(q, qd, qdd) in `stream`, a cudaStream_t."""
        arrays = [self.address(a, i, len(q)) for i, a in enumerate((q, qd, qdd, tau))]
        self.check(self.library.rnea_launch(self.handle, (c_void_p * 4)(*arrays), len(q), stream, self.error))
        return tau

    def close(self):
        """Once what was launched is done."""
        self.library.rnea_close(self.handle)


def torques_in_c(path, name, rows, *states):
    """The same by NAME_rnea_batch of the C text, in doubles."""
    count = len(states[0])
    arrays = [(c_double * (rows * count))(*(v for sample in x for v in sample)) for x in states]
    tau = (c_double * (rows * count))()
    getattr(ctypes.CDLL(path), f"{name}_rnea_batch")(*arrays, tau, c_size_t(count))
    return list(tau)


def largest_error(tau, right, rows):
    """||tau - right|| / ||right||, of all samples the largest; infinite where tau is not finite."""
    def norm(x):
        return sum(v * v for v in x) ** 0.5

    errors = []
    for k in range(0, len(right), rows):
        difference = norm(a - b for a, b in zip(tau[k:k + rows], right[k:k + rows]))
        errors.append(difference / norm(right[k:k + rows]) if difference < float("inf") else float("inf"))
    return max(errors)


# ---- the two libraries; a stream of each is made the current one ----


def with_torch(torch, robot, states):
    with torch.cuda.stream(torch.cuda.Stream()):
        q, qd, qdd = (torch.tensor(x, device="cuda") for x in states)
        tau = robot.torques(q, qd, qdd, torch.empty_like(qd), torch.cuda.current_stream().cuda_stream)
        return tau.flatten().tolist()


def with_cupy(cupy, robot, states):
    with cupy.cuda.Stream(non_blocking=True):
        q, qd, qdd = (cupy.asarray(x, dtype="f4") for x in states)
        tau = robot.torques(q, qd, qdd, cupy.empty_like(qd), cupy.cuda.get_current_stream().ptr)
        return tau.get().ravel().tolist()


def find(name, has_gpu, run):
    """[(the library's name, the function above for it)], or [] having said why."""
    try:
        library = __import__(name)
        if has_gpu(library):
            return [(name, lambda *more: run(library, *more))]
        print(f"skipped: {name}: it finds no GPU")
    except Exception as e:  # not installed, or not for this machine's driver
        print(f"skipped: {name}: {e}")
    return []


def random_states(count, rows, seed=1):
    """q, qd, qdd as lists of lists, of multiples of 1/1024: every float holds them exactly."""
    integer = random.Random(seed).randrange
    return [[[integer(-3072, 3073) / 1024 for _ in range(rows)] for _ in range(count)] for _ in range(3)]


def main(librnea, text, text_c, count="4000"):
    found = find("torch", lambda torch: torch.cuda.is_available(), with_torch)
    found += find("cupy", lambda cupy: cupy.cuda.runtime.getDeviceCount() > 0, with_cupy)
    if not found:
        return 77
    robot, status = Robot(librnea, text), 0
    rows, name = robot.info.nv, robot.info.name.decode()
    states = random_states(int(count), rows)
    right = torques_in_c(text_c, name, rows, *states)
    for library, run in found:
        error = largest_error(run(robot, states), right, rows)
        print(f"{library}: {count} samples of {name}, largest error {error:.2g}")
        status |= not error < 1e-5
    robot.close()
    return int(status)


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
