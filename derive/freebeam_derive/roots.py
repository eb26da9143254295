"""Roots of the characteristic equation: isolated by a bracket, to any number of digits. Eq. (21)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import mpmath
from sympy import Expr, Symbol, lambdify

epsilon = Symbol("epsilon", positive=True)  # e^(-gamma)


@dataclass(frozen=True)
class Characteristic:
    """The characteristic equation p cos γ + q sin γ + r = 0 of a pair of ends. Eq. (21).

    p, q, r: functions of ε = e^(−γ). first: m of the first root's asymptote γ₀ = m π/4; the n-th has first + 4 (n − 1).
    """

    ends: tuple[str, str]
    p: Expr
    q: Expr
    r: Expr
    first: int


def characteristic(p: Expr, q: Expr, r: Expr) -> Callable[[mpmath.mpf], mpmath.mpf]:
    """p cos γ + q sin γ + r as an mpmath function of γ."""
    factors = lambdify(epsilon, (p, q, r), "mpmath")

    def function(g: mpmath.mpf) -> mpmath.mpf:
        a, b, c = factors(mpmath.exp(-g))
        return a * mpmath.cos(g) + b * mpmath.sin(g) + c

    return function


def first_root(p: Expr, q: Expr, r: Expr) -> float:
    """The first positive root, roughly: the first change of sign away from the root at γ = 0."""
    function = characteristic(p, q, r)
    step, g = 0.05, 0.2
    value = function(mpmath.mpf(g))
    while True:
        following = function(mpmath.mpf(g + step))
        if value * following <= 0:
            return g + step / 2
        g, value = g + step, following


def root(beam: Characteristic, index: int, digits: int = 50) -> mpmath.mpf:
    """The index-th positive root γ (from 1) of a comparison beam, to `digits` decimal digits. Eq. (21).

    The bracket is a quarter period to each side of the asymptote, where the sign must change.

    Raises ValueError for an index below 1.
    """
    if index < 1:
        raise ValueError(f"index = {index}: roots are counted from 1")
    with mpmath.workdps(digits + 15):
        function = characteristic(beam.p, beam.q, beam.r)
        asymptote = (beam.first + 4 * (index - 1)) * mpmath.pi / 4
        low, high = asymptote - mpmath.pi / 4, asymptote + mpmath.pi / 4
        if function(low) * function(high) >= 0:
            raise AssertionError(f"no change of sign around root {index} of {beam.ends}")
        found = mpmath.findroot(function, (low, high), solver="anderson", tol=mpmath.mpf(10) ** (-2 * digits - 20))
        # the bracket is closed to the digits asked for: the sign changes across it
        width = found * mpmath.mpf(10) ** (-digits - 5)
        if function(found - width) * function(found + width) > 0:
            raise AssertionError(f"root {index} of {beam.ends} is not isolated to {digits} digits")
        return +found
