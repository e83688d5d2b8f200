"""Calls by Pinocchio's names: with all arrays that its function takes, though an output may not read each of them."""
from __future__ import annotations

from typing import Any, Iterable, NamedTuple

import numpy

from . import _arrays


def call(robot, names: tuple[str, ...], args: tuple, kwargs: dict[str, Any]):
    """The robot's outputs, of arrays that are `names` by their place. Those that it does not read are looked at, and left out."""
    read = {a.name for a in robot.inputs}
    if read.issuperset(names):
        return robot(*args, **kwargs)
    given = _given(robot, names, args, kwargs)
    unread = {n: given.pop(n) for n in names if n not in read and n in given}
    looked_at = {**{n: given[n] for n in names if given.get(n) is not None}, **unread}
    lead = lead_of((n, x, robot.nq if n == "q" else robot.nv) for n, x in looked_at.items())
    result = robot(**given)
    if any(not a.per_batch for a in robot.inputs) or given.get("out") is not None or not unread:
        return result
    return _spread(robot, result, lead, next(iter(unread.items())))


def _given(robot, names: tuple[str, ...], args: tuple, kwargs: dict[str, Any]) -> dict[str, Any]:
    places = (*names, *(a.name for a in robot.inputs if a.name not in names))
    if len(args) > len(places):
        raise TypeError(f"{len(args)} arrays: {_arrays.takes(places, has_out=False)}")
    given = dict(zip(places, args))
    for name, value in kwargs.items():
        if name in given:
            raise TypeError(f"{name} is given twice")
        given[name] = value
    return given


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
