"""Inverse dynamics written in CasADi's own expressions, from the URDF alone: a reference that CasADi differentiates by itself.

Newton's and Euler's equations link by link, of velocities and classical accelerations at the links' origins, in their frames.
Joints are fixed, revolute, continuous and prismatic; mimic joints follow. It shares nothing with the package.
"""
import xml.etree.ElementTree as ElementTree

import casadi as ca
import numpy as np


def vector(element, name, default):
    text = element.get(name) if element is not None else None
    return np.array([float(x) for x in (text or default).split()])


def rotation(rpy):
    """Of fixed roll, pitch and yaw."""
    (a, b, c), (d, e, f) = np.cos(rpy), np.sin(rpy)
    return np.array([[b * c, d * e * c - a * f, a * e * c + d * f], [b * f, d * e * f + a * c, a * e * f - d * c],
                     [-e, d * b, a * b]])


def about(axis, angle):
    """Rodrigues."""
    k = ca.skew(ca.DM(axis))
    return ca.DM.eye(3) + ca.sin(angle) * k + (1 - ca.cos(angle)) * (k @ k)


def of_quaternion(u):
    """Of x y z w, by the length that it has."""
    k = ca.skew(u[:3])
    return ca.DM.eye(3) + 2 * (u[3] * k + k @ k) / ca.sumsqr(u)


class Chain:
    """The robot of a URDF: joints in the order of q, depth-first, children by name."""

    def __init__(self, path, floating=False):
        root = ElementTree.parse(path).getroot()
        self.floating = floating
        self.links = {link.get("name"): link for link in root.findall("link")}
        joints = sorted(root.findall("joint"), key=lambda joint: joint.get("name").encode())
        children = {joint.find("child").get("link") for joint in joints}
        self.root = next(name for name in self.links if name not in children)
        self.walk = []

        def visit(link):
            for joint in joints:
                if joint.find("parent").get("link") == link:
                    self.walk.append(joint)
                    visit(joint.find("child").get("link"))

        visit(self.root)
        moving = [joint.get("name") for joint in self.walk if joint.get("type") != "fixed" and joint.find("mimic") is None]
        self.row = {name: 6 * floating + k for k, name in enumerate(moving)}
        self.nv, self.nq = 6 * floating + len(moving), 7 * floating + len(moving)

    def driven(self, joint):
        """The row of the joint that this one follows, multiplier and offset."""
        row, factor, offset, mimic = self.row.get(joint.get("name")), 1.0, 0.0, joint.find("mimic")
        if mimic is not None:
            driver = next(x for x in self.walk if x.get("name") == mimic.get("joint"))
            row, by, shift = self.driven(driver)
            own = float(mimic.get("multiplier", 1))
            factor, offset = own * by, own * shift + float(mimic.get("offset", 0))
        return row, factor, offset

    def wrench(self, name, w, dw, a):
        """Force and moment about the origin that move this link so."""
        inertial = self.links[name].find("inertial")
        if inertial is None:
            return ca.DM.zeros(3), ca.DM.zeros(3)
        m, x = float(inertial.find("mass").get("value")), inertial.find("inertia")
        c, R = vector(inertial.find("origin"), "xyz", "0 0 0"), rotation(vector(inertial.find("origin"), "rpy", "0 0 0"))
        xx, xy, xz, yy, yz, zz = (float(x.get("i" + k)) for k in ("xx", "xy", "xz", "yy", "yz", "zz"))
        inertia = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
        f = m * (a + ca.cross(dw, c) + ca.cross(w, ca.cross(w, c)))
        return f, inertia @ dw + ca.cross(w, inertia @ w) + ca.cross(c, f)

    def torques(self, q, qd, qdd, gravity=(0, 0, -9.81), outside=None):
        """`outside`: by link, force and moment at its origin in its axes."""
        up, outside = -ca.vertcat(*ca.vertsplit(gravity) if isinstance(gravity, ca.SX) else gravity), outside or {}
        if self.floating:
            w, dw = qd[3:6], qdd[3:6]
            a = qdd[:3] + ca.cross(w, qd[:3]) + of_quaternion(q[3:7]).T @ up
        else:
            w, dw, a = ca.DM.zeros(3), ca.DM.zeros(3), up
        state, forces, back = {self.root: (w, dw, a)}, {}, []
        forces[self.root] = self.wrench(self.root, *state[self.root])
        for joint in self.walk:
            parent, child = joint.find("parent").get("link"), joint.find("child").get("link")
            p, R = vector(joint.find("origin"), "xyz", "0 0 0"), rotation(vector(joint.find("origin"), "rpy", "0 0 0"))
            axis = vector(joint.find("axis"), "xyz", "1 0 0")
            axis, (row, factor, offset) = axis / np.linalg.norm(axis), self.driven(joint)
            turns, slides = joint.get("type") in ("revolute", "continuous"), joint.get("type") == "prismatic"
            x, rate, more = 0, 0, 0
            if row is not None:
                x, rate, more = factor * q[row + self.floating] + offset, factor * qd[row], factor * qdd[row]
            R = R @ about(axis, x) if turns else ca.DM(R)
            p = p + R @ (axis * x) if slides else ca.DM(p)
            w, dw, a = state[parent]
            a = R.T @ (a + ca.cross(dw, p) + ca.cross(w, ca.cross(w, p)))
            w, dw = R.T @ w, R.T @ dw
            if turns:
                dw = dw + axis * more + ca.cross(w, axis * rate)
                w = w + axis * rate
            if slides:
                a = a + axis * more + 2 * ca.cross(w, axis * rate)
            f, n = self.wrench(child, w, dw, a)
            pushed = outside.get(child, ca.DM.zeros(6))
            state[child], forces[child] = (w, dw, a), (f - pushed[:3], n - pushed[3:])
            back.append((parent, child, R, p, axis, row, factor, turns, slides))
        tau = [ca.SX(0)] * self.nv
        for parent, child, R, p, axis, row, factor, turns, slides in reversed(back):
            f, n = forces[child]
            if turns or slides:
                tau[row] = tau[row] + factor * ca.dot(axis, n if turns else f)
            f, n = R @ f, R @ n
            forces[parent] = forces[parent][0] + f, forces[parent][1] + n + ca.cross(p, f)
        if self.floating:
            tau[:6] = ca.vertsplit(ca.vertcat(*forces[self.root]))
        return ca.vertcat(*tau)

    def mass(self, q):
        """The mass matrix."""
        a = ca.SX.sym("a", self.nv)
        return ca.jacobian(self.torques(q, ca.DM.zeros(self.nv), a), a)
