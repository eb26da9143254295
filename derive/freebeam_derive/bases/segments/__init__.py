"""Hierarchic polynomials on segments, joined as the energies need: trial functions of any column. mathematics.md, 11.

Between breaks each field has the values (and slopes) at both ends and bubbles that vanish there, integrals of
Legendre's polynomials P_k(2ξ − 1). All integrals of polynomial factors are constant tables ∫ η^k φ⁽ᵖ⁾ ψ⁽ᑫ⁾ dξ with
η = 2ξ − 1, rational, times the factor's coefficients and a power of the segment's length. Other factors are integrated
by Gauss's rule.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from types import ModuleType
from typing import Any

from sympy import Expr, Poly, PolynomialError, Symbol, expand
from sympy import factor as factored

from freebeam_derive import pieces
from freebeam_derive.bases.segments.strong_form import NoStrongForm, StrongForm, strong_form
from freebeam_derive.display import neighbours
from freebeam_derive.forms import Along, BilinearForm, GeneralSystem, Value
from freebeam_derive.kernel import Facts, Figure, Kernel, Progress
from freebeam_derive.latex import letter
from freebeam_derive.newmark import derive_newmark
from freebeam_derive.notation import NOTATION, PRIMES, x
from freebeam_derive.statement import StatementError
from freebeam_derive.units import told
from freebeam_derive.variation import EquationOfMotion
from freebeam_derive.verify import BOUND

SUFFIX = "_segments"

_MATRICES = (("mass", "M", "mass matrix"), ("rate", "C", "matrix of the rates"), ("stiffness", "K", "stiffness matrix"))
_middle, _half, _eta = Symbol("middle"), Symbol("half"), Symbol("eta")


def kernel_of(column: Facts, system: GeneralSystem, motion: EquationOfMotion | None = None) -> SegmentsKernel:
    """The kernel of a column in polynomials on segments; emit.emit writes it, verify.verify measures it.

    column: what its module says of it, such as a Column. motion: what its exact system is from; without it there is
    none. Raises StatementError for a field that is joined otherwise
    than 0, 1 or 2 times, and a term that holds what the system has not.
    """
    known = {space.name: space.joined for space in system.spaces} | {name: 0 for name, _ in system.coordinates}
    for space in system.spaces:
        if space.joined not in (0, 1, 2):
            raise StatementError(f"{space.name}: joined {space.joined} times; fields are joined 0, 1 or 2 times")
    for form in (*system.M, *system.C, *system.K):
        named = {name for key in form.along for name in (key.test, key.trial)}
        named |= {value.of for pair in form.points for value in pair}
        if missing := sorted(named - set(known)):
            raise StatementError(f"{missing[0]}: the system has no such field or coordinate")
    return SegmentsKernel(column, derive_newmark(), system, motion)


@dataclass(frozen=True)
class Integral:
    """A term of a matrix: the segments that have it, and ∫ factor Dᵖ test D^q trial dx on each of them."""

    segments: tuple[int, ...]
    key: Along
    factor: Expr

    @property
    def test(self) -> tuple[str, int]:
        return self.key.test, self.key.p

    @property
    def trial(self) -> tuple[str, int]:
        return self.key.trial, self.key.q

    @property
    def sampled(self) -> bool:
        """Whether the factor is no polynomial in x."""
        return not self.factor.is_polynomial(x)

    @cached_property
    def coefficients(self) -> tuple[Expr, ...]:
        """The factor in powers of η = 2ξ − 1, ascending: factors in a segment's middle and half its length."""
        if not self.factor.has(x):
            return (self.factor,)
        powers = Poly(self.factor.subs(x, _middle + _half * _eta), _eta).all_coeffs()[::-1]
        return tuple(factored(c) for c in powers)

    @property
    def centred(self) -> bool:
        return self.factor.has(x) and not self.sampled

    @property
    def runs(self) -> list[tuple[int, int]]:
        """First and last of the segments that are neighbours."""
        return neighbours(self.segments)

    @property
    def text(self) -> str:
        return str(self.factor)


@dataclass(frozen=True)
class SegmentsKernel(Kernel):
    """All that is emitted for a column with polynomials on segments as trial functions."""

    basis_name = "segments"

    system: GeneralSystem
    motion: EquationOfMotion | None

    @property
    def least(self) -> int:
        """The least N."""
        return max((space.joined for space in self.system.spaces), default=0)

    def forms(self, name: str) -> tuple[BilinearForm, ...]:
        """The forms of M, C or K, by the power of P; at least one."""
        return getattr(self.system, name) or (BilinearForm({}, {}),)

    @cached_property
    def integrals(self) -> dict[str, list[list[Integral]]]:
        return {name: [grouped(form) for form in self.forms(name)] for _, name, _ in _MATRICES}

    @property
    def tables(self) -> tuple[tuple[str, int, str, int, int], ...]:
        """The constant tables: test, p, trial, q, and the highest power of η."""
        found: dict[tuple[str, int, str, int], int] = {}
        for powers in self.integrals.values():
            for term in (term for terms in powers for term in terms if not term.sampled):
                key = (*term.test, *term.trial)
                found[key] = max(found.get(key, 0), len(term.coefficients) - 1)
        return tuple((*key, highest) for key, highest in sorted(found.items()))

    @cached_property
    def exact(self) -> StrongForm | str:
        """The tables of the exact system, or why there is none."""
        if self.motion is None:
            return "its equations of motion are not known"
        try:
            return strong_form(self.motion)
        except NoStrongForm as reason:
            return str(reason)

    def context(self) -> dict[str, Any]:
        system, breaks = self.system, len(self.system.breaks)
        terms = [term for powers in self.integrals.values() for terms in powers for term in terms]
        own = "".join(f", {p.name}: Any = {float(p.default)!r}" for p in self.column.parameters)
        return {
            "S": breaks - 1,
            "least": self.least,
            "own_any": f", *{own}" if own else "",
            "own": f", *{own}" if own else "",
            "facts": self._facts(),
            "spaces": system.spaces,
            "kinds": {space.joined for space in system.spaces},
            "coordinates": tuple(name for name, _ in system.coordinates),
            "tables": self.tables,
            "highest": max((order for term in terms for _, order in (term.test, term.trial)), default=0),
            "sampled": any(term.sampled for term in terms),
            "breaks": system.breaks,
            "functions": [self._function(*names) for names in _MATRICES],
            "force": system.force,
            "rigid": [_motion(number, motion) for number, motion in enumerate(system.rigid)],
            "stated": {name: [_stated(form) for form in getattr(system, name)] for name in "MCK"},
            "strong": self.exact if isinstance(self.exact, StrongForm) else None,
        }

    def _function(self, name: str, letter_: str, title: str) -> dict[str, Any]:
        """What the function of a matrix is written from."""
        names: dict[Value, str] = {}
        powers = []
        for form, terms in zip(self.forms(letter_), self.integrals[letter_], strict=True):
            points = []
            for (test, trial), factor in form.points.items():
                pair = [names.setdefault(value, f"value_{len(names) + 1}") for value in (test, trial)]
                points.append((factor, *pair))
            powers.append({"along": terms, "points": points, "symmetric": symmetric(form)})
        values = [(given, value) for value, given in names.items()]
        damped = letter_ == "C" or (letter_ == "K" and bool(self.system.circulatory))
        return {
            "name": name, "letter": letter_, "title": title, "points": values, "powers": powers, "damped": damped,
        }  # fmt: skip

    def _facts(self) -> dict[str, Any]:
        column, system = self.column, self.system
        letters = [name for name in ("x", "t", "P", "alpha", "beta", "F_0", "x_F") if name in NOTATION]
        parameters = [
            {"name": p.name, "latex": letter(p), "meaning": p.meaning}
            | {"default": float(p.default), "low": float(p.low), "high": float(p.high)}
            for p in column.parameters
        ]
        return {
            "name": column.name,
            "title": column.title,
            "basis": "legendre",
            "general": True,
            "coupled": list(system.coupled),
            **({"circulatory": list(system.circulatory)} if system.circulatory else {}),
            "inexact": self.exact if isinstance(self.exact, str) else "",
            "default": {"basis": column.basis, "modes": column.modes},
            "ends": list(column.supports(system.spaces[0].name)) if system.spaces else [],
            "least": max(self.least, 1),
            "breaks": [str(place) for place in system.breaks],
            "fields": [{"name": s.name, "latex": s.latex, "joined": s.joined} for s in system.spaces],
            "coordinates": [{"name": name, "latex": latex} for name, latex in system.coordinates],
            "rigid": len(system.rigid),
            "load": "P",
            **told(column.quantities),
            "damping": list(column.damping),
            "force": bool(system.force),
            "parameters": parameters,
            "forms": {name: [self.text(form) for form in self.forms(name)] for _, name, _ in _MATRICES},
            "powers": {name: len(self.forms(name)) for _, name, _ in _MATRICES},
            "latex": {name: NOTATION[name].latex for name in letters},
            "meaning": {name: NOTATION[name].meaning for name in letters},
            "source": column.source,
        }

    def text(self, form: BilinearForm) -> str:
        """A form as text: ∫ from … to … of factor δy″ y″ dx, and products of values at points."""
        breaks = self.system.breaks
        terms = []
        for term in grouped(form):
            of = f"{_named(term.test, True)} {_named(term.trial)}"
            for first, last in neighbours(term.segments):
                low, high = breaks[first], breaks[last + 1]
                span = "" if (low, high) == (0, 1) else f"[{low}, {high}] "
                terms.append((term.factor, f"∫{span or ' '}{{}}{of} dx"))
        for (test, trial), factor in form.points.items():
            terms.append((factor, f"{{}}{_valued(test, True)} {_valued(trial)}"))
        text = ""
        for factor, around in terms:
            negative = factor.could_extract_minus_sign()
            size = -factor if negative else factor
            before = "" if size == 1 else f"({size}) " if size.is_Add else f"{size} "
            sign = (" - " if negative else " + ") if text else ("-" if negative else "")
            text += sign + around.format(before)
        return text or "0"

    def cost(self) -> dict[str, int]:
        return {"exact_in_fractions_up_to": pieces.MODES} if not self.context()["sampled"] else {}

    def bounds(self) -> dict[str, float]:
        return {
            f"matrix entries at N = {pieces.MODES}, of the norms of their terms": BOUND,
            f"functions at N = {pieces.MODES} and their derivatives to the third, of the largest value": BOUND,
        }

    def proven(self, text: str) -> tuple[str, float]:
        return next(iter(self.bounds())), pieces.proven(self.column, self.system, text, pieces.MODES)

    def measured(self, module: ModuleType, say: Progress) -> Iterator[Figure]:
        yield from pieces.figures(self.column, self.system, module, pieces.MODES, say)


def grouped(form: BilinearForm) -> list[Integral]:
    """The integrals of a form; those that differ in the segment alone are one."""
    found: dict[tuple[Along, Expr], list[int]] = {}
    for key, factor in form.along.items():
        found.setdefault((replace(key, segment=0), factor), []).append(key.segment)
    return [Integral(tuple(sorted(segments)), key, factor) for (key, factor), segments in found.items()]


def symmetric(form: BilinearForm) -> bool:
    """Whether the form is unchanged when test and trial function change places."""
    along = {Along(k.segment, k.trial, k.q, k.test, k.p): factor for k, factor in form.along.items()}
    points = {(trial, test): factor for (test, trial), factor in form.points.items()}
    return _same(form.along, along) and _same(form.points, points)


def _same(one: dict[Any, Expr], other: dict[Any, Expr]) -> bool:
    return all(expand(one.get(key, 0) - other.get(key, 0)) == 0 for key in {*one, *other})


def _stated(form: BilinearForm) -> tuple[list[Any], list[Any]]:
    """A form's integrals with their factors in powers of x, and its products of values."""
    along = []
    for term in grouped(form):
        powers = () if term.sampled else Poly(term.factor, x).all_coeffs()[::-1]
        along.append((term.segments, *term.test, *term.trial, [factored(c) for c in powers]))
    return along, [(test, trial, factor) for (test, trial), factor in form.points.items()]


def _motion(number: int, motion: dict[tuple[str, int | None], Expr]) -> list[dict[str, Any]]:
    """A rigid motion, by the fields' segments with the same line on them, and the coordinates."""
    parts: dict[tuple[str, Expr], list[int]] = {}
    found: list[dict[str, Any]] = []
    for (name, segment), function in motion.items():
        if segment is None:
            found.append({"number": number, "name": name, "segments": None, "constant": function})
        else:
            parts.setdefault((name, function), []).append(segment)
    for (name, function), segments in parts.items():
        try:
            line = Poly(function, x)
        except PolynomialError:
            line = None
        if line is None or line.degree() > 1:
            raise StatementError(f"rigid motion {function} of {name}: must be of degree 1 at most in x")
        constant, slope = (line.coeff_monomial(power) for power in (1, x))
        part = {"number": number, "name": name, "segments": tuple(sorted(segments))}
        found.append({**part, "constant": constant, "slope": slope})
    return found


def _named(of: tuple[str, int], test: bool = False) -> str:
    name, order = of
    primes = PRIMES[order] if order < len(PRIMES) else f"^({order})"
    return f"{'δ' if test else ''}{name}{primes}"


def _valued(value: Value, test: bool = False) -> str:
    name = _named((value.of, value.order), test)
    if value.place is None:
        return name
    return f"{name}({value.place}{'−' if value.side < 0 else '+' if value.side > 0 else ''})"
