"""Eigenvalues and forced motion of the Ritz system in balls. Eqs. (10), (11), (22)-(25).

Eigenvalues are enclosed all at once (Arb's `eig`). The amplitude at a sensor under a force that oscillates is the
modulus of a quotient of two polynomials in the load, so that where it rises and where it falls is a question of the
sign of one polynomial.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from types import ModuleType

from flint import acb, acb_mat, arb, arb_mat, arb_poly

from freebeam_derive.certify.balls import Unproven, exact, matrices, precision, roots
from freebeam_derive.certify.bivariate import signs_on
from freebeam_derive.certify.boundary_polynomials import determinant

BITS = 256


def eigenvalues(kernel: ModuleType, modes: int, load: Fraction, alpha: Fraction, beta: Fraction) -> tuple[acb, ...]:
    """The 2N eigenvalues of A of Eq. (25), disjoint balls, each with one. Raises Unproven where they are too close."""
    with precision(BITS):
        M, E, H = matrices(kernel, modes)
        K, C = E + H * exact(load), M * exact(beta) + E * exact(alpha)
        lower_left, lower_right = -M.solve(K), -M.solve(C)
        rows = [[arb(0)] * modes + [arb(int(i == j)) for j in range(modes)] for i in range(modes)]
        rows += [
            [lower_left[i, j] for j in range(modes)] + [lower_right[i, j] for j in range(modes)] for i in range(modes)
        ]
        try:
            return tuple(acb_mat(rows).eig())
        except ValueError as error:
            raise Unproven("the eigenvalues could not be told apart") from error


def mode_values(kernel: ModuleType, modes: int, place: Fraction) -> list[arb]:
    """χ of Eq. (22) for the first modes at a place, from the printed formula, at the precision in hand."""
    quarter, _, delta = roots(kernel, modes)
    values = []
    for q, d in zip(quarter, delta, strict=True):
        g = int(q) * arb.pi() / 4 + d
        z = g * exact(place)
        ratio = (g.cos() - g.cosh()) / (g.sin() + g.sinh())
        values.append(z.sin() + z.sinh() + ratio * (z.cos() + z.cosh()))
    return values


@dataclass(frozen=True)
class Amplitude:
    """|ŷ(x_s)|² of the motion under a force sin ωt of amplitude 1 at x_F, as upper(P) / lower(P)."""

    upper: arb_poly
    lower: arb_poly

    def at(self, load: Fraction) -> arb:
        """The amplitude itself."""
        with precision(BITS):
            P = exact(load)
            return (self.upper(P) / self.lower(P)).sqrt()

    def slope_signs(self, start: Fraction, end: Fraction, width: Fraction) -> list[tuple[Fraction, Fraction, int]]:
        """Where the amplitude rises (+1) and falls (−1) with the load; 0 on pieces no longer than `width`."""
        with precision(BITS):
            slope = self.upper.derivative() * self.lower - self.upper * self.lower.derivative()
            return _signs(slope, start, end, width)


def _signs(
    polynomial: arb_poly, start: Fraction, end: Fraction, width: Fraction
) -> list[tuple[Fraction, Fraction, int]]:
    found: list[tuple[Fraction, Fraction, int]] = []
    waiting = [(start, end)]
    while waiting:
        a, b = waiting.pop()
        (sign,) = signs_on([polynomial], a, b)
        if not sign and b - a > width:
            middle = (a + b) / 2
            waiting += [(middle, b), (a, middle)]
        elif found and found[-1][2] == sign:
            found[-1] = (found[-1][0], b, sign)
        else:
            found.append((a, b, sign))
    return found


def amplitude(
    kernel: ModuleType,
    modes: int,
    alpha: Fraction,
    beta: Fraction,
    frequency: Fraction,
    x_F: Fraction,
    x_s: Fraction,
    transposed: bool = False,
) -> Amplitude:
    """The amplitude of the elastic motion as a function of the load. transposed: K of Eq. (11) as printed."""
    with precision(BITS):
        M, E, H = matrices(kernel, modes)
        if transposed:
            H = H.transpose()
        C = M * exact(beta) + E * exact(alpha)
        force, sensor = mode_values(kernel, modes, x_F), mode_values(kernel, modes, x_s)
        w = exact(frequency)
        still = [[acb(E[i, j] - w * w * M[i, j], w * C[i, j]) for j in range(modes)] for i in range(modes)]
        # by Cramer's rule: the system's determinant, bordered by force and sensor, over the determinant itself
        bordered = [[*row, acb(f)] for row, f in zip(still, force, strict=True)] + [[*map(acb, sensor), acb(0)]]
        loaded = [[*row, arb(0)] for row in H.tolist()] + [[arb(0)] * (modes + 1)]
        above = determinant([acb_mat(bordered), acb_mat(arb_mat(loaded))])
        return Amplitude(_squared(above), _squared(determinant([acb_mat(still), acb_mat(H)])))


def _squared(coefficients: list[acb]) -> arb_poly:
    """The square of the modulus of a polynomial in the load."""
    real, imaginary = arb_poly([c.real for c in coefficients]), arb_poly([c.imag for c in coefficients])
    return real * real + imaginary * imaginary
