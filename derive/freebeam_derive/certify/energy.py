"""Gyroscopic columns whose energy is kept, such as a pipe held at both ends, are stable while K is positive.

With M and K symmetric and C skew an eigenvalue has λ² (v, M v) + λ (v, C v) + (v, K v) = 0, where (v, C v) is
imaginary: λ = iω with m ω² + c ω − k = 0 of real m, c and k. Where M and K are positive ω is real; and since the energy
is kept, no motion grows, not even as a power of time (Thomson and Tait; Chetayev, The Stability of Motion, 1961). K is
positive without load where its energy is a sum of squares and λ = 0 is no eigenvalue, and stays so under loads up to
which 0 is none: the load acts on lower derivatives than V has, so that the lowest eigenvalue of K goes with it.

That C is skew is seen by parts: ∫ f u′v = [f uv] − ∫ f uv′ − ∫ f′uv, until v has as many derivatives as u, or one more.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import arb

from freebeam_derive.certify.balls import Exact, Unproven, formal
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.formal import Formal

NARROWEST = 2.0**-14
"""Of the loads up to which 0 is no eigenvalue: how narrow an interval of them may be."""
Trace = tuple[str, int, Any, int]
Factors = list[Formal]


def kept(kernel: Any, own: Mapping[str, Fraction], dampings: Sequence[Exact | int]) -> bool:
    """Whether M is constant and positive, C skew, and K symmetric, without load a sum of squares beside which the load
    is small. By the forms, whose factors are to be polynomials in x."""
    try:
        given = {name: formal(value) for name, value in own.items()}
        forms = kernel.forms(Formal(1), *map(formal, dampings), **given)
        (M, *more), (still, *loads), breaks = forms["M"], forms["K"], forms["breaks"]
        joined = {name: of for name, (of, _, _) in kernel.FIELDS.items()}
        highest = joined | dict.fromkeys(kernel.COORDINATES, 1)
        every = [(form, -1) for form in (still, *loads)] + [(form, 1) for form in forms["C"]]
        small = (p < highest[u] or q < highest[v] for along, _ in loads for _, u, p, v, q, _ in along)
        known = (of[1] < highest[of[0]] for (_, points), _ in every for *both, _ in points for of in both)
        return (
            not any(along or points for along, points in more)
            and all(small)
            and all(known)
            and _squares(M, len(breaks) - 1, dict.fromkeys(joined, 0), kernel.COORDINATES)
            and _squares(still, len(breaks) - 1, joined, ())
            and all(_cancels(kernel, breaks, form, side) for form, side in every)
        )
    except (AttributeError, TypeError, ValueError):
        return False


def _squares(form: Any, segments: int, orders: Mapping[str, int], coordinates: Sequence[str]) -> bool:
    """Whether it is a sum of squares with positive factors, one of them of each coordinate, and in each segment of each
    field's derivative of an order."""
    along, points = form
    positive = all((u, p) == (v, q) and all(f >= 0 for f in factors) for _, u, p, v, q, factors in along)
    positive &= all(one == other and factor >= 0 for one, other, factor in points)
    held = {(u, k) for of, u, p, _, _, factors in along if p == orders.get(u) and factors[0] > 0 for k in of}
    alone = {one[0] for one, _, factor in points if factor > 0}
    return positive and held >= {(u, k) for u in orders for k in range(segments)} and alone >= set(coordinates)


def _cancels(kernel: Any, breaks: Sequence[Any], form: Any, side: int) -> bool:
    """Whether a form of (u, v) plus side times that of (v, u) is nothing for all functions that meet the supports."""
    inside: dict[tuple[int, str, int, str, int], Factors] = {}
    ends: defaultdict[tuple[Trace, Trace], Formal] = defaultdict(lambda: Formal(0))
    along, points = form

    def end(k: int, at: int, u: str, p: int, v: str, q: int, factor: Formal) -> None:
        """Of a segment, the left or the right one."""
        one, two = (_trace(kernel, breaks, (name, order, k + at, 1 - 2 * at)) for name, order in ((u, p), (v, q)))
        if one and two:
            ends[one, two] += factor

    def add(k: int, u: str, p: int, v: str, q: int, f: Factors) -> None:
        if p > q or q > p + 1:
            x = [breaks[k], breaks[k + 1]]
            more, less = (p - 1, q) if p > q else (p, q - 1)
            for at in (0, 1):
                value = sum((c * x[at] ** n for n, c in enumerate(f)), Formal(0))
                end(k, at, u, more, v, less, value if at else -value)
            slope = [-(n * c) for n, c in enumerate(f)][1:]
            add(k, u, more, v, less, slope or [Formal(0)])
            add(k, u, *((more, v, q + 1) if p > q else (p + 1, v, less)), [-c for c in f])
            return
        old = inside.get((k, u, p, v, q), [])
        size = max(len(old), len(f))
        both = (of + [Formal(0)] * (size - len(of)) for of in (old, f))
        inside[k, u, p, v, q] = [a + b for a, b in zip(*both, strict=True)]

    for segments, u, p, v, q, factors in along:
        f = [Formal(0) + factor for factor in factors]
        for k in segments:
            add(k, u, p, v, q, f)
            add(k, v, q, u, p, [side * c for c in f])
    for first, other, factor in points:
        one, two = (_trace(kernel, breaks, _numbered(breaks, value)) for value in (first, other))
        if one and two:
            ends[one, two] += Formal(0) + factor
            ends[two, one] += side * (Formal(0) + factor)
    return all(c == 0 for f in inside.values() for c in f) and all(c == 0 for c in ends.values())


def _numbered(breaks: Sequence[Any], value: Trace) -> Trace:
    """A value with the number of its break for its place."""
    name, order, place, side = value
    if place is None:
        return value
    return name, order, next(n for n, of in enumerate(breaks) if Formal(0) + of == place), side


def _trace(kernel: Any, breaks: Sequence[Any], value: Trace) -> Trace | None:
    """The same value on either side of a break where the field joins; None where it is held."""
    name, order, n, side = value
    if n is None:
        return value
    joined, held, opened = kernel.FIELDS[name]
    last = len(breaks) - 1
    if n in (0, last):
        return None if (int(n == last), order) in held else (name, order, n, 0)
    return (name, order, n, 0) if order < joined and (n, order) not in opened else (name, order, n, side)


def positive_below(system: ExactSystem, load: arb) -> None:
    """λ = 0 is no eigenvalue below a divergence in a ball. Raises Unproven."""
    end = load.upper()
    waiting = [(arb(0), end)]
    while waiting:
        a, b = waiting.pop()
        middle, whole = ((a + b) / 2).mid(), a.union(b)
        slope = system.taylor(whole, arb(0), ((1, 0),))[1, 0]
        value = system.taylor(middle, arb(0), ((0, 0),))[0, 0] + slope * (whole - middle)
        if not value.contains(0) or (b == end and not slope.contains(0)):
            continue
        if b - a < end * NARROWEST:
            raise Unproven(f"F(P, 0) is not known to differ from zero at the load {float(a):.10g}")
        waiting += [(middle, b), (a, middle)]
