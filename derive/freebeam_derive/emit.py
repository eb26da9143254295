"""Kernel graphs written as NumPy modules: the only place that knows NumPy's syntax.

The text depends on the graph alone: no timestamp, no path, no hash order. What reads it is the runtime, or anyone
who takes the one file into a code of their own; it imports NumPy and nothing else.
"""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Iterable
from functools import reduce
from typing import Any

from sympy import (
    Expr,
    Inverse,
    MatMul,
    Max,
    Piecewise,
    Poly,
    Pow,
    S,
    Symbol,
    cancel,
    cos,
    cse,
    expand,
    factor,
    fraction,
    integrate,
    lcm,
    numbered_symbols,
    sin,
    together,
)
from sympy.printing.pycode import PythonCodePrinter

from freebeam_derive.kernel import (
    QUANTITIES,
    ColumnKernel,
    Kernel,
    MatrixProgram,
    PolynomialKernel,
    SeriesProgram,
    delta,
)
from freebeam_derive.legendre import products, series
from freebeam_derive.modes import eta
from freebeam_derive.newmark import Newmark
from freebeam_derive.notation import NOTATION, gamma, x
from freebeam_derive.scaling import SCALES, UNITS
from freebeam_derive.statement import GEOMETRIC, StatementError, jets

INDENT = "    "
WIDTH = 110
_EXACT = (2, 4, 8, 16, 32, 64)  # denominators that a float holds exactly


class _Printer(PythonCodePrinter):  # type: ignore[misc]
    """SymPy to NumPy on arrays of modes (f), of pairs of modes (f_i a column, f_j a row) and matrices."""

    def __init__(self) -> None:
        super().__init__({"fully_qualified_modules": False, "allow_unknown_functions": True})

    def _function(self, name: str, e: Expr) -> str:
        return f"np.{name}({self._print(e.args[0])})"

    def _print_sin(self, e: Expr) -> str:
        return self._function("sin", e)

    def _print_cos(self, e: Expr) -> str:
        return self._function("cos", e)

    def _print_exp(self, e: Expr) -> str:
        return self._function("exp", e)

    def _print_Rational(self, e: Expr) -> str:
        return repr(float(e)) if e.q in _EXACT else f"{e.p} / {e.q}"

    def _print_Mul(self, e: Expr) -> str:
        number, rest = e.as_coeff_Mul()
        if number.is_Rational and number.q not in (1, *_EXACT):
            # division rounds once, and is exact in exact numbers
            return f"{self.parenthesize(number.p * rest, 50)} / {number.q}"
        return str(super()._print_Mul(e))

    def parenthesize(self, item: Expr, level: int, strict: bool = False) -> str:
        if item.is_Rational and item >= 0 and item.q in _EXACT:
            return str(self._print(item))
        return str(super().parenthesize(item, level, strict))

    def _print_Piecewise(self, e: Piecewise) -> str:
        text = str(self._print(e.args[-1][0]))
        for value, condition in reversed(e.args[:-1]):
            text = f"{self._print(value)} if {self._print(condition)} else {text}"
        return text

    def _print_Infinity(self, e: Expr) -> str:
        return "np.inf"

    def _print_Pi(self, e: Expr) -> str:
        return "np.pi"

    def _print_Symbol(self, e: Symbol) -> str:
        name = str(e.name)
        if name.endswith("_i"):
            return f"{name[:-2]}[:, None]"
        return name[:-2] if name.endswith("_j") else name

    def _print_Pow(self, e: Expr, rational: bool = False) -> str:
        base, power = e.as_base_exp()
        if power == S.Half:
            return f"np.sqrt({self._print(base)})"
        if power.is_Integer and power > 2:
            # products of squares: NumPy's general power is slow and less exact
            half = self.parenthesize(e.func(base, power // 2), 60) if power > 3 else None
            printed = self.parenthesize(base, 60)
            if half is None:
                return f"{printed} * {printed} * {printed}"
            return f"{half}**2" + (f" * {printed}" if power % 2 else "")
        return str(super()._print_Pow(e, rational=rational))

    def _print_MatrixSymbol(self, e: Expr) -> str:
        return str(e.name)

    def _print_MatMul(self, e: MatMul) -> str:
        scalar, matrices = e.as_coeff_matrices()
        if isinstance(matrices[0], Inverse):
            # one linear solve, never an inverse formed
            product = f"np.linalg.solve({self._print(matrices[0].arg)}, {self._print(MatMul(*matrices[1:]).doit())})"
        else:
            product = " @ ".join(self.parenthesize(m, 50) for m in matrices)
        if scalar == 1:
            return product
        if scalar == -1:
            return f"-{product}" if len(matrices) == 1 else f"-({product})"
        factor = self.parenthesize(scalar, 50)
        return f"{factor} * {product}" if len(matrices) == 1 else f"{factor} * ({product})"

    def _print_MatAdd(self, e: Expr) -> str:
        text = ""
        for term in e.args:
            printed = self._print(term)
            text += f" - {printed[1:]}" if text and printed.startswith("-") else f" + {printed}" if text else printed
        return text


def _code(expression: Expr) -> str:
    text = str(_Printer().doprint(expression))
    return re.sub(r" *(?<!\*)([*/])(?!\*) *", r" \1 ", text)


def _shared(assignments: list[tuple[str, Expr]]) -> list[str]:
    """Assignments with their common parts computed once."""
    shared, reduced = cse([e for _, e in assignments], symbols=numbered_symbols("shared_", start=1), order="canonical")
    named = [*((str(s), e) for s, e in shared), *((name, e) for (name, _), e in zip(assignments, reduced, strict=True))]
    return [f"{name} = {_code(e)}" for name, e in named]


def _equation(kernel: ColumnKernel) -> str:
    """The characteristic equation as text."""
    equation = kernel.beam.equation
    return f"{equation.lhs} = {equation.rhs}".replace("gamma", "γ").replace("*", " ")


def _literal(value: Any, indent: int = 0) -> str:
    """A constant as source text, with double quotes, a line an entry where it is long."""
    if isinstance(value, str) and len(value) + indent > 90 and indent:
        pieces = textwrap.wrap(value, 90 - indent, drop_whitespace=False, break_on_hyphens=False)
        inner = "".join(f"{' ' * (indent + 4)}{_literal(piece)}\n" for piece in pieces)
        return f"(\n{inner}{' ' * indent})"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, dict | list | tuple):
        opening, closing = {dict: ("{", "}"), list: ("[", "]"), tuple: ("(", ")")}[type(value)]
        items = (
            [f"{_literal(k)}: {_literal(v, indent + 4)}" for k, v in value.items()]
            if isinstance(value, dict)
            else [_literal(v, indent + 4) for v in value]
        )
        flat = opening + ", ".join(items) + ("," if isinstance(value, tuple) and len(items) == 1 else "") + closing
        if len(flat) + indent < 80 and "\n" not in flat:
            return flat
        inner = "".join(f"{' ' * (indent + 4)}{item},\n" for item in items)
        return f"{opening}\n{inner}{' ' * indent}{closing}"
    return repr(value)


def _powers(expressions: Iterable[Expr]) -> tuple[list[str], dict[Expr, Expr]]:
    """Statements for the powers of γ that expressions hold, and what to put in their place."""
    needed = {
        int(p.exp) for e in expressions for p in e.atoms(Pow) if p.base == gamma and p.exp.is_Integer and p.exp > 1
    }
    lines: list[str] = []
    names: dict[int, str] = {1: "gamma"}
    highest = max(needed, default=1)
    for n in range(2, highest + 1):
        # each power from two known ones
        if n in needed or any(n < m for m in needed):
            half = n // 2
            names[n] = f"gamma{n}"
            lines.append(f"gamma{n} = {names[n - half]} * {names[half]}")
    keep = set(needed)
    for n in range(highest, 1, -1):
        if n in keep:
            keep |= {n // 2, n - n // 2}
    lines = [line for line in lines if int(line.split(" = ")[0][5:]) in keep]
    return lines, {gamma**n: Symbol(names[n], real=True) for n in keep if n > 1}


def _body(lines: Iterable[str]) -> str:
    return "".join(f"{INDENT}{part}\n" for line in lines for part in _wrapped(line))


def _wrapped(line: str) -> list[str]:
    """A statement of one line, broken in brackets before its outermost sums or else products where it is too long."""
    name, equals, expression = line.partition(" = ")
    if len(line) + len(INDENT) <= WIDTH or not equals:
        return [line]
    depth, breaks = 0, {"+-": [0], "*": [0], "if": [0]}
    for n, letter in enumerate(expression):
        depth += (letter in "([") - (letter in ")]")
        if depth == 0:
            for kind, places in breaks.items():
                if any(expression.startswith(f" {mark} ", n) for mark in (kind.split() if kind == "if" else kind)):
                    places.append(n + 1)
            if expression.startswith(" else ", n):
                breaks["if"].append(n + 1)
    chosen = next((breaks[kind] for kind in ("if", "+-", "*") if len(breaks[kind]) > 1), [0])
    parts = [expression[a:b].strip() for a, b in zip(chosen, [*chosen[1:], len(expression)], strict=True)]
    indent = line[: len(line) - len(line.lstrip())]
    return [f"{name} = (", *(f"{indent}    {part}" for part in parts), f"{indent})"]


def _docstring(text: str, indent: str = INDENT) -> str:
    text = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')  # what a user wrote stays as it was
    paragraphs = [
        textwrap.fill(line, WIDTH - len(indent), subsequent_indent=" " * (len(line) - len(line.lstrip())))
        for line in text.strip().split("\n")
    ]
    body = "\n".join(paragraphs)
    if "\n" not in body and len(body) + len(indent) + 6 <= WIDTH:
        return f'{indent}"""{body}"""\n'
    return textwrap.indent(f'"""{body}\n"""', indent, lambda line: bool(line.strip())) + "\n"


# --- parts of a module --------------------------------------------------------------------------------------


def _header(kernel: Kernel, functions: str, more: str) -> str:
    column = kernel.column
    letters = "\n".join(f"    {m.letter}[i, j] = {m.text}" for m in kernel.matrices)
    source = f"Source: {column.source}.\n\n" if column.source else ""
    text = (
        f"{column.title}: ends {column.ends[0]} and {column.ends[1]}.\n\n"
        f"M q̈ + C q̇ + (E + P H) q = F_0 Q with trial functions that are {functions}, Eqs. (10), (11):\n\n"
        f"{letters}\n    C = {kernel.system.c_M} M + {kernel.system.c_E} E\n\n"
        f"{more} All quantities are nondimensional, Eq. (5).\n\n"
        f"{source}Derived from the energies and emitted by `freebeam generate {column.name}`; do not edit."
    )
    return _docstring(text, "") + (
        "\nfrom __future__ import annotations\n\nfrom typing import Any, NamedTuple\n\nimport numpy as np\n"
        "from numpy.typing import ArrayLike, NDArray\n\nArray = NDArray[np.floating[Any]]\n"
    )


def _metadata(kernel: Kernel, names: tuple[str, ...], more: dict[str, str]) -> str:
    column = kernel.column
    own = [
        {
            "name": p.name,
            "latex": p.latex or p.name,
            "meaning": p.meaning,
            "default": float(p.default),
            "low": float(p.low),
            "high": float(p.high),
        }
        for p in column.parameters
    ]
    data = {
        "name": column.name,
        "title": column.title,
        **more,
        "ends": column.ends,
        "rigid": len(kernel.rigid),
        "load": "P",
        "damping": list(column.damping),
        "force": bool(kernel.system.forces),
        "parameters": own,
        "forms": {m.letter: m.text for m in kernel.matrices},
        "latex": {name: NOTATION[name].latex for name in names},
        "meaning": {name: NOTATION[name].meaning for name in names},
        "source": column.source,
    }
    return "COLUMN: dict[str, Any] = " + _literal(data) + "\n"


def _basis(kernel: ColumnKernel) -> str:
    program = kernel.basis
    corrected = program.roots.function is not None
    fields = [
        ("gamma", "root of the characteristic equation, Eq. (21)"),
        ("quarter", "asymptote of the root in units of π/4"),
        *([("delta", "root less its asymptote")] if corrected else []),
        ("sigma", "sign (−1)^(n−1)"),
        *((name, meaning) for name, _, meaning in program.fields),
        ("turn", "π/4"),
    ]
    listing = "\n".join(f"{name}: {meaning}" for name, meaning in fields)
    text = "class Basis(NamedTuple):\n"
    text += _docstring(f"The first N modes: each field of shape (N,), but for `turn`.\n\n{listing}\n") + "\n"
    text += "".join(f"{INDENT}{name}: {'Any' if name == 'turn' else 'Array'}\n" for name, _ in fields)
    if corrected:
        text += "\n\n" + _characteristic(kernel)
    given = (
        "quarter: Array, sigma: Array, delta: Array, turn: Any"
        if corrected
        else "quarter: Array, sigma: Array, turn: Any"
    )
    text += f"\n\ndef complete({given}) -> Basis:\n" + _docstring(
        "All that is known of the modes, from their roots γ = quarter · turn + delta. Eq. (22).\n\n"
        "The arrays may hold floats, or any numbers that know `exp`, such as intervals: then so does the result.\n"
        if corrected
        else "All that is known of the modes, from their roots γ = quarter · turn. Eq. (22).\n"
    )
    lines = ["gamma = quarter * turn" + (" + delta" if corrected else "")]
    if any(e.has(eta) for _, e, _ in program.fields) or program.common:
        lines.append("tail = sigma * np.exp(-gamma)")
    lines += [f"{name} = {_code(value)}" for name, value in program.common]
    lines += _shared([(name, value) for name, value, _ in program.fields])
    lines.append(f"return Basis({', '.join(name for name, _ in fields)})")
    text += _body(lines) + "\n\ndef basis(N: int) -> Basis:\n"
    how = (
        "asymptotes, corrected by Newton's method, so that there is no table to run out of.\n"
        if corrected
        else "known in closed form.\n"
    )
    text += _docstring(
        f"The first N modes of the unloaded, undamped beam. Eqs. (19)-(22).\n\nRoots of {_equation(kernel)}: {how}"
    )
    lines = [
        "n = np.arange(N, dtype=float)",
        f"quarter = {program.roots.first} + 4 * n",
        "sigma = 1 - 2 * np.remainder(n, 2)",
    ]
    if not corrected:
        return text + _body([*lines, "return complete(quarter, sigma, np.pi / 4)"])
    assert program.roots.start is not None
    lines += [
        "asymptote = quarter * (np.pi / 4)",
        "epsilon = np.exp(-asymptote)",
        f"delta = {_code(program.roots.start)}",
        f"for _ in range({program.roots.iterations}):",
        "    value, slope = characteristic(delta, asymptote, sigma)",
        "    delta = delta - value / slope",
        "return complete(quarter, sigma, delta, np.pi / 4)",
    ]
    return text + _body(lines)


def _characteristic(kernel: ColumnKernel) -> str:
    """The characteristic function, which is zero at a root, and its derivative."""
    roots = kernel.basis.roots
    assert roots.function is not None and roots.derivative is not None
    sine, cosine = Symbol("sine", real=True), Symbol("cosine", real=True)
    written = [e.subs({sin(delta): sine, cos(delta): cosine}) for e in (roots.function, roots.derivative)]
    lines = ["epsilon = np.exp(-asymptote - delta)"]
    for symbol, name in ((sine, "sin"), (cosine, "cos")):
        if any(e.has(symbol) for e in written):
            lines.append(f"{symbol} = np.{name}(delta)")
    lines += [*_shared([("value", written[0]), ("slope", written[1])]), "return value, slope"]
    doc = (
        f"{_equation(kernel)} at γ = asymptote + delta, written so that no digits cancel, and its slope in delta. "
        "Eq. (21).\n"
    )
    head = "def characteristic(delta: Array, asymptote: Array, sigma: Array) -> tuple[Array, Array]:\n"
    return head + _docstring(doc) + _body(lines)


def _shapes(kernel: ColumnKernel) -> str:
    A, B, C, D = kernel.basis.coefficients
    rigid = kernel.rigid
    column = "basis.{}[:, None]"
    corrected = kernel.basis.roots.function is not None

    def factor(c: Expr) -> str:
        return "" if c == 1 else "-" if c == -1 else (column.format(c) if c.is_Symbol else _code(c)) + " * "

    trig = []
    if A != 0:
        trig.append(factor(A) + "rotated[0]")
    if B != 0:
        trig.append(factor(B) + "rotated[1]")
    doc = (
        "Modes or a derivative of them, shape (N, *x.shape). Eq. (22).\n\n"
        "x: places in units of the length, any shape. derivative: its order, 0 or more. "
        + (
            f"rigid: put the {len(rigid)} rigid function{'s' if len(rigid) > 1 else ''} first, "
            f"shape ({len(rigid)} + N, *x.shape)."
            if rigid
            else "rigid: this column has no rigid functions, so it changes nothing."
        )
        + "\n\nsinh and cosh are written in decaying exponentials, and whole turns are struck off γ x exactly, "
        "so that no digits cancel in high modes.\n"
    )
    lines = [
        "x = np.asarray(x, dtype=float)",
        "place = x.reshape(1, -1)",
        "gamma, quarter = basis.gamma[:, None], basis.quarter[:, None]",
        "coarse = np.round(place * 2.0**26) * 2.0**-26  # quarter * coarse is exact",
        "turns = quarter * coarse",
        "turns = turns - 8 * np.round(turns / 8)",
        "phase = (turns + quarter * (place - coarse)) * basis.turn"
        + (" + basis.delta[:, None] * place" if corrected else ""),
        "sine, cosine = np.sin(phase), np.cos(phase)",
        "rotated = ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))[derivative % 4]",
        f"value: Array = {' + '.join(trig)}",
    ]
    if C != 0:
        lines.append(f"value = value + (-1) ** (derivative % 2) * {factor(C)}np.exp(-gamma * place)")
    if D != 0:
        lines.append(f"value = value + {factor(D)}np.exp(-gamma * (1 - place))")
    lines.append("value = value * gamma**derivative if derivative else value")
    if rigid:
        lines.append("if rigid:")
        lines.append("    value = np.concatenate([_rigid_shapes(place, derivative), value])")
    lines.append("return value.reshape(-1, *x.shape)")
    signature = "def shapes(basis: Basis, x: ArrayLike, derivative: int = 0, rigid: bool = False) -> Array:\n"
    text = signature + _docstring(doc) + _body(lines)
    if rigid:
        coefficients = tuple(tuple(float(c) for c in reversed(Poly(f, x).all_coeffs())) for f in rigid)
        body = (
            f"RIGID = {coefficients!r}  # coefficients of 1, x, …: roots γ = 0\n\n\n"
            "def _rigid_shapes(place: Array, derivative: int) -> Array:\n"
            + _docstring("Rigid functions or a derivative of them; place (1, n), result (R, n).")
            + f"{INDENT}polynomials = [np.polynomial.polynomial.polyder(np.array(c), derivative) for c in RIGID]\n"
            f"{INDENT}rows = [np.polynomial.polynomial.polyval(place[0], c) for c in polynomials]\n"
            f"{INDENT}return np.array(rows, dtype=float)\n\n\n"
        )
        text = body + text
    return text


def _apart(kernel: ColumnKernel) -> str:
    corrected = kernel.basis.roots.function is not None
    lines = [f"{name} = basis.{name}" for name in ("gamma", "quarter", *(["delta"] if corrected else []))]
    lines += [
        "squares = gamma * gamma",
        "difference = (quarter[:, None] - quarter) * basis.turn" + (" + (delta[:, None] - delta)" if corrected else ""),
        "difference = difference * (gamma[:, None] + gamma) * (squares[:, None] + squares)",
        "difference.reshape(-1)[:: gamma.size + 1] = np.inf",
        "inverse: Array = 1 / difference",
        "return inverse",
    ]
    doc = (
        "1 / (γᵢ⁴ − γⱼ⁴), zero for i = j, shape (N, N).\n\n"
        "The roots are subtracted before they are rounded: asymptotes and corrections apart.\n"
    )
    return "def _apart(basis: Basis) -> Array:\n" + _docstring(doc) + _body(lines)


def _signature(kernel: Kernel, name: str, arguments: str = "") -> str:
    """Every matrix takes all of the column's own parameters, so that a caller need not know which it depends on."""
    return f"def {name}(basis: Basis{arguments}, rigid: bool = False{_own(kernel)}) -> Array:\n"


def _own_doc(kernel: Kernel) -> str:
    return "".join(f"\n{p.name}: {p.meaning}." for p in kernel.column.parameters)


def _matrix_head(kernel: Kernel, matrix: MatrixProgram | SeriesProgram) -> str:
    """Signature and docstring of a matrix."""
    R = len(kernel.rigid)
    what = {
        "M": "Mass matrix M",
        "E": "Elastic stiffness matrix E of K = E + P H",
        "H": "Load matrix H of K = E + P H",
    }[matrix.letter]
    shape = f"(N, N), or ({R} + N, {R} + N) with the rigid functions first" if R else "(N, N)"
    doc = f"{what}, shape {shape}, nondimensional. {matrix.equation}.\n\n"
    doc += f"{matrix.letter}[i, j] = {matrix.text}\n{_own_doc(kernel)}"
    if matrix.letter == "H":
        doc = (
            doc.rstrip()
            + "\n\nRow i is the test function. The end term is transposed in the paper as printed: docs/errata.md.\n"
            if kernel.column.name == "free-free"
            else doc
        )
    return _signature(kernel, matrix.name) + _docstring(doc)


def _matrix(kernel: ColumnKernel, matrix: MatrixProgram) -> str:
    R = len(kernel.rigid)
    modes = [e for _, e in matrix.mode_statements]
    border = [*matrix.rows, *matrix.columns]
    powers, replace = _powers([*modes, matrix.diagonal, *border])
    lines: list[str] = []
    every = (*modes, matrix.diagonal, *border, *(e for _, e in matrix.pair_statements), *matrix.entry)
    held = {str(s).removesuffix("_i").removesuffix("_j") for e in every for s in e.free_symbols}
    known = ["gamma", "sigma", *(name for name, _, _ in kernel.basis.fields)]
    for name in known:
        if name in held or (name == "gamma" and powers):
            lines.append(f"{name} = basis.{name}")
    lines += powers
    lines += [
        f"{name} = {_code(e.xreplace(replace))}"
        for name, e in matrix.mode_statements
        if e.xreplace(replace) != Symbol(name, real=True)
    ]
    diagonal = _code(matrix.diagonal.xreplace(replace))
    letter = matrix.letter
    if not any(matrix.entry):
        full = diagonal if not matrix.diagonal.is_number else f"np.full(basis.gamma.size, {diagonal})"
        lines.append(f"{letter}: Array = np.diag({full})")
    else:
        lines += [f"{name} = {_code(e)}" for name, e in matrix.pair_statements]
        lines += _horner(letter, matrix.entry)
        lines.append(f"{letter}.reshape(-1)[:: basis.gamma.size + 1] = {diagonal}")
    if R:
        lines.append("if rigid:")
        lines.append(f"    whole = np.zeros(({R} + basis.gamma.size,) * 2)")
        lines.append(f"    whole[{R}:, {R}:] = {letter}")
        corner = [[_float(c) for c in row] for row in matrix.corner]
        if any(c != 0 for row in matrix.corner for c in row):
            lines.append(
                f"    whole[:{R}, :{R}] = np.array([{', '.join('[' + ', '.join(row) + ']' for row in corner)}])"
            )
        for n, (row, column) in enumerate(zip(matrix.rows, matrix.columns, strict=True)):
            if row != 0:
                lines.append(f"    whole[{n}, {R}:] = {_code(row.xreplace(replace))}")
            if column != 0:
                lines.append(f"    whole[{R}:, {n}] = {_code(column.xreplace(replace))}")
        lines.append("    return whole")
    lines.append(f"return {letter}")
    return _matrix_head(kernel, matrix) + _body(lines)


def _horner(letter: str, parts: tuple[Expr, ...]) -> list[str]:
    """Σ parts[n] apartⁿ, a line a power."""
    if len(parts) == 1:
        return [f"{letter}: Array = {_code(parts[0])}"]
    lines = ["apart = _apart(basis)"]
    for n in range(len(parts) - 1, -1, -1):
        annotated = f"{letter}: Array" if n == len(parts) - 1 else letter
        if n == len(parts) - 1:
            lines.append(f"{annotated} = {_code(parts[n])}")
        elif parts[n] == 0:
            lines.append(f"{letter} = {letter} * apart")
        else:
            written = _code(parts[n])
            added = (
                f"- {written[1:]}"
                if written.startswith("-") and parts[n].is_Mul
                else f"+ ({written})"
                if parts[n].is_Add
                else f"+ {written}"
            )
            lines.append(f"{letter} = {letter} * apart {added}")
    return lines


def _damping(kernel: Kernel) -> str:
    system = kernel.system
    passed = "".join(f", {p.name}={p.name}" for p in kernel.column.parameters)
    text = f"def damping_factors(alpha: float, beta: float{_own(kernel)}) -> tuple[float, float]:\n"
    text += _docstring("c_M and c_E of C = c_M M + c_E E: the external and the internal damping. Eq. (12).")
    text += f"{INDENT}return {_float(system.c_M)}, {_float(system.c_E)}\n\n\n"
    text += _signature(kernel, "damping", ", alpha: float, beta: float")
    text += _docstring(
        f"Damping matrix C = c_M M + c_E E with c_M = {system.c_M}, c_E = {system.c_E}, nondimensional. "
        "Eqs. (11), (12)."
    )
    text += f"{INDENT}c_M, c_E = damping_factors(alpha, beta{passed})\n"
    return text + f"{INDENT}return c_M * mass(basis, rigid{passed}) + c_E * stiffness_elastic(basis, rigid{passed})\n"


def _own(kernel: Kernel, used: set[str] | None = None) -> str:
    """The column's own parameters as keyword arguments."""
    chosen = [p for p in kernel.column.parameters if used is None or p.name in used]
    return (", *" if chosen else "") + "".join(f", {p.name}: float = {float(p.default)!r}" for p in chosen)


def _float(e: Expr) -> str:
    return _code(e) if not e.is_number else repr(float(e))


def _force(kernel: Kernel) -> str:
    if not kernel.system.forces:
        return ""
    ((_, size),) = kernel.system.forces
    factor = "" if size == 1 else f"{_code(size)} * "
    doc = (
        "Generalised force Q of Q F_0(t), shape (N,) or with the rigid functions first, nondimensional. "
        "Eq. (11), last line.\n\nQ[i] = φᵢ(x_F)\n\nx_F: place of the transversal force, 0 to 1.\n"
    )
    return (
        "def force(basis: Basis, x_F: float, rigid: bool = False) -> Array:\n"
        + _docstring(doc)
        + f"{INDENT}return {factor}shapes(basis, x_F, rigid=rigid)\n"
    )


def _frequencies(kernel: ColumnKernel) -> str:
    if kernel.damped is None:
        return ""
    half, product = kernel.damped.half, kernel.damped.product
    used = {str(s) for e in (half, product) for s in e.free_symbols}
    arguments = f"gamma: Array, alpha: float = 0.0, beta: float = 0.0{_own(kernel, used)}"
    text = f"def frequencies({arguments}) -> tuple[Any, Any]:\n"
    text += _docstring(
        "Both eigenvalues λ₀ of each mode of the unloaded beam, complex, each (N,), nondimensional. Eq. (23).\n\n"
        "The imaginary part is the damped frequency; where it vanishes the mode is overdamped. The first comes from "
        "the product of both, so that no digits cancel in heavy damping.\n"
    )
    lines = ["gamma = np.asarray(gamma, dtype=complex)", *_shared([("half", half), ("product", product)])]
    lines += ["second = -half - np.sqrt(half * half - product)", "return product / second, second"]
    return text + _body(lines)


def _exact(expression: Expr) -> str:
    """Code in which a fraction that no float holds is made from `one`, a number of the caller's kind."""
    kept = (1, *_EXACT)
    return _code(expression.replace(lambda e: e.is_Rational and e.q not in kept, lambda e: Symbol("one") * e))


def _forms(kernel: Kernel) -> str:
    """The bilinear forms as data."""
    text = f"def forms(one: Any = 1{_own(kernel).replace(': float = ', ': Any = ')}) -> dict[str, Any]:\n"
    text += _docstring(
        "The bilinear forms M, E, H: factors of ∫ xᵏ φᵢ⁽ᵖ⁾ φⱼ⁽ᑫ⁾ dx under (k, p, q), and of φᵢ⁽ᵖ⁾(a) φⱼ⁽ᑫ⁾(b) under "
        "(a, p, b, q). Eq. (11).\n\none: 1 as a number of the kind wanted, such as a fraction or an interval.\n"
    )
    lines = ["return {"]
    for letter, form in (("M", kernel.system.M), ("E", kernel.system.E), ("H", kernel.system.H)):
        along = ", ".join(f"{key}: {_exact(value)}" for key, value in sorted(form.along.items()))
        points = ", ".join(f"({a}, {p}, {b}, {q}): {_exact(value)}" for (a, p, b, q), value in form.points.items())
        lines.append(f'    "{letter}": ({{{along}}}, {{{points}}}),')
    return text + _body([*lines, "}"])


def _equation_of_motion(kernel: Kernel) -> str:
    """The unforced equation of motion and the end conditions as data, for work without a series."""
    motion = kernel.motion
    arguments = f"P: Any, alpha: Any = 0, beta: Any = 0, one: Any = 1{_own(kernel)}".replace(": float = ", ": Any = ")
    terms = []
    for j in jets(motion.strong):
        powers = Poly(motion.strong.coeff(j), x).all_coeffs()[::-1]
        terms.append(f"({j.args[1]}, {j.args[2]}): ({', '.join(_exact(c) for c in powers)},)")
    text = f"def equation(\n{INDENT}{arguments},\n) -> dict[tuple[int, int], tuple[Any, ...]]:\n"
    text += _docstring(
        "The equation of motion without force: (p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ, ascending in powers of x. Eq. (6).\n"
    )
    text += _body(["return {", *(f"    {term}," for term in terms), "}"]) + "\n\n"
    conditions = []
    for end, kind in enumerate(kernel.column.ends):
        rows = ["{(" + str(order) + ", 0): 1}" for order in GEOMETRIC[kind]]
        for order in range(2):
            if (end, order) in motion.natural:
                natural = motion.natural[end, order]
                rows.append(
                    "{"
                    + ", ".join(f"({j.args[1]}, {j.args[2]}): {_exact(natural.coeff(j))}" for j in jets(natural))
                    + "}"
                )
        conditions.append(rows)
    text += f"def end_conditions(\n{INDENT}{arguments},\n) -> tuple[Any, Any]:\n"
    text += _docstring("Two conditions at x = 0 and two at x = 1: (p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ there. Eq. (15).\n")
    lines = ["return ("]
    for rows in conditions:
        lines += ["    (", *(f"        {row}," for row in rows), "    ),"]
    return text + _body([*lines, ")"])


def _newmark(newmark: Newmark) -> str:
    text = (
        "def newmark_step(\n"
        "    M: Array, C: Array, K: Array, q: Array, dq: Array, ddq: Array, F: Array, h: float,\n"
        "    newmark: tuple[float, float] = (0.25, 0.5),\n) -> tuple[Array, Array, Array]:\n"
    )
    text += _docstring(
        "One step of Newmark's method for Eq. (10): q, dq, ddq after a time h.\n\n"
        "M, C, K: (n, n). q, dq, ddq: (n,) or (n, cases), the state before. F: force after the step, like q.\n"
        "newmark: its two parameters (b, g); (1/4, 1/2) is average acceleration. Order 2 for g = 1/2, else 1.\n"
    )
    text += f"{INDENT}b, g = newmark\n"
    for name, expression in newmark.formulas:
        text += f"{INDENT}{name} = {_code(expression)}\n"
    text += f"{INDENT}return q_next, dq_next, ddq_next\n\n\n"
    text += "def newmark_limit(xi: float, newmark: tuple[float, float] = (0.25, 0.5)) -> float:\n"
    text += _docstring(
        "Largest stable ω h of Newmark's method for damping ratio xi; infinite where every step is stable.\n"
    )
    bounds = newmark.inverse_limit.args if isinstance(newmark.inverse_limit, Max) else (newmark.inverse_limit,)
    text += f"{INDENT}b, g = newmark\n"
    names = [f"bound_{n}" for n, bound in enumerate(bounds, start=1) if not bound.is_number]
    varying = [bound for bound in bounds if not bound.is_number]
    text += _body(f"{name} = {_code(bound)}" for name, bound in zip(names, varying, strict=True))
    text += f"{INDENT}inverse = max({', '.join(['0.0', *names])})\n"
    return text + f"{INDENT}return float(1 / inverse) if inverse else np.inf\n"


def _scales() -> str:
    listing = "\n".join(f"{name}: {UNITS[name]}" for name in SCALES)
    text = "def scales(bending_stiffness: float, mass_per_length: float, length: float) -> dict[str, float]:\n"
    text += _docstring(
        "SI size of one nondimensional unit of each quantity, for a beam in SI units (N m², kg/m, m). Eq. (5).\n\n"
        + listing
        + "\n"
    )
    text += f"{INDENT}EI, m, L = bending_stiffness, mass_per_length, length\n"
    text += f"{INDENT}return {{\n"
    text += "".join(f'{INDENT}{INDENT}"{name}": float({_code(e)}),\n' for name, e in SCALES.items())
    return text + f"{INDENT}}}\n"


# --- modules ------------------------------------------------------------------------------------------------


def emit(kernel: Kernel) -> str:
    """The NumPy module of a column, as text. Deterministic to the byte for one version of SymPy.

    Raises StatementError for a parameter whose name the module gives to something else.
    """
    parts = _polynomial_parts(kernel) if isinstance(kernel, PolynomialKernel) else _mode_parts(kernel)
    parts += [_damping(kernel), _force(kernel), _forms(kernel), _equation_of_motion(kernel)]
    parts += [_frequencies(kernel)] if isinstance(kernel, ColumnKernel) else []
    parts += [_newmark(kernel.newmark), _scales()]
    text = "\n\n".join(part if part.endswith("\n") else part + "\n" for part in parts if part)
    nodes = list(ast.walk(ast.parse(text)))
    assigned = {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    assigned |= {node.name for node in nodes if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    for parameter in kernel.column.parameters:
        if parameter.name in assigned:
            raise StatementError(f"parameter {parameter.name!r}: emitted code calls something else so; choose another")
    return text


def _mode_parts(kernel: Kernel) -> list[str]:
    assert isinstance(kernel, ColumnKernel)
    parts = [
        _header(kernel, "the modes of the unloaded beam", f"Roots of {_equation(kernel)}."),
        _metadata(kernel, ("x", "t", "P", "alpha", "beta", "F_0", "x_F", "gamma", "y"), {}),
        _basis(kernel),
        _shapes(kernel),
    ]
    if any(len(m.entry) > 1 for m in kernel.matrices):
        parts.append(_apart(kernel))
    return [*parts, *(_matrix(kernel, matrix) for matrix in kernel.matrices)]


# --- polynomials as trial functions -------------------------------------------------------------------------
# Constants are integers, and quotients are taken in the arrays' own numbers: on arrays of rational numbers or
# intervals these modules compute exactly, or with proof.


def _quotient(expression: Expr) -> str:
    """A rational expression as one quotient of polynomials with whole coefficients."""
    above, below = fraction(factor(expression))
    if below == 1:
        return _code(above)
    return re.sub(r"^\((\w+)\) / ", r"\1 / ", f"({_code(above)}) / ({_code(below)})")


def _times(factor_: Expr, term: str) -> str:
    """A term times a factor in the column's parameters."""
    above, below = fraction(together(factor_))
    text = {S.One: term, S.NegativeOne: f"-{term}"}.get(above)
    if text is None:
        text = f"{f'({_code(above)})' if above.is_Add else _code(above)} * {term}"
    return text if below == 1 else f"{text} / {_code(below) if below.is_Atom else f'({_code(below)})'}"


def _sum(terms: Iterable[str]) -> str:
    return " + ".join(terms).replace("+ -", "- ")


def _polynomial_parts(kernel: Kernel) -> list[str]:
    assert isinstance(kernel, PolynomialKernel)
    more = (
        "Each is the polynomial of its degree that meets the geometric conditions and is orthogonal to all of lower "
        "degree that do, in a series of Legendre's polynomials P_k(2x − 1)."
    )
    names = ("x", "t", "P", "alpha", "beta", "F_0", "x_F", "y")
    return [
        _header(kernel, "polynomials", more),
        _metadata(kernel, names, {"basis": "legendre"}),
        _polynomial_basis(kernel),
        _polynomial_shapes(kernel),
        *(_integrals(power) for power in kernel.powers),
        *(_series_matrix(kernel, matrix) for matrix in kernel.matrices),
    ]


def _polynomial_basis(kernel: PolynomialKernel) -> str:
    R, first = len(kernel.rigid), kernel.basis.first
    listed = f"({R} + N,)" if R else "(N,)"
    fields = [
        ("order", f"orders k of Legendre's polynomials P_k(2x − 1), ({first} + N,)"),
        ("sigma", f"(−1)^k, ({first} + N,)"),
        ("norm", f"∫ φ² dx, {listed}"),
        *(
            (name, f"{('φ', 'φ′', 'φ″', 'φ‴')[order]}({end}), {listed}")
            for name, end, order, _ in kernel.values
        ),
        *(
            (QUANTITIES[p], f"{('φ', 'φ′', 'φ″', 'φ‴')[p]} in P_0, P_1, …, {listed[:-1].rstrip(',')}, {first} + N)")
            for p in kernel.orders
        ),
    ]  # fmt: skip
    text = "class Basis(NamedTuple):\n"
    what = f"The {R} rigid function{'s' if R > 1 else ''}, then the first" if R else "The first"
    listing = "\n".join(f"{name}: {meaning}" for name, meaning in fields)
    text += _docstring(f"{what} N elastic functions: polynomials of degree {first}, {first + 1}, …\n\n{listing}\n")
    text += "\n" + "".join(f"{INDENT}{name}: Array\n" for name, _ in fields)

    text += "\n\ndef complete(order: Array, sigma: Array) -> Basis:\n"
    text += _docstring(
        "All that is known of the functions, from the orders 0, 1, …, D − 1 and their signs (−1)^k: N = "
        f"D − {first}. Eq. (9).\n\nThe arrays may hold floats, or any numbers that can be divided, such as fractions "
        "or intervals: then so does the result.\n"
    )
    lines = [f"degree = order[{first}:]", *_series_lines(kernel)]
    unit = [tuple(series(f)) for f in kernel.rigid]
    if R:
        lines += [
            "unit = order[1:2]  # 1, in the numbers at hand",
            f"rigid = np.zeros(({R}, order.size), dtype=order.dtype)",
        ]
        for n, row in enumerate(unit):
            lines += [f"rigid[{n}, {k}:{k + 1}] = {_times(c, 'unit')}" for k, c in enumerate(row) if c != 0]
        lines.append("deflection = np.concatenate([rigid, deflection])")
    if len(kernel.orders) > 1:
        lines.append("derivative = _derivative(order, sigma)")
    lines += [f"{QUANTITIES[p]} = {QUANTITIES[p - 1]} @ derivative" for p in kernel.orders[1:]]
    squares = [integrate(expand(f**2), (x, 0, 1)) for f in kernel.rigid]
    lines += _vector("norm", squares, kernel.basis.norm, "")
    for name, end, order, value in kernel.values:
        at_end = [f.diff(x, order).subs(x, end) for f in kernel.rigid]
        lines += _vector(name, at_end, value, "" if end else f"sigma[{first}:] * ")
    lines.append(f"return Basis({', '.join(name for name, _ in fields)})")
    text += _body(lines) + "\n\n"

    text += "def _derivative(order: Array, sigma: Array) -> Array:\n"
    text += _docstring(
        "What a series is multiplied by, from the right, to give its derivative: P_k′ = Σ 2 (2m + 1) P_m."
    )
    lines = ["value: Array = np.tril((1 - sigma[:, None] * sigma) * (2 * order + 1), -1)", "return value"]
    text += _body(lines) + "\n\n"
    text += "def basis(N: int) -> Basis:\n" + _docstring(
        f"The functions of degree up to N + {first - 1}, N of them elastic. Eq. (9), section 3.1."
    )
    return text + _body(
        [f"order = np.arange({first} + N, dtype=float)", "return complete(order, 1 - 2 * np.remainder(order, 2))"]
    )


def _series_lines(kernel: PolynomialKernel) -> list[str]:
    """The elastic functions in Legendre's polynomials: 1 for their own degree, and what the ends take away below it."""
    first, conditions = kernel.basis.first, kernel.basis.conditions
    if conditions:
        lines = [f"weight_{n} = {_quotient(c.weight)}" for n, c in enumerate(conditions, start=1)]
        shares = ["", ""]
        for n, c in enumerate(conditions, start=1):
            term = f"weight_{n}[:, None]" + ("" if c.of == 1 else f" * ({_code(c.of)})")
            shares[c.end] += f" + {term}" if shares[c.end] else term
        if shares[0]:
            shares[0] = f"sigma[{first}:, None] * sigma * ({shares[0]})"
        lines.append(f"share = {' + '.join(share for share in shares if share)}")
        lines.append(f"deflection = np.tril(-(2 * order + 1) * share, {first - 1})")
    else:
        lines = ["deflection = np.zeros((degree.size, order.size), dtype=order.dtype)"]
    return [*lines, f"deflection[np.arange(degree.size), np.arange({first}, order.size)] = 1"]


def _vector(name: str, rigid: list[Expr], elastic: Expr, sign: str) -> list[str]:
    """A quantity of each function, of the rigid ones first."""
    value = f"{sign}{_quotient(elastic)}" if elastic.free_symbols else f"{sign}np.full_like(degree, 1)"
    if elastic.is_number and elastic != 1:
        raise AssertionError(f"{name}: {elastic} at every degree is not written")
    if not rigid:
        return [f"{name} = {value}"]
    return [f"{name} = np.concatenate([{', '.join([*(_times(c, 'unit') for c in rigid), value])}])"]


def _polynomial_shapes(kernel: PolynomialKernel) -> str:
    R = len(kernel.rigid)
    doc = (
        "Trial functions or a derivative of them, shape (N, *x.shape). Eq. (9).\n\n"
        "x: places in units of the length, any shape. derivative: its order, 0 or more. "
        + (
            f"rigid: with the {R} rigid function{'s' if R > 1 else ''} first, shape ({R} + N, *x.shape).\n"
            if R
            else "rigid: this column has no rigid functions, so it changes nothing.\n"
        )
    )
    lines = [
        "x = np.asarray(x, dtype=float)",
        "series = basis.deflection",
        "for _ in range(derivative):",
        "    series = series @ _derivative(basis.order, basis.sigma)",
        f"value: Array = series{_elastic(R)} @ _legendre(basis.order.size, x.reshape(-1))",
        "return value.reshape(-1, *x.shape)",
    ]
    text = "def shapes(basis: Basis, x: ArrayLike, derivative: int = 0, rigid: bool = False) -> Array:\n"
    text += _docstring(doc) + _body(lines) + "\n\n"
    text += "def _legendre(count: int, x: Array) -> Array:\n" + _docstring(
        "P_k(2x − 1) for k below count, shape (count, x.size).\n\n"
        "By their differences, in the distance from the nearer end, so that nothing cancels there.\n"
    )
    lines = [
        "near = np.minimum(x, 1 - x)",
        "value = np.ones((count, x.size))",
        "step = -2 * near",
        "for k in range(1, count):",
        "    value[k] = value[k - 1] + step",
        "    step = (k * step - 2 * (2 * k + 1) * near * value[k]) / (k + 1)",
        "value[1::2] *= np.where(x < 0.5, -1, 1)",
        "return value",
    ]
    return text + _body(lines)


def _elastic(R: int) -> str:
    """Subscript that leaves the rigid functions out unless they are asked for."""
    return f"[0 if rigid else {R} :]" if R else ""


def _integrals(power: int) -> str:
    bands = products(power)
    text = f"def _integrals_{power}(order: Array) -> Array:\n"
    text += _docstring(f"∫ {'' if power == 0 else 'x ' if power == 1 else f'x^{power} '}P_m P_n dx, shape (D, D).")
    lines = [f"value: Array = np.diag({_quotient(bands[0])})"]
    for n, band in enumerate(bands[1:], start=1):
        lines.append(f"band_{n} = ({_quotient(band)})[:-{n}]")
        lines.append(f"value = value + np.diag(band_{n}, {n}) + np.diag(band_{n}, -{n})")
    return text + _body([*lines, "return value"])


def _series_matrix(kernel: PolynomialKernel, matrix: SeriesProgram) -> str:
    letter, R = matrix.letter, len(kernel.rigid)
    terms: list[tuple[str, Expr]] = []  # what is added, and its factor
    if matrix.diagonal != 0:
        terms.append(("np.diag(basis.norm)", matrix.diagonal))
    lines: list[str] = []
    for (p, q), factors in matrix.along.items():
        if len(factors) == 1:
            ((power, c),) = factors.items()
            terms.append((f"(basis.{QUANTITIES[p]} @ _integrals_{power}(basis.order) @ basis.{QUANTITIES[q]}.T)", c))
        else:
            # divided last: NumPy's zeros off the bands are plain integers, whose quotients would be floats
            below = reduce(lcm, (fraction(together(c))[1] for c in factors.values()))
            name = f"between_{p}{q}"
            between = (_times(cancel(c * below), f"_integrals_{power}(basis.order)") for power, c in factors.items())
            lines.append(f"{name} = {_sum(between)}")
            terms.append((f"(basis.{QUANTITIES[p]} @ {name} @ basis.{QUANTITIES[q]}.T)", 1 / below))
    terms += [(f"basis.{row}[:, None] * basis.{column}", c) for c, row, column in matrix.points]
    for n, (term, c) in enumerate(terms):
        added = _times(c, term)
        if n == 0:
            added = added[1:-1] if added == term and term.startswith("(") else added
            lines.append(f"{letter}: Array = {added}")
        else:
            lines.append(f"{letter} = {_sum([letter, added])}")
    if not terms:
        lines.append(f"{letter}: Array = np.diag(0 * basis.norm)")
    if matrix.symmetric and (matrix.along or matrix.points):
        lines.append(f"{letter} = ({letter} + {letter}.T) / 2  # to the last bit")
    cut = f"return {letter} if rigid else {letter}[{R}:, {R}:]" if R else f"return {letter}"
    return _matrix_head(kernel, matrix) + _body([*lines, cut])
