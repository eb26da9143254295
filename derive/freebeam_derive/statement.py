"""What a column is: energies, virtual work, ends and parameters, close to how Eq. (8) is printed.

A column's file states one `column = Column(...)` with four helpers: `integral` (over the beam), `at` (a value
at a point), `delta` (the variation) and `Parameter`. `load_column` reads such a file from anywhere. A statement
that makes no sense, or that is not supported, is refused with the reason, as a `StatementError`.

Inside the program a functional is held in jets: `jet(field, p, r, place)` is d^p/dx^p d^r/dt^r of the deflection
(field 0) or of the virtual displacement (field 1), along the beam or at a point, so that it is a polynomial.
"""

from __future__ import annotations

import keyword
import math
import re
import runpy
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import Any

from sympy import (
    Add,
    Derivative,
    Dummy,
    Expr,
    Function,
    Integer,
    Integral,
    Mul,
    Piecewise,
    Poly,
    PolynomialError,
    S,
    Subs,
    Symbol,
    Tuple,
    expand,
    nsimplify,
    sympify,
)
from sympy.core.function import AppliedUndef

from freebeam_derive.notation import F_0, NOTATION, P, alpha, beta, t, variation_of_y, x, x_F, y

# Geometric conditions of each kind of end: the orders of derivative that it holds at zero. The natural ones
# are derived from the energies (variation.py).
GEOMETRIC: dict[str, tuple[int, ...]] = {"free": (), "pinned": (0,), "sliding": (1,), "clamped": (0, 1)}

ALONG = Symbol("along")  # the place of a jet that is a function of x
jet = Function("jet")

# what every emitted function of a matrix knows by these names, and the name of the place above
RESERVED = ("np", "basis", "rigid", "along")
# What public calls that take a column's own parameters as keywords call so themselves; a test compares these with the
# calls' signatures.
KEYWORDS = frozenset(
    """
    self column modes load loads load_max kappa beam digits progress series vectors
    parameter low high log tolerance values name
    step chunks scheduler workers store convergence
    ax color count label moments normalised part width
""".split()
)
# What a map's dataset holds besides: an axis or a setting of the same name would take its place.
MAPS = frozenset("frequency kind error converged title column_title fixed units source".split())
MAPS |= {"bending_stiffness", "mass_per_length", "length"}

# LaTeX of a parameter, as every page and picture can show it: letters with marks, in roman or not, and their scripts.
_GREEK = (
    "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi pi rho sigma tau "
    "upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega ell"
)
_PLAIN = rf"[A-Za-z0-9 ]|\\(?:{_GREEK.replace(' ', '|')})(?![A-Za-z])"
_MARKED = rf"{_PLAIN}|\\(?:mathrm|mathsf|mathbf|hat|bar|tilde|dot|ddot)\{{(?:{_PLAIN})+\}}"
_SCRIPT = rf"(?:{_MARKED}|\{{(?:{_MARKED}|,)+\}})"
_LETTER = re.compile(rf"(?:(?:{_MARKED})(?:_{_SCRIPT})?(?:\^{_SCRIPT})?|/)+")


class StatementError(ValueError):
    """A column's statement that makes no sense; the message is one line with the reason and the cure."""


_LOST = "a term that is zero is refused, since SymPy may have lost what it was to be"


def integral(density: Expr, length: Expr = S.One) -> Expr:
    """Integral of a density over the beam, x from 0 to `length` (1 in a nondimensional statement).

    Raises StatementError where the density is zero: a term was lost before it came here.
    """
    return Integral(_not_zero("integral", density), (x, 0, length))


def at(expression: Expr, place: Expr | int) -> Expr:
    """Value of an expression in y or delta(y) at a place along the beam.

    Raises StatementError where the expression is zero: a term was lost before it came here.
    """
    return Subs(_not_zero("at", expression), x, sympify(place))


def delta(expression: Expr) -> Expr:
    """First variation of an expression in y, whether along the beam or at a place. Eq. (7).

    Raises StatementError where nothing varies.
    """
    expression = sympify(expression)
    variation = show(varied(_fields_of(expression, "delta")))
    if variation == 0:
        raise StatementError(f"delta({expression}) is zero: it does not hold the y of freebeam_derive.notation")
    return variation


def _not_zero(helper: str, expression: Expr) -> Expr:
    expression = sympify(expression)
    if expression == 0:
        raise StatementError(f"{helper}(0): {_LOST}")
    return expression


@dataclass(frozen=True)
class Parameter:
    """A parameter of a column's own, beside the load and the dampings; nondimensional."""

    symbol: Symbol
    meaning: str
    default: float
    low: float
    high: float
    latex: str = ""

    @property
    def name(self) -> str:
        return str(self.symbol)


@dataclass(frozen=True)
class Functional:
    """A work or an energy in jets: a density along the beam and a sum of products of point values."""

    density: Expr
    points: Expr

    def __add__(self, other: Functional) -> Functional:
        return Functional(expand(self.density + other.density), expand(self.points + other.points))

    def scaled(self, factor: Expr | int) -> Functional:
        return Functional(expand(factor * self.density), expand(factor * self.points))

    def coefficient(self, symbol: Expr) -> Functional:
        """The part that is linear in a symbol, divided by it."""
        return Functional(self.density.coeff(symbol, 1), self.points.coeff(symbol, 1))

    def __bool__(self) -> bool:
        return bool(self.density != 0 or self.points != 0)


@dataclass(frozen=True)
class Energies:
    """T, V, W_c and the virtual work δW_nc of Eq. (8), as SymPy expressions over 0 ≤ x ≤ length."""

    T: Expr
    V: Expr
    W_c: Expr
    dW_nc: Expr
    length: Expr = S.One

    def functional(self, name: str) -> Functional:
        """T, V, W_c or dW_nc in jets."""
        return read_functional(sympify(getattr(self, name)), name, self.length)


@dataclass(frozen=True)
class Column:
    """A column: its energies and virtual work, ends and parameters; data, and nothing else.

    name: lower case with hyphens. title: one line. T, V, W_c, dW_nc: nondimensional, in `y`, `delta(y)`, `x`,
    `t`, the load `P`, `alpha`, `beta`, the force `F_0` at `x_F` and the column's own parameters. ends: kinds
    at x = 0 and x = 1, each free, pinned, sliding or clamped. dimensional: the same in SI quantities, if given;
    then the nondimensional one is derived from it and compared (scaling.py). basis, modes: the trial functions,
    "legendre" polynomials or comparison "modes", and their number, where none are asked for.

    Raises StatementError where the statement makes no sense.
    """

    name: str
    title: str
    T: Expr
    V: Expr
    W_c: Expr
    dW_nc: Expr
    ends: tuple[str, str]
    parameters: tuple[Parameter, ...] = ()
    dimensional: Energies | None = None
    source: str = ""
    basis: str = "legendre"
    modes: int = 16

    def __post_init__(self) -> None:
        check(self)

    @cached_property
    def energies(self) -> Energies:
        return Energies(sympify(self.T), sympify(self.V), sympify(self.W_c), sympify(self.dW_nc))

    @property
    def module(self) -> str:
        """Name of the emitted module."""
        return self.name.replace("-", "_")

    @property
    def damping(self) -> tuple[str, ...]:
        """The dampings that the virtual work contains, of alpha and beta."""
        return tuple(str(s) for s in (alpha, beta) if self.energies.dW_nc.has(s))

    @property
    def forced(self) -> bool:
        """Whether the transversal force F_0 does work."""
        return bool(self.energies.dW_nc.has(F_0) or self.energies.W_c.has(F_0))


# --- reading a statement into jets ------------------------------------------------------------------------


FIELDS = (y.func, variation_of_y.func)


def _fields_of(expression: Expr, name: str) -> Expr:
    """Replace derivatives and values of y and delta_y by jets. name: what is read, for messages.

    Raises StatementError for a value at an instant, or at a place that moves along the beam.
    """

    def one(e: Expr, field: AppliedUndef, orders: tuple[int, int]) -> Expr:
        place, time = field.args
        if time != t:
            raise StatementError(f"{name}: {e} is not taken at the time t; y at other instants is not supported")
        if place != x and place.has(x, t):
            raise StatementError(f"{name}: {e} is not taken at x or at a fixed place; such a place is not supported")
        if place != x and orders[0]:
            raise StatementError(f"{name}: {e} differentiates a value at a place; write at(y.diff(x), {place})")
        which = Integer(FIELDS.index(field.func))
        return jet(which, Integer(orders[0]), Integer(orders[1]), ALONG if place == x else place)

    def convert(e: Expr) -> Expr:
        if not e.has(*FIELDS):
            return e
        if isinstance(e, Subs):
            place = e.point[0]
            if set(e.variables) != {x} or set(e.point) != {place} or place.has(x, t) or e.expr.has(Integral):
                raise StatementError(f"{name}: {e} is not taken at a fixed place; such a value is not supported")
            return at_place(convert(e.expr), place)
        if isinstance(e, Derivative):
            orders = {v: int(n) for v, n in e.variable_count}
            if isinstance(e.expr, AppliedUndef) and e.expr.func in FIELDS and set(orders) <= {x, t}:
                return one(e, e.expr, (orders.get(x, 0), orders.get(t, 0)))
            done = e.doit(integrals=False)
            if done == 0:
                raise StatementError(f"{name}: the derivative of {e.expr} is zero: {e} does not vary")
            if done == e:
                raise StatementError(f"{name}: {e} is no derivative of y in x and t; others are not supported")
            return convert(done)
        if isinstance(e, AppliedUndef) and e.func in FIELDS:
            return one(e, e, (0, 0))
        return e.func(*(convert(a) for a in e.args))

    return expand(convert(expression))


def at_place(expression: Expr, place: Expr) -> Expr:
    """An expression in x and in jets along the beam, taken at a place."""
    moved = {j: jet(*j.args[:3], place) for j in expression.atoms(jet) if j.args[3] == ALONG}
    return expression.xreplace(moved).xreplace({x: place})


def varied(expression: Expr) -> Expr:
    """First variation of an expression in jets. Eq. (7)."""
    epsilon = Dummy("epsilon")
    moved = {j: j + epsilon * jet(Integer(1), *j.args[1:]) for j in jets(expression, 0)}
    return expand(expression.xreplace(moved).diff(epsilon).xreplace({epsilon: S.Zero}))


def read_functional(expression: Expr, name: str, length: Expr) -> Functional:
    """Split a work or an energy into its density and its point values, both in jets.

    Raises StatementError for what is not read: a function beside y and F_0, a term that is neither an integral over
    the beam nor values at points, and a term that vanishes.
    """
    density, points = [], []
    # 0.5 stands for 1/2: nothing is rounded in a derivation
    exact = expression.replace(lambda e: e.is_Float, lambda e: nsimplify(e, rational=True))
    for term in Add.make_args(expand(exact)):
        if term.has(S.NaN, S.Infinity, S.NegativeInfinity, S.ComplexInfinity, S.ImaginaryUnit):
            raise StatementError(f"{name}: the term {term} is not a finite real number times y")
        integrals = [f for f in Mul.make_args(term) if isinstance(f, Integral)]
        rest = Mul(*(f for f in Mul.make_args(term) if not isinstance(f, Integral)))
        if not integrals:
            read = _fields_of(term, name)
            points.append(read)
        elif len(integrals) > 1 or rest.has(*FIELDS, x):
            raise StatementError(
                f"{name}: the term {term} multiplies an integral by {rest}; only constants may stand there"
            )
        else:
            (variable, *bounds), *more = integrals[0].limits
            if more or variable != x or bounds != [0, length]:
                raise StatementError(
                    f"{name}: {integrals[0]} does not run over the beam, x from 0 to {length}; "
                    "other integrals are not supported"
                )
            read = _fields_of(rest * integrals[0].function, name)
            density.append(read)
        if read == 0 and expression != 0:
            raise StatementError(f"{name}: the term {term} is zero; {_LOST}")
    result = Functional(expand(Add(*density)), expand(Add(*points)))
    for part, inside in ((result.density, True), (result.points, False)):
        for applied in sorted(part.atoms(AppliedUndef), key=str):
            if applied.func not in (jet, F_0.func):
                raise StatementError(
                    f"{name}: {applied} is never varied; fields and functions beside y and F_0 are not supported"
                )
            if applied.func != jet or (applied.args[3] == ALONG) == inside:
                continue
            if inside:
                raise StatementError(
                    f"{name}: {show(applied)} stands under the integral; a value at a place is not supported there"
                )
            raise StatementError(
                f"{name}: {show(applied)} stands outside an integral; use integral(...) for densities "
                "and at(..., place) for values at points"
            )
    if result.points.has(x):
        raise StatementError(f"{name}: x stands outside an integral; use integral(...) or at(..., place)")
    return result


def show(expression: Expr) -> Expr:
    """A jet expression in derivatives of y(x, t) and delta_y(x, t), for printing."""
    return expression.xreplace({j: _shown(*j.args) for j in expression.atoms(jet)})


@cache
def _shown(which: Expr, p: Expr, r: Expr, place: Expr) -> Expr:
    f = y if which == 0 else variation_of_y
    derivative = f.diff((x, int(p)), (t, int(r))) if int(p) or int(r) else f
    if place == ALONG:
        return derivative
    return Subs(derivative, x, place) if int(p) else derivative.subs(x, place)


def display(functional: Functional, length: Expr = S.One) -> Expr:
    """A functional in jets as the integral and point values that a reader knows."""
    along = integral(show(functional.density), length) if functional.density != 0 else S.Zero
    return along + show(functional.points)


# --- what makes sense -------------------------------------------------------------------------------------


def jets(expression: Expr, which: int | None = None) -> list[Expr]:
    """The jets of an expression, of one field or of both, in a fixed order."""
    found = [j for j in expression.atoms(jet) if which is None or j.args[0] == which]
    return sorted(found, key=lambda j: tuple(str(a) for a in j.args))


def _degree(name: str, expression: Expr, which: int) -> tuple[int, int]:
    """Lowest and highest total degree of an expression in the jets of one field.

    Raises StatementError where it is no polynomial of them.
    """
    variables = jets(expression, which)
    if not variables or expression == 0:
        return 0, 0
    try:
        degrees = [sum(monomial) for monomial in Poly(expression, *variables).monoms()]
    except PolynomialError:
        if expression.has(Piecewise):
            raise StatementError(f"{name}: {show(expression)} is piecewise in x or y, which is not supported") from None
        what = "not linear in the variation" if which else "of higher than second degree in y, or no polynomial of it"
        raise StatementError(f"{name}: {show(expression)} is {what}, which is not supported") from None
    return min(degrees), max(degrees)


def _range(parameter: Parameter) -> tuple[float, float, float]:
    return parameter.default, parameter.low, parameter.high


def _refuse_types(column: Column) -> None:
    """What is not of the kind that a Column holds: refused before anything is computed with it."""
    if not isinstance(column.name, str) or not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", column.name):
        raise StatementError(
            f"name {column.name!r}: lower-case letters, digits and single hyphens, such as 'free-free'"
        )
    ends = column.ends
    if not isinstance(ends, tuple) or len(ends) != 2 or any(not isinstance(e, str) or e not in GEOMETRIC for e in ends):
        raise StatementError(f"ends {ends!r}: a pair of {', '.join(GEOMETRIC)}, at x = 0 and x = 1")
    for name in ("T", "V", "W_c", "dW_nc"):
        value = getattr(column, name)
        if not isinstance(value, Expr | int | float):
            raise StatementError(f"{name} = {value!r}: not a SymPy expression; write it with integral(...) and at(...)")
    if not isinstance(column.parameters, tuple) or not all(isinstance(p, Parameter) for p in column.parameters):
        raise StatementError("parameters: must be a tuple of Parameter, such as (Parameter(eta, ...),)")


def _refuse_unknown(column: Column) -> None:
    own = {p.symbol for p in column.parameters}
    known = {x, t, P, alpha, beta, x_F} | own
    for name in ("T", "V", "W_c", "dW_nc"):
        for symbol in sorted(getattr(column.energies, name).free_symbols - known, key=str):
            if str(symbol) in NOTATION and NOTATION[str(symbol)].symbol == symbol:
                what = (
                    "has no place in a nondimensional statement, Eq. (5), which holds x, t, P, alpha, beta, x_F and "
                    "the column's own parameters"
                )
            elif str(symbol) in NOTATION:
                what = f"is not known; import {symbol} from freebeam_derive.notation"
            elif str(symbol) in map(str, own):
                what = "is not the one that is declared; use one Symbol for both, of the same assumptions"
            else:
                what = f"is not known; declare it: parameters=(Parameter({symbol}, ...),)"
            raise StatementError(f"{name}: the symbol {symbol} {what}")
    for parameter in column.parameters:
        _refuse_name(parameter.name)
        if parameter.latex and not (isinstance(parameter.latex, str) and _LETTER.fullmatch(parameter.latex)):
            raise StatementError(
                f"parameter {parameter.name}: latex {parameter.latex!r} is no letter with marks and scripts in LaTeX, "
                r"without dollars, such as '\\mu' or 'k_{\\mathrm{w}}'; leave it out and the name is shown"
            )
        if [p.name for p in column.parameters].count(parameter.name) > 1:
            raise StatementError(f"parameter {parameter.name}: declared twice; declare it once")
        if not all(isinstance(v, int | float) and math.isfinite(v) for v in _range(parameter)):
            raise StatementError(
                f"parameter {parameter.name}: default, low and high are {_range(parameter)}; give finite numbers"
            )
        if not parameter.low <= parameter.default <= parameter.high:
            raise StatementError(
                f"parameter {parameter.name}: default {parameter.default} lies outside "
                f"{parameter.low} to {parameter.high}"
            )


def _refuse_name(name: str) -> None:
    """A parameter's name that something else has, or that is no name in code."""
    if name in KEYWORDS:
        why = "the name is taken: it is a keyword of the calls that a column's parameters are given to"
    elif name in NOTATION or name in RESERVED or name in MAPS:
        why = "the name is taken"
    # f_i and f_j are the values of f in the two modes of a pair
    elif keyword.iskeyword(name) or not name.isidentifier() or name.endswith(("_i", "_j")):
        why = "the name is not usable in code"
    else:
        return
    other = f"{name}_0" if name.isidentifier() and f"{name}_0" not in NOTATION else "k_0"
    raise StatementError(f"parameter {name!r}: {why}; choose another, such as {other}")


def _refuse_degrees(works: dict[str, Functional]) -> None:
    for name, work in works.items():
        for part in (work.density, work.points):
            if part.xreplace({F_0: S.One}).has(t):
                raise StatementError(
                    f"{name}: time t stands in {show(part)} by itself; only y and F_0 may depend on time here"
                )
            if name == "dW_nc":
                _refuse_virtual_work(part)
            else:
                _refuse_energy(name, part)
    if works["T"].density == 0:
        raise StatementError(
            "T: holds no y.diff(t)**2 under an integral; a beam without mass along the beam is not supported"
        )
    bending = works["V"].density.coeff(jet(Integer(0), Integer(2), Integer(0), ALONG), 2)
    if bending == 0:
        raise StatementError(
            "V: holds no y.diff(x, 2)**2 under an integral; a beam without bending stiffness is not supported"
        )
    inertia = works["T"].density.coeff(jet(Integer(0), Integer(0), Integer(1), ALONG), 2)
    for name, size in (("T", inertia), ("V", bending)):
        if size.is_negative:
            raise StatementError(f"{name}: the energy {display(works[name])} is negative; check its sign")
    for name in ("T", "V", "W_c"):
        for symbol in (P, alpha, beta) if name != "W_c" else (alpha, beta):
            if works[name].density.has(symbol) or works[name].points.has(symbol):
                what = "load P does its work in W_c or dW_nc" if symbol == P else f"damping {symbol} acts in dW_nc"
                raise StatementError(f"{name}: the {what}, not in {name}")


def _refuse_virtual_work(part: Expr) -> None:
    """What δW_nc holds, along the beam or at points."""
    if part != 0 and _degree("dW_nc", part, 1) != (1, 1):
        raise StatementError(
            "dW_nc: the virtual work is not linear in the variation; every term must hold delta(...) once"
        )
    for j in jets(part, 1):
        if j.args[2] != 0:
            raise StatementError(f"dW_nc: holds {show(j)}; a virtual displacement has no rate")
    if _degree("dW_nc", part, 0)[1] > 1:
        raise StatementError("dW_nc: the virtual work is not linear in y; only linear systems are supported")
    for j in jets(part, 0):
        if int(j.args[2]) > 2:
            raise StatementError(f"dW_nc: holds {show(j)}; rates of y up to the second are known")
        if int(j.args[2]) and part.coeff(j).has(P):
            raise StatementError(f"dW_nc: the load P multiplies {show(j)}; a load on a rate of y is not supported")
        if part.coeff(j).has(F_0):
            raise StatementError(f"dW_nc: F_0 multiplies {show(j)}; it is a transversal force, not a load")
    undamped = part.xreplace({j: S.Zero for j in jets(part, 0) if int(j.args[2]) == 1})
    if undamped.has(alpha, beta):
        raise StatementError("dW_nc: alpha and beta are dampings; they multiply first rates of y alone")
    _refuse_powers_of_the_load("dW_nc", part)


def _refuse_energy(name: str, part: Expr) -> None:
    """What T, V or W_c holds, along the beam or at points."""
    if jets(part, 1):
        raise StatementError(f"{name}: an energy holds no delta(...), which stands in dW_nc alone")
    low, high = _degree(name, part, 0)
    if high > 2:
        raise StatementError(f"{name}: of higher than second degree in y; only quadratic energies are supported")
    if part.has(F_0) and high > 1:
        raise StatementError(f"{name}: F_0 must not multiply a square of y; it is a transversal force, not a load")
    for j in jets(part, 0):
        if int(j.args[2]) != (1 if name == "T" else 0):
            kind = "first rates of y only" if name == "T" else "y without rates"
            raise StatementError(f"{name}: holds {show(j)}; it must be made of {kind}")
    if name == "T" and low < 2 and part != 0:
        raise StatementError("T: must be quadratic in the rates of y")
    for term in Add.make_args(part):
        if term != 0 and not jets(term):
            raise StatementError(f"{name}: the term {show(term)} does not hold y, so that it does no work")
    _refuse_powers_of_the_load(name, part)


def _refuse_powers_of_the_load(name: str, part: Expr) -> None:
    times = part.coeff(P, 1)
    if times.has(P) or expand(part - part.coeff(P, 0) - P * times) != 0:
        raise StatementError(f"{name}: the load P must enter linearly (K = E + P H)")


def check(column: Column) -> None:
    """Refuse a statement that makes no sense; further checks need the variation (variation.py)."""
    _refuse_types(column)
    if column.basis not in bases():
        raise StatementError(f"basis = {column.basis!r}: must be one of {', '.join(bases())}")
    if type(column.modes) is not int or column.modes < 1:
        raise StatementError(f"modes = {column.modes!r}: must be a whole number, 1 or greater")
    _refuse_unknown(column)
    works = {name: column.energies.functional(name) for name in ("T", "V", "W_c", "dW_nc")}
    _refuse_degrees(works)
    if not any(w.coefficient(P) for w in (works["W_c"], works["dW_nc"])):
        raise StatementError("the load P does no work: it must stand in W_c or in dW_nc")


# --- finding columns --------------------------------------------------------------------------------------


def load_column(path: Path | str) -> Column:
    """Read the file of a column, ours or a user's own.

    Raises StatementError in one line: the file cannot be read, does not parse, states no `column`, or states
    one that makes no sense.
    """
    path = Path(path)
    if path.is_dir():
        raise StatementError(f"{path}: is a folder; give the file of a column, such as column.py")
    try:
        with _lost_derivatives_refused():
            found = runpy.run_path(str(path)).get("column")
    except StatementError as error:
        raise StatementError(f"{path}: {error}") from error
    except SyntaxError as error:
        line = f", line {error.lineno}" if error.lineno else ""
        raise StatementError(f"{path}{line}: does not parse as Python: {error.msg}") from error
    except OSError as error:
        raise StatementError(
            f"{path}: cannot be read: {error.strerror}; give the file of a column, such as column.py"
        ) from error
    except (Exception, SystemExit) as error:
        raise StatementError(f"{path}: fails with {type(error).__name__}: {' '.join(str(error).split())}") from error
    if not isinstance(found, Column):
        raise StatementError(f"{path}: states no column; it must end in `column = Column(...)`")
    return found


_ONE_FILE = threading.RLock()  # a file may load another


@contextmanager
def _lost_derivatives_refused() -> Iterator[None]:
    """While a file is read, a derivative of y or delta_y that is zero is refused, and not lost.

    The value y(1, t) does not hold x, so that SymPy takes its derivative in x for zero at once, and nothing is left of
    the term that it stood in: a follower force, say. The same becomes of a derivative in another Symbol("x").
    """
    with _ONE_FILE:
        before = Derivative.__dict__["__new__"]

        def refuse(kind: type, expression: Any, *variables: Any, **settings: Any) -> Expr:
            found = before.__func__(kind, expression, *variables, **settings)
            named = {str(s) for v in variables for s in (v if isinstance(v, tuple | Tuple) else (v,))}
            if found == 0 and named & {"x", "t"} and sympify(expression).has(*FIELDS):
                raise StatementError(
                    f"a derivative of {expression} is zero: a value at a place is taken after the derivative, such as "
                    "at(y.diff(x), 1), and x and t are those of freebeam_derive.notation"
                )
            return found

        Derivative.__new__ = staticmethod(refuse)
        try:
            yield
        finally:
            Derivative.__new__ = before


@lru_cache(maxsize=1)
def columns() -> dict[str, Path]:
    """Names and files of the columns of this tree, in the order in which they are listed."""
    folder = Path(__file__).parent / "columns"
    return {path.stem.replace("_", "-"): path for path in sorted(folder.glob("[a-z]*.py"))}


@lru_cache(maxsize=1)
def bases() -> tuple[str, ...]:
    """Names of the bases: trial functions of a column, a file each."""
    return tuple(sorted(path.stem for path in (Path(__file__).parent / "bases").glob("[a-z]*.py")))
