"""Checks of what the paper says of critical loads: sections 4.1 to 4.4, and where the others repeat it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from freebeam.ledger import proven
from freebeam.ledger.finding import FLOATS, MAP, PROVEN, RANGE, Finding, Interval, check, enclosure, number
from freebeam.ledger.proven import cells, eigenvalues, exact, interval, line, ritz
from freebeam.ledger.scanned import MODES, PRINTED, scanned, step_of
from freebeam.maps.known import critical_load
from freebeam_sym.columns import column

__all__ = ["map_of_loads", "truncations"]

CLOSE = Fraction(1, 100)  # "very closely comparable": within one per cent
NEGLIGIBLE = Fraction(1, 100)  # of the change it is compared with
SIGNIFICANT = Fraction(1, 10)


def _scan_rule(step: str) -> str:
    return f"the first step of {step} at or above the load"


def _prints(load: Interval, printed: str) -> bool:
    """Whether a scan prints these digits, wherever the load lies between its bounds."""
    return {scanned(end, step_of(printed)) for end in load} == {printed}


@check
def scan(printed: str, alpha: str = "0", beta: str = "0") -> Finding:
    """A printed critical load: the first step of a scan at or above the proven value."""
    found, beam = ritz(alpha, beta), exact(alpha, beta)
    load, whole = interval(found.load), interval(beam.load)
    return Finding(
        _prints(load, printed) and found.kind == "flutter" and all(found.proof.values()),
        f"N = {MODES}: {enclosure(load)}, {found.kind}, first, stable below; the beam itself: {enclosure(whole)}, "
        f"truncation {number(float(load[0] - whole[0]), 3)}",
        PROVEN,
        _scan_rule(step_of(printed)),
    )


@check
def scans(first: str, second: str, alpha: str) -> Finding:
    """Two printed loads and the fall from one to the other: without damping, and at a small internal damping."""
    one, two, limit = ritz(), ritz(alpha), ritz(kappa="0")
    loads = interval(one.load), interval(two.load)
    good = _prints(loads[0], first) and _prints(loads[1], second)
    drop = 1 - loads[1][0] / loads[0][0]
    return Finding(
        good and drop > SIGNIFICANT,
        f"{enclosure(loads[0])} and at α = {alpha} {enclosure(loads[1])}, {number(100 * float(drop), 4)} % less; limit "
        f"α → 0⁺ {enclosure(interval(limit.load))}, where the tangent of s(P) goes through the origin",
        PROVEN,
        f"{_scan_rule(step_of(first))}, and of {step_of(second)}",
    )


@check
def near_beal(value: str) -> Finding:
    """How far Beal's load is from ours."""
    load, beam = interval(ritz().load), interval(exact().load)
    gaps = [Fraction(value) / known[0] - 1 for known in (load, beam)]
    return Finding(
        max(map(abs, gaps)) < CLOSE,
        f"{value} lies {number(100 * float(gaps[0]), 3)} % above {enclosure(load)} and "
        f"{number(100 * float(gaps[1]), 3)} % above the beam itself, {enclosure(beam)}",
        PROVEN,
    )


@lru_cache(maxsize=1)
def truncations() -> dict[str, dict[int, float]]:
    """First loss of stability by N, in both bases."""
    found: dict[str, dict[int, float]] = {}
    for basis in ("modes", "legendre"):
        found[basis] = {}
        for modes in range(1, 17):
            load = critical_load(column("free-free", basis), modes).load
            if load is not None:
                found[basis][modes] = load
    return found


def _explains(load: float, value: str) -> list[str]:
    """The rules that map a load to printed digits."""
    step = step_of(value)
    rules = {
        "rounded": f"{load:.{len(step) - 2}f}",
        f"scanned in steps of {step}": scanned(load, step),
        "cut off": f"{float(math.floor(Fraction(load) / Fraction(step)) * Fraction(step)):.{len(step) - 2}f}",
    }
    return [rule for rule, printed in rules.items() if printed == value]


@check
def beal(value: str) -> Finding:
    """Which truncation gives Beal's digits, and by which rule."""
    explained = []
    for basis, loads in truncations().items():
        for modes, load in loads.items():
            rules = _explains(load, value)
            if rules:
                explained.append(f"{basis} N = {modes}: {number(load, 9)} ({', '.join(rules)})")
    by_both = [text for text in explained if "rounded" in text and "scanned" in text]
    return Finding(
        len(by_both) == 1,
        "; ".join(explained)
        + f"; none of the others up to N = 16, and not the beam itself, {enclosure(interval(exact().load))}",
        FLOATS,
        "rounded, or the first step of 0.1: both at five bending modes, and only there",
    )


@check
def modes_used(count: int) -> Finding:
    """Which numbers of modes give all the printed digits."""
    good = []
    for modes in range(2, 17):
        loads = [critical_load(column("free-free"), modes, row.alpha, row.beta).load for row in PRINTED]
        if all(
            load is not None and scanned(load, step_of(row.printed)) == row.printed
            for load, row in zip(loads, PRINTED, strict=True)
        ):
            good.append(modes)
    printed = ", ".join(row.printed for row in PRINTED)
    return Finding(
        good == [count],
        f"of N = 2 to 16 these give {printed} by the scan's rule: {', '.join(map(str, good))}",
        FLOATS,
        "the first step at or above the load",
    )


# --- without damping ----------------------------------------------------------------------------------------


@check
def coalescence(printed: str, below: str) -> Finding:
    """The two lowest frequencies meet: a double root, proven; and they are the lowest two just below."""
    found = ritz()
    frequency = interval(found.frequency)
    pairs = [imaginary for _, imaginary in eigenvalues(below) if imaginary[0] > 0]
    first, second, third = pairs[:3]
    between = first[1] < frequency[0] and frequency[1] < second[0] and second[1] < third[0]
    return Finding(
        found.kind == "flutter" and all(found.proof.values()) and between and _prints(interval(found.load), printed),
        f"at P = {below} ω₁ = {enclosure(first, 7)}, ω₂ = {enclosure(second, 7)}, ω₃ = {enclosure(third, 7)}; they "
        f"meet at P = {enclosure(interval(found.load))}, ω = {enclosure(frequency)}",
        PROVEN,
        _scan_rule(step_of(printed)),
    )


@check
def equal_real_parts(load: str) -> Finding:
    """Whether the real parts of the two that met are equal; they are opposite."""
    real = [part for part, imaginary in eigenvalues(load) if imaginary[0] > 0][:2]
    low, high = sorted(real, key=lambda part: float(part[0]))
    return Finding(
        low[1] >= high[0],
        f"at P = {load} the two real parts are {enclosure(low, 8)} and {enclosure(high, 8)}: opposite, for without "
        "damping −λ is an eigenvalue with λ",
        PROVEN,
    )


@check
def grows(load: str, alpha: str = "0", beta: str = "0") -> Finding:
    """Above the critical load an eigenvalue that oscillates has a positive real part."""
    real, imaginary = max(eigenvalues(load, alpha, beta), key=lambda pair: float(pair[0][1]))
    return Finding(
        real[0] > 0 and not imaginary[0] <= 0 <= imaginary[1],
        f"at P = {load} Re λ = {enclosure(real, 8)}, |Im λ| = {enclosure(_absolute(imaginary), 8)}",
        PROVEN,
    )


def _absolute(bounds: Interval) -> Interval:
    low, high = sorted(map(abs, bounds))
    return low, high


@check
def moves_right(loads: Sequence[str], alpha: str = "0", beta: str = "0", printed: str = "") -> Finding:
    """The largest real part at growing loads: not positive up to the critical one, and growing after it."""
    rates = [max(real for real, _ in eigenvalues(load, alpha, beta)) for load in loads]
    critical = interval(ritz(alpha, beta).load)
    good = True
    for load, rate in zip(loads, rates, strict=True):
        good &= rate[0] > 0 if Fraction(load) > critical[1] else rate[0] <= 0
    past = [rate for load, rate in zip(loads, rates, strict=True) if Fraction(load) > critical[1]]
    good &= all(a[1] < b[0] for a, b in pairwise(past))
    rule = ""
    if printed:
        good &= _prints(critical, printed)
        rule = _scan_rule(step_of(printed))
    listed = ", ".join(
        f"{load}: {'0' if rate[0] <= 0 <= rate[1] else enclosure(rate, 6)}"
        for load, rate in zip(loads, rates, strict=True)
    )
    return Finding(good, f"largest Re λ by load: {listed}; critical {enclosure(critical)}", PROVEN, rule)


# --- over ranges of damping ---------------------------------------------------------------------------------


def _ends_of_range(name: str, which: str, low: str, high: str, held: str = "0") -> tuple[Interval, Interval]:
    keys = ("alpha", "beta") if which == "internal" else ("beta", "alpha")
    found = [ritz(name=name, **{keys[0]: damping, keys[1]: held}) for damping in (low, high)]
    assert all(all(one.proof.values()) for one in found)
    return interval(found[0].load), interval(found[1].load)


_LETTER = {"internal": "α", "external": "β"}


@check
def constant(which: str, low: str, high: str, printed: str, name: str = "free-free") -> Finding:
    """For every damping of a range the scan prints the same: stable up to the step before, unstable there."""
    step = step_of(printed)
    before = Fraction(printed) - Fraction(step)
    range_ = line(name, which)
    pieces = (
        range_.stable(Fraction(low), Fraction(high), before),
        range_.unstable(Fraction(low), Fraction(high), Fraction(printed)),
    )
    first, last = _ends_of_range(name, which, low, high)
    return Finding(
        True,  # `stable` and `unstable` raise where they are not proven
        f"for every {_LETTER[which]} from {low} to {high} stable up to {_decimal(before, step)} and unstable at "
        f"{printed} (proven on {pieces[0]} and {pieces[1]} cells); the load itself goes from {enclosure(first)} to "
        f"{enclosure(last)}",
        RANGE,
        _scan_rule(step),
    )


def _decimal(value: Fraction, step: str) -> str:
    return f"{float(value):.{len(step) - 2}f}"


@check
def rises(
    which: str,
    low: str,
    high: str,
    held: str = "0",
    name: str = "free-free",
    above_undamped: bool = False,
    none_before: str = "",
) -> Finding:
    """The crossing rises with a damping all over a range: the sign of its slope on cells that cover it.

    none_before: the share of the load below the crossing in which another one may go unnoticed, for a proof that there
    is none in the rest.
    """
    found = cells(name, which, held, low, high, 24)
    first, last = _ends_of_range(name, which, low, high, held)
    letter = _LETTER[which]
    good = all(cell.rises == 1 and cell.square[0] > 0 for cell in found)
    text = f"from {enclosure(first)} at {letter} = {low} to {enclosure(last)} at {high}, dP/d{letter} > 0"
    if above_undamped:
        good &= min(cell.load[0] for cell in found) > interval(ritz(name=name).load)[1]
        text += f"; without damping {enclosure(interval(ritz(name=name).load))}"
    if held != "0":
        text = f"{'β' if which == 'internal' else 'α'} = {held}: {text}"
    proof = f"proven on {len(found)} cells; first, at both ends"
    if none_before:
        share = proven.none_before(name, which, held, low, high, 24, none_before)
        proof += f", and between them stable up to {number(100 * float(share), 2)} % below it"
    return Finding(good, f"{text} ({proof})", RANGE)


def _runs(name: str, which: str, held: str, low: str, high: str) -> list[tuple[Fraction, Fraction, int]]:
    """Stretches of one sign of the slope."""
    found: list[tuple[Fraction, Fraction, int]] = []
    for cell in cells(name, which, held, low, high, 40):
        if found and found[-1][2] == cell.rises:
            found[-1] = (found[-1][0], cell.high, cell.rises)
        else:
            found.append((cell.low, cell.high, cell.rises))
    return found


@check
def falls_then_rises(low: str, high: str, held: str, name: str = "free-free") -> Finding:
    """At a given β the load falls with α and then rises; where the turn lies."""
    runs = _runs(name, "internal", held, low, high)
    first, last = _ends_of_range(name, "internal", low, high, held)
    turn = runs[1][:2] if len(runs) == 3 else (Fraction(0), Fraction(0))
    lowest = min(cell.load[0] for cell in cells(name, "internal", held, low, high, 40))
    highest = min(cell.load[1] for cell in cells(name, "internal", held, low, high, 40))
    narrow = turn[1] > 0 and turn[1] - turn[0] < turn[0] / 1000
    return Finding(
        [sign for *_, sign in runs] == [-1, 0, 1] and narrow,
        f"β = {held}: from {enclosure(first)} at α = {low} it falls to {enclosure((lowest, highest), 6)} at α between "
        f"{number(float(turn[0]), 4)} and {number(float(turn[1]), 4)}, then rises to {enclosure(last)} at {high}; "
        f"the sign of dP/dα is proven on all but that piece",
        RANGE,
    )


@lru_cache(maxsize=1)
def map_of_loads() -> tuple[Any, Any, Any]:
    """Critical loads over the ranges of Figs. 4 and 5: α (rows), β (columns), floats."""
    beam = column("free-free")
    alphas, betas = np.geomspace(1e-6, 1e-1, 36), np.geomspace(1e-2, 1, 13)
    loads = np.array([[critical_load(beam, MODES, a, b).load for b in betas] for a in alphas], dtype=float)
    return alphas, betas, loads


@check
def map_rises_with_beta() -> Finding:
    """At every α of a map the load rises with β; proven along lines."""
    *_, loads = map_of_loads()
    lines = [rises("external", "0.01", "1", alpha) for alpha in ("0.00001", "0.001", "0.1")]
    steps = np.diff(loads, axis=1)
    return Finding(
        bool((steps > 0).all()) and all(one.holds for one in lines),
        f"on a map of {loads.shape[0]} × {loads.shape[1]} points, α from 1e-6 to 0.1, β from 0.01 to 1, every step "
        "in β "
        f"raises the load; proven along three lines: " + "; ".join(one.computed for one in lines),
        MAP,
    )


@check
def map_falls_then_rises() -> Finding:
    """At every β of a map the load falls with α and then rises; proven along a line."""
    alphas, _, loads = map_of_loads()
    lowest = loads.argmin(axis=0)
    good = all(
        0 < k < len(alphas) - 1 and (np.diff(column_[: k + 1]) < 0).all() and (np.diff(column_[k:]) > 0).all()
        for k, column_ in zip(lowest, loads.T, strict=True)
    )
    one = falls_then_rises("0.000001", "0.1", "0.1")
    return Finding(
        bool(good) and one.holds,
        f"on a map of {loads.shape[0]} × {loads.shape[1]} points each β from 0.01 to 1 has one least load, at α from "
        f"{number(alphas[lowest[0]], 2)} to {number(alphas[lowest[-1]], 2)}, falling before and rising after; proven "
        f"for {one.computed}",
        MAP,
    )


@check
def different_forms() -> Finding:
    """α alone raises the load, β alone raises it, α with β first lowers it."""
    signs = {
        "α alone": [sign for *_, sign in _runs("free-free", "internal", "0", "0.001", "0.1")],
        "α with β = 0.1": [sign for *_, sign in _runs("free-free", "internal", "0.1", "0.000001", "0.1")],
        "β alone": sorted({cell.rises for cell in cells("free-free", "external", "0", "0.01", "1", 24)}),
    }
    arrow = {1: "rises", -1: "falls", 0: "turns"}
    return Finding(
        signs["α alone"] == [1] and signs["β alone"] == [1] and signs["α with β = 0.1"] == [-1, 0, 1],
        "; ".join(f"{name}: {', '.join(arrow[s] for s in found)}" for name, found in signs.items()),
        RANGE,
    )


@check
def negligible(low: str, high: str) -> Finding:
    """The change by external damping against that by internal damping."""
    undamped = interval(ritz().load)
    outer = interval(ritz(beta=high).load)[1] - undamped[0]
    inner = undamped[0] - interval(ritz(alpha="0.000001").load)[1]
    risen = interval(ritz(alpha="0.1").load)[0] - interval(ritz(alpha="0.001").load)[1]
    return Finding(
        outer < NEGLIGIBLE * min(inner, risen),
        f"β up to {high} changes the load by {number(float(outer), 4)}; α = 1e-6 by −{number(float(inner), 4)}, and "
        f"from α = {low} to 0.1 by {number(float(risen), 4)}",
        PROVEN,
    )


@check
def range_sign(low: str, high: str) -> Finding:
    """Whether a range as printed holds any number: 10^-1 < β ≥ 10^0 is β ≥ 1."""
    middle = (Fraction(low) + Fraction(high)) / 2
    meant = Fraction(low) < middle and middle >= Fraction(high)  # as printed; a value between must be in the range
    found = rises("external", low, high)
    return Finding(
        meant,
        f"β ≥ {high} is what the signs say; {low} < β ≤ {high} is meant, as section 5 has it, and there "
        f"{found.computed}",
        found.by,
    )


@check
def digits_change(which: str, low: str, high: str, printed: str) -> Finding:
    """From which damping on the printed digits themselves change; the load rises all along."""
    found = rises(which, low, high, none_before="0.03")
    a, b = Fraction(low), Fraction(high)
    while b - a > Fraction(1, 10000):
        middle = (a + b) / 2
        load = critical_load(column("free-free"), MODES, beta=float(middle)).load
        assert load is not None
        if scanned(load, step_of(printed)) == printed:
            a = middle
        else:
            b = middle
    return Finding(
        found.holds, f"{found.computed}; the digits {printed} change from β = {number(float(b), 3)} on", found.by
    )


@check
def significant(alpha: str) -> Finding:
    """How much damping changes the critical load."""
    load, damped = interval(ritz().load), interval(ritz(alpha).load)
    share = 1 - damped[1] / load[0]
    return Finding(
        share > SIGNIFICANT,
        f"α = {alpha} lowers it from {enclosure(load)} to {enclosure(damped)}, by {number(100 * float(share), 4)} %",
        PROVEN,
    )


@check
def flutter_everywhere(which: str) -> Finding:
    """Every critical load of a range is flutter: the crossing has a frequency, on cells that cover the range."""
    if which == "both":
        alphas, betas, _ = map_of_loads()
        beam = column("free-free")
        kinds = {critical_load(beam, MODES, float(a), float(b)).kind for a in alphas[::4] for b in betas[::3]}
        squares = [cell.square[0] for cell in cells("free-free", "internal", "0.1", "0.000001", "0.1", 40)]
        return Finding(
            kinds == {"flutter"} and min(squares) > 0,
            f"{', '.join(sorted(kinds))} at all of {len(alphas[::4]) * len(betas[::3])} points of a map; proven for "
            f"β = 0.1 and α from 1e-6 to 0.1, where ω ≥ {number(math.sqrt(float(min(squares))), 4)}",
            MAP,
        )
    low, high = ("0.001", "0.1") if which == "internal" else ("0.01", "1")
    squares = [cell.square[0] for cell in cells("free-free", which, "0", low, high, 24)]
    ends = [ritz("0.000001"), ritz("0.001")] if which == "internal" else [ritz()]
    return Finding(
        min(squares) > 0 and all(one.kind == "flutter" for one in ends),
        f"ω ≥ {number(math.sqrt(float(min(squares))), 4)} at the crossing for {_LETTER[which]} from {low} to {high}"
        + (", and flutter at α = 1e-6 and 0.001" if which == "internal" else ", and flutter without damping"),
        RANGE,
    )


@check
def cantilever(which: str) -> Finding:
    """The same claims for the cantilever under a follower force, Beck's column."""
    undamped = interval(ritz(name="beck").load)
    if which == "internal":
        small = interval(ritz("0.000001", name="beck").load)
        same = constant("internal", "0.000001", "0.001", scanned(small[1], "0.1"), "beck")
        more = rises("internal", "0.001", "0.1", name="beck")
        return Finding(
            same.holds and more.holds and small[1] < (1 - SIGNIFICANT) * undamped[0],
            f"Beck's column: {enclosure(undamped)} without damping; {same.computed}; {more.computed}",
            RANGE,
        )
    more = rises("external", "0.01", "1", name="beck", above_undamped=True)
    return Finding(more.holds, f"Beck's column: {more.computed}", RANGE)
