"""What a column is: energies, virtual work, ends and parameters, close to how Eq. (8) is printed.

A column's file states one `column = Column(...)` with a few helpers: `integral` (over the beam or a part of it), `at`
(a value at a place), `jump` (of a value at a place), `delta` (the variation), `hinge`, and `Field`, `Coordinate` and
`Parameter` to declare what is not there. `load_column` reads such a file from anywhere. A statement that makes no
sense, or that is not supported, is refused with the reason, as a `StatementError`.
"""

from __future__ import annotations

import keyword
import math
import re
import runpy
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

from sympy import (
    Add,
    Derivative,
    Expr,
    Mul,
    Piecewise,
    Poly,
    PolynomialError,
    S,
    Symbol,
    Tuple,
    degree,
    expand,
    nan,
    sympify,
)
from sympy.core.function import AppliedUndef

from freebeam_derive.display import display
from freebeam_derive.jets import (
    ALONG,
    Beam,
    Coordinate,
    Field,
    Functional,
    Hinge,
    Reading,
    StatementError,
    at,
    at_place,
    beside,
    delta,
    hinge,
    integral,
    jet,
    jets,
    jump,
    kind_of,
    name_of,
    on_segments,
    read,
    segment_of,
    show,
    trial,
    unknowns,
    varied,
)
from freebeam_derive.notation import EI, F_0, NOTATION, L, P, alpha, beta, m, t, x, x_F
from freebeam_derive.references import Reference
from freebeam_derive.units import SCALES, Quantity, unit_of

__all__ = [
    "ALONG",
    "Column",
    "Coordinate",
    "Energies",
    "Field",
    "Functional",
    "GEOMETRIC",
    "Parameter",
    "Reference",
    "StatementError",
    "at",
    "at_place",
    "bases",
    "columns",
    "delta",
    "display",
    "gallery",
    "hinge",
    "integral",
    "jet",
    "jets",
    "jump",
    "load_column",
    "show",
    "varied",
]

# Geometric conditions of each kind of end: the orders of derivative of the deflection that it holds at zero. The
# natural ones are derived from the energies (variation.py).
GEOMETRIC: dict[str, tuple[int, ...]] = {"free": (), "pinned": (0,), "sliding": (1,), "clamped": (0, 1)}

# what every emitted function of a matrix knows by these names, and the names of the places of jets
RESERVED = ("np", "basis", "rigid", "along", "always")
# What public calls that take a column's own parameters as keywords call so themselves; a test compares these with the
# calls' signatures.
KEYWORDS = frozenset(
    """
    self column modes load loads load_max kappa beam digits progress series vectors
    parameter low high log tolerance values name
    step chunks scheduler workers store convergence
    ax above color count label moments normalised part width
    amplitude frequency rigid x_F x_s
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
class Energies:
    """T, V, W_c and the virtual work δW_nc of Eq. (8), as SymPy expressions over 0 ≤ x ≤ length, cut at places."""

    T: Expr
    V: Expr
    W_c: Expr = S.Zero
    dW_nc: Expr = S.Zero
    length: Expr = S.One
    cuts: tuple[Expr, ...] = ()
    scaling: Mapping[Expr, Expr] = field(default_factory=dict)
    """Of a dimensional statement: what its own quantities are in nondimensional ones, {m_tip: mu * m * L}, the load
    where it is no force, {P: P * sqrt(EI / m) / L} of a velocity, and unknowns, {q: L * q}."""

    @property
    def beam(self) -> Beam:
        return Beam(self.length, self.cuts)

    def reading(self, name: str) -> Reading:
        """T, V, W_c or dW_nc in jets, not yet cut into segments."""
        return read(sympify(getattr(self, name)), name, self.length)

    def functional(self, name: str) -> Functional:
        """T, V, W_c or dW_nc in jets."""
        return on_segments(self.reading(name), self.beam)


@dataclass(frozen=True)
class Column:
    """A column: its energies and virtual work, ends and parameters; data, and nothing else.

    name: lower case with hyphens. title: one line. T, V, W_c, dW_nc: nondimensional, in `y`, `delta(y)`, `x`,
    `t`, the load `P`, `alpha`, `beta`, the force `F_0` at `x_F`, the column's own parameters, and further fields and
    coordinates; W_c and dW_nc are left out where they are nothing. ends: kinds at x = 0 and x = 1, each free, pinned,
    sliding or clamped, of all fields; or of each field, {y: ("clamped", "free"), psi: ("clamped", "free")}; left out
    where there is no field. dimensional: the same in SI quantities, if given; then the nondimensional one is derived
    from it and compared (scaling.py). basis, modes: the trial functions where none are asked for, and their number.
    releases: hinges inside the beam. family: of the columns that it is listed with. references: critical loads to
    compare with.

    Raises StatementError where the statement makes no sense.
    """

    name: str
    title: str
    T: Expr
    V: Expr
    W_c: Expr = S.Zero
    dW_nc: Expr = S.Zero
    ends: Any = ()  # a pair of kinds, or {field: pair}
    parameters: tuple[Parameter, ...] = ()
    dimensional: Energies | None = None
    source: str = ""
    basis: str = "legendre"
    modes: int = 16
    releases: tuple[Hinge, ...] = ()
    family: str = ""
    references: tuple[Reference, ...] = ()

    def __post_init__(self) -> None:
        check(self)
        if self.dimensional is not None and self.cuts:
            length, own = self.dimensional.length, self.dimensional.scaling
            sizes = {
                next(iter(sympify(value).free_symbols & set(self.defaults))): (key, value)
                for key, value in own.items()
                if key.is_Symbol and len(sympify(value).free_symbols & set(self.defaults)) == 1
            }
            cuts = tuple(expand(length * cut.subs({p: p * k / v for p, (k, v) in sizes.items()})) for cut in self.cuts)
            object.__setattr__(self, "dimensional", replace(self.dimensional, cuts=cuts))

    @cached_property
    def energies(self) -> Energies:
        return replace(self._uncut, cuts=self.cuts)

    @cached_property
    def _uncut(self) -> Energies:
        return Energies(sympify(self.T), sympify(self.V), sympify(self.W_c), sympify(self.dW_nc))

    @cached_property
    def cuts(self) -> tuple[Expr, ...]:
        """Places inside the beam at which it is cut into segments, ascending at the parameters' defaults.

        Raises StatementError where one lies beyond the beam, or two have no order.
        """
        if not self.fields:
            return ()
        found = {cut for name in WORKS for cut in self._uncut.reading(name).cuts(S.One)}
        found |= {release.place for release in self.releases}
        return _in_order({expand(cut) for cut in found} - {S.Zero, S.One}, self.defaults)

    @cached_property
    def defaults(self) -> dict[Symbol, float]:
        """The parameters at their defaults."""
        return {p.symbol: p.default for p in self.parameters}

    @cached_property
    def unknowns(self) -> tuple[Any, ...]:
        """The functions that the statement is about: y first, the others in the order of their names."""
        functions = {a.func for name in WORKS for a in sympify(getattr(self, name)).atoms(AppliedUndef)}
        functions = {f for f in functions if kind_of(f) and not str(f).startswith("delta_")}
        order = unknowns(sympify(getattr(self, name)) for name in WORKS)
        return tuple(sorted(functions, key=lambda f: order.index(str(f))))

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the fields along the beam, y first."""
        return tuple(str(f) for f in self.unknowns if kind_of(f) == "field")

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of time alone."""
        return tuple(str(f) for f in self.unknowns if kind_of(f) == "coordinate")

    def supports(self, name: str) -> tuple[str, str]:
        """Kinds of the ends of a field, at x = 0 and x = 1."""
        if isinstance(self.ends, Mapping):
            first, second = next(kinds for field, kinds in self.ends.items() if str(field.func) == name)
        else:
            first, second = self.ends
        return first, second

    def held(self, name: str, joined: int) -> frozenset[tuple[int, int]]:
        """(end, order) at which a field is held at zero; joined: derivatives below this order are continuous.

        Ends that are given for all fields hold y as they say, and another field where they hold the slope."""
        held = set()
        for end, kind in enumerate(self.supports(name)):
            if name == "y" or isinstance(self.ends, Mapping):
                held |= {(end, order) for order in GEOMETRIC[kind] if order < joined}
            elif 1 in GEOMETRIC[kind]:
                held |= {(end, order) for order in range(joined) if kind == "clamped" or order == 0}
        return frozenset(held)

    @property
    def module(self) -> str:
        """Name of the emitted module."""
        return self.name.replace("-", "_")

    @property
    def damping(self) -> tuple[str, ...]:
        """The dampings that the virtual work contains, of alpha and beta."""
        return tuple(str(s) for s in (alpha, beta) if self.energies.dW_nc.has(s))

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """SI quantities of its own: "load" where that is no force in EI / L², what the dimensional statement calls the
        quantity of a parameter, such as "m_tip" of mu, and its coordinates. Without a unit is a load to which nothing
        gives one.

        Raises StatementError where a quantity of the dimensional statement has no unit, or the name of another.
        """
        given = self.dimensional.scaling if self.dimensional is not None else {}
        own, found = set(self.defaults), {}
        if P in given:
            found["load"] = _quantity("load", sympify(given[P]) / P, own)
        elif (unit := self._load_unit) != "N" and (unit or self.dimensional is None):
            found["load"] = Quantity(SCALES["load"] * {"N m": L, "N/m": 1 / L}.get(unit, 1), unit)
        for key, value in given.items():
            of = sorted(sympify(value).free_symbols & own, key=str)
            if key == P or not key.is_Symbol or len(of) != 1 or (sympify(value) / of[0]).has(of[0]) or key == of[0]:
                continue
            if str(key) in {*SCALES, *map(str, own)}:
                raise StatementError(f"scaling: {key} is the name of another quantity; give it one of its own")
            found[str(key)] = replace(_quantity(str(key), sympify(value) / of[0], set()), of=str(of[0]))
        if self.dimensional is not None:
            sizes = {str(key.func): sympify(value) / key for key, value in given.items() if not key.is_Symbol}
            found |= {name: _quantity(name, sizes.get(name, S.One), set()) for name in self.coordinates}
        return found

    @cached_property
    def scaling(self) -> dict[Expr, Expr]:
        """What quantities of the dimensional statement are in nondimensional ones, and fields and coordinates that are
        no angles: those that it says, the load, and fields whose curvature the energy holds, which are lengths."""
        given = self.dimensional.scaling if self.dimensional is not None else {}
        lengths = {f(x, t): L * f(x, t) for f in self.unknowns if kind_of(f) == "field" and self._is_length(str(f))}
        return {P: self.scales["load"] * P, **lengths, **given}

    def _is_length(self, name: str) -> bool:
        works = {work: self.energies.functional(work) for work in WORKS}
        return name == "y" or joined(works, name) == 2

    @property
    def scales(self) -> dict[str, Expr]:
        """SI size of one nondimensional unit of each quantity, in EI, m, L and parameters. Eq. (5)."""
        return SCALES | {name: quantity.size for name, quantity in self.quantities.items()}

    @property
    def _load_unit(self) -> str:
        """The load's unit in SI, where its work tells it: "N", of a torque "N m", of a force per length "N/m"; ""
        where it does not, as of a flow's velocity and of what acts on coordinates.

        A field whose curvature the energy holds, and y, are lengths, others angles; x is a share of the length.
        """
        works, powers = {name: self.energies.functional(name) for name in WORKS}, set()
        lengths = {name: int(self._is_length(name)) for name in self.fields}
        for part, along in ((part, k) for work in works.values() for k, part in enumerate((work.points, work.density))):
            for term in Add.make_args(expand(part)):
                held = [j for j in jets(term) for _ in range(int(degree(term, j)))]
                if degree(term, P) != 1 or any(int(j.args[2]) for j in held):
                    continue
                if "y" not in lengths or any(name_of(j.args[0]) not in lengths for j in held):
                    return ""
                powers.add(along + sum(lengths[name_of(j.args[0])] - int(j.args[1]) for j in held))
        if powers == {1, 2}:  # a force per length, whose resultant other terms hold
            return "N"
        return {0: "N m", 1: "N", 2: "N/m"}.get(powers.pop(), "") if len(powers) == 1 else ""

    @property
    def forced(self) -> bool:
        """Whether the transversal force F_0 does work."""
        return bool(self.energies.dW_nc.has(F_0) or self.energies.W_c.has(F_0))


def _quantity(name: str, size: Expr, parameters: set[Symbol]) -> Quantity:
    try:
        if unknown := size.free_symbols - {EI, m, L} - parameters:
            raise ValueError(f"its size {size} holds {', '.join(sorted(map(str, unknown)))}")
        return Quantity(size, unit_of(size))
    except ValueError as error:
        raise StatementError(f"scaling: {name}: {error}") from None


def _refuse_off_the_beam(column: Column) -> None:
    for name in WORKS:
        for j in jets(column._uncut.reading(name).points):
            place = j.args[3].args[0] if j.args[3].func == beside else j.args[3]
            value = place.subs(column.defaults)
            if value.is_number and not (value.is_real and 0 <= value <= 1):
                raise StatementError(f"{name}: {show(j)} is taken off the beam, which runs from x = 0 to x = 1")


def _in_order(cuts: set[Expr], defaults: Mapping[Symbol, float]) -> tuple[Expr, ...]:
    """Places inside the beam by their values at the parameters' defaults; those beyond it are no cuts."""
    placed = []
    for cut in cuts:
        value = cut.subs(defaults)
        if not value.is_number or not value.is_real or (cut.free_symbols and not 0 < value < 1):
            raise StatementError(f"the place {cut} is {value} at the parameters' defaults; give one between 0 and 1")
        if 0 < value < 1:
            placed.append((float(value), str(cut), cut))
    for (value, _, one), (other, _, two) in pairwise(sorted(placed)):
        if other - value < 1e-9:
            raise StatementError(
                f"the places {one} and {two} are both {value:g} at the parameters' defaults; give defaults that put "
                "one before the other"
            )
    return tuple(cut for *_, cut in sorted(placed))


# --- what makes sense -------------------------------------------------------------------------------------


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
        if any(jets(piecewise) for piecewise in expression.atoms(Piecewise)):
            raise StatementError(f"{name}: {show(expression)} is piecewise in y, which is not supported") from None
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
    pairs = column.ends.values() if isinstance(column.ends, Mapping) else (column.ends,) if column.ends != () else ()
    for ends in pairs:
        if (
            not isinstance(ends, tuple)
            or len(ends) != 2
            or any(not isinstance(e, str) or e not in GEOMETRIC for e in ends)
        ):
            raise StatementError(f"ends {ends!r}: a pair of {', '.join(GEOMETRIC)}, at x = 0 and x = 1")
    if not isinstance(column.releases, tuple) or not all(isinstance(r, Hinge) for r in column.releases):
        raise StatementError("releases: must be a tuple of hinges, such as (hinge(0.5),)")
    for name in WORKS:
        value = getattr(column, name)
        if not isinstance(value, Expr | int | float):
            raise StatementError(f"{name} = {value!r}: not a SymPy expression; write it with integral(...) and at(...)")
    if not isinstance(column.parameters, tuple) or not all(isinstance(p, Parameter) for p in column.parameters):
        raise StatementError("parameters: must be a tuple of Parameter, such as (Parameter(eta, ...),)")
    if not isinstance(column.references, tuple) or not all(isinstance(r, Reference) for r in column.references):
        raise StatementError("references: must be a tuple of Reference, such as (Reference('20.05', 'flutter', ...),)")


def _refuse_unknown(column: Column) -> None:
    own = {p.symbol for p in column.parameters}
    known = {x, t, P, alpha, beta, x_F} | own
    for name in WORKS:
        for symbol in sorted(sympify(getattr(column, name)).free_symbols - known, key=str):
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


def _refuse_degrees(column: Column, works: dict[str, Functional]) -> None:
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
    for name in column.fields:
        _refuse_strength(column, works, name)
    for name in column.coordinates:
        rates = (*jets(works["T"].points + works["T"].density, 0), *jets(works["dW_nc"].points, 0))
        if not any(name_of(j.args[0]) == name and int(j.args[2]) for j in rates):
            raise StatementError(
                f"the coordinate {name} is moved by nothing: no rate of it stands in T or in dW_nc; give it a mass or "
                "a damper, or eliminate it"
            )


def joined(works: Mapping[str, Functional], name: str) -> int:
    """The highest derivative of a field whose square the energy V holds: all below are continuous along the beam."""
    V = works["V"].density
    return max((p for p in range(4) for s in _places(V) if _square(V, name, p, 0, s) != 0), default=0)


def _places(density: Expr) -> list[Expr]:
    return sorted({j.args[3] for j in jets(density) if segment_of(j.args[3]) is not None}, key=str)


def _square(density: Expr, name: str, order: int, rate: int, place: Expr) -> Expr:
    """The factor of the square of a derivative of a field on a segment."""
    return density.coeff(jet(trial(name), order, rate, place), 2)


def _refuse_strength(column: Column, works: dict[str, Functional], name: str) -> None:
    """A field without inertia or without stiffness, or with negative ones."""
    order = joined(works, name)
    used = [int(j.args[1]) for w in works.values() for j in jets(w.density) if name_of(j.args[0]) == name]
    highest = max(used, default=0)
    if highest > 2:
        raise StatementError(
            f"a derivative of order {highest} of {name}: a beam takes a force or a moment, nothing higher"
        )
    moves = any(int(j.args[2]) and name_of(j.args[0]) == name for j in jets(works["T"].density))
    if not moves and (name == "y" or _loaded(works, name)):
        raise StatementError(
            f"T: holds no {name}.diff(t)**2 under an integral; a beam without mass along the beam is not supported, "
            "but for a field other than y that the load multiplies in no product with itself: give "
            f"{name} the inertia that it has, however small"
        )
    if order < max(highest, 1):
        wanted = f"{name}.diff(x, 2)**2" if max(highest, 1) == 2 or name == "y" else f"{name}.diff(x)**2"
        what = "bending stiffness" if name == "y" else "stiffness"
        raise StatementError(f"V: holds no {wanted} under an integral; a beam without {what} is not supported")
    stiffness = "bending stiffness" if order == 2 else "stiffness"
    for work, what, p, rate in (("T", "mass", 0, 1), ("V", stiffness, order, 0))[not moves :]:
        for segment, place in enumerate(column.energies.beam.segments):
            factor = 2 * _square(works[work].density, name, p, rate, place)
            if factor != 0 or work == "V" or not _turns(works["T"].density, name, place):
                held = [order - 1 in GEOMETRIC[end] for end in column.supports(name)]
                _refuse_negative(column, works[work], work, what, factor, segment, held)


def _loaded(works: Mapping[str, Functional], name: str) -> bool:
    """Whether the load multiplies a product of a field with itself, or with its variation."""
    for work in works.values():
        for part in (work.density, work.points):
            for term in Add.make_args(part.expand()):
                held = [j for kind in (0, 1) for j in jets(term, kind)]
                if term.has(P) and held and all(name_of(j.args[0]) == name for j in held):
                    return True
    return False


def _turns(T: Expr, name: str, place: Expr) -> bool:
    """Whether a field has inertia on a segment by another derivative, or together with another field."""
    return any(name_of(j.args[0]) == name and int(j.args[2]) and j.args[3] == place for j in jets(T))


def _refuse_negative(
    column: Column, work: Functional, name: str, what: str, factor: Expr, segment: int, held: list[bool]
) -> None:
    if factor.is_negative:
        raise StatementError(f"{name}: the energy {display(work, S.One, column.cuts)} is negative; check its sign")
    low, high = (float(place.subs(column.defaults)) for place in column.energies.beam.places[segment : segment + 2])
    at_defaults = factor.subs({**column.defaults, P: S.Zero})
    # stiffness must not vanish at a break either, nor where an end holds the slope: it would be a hinge, which
    # polynomials do not come near; at an end that is free or pinned it may
    breaks = (low > 0 or held[0], high < 1 or held[1]) if name == "V" else (False, False)
    for k in range(1 - breaks[0], 64 + breaks[1]):
        where = low + (high - low) * k / 64
        value = at_defaults.subs(x, where)
        if value.is_real and not value > 1e-12 * (k in (0, 64)):
            raise StatementError(
                f"{name}: the {what} {factor} is {float(value):.3g} at x = {where:.4g}, at the parameters' defaults; "
                "it must be positive along the beam"
            )
        if value is nan or value.is_infinite or value.is_real is False:
            raise StatementError(
                f"{name}: the {what} {factor} is no real number at x = {where:.4g}, at the parameters' defaults"
            )
        if not factor.has(x):
            break


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
        if part.coeff(j).has(F_0):
            raise StatementError(f"dW_nc: F_0 multiplies {show(j)}; it is a transversal force, not a load")
    undamped = part.xreplace({j: S.Zero for j in jets(part, 0) if int(j.args[2]) < 2})
    if undamped.has(alpha, beta):
        raise StatementError(
            "dW_nc: alpha and beta are dampings; they multiply first rates, or displacements as of a shaft that turns"
        )
    if part.has(alpha, beta) and Poly(part, alpha, beta).total_degree() > 1:
        raise StatementError("dW_nc: alpha and beta are dampings; they enter linearly, and do not multiply each other")
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
        if int(j.args[2]) > (1 if name == "T" else 0):
            kind = "first rates of y only" if name == "T" else "y without rates"
            raise StatementError(f"{name}: holds {show(j)}; it must be made of {kind}")
    if name == "T" and low < 2 and part != 0:
        raise StatementError("T: must be quadratic in the rates of y")
    for term in Add.make_args(part):
        if term != 0 and not jets(term):
            raise StatementError(f"{name}: the term {show(term)} does not hold y, so that it does no work")
        if name == "T" and term != 0 and not any(int(j.args[2]) for j in jets(term)):
            _refuse_without_rate(part, term)
    if part.has(alpha, beta):
        damping = alpha if part.has(alpha) else beta
        raise StatementError(f"{name}: the damping {damping} acts in dW_nc, not in {name}")
    _refuse_powers_of_the_load(name, part)


def _refuse_without_rate(T: Expr, term: Expr) -> None:
    """A term of T without rates, but in a rotating frame: what it holds then multiplies a rate in another term."""
    for j in jets(term):
        if not any(int(other.args[2]) for with_j in Add.make_args(T) if with_j.has(j) for other in jets(with_j)):
            raise StatementError(
                f"T: holds {show(term)}, which has no rate; write the rate where it was forgotten, such as y.diff(t), "
                "and the potential of a centrifugal force in V, with the other sign"
            )


def _refuse_powers_of_the_load(name: str, part: Expr) -> None:
    if part.has(P) and not part.is_polynomial(P):
        raise StatementError(f"{name}: the load P must enter as a polynomial, such as P or P**2")


WORKS = ("T", "V", "W_c", "dW_nc")


def check(column: Column) -> None:
    """Refuse a statement that makes no sense; further checks need the variation (variation.py)."""
    _refuse_types(column)
    if column.basis not in bases():
        raise StatementError(f"basis = {column.basis!r}: must be one of {', '.join(bases())}")
    if type(column.modes) is not int or column.modes < 1:
        raise StatementError(f"modes = {column.modes!r}: must be a whole number, 1 or greater")
    _refuse_unknown(column)
    _refuse_supports(column)
    _refuse_off_the_beam(column)
    works = {name: column.energies.functional(name) for name in WORKS}
    _refuse_degrees(column, works)
    _refuse_complex(column, works)
    if not any(part.has(P) for w in works.values() for part in (w.density, w.points)):
        raise StatementError("the load P does no work: it must stand in W_c or in dW_nc")


def _refuse_complex(column: Column, works: Mapping[str, Functional]) -> None:
    """Factors that are no finite real numbers at the parameters' defaults, somewhere along the beam."""
    places = [place.subs(column.defaults) for place in column.energies.beam.places]
    for name, work in works.items():
        for term in Add.make_args(work.density + work.points):
            factor = Mul(*(f for f in Mul.make_args(term) if not jets(f)))
            at_defaults = factor.subs({**column.defaults, P: S.One, alpha: S.One, beta: S.One})
            along = next((k for j in jets(term) if (k := segment_of(j.args[3])) is not None), None)
            if along is None or at_defaults.is_polynomial(x):
                wheres = [S.Zero]
            else:
                low, high = places[along : along + 2]
                wheres = [low + (high - low) * k / 16 for k in range(17)]
            for where in wheres:
                value = at_defaults.subs(x, where)
                if value.is_number and (value.is_real is False or value.is_finite is False):
                    spot = f" at x = {float(where):.4g}" if len(wheres) > 1 else ""
                    raise StatementError(
                        f"{name}: {factor} is no finite real number{spot}, at the parameters' defaults; give it such "
                        "values along the whole beam"
                    )


def _refuse_supports(column: Column) -> None:
    """Ends that are not said of each field, or of what is no field."""
    if not isinstance(column.ends, Mapping):
        if column.fields and not column.ends:
            raise StatementError(f"ends: give those of {', '.join(column.fields)}, such as ('clamped', 'free')")
        return
    stated = [str(getattr(field, "func", field)) for field in column.ends]
    if sorted(stated) != sorted(column.fields):
        raise StatementError(
            f"ends: are given of {', '.join(stated) or 'nothing'}, but the fields are {', '.join(column.fields)}"
        )


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
            if (
                found == 0
                and named & {"x", "t"}
                and any(kind_of(a.func) for a in sympify(expression).atoms(AppliedUndef))
            ):
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
    """Names and files of the columns whose kernels are checked in, in the order in which they are listed."""
    return _files_of(Path(__file__).parent / "columns")


def gallery() -> dict[str, Path]:
    """Names and files of the gallery's columns, whose kernels are derived when they are first used."""
    return _files_of(Path(__file__).parent / "columns" / "gallery")


def _files_of(folder: Path) -> dict[str, Path]:
    return {path.stem.replace("_", "-"): path for path in sorted(folder.glob("[a-z]*.py"))}


@lru_cache(maxsize=1)
def bases() -> tuple[str, ...]:
    """Names of the bases: trial functions of a column, a file each. Polynomials on segments, of columns beyond the
    textbook's, go by the name of the polynomials."""
    return tuple(sorted(path.stem for path in (Path(__file__).parent / "bases").glob("[a-z]*.py")))
