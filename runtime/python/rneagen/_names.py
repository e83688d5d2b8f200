"""Calls by Pinocchio's names: with all arrays that its function takes, though an output may not read each of them."""
from __future__ import annotations

import inspect
import keyword
from typing import Any, Callable, Iterable, NamedTuple, TypeVar

import numpy

from . import _arrays


def call(robot, names: tuple[str, ...], args: tuple, kwargs: dict[str, Any]):
    """The robot's outputs, of arrays that are `names` by their place. Those that it does not read are looked at, and left out."""
    read = {a.name for a in robot.inputs}
    if read.issuperset(names):
        return robot(*args, **kwargs)
    given = given_of(robot, names, args, kwargs)
    unread = {n: given.pop(n) for n in names if n not in read and n in given}
    looked_at = {**{n: given[n] for n in names if given.get(n) is not None}, **unread}
    lead = lead_of((n, x, robot.nq if n == "q" else robot.nv) for n, x in looked_at.items())
    result = robot(**given)
    if any(not a.per_batch for a in robot.inputs) or given.get("out") is not None or not unread:
        return result
    return _spread(robot, result, lead, next(iter(unread.items())))


def given_of(robot, names: tuple[str, ...], args: tuple, kwargs: dict[str, Any]) -> dict[str, Any]:
    """Arrays by name, of which `names` come first by their place."""
    places = (*names, *(a.name for a in robot.inputs if a.name not in names))
    if len(args) > len(places):
        raise TypeError(f"{len(args)} arrays: {_arrays.takes(places, has_out=False)}")
    given = dict(zip(places, args))
    for name, value in kwargs.items():
        if name in given:
            raise TypeError(f"{name} is given twice")
        given[name] = value
    return given


# ---- what inspect shows ----

PLACE, NAMED = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY
OUT = inspect.Parameter("out", NAMED, default=None)
Function = TypeVar("Function", bound=Callable)


def takes(*names: str, several: bool = False) -> Callable[[Function], Function]:
    """The signature of a method: arrays by their places, or `several`, then out= and inputs by their names."""
    arrays = [inspect.Parameter(name, PLACE) for name in ("self", *names)]
    more = [inspect.Parameter("arrays", inspect.Parameter.VAR_POSITIONAL)] if several else []
    named = inspect.Parameter("inputs", inspect.Parameter.VAR_KEYWORD)

    def signed(function: Function) -> Function:
        setattr(function, "__signature__", inspect.Signature([*arrays, *more, OUT, named]))
        return function
    return signed


def shown(arrays: Iterable[_arrays.Array]) -> str:
    """Shapes as a call takes them: "(..., 7)"."""
    return ", ".join(str((*([] if a.per_batch else [...]), *a.shape)).replace("Ellipsis", "...") for a in arrays)


def signature_of(robot) -> inspect.Signature:
    """Of a robot: inputs with their shapes, then out. One that may be left out has a default where all after it have one."""
    parameters, may = [], True
    for a in reversed(robot.inputs):
        may = may and a.default is not None
        name = a.name + "_" * keyword.iskeyword(a.name)
        parameters.insert(0, inspect.Parameter(name, PLACE, annotation=shown([a]), **{"default": None} if may else {}))
    kind = PLACE if _arrays.places(len(parameters)) > len(parameters) else NAMED
    return inspect.Signature([*parameters, OUT.replace(kind=kind)], return_annotation=shown(robot.outputs))


# ---- arrays that are looked at ----


class Taken(NamedTuple):
    """What _arrays.lead_of looks at of an input."""
    name: str
    shape: tuple[int, ...]
    per_batch: bool = False


def lead_of(given: Iterable[tuple[str, Any, int]]) -> tuple[int, ...]:
    """The axes of samples, which are the same of all: of (name, array, rows)."""
    given = list(given)
    for name, x, _ in given:
        _arrays.kind_of(name, x)
    return _arrays.lead_of((Taken(name, (rows,)), tuple(x.shape)) for name, x, rows in given)


def _spread(robot, result, lead: tuple[int, ...], unread: tuple[str, Any]):
    """Outputs that nothing varies, once for each sample, in arrays like the one that was given."""
    name, like = unread
    module = _arrays.module_of(_arrays.kind_of(name, like).partition(" ")[0])
    if robot._is_sparse:
        raise TypeError(f"{name} is not read: sparse matrices that are constant are those of robot.want(...)()")
    values = (result,) if robot._outputs is None else tuple(result)
    return robot._join([module.constant(numpy.asarray(x), (*lead, *a.shape), like) for a, x in zip(robot.outputs, values)])
