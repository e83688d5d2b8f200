"""Derivatives of a robot's outputs, for the libraries that differentiate. Each is made by another text of the same scene, which is a robot
too: so a derivative has a compiled text of its own, and what the library does with robots it does with derivatives.

Backward, with w the gradient of the loss by an output:
    tau, qdd        the output vjp: w' d tau/d(q, qd, qdd), w' d qdd/d(q, qd, tau)
    gravity, bias   the same at qdd = 0, at qd = 0, of the rigid bodies alone
    M               sum over columns j of the vjp of M e_j: tau without gravity at qd = 0, qdd = e_j
    freed constants w' d tau/d constant, of the output dtau_dNAME
    wrenches        minus the link's twist at qd = w, for tau holds -J' f; of qdd, its twist at qd = M^-1 w

Forward, with d the tangent of the inputs, the transposes of these: the output jvp; of M column by column; dtau_dNAME d;
    wrenches        J' d = minus tau at rest and without gravity; qdd takes it as a tangent of tau
"""
from __future__ import annotations

from typing import Any, Callable, NamedTuple, Sequence

from . import _robot

FREED = ("gravity", "link_mass", "link_inertia", "link_payload", "joint_offset")
PARTS = {"joint_position": 0, "joint_velocity": 1, "joint_acceleration": 2, "joint_torque": 2}  # of vjp and jvp_v
RIGID = ("damping", "friction", "fext", "fext_frame", "refine", "dynamics")  # what gravity, bias and M have not
ABSENT: dict[str, tuple[str, ...]] = {"bias_torque": ("joint_acceleration", "joint_torque", "link_wrench")}  # what they do not depend on
ABSENT["gravity_torque"] = (*ABSENT["bias_torque"], "joint_velocity")
ABSENT["mass_matrix"] = (*ABSENT["gravity_torque"], "gravity")
SECOND = ("vjp", "jvp", "dtau_dq", "dtau_dqd", "dtau_dfreed", "dqdd_dq", "dqdd_dqd", "dqdd_dfreed")


class Library(NamedTuple):
    """What differs between the caller's libraries."""
    run: Callable[[Any, list], Sequence]  # the outputs of a robot, of arrays for all its inputs
    zeros: Callable[[Any, tuple[int, ...]], Any]  # (an array like it, shape)
    identity: Callable[[Any, int], Any]
    expand: Callable[[Any, tuple[int, ...]], Any]  # broadcast, and in one piece
    join: Callable[[list], Any]  # along the last axis
    cross: Callable[[Any, Any], Any]  # of vectors along the last axis


class Gradients:
    """Of one robot. Arrays go by the names of its inputs."""

    def __init__(self, robot, library: Library):
        self.robot, self.library = robot, library
        self.is_forward = any(a.role == "joint_torque" for a in robot.inputs)
        self.floating = [joint for joint in robot.joints if joint["nq"] != joint["nv"]]
        self.made: dict[tuple, Any] = {}  # robots of derivatives
        self.recipes: dict[tuple, tuple] = {}

    # ---- the robots ----

    def options_of(self, output) -> dict[str, Any]:
        """Keywords of the robots that differentiate this output; NotImplementedError where there are none."""
        role = output.role
        if role in SECOND:
            raise NotImplementedError(f"{self.robot.name}: second derivatives: {output.name} is a derivative, and has no gradient of its own")
        if role == "joint_acceleration" or role == "joint_torque" and not self.is_forward:
            return {}
        if role not in ABSENT:
            raise NotImplementedError(f"{self.robot.name}: {output.word} has no gradient; tau, qdd, gravity, bias and M have one")
        for keyword in ("fold", "scene"):
            if self.robot._options.get(keyword):
                raise NotImplementedError(f"{self.robot.name}: {output.word} has no gradient where the scene has {keyword}=")
        return {**dict.fromkeys(RIGID), **({"gravity": (0.0, 0.0, 0.0)} if role == "mass_matrix" else {})}

    def make(self, key: tuple, options: dict[str, Any]):
        """A robot with other keywords, made once."""
        if key not in self.made:
            self.made[key] = _robot.Robot(self.robot._urdf, self.robot._file, {**self.robot._options, "sparse": None, **options})
        return self.made[key]

    def run(self, robot, named: dict[str, Any], like) -> dict[str, Any]:
        """Its outputs by word, from inputs by name; q, qd and qdd that are not there are 0."""
        arrays = [named[a.name] if a.name in named else self.library.zeros(like, (*like.shape[:-1], *a.shape)) for a in robot.inputs]
        return dict(zip((a.word for a in robot.outputs), self.library.run(robot, arrays)))

    def recipe(self, product: str, output, needed: Sequence, options: dict[str, Any]) -> tuple[Any, dict[str, str], str]:
        """The robot that makes `product`, vjp or jvp, by these inputs; the words of its outputs for freed constants; the key of both."""
        of = "qdd" if output.name == "qdd" else "tau"
        words = {a.name: f"d{of}_d{a.word}" for a in needed if a.role in FREED}
        is_needed = any(a.role in PARTS or of == "qdd" and a.role == "link_wrench" for a in needed)
        key = (product, output.name, is_needed, *words)
        if key not in self.recipes:
            wanted = [*([product] if is_needed and of == "tau" else []), *words.values()]
            keyword = {product: "qdd" if is_needed and of == "qdd" else None}
            self.recipes[key] = (self.make(key, {**options, "want": wanted or None, **keyword}) if is_needed or words else None), words
        return (*self.recipes[key], is_needed)

    def of_input(self, array) -> None:
        """Raise where nothing can be differentiated by this input."""
        if array.role == "link_wrench":
            if self.robot._options.get("scene") or self.robot._options.get("fext_frame") not in (None, "link"):
                raise NotImplementedError(f"{self.robot.name}: there is no gradient by {array.word} in the world's axes; fext_frame='link' has one")
        elif array.role not in PARTS and array.role not in FREED:
            raise NotImplementedError(f"{self.robot.name}: there is no gradient by {array.word}")

    def columns(self, arrays: dict[str, Any], lead: tuple[int, ...], like) -> dict[str, Any]:
        """For M, column by column, or row by row, for M is symmetric: one more axis of nv samples."""
        nv, expand = self.robot.nv, self.library.expand
        made = {a.name: x if x is None or a.per_batch else expand(x[..., None, :], (*lead, nv, *a.shape))
                for a, x in ((a, arrays.get(a.name)) for a in self.robot.inputs) if a.name in arrays}
        made["gravity"] = self.library.zeros(like, (3,))
        made["qdd"] = expand(self.library.identity(like, nv), (*lead, nv, nv))
        return made

    # ---- backward ----

    def backward(self, output, arrays: Sequence, w, needs: Sequence[bool]) -> list:
        """What w makes of each input that is needed; None where it makes nothing. An input of arrays that is None was left out."""
        absent, inputs, options = ABSENT.get(output.role, ()), self.robot.inputs, self.options_of(output)
        named = {a.name: x for a, x in zip(inputs, arrays) if a.role not in absent}
        needs = [need and a.role not in absent for a, need in zip(inputs, needs)]
        if output.role != "mass_matrix":
            return self.backward_vector(output, named, w, needs, options)
        parts = self.backward_vector(output, self.columns(named, w.shape[:-2], w), w, needs, options)
        return [x if x is None or a.per_batch else x.sum(-2) for a, x in zip(inputs, parts)]

    def backward_vector(self, output, named: dict[str, Any], w, needs: Sequence[bool], options: dict[str, Any]) -> list:
        """Of tau and what is like it, or of qdd."""
        inputs, w = self.robot.inputs, self.library.expand(w, tuple(w.shape))
        robot, words, _ = self.recipe("vjp", output, [a for a, need in zip(inputs, needs) if need], options)
        found = self.run(robot, {**named, "vjp_v": w}, w) if robot else {}
        return [self.pick(a, w, found, words, named) if need else None for a, need in zip(inputs, needs)]

    def pick(self, array, w, found: dict[str, Any], words: dict[str, str], named):
        """The gradient by one input."""
        self.of_input(array)
        nv = self.robot.nv
        if array.role in PARTS:
            at = PARTS[array.role] * nv
            part = found["vjp"][..., at:at + nv]
            return self.to_numbers(named[array.name], part) if array.role == "joint_position" and self.floating else part
        if array.role in FREED:
            product = (w[..., None, :] @ found[words[array.name]])[..., 0, :]
            return product.sum(tuple(range(len(product.shape) - 1))) if array.per_batch else product
        v = self.library.expand(found["vjp"][..., 2 * nv:], tuple(w.shape)) if self.is_forward else w
        robot = self.make(("twist", array.name), {"want": [f"twist.{array.of}"], "vjp": None, **dict.fromkeys(RIGID)})
        twist, = self.run(robot, {**named, "qd": v}, w).values()
        return twist if self.is_forward else -twist

    # ---- forward ----

    def forward(self, output, arrays: Sequence, tangents: Sequence):
        """The tangent of an output, from those of the inputs, None for none, with as many axes of samples as the arrays have; that of a
        constant of the whole batch may have them too. None: it is zero."""
        absent, inputs, options = ABSENT.get(output.role, ()), self.robot.inputs, self.options_of(output)
        named = {a.name: x for a, x in zip(inputs, arrays) if a.role not in absent}
        given = {a.name: d for a, d in zip(inputs, tangents) if d is not None and a.role not in absent}
        if not given:
            return None
        lead = next((tuple(x.shape[:-1]) for a, x in zip(inputs, arrays) if not a.per_batch), ())
        if output.role != "mass_matrix":
            return self.forward_vector(output, named, given, lead, options)
        like = next(iter(given.values()))
        given = {name: d[..., None, :] for name, d in given.items()}
        return self.forward_vector(output, self.columns(named, lead, like), given, (*lead, self.robot.nv), options)

    def forward_vector(self, output, named: dict[str, Any], given: dict[str, Any], lead: tuple[int, ...], options: dict[str, Any]):
        inputs, nv = [a for a in self.robot.inputs if a.name in given], self.robot.nv
        for a in inputs:
            self.of_input(a)
        like = self.library.zeros(next(iter(given.values())), (*lead, nv))
        robot, words, is_needed = self.recipe("jvp", output, inputs, options)
        push = [self.of_wrench(a, named, given[a.name], like) for a in inputs if a.role == "link_wrench"]
        total = [] if self.is_forward else [-x for x in push]
        if robot:
            parts = self.parts(inputs, named, given, like, push if self.is_forward else []) if is_needed else {}
            found = self.run(robot, {**named, **parts}, like)
            total += [found["jvp"]] if is_needed else []
            total += [(found[word] @ given[name][..., None])[..., 0] for name, word in words.items()]
        return sum(total[1:], total[0])

    def parts(self, inputs: Sequence, named, given, like, push: list) -> dict[str, Any]:
        """jvp_v: tangents of q, qd and qdd or tau, one after another."""
        parts = [like, like, like]
        for a in inputs:
            if a.role in PARTS:
                d = given[a.name]
                is_numbers = a.role == "joint_position" and self.floating
                parts[PARTS[a.role]] = parts[PARTS[a.role]] + (self.from_numbers(named[a.name], d) if is_numbers else d)
        parts[2] = sum(push, parts[2])
        return {"jvp_v": self.library.join(parts)}

    def of_wrench(self, array, named: dict[str, Any], d, like):
        """J' d."""
        still = {**dict.fromkeys(RIGID), "fext": self.robot._options.get("fext"), "gravity": (0.0, 0.0, 0.0), "jvp": None}
        robot = self.make(("push",), {**still, "want": ["tau"], "fold": None})
        at_rest = {a.name: x for a, x in ((a, named.get(a.name)) for a in robot.inputs) if x is not None and a.role not in ABSENT["mass_matrix"]}
        at_rest.update({"gravity": self.library.zeros(like, (3,)), array.name: self.library.expand(d, (*like.shape[:-1], 6))})
        tau, = self.run(robot, at_rest, like).values()
        return -tau

    # ---- quaternions ----

    def to_numbers(self, q, part):
        """Gradients from the tangent space to the numbers of q: a floating joint's position p and quaternion u = (v, s) move by R a and
        u (b, 0)/2 with a twist (a, b), whose transposed inverses are R and 2 u (b, 0)/|u|^2."""
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
        """Tangents from the numbers of q to the tangent space: the inverse of what moves them, a = R' dp and b = 2 u* du/|u|^2, whose part
        along u is left out."""
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
