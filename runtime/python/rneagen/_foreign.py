"""Arrays of other libraries: of a GPU by the CUDA array interface or DLPack, on their own device and in their current
stream, and of the processor by DLPack. The caller's library makes the outputs. Nothing is copied, nothing waits."""
from __future__ import annotations

import functools
import importlib
import math
from typing import Any, NamedTuple, Sequence

import numpy

from . import _arrays, _core

CUDA_DEVICES = (2, 13)  # kDLCUDA, kDLCUDAManaged
LEGACY_STREAM = 1  # of the CUDA array interface and of DLPack: the default stream


class View(NamedTuple):
    """An array as a launch sees it; `keep` must live as long."""
    address: int
    shape: tuple[int, ...]
    scalar: str
    device: int
    stream: int | None
    read_only: bool
    keep: Any


@functools.lru_cache(maxsize=64)
def protocols(kind: type) -> tuple[bool, bool]:
    """Have arrays of this type the CUDA array interface, and DLPack's device? Asked of the type: asking an array
    would make the answer."""
    return hasattr(kind, "__cuda_array_interface__"), hasattr(kind, "__dlpack_device__")


def protocols_of(array: Any) -> tuple[bool, bool]:
    return protocols(type(array))  # type: ignore[arg-type]


def on_gpu(array: Any) -> bool:
    has_interface, has_dlpack = protocols_of(array)
    return int(array.__dlpack_device__()[0]) in CUDA_DEVICES if has_dlpack else has_interface


def scalar_of(name: str, kind: str, bits: int) -> str:
    if kind != "f" or bits not in (32, 64):
        raise TypeError(f"{name}: its numbers are {kind}{bits}; float32 or float64 is wanted")
    return f"f{bits}"


def check_order(name: str, shape: Sequence[int], strides: Sequence[int] | None, unit: int) -> None:
    """Strides of C order: in elements of `unit`."""
    wanted = unit
    if strides is None or 0 in shape:
        return
    for size, stride in zip(reversed(shape), reversed(strides)):
        if size > 1 and stride != wanted:
            raise ValueError(f"{name}: it is not contiguous in C order; ascontiguousarray makes a copy that is")
        wanted *= size


def device_of(robot, array: Any) -> int:
    if protocols_of(array)[1]:
        return int(array.__dlpack_device__()[1])
    return robot._options.get("device") or 0


def view_interface(robot, name: str, array: Any) -> View:
    what = array.__cuda_array_interface__
    shape, kind = tuple(what["shape"]), what["typestr"]
    if kind[0] == ">":
        raise TypeError(f"{name}: its bytes are in another order than this machine's")
    scalar = scalar_of(name, kind[1], 8 * int(kind[2:]))
    check_order(name, shape, what.get("strides"), int(kind[2:]))
    return View(what["data"][0], shape, scalar, device_of(robot, array), what.get("stream"), what["data"][1], array)


def view_dlpack(robot, name: str, array: Any) -> View:
    capsule = array.__dlpack__(stream=LEGACY_STREAM)
    address, device, kind, bits, shape, strides = _core.dlpack(capsule)
    scalar = scalar_of(name, {2: "f"}.get(kind, "number type "), bits)
    check_order(name, shape, strides, 1)
    return View(address, shape, scalar, device, LEGACY_STREAM, False, (array, capsule))


def view(robot, name: str, array: Any) -> View:
    if not on_gpu(array):
        raise ValueError(f"{name}: it is in the processor's memory, and other arrays are on a GPU")
    return (view_interface if protocols_of(array)[0] else view_dlpack)(robot, name, array)


# ---- the caller's library ----


def library_of(array: Any):
    """Its namespace of functions; None: unknown."""
    if hasattr(array, "__array_namespace__"):
        return array.__array_namespace__()
    root = type(array).__module__.partition(".")[0]
    return importlib.import_module(root) if root == "cupy" else importlib.import_module("numba.cuda") if root == "numba" else None


def new_array(like: Any, shape: tuple[int, ...], scalar: str, name: str):
    library, dtype = library_of(like), _arrays.DTYPES[scalar]
    root = type(like).__module__.partition(".")[0]
    if root == "cupy":
        with like.device:
            return library.empty(shape, dtype)
    if root == "numba":
        return library.device_array(shape, dtype)
    if hasattr(library, "empty"):
        return library.empty(shape, dtype=getattr(like, "dtype", dtype), device=getattr(like, "device", None))
    raise TypeError(f"out: no way is known to make an array of {root} for {name}; give out=")


def stream_of(like: Any, found: View) -> int:
    """The stream that is current in the caller's library, for the driver: 0 is the default stream."""
    root = type(like).__module__.partition(".")[0]
    if root == "cupy":
        return importlib.import_module("cupy").cuda.get_current_stream().ptr
    return 0 if found.stream == LEGACY_STREAM else found.stream or 0


# ---- calls ----


def check_alike(robot, views: Sequence[View | None]) -> View:
    """All arrays have one type of numbers, and are on one device; returns the first."""
    first = next(v for v in views if v is not None)
    for array, v in zip((*robot.inputs, *robot.outputs), views):
        if v is not None and v.scalar != first.scalar:
            raise TypeError(f"{array.name}: its numbers are {v.scalar}, and those of the first array {first.scalar}: "
                            "all arrays have one dtype")
        if v is not None and v.device != first.device:
            raise ValueError(f"{array.name}: it is on device {v.device}, and the first array on {first.device}")
    return first


def outputs_for(robot, like: Any, lead: tuple[int, ...], scalar: str, out: Any) -> list[Any]:
    if out is None:
        return [new_array(like, (*lead, *a.shape), scalar, a.name) for a in robot.outputs]
    return list(_arrays.tuple_out(robot, out, "arrays"))


def views_of_outputs(robot, outputs: Sequence[Any], lead: tuple[int, ...]) -> list[View]:
    views = [view(robot, "out", x) for x in outputs]
    for array, v in zip(robot.outputs, views):
        if v.shape != (*lead, *array.shape):
            raise ValueError(f"out: the shape of the array for {array.name} is {v.shape}; {(*lead, *array.shape)} is wanted")
        if v.read_only:
            raise ValueError(f"out: the array for {array.name} is read-only")
    return views


def prepare(robot, arrays: Sequence[Any], out: Any):
    """(kernel, addresses, count, stream, outputs, what must live)."""
    like = next(x for x in arrays if x is not None)
    views: list[Any] = [None if x is None else view(robot, a.name, x) for a, x in zip(robot.inputs, arrays)]
    first = check_alike(robot, views)
    lead = _arrays.lead_of((a, v.shape) for a, v in zip(robot.inputs, views) if v is not None)
    arrays = list(arrays)
    for i, array in enumerate(robot.inputs):
        if views[i] is None:
            arrays[i] = library_of(like).asarray(_arrays.fill(array, lead, _arrays.DTYPES[first.scalar]))
            views[i] = view(robot, array.name, arrays[i])
    outputs = outputs_for(robot, like, lead, first.scalar, out)
    views += views_of_outputs(robot, outputs, lead)
    check_alike(robot, views)
    kernel = robot.kernel(robot.precision_for(first.scalar), "cuda", first.device)
    return kernel, tuple(v.address for v in views), math.prod(lead), stream_of(like, first), outputs, views


def on_host(robot, arrays: Sequence[Any], out: Any):
    """Arrays of the processor, without a copy; the outputs become the caller's library's."""
    given = next(x for x in arrays if x is not None)
    if isinstance(out, tuple):
        to = tuple(map(numpy.from_dlpack, out))
    else:
        to = None if out is None else numpy.from_dlpack(out)
    result = _arrays.call(robot, [None if x is None else numpy.from_dlpack(x) for x in arrays], to)
    back = getattr(library_of(given), "from_dlpack", None)
    if out is not None or back is None:
        return result if out is None else out
    return robot._join(list(map(back, result))) if isinstance(result, tuple) else back(result)


def constant(values: numpy.ndarray, shape: tuple[int, ...], like: Any):
    """An array like `like` with values that are the same for all samples."""
    return library_of(like).asarray(_arrays.constant(values, shape, like))


def call(robot, arrays: Sequence[Any], out: Any):
    if not on_gpu(next(x for x in arrays if x is not None)):
        return on_host(robot, arrays, out)
    if robot._conversion:
        return robot._conversion.call(arrays, out)
    _arrays.refuse(robot.sparse)
    kernel, addresses, count, stream, outputs, _ = prepare(robot, arrays, out)
    kernel.launch(addresses, count, stream)
    return robot._join(outputs)


def bind(robot, arrays: Sequence[Any], out: Any):
    if not on_gpu(next(x for x in arrays if x is not None)):
        raise TypeError("bind: take arrays of NumPy: numpy.from_dlpack makes them without a copy")
    _arrays.refuse_conversion(robot)
    _arrays.refuse(robot.sparse)
    kernel, addresses, count, stream, outputs, views = prepare(robot, arrays, out)
    return kernel.bind(addresses, count, stream, robot._join(outputs), (views, tuple(arrays)))
