"""What a text takes and gives, and calls on arrays of NumPy that are not the plain case."""
from __future__ import annotations

import dataclasses
import difflib
import functools
import importlib
import keyword
import math
import operator
import re
from typing import Any, Iterable, Sequence

import numpy

SCALARS = {"f32": "f32", "mixed": "f32", "f64": "f64", "f32x2": "f64"}  # numbers in memory, by precision
NUMPY, JAX = "_arrays NumPy", "jax JAX"  # modules, and what messages call their arrays
SYMMETRIC = ("mass_matrix", "opspace_inertia")  # roles of matrices that may be stored by their lower triangle
DTYPES = {"f32": numpy.dtype("float32"), "f64": numpy.dtype("float64")}


@dataclasses.dataclass(frozen=True)
class Array:
    """An input or output: `shape` of a sample, before which stand the axes of samples. `per_batch`: one for all samples."""
    name: str
    word: str
    rows: int
    shape: tuple[int, ...]
    role: str
    of: str
    is_output: bool
    per_batch: bool
    default: tuple[float, ...] | None  # of an input that may be left out
    pattern: tuple[tuple[int, ...], tuple[int, ...]] | None  # of a matrix by joints: rows and columns of what is stored
    size: tuple[int, int]  # of such a matrix; else 0, 0

    @property
    def is_matrix(self) -> bool:
        return self.pattern is not None

    @functools.cached_property
    def is_lower(self) -> bool:
        """Is only the lower triangle of a symmetric matrix stored?"""
        return self.role.startswith(SYMMETRIC) and all(r >= c for r, c in zip(*(self.pattern or ((), ()))))


def describe(array: dict[str, Any], nv: int, sparse: bool) -> Array:
    """An entry of _core.Model.arrays()."""
    rows, pattern = array["rows"], array["pattern"]
    *pattern, lines, columns = pattern or (0, 0)
    if array["role"] == "link_pose":  # [R p] is always whole
        pattern = []
    shape: tuple[int, ...] = (rows,)
    if array["role"] in ("power", "kinetic_energy", "potential_energy"):
        shape = ()
    elif array["role"] == "link_pose" and lines:
        shape = (lines, columns)
    elif pattern and not sparse:
        shape = (lines, columns)
    elif array["is_output"] and array["role"].endswith("_dfreed"):
        shape = (nv, rows // nv)
    if array["default"] is not None:
        array["default"] = tuple(array["default"] + [0.0] * (rows - len(array["default"])))
    if rows != math.prod(shape):
        raise AssertionError(f"{array['name']}: {rows} rows are no {shape}")
    array = {**array, "pattern": (tuple(pattern[0]), tuple(pattern[1])) if pattern else None}
    return Array(shape=shape, size=(lines, columns), **array)


def identifiers(arrays: Sequence[Array]) -> list[str]:
    """What fields of a named tuple are called: the scene's words, or else the text's names."""
    words = [re.sub(r"\W", "_", array.word) for array in arrays]
    good = len(set(words)) == len(words) and all(w.isidentifier() and not keyword.iskeyword(w) and w[0] != "_" for w in words)
    return words if good else [array.name for array in arrays]


def whole(name: str, value: Any, end: int) -> int:
    """A number from 0 to end - 1."""
    try:
        number = int(operator.index(value))
    except TypeError:
        raise TypeError(f"{name} takes a whole number, not {value!r}") from None
    if not 0 <= number < end:
        raise ValueError(f"{name} takes a whole number from 0 to {end - 1}, not {number}")
    return number


def copy_of(x: numpy.ndarray) -> numpy.ndarray:
    """In one piece, where its numbers have their places in memory."""
    return numpy.require(x, None, ["C", "A"])


def fill(array: Array, lead: tuple[int, ...], dtype) -> numpy.ndarray:
    """What an input that was left out is."""
    return spread(array.default, array.shape if array.per_batch else (*lead, *array.shape), dtype)


def spread(values: Any, shape: tuple[int, ...], dtype) -> numpy.ndarray:
    """An array with values that are the same for all samples."""
    return numpy.ascontiguousarray(numpy.broadcast_to(numpy.asarray(values, dtype), shape))


ENOUGH = 3  # inputs, with which `out` may be given by its place; with fewer, one that other outputs take would be written over


def places(inputs: int) -> int:
    """How many arrays a call may name by their place."""
    return inputs + (inputs >= ENOUGH)


def takes(names: Sequence[str], has_out: bool) -> str:
    if has_out:
        return f"the robot takes {', '.join([*names, 'and out'])}"
    return f"the robot takes {', '.join(names) or 'no array'}; what it writes into is named, out="


def arguments(robot, args: tuple, kwargs: dict[str, Any]) -> tuple[list[Any], Any]:
    """By input the array that was given, or None for one that may be left out; and out."""
    inputs, names = robot.inputs, [a.name for a in robot.inputs]
    has_out = places(len(names)) > len(names)
    if len(args) > places(len(names)):
        raise TypeError(f"{len(args)} arrays: {takes(names, has_out)}")
    given = dict(zip((*names, "out"), args))
    for name, value in kwargs.items():
        name = {a.word: a.name for a in inputs}.get(name, name)
        if name == "sparse":
            raise TypeError("sparse= is a keyword of load and of want, robot.want(..., sparse=True), not of a call")
        if name not in (*names, "out"):
            near = difflib.get_close_matches(name, (*names, "out"), 1)
            raise TypeError(f"'{name}' is no input: {takes(names, has_out)}" + (f"; did you mean '{near[0]}'?" if near else ""))
        if name in given:
            raise TypeError(f"{name} is given twice")
        given[name] = value
    for array in inputs:
        if given.get(array.name) is None and array.default is None:
            raise TypeError(f"{array.name} is missing: the robot takes {', '.join(names)}")
    return [given.get(name) for name in names], given.get("out")


def check_dtypes(given: Sequence[tuple[Array, Any]]) -> None:
    """A TypeError that names the input, where arrays of one library are not all of float32 or all of float64."""
    first, like = given[0]
    for array, x in given:
        if str(x.dtype).rpartition(".")[2] not in ("float32", "float64"):
            raise TypeError(f"{array.name}: its dtype is {x.dtype}; float32 or float64 is wanted")
        if x.dtype != like.dtype:
            raise TypeError(f"{array.name}: its dtype is {x.dtype}, and that of {first.name} is {like.dtype}: "
                            "all arrays have one")


def lead_of(given: Iterable[tuple[Array, tuple[int, ...]]]) -> tuple[int, ...]:
    """The axes of samples, of inputs and their shapes; another shape is a ValueError."""
    lead: Any = None
    first = ""
    for array, shape in given:
        own = len(array.shape)
        axes = shape[:len(shape) - own]
        if len(shape) < own or shape[len(shape) - own:] != array.shape or array.per_batch and axes:
            goes = f"; {(*lead, *array.shape)} goes with {first}" if lead and not array.per_batch else ""
            raise ValueError(f"{array.name}: its shape is {shape}; {array.shape} is wanted" +
                             (", for all samples" if array.per_batch else ", or axes of samples before it") + goes)
        if not array.per_batch and lead is None:
            lead, first = axes, array.name
        elif not array.per_batch and axes != lead:
            raise ValueError(f"{array.name}: its shape is {shape}; {(*lead, *array.shape)} goes with {first}")
    return lead or ()


def samples_of(inputs: Iterable[Array], arrays: Iterable[Any]) -> tuple[int, ...]:
    """The axes of samples of these inputs' arrays, of which None was left out."""
    of_samples = ((a, x) for a, x in zip(inputs, arrays) if x is not None and not a.per_batch)
    return next((tuple(x.shape[:len(x.shape) - len(a.shape)]) for a, x in of_samples), ())


def tuple_out(robot, out: Any, kind: str) -> tuple:
    """An array for each output; `kind` is what messages call them."""
    outputs = out if isinstance(out, tuple) else (out,)
    if len(outputs) != len(robot.outputs):
        raise TypeError(f"out: a tuple of {len(robot.outputs)} {kind} is wanted, one for each output")
    return outputs


def refuse(is_sparse: bool) -> None:
    """What other arrays than NumPy's have not."""
    if is_sparse:
        raise TypeError("sparse matrices are for arrays of NumPy; take sparse=False")


def refuse_conversion(robot) -> None:
    """What a bound step has not."""
    if robot._conversion:
        raise TypeError(f"bind: convention {robot.convention!r} converts the arrays at every call; "
                        "bind a robot of convention 'pinocchio'")


def adapter(robot, arrays: Sequence[Any], out: Any):
    """The module whose functions call and bind take arrays of this kind: this one, _foreign, torch or jax."""
    given = {a.name: x for a, x in zip(robot.inputs, arrays)}
    outs = {"out": x for x in (out if isinstance(out, tuple) else [out]) if x is not None}
    module = kind_of_all({**given, **outs})[1].partition(" ")[0]
    return module_of(module)


def kind_of_all(given: dict[str, Any]) -> tuple[str, str]:
    """The kind of all arrays that are not None, by kind_of, and the name of one of that kind. Arrays of NumPy may stand among
    those of JAX, as JAX's own functions have it."""
    kinds = {name: kind_of(name, x) for name, x in given.items() if x is not None}
    found = set(kinds.values())
    if found == {JAX, NUMPY}:
        found = {JAX}
    if len(found) > 1:
        first, *rest = kinds.items()
        name, kind = next((n, k) for n, k in rest if k != first[1])
        raise TypeError(f"{name}: an array of {kind.partition(' ')[2]}, and {first[0]} is one of {first[1].partition(' ')[2]}: "
                        "all arrays are of one kind")
    kind = next(iter(found), "_arrays")
    return next((name for name, k in kinds.items() if k == kind), ""), kind


@functools.lru_cache(maxsize=None)
def module_of(name: str):
    return importlib.import_module(f"rneagen.{name}")


def kind_of(name: str, array: Any) -> str:
    """The module for it, and what messages call its kind."""
    root = type(array).__module__.partition(".")[0]
    if root == "torch":
        return "torch PyTorch"
    if root in ("jax", "jaxlib"):
        return JAX
    if isinstance(array, numpy.ma.MaskedArray):
        raise TypeError(f"{name}: a masked array; array.filled() makes a plain one")
    if isinstance(array, numpy.ndarray):
        return NUMPY
    if hasattr(type(array), "__cuda_array_interface__") or hasattr(type(array), "__dlpack__"):
        return f"_foreign {root}"
    raise TypeError(f"{name}: {type(array).__name__} is no array; numpy.asarray makes one of it")


def complete(robot, arrays: Sequence[Any]) -> tuple[numpy.ndarray, ...]:
    """Plain arrays, what was left out filled in."""
    given = [x for x in arrays if x is not None]
    dtype = given[0].dtype if given else DTYPES[robot.scalar or "f64"]
    lead = samples_of(robot.inputs, arrays)
    return tuple(fill(a, lead, dtype) if x is None else numpy.asarray(x) for a, x in zip(robot.inputs, arrays))


def plain(out: Any):
    """Views of NumPy's own type, of a memmap for one."""
    if isinstance(out, tuple):
        return tuple(map(plain, out))
    return numpy.asarray(out) if isinstance(out, numpy.ndarray) else out


def constant(values: numpy.ndarray, shape: tuple[int, ...], like: Any):
    """An array like `like` with values that are the same for all samples."""
    return spread(values, shape, like.dtype)


def _returned(out: Any, result: Any):
    return result if out is None else out


def call(robot, arrays: Sequence[Any], out: Any):
    if robot._conversion:
        return robot._conversion.call([x if x is None else numpy.asarray(x) for x in arrays], out)
    return robot._wrap(_returned(out, robot._run(complete(robot, arrays), plain(out))))


def bind(robot, arrays: Sequence[Any], out: Any):
    refuse_conversion(robot)
    if robot.sparse:
        raise TypeError("bind: sparse matrices are made at every call; take sparse=False")
    return robot._bind(complete(robot, arrays), plain(out))
