"""The critical load of the beam itself over a range: what is proven holds at every value; a wrong range proves none."""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest
from flint import acb, arb, arb_mat
from scipy.linalg import eigh

import freebeam as fb
import freebeam_kernels.beck as beck
from freebeam import exact_ranges
from freebeam.cli import main
from freebeam_derive.certify import frequency_gaps
from freebeam_derive.certify.balls import Range, Unproven, precision
from freebeam_derive.certify.beam import Beam, Jets, NoSeries
from freebeam_derive.certify.beam_cells import OpenStep
from freebeam_derive.certify.beam_itself import Damped
from freebeam_derive.certify.beam_ranges import Over, _Family, crossing, piece
from freebeam_derive.certify.beam_ranges import over as beam_over
from freebeam_derive.certify.beam_stability import damping_factors
from freebeam_derive.certify.column_forms import ColumnForms, over_both
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.frequency_gaps import FrequencyGaps
from freebeam_derive.certify.local_series import Local
from freebeam_derive.certify.parameter_series import DEGREE, OverEquation, Series
from freebeam_derive.certify.strips import NoStrips, Strips
from freebeam_derive.certify.system_ranges import OverSystem
from freebeam_derive.certify.uniform import NotUniform, _form, uniform
from freebeam_sym.checks import InputError

F = Fraction
CASES: dict[str, tuple[str, str, str, str, dict[str, Any]]] = {
    "flutter": ("beck", "eta", "0.6", "0.605", {}),
    "divergence": ("beck", "eta", "0.3", "0.32", {}),
    "divergence, damped": ("beck", "eta", "0.3", "0.301", {"beta": "0.5"}),
    "external damping": ("beck", "beta", "0.5", "0.52", {"alpha": "0.01"}),
    "internal damping": ("beck", "alpha", "0.01", "0.0101", {"beta": "0.5"}),
    "flutter, a rotary inertia": ("pflueger", "J", "0.1", "0.102", {}),
    "flutter, a dead load": ("beck-dead-load", "w", "1", "1.1", {}),
    "vanishing damping": ("beck", "kappa", "0", "0.5", {"kappa": 0}),
}


@pytest.mark.parametrize("name", CASES)
def test_each_value_of_the_range_has_its_load_in_its_piece(name: str) -> None:
    column, parameter, low, high, given = CASES[name]
    found = fb.exact_range(fb.column(column), parameter, low, high, digits=1, **given)
    ends = [F(low), *(F(p.high) for p in found.pieces)]
    assert [F(p.low) for p in found.pieces] == ends[:-1] and ends[-1] == F(high) and found.open == ()
    random = np.random.default_rng(3)
    for p in found.pieces:
        assert p.kind == name.split(",")[0] or p.kind == "flutter"
        for share in (float(random.uniform()),):
            value = F(p.low) + F(share) * (F(p.high) - F(p.low))
            exact = fb.proofs.enclosed_load(fb.column(column), digits=9, **given | {parameter: value})
            assert exact.load is not None and exact.frequency is not None and exact.kind == p.kind
            assert F(p.load[0]) < F(exact.load[0]) and F(exact.load[1]) < F(p.load[1])
            assert F(p.frequency[0]) <= F(exact.frequency[0]) and F(exact.frequency[1]) <= F(p.frequency[1])
        assert F(p.load[1]) < F(p.load[0]) * F(11, 10)
    assert F(found.load[0]) <= min(F(p.load[0]) for p in found.pieces)
    assert F(found.load[1]) >= max(F(p.load[1]) for p in found.pieces)


def test_a_foundation_shifts_the_square_of_each_frequency_and_leaves_the_load() -> None:
    """Over a range of it, which stands in the equation of motion; without damping."""
    beck_load = fb.proofs.enclosed_load(fb.column("beck"), digits=9)
    assert beck_load.load is not None and beck_load.frequency is not None
    found = fb.exact_range(fb.column("foundation"), "k", "100", "101", digits=3)
    (only,) = found.pieces
    assert F(only.load[0]) < F(beck_load.load[0]) and F(beck_load.load[1]) < F(only.load[1])
    low, high = (F(v) ** 2 for v in only.frequency)
    square = F(beck_load.frequency[0]) ** 2
    assert low < square + 100 and square + 101 < high


# ------------------------------------------------------------ broken ranges


def over(low: str, high: str) -> Over:
    return Over(beck, {"eta": Range(F(low), F(high))})


UNDAMPED = (F(0), F(0), None)


def test_a_range_with_loads_far_apart_or_of_another_kind_is_refused() -> None:
    values = Range(F("0.6"), F("0.605"))
    with pytest.raises(Unproven, match="too far apart"):
        piece(over("0.6", "0.605"), values, UNDAMPED, (16.27, 8.36), "flutter", F(1, 10**4))
    with pytest.raises(Unproven):
        piece(over("0.6", "0.605"), values, UNDAMPED, (16.27, 0), "divergence")


def test_a_range_taken_for_its_middle_lacks_the_loads_of_its_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the enclosure stands on."""
    near, ends = (16.27, 8.36), []
    for eta in ("0.6", "0.605"):
        exact = fb.proofs.enclosed_load(fb.column("beck"), digits=9, eta=eta).load
        assert exact is not None
        ends.append(arb(exact[0]))
    found = crossing(over("0.6", "0.605"), UNDAMPED, near, "flutter").load
    assert all(found.contains(load) for load in ends)
    right = _Family.moved
    monkeypatch.setattr(_Family, "moved", lambda self, Y, x: right(self, Y, x).mid())
    found = crossing(over("0.6", "0.605"), UNDAMPED, near, "flutter").load
    assert not any(found.contains(load) for load in ends)


def test_no_box_holds_the_crossings_about_one_half() -> None:
    """Divergence below, flutter above."""
    with pytest.raises(Unproven):
        piece(over("0.49", "0.51"), Range(F("0.49"), F("0.51")), UNDAMPED, (9.0, 0.0), "divergence")
    with pytest.raises(Unproven):
        piece(over("0.49", "0.51"), Range(F("0.49"), F("0.51")), UNDAMPED, (16.05, 7.06), "flutter")


def test_what_is_open_is_named_and_not_covered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_ranges, "FINEST", 2)
    found = fb.exact_range(fb.column("beck"), "eta", "0.44", "0.5", digits=1)
    (left,) = found.open
    assert F(left.low) < F(left.high) == F(1, 2) and left.missing
    parts = sorted([(F(p.low), F(p.high)) for p in (*found.pieces, left)])
    assert all(a[1] == b[0] for a, b in pairwise(parts)) and (parts[0][0], parts[-1][1]) == (F("0.44"), F("0.5"))
    ax = fb.figures.proven_range(found)
    assert len(ax.patches) == len(parts)


def test_where_no_series_loses_stability_nothing_is_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_ranges, "FINEST", 2)
    with pytest.raises(InputError, match="no series loses stability up to the load 2"):
        fb.exact_range(fb.column("beck"), "eta", "0.3", "0.31", load_max=2)


def test_internal_damping_that_may_be_nothing_is_refused() -> None:
    with precision(128), pytest.raises(OpenStep, match="where the load jumps"):
        damping_factors(Beam(beck), Range(F(0), F(1, 100)), F(0), None)
    with precision(128), pytest.raises(OpenStep, match="not known to be positive"):
        damping_factors(Beam(beck), F(0), Range(F(-1, 100), F(1, 100)), None)


# ------------------------------------------------------------ what stands for each value


def test_the_function_of_each_value_is_in_that_of_the_range() -> None:
    orders = ((0, 0), (1, 0), (0, 1), (0, 2))
    with precision(128):
        whole = over("0.4", "0.6")
        local = Local(whole, arb(12, 1), arb(60, 9))
        for eta in (F(2, 5), F(47, 100), F(3, 5)):
            point = arb("12.3"), arb("57.5")
            thin = Beam(beck, {"eta": eta}).taylor(*point, orders)
            for found in (whole.taylor(*point, orders), local.taylor(*point, orders)):
                assert all(found[order].contains(thin[order].mid()) for order in orders)
        strips = Strips(beck, {"eta": Range(F(2, 5), F(3, 5))}, 40)
        reach = strips.reach(2)
        assert all(reach < Strips(beck, {"eta": eta}, 40).reach(2) for eta in (F(2, 5), F(1, 2), F(3, 5)))


FOUNDATION = fb.column("foundation").kernel
SPREAD = Range(F(95), F(105))


def of_foundation(share: Any) -> Beam:
    """share: −1 to 1 of the way from the middle to an end."""
    return Beam(FOUNDATION, {"k": 100 + 5 * F(share)})


@pytest.mark.parametrize("place", [(arb(15), arb(150)), (acb(15, -1), acb(150, 3))])
def test_the_function_of_each_foundation_is_in_the_polynomial_of_the_range(place: Any) -> None:
    orders = ((0, 0), (1, 0), (0, 1), (0, 2))
    with precision(128):
        over_it = OverEquation(FOUNDATION, {"k": SPREAD})
        around = [side + (arb(0, 1) if isinstance(side, arb) else acb(arb(0, 1), arb(0, 1))) for side in place]
        found = over_it.taylor(*place, orders), Local(over_it, *around).taylor(*place, orders)
        jets = Jets(orders, isinstance(place[0], acb))
        terms = [row.entries() for row in over_it.coefficients(*place, jets)]
        middle = [row.entries() for row in _coefficients(over_it._at, *place, jets)]
        for share in (-1, F(1, 3), 1):
            thin = of_foundation(share).taylor(*place, orders)
            assert all(whole[order].contains(thin[order]) for whole in found for order in orders)
            assert all(at.contains(thin[order]) for order, at in zip(jets.orders, _at(terms, share), strict=True))
            # what is left out after t² is there, and counted
            assert not _at(middle, share)[0].contains(thin[0, 0])


def _coefficients(beam: Any, p: Any, s: Any, jets: Jets) -> list[Any]:
    series = Series(jets, DEGREE)
    return series.coefficients(beam.expanded(p, s, series))


def _at(terms: list[list[Any]], t: Any) -> list[Any]:
    t = arb(F(t).numerator) / F(t).denominator
    return [sum((c * t**k for k, c in enumerate(column)), arb(0)) for column in zip(*terms, strict=True)]


def test_a_foundation_may_be_nothing_in_a_range() -> None:
    """The bounds of the strips are those of its largest value, not of a ball about nothing."""
    with precision(128):
        reach = Strips(FOUNDATION, {"k": Range(F(0), F(1))}, 40).reach(2)
        most = Strips(FOUNDATION, {"k": F(1)}, 40).reach(2)
        assert most * arb("0.999") < reach < most * arb("1.000001")


def test_conditions_that_hold_the_parameter_too() -> None:
    """A dead load stands in the equation and at x = 1, a rotational spring at x = 0."""
    orders, place = ((0, 0), (0, 1)), (arb(9), arb(70))
    for name, own in (("beck-dead-load", "w"), ("elastic-root", "c")):
        kernel = uniform(fb.column(name).kernel)
        with precision(128):
            over_it = OverEquation(kernel, {own: Range(F(1), F(2))})
            whole = over_it.taylor(*place, orders)
            terms = [row.entries() for row in over_it.coefficients(*place, Jets(orders, False))]
            for share in (-1, F(1, 3), 1):
                thin = Beam(kernel, {own: F(3, 2) + F(share) / 2}).taylor(*place, orders)
                assert all(whole[order].contains(thin[order]) for order in orders)
                assert _at(terms, share)[0].overlaps(thin[0, 0])


def test_a_parameter_of_stiffness_mass_or_a_square_is_refused() -> None:
    def changed(**more: Any) -> Any:
        def equation(*given: Any, k: Any, **rest: Any) -> Any:
            return {**FOUNDATION.equation(*given, **rest), **{key: (f(k),) for key, f in table.items()}}

        table = {tuple(map(int, key[1:].split("_"))): f for key, f in more.items()}
        return SimpleNamespace(COLUMN=FOUNDATION.COLUMN, equation=equation, end_conditions=FOUNDATION.end_conditions)

    for bad in ({"d4_0": lambda k: k}, {"d0_2": lambda k: k}, {"d0_0": lambda k: k * k}, {"d4_1": lambda k: k}):
        with pytest.raises(NoSeries, match="linear in it, and bending stiffness"):
            OverEquation(changed(**bad), {"k": Range(F(1), F(2))})
    for name in ("pflueger", "cone", "tip-damper", "exponential-taper", "step"):
        assert uniform(fb.column(name).kernel) is None
    with precision(64), pytest.raises(NoSeries, match="damping is not of the form"):
        Beam(uniform(fb.column("beck-dead-load").kernel)).damping(F(1, 100), F(0))


@pytest.mark.parametrize("which", ["eta", "k", "alpha", "beta"])
def test_the_equations_of_each_value_are_in_those_of_the_range(which: str) -> None:
    """At a point that is no crossing, times a matrix."""
    own = "k" if which == "k" else "eta"
    kernel = FOUNDATION if which == "k" else beck
    middle = {"eta": F(3, 5), "alpha": F(1, 1000), "beta": F(1, 2), "k": F(100)}
    spread = middle[which] / 40
    held: dict[str, Any] = {**middle, which: Range(middle[which] - spread, middle[which] + spread)}
    x = [arb(15), arb(7)]
    with precision(128):
        Y = arb_mat([[2, -1], [arb("0.5"), 3]])
        beam = beam_over(kernel, {own: held[own]}) if which == own else Beam(kernel, {own: held[own]})
        whole = _Family(beam, (held["alpha"], held["beta"], None), "flutter").moved(Y, x)
        for share in (-1, F(1, 3), 1):
            at = {**middle, which: middle[which] + share * spread}
            thin = _Family(Beam(kernel, {own: at[own]}), (at["alpha"], at["beta"], None), "flutter").moved(Y, x)
            assert all(a.contains(b.mid()) for a, b in zip(whole.entries(), thin.entries(), strict=True))
        far = {**middle, which: middle[which] + 3 * spread}
        thin = _Family(Beam(kernel, {own: far[own]}), (far["alpha"], far["beta"], None), "flutter").moved(Y, x)
        assert not all(a.contains(b) for a, b in zip(whole.entries(), thin.entries(), strict=True))


def test_equations_change_with_damping_as_their_differences_do() -> None:
    """One slope along a range of both that is almost none, at a point that is no crossing."""
    x, h, middle, beam = [arb(15), arb(7)], F(1, 10**12), (F(1, 100), F(1, 2)), Beam(beck, {"eta": F(1)})
    with precision(256):
        whole: Any = tuple(Range(v - h, v + h) for v in middle)
        ((slopes, weight),) = _Family(beam, (*whole, None), "flutter")._by_damping(x)
        above, below = (Damped(beam, *(v + side for v in middle)).value(x) for side in (h, -h))
        assert weight.mid() == 0 and 1 <= weight.rad() < 1.001
        for slope, one, other in zip(slopes, above, below, strict=True):
            assert slope.mid() != 0 and abs(((one - other) / 2 / slope.mid() - 1).mid()) < 1e-9


def test_frequencies_of_each_value_are_on_their_side_of_the_lines() -> None:
    """Of a column with a tip mass, by series without load; and F of each value is in that of the range."""
    kernel, values = fb.column("pflueger").kernel, Range(F("0.8"), F("1.2"))
    own = {"J": F(1, 10)}
    system = OverSystem(kernel, {**own, "mu": values})
    orders = ((0, 0), (0, 1))
    with precision(64):
        gaps = FrequencyGaps(system, arb(6))
        lines = {k: float(gaps.line(k)) for k in range(gaps.lowest, gaps.count)}
        whole = system.taylor(arb(8), arb(20), orders)
        local = Local(system, arb(8, "0.1"), arb(20, "0.3")).taylor(arb("8.05"), arb("19.8"), orders)
    assert len(lines) > 1
    basis = kernel.basis(24)
    for mu in (F("0.8"), F("0.93"), F("1.2")):
        given = {"mu": float(mu), "J": 0.1}
        squares = 1 / eigh(kernel.mass(basis, 0.0, **given), kernel.stiffness(basis, 0.0, **given), eigvals_only=True)
        assert all(np.sum(squares < R) == k for k, R in lines.items())
        with precision(64):
            thin = ExactSystem(kernel, {**own, "mu": mu})
            for found, point in ((whole, ("8", "20")), (local, ("8.05", "19.8"))):
                at = thin.taylor(*map(arb, point), orders)
                assert all(found[order].contains(at[order].mid()) for order in orders)


def test_masses_and_springs_that_grow_together_are_refused() -> None:
    """Frequencies need not go one way then."""
    with precision(64):
        low, high = (ColumnForms(fb.column("pflueger").kernel, {"mu": F(mu), "J": F("0.1")}) for mu in (1, 2))
        assert over_both(low, high).masses[F(1), 0].contains(arb("1.5"))
        high.springs = {(F(1), 0): F(1)}
        with pytest.raises(NoStrips, match="not all frequencies rise"):
            over_both(low, high)
        high.m = [[F(2)]]
        with pytest.raises(NoStrips, match="more than masses and springs"):
            over_both(low, high)


def test_a_range_of_one_end_alone_would_put_a_line_too_low(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frequencies fall as the mass grows: those of both ends bound the gaps, and of one they are taken for wider."""
    system = OverSystem(fb.column("pflueger").kernel, {"J": F(1, 10), "mu": Range(F(1, 2), F(2))})
    with precision(64):
        right = FrequencyGaps(system, arb(3)).reach
        monkeypatch.setattr(frequency_gaps, "at_both", lambda own: [{"J": F(1, 10), "mu": F(1, 2)}])
        assert right < FrequencyGaps(system, arb(3)).reach


@pytest.mark.parametrize(
    ("column", "own", "message"),
    [
        ("beck-self-weight", "g", "in one condition alone, linearly"),
        ("step", "s", "in one condition alone, linearly"),
        ("point-mass", "a", "where a stands is not known"),
        ("feedback", "a", "in one condition alone, linearly"),  # the place of a sensor
        ("tip-damper", "c", "dampers or gyroscopic terms"),
    ],
)
def test_what_no_range_is_served_of_beyond_the_textbook(column: str, own: str, message: str) -> None:
    with pytest.raises(NoSeries, match=message):
        OverSystem(fb.column(column).kernel, {own: Range(F(2, 5), F(1, 2))})


def test_a_parameter_elsewhere_than_in_one_condition_is_refused() -> None:
    right = beck.end_conditions

    def twice(*given: Any, eta: Any, **more: Any) -> Any:
        left, (force, moment) = right(*given, eta=eta, **more)
        return left, (force, {**moment, (1, 0): eta})

    def bent(*given: Any, eta: Any, **more: Any) -> Any:
        return right(*given, eta=eta * eta, **more)

    def held(*given: Any, eta: Any, **more: Any) -> Any:
        left, ends = right(*given, eta=1, **more)
        return (left[0], {(1, 0): 1, (2, 0): eta}), ends

    def inside(*given: Any, eta: Any, **more: Any) -> Any:
        return {**beck.equation(*given, eta=eta, **more), (0, 0): (eta,)}

    for changed in (
        {"end_conditions": twice},
        {"end_conditions": bent},
        {"end_conditions": held},
        {"equation": inside},
    ):
        parts = {"COLUMN": beck.COLUMN, "equation": beck.equation, "end_conditions": right} | changed
        with pytest.raises(NoSeries, match="a range of eta is served where it stands in one condition at x = 1 alone"):
            Over(SimpleNamespace(**parts), {"eta": Range(F(1, 2), F(1))})
    with precision(64), pytest.raises(NoStrips, match="moves rigidly"):
        Strips(Rigid(), {"k": Range(F(1), F(2))}, 40)  # type: ignore[arg-type]


class Rigid:
    """A column that moves rigidly, with a parameter."""

    COLUMN: ClassVar = {**fb.column("free-free").kernel.COLUMN, "parameters": [{"name": "k", "default": 1.0}]}

    @staticmethod
    def forms(one: Any, *, k: Any) -> Any:
        return {"M": ({(0, 0, 0): 1}, {}), "E": ({(0, 2, 2): 1}, {}), "H": ({(0, 1, 1): k}, {})}

    @staticmethod
    def damping_factors(alpha: Any, beta: Any, *, k: Any) -> Any:
        return beta, alpha


# ------------------------------------------------------------ the command line


def test_a_range_is_typed_with_two_dots(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ["critical", "--column", "beck", "--exact", "--digits", "1", "--set", "eta=0.3..0.31"]
    picture = tmp_path / "picture.svg"
    assert main([*words, "--json", "--plot", str(picture)]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["parameters"] == {"eta": [0.3, 0.31]} and record["inputs"]["eta"] == "0.3 to 0.31"
    assert record["pieces"][0]["low"] == "0.3" and record["pieces"][-1]["high"] == "0.31" and record["open"] == []
    assert all(record["pieces"][0]["proof"].values()) and "<svg" in picture.read_text()
    assert main(words) == 0
    assert "each value" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments",
    [
        ["--set", "eta=0.3..0.31"],
        ["--exact", "--set", "eta=0.31..0.3"],
        ["--exact", "--set", "eta=0.3..x"],
        ["--exact", "--set", "eta=0.3..0.31", "--beta", "0.1..0.2"],
        ["--exact", "--alpha", "0..0.1"],
        ["--exact", "--alpha", "0+", "--beta", "0.1..0.2"],
        ["--exact", "--kappa", "0..1"],
        ["--exact", "--beta", "-1..1"],
        ["--exact", "--set", "eta=0.3..0.31", "--all"],
        ["--exact", "--set", "eta=0.3..0.31", "--digits", "9"],
        ["--exact", "--set", "eta=0.3..0.31", "--bending-stiffness", "1"],
    ],
)
def test_a_range_that_is_none_is_refused_in_one_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["critical", "--column", "beck", *arguments]) == 2
    out, err = capsys.readouterr()
    assert not out and err.count("\n") == 1


def test_forms_at_places_keep_which_end_moves_and_which_is_felt() -> None:
    point = ((None, 0, F(0), None), (None, 1, F(1), None), F(5))
    assert _form([(None, None, 1, None, 0, (3, 0, 2))], [point, point]) == (
        {(0, 1, 0): 3, (1, 1, 0): 0, (2, 1, 0): 2},
        {(0, 0, 1, 1): 10},
    )
    with pytest.raises(NotUniform):
        _form([], [((None, 0, F(1, 2), None), *point[1:])])
