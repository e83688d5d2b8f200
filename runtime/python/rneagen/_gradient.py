"""Derivatives of a robot's outputs, for the libraries that differentiate. They are made by another text of the same
scene, which is a robot too: so a derivative has a compiled text of its own, and what the library does with robots it
does with derivatives.

Backward, with w the gradients of the loss by the outputs, one after another, that text's output vjp is w' d
outputs/d(q, qd, qdd), or by tau in place of qdd where that is found. Forward, with d the tangents of (q, qd, qdd) or
(q, qd, tau), its output jvp is d outputs/d(...) d. For what is free and for wrenches, where derivatives by these are
needed, it has an output or an input each.

Second derivatives are derivatives of a text that has an output vjp, w' J with J = d outputs/d(q, qd, qdd). By the state along d
they are the output jvp of a third text, H d (--jvp vjp), by w they are products with J again:

    forward    vjp varies by H d + dw' J
    backward   with g the gradient by vjp, the loss varies by H' g with the state, by J g with w

Backward of forward: with w the gradients of the loss by jvp, J d, the loss varies by H' d with the state, by J' w with d.

H is symmetric but for rows of floating joints, whose twists do not commute: (H' g)_j = (H g)_j + vjp . [e_j, g], with Lie's
bracket [(a, b), (c, d)] = (b x c + a x d, b x d) of twists (linear, angular).
"""
from __future__ import annotations

import re
from typing import Any, Callable, Iterable, NamedTuple, Sequence

from . import _arrays
from ._errors import RobotError

PARTS = {"joint_position": 0, "joint_velocity": 1, "joint_acceleration": 2, "joint_torque": 2}  # of vjp and jvp_v
PRODUCTS, DIRECTIONS = ("vjp", "jvp"), ("cotangent", "tangent")  # roles of outputs, and of what they are along
FREED = ("gravity", "link_mass", "link_inertia", "link_payload", "joint_offset", "joint_armature", "joint_damping",
         "joint_friction", "armature", "damping", "friction")
HAD = ("There are no third derivatives; second ones are by q, qd, qdd and tau, where one of the two goes backward (grad, vjp, "
       "jacrev), as in hessian, and of such gradients by what is free, forward, as in jacfwd(grad(f)); take differences of those "
       "for others")
REFUSED = {"jvp": f"has no such derivative: it is one along a direction. {HAD}",  # by role
           "joint_acceleration_bound": "has no gradient: it is a bound"}


# Names of derivatives: vjp_OF_BY, jvp_OF_BY_APART, second_BY_APART, along, across, apart_WORDS. Each part is places of words
# among inputs, then outputs.
DERIVATION = re.compile(r"(vjp|jvp|second|apart|along|across)(_(none|\d+(x\d+)*))*")


class Library(NamedTuple):
    """What differs between the caller's libraries."""
    run: Callable[[Any, list], Sequence]  # the outputs of a robot, of arrays for all its inputs
    zeros: Callable[[Any, tuple[int, ...]], Any]  # (an array like it, shape)
    expand: Callable[[Any, tuple[int, ...]], Any]  # broadcast, and in one piece
    join: Callable[[list], Any]  # along the last axis
    cross: Callable[[Any, Any], Any]  # of vectors along the last axis


class Gradients:
    """Of one robot."""

    def __init__(self, robot, library: Library):
        self.robot, self.library = robot, library
        self.is_forward = robot._facts["forward"]
        self.floating = [joint for joint in robot.joints if joint["nq"] != joint["nv"]]
        self.given = robot._facts["given"]["tau"]  # by row
        self.made: dict[tuple, Any] = {}  # robots of derivatives, by what they are of and by

    # ---- the robots ----

    def make(self, product: str, of: Sequence, by: Iterable, apart: tuple[str, ...] = ()):
        """The robot of this product, "vjp" or "jvp", of these outputs and by these inputs, made once; and the words
        of what it is of. An output that the scene has made constant is left out: None where nothing is left. `apart`:
        see forward."""
        for a in of:
            if a.role in REFUSED:
                raise self.refused(a)
        key = product, tuple(a.word for a in of), tuple(a.word for a in by if a.role not in PARTS), *([apart] if apart else [])
        if key not in self.made:
            words = [*key[1], "qdd"] if self.is_forward and "qdd" not in key[1] else [*key[1]]  # else tau would be no input
            options = {"want": None, "jvp": None, "vjp": None, "by": list(key[2]) or None, "sparse": None, **self.freed(apart)}
            robot = None
            while words and robot is None:
                try:
                    robot = self.robot._with(**{**options, product: words})
                except RobotError as error:
                    constant = re.search("'(.*)' does not vary", str(error))
                    if not constant:
                        raise
                    words.remove(constant[1])
            self.made[key] = self.named(robot, key), words
        return self.made[key]

    def freed(self, apart: tuple[str, ...]) -> dict[str, Any]:
        """The keyword that makes these constants one for each sample."""
        free = [f"{a.word}:{'batch' if a.per_batch and a.word not in apart else 'sample'}"
                for a in self.robot.inputs if a.role in FREED]
        return {"free": free} if apart else {}

    def robot_apart(self, words: tuple[str, ...]):
        """The robot with these constants one for each sample."""
        key = "apart", words
        if key not in self.made:
            self.made[key] = self.named(self.robot._with(**self.freed(words)), key)
        return self.made[key]

    # ---- their names ----
    # A program that a library has kept from another run calls operators of derivatives that this run has not made yet.

    def named(self, robot, key: tuple):
        """The robot, which knows how it was made: the words of `key` by their places."""
        kind, *parts = key
        places = [a.word for a in (*self.robot.inputs, *self.robot.outputs)]
        if robot is not None:
            numbers = [[str(places.index(word)) for word in part] for part in parts]
            robot._derivation = self.robot, "_".join([kind, *("x".join(part) or "none" for part in numbers)])
        return robot

    def derived(self, derivation: str):
        """The robot that `named` has named so."""
        kind, *parts = derivation.split("_")
        arrays = (*self.robot.inputs, *self.robot.outputs)
        found = [[] if part == "none" else [arrays[int(i)] for i in part.split("x")] for part in parts]
        if kind in ("along", "across"):
            return self.along_robot() if kind == "along" else self.across_robot()
        if kind == "apart":
            return self.robot_apart(tuple(a.word for a in found[0]))
        apart = tuple(a.word for part in found[(1 if kind == "second" else 2):] for a in part)
        return self.second_robot(found[0], apart) if kind == "second" else self.make(kind, found[0], found[1], apart)[0]

    def lacking(self, what: str) -> NotImplementedError:
        return NotImplementedError(f"{self.robot.name}: {what}. {HAD}")

    def refused(self, array) -> NotImplementedError:
        return NotImplementedError(f"{self.robot.name}: {array.word} {REFUSED[array.role]}")

    def no_second(self, array) -> NotImplementedError:
        return self.lacking(f"no second derivatives by {array.word}")

    @staticmethod
    def constant_of(array) -> str:
        """The word of the constant that this is, or is a direction of."""
        return array.of if array.role == "tangent" and array.of else array.word

    def run(self, robot, given: dict[str, Any], lead: tuple[int, ...], like) -> dict[str, Any]:
        """Its outputs by word, from inputs by word; what is not there is 0."""
        arrays = [given[a.word] if a.word in given else self.library.zeros(like, (*lead, *a.shape)) for a in robot.inputs]
        return dict(zip((a.word for a in robot.outputs), self.library.run(robot, arrays)))

    # ---- backward ----

    def backward(self, arrays: Sequence, weights: Sequence, needs: Sequence[bool], apart: tuple[str, ...] = ()) -> list:
        """What the weights of the outputs, None for none, make of each input that is needed; None where they make
        nothing. An input of arrays that is None was left out. Constants of the whole batch have the sum over samples,
        those in `apart` one for each."""
        inputs = self.robot.inputs
        of = [(a, w) for a, w in zip(self.robot.outputs, weights) if w is not None]
        needed = [a for a, need in zip(inputs, needs) if need]
        if not of or not needed:
            return [None] * len(inputs)
        given = {a.word: x for a, x in zip(inputs, arrays)}
        first = [x for x in of if x[0].role not in PRODUCTS]
        second, along = ([x for x in of if x[0].role == role] for role in PRODUCTS)
        found = [self.products(first, [a for a in needed if a.role not in DIRECTIONS], given)] if first else []
        found += [self.second(x, [a for a in needed if a.role != "tangent"], given) for x in second]
        found += [self.across(x, needed, given) for x in along]
        return [self.total([self.pick(a, f, given, apart) for f in found]) if need else None for a, need in zip(inputs, needs)]

    @staticmethod
    def total(parts: list):
        """Their sum; None where there is none."""
        there = [x for x in parts if x is not None]
        return sum(there[1:], there[0]) if there else None

    def products(self, of: Sequence[tuple], needed: Sequence, given: dict[str, Any]) -> dict[str, Any]:
        """vjp of these outputs with these weights, and what it is by other inputs: by word."""
        robot, words = self.make("vjp", [a for a, _ in of], needed)
        a, w = of[0]
        lead = tuple(w.shape[:len(w.shape) - len(a.shape)])
        weights = {a.word: w.reshape((*lead, a.rows)) for a, w in of}
        if robot is None:
            return {"vjp": self.library.zeros(w, (*lead, 3 * self.robot.nv))}
        if "qdd" in words and "qdd" not in weights:
            weights["qdd"] = self.library.zeros(w, (*lead, self.robot.nv))
        return self.run(robot, {**given, "vjp_v": self.library.join([weights[word] for word in words])}, lead, w)

    def second(self, of: tuple, needed: Sequence, given: dict[str, Any]) -> dict[str, Any]:
        """What the gradient g by vjp makes of the state, as products has it, and of its weights."""
        a, g = of
        lead = tuple(g.shape[:len(g.shape) - 1])
        for other in needed:
            if a.word != "vjp" or other.role not in PARTS and other.role != "cotangent":
                raise self.lacking(f"no second derivatives by {other.word if a.word == 'vjp' else a.word[4:]}")
        found: dict[str, Any] = {}
        if any(x.role in PARTS for x in needed):
            robot = self.second_robot(())
            made = self.run(robot, {**given, "jvp_v": g}, lead, g) if robot else {}
            found["vjp"] = self.transposed(made["jvp"], made["vjp"], g) if made else self.library.zeros(g, tuple(g.shape))
        if any(x.role == "cotangent" for x in needed):
            found["vjp_v"] = self.run(self.along_robot(), {**given, "jvp_v": g}, lead, g)["jvp"]
        return found

    def second_robot(self, by: Sequence, apart: tuple[str, ...] = ()):
        """How its vjp varies along a direction; None: not at all, by what the scene gives."""
        words = tuple(a.word for a in by if a.role not in PARTS)
        key = "second", words, apart
        if key not in self.made:
            made = None
            try:
                made = self.robot._with(want=None, jvp=["vjp"], by=list(words) or None, sparse=None, **self.freed(apart))
            except RobotError as error:
                if "'vjp' does not vary" not in str(error):
                    raise
            self.made[key] = self.named(made, key)
        return self.made[key]

    def along_robot(self):
        """The products of what its vjp is of, the other way."""
        if "along" not in self.made:
            weights = next(a for a in self.robot.inputs if a.role == "cotangent")
            words = self.robot._options.get("vjp") or weights.of or ("qdd" if self.is_forward else "tau")
            made = self.robot._with(want=None, jvp=words, vjp=None, by=None, sparse=None)
            self.made["along"] = self.named(made, ("along",))
        return self.made["along"]

    def across(self, of: tuple, needed: Sequence, given: dict[str, Any]) -> dict[str, Any]:
        """What the gradient w by jvp makes of the state, and of the directions."""
        a, w = of
        if "vjp" in a.of.split(","):
            raise self.refused(a)
        for other in needed:
            if other.role not in (*PARTS, *DIRECTIONS):
                raise self.no_second(other)
        robot = self.across_robot()
        made = self.run(robot, {**given, "vjp_v": w}, tuple(w.shape[:len(w.shape) - 1]), w)
        bent = self.transposed(made["jvp"], made["vjp"], given["jvp_v"]) if "jvp" in made else 0 * made["vjp"]
        along = {f"vjp.{x.word}": made[f"vjp{x.word[5:]}"] for x in needed if x.role == "tangent"}
        return {"vjp": bent, **along}

    def across_robot(self):
        """The products of what its jvp is of, with weights, and how they vary along its directions, if they do."""
        if "across" not in self.made:
            jvp = next(a for a in self.robot.outputs if a.role == "jvp")
            words = self.robot._options.get("jvp") or jvp.of or ("qdd" if self.is_forward else "tau")
            options = {"want": None, "vjp": words, "sparse": None}
            try:
                made = self.robot._with(**options, jvp=["vjp"])
            except RobotError as error:
                if "'vjp' does not vary" not in str(error):
                    raise
                made = self.robot._with(**options, jvp=None)
            self.made["across"] = self.named(made, ("across",))
        return self.made["across"]

    def transposed(self, product, vjp, g):
        """H' g from H g."""
        pieces, at, cross = [], 0, self.library.cross
        for joint in self.floating:
            i = joint["iv"]
            c, d, m, n = (x[..., k:k + 3] for x in (g, vjp) for k in (i, i + 3))
            # e_j = (a, b): m . (b x c + a x d) + n . (b x d)
            pieces += [product[..., at:i], product[..., i:i + 3] + cross(d, m),
                       product[..., i + 3:i + 6] + cross(c, m) + cross(d, n)]
            at = i + 6
        return self.library.join([*pieces, product[..., at:]]) if pieces else product

    def pick(self, array, found: dict[str, Any], given: dict[str, Any], apart: tuple[str, ...]):
        """The gradient by one input."""
        if array.role == "cotangent":
            return found.get("vjp_v")
        if array.role in PARTS:
            at, nv = PARTS[array.role] * self.robot.nv, self.robot.nv
            part = found["vjp"][..., at:at + nv]
            if array.role == "joint_torque":
                return self.without_given(part)
            return self.to_numbers(given[array.word], part) if array.role == "joint_position" and self.floating else part
        product = found.get(f"vjp.{array.word}")
        if product is None or not array.per_batch or array.word in apart:
            return product
        samples = tuple(range(len(product.shape) - 1))
        return product.sum(samples) if samples else product  # PyTorch takes no axes for all of them

    # ---- forward ----

    def forward(self, of: Sequence, arrays: Sequence, tangents: Sequence) -> list:
        """The tangents of these outputs, from those of the inputs, None for none, with as many axes of samples as the
        arrays have. The tangent of a constant of the whole batch may have them too: it is `apart` then."""
        library = self.library
        given = [(a, d) for a, d in zip(self.robot.inputs, tangents) if d is not None]
        lead = _arrays.samples_of(self.robot.inputs, arrays)
        values = {a.word: x for a, x in zip(self.robot.inputs, arrays)}
        state = [(a, d) for a, d in given if a.role != "cotangent"]
        weights = next((d for a, d in given if a.role == "cotangent"), None)
        first = [a for a in of if a.role != "vjp"]
        found = self.tangents(first, values, state, lead) if first and state else {}
        for a in of:
            along = self.second_tangent(a, values, state, weights, lead) if a.role == "vjp" else None
            if along is not None:
                found[a.word] = along
        like = given[0][1]
        return [found[a.word].reshape((*lead, *a.shape)) if a.word in found else library.zeros(like, (*lead, *a.shape))
                for a in of]

    def along(self, robot, values: dict[str, Any], given: Sequence[tuple], lead: tuple[int, ...], apart: tuple[str, ...]):
        """The output jvp of a robot, along these tangents."""
        library, like = self.library, given[0][1]
        shapes = {a.word: a.shape for a in self.robot.inputs}
        values = {word: library.expand(x, (*lead, *shapes[word])) if word in apart else x for word, x in values.items()}
        values.update({f"jvp_v.{a.word}": d for a, d in given if a.role not in PARTS})
        values["jvp_v"] = self.direction(given, values, library.zeros(like, (*lead, self.robot.nv)))
        return self.run(robot, values, lead, like)["jvp"]

    @staticmethod
    def apart(given: Sequence[tuple]) -> tuple[str, ...]:
        return tuple(a.word for a, d in given if a.per_batch and len(d.shape) > len(a.shape))

    def tangents(self, of: Sequence, values: dict[str, Any], given: Sequence[tuple], lead: tuple[int, ...]) -> dict[str, Any]:
        """Of outputs that are no product, by word; what is not there is 0."""
        apart = self.apart(given)
        robot, words = self.make("jvp", of, [a for a, _ in given], apart)
        found, at = {}, 0
        if robot is not None:
            jvp, rows = self.along(robot, values, given, lead, apart), {a.word: a.rows for a in of}
            for word in words:  # all of it is no slice: where many tangents are one tensor, PyTorch has none
                found[word] = jvp[..., at:at + rows.get(word, 0)] if rows.get(word) != jvp.shape[-1] else jvp
                at += rows.get(word, 0)
        return found

    def second_tangent(self, array, values: dict[str, Any], given: Sequence[tuple], weights, lead: tuple[int, ...]):
        """Of vjp: H d + dw' J; None: nothing."""
        if array.word != "vjp":
            raise self.lacking(f"no second derivatives by {array.word[4:]}")
        parts, apart = [], self.apart(given)
        robot = self.second_robot([a for a, _ in given], apart) if given else None
        if robot:
            parts.append(self.along(robot, values, given, lead, apart))
        if weights is not None:
            parts.append(self.run(self.robot, {**values, "vjp_v": weights}, lead, weights)["vjp"])
        return self.total(parts)

    def direction(self, given: Sequence[tuple], values: dict[str, Any], zero):
        """jvp_v: tangents of q, qd and qdd or tau, one after another."""
        parts = [zero, zero, zero]
        for a, d in given:
            if a.role in PARTS:
                is_numbers = a.role == "joint_position" and self.floating
                d = self.without_given(d) if a.role == "joint_torque" else d
                parts[PARTS[a.role]] = self.from_numbers(values[a.word], d) if is_numbers else d
        return self.library.join(parts)

    def without_given(self, rows):
        """With 0 for rows of tau that fold= gives: texts have derivatives by them, though they do not read them."""
        if not self.given:
            return rows
        zero = self.library.zeros(rows, (*rows.shape[:-1], 1))
        return self.library.join([zero if i in self.given else rows[..., i:i + 1] for i in range(self.robot.nv)])

    # ---- quaternions ----

    def to_numbers(self, q, part):
        """Gradients from the tangent space to the numbers of q: a floating joint's position p and quaternion u = (v,
        s) move by R a and u (b, 0)/2 with a twist (a, b), whose transposed inverses are R and 2 u (b, 0)/|u|^2."""
        pieces, at, cross = [], 0, self.library.cross
        for joint in self.floating:
            iv = joint["iv"]
            v, s, twice = self.quaternion(q, joint)
            a, b = part[..., iv:iv + 3], part[..., iv + 3:iv + 6]
            across = cross(v, a)
            pieces += [part[..., at:iv], a + 2 * (s * across + cross(v, across)), twice * (s * b + cross(v, b)),
                       -twice * (v * b).sum(-1)[..., None]]
            at = iv + 6
        return self.library.join([*pieces, part[..., at:]])

    def from_numbers(self, q, d):
        """Tangents from the numbers of q to the tangent space: the inverse of what moves them, a = R' dp and b = 2 u*
        du/|u|^2, whose part along u is left out."""
        pieces, at, cross = [], 0, self.library.cross
        for joint in self.floating:
            iq = joint["iq"]
            v, s, twice = self.quaternion(q, joint)
            p, e, r = d[..., iq:iq + 3], d[..., iq + 3:iq + 6], d[..., iq + 6:iq + 7]
            across = cross(v, p)
            pieces += [d[..., at:iq], p - 2 * (s * across - cross(v, across)), twice * (s * e - r * v - cross(v, e))]
            at = iq + 7
        return self.library.join([*pieces, d[..., at:]])

    @staticmethod
    def quaternion(q, joint) -> tuple:
        """Its vector, its scalar, and 2/|u|^2."""
        i = joint["iq"] + 3
        return q[..., i:i + 3], q[..., i + 3:i + 4], 2 / (q[..., i:i + 4] ** 2).sum(-1)[..., None]
