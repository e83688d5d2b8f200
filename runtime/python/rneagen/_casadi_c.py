"""C of CasADi's functions: what all of them share, and CasADi's interface of one. For @ the file has a prefix of its own."""
from __future__ import annotations

import re
import textwrap
from typing import Any, Callable, Iterable, NamedTuple, Sequence

RESERVED = """null jac hess casadi_real casadi_int main auto break case char const continue default do double else enum
extern float for goto if inline int long register restrict return short signed sizeof static struct switch typedef union
unsigned void volatile while INFINITY NAN fpclassify gamma isfinite isgreater isgreaterequal isinf isless islessequal
islessgreater isnan isnormal isunordered j0 j1 jn signbit signgam y0 y1 yn""".split()
MATH = """acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs fdim floor fma fmax
fmin fmod frexp hypot ilogb ldexp lgamma llrint llround log log10 log1p log2 logb lrint lround modf nan nearbyint nextafter
nexttoward pow remainder remquo rint round scalbln scalbn sin sinh sqrt tan tanh tgamma trunc""".split()

HEAD = '''\
#include <math.h>

#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int long long int
#endif
'''

SHARED = '''
/* Zeros where CasADi gives no array. */
static inline void @take(double *to, const double *from, casadi_int count)
{
	for (casadi_int k = 0; k < count; k++)
		to[k] = from ? from[k] : 0;
}

/* To places in `to`, some of which are the same. */
static inline void @add(double *to, const double *from, const casadi_int *at, casadi_int count)
{
	for (casadi_int k = 0; from && k < count; k++)
		to[at[k]] += from[k];
}

/* From places in `from`; -1: zero. */
static inline void @put(double *to, const double *from, const casadi_int *at, casadi_int count)
{
	for (casadi_int k = 0; to && k < count; k++)
		to[k] = at[k] < 0 ? 0 : from[at[k]];
}

/* Column `column` of `columns`. */
static inline void @column(double *to, const double *from, casadi_int rows, casadi_int columns, casadi_int column)
{
	for (casadi_int i = 0; i < rows; i++)
		to[i*columns + column] = from[i];
}

/* All columns. */
static inline void @spread(double *to, const double *from, casadi_int rows, casadi_int columns)
{
	for (casadi_int i = 0; i < rows*columns; i++)
		to[i] = from[i/columns];
}
'''

FLOATING = '''
/* A floating joint: q is a position p and a quaternion u = (v, s) of any length, a twist is (a, b). It moves p by
   R(u/|u|) a, u by u (b, 0)/2. */
static inline double @length2(const double *q)
{
	return q[3]*q[3] + q[4]*q[4] + q[5]*q[5] + q[6]*q[6];
}

static inline void @unit(double *to, const double *q)
{
	const double length = sqrt(@length2(q));

	for (int k = 0; k < 7; k++)
		to[k] = k < 3 ? q[k] : q[k]/length;
}

static inline void @cross(double *to, const double *a, const double *b)
{
	to[0] = a[1]*b[2] - a[2]*b[1];
	to[1] = a[2]*b[0] - a[0]*b[2];
	to[2] = a[0]*b[1] - a[1]*b[0];
}

/* R a, or with sign -1 R' a */
static inline void @turn(double *to, const double *q, const double *a, double sign)
{
	const double f = 2/@length2(q), s = sign*q[6];
	double across[3], again[3];

	@cross(across, q + 3, a);
	@cross(again, q + 3, across);
	for (int k = 0; k < 3; k++)
		to[k] = a[k] + f*(s*across[k] + again[k]);
}

/* The transposed inverse of what a turn b makes of a quaternion u: f (s b + v x b, -v.b), f = 2/|u|^2 */
static inline void @quaternion(double *to, const double *u, const double *b, double f)
{
	@cross(to, u, b);
	for (int k = 0; k < 3; k++)
		to[k] = f*(u[3]*b[k] + to[k]);
	to[3] = -f*(u[0]*b[0] + u[1]*b[1] + u[2]*b[2]);
}

/* The twist that numbers d of q make. */
static inline void @to_twist(double *t, const double *q, const double *d)
{
	const double f = 2/@length2(q), *v = q + 3, *e = d + 3;

	@turn(t, q, d, -1);
	@cross(t + 3, v, e);
	for (int k = 0; k < 3; k++)
		t[3 + k] = f*(v[3]*e[k] - e[3]*v[k] - t[3 + k]);
}

/* A gradient by the numbers of q, from that by a twist. */
static inline void @from_twist(double *d, const double *q, const double *g)
{
	@turn(d, q, g, 1);
	@quaternion(d + 3, q + 3, g + 3, 2/@length2(q));
}

/* What that gradient varies by with the same g, along numbers d of q and their twist t: added to `to`. */
static inline void @add_turn(double *to, const double *q, const double *d, const double *t, const double *g)
{
	const double f = 2/@length2(q), along = q[3]*d[3] + q[4]*d[4] + q[5]*d[5] + q[6]*d[6];
	double across[3], turned[3], e[4], u[4];

	@cross(across, t + 3, g);
	@turn(turned, q, across, 1);
	@quaternion(e, d + 3, g + 3, f);
	@quaternion(u, q + 3, g + 3, f*f*along);
	for (int k = 0; k < 7; k++)
		to[k] += k < 3 ? turned[k] : e[k - 3] - u[k - 3];
}
'''


class Signature(NamedTuple):
    """Of an array: `pattern` is (row, column), column by column; None: all of it, []: nothing. `default`: each number of an input
    that is left out, in C."""
    name: str
    shape: tuple[int, int]
    pattern: Sequence[tuple[int, int]] | None = None
    default: str = "0"


def entries(array: Signature) -> Sequence[tuple[int, int]]:
    lines, columns = array.shape
    return [(i, j) for j in range(columns) for i in range(lines)] if array.pattern is None else array.pattern


def called(functions: str, by: str) -> str:
    """Those that `by`, or one of these, calls."""
    found = ""
    for function in reversed(re.findall(r".*?\n}\n", functions, re.S)):
        name = re.search(r"@\w+\(", function)
        if name and name[0] in by + found:
            found = function + found
    return found


def by_columns(places: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    return sorted(places, key=lambda at: at[::-1])


def identifier(name: str) -> str:
    """As CasADi wants it: no double underscores, and none at the ends."""
    return re.sub("__+", "_", re.sub(r"\W", "_", name, flags=re.ASCII)).strip("_")


def is_taken(name: str) -> bool:
    """By C, its <math.h>, where functions of float and long double end in f and l, or CasADi."""
    return name in RESERVED or name in MATH or (name[-1:] in ("f", "l") and name[:-1] in MATH)


def wrapped(values: Iterable[Any], indent: str = "\t") -> str:
    """A list's lines."""
    return textwrap.fill(", ".join(map(str, values)), 118, initial_indent=indent, subsequent_indent=indent,
                         break_long_words=False, break_on_hyphens=False)


def listed(kind: str, stored: str, name: str, array: str, values: Sequence[str]) -> str:
    """A function that gives the value with a number, 0 beyond the last one."""
    lines = wrapped(values, "\t\t") or "\t\t0"
    return f'''\
{kind}{name}(casadi_int i)
{{
	static {stored}{array}[] = {{
{lines}}};

	return i >= 0 && i < {max(1, len(values))} ? {array}[i] : 0;
}}
'''


def interface(name: str, inputs: Sequence[Signature], outputs: Sequence[Signature], statements: Sequence[str], size: int,
              table: Callable[[Iterable[int]], str]) -> str:
    """A function by its statements, and what CasADi asks of it; `size` of w. `table` gives names of tables."""
    text, pattern = "const char *", "const casadi_int *"
    asked = [listed("casadi_real ", "const double ", f"{name}_default_in", "values", [a.default for a in inputs])]
    for end, arrays in (("in", inputs), ("out", outputs)):
        asked.append(listed(text, f"{text}const ", f"{name}_name_{end}", "names", [f'"{a.name}"' for a in arrays]))
    for end, arrays in (("in", inputs), ("out", outputs)):
        patterns = [table(compressed(a)) for a in arrays]
        asked.append(listed(pattern, f"{pattern}const ", f"{name}_sparsity_{end}", "patterns", patterns))
    answers = "\n".join(asked)
    body = "\n".join("\t" + line for line in statements)
    return f'''
/*
{wrapped(map(shown, inputs), " * ")} ->
{wrapped(map(shown, outputs), " * ")}
 */
int {name}(const casadi_real **arg, casadi_real **res, casadi_int *iw, casadi_real *w, int mem)
{{
	(void)arg, (void)res, (void)iw, (void)w, (void)mem;
{body}
	return 0;
}}

int {name}_alloc_mem(void) {{ return 0; }}
int {name}_init_mem(int mem) {{ return (void)mem, 0; }}
void {name}_free_mem(int mem) {{ (void)mem; }}
int {name}_checkout(void) {{ return 0; }}
void {name}_release(int mem) {{ (void)mem; }}
void {name}_incref(void) {{ }}
void {name}_decref(void) {{ }}
casadi_int {name}_n_in(void) {{ return {len(inputs)}; }}
casadi_int {name}_n_out(void) {{ return {len(outputs)}; }}

{answers}
int {name}_work(casadi_int *sz_arg, casadi_int *sz_res, casadi_int *sz_iw, casadi_int *sz_w)
{{
	if (sz_arg)
		*sz_arg = {len(inputs)};
	if (sz_res)
		*sz_res = {len(outputs)};
	if (sz_iw)
		*sz_iw = 0;
	if (sz_w)
		*sz_w = {size};
	return 0;
}}
'''


def shown(array: Signature) -> str:
    return array.name + "".join(f"[{n}]" for n in array.shape if n != 1)


def compressed(array: Signature) -> list[int]:
    """CasADi's compressed columns."""
    lines, columns = array.shape
    found = entries(array)
    begins = [sum(c < j for _, c in found) for j in range(columns + 1)]
    return [lines, columns, *begins, *(r for r, _ in found)]
