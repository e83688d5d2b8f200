"""What CasADi differentiates, of one robot: the numbers of its inputs, which numbers each output and each derivative depends
on, and the robots whose texts compute these.

Numbers are those of all inputs, one after another, as CasADi has them. Texts differentiate by tangents: 3 nv of the state (q,
qd and qdd or tau), then what is free. They are the same but for a floating joint, whose seven numbers, a position and a
quaternion, move by a twist of six. Its quaternion is divided by its length before a text sees it, so that outputs are functions
of all seven numbers with exact derivatives everywhere, and have none along the quaternion.

What depends on what is found by the evaluator, which compiles nothing: texts are linear in a direction, so with a NaN for one of
its numbers the rows that depend on it, and no others, are NaN.
"""
from __future__ import annotations

import functools
import re
from typing import Any, Iterable, NamedTuple, Sequence

import numpy

from ._arrays import Array
from ._errors import RobotError
from ._gradient import FREED, PARTS, REFUSED

DIRECT = {"tau": ("dtau_dq", "dtau_dqd", "M"), "qdd": ("dqdd_dq", "dqdd_dqd", "Minv")}  # matrices by the part of the state


class Number(NamedTuple):
    """Of an input."""
    input: int
    row: int
    tangents: frozenset[int]


class Plan(NamedTuple):
    """Directions in which a text is computed at once: groups of numbers that no row which is read confuses."""
    group: list[int]  # of each number; -1: none
    count: int
    read: dict[tuple[int, int], int]  # (row, number): group


def stored(array: Array) -> list[list[tuple[int, int]]]:
    """Where each stored number of an output stands in its matrix; a vector is a column."""
    if array.pattern:
        row, col = array.pattern
        return [[(r, c)] if r == c or not array.is_lower else [(r, c), (c, r)] for r, c in zip(row, col)]
    columns = array.shape[1] if len(array.shape) > 1 else 1
    return [[divmod(k, columns)] for k in range(array.rows)]


def rows_at(array: Array) -> dict[tuple[int, int], int]:
    """By place in the matrix, the number that is stored for it."""
    return {where: k for k, each in enumerate(stored(array)) for where in each}


def shape(array: Array) -> tuple[int, int]:
    """Of the matrix."""
    if array.pattern:
        return array.size
    return (array.shape[0], array.shape[1]) if len(array.shape) > 1 else (array.rows, 1)


def evaluate(robot, given: dict[str, numpy.ndarray], count: int) -> dict[str, numpy.ndarray]:
    """Outputs by word, of `count` samples of a random state, but for the inputs `given` by word."""
    drawn = robot.random(1)
    inputs = [numpy.ascontiguousarray(numpy.broadcast_to(given.get(a.word, x), (count, a.rows)))
              for a, x in zip(robot.inputs, drawn)]
    outputs = [numpy.zeros((count, a.rows)) for a in robot.outputs]
    robot.kernel("f64", "evaluator").launch(tuple(x.ctypes.data for x in (*inputs, *outputs)), count)
    return {a.word: x for a, x in zip(robot.outputs, outputs)}


def grouped(columns: dict[int, set[int]], needed: dict[int, set[int]], numbers: int) -> Plan:
    """Greedy: numbers share a group if no row that one of them needs depends on another."""
    groups: list[list[int]] = []
    for k in sorted(needed, key=lambda k: -len(columns[k])):
        for group in groups:
            if not any(needed[k] & columns[other] or needed[other] & columns[k] for other in group):
                group.append(k)
                break
        else:
            groups.append([k])
    group_of = {k: g for g, group in enumerate(groups) for k in group}
    read = {(i, k): group_of[k] for k in needed for i in needed[k]}
    return Plan([group_of.get(k, -1) for k in range(numbers)], len(groups), read)


class Model:
    """Of a robot, and its derivatives up to this order."""

    def __init__(self, robot, derivatives: int):
        if robot.scalar == "f32":
            raise ValueError(f"CasADi's numbers are doubles, and precision {robot._options['precision']!r} takes floats: "
                             "load the robot with precision='f64'")
        if robot._conversion:
            raise ValueError("CasADi takes convention 'pinocchio' alone")
        words = [a.word for a in robot.inputs if a.role in FREED]
        self.free = {"free": [f"{word}:sample" for word in words]} if words else {}
        self.robot = robot._with(sparse=True, **self.free)
        self.nv, self.inputs, self.outputs = robot.nv, self.robot.inputs, self.robot.outputs
        self.is_forward = self.robot._facts["forward"]
        self.by = [a for a in self.inputs if a.role not in PARTS]
        self.floating = [j for j in robot.joints if j["nq"] != j["nv"]] if any(map(self.is_position, self.inputs)) else []
        self.numbers = [Number(i, row, self.tangents(a, row)) for i, a in enumerate(self.inputs) for row in range(a.rows)]
        self.rows = [(o, k) for o, a in enumerate(self.outputs) for k in range(a.rows)]  # stored numbers of all outputs
        if derivatives:
            self.check()

    @staticmethod
    def is_position(array: Array) -> bool:
        return array.role == "joint_position"

    def check(self) -> None:
        for a in self.outputs:
            if a.role in REFUSED or a.role == "vjp":
                raise ValueError(f"{a.word} has no derivative here: derivatives=0 computes it alone")

    # ---- tangents ----

    @functools.cached_property
    def tangent_at(self) -> dict[str, int]:
        """Where the tangents of what is free begin, by word."""
        at, found = 3 * self.nv, {}
        for a in self.by:
            found[a.word] = at
            at += a.rows
        return found

    @property
    def tangent_count(self) -> int:
        return 3 * self.nv + sum(a.rows for a in self.by)

    def tangents(self, array: Array, row: int) -> frozenset[int]:
        if array.role not in PARTS:
            return frozenset([self.tangent_at[array.word] + row])
        if array.role == "joint_torque" and row in self.robot._facts["given"]["tau"]:
            return frozenset()  # which a text has derivatives by, though it does not read it
        if not self.is_position(array):
            return frozenset([PARTS[array.role] * self.nv + row])
        joint = next(j for j in self.robot.joints if j["iq"] <= row < j["iq"] + j["nq"])
        k = row - joint["iq"]
        if joint["nq"] == joint["nv"]:
            return frozenset([joint["iv"] + k])
        return frozenset(range(joint["iv"] + (0 if k < 3 else 3), joint["iv"] + (3 if k < 3 else 6)))

    # ---- robots ----

    def make(self, **options: Any):
        """The same scene with other outputs."""
        return self.robot._with(**{"want": None, "jvp": None, "vjp": None, "by": None, "sparse": True, **options})

    def product(self, product: str, words: Iterable[str], **more: Any):
        """The robot of "jvp" or "vjp", and the words of what it is of: the scene has made the others constant. None: all."""
        left = list(words)
        left += ["qdd"] if self.is_forward and "qdd" not in left else []  # else tau would be no input
        while left:
            try:
                return self.make(**{product: left, "by": [a.word for a in self.by] or None, **more}), left
            except RobotError as error:
                constant = re.search("'(.*)' does not vary", str(error))
                if not constant:
                    raise
                if constant[1] not in left:  # vjp
                    break
                left.remove(constant[1])
        return None, []

    @functools.cached_property
    def words(self) -> list[str]:
        return [a.word for a in self.outputs]

    @functools.cached_property
    def reverse(self):
        return self.product("vjp", self.words)

    @functools.cached_property
    def second(self):
        return self.product("vjp", self.words, jvp=["vjp"])[0]

    def row_at(self, words: Sequence[str]) -> dict[str, int]:
        """Where the rows of each begin, in jvp or vjp_v of these."""
        rows = {"qdd": self.nv, **{a.word: a.rows for a in self.outputs}}
        at, found = 0, {}
        for word in words:
            found[word] = at
            at += rows[word]
        return found

    # ---- what depends on what ----

    def spoilt(self, robot) -> numpy.ndarray:
        """(tangents, rows of jvp): does the row depend on the tangent?"""
        count, nan = self.tangent_count, numpy.full(self.tangent_count, numpy.nan)
        seeds = numpy.where(numpy.eye(count, dtype=bool), nan, 0.0)
        given = {"jvp_v": seeds[:, :3 * self.nv]}
        for a in self.by:
            given[f"jvp_v.{a.word}"] = seeds[:, self.tangent_at[a.word]:self.tangent_at[a.word] + a.rows]
        return numpy.isnan(evaluate(robot, given, count)["jvp"])

    def by_numbers(self, found: numpy.ndarray) -> dict[int, set[int]]:
        """For each number the rows, from those for each tangent."""
        return {k: {int(i) for t in x.tangents for i in found[t].nonzero()[0]} for k, x in enumerate(self.numbers)}

    @functools.cached_property
    def found(self) -> numpy.ndarray:
        """(tangents, rows of all outputs, one after another): does the row depend on the tangent?"""
        robot, words = self.product("jvp", self.words)
        if robot is None:
            return numpy.zeros((self.tangent_count, len(self.rows)), bool)
        at, found = self.row_at(words), self.spoilt(robot)
        own = [at[self.outputs[o].word] + k if self.outputs[o].word in at else -1 for o, k in self.rows]
        return numpy.stack([found[:, i] if i >= 0 else numpy.zeros(len(found), bool) for i in own], 1)

    @functools.cached_property
    def first(self) -> dict[int, set[int]]:
        """For each number the rows of the outputs that depend on it."""
        return self.by_numbers(self.found)

    def refuse_free(self) -> None:
        """Texts differentiate a gradient by what is free along the state alone."""
        robot = self.reverse[0]
        for a in self.by if robot else ():
            found = evaluate(robot, {a.word: numpy.full((1, a.rows), numpy.nan)}, 1)
            for b in self.by:
                if not numpy.isfinite(found[f"vjp.{b.word}"]).all():
                    raise ValueError(f"second derivatives by {b.word} and {a.word} are not to be had: derivatives=1 leaves "
                                     "second ones out")

    @functools.cached_property
    def pairs(self) -> dict[int, set[int]]:
        """For each number the numbers with which it has a second derivative."""
        self.refuse_free()
        found = {k: set() for k in range(len(self.numbers))} if self.second is None else self.by_numbers(self.spoilt(self.second))
        pairs = {k: {i for i, x in enumerate(self.numbers) if x.tangents & found[k]} for k in found}
        for joint in self.floating:
            self.add_turns(pairs, joint)
        return {k: pairs[k] | {i for i in pairs if k in pairs[i]} for k in pairs}

    def add_turns(self, pairs: dict[int, set[int]], joint: dict[str, Any]) -> None:
        """What a gradient by a floating joint's twist makes, as its numbers turn."""
        begin = next(k for k, x in enumerate(self.numbers) if self.is_position(self.inputs[x.input])) + joint["iq"]
        place, turn = set(range(begin, begin + 3)), set(range(begin + 3, begin + 7))
        for k in turn:
            pairs[k] |= place if self.first[begin] else set()
            pairs[k] |= turn if self.first[begin + 3] else set()

    # ---- how it is computed ----

    @functools.cached_property
    def direct(self):
        """A robot whose outputs are matrices of derivatives, or None; and where values stand: (row, tangent): (word, place)."""
        wanted, values = {}, {}
        for word, matrices in DIRECT.items():
            for a in self.inputs if word in self.words else ():
                if a.role in PARTS:
                    wanted[matrices[PARTS[a.role]]] = word, PARTS[a.role]
        if not wanted:
            return None, {}
        robot = self.direct_robot(list(wanted))
        if robot is None:
            return None, {}
        row = {(self.outputs[o].word, k): i for i, (o, k) in enumerate(self.rows)}
        for matrix in robot.outputs:
            word, part = wanted[matrix.word]
            for place, at in enumerate(stored(matrix)):
                values.update({(row[word, r], part * self.nv + c): (matrix.word, place) for r, c in at})
        return robot, values

    def direct_robot(self, matrices: list[str]):
        """None where the scene gives a row of the state: there is no matrix of derivatives by that."""
        while matrices:
            try:
                return self.make(want=matrices)
            except RobotError as error:
                refused = re.search("'(.*)': row .* is given", str(error))
                if not refused:
                    raise
                matrices.remove(refused[1])
        return None

    def is_direct(self, row: int, number: int) -> bool:
        return all((row, t) in self.direct[1] for t in self.numbers[number].tangents if self.found[t, row])

    @functools.cached_property
    def along(self):
        """The robot of jvp for what is not direct, or None; and the words of what it is of."""
        words = {self.outputs[self.rows[i][0]].word for i, _ in self.first_plan.read}
        return self.product("jvp", [word for word in self.words if word in words])

    @functools.cached_property
    def first_plan(self) -> Plan:
        left = {k: {i for i in rows if not self.is_direct(i, k)} for k, rows in self.first.items()}
        outputs = {self.rows[i][0] for rows in left.values() for i in rows}
        columns = {k: {i for i in rows if self.rows[i][0] in outputs} for k, rows in self.first.items()}
        return grouped(columns, {k: rows for k, rows in left.items() if rows}, len(self.numbers))

    @functools.cached_property
    def second_plan(self) -> Plan:
        """Of two numbers one is enough, for the matrix is symmetric: the one with which most others are found is taken first."""
        state = {k for k, x in enumerate(self.numbers) if self.inputs[x.input].role in PARTS}  # rows that jvp has
        left = {k: rows & state for k, rows in self.pairs.items()}
        needed: dict[int, set[int]] = {}
        while any(left.values()):
            k = max(left, key=lambda k: len(left[k]))
            needed[k], left[k] = left[k], set()
            for i in needed[k]:
                left[i] = left[i] - {k}
        return grouped({k: rows & state for k, rows in self.pairs.items()}, needed, len(self.numbers))
