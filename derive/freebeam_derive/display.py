"""Functionals in jets as a reader knows them: integrals over runs of segments, and values at points."""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Add, Expr, Integral, Mul, S, factor

from freebeam_derive.jets import ALONG, Beam, Functional, jet, jets, segment_of, show
from freebeam_derive.notation import F_0, x


def display(functional: Functional, length: Expr = S.One, cuts: Sequence[Expr] = ()) -> Expr:
    """A functional in jets as the integrals and point values that a reader knows.

    A term that is the same on neighbouring segments is under one integral, which is taken segment by segment.
    """
    beam = Beam(length, tuple(cuts))
    found: dict[Expr, list[int]] = {}
    for term in Add.make_args(functional.density):
        (segment,) = {k for j in jets(term) if (k := segment_of(j.args[3])) is not None} or {0}
        along = {j: jet(*j.args[:3], ALONG) for j in jets(term) if j.args[3] == beam.along(segment)}
        found.setdefault(term.xreplace(along), []).append(segment)
    densities: dict[tuple[int, int], Expr] = {}
    for term, segments in found.items():
        for run in neighbours(sorted(segments)):
            densities[run] = densities.get(run, S.Zero) + term
    total = show(functional.points)
    for (first, last), density in sorted(densities.items()):
        if density != 0:
            total += Integral(show(gathered(density)), (x, beam.places[first], beam.places[last + 1]))
    return total


def gathered(expression: Expr) -> Expr:
    """A sum in jets with one factor before each product of them, where that depends on x, as a product if it is one:
    (1 − x) y″ and (1 − x/2)⁴ y″ δy″."""
    factors: dict[Expr, list[Expr]] = {}
    for term in Add.make_args(expression):
        constant, product = term.as_independent(jet, F_0)
        factors.setdefault(product, []).append(constant)
    terms = []
    for product, found in factors.items():
        whole = Add(*found)
        terms += [_oriented(factor(whole)) * product] if whole.has(x) else [constant * product for constant in found]
    return Add(*terms)


def _oriented(product: Expr) -> Expr:
    """A product whose sums are positive at x = 0 where that can be told: 1 − x and not −(x − 1)."""
    turned = S.One
    for part in Mul.make_args(product):
        base, power = part.as_base_exp()
        if base.is_Add and base.subs(x, 0).could_extract_minus_sign() and power.is_Integer:
            part = (-1) ** power * (-base) ** power
        turned *= part
    return turned


def neighbours(segments: Sequence[int]) -> list[tuple[int, int]]:
    """First and last of each run of neighbouring segments."""
    runs: list[tuple[int, int]] = []
    for segment in segments:
        if runs and runs[-1][1] == segment - 1:
            runs[-1] = (runs[-1][0], segment)
        else:
            runs.append((segment, segment))
    return runs
