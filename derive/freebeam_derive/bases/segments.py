"""Polynomials on segments, for any column: joined at the breaks as the energies need. Eqs. (9), (11).

On a segment ξ runs from 0 to 1. Functions that bend are the four cubics that are a value or a slope at one end, and
then double integrals of Legendre's polynomials, which vanish with their slopes at both ends, and whose second derivatives
are orthogonal. Functions of which the values alone are joined are the two lines and single integrals. The coordinates
of the first are values and slopes at the breaks: shared by neighbours, or not, where they are free to jump.

A factor that is a polynomial in x is written in Legendre's polynomials of the segment, and its integrals are closed
forms, in fractions too; another function is integrated by Gauss and Legendre's rule.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any

from sympy import Expr, Piecewise, Poly, PolynomialError, S, Symbol, expand, legendre, simplify, sympify

from freebeam_derive import segment_reference
from freebeam_derive.derivation import GeneralDerivation
from freebeam_derive.emit import source
from freebeam_derive.forms import Along, BilinearForm, GeneralSystem, Value
from freebeam_derive.kernel import Figure, Kernel, Program, Progress
from freebeam_derive.notation import PRIMES, alpha, beta, x, x_F
from freebeam_derive.record import Step
from freebeam_derive.statement import StatementError

SUFFIX = "_legendre"
VERIFIED = 10
"""N up to which all entries are verified."""
NODES_MORE = 48
"""Nodes of Gauss and Legendre's rule beyond N + 2, for factors that are no polynomials: exp(−x), 1/(1 + x) and the like
are then integrated to rounding, which the verification measures."""
_KINDS = {2: "_bending", 1: "_simple"}
_MATRICES = (
    ("mass", "M", "Mass matrix M"),
    ("damping", "C", "Damping matrix C"),
    ("stiffness", "K", "Stiffness matrix K"),
)
_xi = Symbol("xi")


@dataclass(frozen=True)
class SegmentKernel(Kernel):
    """All that is emitted for a column with polynomials on segments."""

    basis_name = "segments"

    @property
    def general(self) -> GeneralSystem:
        assert isinstance(self.system, GeneralSystem)
        return self.system

    @property
    def fields(self) -> tuple[tuple[str, str], ...]:
        return ()

    @cached_property
    def nodes(self) -> tuple[dict[str, list[list[int]]], int]:
        """Of each field, segment by segment, the numbers of its values and slopes at both ends; and their count."""
        found: dict[str, list[list[int]]] = {}
        count, last = 0, len(self.general.breaks) - 1
        for space in self.general.spaces:
            numbers: dict[tuple[int, int, int], int] = {}
            for place in range(last + 1):
                for order in range(space.joined):
                    end = {0: 0, last: 1}.get(place)
                    apart = (place, order) in space.opened
                    for side in (-1, 1) if apart else (0,):
                        held = end is not None and (end, order) in space.held
                        numbers[place, order, side] = -1 if held else count
                        count += not held

            def number(place: int, order: int, side: int, of: dict[tuple[int, int, int], int] = numbers) -> int:
                return of[(place, order, side) if (place, order, side) in of else (place, order, 0)]

            found[space.name] = [
                [number(k + (side < 0), order, side) for side in (1, -1) for order in range(space.joined)]
                for k in range(last)
            ]
        return found, count

    def context(self) -> dict[str, Any]:
        system = self.general
        found, nodal = self.nodes
        kinds = sorted({space.joined for space in system.spaces})
        matrices = [self._matrix(*each) for each in _MATRICES]
        force = [_times(factor, self._vector(value)) for value, factor in system.force]
        every = [text for m in matrices for p in m["powers"] for pair in p["points"] for text in pair[1:]] + force
        along = [term for m in matrices for p in m["powers"] for term in p["along"]]
        names = [p.name for p in self.column.parameters]
        own = ", ".join(f"{p.name}: Any = {float(p.default)!r}" for p in self.column.parameters)
        return {
            "nodes": found,
            "nodal": nodal,
            "kinds": kinds,
            "least": 2 if 2 in kinds else 1,
            "breaks": system.breaks,
            "breaks_exact": [_exact(b) for b in system.breaks],
            "coordinates": system.coordinates,
            "matrices": matrices,
            "forms": {letter: [*self._texts(letter)] for _, letter, _ in _MATRICES},
            "loose": any("_one(" in term["left"] + term["right"] for term in along),
            "quadrature": any(term["series"] is None for term in along),
            "nodes_more": NODES_MORE,
            "points": any("_unit(" in text for text in every),
            "inner": any("_value(" in text for text in every),
            "force": force,
            "force_places": any("breaks" in text for text in force),
            "rigid": system.rigid,
            "rigid_texts": [_motion_text(m, len(system.breaks) - 1) for m in system.rigid],
            "rigid_rows": [*self._rigid_rows()],
            "rigid_places": ", ".join(f"break_{k}" for k in range(len(system.breaks))),
            "own_alone": f"*, {own}" if own else "",
            "own_any": f", *, {own}" if own else "",
            "own": f", *, {own}" if own else "",
            "passed_alone": ", ".join(f"{name}={name}" for name in names),
        }

    def _matrix(self, name: str, letter: str, words: str) -> dict[str, Any]:
        forms: tuple[BilinearForm, ...] = getattr(self.general, letter)
        powers = []
        for number, form in enumerate(forms):
            along = [self._along(key, factor) for key, factor in _sorted(form.along)]
            points = [
                (_exact(factor), self._vector(test), self._vector(trial))
                for (test, trial), factor in _sorted(form.points)
            ]
            powers.append({"number": number, "along": along, "points": points})
        text = str(powers)
        segments = sorted({term["segment"] for power in powers for term in power["along"]})
        return {
            "name": name,
            "letter": letter,
            "words": words,
            "powers": powers,
            "segments": segments,
            "uses_places": bool(segments) or "breaks" in text,
            "uses_one": "one" in text.replace("_one", ""),
            "symmetric": tuple(form.symmetric for form in forms),
        }

    def _along(self, key: Along, factor: Expr) -> dict[str, Any]:
        """What an integral along a segment is emitted as."""
        start, length = Symbol(f"start_{key.segment}"), Symbol(f"length_{key.segment}")
        series = legendre_series(factor, start, length)
        rows, left = self._functions(key.test, key.segment, key.p)
        columns, right = self._functions(key.trial, key.segment, key.q)
        return {
            "segment": key.segment,
            "rows": rows,
            "left": left,
            "columns": columns,
            "right": right,
            "series": None if series is None else [_exact(value) for value in series],
            "function": source.code(factor, "np") if series is None else "",
        }

    def _functions(self, name: str, segment: int, order: int) -> tuple[str, str]:
        """The numbers of an unknown's coordinates on a segment, and a derivative of its functions as series."""
        for space in self.general.spaces:
            if space.name == name:
                return (
                    f'basis.numbers["{name}"][{segment}]',
                    f"{_KINDS[space.joined]}(basis, {order}, length_{segment})",
                )
        return f"np.array([{self._coordinate(name)}])", "_one(basis)"

    def _coordinate(self, name: str) -> str:
        names = [name_ for name_, _ in self.general.coordinates]
        return f"basis.size - {len(names) - names.index(name)}"

    def _vector(self, value: Value) -> str:
        """What gives a value from the coordinates."""
        if value.place is None:
            return f"_unit(basis, {self._coordinate(value.of)})"
        space = next(s for s in self.general.spaces if s.name == value.of)
        number = next((k for k, b in enumerate(self.general.breaks) if expand(b - value.place) == 0), None)
        if number is not None and value.order < space.joined:
            last = len(self.general.breaks) - 1
            left = number == last or (value.side < 0 and number > 0)
            segment, offset = (number - 1, space.joined) if left else (number, 0)
            return f'_unit(basis, basis.numbers["{value.of}"][{segment}][{offset + value.order}])'
        place = "x_F" if value.place == x_F else _exact(value.place)
        return f'_value(basis, "{value.of}", {value.order}, {place}, {value.side}, breaks)'

    def _rigid_rows(self) -> Iterator[tuple[int, str, str]]:
        """Column, numbers of coordinates and their values, of each rigid motion."""
        for column, motion in enumerate(self.general.rigid):
            for (name, segment), function in sorted(motion.items(), key=str):
                if segment is None:
                    yield column, self._coordinate(name), _exact(sympify(function))
                    continue
                space = next(s for s in self.general.spaces if s.name == name)
                values = [
                    sympify(function).diff(x, order).subs(x, Symbol(f"break_{segment + end}"))
                    for end in range(2)
                    for order in range(space.joined)
                ]
                count = len(values)
                listed = ", ".join(f"{_exact(v)}" if v.free_symbols else f"{v} * one" for v in values)
                yield column, f'basis.numbers["{name}"][{segment}][:{count}]', listed

    def _texts(self, letter: str) -> Iterator[str]:
        for power, form in enumerate(getattr(self.general, letter)):
            load = "" if power == 0 else "P " if power == 1 else f"P^{power} "
            yield load + (form_text(form, self.general) or "0")

    def facts(self) -> dict[str, Any]:
        """What the runtime must know beside the usual."""
        system = self.general
        return {
            "basis": "legendre",
            "general": True,
            "fields": [space.name for space in system.spaces],
            "coordinates": [name for name, _ in system.coordinates],
            "breaks": [str(b) for b in system.breaks],
            "coupled": list(system.coupled),
            "rigid": len(system.rigid),
            "force": bool(system.force),
            "forms": {letter: "; ".join(self._texts(letter)) for _, letter, _ in _MATRICES},
        }

    def cost(self) -> dict[str, int]:
        return {"segments": len(self.general.breaks) - 1, "exact_in_fractions_up_to": VERIFIED}

    def bounds(self) -> dict[str, float]:
        return {f"matrix entries up to N = {VERIFIED}, of the norms of their terms": segment_reference.BOUND}

    def measured(self, module: ModuleType, say: Progress) -> Iterator[Figure]:
        yield from segment_reference.figures(self.general, module, VERIFIED, say)


def build(derivation: GeneralDerivation) -> SegmentKernel:
    """What is emitted for a column beyond the textbook's. Raises StatementError for a factor it cannot hold."""
    system = derivation.system
    for forms in (system.M, system.C, system.K):
        for form in forms:
            for factor in (*form.along.values(), *form.points.values()):
                if factor.has(Piecewise) and any(p.has(x) for p in factor.atoms(Piecewise)):
                    raise StatementError(f"the factor {factor} is piecewise in x within a segment")
    programs = tuple(Program(name, letter, "", "Eq. (11)") for name, letter, _ in _MATRICES)
    return SegmentKernel(derivation.column, derivation.motion, system, derivation.newmark, (), programs)


def steps(derivation: Any) -> tuple[Step, ...]:
    """The record of how the functions were derived: none yet."""
    return ()


def legendre_series(factor: Expr, start: Expr, length: Expr) -> tuple[Expr, ...] | None:
    """A polynomial in x as a series in P_j(2ξ − 1) on a segment, x = start + length ξ; None where it is none."""
    try:
        polynomial = Poly(expand(factor.subs(x, start + length * _xi)), _xi)
    except PolynomialError:
        return None
    if any(c.has(_xi) for c in polynomial.coeffs()):
        return None
    series = [S.Zero] * (polynomial.degree() + 1 if not polynomial.is_zero else 1)
    rest = polynomial
    while not rest.is_zero:
        n = rest.degree()
        basis = Poly(legendre(n, 2 * _xi - 1), _xi)
        series[n] = expand(rest.LC() / basis.LC())
        rest = rest - basis * series[n]
    return tuple(series)


def _sorted(mapping: dict[Any, Expr]) -> list[tuple[Any, Expr]]:
    return sorted(mapping.items(), key=lambda item: str(item[0]))


def _exact(expression: Expr) -> str:
    """Code that is exact where the numbers are fractions: no quotient of two plain numbers stands in it."""
    expression = sympify(expression)
    if expression.is_Integer:
        return str(expression)
    if not expression.free_symbols or expression.is_Add:
        return (
            source.quotient(Symbol("one") * expression)
            if expression.is_rational_function()
            else source.code(expression)
        )
    return source.quotient(expression) if expression.is_rational_function() else source.code(expression)


def _times(factor: Expr, text: str) -> str:
    return text if factor == 1 else f"{_exact(factor)} * {text}"


def _derivative(name: str, order: int, varied: bool) -> str:
    primes = PRIMES[order] if order < len(PRIMES) else f"^({order})"
    return f"{'δ' if varied else ''}{name}{primes}"


def form_text(form: BilinearForm, system: GeneralSystem) -> str:
    """A form in one line of text, such as ∫ δy″ y″ dx + mu δy(1) y(1)."""
    terms: list[tuple[Expr, str]] = []
    last = len(system.breaks) - 1
    for key, factor in _sorted(form.along):
        low, high = system.breaks[key.segment : key.segment + 2]
        bounds = "" if last == 1 else f"[{low}, {high}] "
        inside = "" if not factor.has(x) else f"({factor}) " if factor.is_Add else f"{factor} "
        product = f"{_derivative(key.test, key.p, True)} {_derivative(key.trial, key.q, False)}"
        terms.append((S.One if inside else factor, f"∫{bounds or ' '}{inside}{product} dx"))
    for (test, trial), factor in _sorted(form.points):
        terms.append((factor, f"{_value_text(test, True)} {_value_text(trial, False)}"))
    text = ""
    for value, term in terms:
        negative = value.could_extract_minus_sign()
        size = -value if negative else value
        shown = "" if size == 1 else f"({size}) " if size.is_Add else f"{size} "
        text += (" − " if text else "−") if negative else (" + " if text else "")
        text += f"{shown}{term}"
    return text


def _value_text(value: Value, varied: bool) -> str:
    name = _derivative(value.of, value.order, varied)
    side = {-1: "⁻", 1: "⁺"}.get(value.side, "")
    return name if value.place is None else f"{name}({value.place}{side})"


def _motion_text(motion: dict[tuple[str, Any], Expr], segments: int) -> str:
    parts = []
    for (name, segment), function in sorted(motion.items(), key=str):
        where = f" on segment {segment + 1}" if segment is not None and segments > 1 else ""
        parts.append(f"{name} = {simplify(function)}{where}")
    return ", ".join(parts)


__all__ = ["SegmentKernel", "alpha", "beta", "build", "form_text", "legendre_series", "steps"]
