"""librnea's functions by ctypes, beside those of examples/torch_call.py, for any precision, kernel and backend."""
import ctypes
import sys
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "examples"))
from torch_call import FUNCTIONS, rnea_error, rnea_info, rnea_options

RNEA_BACKEND_CUDA, RNEA_BACKEND_HOST = 1, 2
KERNELS = ("rnea", "fpass", "bpass")


class rnea_info_whole(ctypes.Structure):  # as far as the count of its arrays
    _fields_ = rnea_info._fields_ + [("input_count", c_size_t), ("output_count", c_size_t)]


class rnea_build(ctypes.Structure):
    _fields_ = [("backend", c_int), ("device", c_char_p), ("compiler", c_char_p), ("target", c_char_p), ("note", c_char_p),
                ("cached", c_int), ("seconds", c_double), ("min_blocks", c_uint), ("threads", c_uint)]


class rnea_resources(ctypes.Structure):
    _fields_ = [("registers", c_int), ("local_bytes", c_size_t), ("shared_bytes", c_size_t), ("max_block", c_uint),
                ("busy_block", c_uint)]


MORE = {
    **FUNCTIONS,
    "rnea_info": (POINTER(rnea_info_whole), c_void_p),
    "rnea_build": (POINTER(rnea_build), c_void_p),
    "rnea_resources": (c_int, c_void_p, c_char_p, POINTER(rnea_resources), POINTER(rnea_error)),
    "rnea_launch_kernel": (c_int, c_void_p, c_char_p, POINTER(c_void_p), c_size_t, c_void_p, POINTER(rnea_error)),
    "rnea_run": (c_int, c_void_p, POINTER(c_void_p), c_size_t, POINTER(rnea_error)),
}


def kernel_name(function):
    """What a text calls it: one of another function has rnea alone."""
    return (function if function in KERNELS else "rnea").encode()


class Robot:
    """One opened text. `cache`: a folder, or "" for none; `block` 0: what the text says; `threads` 0: all."""

    def __init__(self, library, text, backend, cache="", block=0, threads=0):
        self.library, self.handle, self.error = ctypes.CDLL(library), c_void_p(), rnea_error()
        for name, (returned, *taken) in MORE.items():
            function = getattr(self.library, name)
            function.restype, function.argtypes = returned, taken
        options = rnea_options(backend=backend, cache=str(cache).encode(), block=block, threads=threads)
        self.check(self.library.rnea_open_file(str(text).encode(), options, self.handle, self.error))
        self.info = self.library.rnea_info(self.handle).contents
        self.build = self.library.rnea_build(self.handle).contents
        self.outputs = [self.info.arguments[self.info.input_count + i].rows for i in range(self.info.output_count)]

    def check(self, code):
        if code:
            raise RuntimeError(self.error.message.decode())

    def output_rows(self, function):
        """Scalars per sample of each output of the function."""
        body = 6 * self.info.nb
        return [body] * 3 if function == "fpass" else [self.info.nv] if function == "bpass" else self.outputs

    def launcher(self, function, addresses, count, stream=None):
        """A call that launches the kernel `function` on arrays at these addresses."""
        arrays, kernel = (c_void_p * len(addresses))(*addresses), kernel_name(function)
        launch, handle, error = self.library.rnea_launch_kernel, self.handle, self.error
        return lambda: self.check(launch(handle, kernel, arrays, count, stream, error))

    def runner(self, addresses, count):
        """A call of rnea_run on arrays of the program's own."""
        arrays = (c_void_p * len(addresses))(*addresses)
        return lambda: self.check(self.library.rnea_run(self.handle, arrays, count, self.error))

    def registers(self, function):
        found = rnea_resources()
        self.check(self.library.rnea_resources(self.handle, kernel_name(function), found, self.error))
        return found.registers

    def close(self):
        self.library.rnea_close(self.handle)
