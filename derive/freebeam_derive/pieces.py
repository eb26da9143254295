"""The independent route for polynomials on segments: functions in powers of ξ, exact, and integrals of them.

Bubbles are made by Rodrigues' formula and integrated twice; nothing of the kernel's recurrences is used. A factor that
is no polynomial in x has its moments ∫ f ξ^k dξ as balls that enclose them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
from flint import acb, arb, fmpq, fmpq_poly
from sympy import Expr, Poly, Rational

from freebeam_derive import rounding
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.forms import Along, BilinearForm, GeneralSystem, Space, Value
from freebeam_derive.independent import VerificationError, fraction, number_with_digits
from freebeam_derive.kernel import Facts, Figure, Progress
from freebeam_derive.notation import x
from freebeam_derive.ritz import Form
from freebeam_derive.statement import StatementError
from freebeam_derive.verify import BOUND, DAMPING, PLACES, load, samples, size

MODES = 16  # verified: N, all entries and derivatives up to the third
_BITS = 500  # of moments: their sums lose 60 digits at N = 16
_SHARP = fmpq(1, 10**40)  # radius of an entry within which it is known, of the sum of its terms' sizes
_ACROSS = 48  # places on a segment at which a function's largest value is looked for

Exact = dict[str, fmpq]
Table = np.ndarray[Any, np.dtype[Any]]


# --- functions on one segment, in powers of ξ ---------------------------------------------------------------


@cache
def functions(joined: int, size: int) -> tuple[fmpq_poly, ...]:
    """The functions on a segment but for the length's factor of those of unit slope, in powers of 0 ≤ ξ ≤ 1."""
    found: list[list[int]] = [
        [],
        [[1, -1], [0, 1]],
        [[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]],
    ][joined]
    corners = [fmpq_poly(c) for c in found]
    bubbles = []
    for m in range(joined, size - joined):
        bubble = _rodrigues(m)
        if joined == 1:
            bubble = _integral(bubble * (2 * (2 * m + 1)))
        if joined == 2:
            square = 16 * (2 * m - 1) ** 2 * (2 * m + 1) * (2 * m + 3) ** 2
            unit = fmpq(4 * (2 * m - 1) * (2 * m + 1) * (2 * m + 3), 2 ** (square.bit_length() // 2))
            bubble = _integral(_integral(bubble * unit))
        bubbles.append(bubble)
    return (*corners, *bubbles)


def _rodrigues(m: int) -> fmpq_poly:
    """P_m(2ξ − 1)."""
    return derivative(fmpq_poly([0, -1, 1]) ** m, m) / math.factorial(m)


def derivative(function: fmpq_poly, order: int) -> fmpq_poly:
    return derivative(function.derivative(), order - 1) if order else function


def _integral(function: fmpq_poly) -> fmpq_poly:
    return function.integral()


@cache
def _products(test: tuple[int, int], trial: tuple[int, int], size: int) -> list[list[fmpq_poly]]:
    """Products of derivatives in ξ; test, trial: how often joined (−1 a coordinate) and the order."""
    left, right = (
        [derivative(f, order) for f in (functions(joined, size) if joined >= 0 else (fmpq_poly([1]),))]
        for joined, order in (test, trial)
    )
    return [[a * b for b in right] for a in left]


@cache
def _moment(test: tuple[int, int], trial: tuple[int, int], size: int, k: int) -> Table:
    """∫ ξ^k Dᵖ test D^q trial dξ over 0 ≤ ξ ≤ 1."""
    weight = fmpq_poly([0] * k + [1])
    rows = [[(weight * f).integral()(1) for f in row] for row in _products(test, trial, size)]
    return _objects(rows)


def _objects(rows: Sequence[Sequence[Any]]) -> Table:
    found = np.empty((len(rows), len(rows[0])), dtype=object)
    found[:] = [list(row) for row in rows]
    return found


@cache
def _largest(joined: int, order: int, size: int) -> Any:
    """Largest value of a derivative in ξ of each function, as far as looked for, in floats."""
    if joined < 0:
        return np.ones(1)
    places = [fmpq(n, _ACROSS) for n in range(_ACROSS + 1)]
    each = [derivative(f, order) for f in functions(joined, size)]
    return np.array([max(abs(float(f(place))) for place in places) for f in each])


# --- the whole beam -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Pieces:
    """The functions of a system at given parameters: on each segment, exact. numbers: as the module has them."""

    system: GeneralSystem
    values: dict[str, float]
    numbers: dict[str, Any]
    count: int
    size: int

    @property
    def joined(self) -> dict[str, int]:
        """How often each field is joined, −1 for a coordinate."""
        return {s.name: s.joined for s in self.system.spaces} | {name: -1 for name, _ in self.system.coordinates}

    def number(self, expression: Expr) -> fmpq:
        """An expression in the parameters; 60 digits of an irrational one."""
        return number_with_digits(expression, self.values)[0]

    def breaks(self) -> list[fmpq]:
        return [self.number(place) for place in self.system.breaks]

    def lengths(self) -> list[fmpq]:
        breaks = self.breaks()
        return [b - a for a, b in itertools.pairwise(breaks)]

    def sizes(self, name: str, segment: int) -> Table:
        """The factor of each function on a segment: its length for those of unit slope."""
        found = np.array([fmpq(1)] * self.numbers[name].shape[1], dtype=object)
        if self.joined[name] == 2:
            found[[1, 3]] = self.lengths()[segment]
        return found

    def at(self, value: Value, place: fmpq | None = None) -> Table:
        """A point value of every coordinate, (n,), exact."""
        found = np.array([fmpq(0)] * (self.count + 1), dtype=object)
        if value.place is None:
            found[self.numbers[value.of][0]] = fmpq(1)
            return found[:-1]
        place = self.number(value.place) if place is None else place
        segment = self.segment(place, value.side)
        found[self.numbers[value.of][segment]] = self.local(value.of, value.order, segment, place)
        return found[:-1]

    def segment(self, place: fmpq, side: int) -> int:
        inner = self.breaks()[1:-1]
        return len([b for b in inner if (b < place if side < 0 else b <= place)])

    def local(self, name: str, order: int, segment: int, place: fmpq) -> Table:
        """A derivative in x of the functions on a segment, at a place of it."""
        low, length = self.breaks()[segment], self.lengths()[segment]
        xi = (place - low) / length
        each = functions(self.joined[name], self.size)
        values = np.array([derivative(f, order)(xi) for f in each], dtype=object)
        found: Table = self.sizes(name, segment) * values / length**order
        return found

    def along(self, key: Along, factor: Expr) -> tuple[Table, Table]:
        """An integral over a segment as a matrix, (n, n), exact or of 40 digits; what its terms can be, in floats."""
        low, length = self.breaks()[key.segment], self.lengths()[key.segment]
        test, trial = (self.joined[key.test], key.p), (self.joined[key.trial], key.q)
        if factor.is_polynomial(x):
            block: Any = 0
            coefficients = _polynomial(factor, self)(fmpq_poly([low, length])) if factor != 0 else fmpq_poly([0])
            for k in range(coefficients.degree() + 1):
                block = block + coefficients[k] * _moment(test, trial, self.size, k)
        else:
            block = _enclosed(factor, self.values, low, length, _products(test, trial, self.size))
        rows, columns = self.sizes(key.test, key.segment), self.sizes(key.trial, key.segment)
        power = length ** (1 - key.p - key.q)
        place = np.ix_(self.numbers[key.test][key.segment], self.numbers[key.trial][key.segment])
        exact = _objects([[fmpq(0)] * (self.count + 1)] * (self.count + 1))
        exact[place] = rows[:, None] * columns * power * block
        norms = [
            np.sqrt(np.diagonal(_moment(side, side, self.size, 0)).astype(float)) * sizes.astype(float)
            for side, sizes in ((test, rows), (trial, columns))
        ]
        scale = np.zeros((self.count + 1, self.count + 1))
        ends = ({**self.values, "x": float(end)} for end in (low, low + length))
        # the length, a difference of breaks, is known to a rounding of them
        known = float((low + length) / length)
        scale[place] = max(size(factor, end) for end in ends) * known * float(power) * np.outer(*norms)
        return exact[:-1, :-1], scale[:-1, :-1]

    def form(self, form: BilinearForm) -> tuple[Table, Any]:
        """The matrix of a form, (n, n), exact; and the sum of what its terms can be, in floats."""
        exact = _objects([[fmpq(0)] * self.count] * self.count)
        scale = np.zeros((self.count, self.count))
        for key, factor in form.along.items():
            part, most = self.along(key, factor)
            exact, scale = exact + part, scale + most
        for (test, trial), factor in form.points.items():
            exact = exact + self.number(factor) * np.outer(self.at(test), self.at(trial))
            scale = scale + size(factor, self.values) * np.outer(self.most(test), self.most(trial))
        return exact, scale

    def most(self, value: Value) -> Any:
        """The largest values on the segment of a place, in floats, and what a rounding of the place changes."""
        if value.place is None:
            return np.abs(self.at(value)).astype(float)
        found, place = np.zeros(self.count + 1), self.number(value.place)
        segment = self.segment(place, value.side)
        sizes = self.sizes(value.of, segment).astype(float) / float(self.lengths()[segment]) ** value.order
        found[self.numbers[value.of][segment]] = sizes * _largest(self.joined[value.of], value.order, self.size)
        return found[:-1] + np.abs(place * self.at(replace(value, order=value.order + 1))).astype(float)


def _polynomial(factor: Expr, pieces: Pieces) -> fmpq_poly:
    """A polynomial factor in powers of x."""
    return fmpq_poly([pieces.number(c) for c in Poly(factor, x).all_coeffs()[::-1]])


def _enclosed(
    factor: Expr, values: dict[str, float], low: fmpq, length: fmpq, products: list[list[fmpq_poly]]
) -> Table:
    """∫ factor times products dξ, from moments in balls. Raises VerificationError where they are not known."""
    degree = max(f.degree() for row in products for f in row)
    with precision(_BITS):
        given = {name: acb(fraction(value)) for name, value in values.items()}

        def integrand(k: int) -> Any:
            return lambda xi, analytic: xi**k * _complex(factor, {**given, "x": low + length * xi}, analytic)

        moments = [acb.integral(integrand(k), 0, 1).real for k in range(degree + 1)]
        found: list[list[fmpq]] = []
        for row in products:
            found.append([])
            for product in row:
                terms = [moments[k] * arb(c) for k, c in enumerate(product.coeffs())]
                total = sum(terms, arb(0))
                known = total.rad() < arb(_SHARP) * (1 + sum((abs(term) for term in terms), arb(0)))
                if not known:
                    raise VerificationError(f"∫ {factor} dx from {low} on is known to {total} only: is it singular?")
                found[-1].append(fmpq(*_ratio(total.mid())))
    return _objects(found)


def _ratio(value: arb) -> tuple[int, int]:
    mantissa, exponent = map(int, value.man_exp())
    power: int = 2 ** abs(exponent)
    return (mantissa * power, 1) if exponent > 0 else (mantissa, power)


_FUNCTIONS = ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "asin", "acos", "atan", "asinh", "atanh")


def _complex(e: Expr, values: dict[str, Any], analytic: bool) -> Any:
    """An expression in complex balls. Raises StatementError for a function that is not analytic."""
    if e.is_Symbol:
        return values[str(e)]
    if e.is_Rational:
        return acb(fmpq(int(e.p), int(e.q)))
    if e.is_Float:
        return acb(fraction(float(e)))
    if e.is_number and not e.args:
        return acb(arb.pi()) if str(e) == "pi" else acb(1).exp()
    name = type(e).__name__
    parts = [_complex(part, values, analytic) for part in e.args]
    if e.is_Add:
        return sum(parts, acb(0))
    if e.is_Mul:
        return math.prod(parts, start=acb(1))
    if e.is_Pow:
        if e.exp.is_Integer:
            return parts[0] ** int(e.exp)
        return parts[0].pow(parts[1], analytic)
    if name not in _FUNCTIONS:
        raise StatementError(f"{e.func} in {e}: not analytic in x; put breaks where it changes, and state each part")
    return parts[0].log(analytic) if name == "log" else getattr(parts[0], name)()


# --- the comparison -----------------------------------------------------------------------------------------


def figures(column: Facts, system: GeneralSystem, module: ModuleType, modes: int, say: Progress) -> Iterator[Figure]:
    """Measured errors of the emitted module's functions and matrices at N = modes.

    Raises VerificationError where what is exact is not equal, or the coordinates are not those of all functions that
    meet the conditions.
    """
    basis = module.basis(modes)
    defaults = {p.name: float(p.default) for p in column.parameters}
    in_fractions = None
    if hasattr(module, "complete"):  # other languages have no fractions
        orders = np.empty(len(basis.order), dtype=object)
        orders[:] = [fmpq(n) for n in range(len(orders))]
        in_fractions = module.complete(orders)
    pieces = Pieces(system, defaults, basis.numbers, basis.size, modes + 2)
    say("functions")
    _space(pieces)
    yield from _functions(pieces, module, basis)
    if in_fractions is not None:
        _rigid(pieces, module, in_fractions, defaults)
    say("matrices")
    for letter, function in (("M", module.mass_terms), ("C", module.rate_terms), ("K", module.stiffness_terms)):
        forms = getattr(system, letter)
        for power, form in enumerate(forms):
            given = defaults | (DAMPING if letter == "C" or (letter == "K" and system.circulatory) else {})
            worst = ("", 0.0)
            for values in _samples(column, system, form, given):
                here = replace(pieces, values=values)
                where = ", ".join(f"{name} = {value:.6g}" for name, value in values.items()) or "no parameters"
                exact = in_fractions if all(_rational(each, here) for each in forms) else None
                error, place = _compare(here, form, function, power, basis, exact, f"{letter}_{power} at {where}")
                if error >= worst[1]:
                    worst = (f"{place}, {where}", error)
            yield Figure(f"entries of {letter}_{power} at N = {modes}, of the norms of their terms", *worst, BOUND)


def proven(column: Facts, system: GeneralSystem, text: str, modes: int) -> float:
    """The bound of rounding in an entry of the emitted NumPy module's matrices at N = modes, by proof, over what its
    terms can be, at the parameters' defaults. Raises Unproven where the data are not rational."""
    module = rounding.instrumented(load(text, column.module))
    values = {p.name: float(p.default) for p in column.parameters}
    worst = 0.0
    with precision(rounding.BITS):
        basis = rounding.basis(module, modes)
        for letter, function in (("M", module.mass_terms), ("C", module.rate_terms), ("K", module.stiffness_terms)):
            given = values | (DAMPING if letter == "C" or (letter == "K" and system.circulatory) else {})
            pieces = Pieces(system, given, basis.numbers, basis.size, modes + 2)
            if not all(_rational(form, pieces) for form in getattr(system, letter)):
                raise Unproven(f"{column.name}: its data are no fractions")
            terms = function(basis, **rounding.given(given))
            for computed, form in zip(terms, getattr(system, letter), strict=False):
                worst = max(worst, rounding.largest(computed, *pieces.form(form)))
    return rounding.upward(worst)


def _compare(
    pieces: Pieces, form: BilinearForm, function: Any, power: int, basis: Any, in_fractions: Any, what: str
) -> tuple[float, str]:
    """Largest error of a matrix, relative to what its terms can be, and where it is.

    in_fractions: the basis in which it must be equal, None where the data are not rational.
    """
    with np.errstate(all="ignore"):  # other powers of P may have no value here
        computed = function(basis, **pieces.values)[power]
    if not np.isfinite(computed).all():
        raise VerificationError(f"{what}: not finite")
    exact, scale = pieces.form(form)
    if in_fractions is not None:
        given = {name: fraction(value) for name, value in pieces.values.items()}
        found = function(in_fractions, **given)[power]
        if any(a != b for a, b in zip(found.flat, exact.flat, strict=True)):
            raise VerificationError(f"{what}: in exact fractions not what the integrals are")
    errors = np.abs(np.vectorize(fraction, otypes=[object])(computed) - exact).astype(float)
    errors[errors <= 1e-40 * np.max(scale)] = 0  # of the reference, in what vanishes
    errors = np.divide(errors, scale, out=np.where(errors > 0, np.inf, 0.0), where=scale > 0)
    i, j = np.unravel_index(int(errors.argmax()), errors.shape)
    return float(errors[i, j]), f"row {i + 1}, column {j + 1}"


def _rational(form: BilinearForm, pieces: Pieces) -> bool:
    """Whether all of a form is rational at given parameters: breaks, places and factors."""
    if not all(factor.is_polynomial(x) for factor in form.along.values()):
        return False
    expressions = [*pieces.system.breaks, *form.points.values()]
    expressions += [c for factor in form.along.values() for c in Poly(factor, x).all_coeffs()]
    expressions += [v.place for pair in form.points for v in pair if v.place is not None]
    return all(number_with_digits(e, pieces.values)[1] for e in expressions)


def _samples(
    column: Facts, system: GeneralSystem, form: BilinearForm, defaults: dict[str, float]
) -> list[dict[str, float]]:
    """Values of the parameters: where each monomial of the factors has a large share.

    Parameters in places or in functions of x cannot have any size: they take others between their `low` and `high`.
    """
    forms = (*system.M, *system.C, *system.K)
    others = [f for each in forms for f in each.along.values() if not f.is_polynomial(x)]
    places = [v.place for each in forms for pair in each.points for v in pair if v.place is not None]
    bounded = {str(s) for e in (*system.breaks, *places, *others) for s in e.free_symbols}
    factors = [c for f in form.along.values() if f.is_polynomial(x) for c in Poly(f, x).all_coeffs()]
    parts = dict(enumerate((*factors, *form.points.values())))
    found = samples(Form({(k, 0, 0): c for k, c in parts.items()}, {}), defaults)
    found = [{n: defaults[n] if n in bounded else v for n, v in values.items()} for values in found]
    for share in (Fraction(1, 8), Fraction(3, 4)):
        between = {p.name: float(p.low + (p.high - p.low) * share) for p in column.parameters if p.name in bounded}
        found += [defaults | {name: value} for name, value in between.items()]
    unique = {tuple(values.items()): values for values in found}
    return [values for values in unique.values() if _sound(system, values, places)]


def _sound(system: GeneralSystem, values: dict[str, float], places: list[Expr]) -> bool:
    """Whether the breaks ascend, and places lie on the beam, none so near a break that rounding decides its side."""
    breaks = [number_with_digits(place, values)[0] for place in system.breaks]
    on = [number_with_digits(place, values)[0] for place in places]
    apart = all(place == other or abs(place - other) > fmpq(1, 10**9) for place in on for other in breaks)
    return apart and all(a < b for a, b in itertools.pairwise(breaks)) and all(0 <= place <= 1 for place in on)


def _space(pieces: Pieces) -> None:
    """The coordinates are those of all functions that meet the conditions: each does, they are independent, and as many
    as there can be. Raises VerificationError."""
    seen: list[int] = []
    count = 0
    for space in pieces.system.spaces:
        table = pieces.numbers[space.name]
        _joined(pieces, space)
        seen += [int(number) for row in table for number in set(row.tolist()) - {-1}]
        kept = [n for row in table for n in row.tolist() if n >= 0]
        if any(len(set(row) - {-1}) != len([n for n in row if n >= 0]) for row in table.tolist()):
            raise VerificationError(f"{space.name}: two functions on a segment have one coordinate")
        inner = len(pieces.system.breaks) - 2
        conditions = len(space.held) + inner * space.joined - len(space.opened)
        if len(set(kept)) != table.size - conditions:
            raise VerificationError(f"{space.name}: {len(set(kept))} coordinates, not {table.size - conditions}")
        count += len(set(kept))
    for name, _ in pieces.system.coordinates:
        seen.append(int(pieces.numbers[name][0, 0]))
        count += 1
    if count != pieces.count or set(seen) != set(range(pieces.count)):
        raise VerificationError(f"{pieces.count} coordinates, of which {count} are used")


def _joined(pieces: Pieces, space: Space) -> None:
    """Raises VerificationError where a coordinate's function jumps at a break, or does not vanish where it is held."""
    breaks = pieces.system.breaks
    for order in range(space.joined):
        for n, place in enumerate(breaks):
            here = [
                pieces.at(Value(space.name, order, place, side))
                for side in ((1,) if n == 0 else (-1,) if n == len(breaks) - 1 else (-1, 1))
            ]
            held = len(here) == 1 and (min(n, 1), order) in space.held
            jumps = len(here) == 2 and (n, order) not in space.opened and (here[0] != here[1]).any()
            if jumps or (held and (here[0] != 0).any()):
                raise VerificationError(f"{space.name}, order {order}: not joined or held at {place}")


def _functions(pieces: Pieces, module: ModuleType, basis: Any) -> Iterator[Figure]:
    """Functions and their derivatives up to the third, relative to the largest value on the segment."""
    breaks = module.places(**pieces.values)
    places = [(place, Rational(*place.as_integer_ratio()), 0) for place in PLACES if place not in breaks[1:-1]]
    inner = zip(breaks[1:-1], pieces.system.breaks[1:-1], strict=True)
    places += [(float(place), exact, side) for place, exact in inner for side in (-1, 1)]
    for space in pieces.system.spaces:
        for order in range(4):
            worst = ("", 0.0)
            for place, stated, side in places:
                computed = module.shapes(basis, place, space.name, order, side, **pieces.values)
                value = Value(space.name, order, stated, side)
                exact, most = pieces.at(value), pieces.most(value)
                errors = np.abs(np.vectorize(fraction, otypes=[object])(computed) - exact).astype(float)
                errors = np.divide(errors, most, out=np.where(errors > 0, np.inf, 0.0), where=most > 0)
                n = int(errors.argmax())
                if errors[n] >= worst[1]:
                    worst = (f"coordinate {n + 1}, x = {place:.4g}", float(errors[n]))
            what = f"derivative {order} of the functions of {space.name}, of the largest value"
            yield Figure(what, *worst, BOUND)


def _rigid(pieces: Pieces, module: ModuleType, in_fractions: Any, defaults: dict[str, float]) -> None:
    """Rigid motions in exact fractions, where they are rational. Raises VerificationError."""
    expressions = [*pieces.system.breaks]
    for motion in pieces.system.rigid:
        expressions += [c for f in motion.values() for c in Poly(f, x).all_coeffs()]
    if not all(number_with_digits(e, defaults)[1] for e in expressions):
        return
    found = module.rigid_motions(in_fractions, **{name: fraction(value) for name, value in defaults.items()})
    breaks = pieces.breaks()
    for number, motion in enumerate(pieces.system.rigid):
        for space in pieces.system.spaces:
            for segment in range(len(breaks) - 1):
                line = _polynomial(motion.get((space.name, segment), Rational(0)), pieces)
                for place in (breaks[segment], breaks[segment + 1]):
                    local = pieces.local(space.name, 0, segment, place)
                    numbers = pieces.numbers[space.name][segment]
                    whole = np.array([*found[:, number], fmpq(0)], dtype=object)[numbers]
                    if (local * whole).sum() != line(place) or (whole[max(2, 2 * space.joined) :] != 0).any():
                        raise VerificationError(f"rigid motion {number + 1}: not {line} on segment {segment}")
        for name, _ in pieces.system.coordinates:
            expected = pieces.number(motion.get((name, None), Rational(0)))
            if found[pieces.numbers[name][0, 0], number] != expected:
                raise VerificationError(f"rigid motion {number + 1}: {name} is not {expected}")
