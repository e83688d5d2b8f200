"""The algorithm of spatial.py written out for one robot: a tracer runs it on symbols and prints one statement for every
operation on scalars that is left, as Python text that takes any library's arrays [N]."""
import numpy as np

from spatial import Spatial


class Value:
    __array_ufunc__ = None  # NumPy's scalars leave the operators to this class

    def __init__(self, trace, text):
        self.trace, self.text = trace, text

    def __mul__(self, other):
        if not isinstance(other, Value):
            if other == 0:
                return 0.0
            if abs(other) == 1:
                return self if other == 1 else -self
        return self.trace.add("*", self, other)

    def __add__(self, other):
        return self if not isinstance(other, Value) and other == 0 else self.trace.add("+", self, other)

    def __sub__(self, other):
        return self + -other

    def __rsub__(self, other):
        return -self + other

    def __neg__(self):
        return self.trace.statement(f"-{self.text}")

    __rmul__, __radd__ = __mul__, __add__


class Trace:
    """Statements, each text once."""

    def __init__(self):
        self.names = {}

    def statement(self, text):
        if text not in self.names:
            self.names[text] = f"t{len(self.names)}"
        return Value(self, self.names[text])

    def add(self, sign, *operands):
        texts = sorted(x.text if isinstance(x, Value) else repr(float(x)) for x in operands)
        return self.statement(f"{texts[0]} {sign} {texts[1]}")

    # ---- what Spatial asks of a library ----

    def each(self, function, x):
        return np.array([self.statement(f"{function}({v.text})") for v in x.ravel()], object).reshape(x.shape)

    def sin(self, x):
        return self.each("sin", x)

    def cos(self, x):
        return self.each("cos", x)

    def stack(self, arrays, axis):
        return np.stack(arrays, axis)

    def einsum(self, indices, m, v):
        return (m if indices.startswith("...ij") else m.T) @ v

    def lines(self, outputs):
        """The statements that `outputs` need, in order."""
        texts, wanted, kept = {name: text for text, name in self.names.items()}, [x.text for x in outputs], set()
        while wanted:
            name = wanted.pop()
            if name not in kept and name in texts:
                kept.add(name)
                wanted += texts[name].replace("(", " ").replace(")", " ").replace("-", " ").split()
        return [f"{name} = {texts[name]}" for name in texts if name in kept]


def rnea_text(model):
    """def rnea(q, qd, qdd, sin, cos): of arrays [n][N], a tuple of n torques [N]."""
    trace = Trace()

    def rows(name):
        return np.array([trace.statement(f"{name}[{i}]") for i in range(model.n)], object)

    tau = Spatial(trace, model, lambda x: x).rnea(rows("q"), rows("qd"), rows("qdd"))
    tau = [x if isinstance(x, Value) else trace.statement("0.0 * q[0]") for x in tau]
    lines = trace.lines(tau)
    body = "\n".join("    " + line for line in lines)
    outputs = ", ".join(x.text for x in tau)
    return f"def rnea(q, qd, qdd, sin, cos):\n{body}\n    return ({outputs},)\n", len(lines)


def rnea(model, sin, cos):
    """That function for one library's sine and cosine, and its number of statements."""
    text, count = rnea_text(model)
    names = {}
    exec(compile(text, "straight", "exec"), names)
    return lambda q, qd, qdd: names["rnea"](q, qd, qdd, sin, cos), count
