"""What a column is: energies, virtual work, ends and parameters, close to how Eq. (8) is printed.

A column's file states one `column = Column(...)` with four helpers: `integral` (over the beam), `at` (a value
at a point), `delta` (the variation) and `Parameter`. `load_column` reads such a file from anywhere. A statement
that makes no sense is refused with the reason, as a `StatementError`.

Inside the program a functional is held in jets: `jet(field, p, r, place)` is d^p/dx^p d^r/dt^r of the deflection
(field 0) or of the virtual displacement (field 1), along the beam or at a point, so that it is a polynomial.
"""

from __future__ import annotations

import keyword
import math
import re
import runpy
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from pathlib import Path

from sympy import (
    Add,
    Derivative,
    Dummy,
    Expr,
    Function,
    Integer,
    Integral,
    Mul,
    Poly,
    S,
    Subs,
    Symbol,
    expand,
    nsimplify,
    sympify,
)
from sympy.core.function import AppliedUndef

from freebeam_derive.notation import F_0, NOTATION, P, alpha, beta, t, variation_of_y, x, x_F, y

# Geometric conditions of each kind of end: the orders of derivative that it holds at zero. The natural ones
# are derived from the energies (variation.py).
GEOMETRIC: dict[str, tuple[int, ...]] = {"free": (), "pinned": (0,), "sliding": (1,), "clamped": (0, 1)}

BASES = ("modes", "legendre")
RESERVED = ("np", "basis", "rigid")  # what every emitted function of a matrix knows by these names
# What public calls that take a column's own parameters as keywords call so themselves; a test compares these with the
# calls' signatures.
KEYWORDS = frozenset(
    """
    self column modes load loads load_max kappa beam digits progress series vectors
    parameter low high log tolerance values name
    step chunks scheduler workers store convergence
    ax color count label moments normalised part points width
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

ALONG = Symbol("along")  # the place of a jet that is a function of x
jet = Function("jet")


class StatementError(ValueError):
    """A column's statement that makes no sense; the message is one line with the reason and the cure."""


def integral(density: Expr, length: Expr = S.One) -> Expr:
    """Integral of a density over the beam, x from 0 to `length` (1 in a nondimensional statement)."""
    return Integral(density, (x, 0, length))


def at(expression: Expr, place: Expr | int) -> Expr:
    """Value of an expression in y or delta(y) at a place along the beam."""
    return Subs(expression, x, sympify(place))


def delta(expression: Expr) -> Expr:
    """First variation of an expression in y: y -> y + epsilon delta_y, differentiated at epsilon = 0. Eq. (7)."""
    epsilon = Dummy("epsilon")
    varied = expression.subs(y, y + epsilon * variation_of_y).doit()
    return varied.diff(epsilon).subs(epsilon, 0).doit()


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


def _fields_of(expression: Expr) -> Expr:
    """Replace derivatives and values of y and delta_y by jets."""

    def one(e: Expr, place: Expr, orders: tuple[int, int]) -> Expr:
        return jet(Integer(0 if e.func == y.func else 1), Integer(orders[0]), Integer(orders[1]), place)

    def convert(e: Expr) -> Expr:
        if isinstance(e, Subs):
            inner, place = convert(e.expr), e.point[0]
            along = {j: jet(*j.args[:3], place) for j in inner.atoms(jet) if j.args[3] == ALONG}
            return inner.xreplace(along).xreplace({x: place})
        if (
            isinstance(e, Derivative)
            and isinstance(e.expr, AppliedUndef)
            and e.expr.func in (y.func, variation_of_y.func)
        ):
            orders = {v: int(n) for v, n in e.variable_count}
            place = e.expr.args[0]
            if set(orders) <= {x, t}:
                return one(e.expr, ALONG if place == x else place, (orders.get(x, 0), orders.get(t, 0)))
        if isinstance(e, AppliedUndef) and e.func in (y.func, variation_of_y.func):
            return one(e, ALONG if e.args[0] == x else e.args[0], (0, 0))
        if not e.args or isinstance(e, AppliedUndef | Derivative):
            return e
        return e.func(*(convert(a) for a in e.args))

    return expand(convert(expression))


def read_functional(expression: Expr, name: str, length: Expr) -> Functional:
    """Split a work or an energy into its density and its point values, both in jets.

    Raises StatementError for a field that is not varied, and for terms that are neither an integral over the
    beam nor values at points.
    """
    density, points = [], []
    # 0.5 stands for 1/2: nothing is rounded in a derivation
    exact = expression.replace(lambda e: e.is_Float, lambda e: nsimplify(e, rational=True))
    for term in Add.make_args(expand(exact)):
        integrals = [f for f in Mul.make_args(term) if isinstance(f, Integral)]
        rest = Mul(*(f for f in Mul.make_args(term) if not isinstance(f, Integral)))
        if not integrals:
            points.append(_fields_of(term))
            continue
        if len(integrals) > 1 or rest.has(y.func, variation_of_y.func, x):
            raise StatementError(
                f"{name}: the term {term} multiplies an integral by {rest}; only constants may stand there"
            )
        (variable, *bounds), *more = integrals[0].limits
        if more or variable != x or bounds != [0, length]:
            raise StatementError(f"{name}: {integrals[0]} must run over the beam; write integral(...)")
        density.append(_fields_of(rest * integrals[0].function))
    result = Functional(expand(Add(*density)), expand(Add(*points)))
    for part, where in ((result.density, "under the integral"), (result.points, "outside an integral")):
        for applied in part.atoms(AppliedUndef):
            if applied.func not in (jet, F_0.func):
                raise StatementError(
                    f"{name}: the field {applied} is never varied; Hamilton's principle here varies y alone: "
                    f"write it in terms of y, or give it as a Parameter"
                )
            if applied.func == jet and (applied.args[3] == ALONG) != (part is result.density):
                raise StatementError(
                    f"{name}: {show(applied)} stands {where}; use integral(...) for densities "
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


def _degree(expression: Expr, which: int) -> tuple[int, int]:
    """Lowest and highest total degree of an expression in the jets of one field."""
    variables = jets(expression, which)
    if not variables or expression == 0:
        return 0, 0
    try:
        degrees = [sum(monomial) for monomial in Poly(expression, *variables).monoms()]
    except Exception:
        return -1, 99
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
                cure = (
                    "leave it out: a nondimensional statement, Eq. (5), holds x, t, P, alpha, beta, x_F and parameters"
                )
            elif str(symbol) in NOTATION:
                cure = f"import {symbol} from freebeam_derive.notation"
            else:
                cure = f"declare it: parameters=(Parameter({symbol}, ...),)"
            raise StatementError(f"{name}: the symbol {symbol} is not known; {cure}")
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
                if part != 0 and _degree(part, 1) != (1, 1):
                    raise StatementError(
                        "dW_nc: the virtual work is not linear in the variation; every term must hold delta(...) once"
                    )
                if any(j.args[2] != 0 for j in jets(part, 1)):
                    raise StatementError(
                        "dW_nc: a virtual displacement has no rate; write the variation without a time derivative"
                    )
                low, high = _degree(part, 0)
                if high > 1 or low < 0:
                    raise StatementError(
                        "dW_nc: the virtual work is not linear in y; a linear stability analysis needs it linearised"
                    )
                for j in jets(part, 0):
                    if int(j.args[2]) > 2:
                        raise StatementError(f"dW_nc: holds {show(j)}; rates of y up to the second are known")
                    if int(j.args[2]) == 1 and part.coeff(j).has(P):
                        raise StatementError(f"dW_nc: the load P multiplies {show(j)}; a load does no work on a rate")
                undamped = part.xreplace({j: S.Zero for j in jets(part, 0) if int(j.args[2]) == 1})
                if undamped.has(alpha, beta):
                    raise StatementError("dW_nc: alpha and beta are dampings; they multiply first rates of y alone")
                continue
            if jets(part, 1):
                raise StatementError(f"{name}: an energy holds no delta(...); virtual work goes into dW_nc")
            low, high = _degree(part, 0)
            if high > 2 or low < 0:
                raise StatementError(
                    f"{name}: of higher than second degree in y; a linear stability analysis needs quadratic energies"
                )
            if part.has(F_0) and high > 1:
                raise StatementError(
                    f"{name}: F_0 must not multiply a square of y; it is a transversal force, not a load"
                )
            for j in jets(part, 0):
                if int(j.args[2]) != (1 if name == "T" else 0):
                    kind = "first rates of y only" if name == "T" else "y without rates"
                    raise StatementError(f"{name}: holds {show(j)}; it must be made of {kind}")
            if name == "T" and low < 2 and part != 0:
                raise StatementError("T: must be quadratic in the rates of y")
    if works["T"].density == 0:
        raise StatementError(
            "T: no kinetic energy along the beam, so the field is never set in motion; state T with y.diff(t)**2"
        )
    bending = works["V"].density.coeff(jet(Integer(0), Integer(2), Integer(0), ALONG), 2)
    if bending == 0:
        raise StatementError("V: the bending energy does not contain y'' squared; a beam needs y.diff(x, 2)**2 in V")
    inertia = works["T"].density.coeff(jet(Integer(0), Integer(0), Integer(1), ALONG), 2)
    for name, size in (("T", inertia), ("V", bending)):
        if size.is_negative:
            raise StatementError(f"{name}: the energy {display(works[name])} is negative; change its sign")
    for name in ("T", "V", "W_c"):
        for symbol in (P, alpha, beta) if name != "W_c" else (alpha, beta):
            if works[name].density.has(symbol) or works[name].points.has(symbol):
                what = "load P does its work in W_c or dW_nc" if symbol == P else f"damping {symbol} acts in dW_nc"
                raise StatementError(f"{name}: the {what}, not in {name}")
    for name in ("W_c", "dW_nc"):
        for part in (works[name].density, works[name].points):
            if part.has(P) and (part.diff(P, 2) != 0 or part.subs(P, 0).has(P)):
                raise StatementError(f"{name}: the load P must enter linearly (K = E + P H)")


def check(column: Column) -> None:
    """Refuse a statement that makes no sense; further checks need the variation (variation.py)."""
    _refuse_types(column)
    if column.basis not in BASES:
        raise StatementError(f"basis = {column.basis!r}: must be one of {', '.join(BASES)}")
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


@lru_cache(maxsize=1)
def columns() -> dict[str, Path]:
    """Names and files of the columns of this tree, in the order in which they are listed."""
    folder = Path(__file__).parent / "columns"
    return {path.stem.replace("_", "-"): path for path in sorted(folder.glob("[a-z]*.py"))}
