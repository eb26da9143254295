"""Lemmas 10, 11 and 13 of docs/theorem.md are the inequalities that are written there, on both sides of each."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb

from freebeam_derive.certify import damped_gaps
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.damped_gaps import DampedGaps, LeftOver
from freebeam_derive.certify.strips import NoStrips


def near(value: float) -> Any:
    return pytest.approx(value, rel=1e-9, abs=1e-30)


def drawn(seed: int) -> Any:
    return np.random.default_rng(seed)


def left_over(**changes: Any) -> Any:
    found: Any = object.__new__(LeftOver)
    found.forms, found.bare, found.turning = [None], {}, arb(0)
    for name, value in changes.items():
        setattr(found, name, value)
    return found


def test_what_damping_leaves_over_takes_is_that_of_lemma_11(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = drawn(13)
    with precision(128):
        for _ in range(4):
            low, high, one, other = np.sort(draw.uniform(-2, 3, 4))[[1, 2, 0, 3]]
            eta, blur = draw.uniform(0.05, 0.3, 2)
            of = left_over(low=arb(low), high=arb(high), at={"a": arb(one), "b": arb(other)})
            of.share = lambda omega, eta=eta: arb(eta)
            beam, most = max(abs(low), abs(high)), max(abs(one), abs(other))
            size = max(beam, most)
            assert float(of.size) == near(size)
            rho, own = math.sqrt(beam**2 + eta * most**2), beam + eta * most
            taken = (2 * rho * blur + (size + own) * blur**2) / (1 - blur**2)
            wanted = low + eta * min(0.0, one - low, other - low) - taken
            assert float(of.least(arb(1), arb(blur))) == near(wanted)


def test_what_bare_places_take_is_that_of_lemma_13(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(damped_gaps, "_reach", lambda forms, place, order, omega: omega * (3 + order + 7 * place))
    monkeypatch.setattr(damped_gaps, "motion", lambda parts, mode, at: mode * (2 + at[1]))
    of = left_over(bare={(1, 0): arb(-2), (0, 1): arb(5)}, _parts=None)
    r, blur, omega = 0.25, 0.125, 3.0
    N = (omega * 10) ** 2, (omega * 4) ** 2
    blurred = (2 + r) * blur / (1 - blur)
    with precision(128):
        found = of.taken(arb(omega), arb(blur), arb(r))
        assert float(found) == near((2 * N[0] * (1 + blurred) + 5 * N[1] * blurred) / omega)
        for mode in (7.0, 1000.0):  # its own motion is dω²/dk where that is less
            found = of.taken(arb(omega), arb(blur), arb(r), arb(mode))
            itself = min(N[0], mode * 2)
            assert float(found) == near((2 * (itself + N[0] * blurred) + 5 * N[1] * blurred) / omega)


def gaps(g: float, omega: float, C: float, R: float = 1.0) -> Any:
    return SimpleNamespace(
        size=arb(C), gap=lambda m: arb(g), frequency=lambda m: arb(omega), line=lambda m: arb(R),
        interval=lambda m: arb(0),
    )  # fmt: skip


def test_high_modes_stay_where_the_inequality_of_lemma_11_holds_and_no_further() -> None:
    """On both sides of the c_M at which it begins to hold, and of each of its two conditions."""
    draw = drawn(17)
    with precision(128):
        for n in range(40):
            g, omega = draw.uniform(1, 3), draw.uniform(2, 9)
            P, C, c_E, CR, delta, here = draw.uniform(0.01, 0.12, 6)
            here = (here - 0.05) * 40
            vanishing = n % 3 == 0
            X = P * C if vanishing else P * C + CR / c_E + delta * math.sqrt(1 + g / omega)
            if n % 5 == 1:  # near the end of what is allowed
                C *= 0.499 * g / X if X < g / 2 else 1
                X = P * C if vanishing else P * C + CR / c_E + delta * math.sqrt(1 + g / omega)
            top = omega + g
            r = g / top
            sigma = X * max((1 + r) / (g * (2 + r) - X), 1 / (g * (2 - r) - X))
            of = SimpleNamespace(
                c_E=arb(c_E), turning=arb(CR), size=arb(delta), c_M=arb(0), bare={},
                taken=lambda omega, blur, r, mode: arb("0.01") * blur * (1 + r),
                least=lambda omega, blur, here=here: arb(here) - blur,
            )  # fmt: skip
            them = gaps(g, omega, C)
            assert float(damped_gaps._load(them, of, 1, arb(P), vanishing)) == near(X)  # type: ignore[arg-type]
            held = lambda of=of, them=them, P=P, top=top, v=vanishing: damped_gaps._damped(  # noqa: E731
                them, of, 1, arb(top), arb(P), v
            )
            if not (2 * X < g and 2 * sigma**2 < 1):
                of.c_M = arb(10) ** 9
                assert not held()
                continue
            eps, k = sigma / math.sqrt(1 - sigma**2), 1 / (1 - 2 * sigma**2)
            h = c_E * (top - X - P * C * k) - CR * k - 0.01 * eps * (1 + r)
            edge = -(top * h + min(0.0, here - eps))
            of.c_M = arb(10) ** 9
            assert held() == (h > 0)
            if h > 0:
                for side in (-1, 1):
                    of.c_M = arb(edge + side * 1e-9 * (1 + abs(edge)))
                    assert held() == (side > 0)


def test_no_mode_passes_where_half_a_gap_is_not_wide_enough() -> None:
    """2 X < g, and σ below 1/√2: on both sides of either, with much damping of the mass."""
    with precision(128):
        of = SimpleNamespace(
            c_E=arb(1), turning=arb(0), size=arb(0), c_M=arb(10) ** 9, bare={},
            taken=lambda *a: arb(0), least=lambda *a: arb(0),
        )  # fmt: skip
        for C in (0.999999, 1.000001):
            assert damped_gaps._damped(gaps(2, 1, C), of, 1, arb(50), arb(1), True) == (C < 1)  # type: ignore[arg-type]
        g, omega = 2.0, 2.25
        r = g / omega
        # X (1/(g (2 − r) − X)) = 1/√2
        edge = g * (2 - r) / (1 + math.sqrt(2))
        assert 2 * edge < g and edge * (1 + r) / (g * (2 + r) - edge) < math.sqrt(0.5)
        for C in (edge - 1e-6, edge + 1e-6):
            of.c_M, of.c_E = arb(10) ** 30, arb(10) ** 12
            k = 1 / (1 - 2 * (C / (g * (2 - r) - C)) ** 2)
            found = damped_gaps._damped(gaps(g, 1, C), of, 1, arb(omega), arb(1), True)  # type: ignore[arg-type]
            assert found == (0 < k < (omega - C) / C)


def test_the_frequency_beyond_which_none_crosses() -> None:
    """Re s = R at Ω² = R/(1 − c_E c_M − c_E² R); without internal damping Ω = √R; and the first of a series with
    ratio 9/8 at which what Lemma 10 asks for fails."""
    with precision(128):
        for c_E, c_M, R in ((0.01, 0.3, 50.0), (0.02, 0.0, 400.0)):
            of = SimpleNamespace(c_E=arb(c_E), c_M=arb(c_M), turning=arb(10) ** 9, size=arb(0))
            found = DampedGaps(gaps(1, 1, 1, R), of, 1, arb(1), arb(1), False)  # type: ignore[arg-type]
            assert float(found.top) == near(math.sqrt(R / (1 - c_E * c_M - c_E**2 * R)))
            of.c_E = arb(0)
            assert float(found.top) == near(math.sqrt(R))
            limit = DampedGaps(gaps(1, 1, 1, R), of, 1, arb(1), arb(1), True)  # type: ignore[arg-type]
            assert float(limit.top) == near(R)
        P, C, CR, delta, c_E = 20.0, 3.0, 0.5, 2.0, 0.25
        of = SimpleNamespace(c_E=arb(c_E), c_M=arb(5), turning=arb(CR), size=arb(delta))
        found = DampedGaps(gaps(1, 1, C, 50.0), of, 1, arb(1), arb(P), False)  # type: ignore[arg-type]
        omega = 1 / (8 * c_E)

        def asked(omega: float) -> float:
            z = c_E * omega
            h = math.sqrt(1 + z * z)
            return (P * C / omega + CR) / math.sqrt(2 * (h - 1)) + delta * h / (z * omega)

        while asked(omega) >= 1:
            omega *= 9 / 8
        assert float(found.top) == near(omega)
        of.turning = arb(10) ** 9
        with pytest.raises(NoStrips, match="no frequency is known"):
            _ = found.top
