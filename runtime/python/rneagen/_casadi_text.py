"""C files of CasADi's functions: the texts that they need, one after another, and functions of CasADi's C interface around them.

Each function works in `w` alone, at places that are fixed here: it copies its arguments there, calls texts, and copies what
CasADi stores of each result, column by column, from places that a table has.
"""
from __future__ import annotations

import re
import textwrap
from typing import Any, Iterable, Sequence

from . import _core
from ._casadi_c import FLOATING, HEAD, SHARED, Signature, by_columns, called, entries, identifier, interface, wrapped
from ._casadi_model import Model, Plan, rows_at, shape, stored
from ._errors import RobotError, translated

class Room:
    """Places in w."""

    def __init__(self) -> None:
        self.size = 0

    def take(self, count: int) -> int:
        self.size += count
        return self.size - count


class Text:
    """A text of a robot of the model, by a name of its own. `batch`: also its function of a batch, [row][sample]."""

    def __init__(self, robot, name: str, batch: bool = False):
        self.robot, self.name = robot, name
        for function in ("",) if batch else ("rnea", "fd", "kin"):
            try:
                self.source = self.generate(only=function) if function else self.generate()
                break
            except RobotError as error:
                if "--only" not in str(error):
                    raise
        found = re.search(rf"^void {name}_(\w+?)\(", self.source, re.M)
        assert found
        self.function = f"{name}_{found[1]}"

    def generate(self, **options: Any) -> str:
        options = {**self.robot._generator, "precision": self.robot._options.get("precision") or "f64", "target": "c",
                   "parts": 1, "layout": "soa", "name": self.name, **options}
        return translated(_core.generate, self.robot._urdf, options)["source"]

    def call(self, at: dict[str, int], count: int = 0) -> str:
        """With arrays by word at these places."""
        arrays = ", ".join(f"w + {at[a.word]}" for a in (*self.robot.inputs, *self.robot.outputs))
        call = f"{self.function}_batch({arrays}, {count});" if count else f"{self.function}({arrays});"
        return textwrap.fill(call, 116, subsequent_indent="\t\t", break_long_words=False)


class File:
    """The C file of one function and its derivatives."""

    def __init__(self, model: Model, name: str, derivatives: int, forward: bool):
        self.model, self.name = model, name
        self.tables: dict[tuple[int, ...], str] = {}
        self.texts: dict[str, Text] = {}
        self.functions: list[str] = []
        self.inputs = [Signature(identifier(a.name), (a.rows, 1), default=self.default(a)) for a in model.inputs]
        self.outputs = [Signature(identifier(a.name), shape(a), by_columns(at for each in stored(a) for at in each))
                        for a in model.outputs]
        self.empty_outputs = [Signature(f"out_{a.name}", a.shape, []) for a in self.outputs]
        names = [a.name for a in (*self.inputs, *self.outputs)]
        if len(set(names)) < len(names):
            raise ValueError(f"CasADi knows arrays by their names, and these are not told apart: {', '.join(names)}")
        self.add_values()
        if derivatives > 0:
            self.add_reverse()
            self.add_first()
        if derivatives > 0 and forward:
            self.add_forward()
        if derivatives > 1:
            self.add_second()

    # ---- pieces ----

    def table(self, values: Iterable[int]) -> str:
        """The name of a table with these values."""
        key = tuple(values) or (0,)
        return self.tables.setdefault(key, f"{self.name}_t{len(self.tables)}")

    def text(self, kind: str, robot, batch: bool = False) -> Text:
        if kind not in self.texts:
            self.texts[kind] = Text(robot, f"{self.name}_{kind}", batch)
        return self.texts[kind]

    def place(self, room: Room, robot, given: dict[str, int], count: int = 1) -> dict[str, int]:
        """Places of all arrays of a text, those that are not given anew."""
        at = dict(given)
        for a in (*robot.inputs, *robot.outputs):
            if a.word not in at:
                at[a.word] = room.take(count*a.rows)
        return at

    def take(self, room: Room, first: int = 0) -> tuple[list[str], int]:
        """Statements that copy the numbers of the inputs, or of seeds of such, and where they lie."""
        begin = at = room.take(len(self.model.numbers))
        lines = []
        for i, a in enumerate(self.inputs):
            lines.append(f"@take(w + {at}, arg[{first + i}], {a.shape[0]});")
            at += a.shape[0]
        return lines, begin

    def state(self, room: Room) -> tuple[list[str], int, dict[str, int]]:
        """Statements that copy the inputs, where their numbers lie, and where texts find them by word."""
        lines, begin = self.take(room)
        at, found = begin, {}
        for a in self.model.inputs:
            found[a.word] = at
            if self.model.is_position(a) and self.model.floating:
                unit = found[a.word] = room.take(a.rows)
                lines += [f"for (int k = 0; k < {a.rows}; k++)", f"\tw[{unit} + k] = w[{at} + k];"]
                lines += [f"@unit(w + {unit + j['iq']}, w + {at + j['iq']});" for j in self.model.floating]
            at += a.rows
        return lines, begin, found

    def twists(self) -> list[tuple[int, int]]:
        """Of floating joints, where numbers and tangents begin."""
        begin = next((k for k, x in enumerate(self.model.numbers) if self.model.is_position(self.model.inputs[x.input])), 0)
        return [(begin + j["iq"], j["iv"]) for j in self.model.floating]

    def moves(self) -> str:
        """The functions between numbers and tangents."""
        numbers, tangents = len(self.model.numbers), self.model.tangent_count
        one = self.table(min(x.tangents) if len(x.tangents) == 1 else -1 for x in self.model.numbers)
        to = "".join(f"\t@to_twist(t + {v}, x + {k}, d + {k});\n" for k, v in self.twists())
        back = "".join(f"\t@from_twist(d + {k}, x + {k}, g + {v});\n" for k, v in self.twists())
        return f'''
/* Tangents t[{tangents}] of numbers d[{numbers}] of the inputs x. */
static inline void @to_tangents(double *t, const double *x, const double *d)
{{
	(void)x;
	@take(t, 0, {tangents});
	for (int k = 0; k < {numbers}; k++)
		if ({one}[k] >= 0)
			t[{one}[k]] = d[k];
{to}}}

/* A gradient by numbers, from that by tangents, of which there are `count`. */
static inline void @to_numbers(double *d, const double *x, const double *g, int count)
{{
	(void)x;
	for (int k = 0; k < {numbers}; k++)
		d[k] = {one}[k] >= 0 && {one}[k] < count ? g[{one}[k]] : 0;
{back}}}
'''

    def put(self, lines: list[str], result: int, at: Iterable[int]) -> None:
        at = list(at)
        if at:
            lines.append(f"@put(res[{result}], w, {self.table(at)}, {len(at)});")

    def add(self, name: str, inputs: Sequence[Signature], outputs: Sequence[Signature], lines: Sequence[str], room: Room) -> None:
        self.functions.append(interface(name, inputs, outputs, lines, room.size, self.table))

    @staticmethod
    def default(array) -> str:
        """CasADi knows one number for a whole input that is left out; where that does not do, the results are no numbers."""
        values = set(array.default or (0.0,))
        return repr(values.pop()) if len(values) == 1 else "NAN"

    # ---- functions ----

    def add_values(self) -> None:
        room = Room()
        lines, _, at = self.state(room)
        text = self.text("values", self.model.robot)
        at = self.place(room, text.robot, at)
        lines.append(text.call(at))
        for i, (a, output) in enumerate(zip(self.model.outputs, self.outputs)):
            row = rows_at(a)
            self.put(lines, i, (at[a.word] + row[where] for where in entries(output)))
        self.add(self.name, self.inputs, self.outputs, lines, room)

    def weights(self, room: Room, first: int) -> tuple[list[str], int]:
        """Statements that make vjp_v of seeds of the outputs, and where it lies."""
        rows = self.model.row_at(self.model.reverse[1])
        count = next(a.rows for a in self.model.reverse[0].inputs if a.role == "cotangent")
        begin = room.take(count)
        lines = [f"@take(w + {begin}, 0, {count});"]
        for i, (a, output) in enumerate(zip(self.model.outputs, self.outputs)):
            if a.word in rows:
                row = rows_at(a)
                table = self.table(row[where] for where in entries(output))
                lines.append(f"@add(w + {begin + rows[a.word]}, arg[{first + i}], {table}, {len(entries(output))});")
        return lines, begin

    def seeds(self, prefix: str, arrays: Sequence[Signature]) -> list[Signature]:
        return [a._replace(name=f"{prefix}_{a.name}", default="0") for a in arrays]

    def tangent_places(self, word: str, at: int, count: int = 1) -> dict[str, int]:
        """Of the arrays of tangents of a product, "jvp_v" or "vjp", side by side from `at` on."""
        return {word: at, **{f"{word}.{a.word}": at + count*self.model.tangent_at[a.word] for a in self.model.by}}

    def add_reverse(self) -> None:
        """adj1_NAME: inputs, outputs that are not read, weights of the outputs -> the same of the inputs."""
        room = Room()
        outputs, inputs = self.seeds("adj", self.inputs), [*self.inputs, *self.empty_outputs, *self.seeds("adj", self.outputs)]
        lines, x, at = self.state(room)
        d = room.take(len(self.model.numbers))
        robot = self.model.reverse[0]
        if robot is not None:
            more, at["vjp_v"] = self.weights(room, len(self.inputs) + len(self.outputs))
            g = room.take(self.model.tangent_count)
            text = self.text("reverse", robot)
            at = self.place(room, robot, {**at, **self.tangent_places("vjp", g)})
            lines += [*more, text.call(at), f"@to_numbers(w + {d}, w + {x}, w + {g}, {self.model.tangent_count});"]
        for i, a in enumerate(self.inputs):
            self.put(lines, i, range(d, d + a.shape[0]) if robot is not None else [-1]*a.shape[0])
            d += a.shape[0]
        self.add(f"adj1_{self.name}", inputs, outputs, lines, room)

    def add_forward(self) -> None:
        """fwd1_NAME: inputs, outputs that are not read, directions of the inputs -> the same of the outputs."""
        room = Room()
        outputs, inputs = self.seeds("fwd", self.outputs), [*self.inputs, *self.empty_outputs, *self.seeds("fwd", self.inputs)]
        lines, x, at = self.state(room)
        robot, words = self.model.product("jvp", self.model.words)
        if robot is not None:
            more, d = self.take(room, len(self.inputs) + len(self.outputs))
            t = room.take(self.model.tangent_count)
            at = self.place(room, robot, {**at, **self.tangent_places("jvp_v", t)})
            text = self.text("forward", robot)
            lines += [*more, f"@to_tangents(w + {t}, w + {x}, w + {d});", text.call(at)]
        rows = self.model.row_at(words)
        for i, (a, output) in enumerate(zip(self.model.outputs, self.outputs)):
            row = rows_at(a)
            self.put(lines, i, (at["jvp"] + rows[a.word] + row[where] if a.word in rows else -1 for where in entries(output)))
        self.add(f"fwd1_{self.name}", inputs, outputs, lines, room)

    def sweep(self, room: Room, kind: str, robot, plan: Plan, x: int, at: dict[str, int]):
        """Statements that compute a text of jvp along all groups of a plan; where its arrays lie by word, and a direction's
        numbers and tangents."""
        count, numbers, tangents = plan.count, len(self.model.numbers), self.model.tangent_count
        d, t, seeds = room.take(numbers), room.take(tangents), room.take(count*tangents)
        text = self.text(kind, robot, batch=True)
        wide = self.place(room, robot, self.tangent_places("jvp_v", seeds, count), count)
        lines = [f"for (int c = 0; c < {count}; c++) {{", *self.direction(plan, x, d, t),
                 f"\t@column(w + {seeds}, w + {t}, {tangents}, {count}, c);", "}"]
        for a in robot.inputs:
            if a.word in at:
                lines.append(f"@spread(w + {wide[a.word]}, w + {at[a.word]}, {a.rows}, {count});")
        return [*lines, text.call(wide, count)], wide, d, t

    def direction(self, plan: Plan, x: int, d: int, t: int) -> list[str]:
        """Statements, in a loop over groups c, that make the numbers of a direction and its tangents."""
        return [f"\tfor (int k = 0; k < {len(self.model.numbers)}; k++)", f"\t\tw[{d} + k] = {self.table(plan.group)}[k] == c;",
                f"\t@to_tangents(w + {t}, w + {x}, w + {d});"]

    def jacobian(self, room: Room, x: int, at: dict[str, int]) -> tuple[list[str], dict[tuple[int, int], int]]:
        """Statements that compute all first derivatives, and where they lie: (row, number): place."""
        lines: list[str] = []
        places: dict[tuple[int, int], int] = {}
        robot, values = self.model.direct
        if robot is not None:
            found = self.place(room, robot, at)
            where = {key: found[word] + place for key, (word, place) in values.items()}
            lines.append(self.text("direct", robot).call(found))
            places.update({(i, k): where[i, t] for k, x in enumerate(self.model.numbers) if len(x.tangents) == 1
                           for t in x.tangents for i in self.model.first[k] if (i, t) in where})
            for k, t in self.twists():
                lines += self.turned(room, x, k, t, where, places)
        plan = self.model.first_plan
        if plan.count:
            robot, words = self.model.along
            more, wide, *_ = self.sweep(room, "along", robot, plan, x, at)
            rows = self.model.row_at(words)
            for (i, k), group in plan.read.items():
                o, own = self.model.rows[i]
                places[i, k] = wide["jvp"] + (rows[self.model.outputs[o].word] + own)*plan.count + group
            lines += more
        return lines, places

    def turned(self, room: Room, x: int, first: int, tangent: int, where: dict, places: dict) -> list[str]:
        """Statements that make rows by a floating joint's numbers of those by its twist."""
        numbers = range(first, first + 7)
        rows = sorted({i for k in numbers for i in self.model.first[k] if self.model.is_direct(i, k)})
        if not rows:
            return []
        g, d = room.take(6), room.take(7*len(rows))
        table = self.table(where.get((i, tangent + k), -1) for i in rows for k in range(6))
        places.update({(i, k): d + 7*n + k - first for n, i in enumerate(rows) for k in numbers if self.model.is_direct(i, k)})
        return [f"for (int i = 0; i < {len(rows)}; i++) {{", f"\t@put(w + {g}, w, {table} + 6*i, 6);",
                f"\t@from_twist(w + {d} + 7*i, w + {x + first}, w + {g});", "}"]

    def blocks(self) -> dict[tuple[int, int], dict[tuple[int, int], tuple[int, int]]]:
        """Of each (output, input) where its first derivatives stand: (row, column) of the block: (row, number) of the model."""
        found: dict = {(o, i): {} for o in range(len(self.outputs)) for i in range(len(self.inputs))}
        places = [where for a in self.model.outputs for where in stored(a)]
        for k, rows in self.model.first.items():
            number = self.model.numbers[k]
            for row in rows:
                o = self.model.rows[row][0]
                for r, c in places[row]:
                    found[o, number.input][r + c*self.outputs[o].shape[0], number.row] = row, k
        return found

    def add_first(self) -> None:
        """jac_NAME: inputs, outputs that are not read -> for each output the derivatives by each input."""
        room = Room()
        lines, x, at = self.state(room)
        more, places = self.jacobian(room, x, at)
        lines += more
        outputs = []
        for (o, i), block in self.blocks().items():
            y, a = self.outputs[o], self.inputs[i]
            pattern = by_columns(block)
            self.put(lines, len(outputs), (places[block[where]] for where in pattern))
            outputs.append(Signature(f"jac_{y.name}_{a.name}", (y.shape[0]*y.shape[1], a.shape[0]), pattern))
        self.add(f"jac_{self.name}", [*self.inputs, *self.empty_outputs], outputs, lines, room)

    def hessian(self, room: Room, x: int, at: dict[str, int]) -> tuple[list[str], dict[tuple[int, int], int]]:
        """Statements that compute second derivatives of weighted outputs, and where they lie: (number, number): place."""
        plan, count, numbers = self.model.second_plan, self.model.second_plan.count, len(self.model.numbers)
        if not count:
            return [], {}
        more, at["vjp_v"] = self.weights(room, len(self.inputs) + len(self.outputs))
        lines, wide, d, t = self.sweep(room, "second", self.model.second, plan, x, at)
        begin, g, v = room.take(count*numbers), room.take(3*self.model.nv), room.take(3*self.model.nv)
        lines = [*more, *lines, f"for (int c = 0; c < {count}; c++) {{", f"\tfor (int k = 0; k < {3*self.model.nv}; k++) {{",
                 f"\t\tw[{g} + k] = w[{wide['jvp']} + {count}*k + c];", f"\t\tw[{v} + k] = w[{wide['vjp']} + {count}*k];", "\t}",
                 f"\t@to_numbers(w + {begin} + {numbers}*c, w + {x}, w + {g}, {3*self.model.nv});"]
        if self.model.floating:
            lines += self.direction(plan, x, d, t)
        lines += [f"\t@add_turn(w + {begin + k} + {numbers}*c, w + {x + k}, w + {d + k}, w + {t + i}, w + {v + i});"
                  for k, i in self.twists()]
        return [*lines, "}"], {key: begin + numbers*group + key[0] for key, group in plan.read.items()}

    def add_second(self) -> None:
        """jac_adj1_NAME: what adj1_NAME takes, and its outputs, not read -> of each gradient the derivatives by each of these."""
        room = Room()
        lines, x, at = self.state(room)
        more, seconds = self.hessian(room, x, at)
        lines += more
        first, firsts = self.jacobian(room, x, at)
        gradients = self.seeds("adj", self.inputs)
        inputs = [*self.inputs, *self.empty_outputs, *self.seeds("adj", self.outputs),
                  *(a._replace(name=f"out_{a.name}", pattern=[]) for a in gradients)]
        outputs: list[Signature] = []
        puts: list[str] = []
        asked: list[int] = []
        blocks, begin = self.blocks(), 0
        for i, a in enumerate(gradients):
            after = 0
            for j, b in enumerate(self.inputs):
                block = {(r, c): (begin + r, after + c) for r in range(a.shape[0]) for c in range(b.shape[0])
                         if begin + r in self.model.pairs[after + c]}
                pattern = by_columns(block)
                self.put(puts, len(outputs), (seconds.get(block[where], seconds.get(block[where][::-1])) for where in pattern))
                outputs.append(Signature(f"jac_{a.name}_{b.name}", (a.shape[0], b.shape[0]), pattern))
                after += b.shape[0]
            for y in self.empty_outputs:
                outputs.append(Signature(f"jac_{a.name}_{y.name}", (a.shape[0], y.shape[0]*y.shape[1]), []))
            for o, y in enumerate(self.outputs):
                block = {where[::-1]: key for where, key in blocks[o, i].items()}
                pattern = by_columns(block)
                self.put(puts, len(outputs), (firsts[block[where]] for where in pattern))
                asked += [len(outputs)] if pattern else []
                outputs.append(Signature(f"jac_{a.name}_adj_{y.name}", (a.shape[0], y.shape[0]*y.shape[1]), pattern))
            begin += a.shape[0]
        if first:
            lines += [f"if ({' || '.join(f'res[{k}]' for k in asked) or '0'}) {{", *("\t" + line for line in first), "}"]
        self.add(f"jac_adj1_{self.name}", inputs, outputs, [*lines, *puts], room)

    # ---- the whole ----

    def __str__(self) -> str:
        functions = "".join(self.functions)
        moves = called(self.moves(), functions)  # has a table too
        shared = called(SHARED + (FLOATING if self.model.floating else ""), moves + functions)
        known = set(re.findall(r"\w+", moves + functions))
        tables = [f"static const casadi_int {name}[] = {{\n{wrapped(key)}}};\n" for key, name in self.tables.items()
                  if name in known]
        mine = "".join([HEAD, shared, "\n", *tables, moves, functions]).replace("@", f"{self.name}_casadi_")
        texts = "\n".join(text.source for text in self.texts.values())
        return f'{self.head()}\n{texts}\n/* ---- CasADi\'s functions ---- */\n\n{mine}'

    def head(self) -> str:
        functions = [found for x in self.functions for found in re.findall(r"^int (\w+)\(const", x, re.M)]
        return f'''\
/* Functions of CasADi's C interface: {', '.join(functions)}.
 * Made by rneagen; do not edit. To compile: cc -O2 -fPIC -shared FILE.c -o FILE.so -lm; then casadi.external("{self.name}",
 * "FILE.so"), or a program's own calls; with -Dcasadi_int=int for programs in which CasADi's integers are int. What the functions
 * compute is said by the texts below, in SI units; matrices are stored column by column, without what is always zero. Functions
 * keep nothing: any number of threads may call them, each with a w of its own. */
'''
