"""Columns in more than three uniform parts: their frequencies without load, and how far apart the high ones are.

By the prover, by the verifier and by finite elements.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from copy import copy
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from flint import acb, arb, fmpq_poly
from scipy.linalg import eigh

import freebeam as fb
from freebeam_derive.certify import stepped_section, verifier_waves
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.stepped_section import SteppedSection, _cells_apart
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_sections import Sections
from freebeam_derive.certify.verifier_waves import Apart
from tests.reference.elements import hermite

BITS = 64
NEEDED = 10
Case = tuple[list[Fraction], Fraction]
CASES: dict[str, Case] = {
    "four steps": ([Fraction(8 - n, 8) for n in range(4)], Fraction(0)),
    "three masses": ([Fraction(1)] * 3, Fraction(1, 10)),
}
"""EI of each of so many parts of one length, with the mass 1; and a mass at the right end of each."""


@cache
def proven(name: str) -> SteppedSection:
    EI, mass = CASES[name]
    count = len(EI)
    step = fb.column("step")
    forms: Any = copy(ColumnForms(step.kernel, {"a": Fraction(1, 2), "r": Fraction(1, 2), "mu": Fraction(0)}))
    forms.breaks = tuple(Fraction(n, count) for n in range(count + 1))
    forms.m, forms.EI, forms.elastic = [[Fraction(1)]] * count, [[f] for f in EI], [{}] * count
    forms.masses = {(x, 0): mass for x in forms.breaks[1:] if mass}
    forms.__dict__.pop("least", None)
    return SteppedSection(forms)


@cache
def checked(name: str) -> Apart:
    EI, mass = CASES[name]
    count = len(EI)
    breaks = tuple(Fraction(n, count) for n in range(count + 1))
    factors = [fmpq_poly([f.numerator]) / f.denominator for f in EI]
    masses = {(n, 0): mass for n in range(1, count + 1) if mass}
    load = [{(1, 1): fmpq_poly([-1])}] * count
    return Apart(
        Sections(("clamped", "free"), breaks, factors, [fmpq_poly([1])] * count, [{}] * count, load, masses, {}, {})
    )


def by_elements(name: str, each: int = 16) -> Any:
    """Frequencies of cubic elements, so many on each part."""
    EI, mass = CASES[name]
    nodes, weights = np.polynomial.legendre.leggauss(4)
    count = each * len(EI)
    M, K = np.zeros((2, 2 * count + 2, 2 * count + 2))
    for n in range(count):
        at, h = slice(2 * n, 2 * n + 4), 1 / count
        for u, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
            y, _, curvature = hermite(u, h)
            M[at, at] += weight * h * np.outer(y, y)
            K[at, at] += weight * h * float(EI[n // each]) * np.outer(curvature, curvature)
        if (n + 1) % each == 0:
            M[2 * n + 2, 2 * n + 2] += float(mass)
    return eigh(K[2:, 2:], M[2:, 2:], eigvals_only=True) ** 0.5


@pytest.mark.parametrize("name", CASES)
def test_frequencies_are_those_of_finite_elements_and_high_ones_apart(name: str) -> None:
    with precision(BITS):
        them = proven(name)
        found = [float(g) ** 2 for g in them.lowest(arb(10))]
        assert np.allclose(found, by_elements(name)[: len(found)], rtol=1e-4) and len(found) > 2
        both = them.gap_beyond(lambda *_: arb(NEEDED)), checked(name).gap(lambda *_: arb(NEEDED))
        start = math.ceil(max(float(G) for G, _ in both))
        above = [
            float(g) ** 2 for n in range(14) for g in them._between(*(start + Fraction(k, 2) for k in (n, n + 1)), 0)
        ]
        assert len(above) > 1 and all(NEEDED < gap < np.diff(above).min() for _, gap in both)


@pytest.mark.parametrize("name", CASES)
def test_parts_have_one_phase_where_they_are_alike(name: str) -> None:
    alike = [0, 1, 2, 3] if name == "four steps" else [0] * len(CASES[name][0])
    with precision(BITS):
        assert proven(name).same == checked(name).same == alike


def test_parts_too_many_to_tell_apart_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with precision(BITS):
        steps, same = proven("four steps"), checked("four steps")
        monkeypatch.setattr(stepped_section, "MOST_WAVES", 100)
        monkeypatch.setattr(verifier_waves, "MOST_WAVES", 100)
        monkeypatch.setattr(stepped_section, "PARTS", 3)
        with pytest.raises(Unproven, match="too many, or too unlike"):
            steps.gap_beyond(lambda *_: arb(NEEDED))
        with pytest.raises(Refused, match="too many, or too unlike"):
            same.gap(lambda *_: arb(NEEDED))
        with pytest.raises(NoStrips, match="more than 3 parts"):
            proven.__wrapped__("four steps")


def test_as_many_waves_as_the_limit_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of whole cells: the least limit that serves is a multiple of the waves of one, and one less is refused."""
    with precision(BITS):
        of, them, G = checked("three masses"), proven("three masses"), arb(1000)
        apart = arb.pi() / (64 * of.whole)
        waves, rest = them._waves(arb(0).union(1 / G), G)
        for where, look, each in (
            (verifier_waves, lambda: of._cells_apart(arb(0).union(1 / G), G, apart), len(of.waves(arb(0)))),
            (stepped_section, lambda: _cells_apart(waves, rest, them.rates, apart, them.same), len(waves) // 2),
        ):

            def is_served(most: int, where: Any = where, look: Any = look) -> bool:
                monkeypatch.setattr(where, "MOST_WAVES", most)
                try:
                    return bool(look())
                except (Refused, Unproven):
                    return False

            least = bisect_left(range(4000), True, key=is_served)
            assert is_served(least) and not is_served(least - 1) and least % each == 0


@pytest.mark.parametrize("prover", [True, False])
def test_on_the_way_to_the_next_frequency_waves_are_looked_at_too(
    prover: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """ε = 1/γ from 0 to 1/G in cells without a gap, each down to 1/(γ + apart) for the largest γ in it."""
    asked: list[tuple[arb, arb]] = []
    G, apart = arb(20), arb(2)

    def look(e: arb, least: arb) -> bool:
        asked.append((e, least))
        return len(asked) > 3

    with precision(BITS):
        them = proven("three masses") if prover else checked("three masses")
        if prover:
            monkeypatch.setattr(them, "_waves", lambda e, at: (e, at))
            monkeypatch.setattr(stepped_section, "_cells_apart", lambda e, at, *_: look(e, at))
        else:
            monkeypatch.setattr(them, "_cells_apart", lambda e, at, *_: look(e, at))
        assert them._all_apart(G, apart)
        cells = sorted((pair[0] for pair in asked[3:]), key=lambda e: float(e.upper()))
        assert len(cells) > 2 and cells[0].contains(0) and cells[-1].contains(1 / G)
        for below, e in pairwise(cells):
            high = below.upper()
            assert e.contains(1 / (1 / high.mid() + apart)) and not e.contains(1 / (1 / high.mid() + 2 * apart))
        for e, least in asked:
            assert least <= 1 / e.upper() * arb("1.01") if not prover else least == G


def test_what_is_left_out_grows_as_a_joint_does() -> None:
    """Of three times the last joint three times as much, and of half of it half: f itself is linear in it."""
    with precision(BITS):
        of = checked("three masses")
        for factor in (arb(3), arb(1) / 2):
            other = copy(of)
            other.joints = [*of.joints[:-1], [[p * acb(factor) for p in row] for row in of.joints[-1]]]
            other.stages = [*of.stages[:-1], {wave: [v * acb(factor) for v in z] for wave, z in of.stages[-1].items()}]
            there, here = other.rest(arb(100), arb(0)), of.rest(arb(100), arb(0))
            assert there is not None and here is not None
            assert here > 0 and abs((there / here / factor - 1).mid()) < 1e-9
