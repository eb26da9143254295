"""All crossings of the beam itself: against long series, closed forms, cases that cannot be decided, broken steps."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb, arb_mat

import freebeam as fb
from freebeam.cli import main
from freebeam_derive.certify import beam_cells, beam_crossings, beam_itself
from freebeam_derive.certify.all_crossings import Crossing
from freebeam_derive.certify.balls import Unproven, exact, precision
from freebeam_derive.certify.beam import Beam
from freebeam_derive.certify.beam_cells import Cells, OpenStep
from freebeam_derive.certify.beam_crossings import Survey
from freebeam_derive.certify.beam_itself import Damped
from freebeam_derive.certify.static_touches import touches
from freebeam_sym.checks import InputError

F = Fraction
CASES: dict[str, dict[str, Any]] = {
    "lost, regained, lost": {"eta": F(2, 5), "load_max": F(30)},
    "damped": {"eta": F(2, 5), "alpha": F(1, 100), "beta": F(1, 2), "load_max": F(16)},
    "the limit of vanishing damping": {"eta": F(2, 5), "kappa": F(0), "load_max": F(16)},
}


def survey(
    name: str, load_max: Fraction, alpha: Any = 0, beta: Any = 0, kappa: Any = None, digits: int = 15, **own: Any
) -> list[Crossing]:
    return Survey(Beam(fb.column(name).kernel, own), F(alpha), F(beta), kappa, load_max, digits).run()


def unstable(load: float, alpha: float = 0, beta: float = 0, eta: float = 1) -> int:
    """Eigenvalues with a positive real part of a series of 16 polynomials, by numpy."""
    system = fb.column("beck", "legendre").system(modes=16, load=load, alpha=alpha, beta=beta, eta=eta)
    values = fb.spectrum(system).eigenvalues
    return int((values.real > (1e-6 if alpha == beta == 0 else 0) * np.abs(values)).sum())


@pytest.mark.parametrize("name", CASES)
def test_crossings_and_counts_are_those_of_a_long_series(name: str) -> None:
    given = dict(CASES[name])
    limit, load_max = "kappa" in given, given["load_max"]
    found = survey("beck", **given)
    assert len(found) >= 2
    del given["load_max"]
    damped = given | {"alpha": F(1, 10**7)} if limit else given
    damped.pop("kappa", None)
    places = [F(0), *(c.load[0] for c in found), load_max]
    for k, (low, high) in enumerate(pairwise(places)):
        expected = found[k].unstable if k < len(found) else found[-1].unstable + found[-1].change
        for share in (0.03, 0.5, 0.97):
            at = float(low) + share * float(high - low)
            assert unstable(at, **{n: float(v) for n, v in damped.items()}) == expected
    series = fb.certified_crossings(
        fb.column("beck", "legendre"), 12 if load_max < 100 else 16, load_max=load_max, digits=12, **given
    )
    assert [c.kind for c in series] == [c.kind for c in found]
    for ours, theirs in zip(found, series, strict=True):
        assert float(ours.load[0]) == pytest.approx(float(theirs.load[0]), rel=1e-9)


def test_euler_loads_are_all_there() -> None:
    found = survey("euler-pinned", F(40), digits=30)
    assert [(c.kind, c.unstable, c.change) for c in found] == [("divergence", 0, 1), ("divergence", 1, 1)]
    with mpmath.workdps(50):
        for n, c in enumerate(found, 1):
            low, high = (mpmath.mpf(v.numerator) / v.denominator for v in c.load)
            assert low < (n * mpmath.pi) ** 2 < high and high - low < mpmath.mpf(10) ** -28


@pytest.mark.parametrize("damping", [None, (0.01, 0), (0, 0.5), (0.01, 0.5)])
def test_an_eigenvalue_that_is_zero_at_a_buckling_load_grows_beyond_it(damping: tuple[float, float] | None) -> None:
    """Of a dead load on a cantilever, at (π/2)² and (3π/2)², whatever damps it."""
    search: Any = object.__new__(Survey)
    search.beam, search.digits, search.load_max, search.found = (
        Beam(fb.column("beck").kernel, {"eta": F(0)}),
        9,
        F(99),
        [],
    )
    given = None if damping is None else tuple(map(arb, damping))
    for n, load in ((1, F(5, 2)), (3, F(22))):
        sign = 1 if n == 1 else -1  # F(P, 0) is the cosine of √P
        low: Any = SimpleNamespace(sign=lambda a, *_, sign=sign: sign * (1 if a.sqrt().cos() > 0 else -1))
        search._divergence(low, load - 1, load + 1, -1, given)
        found = search.found[-1]
        assert found.change == 1 and not found.flutter
        assert float(found.box[0]) == pytest.approx((n * np.pi / 2) ** 2, rel=1e-9)


def test_a_stable_column_has_none() -> None:
    assert survey("beck", F(15)) == []


def test_the_touch_at_one_half_is_a_touch() -> None:
    """det K is c (1 + cos √P): it never passes zero."""
    found = survey("beck", F(12), eta=F(1, 2))
    assert [(c.kind, c.unstable, c.change, c.stability) for c in found] == [("touch", 0, 0, "touched")]
    low, high = found[0].load
    with precision(256):
        assert exact(low) < arb.pi() ** 2 < exact(high) and high - low < F(1, 10**14)
    assert unstable(9.8, eta=0.5) == unstable(9.95, eta=0.5) == 0


def test_a_touch_is_told_from_a_crossing() -> None:
    kernel = fb.column("beck").kernel
    assert touches(Beam(kernel, {"eta": F(1, 2)}), arb(100)) == [1, 3]
    for eta in (F(1, 2) - F(1, 10**30), F(1, 2) + F(1, 10**30), F(0), F(1)):
        assert touches(Beam(kernel, {"eta": eta}), arb(100)) is None
    assert touches(Beam(fb.column("euler-pinned").kernel), arb(100)) is None


def first() -> Any:
    beam = Beam(fb.column("beck").kernel, {"eta": F(1, 2)})
    crossing = beam_itself.flutter_undamped(beam, (16.0525, 7.0552), 12)
    return beam_crossings.complete(beam, crossing, F(0), F(0))


def test_beyond_a_touch_the_next_crossing_is_the_first_loss(monkeypatch: pytest.MonkeyPatch) -> None:
    found, evidence, missing, survey = first()
    assert found.proof.first and found.proof.stable_below and missing == "" and evidence.cells > 0
    *below, last = survey.crossings
    assert [c.kind for c in below] == ["touch"] and last.kind == "flutter" and exact(below[0].load[1]) < found.load
    # a touch that is taken for a crossing
    right = Survey._counted

    def crossed(self: Survey, damped: bool) -> list[Crossing]:
        return [replace(c, change=2) if c.kind == "touch" else c for c in right(self, damped)]

    monkeypatch.setattr(Survey, "_counted", crossed)
    found, evidence, missing, survey = first()
    assert not found.proof.first and evidence is None and missing.startswith("touches") and survey is None


# ------------------------------------------------------------ what cannot be decided, broken steps


def test_how_a_pair_leaves_a_touch_with_internal_damping_alone_is_not_known() -> None:
    """λ = 0 is a double eigenvalue there."""
    with pytest.raises(OpenStep, match=r"divergence: F\(P, 0\) vanishes at the load 9\.8696"):
        survey("beck", F(11), alpha=F(1, 100), eta=F(1, 2))


def test_a_crossing_that_cannot_be_told_from_the_end_is_listed() -> None:
    """One that is known to lie above the end is not. A certificate goes as far as the search did."""
    column = Beam(fb.column("euler-pinned").kernel)
    for digits, above, count in ((30, 0, 0), (30, 1, 1), (60, 0, 1)):
        with mpmath.workdps(80):
            load_max = F(int(mpmath.floor(mpmath.pi**2 * 10**digits)) + above, 10**digits)
        search = Survey(column, F(0), F(0), None, load_max, 15)
        found = search.run()
        assert [c.kind for c in found] == ["divergence"] * count
        assert all(c.load[0] <= load_max for c in found)
        assert all(c.load[1] < search.load_max for c in search.crossings) and search.crossings == found
        assert load_max <= search.load_max <= load_max * F(1_000_001, 1_000_000)


def test_a_crossing_that_is_not_looked_for_is_missed_by_no_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(self: Survey, problem: Any, place: list[arb]) -> list[arb]:
        raise Unproven("nothing is there")

    monkeypatch.setattr(Survey, "_seek", nothing)
    monkeypatch.setattr(beam_cells, "MOST_CUTS", 2)
    with pytest.raises(
        OpenStep, match=r"cells: that there is no other crossing is not known near the load (19|20)\.[0-9]* and ω² = 12"
    ):
        survey("beck", F(21))


def test_a_direction_that_is_wrong_is_noticed_in_the_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beam_crossings, "_change", lambda *given: -2)
    with pytest.raises(OpenStep, match="count: fewer than no eigenvalue"):
        survey("beck", F(21))


def test_a_divergence_that_is_not_seen_to_be_simple_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beam_crossings.Below, "rising", lambda *given: 0)
    with pytest.raises(OpenStep, match=r"divergence: F\(P, 0\) all but vanishes near the load 9.869"):
        survey("euler-pinned", F(12))


# ------------------------------------------------------------ asked for from outside


def test_in_si_units_loads_are_newtons() -> None:
    EI, m, L = 2, 3, 5
    (found,) = fb.exact_crossings(fb.column("euler-pinned"), load_max=1, beam=(EI, m, L))
    assert float(found.load[0]) == pytest.approx(np.pi**2 * EI / L**2, rel=1e-14)
    assert (found.unstable_below, found.unstable_above, found.stability) == (0, 1, "lost")


def test_columns_beyond_the_uniform_beam_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fb.proofs._Asked, "itself", property(lambda self: object()))
    with pytest.raises(InputError, match="goes beyond the uniform beam"):
        fb.exact_crossings(fb.column("euler-pinned"), load_max=2)


def test_from_the_command_line_the_list_needs_an_end(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["critical", "--column", "beck", "--exact", "--all", "--digits", "9"]
    assert main(words) == 2 and capsys.readouterr().err.count("\n") == 1
    assert main([*words, "--load-max", "4", "--set", "eta=0", "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["crossings"]
    assert found["load_lower"].startswith("2.46740110") and found["stability"] == "lost"
    assert main([*words, "--load-max", "2", "--set", "eta=0"]) == 0
    assert "no crossing, stable up to 2" in capsys.readouterr().out


class _LowZero(Damped):
    """Two equations in (P, ω), P = 1 and ω (ω − a) = 0, with the zero at ω = 0 that is looked at elsewhere."""

    def __init__(self, a: float) -> None:
        self.a = arb(a)

    def value(self, x: list[arb]) -> list[arb]:
        return [x[0] - 1, x[1] * (x[1] - self.a)]

    def slopes(self, x: list[arb]) -> tuple[list[arb], arb_mat, Any]:
        return self.value(x), arb_mat([[arb(1), arb(0)], [arb(0), 2 * x[1] - self.a]]), None


@pytest.mark.parametrize(("a", "excluded"), [(0.01, False), (5.0, True)])
def test_a_crossing_of_low_frequency_is_not_taken_for_the_zero_at_rest(a: float, excluded: bool) -> None:
    """A cell from ω = 0 on is left out where the imaginary part has no other zero, and there alone."""
    cells: Any = Cells(None, 0, arb(2), [])  # type: ignore[arg-type]
    found = cells._excluded(_LowZero(a), arb(0).union(arb(2)), arb(0).union(arb(1) / 10))
    assert (found is None) == excluded
