"""Certified loads, nothing remembered from one call to the next: against bisection and a plain series in mpmath."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath as mp
import pytest

import freebeam as fb
from freebeam_derive.certify import balls, beam, beam_itself, first_crossing
from freebeam_derive.certify.boundary_polynomials import Question

RITZ = "A critical load at N = 8, free-free, to so many digits"
BEAM = "The flutter load of the beam itself, free-free, to so many digits"
DAMPED = (Fraction(1, 1000), Fraction(1, 10))
CASES = {
    "undamped": (Question(8), (109.7217602, 23.0812644)),
    "α = 0.001, β = 0.1": (Question(8, *DAMPED), (90.8526572, 11.9553367)),
    "α → 0⁺": (Question(8, kappa=Fraction(0)), (88.1642206, 11.7280670)),
}
NEAR = (109.6891920, 23.0733299)


def forget() -> None:
    for remembered in (balls._isolated, balls._rational_matrices, beam._majorant, beam._weights, beam._shared):
        remembered.cache_clear()


def width(low: Any, high: Any) -> str:
    return f"width {mp.nstr((high - low) / high, 1)}, proven"


@pytest.mark.parametrize(("digits", "bound"), [(50, 0.2), (1000, 5.0)])
@pytest.mark.parametrize("case", CASES)
def bench_series(contender: Any, case: str, digits: int, bound: float) -> None:
    """The crossing, its kind, that it is the first, and stability on all of the interval below."""
    question, near = CASES[case]
    kernel = fb.column("free-free").kernel

    def ours() -> Any:
        forget()
        return first_crossing.certify(kernel, question, near, digits).load

    contender(
        RITZ,
        f"ours, {digits}, {case}",
        ours,
        error=lambda load: width(*(mp.mpf(v.numerator) / v.denominator for v in load)),
        bound=bound,
        rounds=None if digits == 50 else 3,
    )


@pytest.mark.parametrize("case", ["undamped", "α = 0.001, β = 0.1"])
def bench_bisection(contender: Any, case: str) -> None:
    """From an interval of 1, by the largest real part of mpmath's eigenvalues; proves nothing."""
    alpha, beta = (mp.mpf(v.numerator) / v.denominator for v in (CASES[case][0].alpha, CASES[case][0].beta))

    def bisection() -> Any:
        with mp.workdps(60 if alpha else 110):
            with balls.precision(600):
                M, E, H = (
                    mp.matrix([[mp.mpf(v.mid().str(120, radius=False)) for v in row] for row in m.tolist()])
                    for m in balls.matrices(fb.column("free-free").kernel, 8)
                )
            inverse = M**-1
            low, high = mp.floor(CASES[case][1][0]), mp.ceil(CASES[case][1][0])
            while high - low > mp.mpf(10) ** -50 * high:
                middle = (low + high) / 2
                K = inverse * (E + middle * H)
                if alpha == 0:
                    grows = any(abs(v.imag) > mp.mpf(10) ** -40 * abs(v) for v in mp.eig(K, right=False))
                else:
                    A = mp.zeros(16, 16)
                    A[:8, 8:], A[8:, :8], A[8:, 8:] = mp.eye(8), -K, -inverse * (alpha * E + beta * M)
                    grows = any(v.real > 0 for v in mp.eig(A, right=False))
                low, high = (low, middle) if grows else (middle, high)
            return high

    contender(RITZ, f"bisection with mpmath.eig, 50, {case}", bisection, error=lambda _: "nothing proven", rounds=1)


@pytest.mark.parametrize("called", ["first", "again"])
@pytest.mark.parametrize(("digits", "bound"), [(50, 0.01), (1000, 1.0)])
@pytest.mark.parametrize("case", ["undamped", "α = 0.001, β = 0.1"])
def bench_beam(contender: Any, case: str, digits: int, bound: float, called: str) -> None:
    """The crossing and its kind. A first call also makes the tables that any column and load share, such as 1/n!."""
    kernel = fb.column("free-free").kernel

    def ours() -> Any:
        if called == "first":
            forget()
        if case == "undamped":
            return beam_itself.flutter_undamped(beam.Beam(kernel), NEAR, digits)
        return beam_itself.flutter_damped(beam.Beam(kernel), *DAMPED, (90.8385772, 11.9509445), digits)

    contender(
        BEAM,
        f"ours, {digits}, {case}, {called}",
        ours,
        error=lambda found: f"width {(2 * found.load.rad() / found.load).str(1, radius=False)}, proven",
        bound=bound,
    )


def characteristic(p: Any, s: Any) -> list[Any]:
    """F of y'''' + p (x y')' = s y with free ends, and F_p, F_s, F_ps, F_ss, by the plain series from x = 0."""
    ends = []
    for first in ((1, 0), (0, 1)):
        a = [[mp.mpf(v), *[mp.mpf(0)] * 4] for v in (*first, 0, 0)]
        two, three, n = [mp.mpf(0)] * 5, [mp.mpf(0)] * 5, 0
        while n < 24 or any(abs(v) * n**3 > mp.eps for c in a[-4:] for v in c):
            here, beyond = a[n], [(n + 1) ** 2 * v for v in a[n + 1]]
            c = [s * u - p * v for u, v in zip(here, beyond, strict=True)]
            c[1] -= beyond[0]
            c[2] += here[0]
            c[3] += here[1] - beyond[2]
            c[4] += 2 * here[2]
            factor = (n + 1) * (n + 2) * (n + 3) * (n + 4)
            a.append([v / factor for v in c])
            n += 1
        for m, c in enumerate(a):
            two = [t + m * (m - 1) * v for t, v in zip(two, c, strict=True)]
            three = [t + m * (m - 1) * (m - 2) * v for t, v in zip(three, c, strict=True)]
        ends.append((two, three))
    (a, b), (c, d) = ends
    return [x - y for x, y in zip(product(a, d), product(c, b), strict=True)]


def product(a: list[Any], b: list[Any]) -> list[Any]:
    """Value and derivatives of a product, as `characteristic` has them."""
    (f, f_p, f_s, f_ps, f_ss), (g, g_p, g_s, g_ps, g_ss) = a, b
    mixed = f_ps * g + f_p * g_s + f_s * g_p + f * g_ps
    return [f * g, f_p * g + f * g_p, f_s * g + f * g_s, mixed, f_ss * g + 2 * f_s * g_s + f * g_ss]


def bench_plain_series(contender: Any) -> None:
    """Newton's method on F = ∂F/∂s = 0, the series as it stands, twice the digits each time; proves nothing."""

    def newton() -> Any:
        P, s = (mp.mpf(v) for v in (NEAR[0], NEAR[1] ** 2))
        for digits in (20, 35, 65, 65):
            with mp.workdps(digits):
                F, F_p, F_s, F_ps, F_ss = characteristic(P, s)
                det = F_p * F_ss - F_s * F_ps
                P, s = P - (F_ss * F - F_s * F_s) / det, s - (F_p * F_s - F_ps * F) / det
        return P

    def error(P: Any) -> str:
        load = beam_itself.flutter_undamped(beam.Beam(fb.column("free-free").kernel), NEAR, 60).load
        with balls.precision(300), mp.workdps(70):
            return f"off by {mp.nstr(abs(P / mp.mpf(load.mid().str(65, radius=False)) - 1), 1)}, nothing proven"

    contender(BEAM, "plain mpmath series with Newton, 50, undamped", newton, error=error)
