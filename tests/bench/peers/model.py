"""A robot as the peers need it, read from its URDF by nothing of this project: numbered moving bodies with constant
matrices. Spatial vectors are linear, then angular, at the origin of the body's link, as the generated texts have them."""
import math
import xml.etree.ElementTree as xml
from dataclasses import dataclass

import numpy as np

GRAVITY = 9.81
MOVING = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}


@dataclass
class Body:
    joint: str
    kind: str              # "revolute" or "prismatic"
    parent: int            # the moving body it hangs on, -1: the root
    axis: np.ndarray       # of unit length
    rotation: np.ndarray   # from the body's coordinates to its parent's, at q = 0
    offset: np.ndarray     # of its origin, in the parent
    mass: float = 0.0
    moment: np.ndarray = None    # mass times centre of mass
    rotational: np.ndarray = None  # inertia about the origin


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def numbers(element, name, default):
    text = element.get(name) if element is not None else None
    return np.array([float(x) for x in text.split()]) if text else np.array(default, float)


def sine_cosine(angle):
    """Of an angle that is meant to be a multiple of pi/2, exactly."""
    quarter = round(angle / (math.pi / 2))
    if abs(angle - quarter * (math.pi / 2)) < 5e-15:
        return [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarter % 4]
    return math.sin(angle), math.cos(angle)


def placement(element):
    """(R, p) of an <origin>: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    origin = element.find("origin") if element is not None else None
    (sr, cr), (sp, cp), (sy, cy) = (sine_cosine(a) for a in numbers(origin, "rpy", (0, 0, 0)))
    rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return rz @ ry @ rx, numbers(origin, "xyz", (0, 0, 0))


def inertia_of(link):
    """Mass, centre of mass and inertia about it, all in the link's frame; None: it has none."""
    inertial = link.find("inertial")
    if inertial is None:
        return None
    r, c = placement(inertial)
    i = inertial.find("inertia")
    xx, xy, xz, yy, yz, zz = (float(i.get(n, 0)) for n in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    about = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return float(inertial.find("mass").get("value")), c, r @ about @ r.T


class Model:
    """`bodies` in the order of q: depth-first, children by joint name in byte order."""

    def __init__(self, path):
        root = xml.parse(path).getroot()
        self.name, self.path, self.bodies = root.get("name"), str(path), []
        self.links = {link.get("name"): link for link in root.findall("link")}
        self.children = {}
        for joint in sorted(root.findall("joint"), key=lambda j: j.get("name").encode()):
            self.children.setdefault(joint.find("parent").get("link"), []).append(joint)
        moved = {j.find("child").get("link") for joints in self.children.values() for j in joints}
        (base,) = set(self.links) - moved
        self.visit(base, -1, np.eye(3), np.zeros(3))
        self.n = len(self.bodies)

    def visit(self, name, body, rotation, offset):
        """The link `name`, which lies at (rotation, offset) in the moving body `body`."""
        inertia = inertia_of(self.links[name])
        if body >= 0 and inertia:
            self.add_inertia(self.bodies[body], inertia, rotation, offset)
        for joint in self.children.get(name, []):
            r, p = placement(joint)
            r, p, child = rotation @ r, rotation @ p + offset, joint.find("child").get("link")
            if joint.get("type") == "fixed":
                self.visit(child, body, r, p)
            else:
                self.bodies.append(self.moving(joint, body, r, p))
                self.visit(child, len(self.bodies) - 1, np.eye(3), np.zeros(3))

    def moving(self, joint, parent, rotation, offset):
        if joint.get("type") not in MOVING or joint.find("mimic") is not None:
            raise ValueError(f"{self.path}: joint \"{joint.get('name')}\": the peers have no mimic joints and none of "
                             f"type {joint.get('type')}; take another robot")
        axis = numbers(joint.find("axis"), "xyz", (1, 0, 0))
        return Body(joint.get("name"), MOVING[joint.get("type")], parent, axis / np.linalg.norm(axis), rotation, offset,
                    0.0, np.zeros(3), np.zeros((3, 3)))

    def add_inertia(self, body, inertia, rotation, offset):
        mass, centre, about = inertia
        c = rotation @ centre + offset
        body.mass += mass
        body.moment += mass * c
        body.rotational += rotation @ about @ rotation.T + mass * (c @ c * np.eye(3) - np.outer(c, c))


# ---- dense matrices of a body ----


def inertia6(body):
    """I of f = I a."""
    h = skew(body.moment)
    return np.block([[body.mass * np.eye(3), -h], [h, body.rotational]])


def motion(rotation, offset):
    """X of v_child = X v_parent for a child at (rotation, offset): w' = R^T w, v' = R^T (v - p x w)."""
    e = rotation.T
    return np.block([[e, -e @ skew(offset)], [np.zeros((3, 3)), e]])


def subspace(body):
    """S of the joint's own twist S qd."""
    zero = np.zeros(3)
    return np.concatenate([zero, body.axis] if body.kind == "revolute" else [body.axis, zero])


def transform_parts(body):
    """A, B, C of X(q) = A + s B + c C, with s and c the sine and cosine of q; of a prismatic joint s is q, and C is 0."""
    def twice(m):
        return np.kron(np.eye(2), m)

    tree, a = motion(body.rotation, body.offset), body.axis
    if body.kind == "revolute":
        along = np.outer(a, a)
        return twice(along) @ tree, twice(-skew(a)) @ tree, twice(np.eye(3) - along) @ tree
    slide = np.zeros((6, 6))
    slide[:3, 3:] = -skew(a)
    return tree, slide @ tree, np.zeros((6, 6))
