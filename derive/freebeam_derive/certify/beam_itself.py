"""Critical loads and frequencies of the beam itself, enclosed: Krawczyk's method on F(p, s). Eqs. (6), (14), (15).

Newton's method from a start that the caller has (a Ritz value) finds a small box; that Krawczyk's image of the box lies
in its interior proves that it holds one zero and only one. The digits then come by the same step, with J kept as long
as that pays. The rest is decided on the box: that the crossing is simple, and that with growing load it leads from a
stable pair to an unstable one (`onset`). That no other mode of the infinitely many is unstable at a lower load is
proven in `beam_stability`, if at all, and `first` and `stable_below` say so.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Literal

import flint
from flint import acb, arb, arb_mat

from freebeam_derive.certify.balls import Exact, Unproven, ball, exact, precision
from freebeam_derive.certify.beam import Beam, Order, Taylor
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.krawczyk import image, inside, inverse

Kind = Literal["flutter", "divergence"]
Itself = Beam | ExactSystem
Facts = tuple[list[arb], Taylor]  # a box, and what the beam's function is on all of it

_FIRST: tuple[Order, ...] = ((0, 0), (1, 0), (0, 1))


class NoZero(Unproven):
    """Newton's method finds nothing near the start; more bits would not help."""


class NoOnset(Unproven):
    """A crossing was proven, but with growing load it does not lead from stable to unstable."""


@dataclass(frozen=True)
class Proof:
    """What was proven. crossing: it exists, alone in the enclosure. kind: so does its kind, and that it is an onset.

    first, stable_below: so are these, of all modes there are; `beam_stability` alone sets them.
    """

    crossing: bool = True
    first: bool = False
    stable_below: bool = False
    kind: bool = True


@dataclass(frozen=True)
class ExactCrossing:
    """A loss of stability of the beam itself.

    load, frequency: enclosures, nondimensional; the frequency of a divergence is zero. bits: the precision it took.
    """

    load: arb
    frequency: arb
    kind: Kind
    digits: int
    bits: int
    proof: Proof = field(default_factory=Proof)


class Problem(ABC):
    """n real equations for n real unknowns, in balls: what they say of F(p, s), its Taylor coefficients t.

    sought: what their zero is. of_value, of_slopes: the orders of t that equations and matrix need.
    """

    sought: str
    of_value: tuple[Any, ...]
    of_slopes: tuple[Any, ...]

    def __init__(self, beam: Itself) -> None:
        self.beam = beam

    def place(self, x: list[arb]) -> tuple[Any, Any]:
        """p and s of the unknowns."""
        return x[0], x[1]

    @abstractmethod
    def equations(self, x: list[arb], t: Taylor) -> list[arb]:
        """What must vanish."""

    @abstractmethod
    def matrix(self, x: list[arb], t: Taylor) -> list[list[arb]]:
        """Its derivatives by the unknowns."""

    def value(self, x: list[arb]) -> list[arb]:
        """The equations at a point or on a box."""
        return self.equations(x, self.beam.taylor(*self.place(x), self.of_value))

    def slopes(self, x: list[arb]) -> tuple[list[arb], arb_mat, Taylor]:
        """The equations, their matrix of derivatives, and the derivatives of F that they were made of."""
        t = self.beam.taylor(*self.place(x), self.of_slopes)
        return self.equations(x, t), arb_mat(self.matrix(x, t)), t

    def scale(self, x: list[arb]) -> list[arb]:
        """What the widths of the unknowns are relative to."""
        return [abs(value).mid() for value in x]


class Onset(Problem):
    """A crossing, of which more is to be proven."""

    kind: Kind = "flutter"

    def frequency(self, x: list[arb]) -> arb:
        """ω of the crossing; the second unknown is ω² where not said otherwise."""
        return x[1].sqrt()

    @abstractmethod
    def onset(self, x: list[arb], t: Taylor) -> None:
        """With growing load it leads from stable to unstable. Raises NoOnset, or Unproven."""


class Coalescence(Onset):
    """(p, s) with F = ∂F/∂s = 0: two eigenvalues meet. No damping."""

    sought = "undamped flutter at the load (and ω²)"
    of_value = ((0, 0), (0, 1))
    of_slopes = ((0, 0), (0, 1), (1, 0), (1, 1), (0, 2))

    def equations(self, x: list[arb], t: Taylor) -> list[arb]:
        return [t[0, 0], t[0, 1]]

    def matrix(self, x: list[arb], t: Taylor) -> list[list[arb]]:
        return [[t[1, 0], t[0, 1]], [t[1, 1], 2 * t[0, 2]]]

    def onset(self, x: list[arb], t: Taylor) -> None:
        """Near the double root (s − s*)² ~ −2 F_p / F_ss (p − p*): two real s below p*, complex ones above."""
        _sign(t[0, 2] * t[1, 0], "the pair is complex below the load and real above it, a restabilisation")


class Damped(Onset):
    """(P, ω) with F = 0 at λ = iω."""

    sought = "damped flutter at the load (and ω)"
    of_value = ((0, 0),)
    of_slopes = _FIRST

    def __init__(self, beam: Itself, alpha: Exact, beta: Exact) -> None:
        super().__init__(beam)
        self.alpha, self.beta = alpha, beta

    def frequency(self, x: list[arb]) -> arb:
        return x[1]

    def place(self, x: list[arb]) -> tuple[acb, acb]:
        p, s, *_ = self.beam.pencil(x[0], acb(0, x[1]), self.alpha, self.beta)
        return p, s

    def equations(self, x: list[arb], t: Taylor) -> list[arb]:
        return [t[0, 0].real, t[0, 0].imag]

    def _chain(self, x: list[arb], t: Taylor) -> tuple[acb, acb]:
        """F by the load and by the frequency."""
        _, _, p_slope, s_slope, inverse = self.beam.pencil(x[0], acb(0, x[1]), self.alpha, self.beta)
        return t[1, 0] * inverse, acb(0, 1) * (t[1, 0] * p_slope + t[0, 1] * s_slope)

    def matrix(self, x: list[arb], t: Taylor) -> list[list[arb]]:
        by_load, by_frequency = self._chain(x, t)
        return [[by_load.real, by_frequency.real], [by_load.imag, by_frequency.imag]]

    def onset(self, x: list[arb], t: Taylor) -> None:
        """d Re λ / dP > 0, where dλ/dP = −i G_P / G_ω."""
        by_load, by_frequency = self._chain(x, t)
        _sign((by_load * by_frequency.conjugate()).imag, "the growth rate falls with the load there, a restabilisation")


class VanishingDamping(Onset):
    """(p, s) with F = 0 and p s'(p) − s = κ on it: the limit α → 0⁺ at β = κα (the tangent rule)."""

    sought = "flutter at vanishing damping at the load (and ω²)"
    of_value = _FIRST
    of_slopes = (*_FIRST, (2, 0), (1, 1), (0, 2))

    beam: Beam

    def __init__(self, beam: Beam, kappa: Exact) -> None:
        super().__init__(beam)
        self.kappa = kappa

    def moved(self, x: list[arb]) -> arb:
        """s + κ."""
        c_E, c_M = self.beam.damping(Fraction(1), self.kappa)
        if not c_E > 0:
            raise ValueError(f"{self.beam.name}: has no internal damping that could vanish; give a damping instead")
        return x[1] + c_M / c_E

    def equations(self, x: list[arb], t: Taylor) -> list[arb]:
        return [t[0, 0], x[0] * t[1, 0] + self.moved(x) * t[0, 1]]

    def matrix(self, x: list[arb], t: Taylor) -> list[list[arb]]:
        p, moved = x[0], self.moved(x)
        by_p = t[1, 0] + 2 * p * t[2, 0] + moved * t[1, 1]
        by_s = p * t[1, 1] + t[0, 1] + 2 * moved * t[0, 2]
        return [[t[1, 0], t[0, 1]], [by_p, by_s]]

    def onset(self, x: list[arb], t: Taylor) -> None:
        """The growth rate, α (p s' − s − κ)/2 to first order, rises through zero: p s'' > 0."""
        if t[0, 1].contains(0):
            raise Unproven("the eigenvalue is not known to be simple")
        slope = -t[1, 0] / t[0, 1]
        bend = -2 * (t[2, 0] + t[1, 1] * slope + t[0, 2] * slope * slope) / t[0, 1]
        _sign(bend, "the growth rate falls with the load there, a restabilisation")


class VanishingRates(Onset):
    """(P, s) with F = ∂F/∂w = 0: the same of any column. w is the damping times λ, and λ = iω + ε F_w / (2 F_s)."""

    sought = VanishingDamping.sought
    of_value = ((0, 0, 0), (0, 0, 1))
    of_slopes = (*of_value, (1, 0, 0), (0, 1, 0), (1, 0, 1), (0, 1, 1))

    def equations(self, x: list[arb], t: dict[Any, Any]) -> list[arb]:
        return [t[0, 0, 0], t[0, 0, 1]]

    def matrix(self, x: list[arb], t: dict[Any, Any]) -> list[list[arb]]:
        return [[t[1, 0, 0], t[0, 1, 0]], [t[1, 0, 1], t[0, 1, 1]]]

    def onset(self, x: list[arb], t: dict[Any, Any]) -> None:
        """The growth rate rises through zero: (F_wP + F_ws s') / F_s > 0."""
        if t[0, 1, 0].contains(0):
            raise Unproven("the eigenvalue is not known to be simple")
        slope = -t[1, 0, 0] / t[0, 1, 0]
        rises = (t[1, 0, 1] + t[0, 1, 1] * slope) / t[0, 1, 0]
        _sign(rises, "the growth rate falls with the load there, a restabilisation")


class Static(Onset):
    """p with F(p, 0) = 0, after the factor s^R of the rigid motions is struck out."""

    sought = "divergence at the load"
    kind = "divergence"

    def frequency(self, x: list[arb]) -> arb:
        return arb(0)

    def __init__(self, beam: Itself) -> None:
        super().__init__(beam)
        R = self.order = beam.trivial()
        self.of_value = tuple((0, j) for j in range(R + 1))
        self.of_slopes = (*((0, j) for j in range(R + 2)), *((1, j) for j in range(R + 1)))

    def place(self, x: list[arb]) -> tuple[arb, arb]:
        return x[0], arb(0)

    def equations(self, x: list[arb], t: Taylor) -> list[arb]:
        return [t[0, self.order]]

    def matrix(self, x: list[arb], t: Taylor) -> list[list[arb]]:
        return [[t[1, self.order]]]

    def onset(self, x: list[arb], t: Taylor) -> None:
        """s passes from positive to negative: −F_p / F_s < 0. Where F_s may be zero, as of a gyroscopic column, whose λ
        and −λ leave zero together: above the load F has other signs at λ = 0 and at λ = 1, and a zero between."""
        slope, beam = t[1, self.order], self.beam
        if not t[0, self.order + 1].contains(0) or not isinstance(beam, ExactSystem) or not beam.rated:
            slopes = slope * t[0, self.order + 1]
            _sign(slopes, "the eigenvalue comes from the right half plane with growing load there, a restabilisation")
            return
        beyond = beam.taylor(x[0], arb(-1), ((0, 0),))[0, 0] * (-1) ** self.order
        _sign(
            -slope * beyond,
            "above it the number of real eigenvalues between 0 and 1 is even and below it odd, a restabilisation where "
            "there are no others",
        )


class Eigenvalue(Problem):
    """λ with F = 0 at a load: real (x), imaginary without damping (i x), or complex (x + i y)."""

    sought = "the eigenvalue"
    of_value = ((0, 0),)
    of_slopes = _FIRST

    def __init__(
        self, beam: Itself, load: Fraction, alpha: Exact, beta: Exact, line: Literal["real", "imaginary", "plane"]
    ) -> None:
        super().__init__(beam)
        self.load, self.alpha, self.beta, self.line = load, alpha, beta, line

    def eigenvalue(self, x: list[arb]) -> acb:
        """λ of the unknowns."""
        return acb(*x) if self.line == "plane" else acb(x[0]) if self.line == "real" else acb(0, x[0])

    def scale(self, x: list[arb]) -> list[arb]:
        return [abs(self.eigenvalue(x)).mid()] * len(x)

    def _chain(self, x: list[arb]) -> tuple[Any, Any, Any, Any]:
        """p, s and how they change with x (with λ in the plane)."""
        P = exact(self.load)
        if self.line == "imaginary":
            return P, x[0] * x[0], arb(0), 2 * x[0]
        return self.beam.pencil(P, acb(*x) if self.line == "plane" else x[0], self.alpha, self.beta)[:4]

    def place(self, x: list[arb]) -> tuple[Any, Any]:
        return self._chain(x)[:2]

    def equations(self, x: list[arb], t: Taylor) -> list[arb]:
        F = t[0, 0]
        return [F.real, F.imag] if self.line == "plane" else [F]

    def matrix(self, x: list[arb], t: Taylor) -> list[list[arb]]:
        _, _, p_slope, s_slope = self._chain(x)
        slope = t[1, 0] * p_slope + t[0, 1] * s_slope
        if self.line != "plane":
            return [[slope]]
        return [[slope.real, -slope.imag], [slope.imag, slope.real]]


def _sign(ball: arb, otherwise: str) -> None:
    """ball > 0, or NoOnset where it is negative, or Unproven."""
    if ball < 0:
        raise NoOnset(otherwise)
    if not ball > 0:
        raise Unproven("the direction of the crossing is not known")


# -------------------------------------------------------------------- the method


def krawczyk(problem: Problem, box: Sequence[arb]) -> list[arb]:
    """A smaller box with the one zero that `box` is thereby proven to hold, at the precision in force.

    Raises Unproven where the proof fails: there may be none, or more than one.
    """
    x = [side.mid() for side in box]
    return inside(box, image(x, problem.value(x), problem.slopes(list(box))[1], box))


def _log2(ball: arb) -> int:
    """About log2 of an upper bound of |ball|, also far below the smallest float."""
    bound = abs(ball).upper()
    if not bound.is_finite():
        raise Unproven("the balls grew without bound")
    mantissa, power = bound.man_exp()
    return int(power) + int(mantissa).bit_length() if mantissa else -(10**9)


def _accuracy(box: Sequence[arb], scale: Sequence[arb]) -> int:
    """Bits of the least accurate side."""
    return min(_log2(size) - _log2(side.rad()) for side, size in zip(box, scale, strict=True))


def enclose(problem: Problem, start: Sequence[float], digits: int) -> tuple[list[arb], Facts, int]:
    """The zero near a start, to relative widths below 10^-digits; a box about it with F's derivatives; bits used.

    Bits are doubled until the proof succeeds. Raises Unproven when they do not help.
    """
    if digits < 1:
        raise ValueError(f"digits = {digits}: must be 1 or greater")
    target = round(digits * 3.3219281) + 4
    bits = 96
    while True:
        try:
            return _enclose(problem, start, target, bits)
        except Unproven as failure:
            if isinstance(failure, NoZero) or bits > 2 * target + 2048:
                place = ", ".join(f"{v:.10g}" for v in start)
                raise type(failure)(f"{problem.sought} {place} is not proven: {failure}") from None
        bits *= 2


def _enclose(problem: Problem, start: Sequence[float], target: int, bits: int) -> tuple[list[arb], Facts, int]:
    with precision(bits):
        x, radius, guard = _approach(problem, start, bits)
        box = [ball(middle, size * arb(2) ** -radius) for middle, size in zip(x, problem.scale(x), strict=True)]
        _, slopes, taylor = problem.slopes(box)
        facts: Facts = (box, taylor)
    used = max(bits, min(target + 4, 2 * radius) + guard)
    with precision(used):
        found = inside(box, image(x, problem.value(x), slopes, box))
    # the zero is in the box and alone there; from here on it is only refined
    domain, held, reached = box, radius, _accuracy(found, problem.scale(found))
    gain = reached - radius
    while reached < target:
        if target - reached > 2 * gain:
            with precision(reached + guard):
                _, slopes, taylor = problem.slopes(found)
                domain, held, facts = found, reached, (found, taylor)
        wanted = min(target + 4, reached + held)
        x = []
        for side, whole in zip(found, domain, strict=True):
            with precision(reached + 16):  # short numbers are faster
                short = (+side).mid()
            x.append(short if side.contains(short) else side.mid())
            if not whole.contains(x[-1]):  # J must be known from there to the zero
                raise Unproven("rounding led out of the box")
        with precision(wanted + guard):
            new = image(x, problem.value(x), slopes, found)
            finer = [old.intersection(part) for old, part in zip(found, new, strict=True)]
            used = max(used, flint.ctx.prec)
        better = _accuracy(finer, problem.scale(finer))
        gain = better - reached
        if gain <= 0:
            raise Unproven("the enclosure does not shrink")
        found, reached = finer, better
    return found, facts, used


def _approach(problem: Problem, start: Sequence[float], bits: int) -> tuple[list[arb], int, int]:
    """Newton's method: a point, the bits of a box about it that ought to hold the zero, the bits lost to rounding."""
    x = [arb(value) for value in start]
    scales = problem.scale(x)
    before, settled = 0, max(20, bits // 4 - 4)
    for _ in range(30):
        value, slopes, _ = problem.slopes(x)
        step = inverse(slopes) * arb_mat([[v] for v in value])
        sides = [step[i, 0] for i in range(len(x))]
        scale = problem.scale(x)
        noise = _accuracy(sides, scale)
        size = min(_log2(s) - _log2(side.mid()) for side, s in zip(sides, scale, strict=True))
        x = [(middle - side).mid() for middle, side in zip(x, sides, strict=True)]
        if any(abs(now - then) > abs(s) / 2 for now, then, s in zip(x, start, scales, strict=True)):
            raise NoZero("Newton's method leads away from there")
        if noise < settled + 4:
            raise Unproven("rounding hides the zero")
        if size >= settled:
            # each step squares the error, up to a factor that the last two steps show
            lost = max(0, 2 * before - size) if before > 2 else 8
            return x, min(max(2 * size - lost - 6, size - 2), noise - 6), max(bits - noise, 0) + 8
        before = size
    raise NoZero("Newton's method does not settle")


# -------------------------------------------------------------------- what is asked for


def flutter_undamped(beam: Itself, near: tuple[float, float], digits: int) -> ExactCrossing:
    """Onset of flutter without damping: two frequencies meet. near: load and frequency, such as Ritz values.

    Raises Unproven where the load could not be enclosed, NoOnset where it is a restabilisation.
    """
    return onset(Coalescence(beam), (near[0], near[1] ** 2), digits)


def flutter_damped(beam: Itself, alpha: Exact, beta: Exact, near: tuple[float, float], digits: int) -> ExactCrossing:
    """Onset of flutter with damping, Eq. (12). near: load and frequency. Raises Unproven, NoOnset."""
    try:
        return onset(Damped(beam, alpha, beta), near, digits)
    except NoOnset:
        raise
    except Unproven as error:
        if alpha != 0 or beta != 0:
            raise
        raise type(error)(
            f"{error}; where two frequencies meet, as of a gyroscopic column without damping, a series is proven alone"
        ) from None


def flutter_limit(beam: Itself, kappa: Exact, near: tuple[float, float], digits: int) -> ExactCrossing:
    """The limit of the onset of flutter as α → 0⁺ at β = κα; of any column, that its system was made with. near: load
    and frequency. Raises Unproven, NoOnset."""
    problem = VanishingDamping(beam, kappa) if isinstance(beam, Beam) else VanishingRates(beam)
    return onset(problem, (near[0], near[1] ** 2), digits)


def divergence(beam: Itself, near: float, digits: int) -> ExactCrossing:
    """Onset of divergence: a frequency falls to zero; any damping. near: the load. Raises Unproven, NoOnset."""
    with precision(96):
        problem = Static(beam)
    return onset(problem, (near,), digits)


def onset(problem: Onset, near: tuple[float, ...], digits: int) -> ExactCrossing:
    """The crossing, proven to be an onset on the box that it was found in, or else on the narrow one."""
    found, facts, bits = enclose(problem, near, digits)
    with precision(bits):
        if not all(value > 0 for value in found):
            raise Unproven(f"{problem.sought} {float(found[0]):.10g} is not known to be positive")
        try:
            problem.onset(*facts)
        except NoOnset as refusal:
            raise NoOnset(f"{problem.sought} {float(found[0]):.10g} is a crossing, but {refusal}") from None
        except Unproven:
            problem.onset(found, problem.slopes(found)[2])
        return ExactCrossing(found[0], problem.frequency(found), problem.kind, digits, bits)


def frequencies(
    beam: Itself, load: Fraction, alpha: Exact, beta: Exact, near: Sequence[complex], digits: int
) -> tuple[acb, ...]:
    """Eigenvalues λ of the beam at a load, one for each start. Each enclosure holds one eigenvalue and only one, widths
    relative to |λ|; on the real axis, or without damping on the imaginary one, it is known to be.

    Raises Unproven where one could not be enclosed, or where two starts lead to the same.
    """
    found: list[acb] = []
    for start in near:
        value = _eigenvalue(beam, load, alpha, beta, complex(start), digits)
        for other, known in zip(near, found, strict=False):
            if value.overlaps(known):
                raise Unproven(f"the starts {other:.8g} and {start:.8g} lead to one eigenvalue")
        found.append(value)
    return tuple(found)


def _eigenvalue(beam: Itself, load: Fraction, alpha: Exact, beta: Exact, start: complex, digits: int) -> acb:
    small = 1e-6 * abs(start)
    lines: list[tuple[Literal["real", "imaginary", "plane"], tuple[float, ...]]] = []
    if abs(start.imag) <= small:
        lines.append(("real", (start.real,)))
    elif beam.undamped(alpha, beta) and abs(start.real) <= small:
        lines.append(("imaginary", (start.imag,)))
    lines.append(("plane", (start.real, start.imag)))
    failure: Unproven | None = None
    for line, unknowns in lines:
        problem = Eigenvalue(beam, load, alpha, beta, line)
        try:
            return problem.eigenvalue(enclose(problem, unknowns, digits)[0])
        except Unproven as problem_met:
            failure = problem_met
    assert failure is not None
    raise failure
