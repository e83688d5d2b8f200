"""A robot that is called."""
from __future__ import annotations

import functools
import hashlib
import importlib
import inspect
import itertools
import json
import keyword
import os
import re
import sys
import threading
import warnings
import weakref
from collections import namedtuple
from typing import Any, Callable, Iterable, NamedTuple, Unpack

import numpy

from . import _arrays, _convention, _core, _lie, _names, _options, _sparse
from ._errors import BackendError, RobotError, translated
from ._keywords import Keywords

NUMPY = (numpy.ndarray, numpy.empty, _arrays.DTYPES["f32"], _arrays.DTYPES["f64"], _arrays.copy_of)
OWN = ("convention", "sparse")
PRODUCTS = ("jvp", "vjp")  # of derivatives of outputs
KEYS = itertools.count()
# by key, which torch.compile takes for a constant
ALIVE: weakref.WeakValueDictionary[str, "Robot"] = weakref.WeakValueDictionary()
KEYWORDS = (*_options.scene_keywords(), *_options.MODEL, *_options.COUNTED, *_options.OPEN, *OWN)


class Lock:
    """Of one thread, which may take it again. A forked child finds it open: the thread that had it would never open it there."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        LOCKS.add(self)

    def __enter__(self) -> None:
        self._lock.acquire()

    def __exit__(self, *_: object) -> None:
        self._lock.release()


LOCKS: weakref.WeakSet[Lock] = weakref.WeakSet()


def open_locks() -> None:
    for lock in LOCKS:
        lock._lock = threading.RLock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=open_locks)


class Limits(NamedTuple):
    """Of the URDF, by row; infinite where it has none. A quaternion has none."""
    lower: numpy.ndarray  # (nq,), rad or m
    upper: numpy.ndarray  # (nq,), rad or m
    velocity: numpy.ndarray  # (nv,), rad/s or m/s
    effort: numpy.ndarray  # (nv,), N m or N


@functools.lru_cache(maxsize=None)
def tuple_of(kind: str, fields: tuple[str, ...]):
    """A named tuple that can be pickled, though no module has its name."""
    made = namedtuple(kind, fields)  # type: ignore[misc]
    setattr(made, "__reduce__", lambda self: (make_tuple, (kind, fields, tuple(self))))
    return made


def make_tuple(kind: str, fields: tuple[str, ...], values: tuple):
    return tuple_of(kind, fields)(*values)


def load_nvrtc() -> bool:
    """NVIDIA's wheel lies in this Python's own folders, where librnea may not look: once it is loaded, librnea finds
    it by its name. Was there one?"""
    import ctypes
    from pathlib import Path
    for folder in map(Path, sys.path):
        for library in sorted(folder.glob("nvidia/*/lib/libnvrtc.so.1[0-9]"), reverse=True):
            try:
                ctypes.CDLL(str(library))
                return True
            except OSError:
                pass
    return False


def identity(robot: "Robot") -> str:
    """The same for robots that compute the same: of the name, the URDF and the keywords. A name for another library's
    operator."""
    options = {k: v for k, v in robot._generator.items() if k != "file"}
    own = {k: robot._options.get(k) for k in ("backend", "device", "threads", "block", "cache")}
    digest = hashlib.sha256(robot._urdf + repr((sorted(options.items()), sorted(own.items()))).encode()).hexdigest()
    words = "_".join([robot.name, *(a.name for a in robot.outputs)])
    return re.sub(r"\W|^(?=\d)", "_", words, flags=re.ASCII)[:60] + "_" + digest[:12]


def operator_name(robot: "Robot") -> str:
    """A derivative is named after what it is of, and after how it is made of that (_gradient.py)."""
    parent, derivation = robot.__dict__.get("_derivation", (None, ""))
    return f"{operator_name(parent)}__{derivation}" if parent else identity(robot)


def operator_of(robot: "Robot", library: str, operators: dict[str, Any], lock: Any, make: Callable[[str], Any]):
    """What another library calls this robot by, made of its name when it is first needed, and kept as the robot's member
    `library`. Robots that compute the same share it; `operators`, by name, lives as long as the program."""
    found = robot.__dict__.get(library)
    if found is None:
        _arrays.refuse(robot._is_sparse)
        name = operator_name(robot)
        with lock:
            found = operators.get(name) or operators.setdefault(name, make(name))
        setattr(robot, library, found)
    return found


class Signature:
    """What inspect, help and editors show of a call: each robot's own; the class has that of __init__."""

    def __get__(self, robot: "Robot | None", owner: type) -> inspect.Signature:
        if robot is None:
            raise AttributeError("__signature__")
        return _names.signature_of(robot)


class Robot(_core.Robot):
    """Inverse dynamics tau = ID(q, qd, qdd) of one robot in its scene, or what else the scene wants. Made by rneagen.load.

        tau = robot(q, qd, qdd)

    q is (nq,) or (..., nq); qd, qdd and tau are (nv,) or (..., nv): rad, rad/s, rad/s^2, N m; m, m/s, m/s^2, N for
    joints that slide. A floating base comes first: position and quaternion x y z qx qy qz qw in q, a twist of the
    base's frame, linear then angular, in qd. All arrays have the same leading axes, but inputs
    that are one for all samples, and one dtype, float32 or float64. What lies in several pieces is copied. The outputs are
    of the caller's library: NumPy, PyTorch, CuPy, JAX, or another with DLPack. A GPU's arrays are computed where they are, in the
    current stream. `inputs` and `outputs` tell of each array its name, shape and role, and the default of one that may be left
    out.

    `out` is an array for the output; for several outputs a tuple of arrays. Inputs also go by their names: robot(q=q,
    qd=qd, qdd=qdd). What the scene frees (free=, fext=) is an input too; left out, it is as the URDF has it.

    The first call of a dtype compiles, or takes from the cache what was compiled before. Any number of threads may
    call one robot.
    """
    __signature__ = Signature()

    def __init__(self, urdf: bytes, file: str, options: dict[str, Any]):
        self._make(urdf, file, options, None)

    def _make(self, urdf: bytes, file: str, options: dict[str, Any], model: Any) -> None:
        """`model`: of the same text, where there is one."""
        self._urdf, self._file, self._options = urdf, file, dict(options)
        self._generator = self._generator_options(dense=not self.sparse)
        try:
            self._model = model or translated(_core.Model, urdf, self._generator)
        except RobotError as error:
            raise _options.explained(error, self._generator.get("scene", "")) from None
        self._facts, self._joints = self._model.facts(), self._model.joints()
        self._bounds = self._limits()
        arrays = [_arrays.describe(a, self._facts["nv"], self.sparse) for a in self._model.arrays()]
        if not any(a.is_matrix or a.role in PRODUCTS for a in arrays):
            self._generator = self._generator_options(dense=False)  # of the same text, whose head says no more than it needs
        self.inputs = tuple(a for a in arrays if not a.is_output)
        self.outputs = tuple(a for a in arrays if a.is_output)
        self._conversion = None
        if self.convention == "mujoco" and any(joint["nq"] != joint["nv"] for joint in self._joints):
            native = Robot.__new__(Robot)
            native._make(urdf, file, {**options, "convention": "pinocchio"}, self._model)
            self._conversion = _convention.MuJoCo(native)
        self._is_sparse = self.sparse and any(a.is_matrix for a in self.outputs)
        self._outputs = tuple_of("Outputs", tuple(_arrays.identifiers(self.outputs))) if len(self.outputs) > 1 else None
        self._kernels: dict[tuple, Any] = {}
        self._lacking = ""  # why the evaluator computes, where nobody asked for it
        self._wanted: dict[tuple, Robot] = {}
        self._lock = Lock()
        self._define(tuple((a.name, a.rows, a.shape, a.per_batch) for a in arrays), len(self.inputs),
                     _arrays.places(len(self.inputs)), self._outputs, NUMPY, not (self._conversion or self._is_sparse))
        self._key = str(next(KEYS))
        ALIVE[self._key] = self
        if "torch" in sys.modules:  # torch.compile sees no call in C, so a robot becomes one in Python
            importlib.import_module("rneagen.torch")

    def _generator_options(self, dense: bool) -> dict[str, Any]:
        """`dense`: matrices are whole, also those of whose derivatives there are products."""
        options = self._options
        if self.convention not in ("pinocchio", "mujoco"):
            raise ValueError(f"convention takes pinocchio or mujoco, not {self.convention!r}")
        if options.get("dense") is False and not self.sparse:
            raise ValueError("dense=False: matrices are whole; sparse=True has what a text stores of them")
        if dense:
            scene = options.get("scene")
            options = {**options, "dense": True, "scene": scene and scene.without(["dense"])}
        return {"layout": "aos", **_options.generator(options, self._file)}

    # ---- what it is ----

    @property
    def name(self) -> str:
        """Of the robot, as the URDF has it."""
        return self._facts["name"]

    @property
    def nq(self) -> int:
        """Rows of q."""
        return self._facts["nq"]

    @property
    def nv(self) -> int:
        """Rows of qd, qdd and tau."""
        return self._facts["nv"]

    @property
    def joint_names(self) -> list[str]:
        """Joints with entries in q, in their order. A floating base made by base="floating" has the name ""."""
        return [joint["name"] for joint in self._joints]

    @property
    def joints(self) -> list[dict[str, Any]]:
        """The same with the link that each moves, type, rows (iq, nq, iv, nv) and limits."""
        return [dict(joint) for joint in self._joints]

    @property
    def warnings(self) -> list[str]:
        """What of the URDF may not be meant."""
        return list(self._facts["warnings"])

    def _limits(self) -> Limits:
        rows = Limits(numpy.full(self.nq, -numpy.inf), numpy.full(self.nq, numpy.inf), numpy.full(self.nv, numpy.inf),
                      numpy.full(self.nv, numpy.inf))
        for joint in self._joints:
            q, v = slice(joint["iq"], joint["iq"] + joint["nq"]), slice(joint["iv"], joint["iv"] + joint["nv"])
            rows.lower[q], rows.upper[q] = joint["lower"], joint["upper"]
            rows.velocity[v], rows.effort[v] = joint["velocity"], joint["effort"]
        for x in rows:
            x.flags.writeable = False
        return rows

    @property
    def limits(self) -> Limits:
        """Position, velocity and effort, as the URDF states them, read-only. No text models them."""
        return self._bounds

    @functools.cached_property
    def _info(self) -> str:
        return translated(_core.generate, self._urdf, {**self._generator, "tell": 2})["info_json"]

    @property
    def info(self) -> dict[str, Any]:
        """What `rneagen ROBOT.urdf --info=json` tells; the caller's own."""
        return json.loads(self._info)

    @functools.cached_property
    def inertial_parameters(self) -> numpy.ndarray:
        """pi of tau = Y pi, as the URDF has it, with Y = robot.want("regressor")(q, qd, qdd): (10 bodies,), of each
        body and what is fixed to it m hx hy hz Ixx Ixy Ixz Iyy Iyz Izz about its link's origin.
        info["inertial_parameters"] of that robot names the links. Read-only."""
        bodies = self.want("regressor").info["inertial_parameters"]["bodies"]
        values = numpy.array([body["values"] for body in bodies]).ravel()
        values.flags.writeable = False
        return values

    def describe(self) -> str:
        """What `rneagen ROBOT.urdf --info` tells: joints, what the scene leaves, operations, what the URDF has that
        is not modelled."""
        return translated(_core.generate, self._urdf, {**self._generator, "tell": 1})["info"]

    @property
    def sparse(self) -> bool:
        return bool(self._options.get("sparse"))

    @property
    def convention(self) -> str:
        return self._options.get("convention") or "pinocchio"

    @property
    def scalar(self) -> str | None:
        """Numbers in memory, "f32" or "f64"; None: as the arrays of a call."""
        return _arrays.SCALARS.get(self._options.get("precision") or "")

    @property
    def backend(self) -> str:
        """What computes arrays of NumPy: "cpu", compiled; "cuda"; or "evaluator", where there is no C compiler and no
        GPU was asked for: the same results but for rounding, ten to a hundred times as slowly. It compiles if nothing
        was called yet."""
        return self.build["backend"]

    @property
    def build(self) -> dict[str, Any]:
        """How the text that computes arrays of NumPy came to be: backend, device, compiler, target, note (why this
        backend), cached, seconds, threads, unkept (why the cache did not keep it)."""
        own = self._options.get("backend") or "any"
        opened = [kernel for (_, backend, _), kernel in self._kernels.items() if backend == own]
        told = (opened[0] if opened else self.kernel(self._options.get("precision") or "f64")).build()
        return {**told, "note": self._lacking} if told["backend"] == "evaluator" else told

    def __repr__(self) -> str:
        given = ", ".join(f"{k}={v!r}" for k, v in self._options.items() if v is not None)
        takes, makes = (", ".join(a.name for a in arrays) for arrays in (self.inputs, self.outputs))
        return f"<rneagen.Robot {self.name!r}: ({takes}) -> {makes}; nq={self.nq}, nv={self.nv}{'; ' if given else ''}{given}>"

    def __reduce__(self):
        return Robot, (self._urdf, self._file, self._options)

    # ---- calls ----

    def _call(self, args: tuple, kwargs: dict[str, Any]):
        """What is not a plain call on arrays of NumPy."""
        arrays, out = _arrays.arguments(self, args, kwargs)
        return _arrays.adapter(self, arrays, out).call(self, arrays, out)

    @_names.takes(several=True)
    def bind(self, *args: Any, **kwargs: Any) -> Any:
        """step = robot.bind(q, qd, qdd, out) checks the arrays once; step() then computes from what is in them, and
        returns out. The arrays stay alive with the step, and are not checked again: one that is made read-only later is
        written all the same. Without out, an array is made. A GPU's arrays are bound to the stream that is current now."""
        arrays, out = _arrays.arguments(self, args, kwargs)
        return _arrays.adapter(self, arrays, out).bind(self, arrays, out)

    def _check(self, arrays: tuple) -> None:
        """Raise what a call on these arrays would."""
        self._bind(arrays, None)

    def _join(self, outputs):
        """One output, or the named tuple of several."""
        return outputs[0] if self._outputs is None else self._outputs(*outputs)

    def _wrap(self, result):
        """Matrices of which only a part is stored."""
        if not self._is_sparse:
            return result
        values = [result] if self._outputs is None else list(result)
        return self._join([self._sparse_of(a, x) if a.is_matrix else x for a, x in zip(self.outputs, values)])

    def _sparse_of(self, array: _arrays.Array, values: numpy.ndarray) -> _sparse.Sparse:
        row, col = (numpy.array(x, dtype=numpy.int32) for x in array.pattern or ((), ()))
        return _sparse.Sparse(values, row, col, array.size, array.is_lower)

    # ---- texts ----

    def precision_for(self, scalar: str) -> str:
        """The precision of a text for arrays of "f32" or "f64"; TypeError if this robot's is of the other."""
        precision = self._options.get("precision") or scalar
        if _arrays.SCALARS[precision] != scalar:
            raise TypeError(f"{self.inputs[0].name if self.inputs else 'out'}: its dtype is {_arrays.DTYPES[scalar]}, "
                            f"and precision {precision!r} takes {_arrays.DTYPES[_arrays.SCALARS[precision]]}")
        return precision

    def _open(self, scalar: str):
        return self.kernel(self.precision_for(scalar))

    def kernel(self, precision: str, backend: str | None = None, device: int | None = None):
        """The text of this precision, compiled and loaded: a _core.Kernel, whose launch(addresses, count, stream)
        takes an address for each of `inputs` and `outputs`. `backend`: "cpu" or "cuda" (`device` says which); None:
        what arrays of NumPy are computed by."""
        backend = backend or self._options.get("backend") or "any"
        device = (self._options.get("device") or 0) if device is None else device
        with self._lock:
            key = precision, backend, device if backend == "cuda" else None
            if key not in self._kernels:
                self._kernels[key] = self._compile(precision, backend, device)
            return self._kernels[key]

    def _compile(self, precision: str, backend: str, device: int):
        generator = {**self._generator, "precision": precision}
        options = {k: v for k, v in self._options.items() if k in ("threads", "block", "cache") and v is not None}
        if backend == "evaluator":
            return translated(_core.evaluate, self._urdf, generator, options)
        if backend != "cuda":
            # arrays are turned: compilers make vectors of soa; the segments of target c are those that they are quick with
            generator.update(target="c", parts=1, layout="soa")
        text = translated(_core.generate, self._urdf, generator)["source"]
        options.update(backend="cpu" if backend == "any" else backend, device=device)
        try:
            return translated(_core.open, text, options)
        except BackendError as error:
            if backend == "cuda" and error.code == "NO_COMPILER" and load_nvrtc():
                return translated(_core.open, text, options)
            if backend != "any" or error.code not in ("NO_COMPILER", "COMPILER"):
                raise
            self._lacking = str(error)
            warnings.warn(f"{self.name}: computed by the evaluator, slowly: {error}", RuntimeWarning, stacklevel=4)
            threads = {k: v for k, v in options.items() if k == "threads"}
            return translated(_core.evaluate, self._urdf, {**generator, "layout": "aos"}, threads)

    # ---- other outputs ----

    def want(self, *names: str | Iterable[str], sparse: bool | None = None, **products: Any) -> "Robot":
        """The robot with other outputs, by the words of --want: "tau", "M", "bias", "gravity", "dtau_dq", "qdd",
        "Minv", "wrench.JOINT", ... Several outputs come as a named tuple. Matrices are (..., nv, nv), Jacobians (...,
        6, nv), with sparse=True of type rneagen.Sparse; poses are [R p], (..., 3, 4). The same names again give the
        same robot, so that robot.want("M", "bias")(q, qd) may be called in a loop. Where nothing is found of qdd, no link
        stands: contact= and weld= are of accelerations.

            robot.want("tau", vjp=["tau", "pose.hand"])(q, qd, qdd, vjp_v)

        jvp= and vjp= name outputs whose derivatives are multiplied by a vector, without their matrices: vjp (..., 3
        nv), by q, qd and qdd, takes vjp_v, as long as the outputs one after another; jvp, as long as these, takes
        jvp_v (..., 3 nv). by=["payload.hand"] adds what free= and fext= name: outputs vjp_NAME, inputs jvp_v_NAME."""
        _options.check(products, (*PRODUCTS, "by"), "want")
        given = tuple((k, tuple(_options.names(k, x))) for k, x in products.items() if x)
        if len(names) == 1 and not isinstance(names[0], str):  # a list of them, as load takes
            names = tuple(_options.names("want", names[0]))
        if not names and not given:
            _options.refuse_nothing({"want": []})
        is_sparse = self.sparse if sparse is None else _options.flag("sparse", sparse)
        return self._wanting(names, is_sparse, products=given)

    def _wanting(self, names: tuple[str, ...], sparse: bool, fold: tuple[str, ...] = (), products: tuple = ()) -> "Robot":
        key = names, sparse, fold, products
        try:
            found = self._wanted.get(key)
        except TypeError:  # no key, a list for one
            _options.names("want", names)
            raise
        if found:
            return found
        with self._lock:
            options = {**dict.fromkeys(_options.ASKED), "want": list(names), "sparse": sparse or None,
                       "fold": self._folds(fold), **{k: list(x) for k, x in products}}
            if not any(_options.finds_qdd(word) for word in (*names, *(word for _, x in products for word in x))):
                options.update(self._standing_apart())
            return self._wanted.setdefault(key, self._with(**options))

    def _folds(self, more: tuple[str, ...] = (), without: str = "") -> list[str] | None:
        """What is known of inputs, and more, but of one input nothing."""
        own = [pair for pair in _options.pairs("fold", self._options.get("fold") or [])
               if not pair.startswith((f"{without}=", f"{without}."))]
        known = {pair.partition("=")[0] for pair in own}
        return [*own, *(pair for pair in more if pair.partition("=")[0] not in known)] or None

    def _standing_apart(self) -> dict[str, Any]:
        """Without links that stand: these are of accelerations alone."""
        free = _options.names("free", self._options.get("free") or [])
        moved = [name for name in free if not name.startswith("accel.")]
        return {**dict.fromkeys(_options.STANDING), **({"free": moved or None} if moved != free else {})}

    def _unfolded(self, name: str) -> "Robot":
        """Without what is known of an input."""
        if not self._options.get("fold") or self._folds() == (folds := self._folds(without=name)):
            return self
        with self._lock:
            return self._wanted.setdefault(("", name), self._with(fold=folds))

    def _with(self, **options: Any) -> "Robot":
        """With other keywords: in place of the same lines of a scene's file."""
        scene = self._options.get("scene")
        if scene:
            options["scene"] = scene.without(word for word in (*_options.ASKED, *_options.STANDING, "free") if word in options)
        return Robot(self._urdf, self._file, {**self._options, **options})

    def random(self, n: int | None = None, seed: int = 1, dtype=None):
        """A named tuple of all inputs, drawn within the joints' limits or the scene's `range`: arrays of `n` samples,
        or of one without a leading axis. The same seed gives the same samples, those of `rnearun report`."""
        count = _arrays.whole("n", 1 if n is None else n, 2 ** 63)
        drawn = translated(self._model.draw, _arrays.whole("seed", seed, 2 ** 64), count)
        dtype = numpy.dtype(dtype or _arrays.DTYPES[self.scalar or "f64"])
        if dtype.kind != "f":
            raise TypeError(f"dtype: float32 or float64 is wanted, not {dtype}")
        values = []
        for array in self.inputs:
            x = numpy.frombuffer(drawn[array.name], float).astype(dtype)
            values.append(x.reshape(array.shape if array.per_batch or n is None else (count, *array.shape)))
            if array.role == "joint_position" and self._conversion:
                values[-1][..., 3:7] = values[-1][..., [6, 3, 4, 5]]
        return tuple_of("Inputs", tuple(a.name if not keyword.iskeyword(a.name) else a.name + "_" for a in self.inputs))(*values)

    # ---- positions ----

    def integrate(self, q: Any, v: Any) -> Any:
        """Where q (..., nq) is after a velocity v (..., nv), qd dt for one: q + v, but a floating base moves by a twist of its
        own frame. Of NumPy, PyTorch, JAX or CuPy; also with gradients."""
        return _lie.integrate(self, q, v)

    def difference(self, q0: Any, q1: Any) -> Any:
        """The velocity (..., nv) by which integrate makes q1 of q0; a floating base turns by pi at most."""
        return _lie.difference(self, q0, q1)

    def neutral(self, dtype: Any = float) -> numpy.ndarray:
        """q (nq,) of zeros, quaternions of no rotation."""
        return _lie.neutral(self, dtype)

    # ---- by Pinocchio's names ----
    # Each takes what Pinocchio's function takes, also where an output does not read all of it.

    @_names.takes("q", "qd", "qdd")
    def rnea(self, *args: Any, **kwargs: Any) -> Any:
        """tau = rnea(q, qd, qdd): (..., nv), N m."""
        return _names.call(self._unfolded("tau").want("tau"), ("q", "qd", "qdd"), args, kwargs)

    @_names.takes("q", "qd", "tau")
    def aba(self, *args: Any, **kwargs: Any) -> Any:
        """qdd = aba(q, qd, tau): (..., nv), rad/s^2."""
        return _names.call(self._unfolded("qdd").want("qdd"), ("q", "qd", "tau"), args, kwargs)

    @_names.takes("q")
    def crba(self, *args: Any, **kwargs: Any) -> Any:
        """M = crba(q): the mass matrix (..., nv, nv), kg m^2, whole."""
        return _names.call(self._unfolded("tau").want("M"), ("q",), args, kwargs)

    @_names.takes("q")
    def computeMinverse(self, *args: Any, **kwargs: Any) -> Any:
        """Minv = computeMinverse(q): the inverse of the mass matrix (..., nv, nv), whole."""
        robot = self._unfolded("qdd")._unfolded("tau")._wanting(("Minv",), self.sparse, ("qd=0", "tau=0"))
        return _names.call(robot, ("q",), args, kwargs)

    @_names.takes("q", "qd")
    def nonLinearEffects(self, *args: Any, **kwargs: Any) -> Any:
        """tau = nonLinearEffects(q, qd): of gravity and velocities, (..., nv)."""
        if self._conversion:  # M of the base's Coriolis term is in it: MuJoCo's qdd = 0 is another than ours
            return _convention.nonlinear_effects(self.want("tau"), args, kwargs)
        return _names.call(self._unfolded("tau").want("bias"), ("q", "qd"), args, kwargs)

    @_names.takes("q")
    def computeGeneralizedGravity(self, *args: Any, **kwargs: Any) -> Any:
        """tau = computeGeneralizedGravity(q): of gravity alone, (..., nv)."""
        return _names.call(self._unfolded("tau").want("gravity"), ("q",), args, kwargs)

    @_names.takes("q", "qd", "qdd")
    def computeRNEADerivatives(self, *args: Any, **kwargs: Any) -> Any:
        """(dtau_dq, dtau_dqd, M) of (q, qd, qdd): (..., nv, nv) each. A floating base varies by a twist in its frame."""
        return _names.call(self._unfolded("tau").want("dtau_dq", "dtau_dqd", "M"), ("q", "qd", "qdd"), args, kwargs)

    @_names.takes("q", "qd", "tau")
    def computeABADerivatives(self, *args: Any, **kwargs: Any) -> Any:
        """(dqdd_dq, dqdd_dqd, Minv) of (q, qd, tau): (..., nv, nv) each."""
        return _names.call(self._unfolded("qdd").want("dqdd_dq", "dqdd_dqd", "Minv"), ("q", "qd", "tau"), args, kwargs)


def load(urdf: str | os.PathLike | bytes, **keywords: Unpack[Keywords]) -> Robot:
    """Load a robot from the URDF at a path, or from its text: a string that begins with "<", or bytes with "<".

        robot = rneagen.load("iiwa14.urdf")
        tau = robot(q, qd, qdd)

    Keywords are the options of the command line, with underscores:

    want="tau", ["M", "bias"]     what is computed
    lock={"elbow": 1.57}          joints that are held; planar and floating joints take 3 and 7 numbers
    root="LINK", tip=["LINK"]     part of the robot; beside="drop", lock_all_but=[...]
    base="floating"               fixed unless given
    fold={"qdd": 0}               inputs that are known
    add_frame={"tool": ("hand", 0, 0, 0.1, 0, 0, 0)}  a frame on a link: x y z, m, roll pitch yaw, rad; then want="pose.tool"
    pose="quaternion", frame="world-aligned"          how pose.LINK is written, and in which frame jacobian.LINK is
    free=["payload.hand"]         constants that become inputs; fext=["foot"] external wrenches
    contact=["foot"]              origins of links that stand; weld=["foot"] whole links; then want=["qdd", "contact.foot"]; with
                                  free=["accel.foot"] they accelerate as that input says
    gravity=(0, 0, -9.81)         m/s^2, in the world
    precision="f32"               f32, f64, mixed, f32x2; unless given as the arrays are: float32 or float64
    trig="accurate", strict=False, mimic="honour", order=[...], params="auto", damping=True, friction=0.01
    jvp=["tau"], vjp=["tau"], by=["payload.hand"]     derivatives times a vector
    armature={"elbow": 0.1}       rotor inertias, kg m^2, or a file of lines JOINT KG_M2; fext_frame="world"
    derivatives=, dynamics=, refine=, drop_below=, round_constants=, snap_angle=, range=, parts=, segments=, limbs=
    scene="FILE"                  all of these as lines of a file, which is read once

    And of the call:

    backend="cpu"                 "cpu", "cuda" or "evaluator" for arrays of NumPy; unless given the processor
    device=0, threads=0, block=0, cache=None
    sparse=False                  matrices as rneagen.Sparse instead of (..., nv, nv); dense= is for these alone
    convention="pinocchio"        "mujoco": position, velocity and torque of a floating base as MuJoCo has them

    Raises RobotError with the generator's message if the URDF or the scene is at fault; TypeError for a keyword that
    is not known.
    """
    _options.check(keywords, KEYWORDS, "load")
    options = _options.taken(dict(keywords))
    return Robot(*_options.read(urdf), options)
