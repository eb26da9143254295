"""Mathematics as LaTeX: derivatives as primes and dots, terms in a reader's order, long sums over several lines.

`y'` is d/dx, a dot d/dt; arguments are left out, places stay: `y'(1)`. Only commands that every LaTeX and every
converter to MathML knows are used.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from sympy import (
    Add,
    Basic,
    Derivative,
    DiracDelta,
    Eq,
    Expr,
    Function,
    Integral,
    MatrixBase,
    Mul,
    S,
    Subs,
    Symbol,
    cos,
    exp,
    fraction,
    sin,
    sympify,
)
from sympy.core.function import AppliedUndef
from sympy.printing.latex import LatexPrinter

from freebeam_derive.comparison import eta, sigma
from freebeam_derive.jets import beside, leap
from freebeam_derive.notation import NOTATION, QUANTITIES, P, alpha, beta, gamma, t, x
from freebeam_derive.statement import Column, Parameter

WIDTH = 76
"""Characters of a line of mathematics; a longer sum is broken."""

_NAMES = {
    "Sigma_j": r"\sum_{j}", "delta_W_nc": r"\delta W_{\mathrm{nc}}", "K^G_ij": r"K^{\mathrm{G}}_{ij}",
    "q_hat": r"\hat{q}", "epsilon": r"\varepsilon", "P_star": r"P_{*}", "s_star": r"s_{*}", "degree": "d", "order": "k",
    "u^T": r"u^{\mathsf{T}}", "a^T": r"a^{\mathsf{T}}", "b^T": r"b^{\mathsf{T}}",
    "q_next": r"q_{+}", "dq_next": r"\dot{q}_{+}", "ddq_next": r"\ddot{q}_{+}", "dq": r"\dot{q}", "ddq": r"\ddot{q}",
    "q_predicted": r"q_{\mathrm{p}}", "dq_predicted": r"\dot{q}_{\mathrm{p}}", "effective": "S", "right_side": "r",
    "dq^T": r"\dot{q}^{\mathsf{T}}", "q^T": r"q^{\mathsf{T}}", "ddq^T": r"\ddot{q}^{\mathsf{T}}",
    "ddq_next^T": r"\ddot{q}_{+}^{\mathsf{T}}",
}  # fmt: skip
_FIELDS = {
    "phi_i": r"\varphi_{i}", "phi_j": r"\varphi_{j}", "phi_d": r"\varphi_{d}", "phi": r"\varphi",
    "q_i": "q_{i}", "q_j": "q_{j}", "q": "q", "u": "u", "v": "v", "tau": r"\tau", "F": "F", "M": "M",
}  # fmt: skip
"""Functions of place and time that NOTATION has not; their arguments are left out."""
_ENTRY = re.compile(r"[A-Z](\^[G\d])?_[a-z]{1,2}|d?d?q|q_hat")
PRIME = r"\prime"
_DOTS = ("{}", r"\dot{{{}}}", r"\ddot{{{}}}", r"\dddot{{{}}}")


class Printer(LatexPrinter):  # type: ignore[misc]
    """LaTeX of forms and of the objects of a record. own: LaTeX of names beside the usual, a column's parameters;
    unknowns: that of its fields and coordinates beside y."""

    def __init__(self, own: dict[str, str] | None = None, unknowns: dict[str, str] | None = None) -> None:
        super().__init__({"ln_notation": True, "fold_short_frac": False, "mat_str": "pmatrix", "mat_delim": ""})
        self.own, self.unknowns = own or {}, unknowns or {}

    def _print_Symbol(self, expr: Any, style: str = "plain") -> str:
        name = str(expr)
        if name in self.own or name in _NAMES:
            return self.own.get(name) or _NAMES[name]
        if name in NOTATION:
            return NOTATION[name].latex
        if powered := re.fullmatch(
            r"([MCK])\^(\d)_(ij|ji)", name
        ):  # the part of a matrix that goes with a power of the load
            return rf"{powered[1]}^{{({powered[2]})}}_{{{powered[3]}}}"
        if barred := re.fullmatch(r"([a-zA-Z]+)_(?:(\w+)_)?bar(?:_(\w+))?", name):
            below = barred[2] or barred[3]
            return rf"\bar{{{super()._print_Symbol(Symbol(barred[1]))}}}" + (f"_{{{below}}}" if below else "")
        return str(super()._print_Symbol(expr))

    # --- fields: y, δy, φ_i, χ, q_j, F_0

    def _field(self, expr: Any) -> tuple[str, bool]:
        """The letter of an undefined function, and whether it is one whose arguments are left out."""
        name = expr.func.__name__
        if name in self.own:  # another unknown of the column, its variation or its trial function
            return self.own[name], True
        if name in NOTATION and NOTATION[name].symbol.is_Function:
            return NOTATION[name].latex, True
        if name not in _FIELDS and expr.args[-1] == t and len(expr.args) < 3:  # an unknown of some column
            varied = r"\delta " if name.startswith("delta_") else ""
            return varied + str(LatexPrinter().doprint(Symbol(name.removeprefix("delta_")))), True
        return _FIELDS.get(name, name), name in _FIELDS

    def _derivative(self, letter: str, orders: dict[Any, int]) -> str:
        prefix, core = ("\\delta ", letter.removeprefix(r"\delta ")) if letter.startswith(r"\delta ") else ("", letter)
        subscript = ""
        if "_{" in core:
            core, rest = core.split("_{", 1)
            subscript = "_{" + rest
        dotted = _DOTS[orders.get(t, 0)].format(core)
        primes = sum(n for variable, n in orders.items() if variable != t)
        return f"{prefix}{dotted}{subscript}" + (f"^{{{PRIME * primes}}}" if primes else "")

    def _print_Derivative(self, expr: Any) -> str:
        inner = expr.expr
        if isinstance(inner, AppliedUndef):
            letter, known = self._field(inner)
            orders = {variable: int(n) for variable, n in expr.variable_count}
            if known or len(inner.args) == 1:
                text = self._derivative(letter, orders)
                return self._placed(text, inner.args[0]) if known else f"{text}({self._print(inner.args[0])})"
            if len(inner.args) == 2 and len(orders) == 1 and next(iter(orders)).is_Symbol and letter == "D":
                return rf"\frac{{\partial {letter}}}{{\partial {self._print(next(iter(orders)))}}}"
            if letter == "P":  # Legendre's polynomials
                return rf"P_{{{self._print(inner.args[0])}}}^{{\prime}}"
        return str(super()._print_Derivative(expr))

    def _placed(self, text: str, place: Any) -> str:
        """A field's letter, and its place where that is one: x and t are left out."""
        return text if place in (x, t) else f"{text}({self.place(place)})"

    def place(self, place: Any) -> str:
        """A place along the beam, a decimal where that is short; with a sign above it just beside it."""
        if place.func in (beside, leap):
            above = "" if place.func == leap else "^{+}" if place.args[1] > 0 else "^{-}"
            return self.place(place.args[0]) + above
        if place.is_Rational and not place.is_Integer and 10000 % place.q == 0:
            return f"{float(place):g}"
        return str(self._print(place))

    def _print_Subs(self, expr: Any) -> str:
        inner, _, (place,) = expr.args
        if place.func == leap:  # how much it jumps there
            return rf"\left[{self._print(inner)}\right]_{{{self.place(place)}}}"
        return f"{self._print(inner)}({self.place(place)})"

    def _print_Function(self, expr: Any, exp: Any = None) -> str:
        if isinstance(expr, AppliedUndef):
            if expr.func.__name__ in ("det", "tr"):
                return rf"\operatorname{{{expr.func.__name__}}}\left({self._print(expr.args[0])}\right)"
            letter, known = self._field(expr)
            if letter == "P" and len(expr.args) == 2:
                text = f"P_{{{self._print(expr.args[0])}}}"
            elif known:
                text = self._placed(letter, expr.args[0])
            else:
                text = f"{letter}({', '.join(self._print(a) for a in expr.args)})"
            return f"{{{text}}}^{{{exp}}}" if exp else text
        name = expr.func.__name__
        if name in ("sin", "cos", "sinh", "cosh") and len(expr.args) == 1 and not expr.args[0].is_Add:
            power = f"^{{{exp}}}" if exp else ""
            return rf"\{name}{power} {self._print(expr.args[0])}"
        return str(super()._print_Function(expr, exp))

    def _print_DiracDelta(self, expr: Any, exp: Any = None) -> str:
        return rf"\delta({self._print(expr.args[0])})"

    def _print_ExpBase(self, expr: Any, exp: Any = None) -> str:
        return rf"\mathrm{{e}}^{{{self._print(expr.args[0] * (exp or 1))}}}"

    def _print_re(self, expr: Any, exp: Any = None) -> str:
        inner = self._print(expr.args[0])
        return (
            rf"\operatorname{{Re}} {inner}" if expr.args[0].is_Symbol else rf"\operatorname{{Re}}\left({inner}\right)"
        )

    def _print_Integral(self, expr: Any) -> str:
        (variable, *bounds), *_ = expr.limits
        if _leading_minus(expr.function):
            return f"- {self._print(Integral(-expr.function, *expr.limits))}"
        inside = self._print(expr.function)
        if expr.function.is_Add:
            inside = rf"\left({inside}\right)"
        low, high = (self.place(b) for b in bounds)
        return rf"\int_{{{low}}}^{{{high}}} {inside}\,d{self._print(variable)}"

    # --- order of terms and factors

    def _print_Add(self, expr: Any, order: Any = None) -> str:
        return signed([(sign, text) for sign, text in self.terms(expr)])

    def terms(self, expr: Any) -> list[tuple[str, str]]:
        """Signs and LaTeX of the terms of a sum, in a reader's order, one with a plus first where there is one."""
        found = []
        for term in self._ordered(expr):
            negative = term.could_extract_minus_sign() and not term.is_Add
            if isinstance(term, Integral) and _leading_minus(term.function):
                term, negative = Integral(-term.function, *term.limits), True
                text = self._print(term)
            else:
                text = self._print(-term if negative else term)
            if text.startswith("- "):
                negative, text = not negative, text[2:]
            found.append(("-" if negative else "+", text))
        first = next((k for k, (sign, _) in enumerate(found) if sign == "+"), 0)
        return [found[first], *found[:first], *found[first + 1 :]]

    def _ordered(self, expr: Any) -> list[Any]:
        if not expr.is_commutative:
            return sorted(Add.make_args(expr), key=_matrix_rank)
        return sorted(Add.make_args(expr), key=_rank) if _fields(expr) else self._terms_of(expr)

    def _print_Mul(self, expr: Any) -> str:
        above, below = fraction(expr)
        if above.is_Add and below != 1 and all(_leading_minus(e) for e in above.args):
            return f"- {self._print(-above / below)}"
        plain = not any(f.is_Pow and f.exp.is_negative for f in Mul.make_args(expr)) and expr.is_commutative
        if not plain or not (_fields(expr) or any(_ENTRY.fullmatch(str(e)) for e in expr.free_symbols)):
            return str(super()._print_Mul(expr))
        number, rest = expr.as_coeff_Mul()
        listed = sorted(Mul.make_args(rest), key=lambda f: (_kind(f), self._print(f)))
        pieces = [rf"\left({self._print(f)}\right)" if f.is_Add else self._print(f) for f in listed]
        text = pieces[0]
        for piece in pieces[1:]:
            text += (r"\," if piece.startswith(r"\delta") else " ") + piece
        if number == 1:
            return text
        return f"- {text}" if number == -1 else f"{self._print(number)} {text}"

    def _print_Pow(self, expr: Any) -> str:
        if expr.exp.is_Integer and expr.exp > 1 and (isinstance(expr.base, Derivative | Subs)):
            base = self._print(expr.base)
            tall = "prime" in base or "frac" in base
            return rf"\left({base}\right)^{{{expr.exp}}}" if tall else f"{base}^{{{expr.exp}}}"
        return str(super()._print_Pow(expr))

    def _print_Piecewise(self, expr: Any) -> str:
        rows = [
            f"{self._print(e)} & " + (r"\text{otherwise}" if c is S.true else rf"\text{{if }} {self._print(c)}")
            for e, c in expr.args
        ]
        return r"\begin{cases} " + r" \\ ".join(rows) + r" \end{cases}"

    # --- lines

    def lines(self, item: Any) -> list[str]:
        """An object as lines of LaTeX, `&` before what is aligned; a tuple is several objects."""
        if isinstance(item, tuple | list):
            return [line for part in item for line in self.lines(part)]
        item = readable(item)
        if isinstance(item, Eq) and item.rhs == 0 and all(_leading_minus(e) for e in Add.make_args(item.lhs)):
            item = Eq(-item.lhs, 0, evaluate=False)
        if isinstance(item, Eq):
            left = self._print(item.lhs)
            if item.rhs == 0 and width(left) > WIDTH:
                broken = self._broken(item.lhs)
                return [f"& {broken[0]}", *(rf"& \quad {line}" for line in broken[1:-1]), rf"& \quad {broken[-1]} = 0"]
            first, *rest = self._broken(item.rhs, WIDTH - width(left))
            return [f"{left} &= {first}", *(rf"&\quad {line}" for line in rest)]
        first, *rest = self._broken(item)
        return [f"& {first}", *(rf"& \quad {line}" for line in rest)]

    def _broken(self, expr: Any, room: int = WIDTH) -> list[str]:
        """An expression in pieces that fit a line each, broken between the terms of its sum or of an integrand."""
        if not isinstance(expr, Basic | MatrixBase):
            expr = sympify(expr)
        whole = self._print(expr)
        if width(whole) <= max(room, 24) or isinstance(expr, MatrixBase):
            return [whole]
        pieces: list[tuple[str, str]] = []
        for term in self._ordered(expr):
            if isinstance(term, Integral) and term.function.is_Add and width(self._print(term)) > 24:
                ((variable, low, high),) = term.limits
                inner = self.terms(term.function)
                opening = rf"\int_{{{self.place(low)}}}^{{{self.place(high)}}} \bigl("
                for k, (sign, text) in enumerate(inner):
                    if k == 0:
                        sign, text = "+", opening + (f"-{text}" if sign == "-" else text)
                    if k == len(inner) - 1:
                        text += rf"\bigr)\,d{self._print(variable)}"
                    pieces.append((sign, text))
            else:
                pieces += self.terms(term)
        result: list[str] = []
        line = ""
        for sign, text in pieces:
            piece = text if not line and not result and sign == "+" else f"{sign} {text}"
            if line and width(f"{line} {piece}") > max(room, 24):
                result.append(line)
                line = piece
            else:
                line = f"{line} {piece}" if line else piece
        return [*result, line]

    def _terms_of(self, expr: Any) -> list[Any]:
        return list(self._as_ordered_terms(expr)) if isinstance(expr, Add) else [expr]

    def labelled(self, item: Any, names: tuple[str, ...]) -> list[str]:
        """The parts of a tuple, each after its name; one without a name is a relation."""
        found: list[str] = []
        parts = _parts(item)
        for name, part in zip(names, parts, strict=True):
            if not name:
                found += self.lines(part)
                continue
            first, *rest = self._broken(readable(part), WIDTH - width(name))
            found += [f"{name} &= {first}", *(rf"&\quad {line}" for line in rest)]
        return found


def printer(column: Column) -> Printer:
    """The printer of a column, which knows its own parameters and unknowns."""
    own = {p.name: letter(p) for p in column.parameters}
    for function in column.unknowns:
        name = str(function)
        if name == "y":
            continue
        plain = str(LatexPrinter().doprint(Symbol(name))) if function.letter == name else function.letter
        base, _, below = re.sub(r"_(\w)$", r"_{\1}", plain).partition("_")
        below = below.removeprefix("{").removesuffix("}")
        full = f"{base}_{{{below}}}" if below else base
        own |= {name: full, f"delta_{name}": rf"\delta {full}", f"shape_{name}": rf"\hat{{{base}}}{full[len(base) :]}"}
        trial = rf"\hat{{{base}}}" if name in column.coordinates else base
        own |= {f"trial_{name}_{k}": f"{trial}_{{{f'{below},{k}' if below else k}}}" for k in "ij"}
    return Printer(own)


def letter(parameter: Parameter) -> str:
    """LaTeX of a parameter: what it states, or its name as SymPy reads names, such as k_{wall} of k_wall.

    >>> letter(Parameter(Symbol("mu_tip"), "mass at the tip", 0.5, 0.0, 1.0))
    '\\\\mu_{tip}'
    """
    return parameter.latex or str(LatexPrinter().doprint(parameter.symbol))


def _parts(item: Any) -> list[Any]:
    return [part for inner in item for part in _parts(inner)] if isinstance(item, tuple) else [item]


def signed(terms: Iterable[tuple[str, str]]) -> str:
    """A sum from the signs and the texts of its terms."""
    text = ""
    for sign, term in terms:
        text += (f" {sign} " if text else "-" if sign == "-" else "") + term
    return text


def width(text: str) -> int:
    """Roughly how many characters LaTeX takes on a line; of a fraction, the wider part."""
    for _ in range(4):
        text = re.sub(
            r"\\frac\{([^{}]*)\}\{([^{}]*)\}",
            lambda m: m[1] if width(m[1]) >= width(m[2]) else m[2],
            text,
        )
    text = re.sub(r"\\(left|right|bigl|bigr|mathrm|mathsf|operatorname|dot|ddot|hat|bar|,|quad)", "", text)
    text = re.sub(r"\\prime", "'", text)
    text = re.sub(r"\\[a-zA-Z]+", "x", text)
    return len(re.sub(r"[{}^_&\s]", "", text)) + 2 * len(re.findall(r"(?<=\s)[-+=](?=\s)", text))


def readable(item: Any) -> Any:
    """The names that the program has for end values and tails, written as what they stand for."""
    if not isinstance(item, Basic | MatrixBase):
        return sympify(item)
    symbols = item.free_symbols
    values: dict[Any, Any] = {}
    for symbol in symbols:
        name = str(symbol)
        match = re.fullmatch(r"(deflection|slope|moment|shear)_([01])(?:_([ij]))?", name)
        if match:
            order, end, suffix = QUANTITIES.index(match[1]), int(match[2]), match[3] or "i"
            phi = Function(f"phi_{suffix}", real=True)(x)
            value = Subs(phi.diff(x, order), x, end) if order else phi.subs(x, end)
            base = Symbol(f"gamma_{suffix}", positive=True) if match[3] else gamma
            values[symbol] = value / base**order
    if eta in symbols:
        values[eta] = sigma * exp(-gamma)
    if not values:
        return item
    if isinstance(item, Eq):
        return Eq(readable(item.lhs), readable(item.rhs), evaluate=False)
    return item.xreplace(values)


def _fields(expr: Any) -> bool:
    return bool(getattr(expr, "atoms", None) and expr.atoms(AppliedUndef))


def _kind(factor: Any) -> int:
    """Numbers and parameters, entries of matrices, sums, fields, what is virtual, the delta function."""
    if factor.has(DiracDelta) or isinstance(factor, cos | sin):
        return 5
    if _fields(factor):
        return 4 if any(a.func.__name__.startswith("delta_") for a in factor.atoms(AppliedUndef)) else 3
    return 2 if factor.is_Add else int(bool(_ENTRY.fullmatch(str(factor))))


def _matrix_rank(term: Any) -> int:
    """Mass, damping, stiffness, load, force, as equations of motion have them."""
    letters = [str(f) for f in Mul.make_args(term) if not f.is_commutative]
    first = next((letter for letter in letters if letter in "MCEKHF"), "")
    return "MCEKHF".index(first) if first else 9


def _rank(term: Any) -> tuple[Any, ...]:
    """Inertia, external damping, internal damping, bending, load, force; integrals before values at points."""
    orders = [sum(int(n) for variable, n in d.variable_count if variable == t) for d in term.atoms(Derivative)]
    applied = term.atoms(AppliedUndef)
    names = {a.func.__name__ for a in applied}
    highest = max(orders, default=0)
    return (
        not names.isdisjoint({"F", "F_0"}),
        not term.has(Integral) and (bool(term.atoms(Subs)) or any(a.args[0] not in (x, t) for a in applied)),
        term.has(P),
        -2 if highest == 2 else 0,
        -1 if term.has(beta) else 0,
        0 if term.has(alpha) else 1,
        min((_number(i.limits[0][1]) for i in term.atoms(Integral)), default=0.0),
        str(term),
    )


def _number(place: Any) -> float:
    """Where a place lies, in the middle if that is not known."""
    return float(place) if place.is_number else 0.5


def _leading_minus(expr: Expr) -> bool:
    return not expr.is_Add and expr.could_extract_minus_sign()
