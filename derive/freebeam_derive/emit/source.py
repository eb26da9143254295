"""Expressions as source: what the templates print with.

Emitted functions take arrays of any library that follows the Python array API: `xp` is its namespace. A column's own
parameters may be arrays too; what is a maximum, a minimum or piecewise in them takes numbers only.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable
from typing import Any

from sympy import (
    E,
    Expr,
    Inverse,
    Lambda,
    MatMul,
    Piecewise,
    S,
    Symbol,
    cse,
    exp,
    factor,
    fraction,
    horner,
    numbered_symbols,
    pi,
    sympify,
    together,
)
from sympy.printing.pycode import PythonCodePrinter

from freebeam_derive.forms import Value
from freebeam_derive.statement import StatementError

EXACT = (2, 4, 8, 16, 32, 64)  # denominators that a float holds exactly
_FUNCTIONS = {  # SymPy's name and the array API's
    **{name: name for name in ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "sign", "floor")},
    **{f"a{name}": f"a{name}" for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh")},
    "Abs": "abs",
    "ceiling": "ceil",
}
OWN = "own"  # namespace of functions of a column's own parameters: the module's, such as `_sqrt`


class Printer(PythonCodePrinter):  # type: ignore[misc]
    """SymPy to Python on arrays of modes (f), of pairs of modes (f_i a column, f_j a row) and matrices."""

    def __init__(self, namespace: str) -> None:
        super().__init__({"fully_qualified_modules": False, "allow_unknown_functions": True})
        self.prefix = "_" if namespace == OWN else f"{namespace}."

    def _print_Function(self, e: Expr) -> str:
        if type(e).__name__ not in _FUNCTIONS:
            raise StatementError(
                f"the function {e.func} in {e} is none that kernels have; write it in terms of "
                f"{', '.join(sorted({*_FUNCTIONS, 'sqrt'}))}, Min, Max and Piecewise, or make {e} a parameter"
            )
        return f"{self.prefix}{_FUNCTIONS[type(e).__name__]}({self._print(e.args[0])})"

    def _print_Rational(self, e: Expr) -> str:
        return repr(float(e)) if e.q in EXACT else f"{e.p} / {e.q}"

    def _print_Mul(self, e: Expr) -> str:
        below = [f for f in e.args if f.is_Pow and f.exp.is_Rational and f.exp.is_negative]
        if len(below) == 1 and below[0].exp.is_Integer and below[0].exp < -2 and below[0].exp % 2:
            # several factors below the stroke get brackets; one that is printed as a product does not
            return str(self._print(e.xreplace({below[0]: 1 / Symbol(f"({self._print(1 / below[0])})")})))
        number, rest = e.as_coeff_Mul()
        if number.is_Rational and number.q not in (1, *EXACT):
            # division rounds once, and is exact in exact numbers
            return f"{self.parenthesize(number.p * rest, 50)} / {number.q}"
        return str(super()._print_Mul(e))

    def parenthesize(self, item: Expr, level: int, strict: bool = False) -> str:
        if item.is_Rational and item >= 0 and item.q in EXACT:
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
            return f"{self.prefix}sqrt({self._print(base)})"
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
            left, right = matrices[0].arg, MatMul(*matrices[1:]).doit()
            product = f"{self.prefix}linalg.solve({self._print(left)}, {self._print(right)})"
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


for _name in {*PythonCodePrinter._kf, "sign"} - {"Min", "Max"}:  # none of Python's own `math`
    setattr(Printer, f"_print_{_name}", Printer._print_Function)


def code(expression: Expr, namespace: str = OWN) -> str:
    """An expression as source. Raises StatementError for a function that kernels do not have."""
    return str(Printer(namespace).doprint(expression))


def own_functions(text: str) -> list[str]:
    """The functions of a column's own parameters that a module calls."""
    names = "|".join(sorted({*_FUNCTIONS.values(), "sqrt"}))
    return sorted(set(re.findall(rf"\b_({names})\(", text)))


def shared(assignments: list[tuple[str, Expr]]) -> list[tuple[str, Expr]]:
    """Assignments with their common parts computed once, as a list of such."""
    parts, reduced = cse([e for _, e in assignments], symbols=numbered_symbols("shared_", start=1), order="canonical")
    return [*((str(s), e) for s, e in parts), *zip((name for name, _ in assignments), reduced, strict=True)]


def literal(value: Any) -> str:
    """A constant as source: a long text in pieces, an expression exactly."""
    if isinstance(value, str) and len(value) > 88:
        pieces = textwrap.wrap(value, 88, drop_whitespace=False, break_on_hyphens=False)
        return f"({' '.join(map(repr, pieces))})"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{literal(k)}: {literal(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        listed = ", ".join(map(literal, value))
        return f"[{listed}]" if isinstance(value, list) else f"({listed},)" if len(value) == 1 else f"({listed})"
    if isinstance(value, Lambda):
        return f"lambda {value.variables[0]}: {exact(value.expr)}"
    return exact(value) if isinstance(value, Expr) else repr(value)


def exact(expression: Expr) -> str:
    """Code in which a fraction or a root that no float holds is made from `one`, a number of the caller's kind."""
    kept = (1, *EXACT)
    found = _functions_of_one(expression)
    return code(found.replace(lambda e: e.is_Rational and e.q not in kept, lambda e: Symbol("one") * e))


def _functions_of_one(expression: Expr) -> Expr:
    """The expression with the roots and other functions of rational numbers taken of such of the caller's kind."""
    return expression.replace(_of_number, lambda e: e.func(_of_one(e.args[0]), *e.args[1:]))


def _of_number(e: Expr) -> bool:
    """Whether it is a root or another function of a rational number."""
    return bool((e.is_Function or (e.is_Pow and not e.exp.is_Integer)) and e.args[0].is_Rational)


def _of_one(number: Expr) -> Symbol:
    return Symbol(f"(one * {number.p} / {number.q})")


def number(expression: Expr) -> str:
    """An expression, a float where it is a number."""
    return repr(float(expression)) if expression.is_number else code(expression)


def plus(expression: Expr) -> str:
    """An expression as what is added to something; nothing for zero."""
    text = code(expression)
    if expression == 0:
        return ""
    if expression.is_Add:
        return f" + ({text})"
    return f" - {text[1:]}" if text[0] == "-" else f" + {text}"


def _bracketed(expression: Expr, say: Callable[[Expr], str]) -> str:
    return say(expression) if expression.is_Atom else f"({say(expression)})"


def quotient(expression: Expr, say: Callable[[Expr], str] = code) -> str:
    """A rational expression as one quotient of polynomials with whole coefficients; say: the language's printer."""
    above, below = fraction(factor(expression))
    return say(above) if below == 1 else f"{_bracketed(above, say)} / {_bracketed(below, say)}"


def times(text: str, factor_: Expr, say: Callable[[Expr], str] = code) -> str:
    """Source times a factor in the column's parameters, with whole coefficients; say: the language's printer."""
    above, below = fraction(together(sympify(factor_)))
    if above.is_Add:  # SymPy leaves -x/3 - 1/3 as it is
        content, rest = above.as_content_primitive()
        above, below = content.p * rest, content.q * below
    if above != 1:
        text = f"-{text}" if above == -1 else f"{_bracketed(above, say) if above.is_Add else say(above)} * {text}"
    return text if below == 1 else f"{text} / {_bracketed(below, say)}"


def scalar(expression: Expr) -> str:
    """An expression in the column's parameters as a number of the kind of `one`, exact in exact numbers; a root or
    another function of a number that is none is as good as `one` can be."""
    known = sympify(expression).subs(pi, 4 * Symbol("_atan(one)")).subs(E, exp(Symbol("one")))
    return times("one", _functions_of_one(known))


def value(given: Value) -> str:
    """What a point term sees: name, order, place and side."""
    place = "None" if given.place is None else scalar(given.place)
    return f"({given.of!r}, {given.order}, {place}, {given.side})"


def at(given: Value) -> str:
    """The vector of what a point term sees."""
    if given.place is None:
        return f"_at(basis, breaks, {given.of!r})"
    side = f", {given.side}" if given.side else ""
    return f"_at(basis, breaks, {given.of!r}, {given.order}, {scalar(given.place)}{side})"


def polynomial(expression: Expr) -> str:
    """A polynomial in nested form; a constant too is an array like `place`."""
    return (
        code(horner(expression)) if expression.free_symbols else f"zero + {code(expression)}" if expression else "zero"
    )
