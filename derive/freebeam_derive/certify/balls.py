"""Ball arithmetic (Arb) on the emitted kernels: roots and matrices with rigorous error bounds. Eqs. (11), (21).

The kernels are not rewritten: NumPy carries them out on arrays of balls. The floats that they hold are exact binary
fractions, and π/4 is handed to them as a ball.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import zip_longest
from types import ModuleType
from typing import Any

import flint
import numpy as np
from flint import arb, arb_mat, arb_series, fmpq, fmpq_mat
from flint.utils.flint_exceptions import DomainError

from freebeam_derive.certify.decimals import read
from freebeam_derive.certify.formal import Formal, Letters, letters, resting
from freebeam_derive.certify.moments import enclosing
from freebeam_derive.certify.numbers import Number, plain, reason
from freebeam_derive.certify.structure import Beside, held, is_even


class Unproven(ArithmeticError):
    """What was asked for could not be proven at the precision in hand; more bits may do."""


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Work with balls of so many bits, and put back what was."""
    before = flint.ctx.prec
    flint.ctx.prec = bits
    try:
        yield
    finally:
        flint.ctx.prec = before


@dataclass(frozen=True)
class Root:
    """The square root of a positive rational number, for dampings whose unit holds one. Eq. (5)."""

    square: Fraction

    def __float__(self) -> float:
        return math.sqrt(self.square)


@dataclass(frozen=True)
class Range:
    """All numbers from low to high: what is proven with it holds of each."""

    low: Fraction
    high: Fraction

    def __float__(self) -> float:
        return float((self.low + self.high) / 2)


Exact = Fraction | Root | Range


def root(square: Fraction) -> Fraction | Root:
    """The square root of a rational number that is not negative; rational where it is."""
    below, under = math.isqrt(square.numerator), math.isqrt(square.denominator)
    return Fraction(below, under) if Fraction(below, under) ** 2 == square else Root(square)


def exact(value: Exact | int) -> arb:
    """The ball of a rational number, of the root of one, or about a range."""
    if isinstance(value, Root):
        return exact(value.square).sqrt()
    if isinstance(value, Range):
        return exact(value.low).union(exact(value.high))
    value = Fraction(value)
    return arb(fmpq(value.numerator, value.denominator))


def ends(ball: arb) -> tuple[Fraction, Fraction]:
    """Lower and upper end of a ball, exactly."""
    middle, radius = (Fraction(*map(int, (v.fmpq().p, v.fmpq().q))) for v in (ball.mid(), ball.rad()))
    return middle - radius, middle + radius


def ball(middle: arb | int, radius: arb) -> arb:
    """The ball about a point, of a radius that may be a ball itself."""
    return middle + radius * arb(0, 1)


def rational(value: arb | float, bits: int) -> Fraction:
    """A dyadic rational near a ball's middle. Raises Unproven for a ball that has none."""
    if not arb(value).is_finite():
        raise Unproven("a number that the proof steps by is not finite")
    mantissa, exponent = (int(part) for part in arb(value).mid().man_exp())
    excess = mantissa.bit_length() - bits
    if excess > 0:
        mantissa, exponent = mantissa >> excess, exponent + excess
    return Fraction(mantissa << exponent) if exponent >= 0 else Fraction(mantissa, 1 << -exponent)


def greatest(balls: Iterable[arb]) -> arb:
    """What none is above, NaN where one is that. Their floats would not do: all below 1e-308 are one."""
    return reduce(arb.max, balls)


def least(balls: Iterable[arb]) -> arb:
    """What none is below, likewise."""
    return reduce(arb.min, balls)


def array(balls: list[Any]) -> Any:
    """A NumPy array of balls."""
    result = np.empty(len(balls), dtype=object)
    result[:] = balls
    return result


def one(found: Any) -> arb:
    """The only entry of an array of balls."""
    only: arb = np.asarray(found, dtype=object).reshape(-1)[0]
    return only


def roots(kernel: ModuleType, modes: int) -> tuple[Any, Any, Any]:
    """quarter, sigma (integers) and delta (balls) of the first `modes` roots γ = quarter π/4 + delta, each (modes,).

    Proven: each ball holds exactly one root of the characteristic equation, there is none besides up to the last,
    and none is counted twice. Raises Unproven where the precision does not carry that.
    """
    floats = kernel.basis(modes)
    quarter = [int(q) for q in floats.quarter]
    sigma = [int(s) for s in floats.sigma]
    if not hasattr(kernel, "characteristic"):
        # sin γ = 0 or cos γ = 0 (times a factor without zeros): the asymptotes are the roots
        return array(quarter), array(sigma), array([arb(0)] * modes)
    _isolated(kernel, modes)
    found = [_root(kernel, q, s, float(d)) for q, s, d in zip(quarter, sigma, floats.delta, strict=True)]
    if not all(abs(delta) < arb.pi() / 4 for delta in found):
        raise Unproven("a root does not lie near its asymptote")
    return array(quarter), array(sigma), array(found)


@lru_cache(maxsize=64)
def _isolated(kernel: ModuleType, modes: int) -> None:
    """One root within a quarter period of each asymptote, none elsewhere up to there. Digits do not matter here."""
    floats = kernel.basis(modes)
    with precision(80):
        pi = arb.pi()
        for n, (q, s) in enumerate(zip(floats.quarter, floats.sigma, strict=True)):
            if not _slope(kernel, arb(0, 1) * pi / 4, int(q), int(s)) > 0:
                raise Unproven(f"root {n + 1} is not known to be the only one near its asymptote")
            _no_zero(kernel, pi / 4, 3 * pi / 4, int(q), int(s))
        _none_before(kernel, int(floats.quarter[0]), int(floats.sigma[0]))


def _value(kernel: ModuleType, delta: arb, quarter: int, sigma: int) -> arb:
    return one(kernel.characteristic(array([delta]), array([quarter * arb.pi() / 4]), array([sigma]))[0])


def _slope(kernel: ModuleType, delta: arb, quarter: int, sigma: int) -> arb:
    return one(kernel.characteristic(array([delta]), array([quarter * arb.pi() / 4]), array([sigma]))[1])


def _root(kernel: ModuleType, quarter: int, sigma: int, start: float) -> arb:
    """Interval Newton around a float: the result is inside the trial ball, so it holds one root and only one."""
    bits = flint.ctx.prec
    middle, reached = arb(start), 40
    while True:
        # plain Newton with twice the digits each time
        with precision(min(2 * reached, bits) + 20):
            middle = (middle - _value(kernel, middle, quarter, sigma) / _slope(kernel, middle, quarter, sigma)).mid()
        if reached >= bits:
            break
        reached *= 2
    for wider in range(4, bits // 2, 8):
        trial = ball(middle, arb(2) ** (wider - bits))
        image = middle - _value(kernel, middle, quarter, sigma) / _slope(kernel, trial, quarter, sigma)
        if trial.contains_interior(image):
            return image
    raise Unproven("a root of the characteristic equation could not be enclosed")


def _no_zero(kernel: ModuleType, low: arb, high: arb, quarter: int, sigma: int, depth: int = 0) -> None:
    """No zero of the characteristic function for low ≤ δ ≤ high, by bisection."""
    between = low.union(high)
    if not _value(kernel, between, quarter, sigma).contains(0):
        return
    if depth > 30:
        raise Unproven("a stretch between two roots could not be shown to hold none")
    middle = (low + high) / 2
    _no_zero(kernel, low, middle, quarter, sigma, depth + 1)
    _no_zero(kernel, middle, high, quarter, sigma, depth + 1)


def _none_before(kernel: ModuleType, quarter: int, sigma: int) -> None:
    """No root between γ = 0, which may be one itself, and a quarter period before the first asymptote."""
    pi = arb.pi()
    start = -quarter * pi / 4  # δ at γ = 0
    pieces, width = 256, arb(1) / 256
    if quarter > 2:
        _no_zero(kernel, start + 1, -pi / 4, quarter, sigma)
    # Of the function times e^γ (cosh and sinh in place of ε) all derivatives below the order of its zero at γ = 0
    # vanish there; the next keeps its sign up to γ = 1, so all below do. (π/4 < 1, where the first root is beyond.)
    at_zero = _series(kernel, start, quarter, sigma, 5)
    order = next(k for k in range(6) if not at_zero[k].contains(0))
    signs = set()
    for piece in range(pieces):
        around = ball(start + width * piece + width / 2, width / 2)
        coefficient = _series(kernel, around, quarter, sigma, order)[order]
        signs.add(1 if coefficient > 0 else -1 if coefficient < 0 else 0)
    if len(signs) != 1 or 0 in signs:
        raise Unproven("the neighbourhood of γ = 0 could not be shown to hold no root")


def _series(kernel: ModuleType, delta: arb, quarter: int, sigma: int, order: int) -> list[arb]:
    """Taylor coefficients at δ, up to an order, of the characteristic function times e^γ."""
    before = flint.ctx.cap
    flint.ctx.cap = order + 1
    try:
        variable = arb_series([delta, arb(1)])
        asymptote = arb_series([quarter * arb.pi() / 4])
        value = kernel.characteristic(array([variable]), array([asymptote]), array([arb_series([arb(sigma)])]))[0]
        series = one(value) * (variable + asymptote).exp()
        return [series[k] for k in range(order + 1)]
    finally:
        flint.ctx.cap = before


def parameters(kernel: Any, own: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """All own parameters of a column as rational numbers, or what is given; defaults by their shortest decimals.

    Raises ValueError for one that it does not have.
    """
    held = {p["name"]: read(str(p["default"])) for p in kernel.COLUMN["parameters"]}
    for name in own or {}:
        if name not in held:
            raise ValueError(f"{name}: {kernel.COLUMN['name']} has no such parameter")
    return held | dict(own or {})


def matrices(
    kernel: ModuleType, modes: int, own: Mapping[str, Fraction] | None = None
) -> tuple[arb_mat, arb_mat, arb_mat]:
    """M, E, H of the elastic functions as ball matrices, at the precision in hand. Eq. (11).

    own: the column's own parameters as rational numbers, defaults where left out. Of polynomials they are rational
    numbers, computed exactly and rounded once. Raises Unproven.
    """
    held = parameters(kernel, own)
    stated_exactly(kernel, held)
    if kernel.COLUMN.get("basis") == "legendre":
        return tuple(  # type: ignore[return-value]
            arb_mat([[arb(v) for v in row] for row in matrix.tolist()])
            for matrix in _rational_matrices(kernel, modes, tuple(sorted(held.items())))
        )
    basis = basis_of(kernel, modes)
    given = {name: exact(value) for name, value in held.items()}
    found = [f(basis, **given) for f in (kernel.mass, kernel.stiffness_elastic, kernel.stiffness_load)]
    return tuple(arb_mat([[arb(v) for v in row] for row in matrix.tolist()]) for matrix in found)  # type: ignore[return-value]


def basis_of(kernel: ModuleType, modes: int) -> Any:
    """The kernel's functions, with proven roots in balls or, of polynomials, in fractions. Raises Unproven."""
    if kernel.COLUMN.get("basis") == "legendre":
        size = kernel.basis(modes).order.size
        return kernel.complete(array([fmpq(k) for k in range(size)]), array([fmpq((-1) ** k) for k in range(size)]))
    quarter, sigma, delta = roots(kernel, modes)
    corrections = [delta] if hasattr(kernel, "characteristic") else []
    return kernel.complete(quarter, sigma, *corrections, arb.pi() / 4)


def stated_exactly(kernel: ModuleType, own: Mapping[str, Fraction]) -> None:
    """Refuse a column with a factor that its kernel holds as a rounded float: what was proven would be of another."""
    try:
        stated = {
            f"form {name}": [v for part in parts for v in part.values()]
            for name, parts in kernel.forms(Fraction(1), **own).items()
        }
        stated["damping"] = kernel.damping_factors(Fraction(1), Fraction(1), **own)
    except (AttributeError, TypeError):  # fractions have no roots
        raise Unproven(f"{kernel.COLUMN['name']}: a factor of its forms is no fraction, but a root, say") from None
    for where, factors in stated.items():
        for factor in factors:
            if isinstance(factor, float) and not (factor * 2**20).is_integer():
                raise Unproven(f"{kernel.COLUMN['name']}: a factor of its {where} is no fraction, {factor!r}")


@lru_cache(maxsize=16)
def _rational_matrices(kernel: ModuleType, modes: int, own: tuple[tuple[str, Fraction], ...]) -> tuple[Any, ...]:
    """M, E, H of trial polynomials, exact."""
    basis = basis_of(kernel, modes)
    given = {name: fmpq(value.numerator, value.denominator) for name, value in own}
    try:
        return tuple(f(basis, **given) for f in (kernel.mass, kernel.stiffness_elastic, kernel.stiffness_load))
    except (AttributeError, TypeError):  # fractions have no powers of fractions
        raise Unproven(f"{kernel.COLUMN['name']}: a factor of its forms is no fraction, but a power, say") from None


Terms = list[arb_mat]


def coefficients(
    kernel: ModuleType, modes: int, own: Mapping[str, Fraction], dampings: tuple[Exact, Exact], alone: bool = False
) -> tuple[Terms, Terms, Terms]:
    """M, C and K of the elastic functions by powers of the load, of any column, as ball matrices. Eqs. (10), (11).

    dampings: alpha and beta. What is zero is exactly that; highest powers that are nothing are left out. alone: C is to
    be that of alpha and beta alone. Raises Unproven for a column with a factor whose integrals are not known, for
    damping that couples its rigid motions to the bending, and where there is another C beside that of alpha and beta
    which alone is asked for.
    """
    if kernel.COLUMN.get("general"):
        return ball_matrices(*matrices_of_any(kernel, modes, own, dampings, alone))
    M_0, E, H = matrices(kernel, modes, own)
    c_M, c_E = kernel.damping_factors(*map(exact, dampings), **{name: exact(value) for name, value in own.items()})
    if alone and not (arb(c_E) > 0 or (c_E == 0 and arb(c_M) > 0)):
        raise Unproven(f"{kernel.COLUMN['name']} has no damping that could vanish")
    return [M_0], _without_zeros([arb(c_M) * M_0 + arb(c_E) * E]), [E, H]


def matrices_of_any(
    kernel: ModuleType, modes: int, own: Mapping[str, Fraction], dampings: tuple[Exact, Exact], alone: bool = False
) -> tuple[list[Any], list[Any], list[Any]]:
    """The same of a column beyond the textbook's, as arrays (n, n) of fractions, of balls where a factor is none.
    Raises Unproven, as `coefficients` does."""
    return named_matrices(kernel, modes, own, dampings, alone)[:3]


def named_matrices(
    kernel: ModuleType, modes: int, own: Mapping[str, Fraction], dampings: tuple[Exact, Exact], alone: bool = False
) -> tuple[list[Any], list[Any], list[Any], list[str], Letters | None]:
    """The same, and for each row the field or coordinate that it is of, but for rigid motions; of balls, where there
    are no rigid motions, their letters too, None where these are not known."""
    M, C, K, names, exactly, beside = matrices_with_rates(kernel, modes, own, dampings, alone)
    if beside:
        what = "acts on displacements too" if beside.acts else "leaves rates of the column's own"
        raise Unproven(f"{kernel.COLUMN['name']}: a damping that vanishes {what}")
    return M, C, K, names, exactly


def matrices_with_rates(
    kernel: ModuleType, modes: int, own: Mapping[str, Fraction], dampings: tuple[Exact, Exact], alone: bool = False
) -> tuple[list[Any], list[Any], list[Any], list[str], Letters | None, Beside | None]:
    """The same, and with `alone` what there is beside the damping that vanishes, which leaves the determinant even."""
    name = kernel.COLUMN["name"]
    for damping, value in zip(("alpha", "beta"), dampings, strict=True):
        if value != 0 and damping in kernel.COLUMN["coupled"]:
            raise Unproven(f"{damping}: this damping couples the rigid motions of {name} to its bending")
    M, parts, R = _stated(kernel, modes, own)
    whole = M, *(_vanishing if alone else _damped)(parts, *map(_size, dampings))
    (M, C, K, G, S), dropped = _elastic_terms(whole if alone else (*whole, [], []), R)
    inexact = any(isinstance(v, arb) for terms in (M, C, K) for X in terms for v in X.flat)
    sums = _sums(kernel, modes, tuple(sorted(own.items())), dampings, alone) if inexact else None
    beside = None
    if any(held(X).any() for X in (*G, *S)):
        if R.shape[1]:
            raise Unproven(
                f"{name}: a damping that vanishes leaves rates of the column's own, or acts on displacements, beside "
                "rigid motions"
            )
        if not (is_even(M, G, K) or (sums and is_even(*letters([sums[0], sums[3], sums[2]])))):
            raise Unproven(f"{name}: a damper of its own stays when alpha and beta vanish")
        *_, of_G, of_S = letters(sums) if sums else [None, None]
        beside = Beside(G, S, (of_G, of_S) if of_G is not None and of_S is not None else None)
    rest = resting(sums[2][0]) if sums and not beside and not _regular(K[0]) else None
    if rest is not None and (not R.shape[1] or rest.holds(R)):
        turned = [[rest.left.T @ X @ rest.right for X in terms] for terms in whole[:3]]
        (M, C, K), dropped = _elastic_terms(turned, rest.seen(R))
        kept = [n for n in range(len(R)) if n not in dropped]
        K[0][[kept.index(n) for n in rest.rows if n in kept], :] = fmpq(0)
        K[0][:, [kept.index(n) for n in rest.columns if n in kept]] = fmpq(0)
    else:
        rest = None
    exactly = None
    if sums and not R.shape[1]:
        of_M, of_C, of_K = letters(
            [[X if rest is None else rest.left.T @ X @ rest.right for X in of] for of in sums[:3]]
        )
        exactly = of_M, of_C, of_K
    numbers = kernel.basis(modes).numbers
    names = [next(of for of, table in numbers.items() if n in table) for n in range(len(R))]
    return M, C, K, [of for n, of in enumerate(names) if n not in dropped], exactly, beside


def _regular(K: Any) -> bool:
    return not arb_mat([[arb(v) for v in row] for row in K.tolist()]).det().contains(0)


def _damped(parts: list[Any], alpha: Any, beta: Any) -> Any:
    """C and K at alpha and beta, of those without and with each alone."""
    C, K, G, S = _vanishing(parts, alpha, beta)
    return [x + y for x, y in zip(G, C, strict=True)], [x + y for x, y in zip_longest(K, S, fillvalue=0)]


def _vanishing(parts: list[Any], alpha: Any, beta: Any) -> Any:
    """Of the same what alpha and beta make of C, K without them, then C without them and what they make of K."""
    C, S = (
        [alpha * (x - b) + beta * (y - b) for b, x, y in zip(*of, strict=True)] if of[1:] else []
        for of in (parts[:3], parts[3:])
    )
    return C, parts[3], parts[0], S


def formal(value: Exact | int) -> Formal:
    """An exact number as one that tells how it comes about. TypeError for a range."""
    if isinstance(value, Range):
        raise TypeError("a range is no number")
    if isinstance(value, Root):
        return Formal.named(f"sqrt({value.square})")
    return Formal(fmpq(*value.as_integer_ratio()))


@lru_cache(maxsize=4)
def _sums(
    kernel: ModuleType, modes: int, own: tuple[tuple[str, Fraction], ...], dampings: tuple[Exact, Exact], alone: bool
) -> list[list[Any]] | None:
    """M, C and K, with rigid motions, of numbers that tell how they come about, None where that is not known; alone:
    and what is beside a damping that vanishes."""
    basis = kernel.complete(array([Formal(k) for k in range(modes + 2)]))
    given = {name: formal(value) for name, value in own}
    try:
        sizes = [*map(formal, dampings)]
        of = enclosing(kernel, formal=True)
        terms = (_vanishing if alone else _damped)(_rates_and_stiffness(kernel, of, basis, given, Formal), *sizes)
        return [
            [array_of(lambda v: v + Formal(0), X) for X in powers] for powers in (of.mass_terms(basis, **given), *terms)
        ]
    except (AttributeError, TypeError, ValueError):
        return None


def _rates_and_stiffness(kernel: ModuleType, of: Any, basis: Any, given: dict[str, Any], number: Any) -> list[Any]:
    """C without alpha and beta and with each alone, then K, of the same kinds where it hangs on these."""
    each = [tuple(map(number, d)) for d in ((0, 0), (1, 0), (0, 1))]
    parts = [of.rate_terms(basis, *d, **given) for d in each]
    return parts + [
        of.stiffness_terms(basis, *d, **given) for d in (each if kernel.COLUMN.get("circulatory") else [()])
    ]


def _stated(kernel: ModuleType, modes: int, own: Mapping[str, Fraction]) -> tuple[Any, list[Any], Any]:
    """M, C without alpha and beta and with each alone, K, of the same kinds where it hangs on these, and rigid motions,
    of fractions; of balls where there are none."""
    basis = kernel.complete(array([fmpq(k) for k in range(modes + 2)]))
    given: dict[str, Any] = {name: fmpq(*value.as_integer_ratio()) for name, value in own.items()}

    def asked(of: Any) -> tuple[Any, list[Any], Any]:
        parts = _rates_and_stiffness(kernel, of, basis, given, fmpq)
        return of.mass_terms(basis, **given), parts, kernel.rigid_motions(basis, **given)

    try:
        return asked(kernel)
    except (AttributeError, DomainError, TypeError, ValueError):
        pass  # a root of a number, say, or a factor that is no polynomial in x
    given = {name: Number(value) for name, value in given.items()}
    basis = basis._replace(order=array([Number(k) for k in basis.order]))
    try:
        M, parts, R = asked(enclosing(kernel))
        M, *parts = ([array_of(plain, X) for X in terms] for terms in (M, *parts))
        return M, parts, array_of(plain, R)
    except (AttributeError, DomainError, TypeError, ValueError) as error:
        raise Unproven(f"{kernel.COLUMN['name']}: its matrices are no fractions or balls: {reason(error)}") from None


def array_of(change: Callable[[Any], Any], X: Any) -> Any:
    """An array with each entry changed."""
    found = np.empty(X.shape, dtype=object)
    for at, value in np.ndenumerate(X):
        found[at] = change(value)
    return found


def ball_matrices(M: list[Any], C: list[Any], K: list[Any]) -> tuple[Terms, Terms, Terms]:
    """Arrays as matrices of balls at the precision in hand; highest powers of C that are nothing are left out."""
    M, C, K = ([arb_mat([[arb(v) for v in row] for row in X.tolist()]) for X in terms] for terms in (M, C, K))
    return M, _without_zeros(C), K


def _size(damping: Exact) -> fmpq | arb:
    return fmpq(*damping.as_integer_ratio()) if isinstance(damping, Fraction | int) else exact(damping)


def _elastic_terms(terms: Sequence[list[Any]], R: Any) -> tuple[list[list[Any]], list[int]]:
    """Matrices without rigid motions, those of M first; and which coordinates are left out."""
    T, dropped = _elastic(R, terms[0][0])
    return [[X if T is None else T.T @ X @ T for X in of] for of in terms], dropped


def _elastic(R: Any, M: Any) -> tuple[Any, list[int]]:
    """Functions that are M-orthogonal to the rigid motions R, as columns, None where there are none of these; each is a
    coordinate and what of R makes it orthogonal, but for some coordinates, whose numbers are given too."""
    count = R.shape[1]
    if not count:
        return None, []
    left, dropped = R.copy(), []
    for k in range(count):
        row = next(i for i in range(len(R)) if left[i, k] != 0)
        dropped.append(row)
        for other in range(k + 1, count):
            left[:, other] = left[:, other] - left[:, k] * (left[row, other] / left[row, k])
    others = np.delete(np.array([[fmpq(int(i == j)) for j in range(len(R))] for i in range(len(R))]), dropped, axis=1)
    A, B = R.T @ M @ R, R.T @ M @ others
    kind: Any = arb_mat if any(isinstance(v, arb) for X in (A, B) for v in X.flat) else fmpq_mat
    try:
        solved = kind(A.tolist()).solve(kind(B.tolist()))
    except ZeroDivisionError:
        raise Unproven("rigid motions are not known to be independent and to have mass") from None
    return others - R @ np.array(solved.tolist()), dropped


def _without_zeros(terms: list[arb_mat]) -> list[arb_mat]:
    while terms and all(v == 0 for v in terms[-1].entries()):
        terms.pop()
    return terms
