"""All crossings up to a load: against counts of unstable eigenvalues, closed forms, cases that cannot be decided."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from itertools import pairwise, product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_mat, arb_poly
from hypothesis import given, settings
from hypothesis import strategies as st

import freebeam as fb
from freebeam_derive.certify import all_crossings, balls, first_crossing
from freebeam_derive.certify.all_crossings import Crossing, Inseparable
from freebeam_derive.certify.balls import Unproven
from freebeam_derive.certify.boundary_polynomials import Question, boundary
from freebeam_sym import column_names

F = Fraction
TOP = F(1000)


@cache
def found(name: str, question: Question, digits: int = 15, basis: str = "modes", top: Fraction = TOP) -> list[Crossing]:
    return all_crossings.survey(fb.column(name, basis).kernel, question, top, digits)


class Own(dict[str, Fraction]):
    """Parameters of a column's own that can be part of a question that is remembered."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(self.items()))


def unstable(name: str, basis: str, question: Question, load: float) -> int:
    """Eigenvalues λ with a positive real part, by numpy; stable ones without damping are on the axis."""
    own = {n: float(v) for n, v in (question.own or {}).items()}
    alpha, beta = float(question.alpha), float(question.beta)
    system = fb.column(name, basis).system(modes=question.modes, load=load, alpha=alpha, beta=beta, **own)
    K, C = np.linalg.solve(system.M, system.K), np.linalg.solve(system.M, system.C)
    N = question.modes
    values = np.linalg.eigvals(np.block([[np.zeros((N, N)), np.eye(N)], [-K, -C]]))
    return int((values.real > (1e-5 if question.undamped else 1e-10) * np.abs(values)).sum())


@settings(derandomize=True, deadline=None, max_examples=14)
@given(
    name=st.sampled_from(column_names()),
    basis=st.sampled_from(["modes", "legendre"]),
    modes=st.integers(1, 5),
    alpha=st.one_of(st.just(0.0), st.floats(-4, 1).map(lambda p: 10**p)),
    beta=st.one_of(st.just(0.0), st.floats(-3, 2).map(lambda p: 10**p)),
    eta=st.floats(0, 1.3),
)
def test_between_crossings_as_many_eigenvalues_grow_as_numpy_counts(
    name: str, basis: str, modes: int, alpha: float, beta: float, eta: float
) -> None:
    own = Own(eta=F(eta)) if name == "beck" else Own()
    question = Question(modes, F(alpha), F(beta), own=own)
    listed = found(name, question, basis=basis)
    edges = [F(0), *(c.load[0] for c in listed), TOP]
    count = 0
    for k, (low, high) in enumerate(pairwise(edges)):
        assert low < high
        if high - low > high / 1000:
            for share in (0.05, 0.5, 0.95):
                assert unstable(name, basis, question, float(low) + share * float(high - low)) == count
        if k < len(listed):
            assert listed[k].unstable == count
            count += listed[k].change


@pytest.mark.parametrize(
    ("name", "question"),
    [
        ("free-free", Question(8)),
        ("free-free", Question(8, F("0.001"), F("0.1"))),
        ("free-free", Question(6, kappa=F(0))),
        ("beck", Question(4, own=Own(eta=F("0.4")))),
    ],
)
def test_the_first_crossing_is_the_certified_load(name: str, question: Question) -> None:
    """Two proofs: Hermite and Biehler's theorem up to the load, and the search of the whole range."""
    first = found(name, question)[0]
    square = first.square or (F(0), F(0))
    near = float(first.load[0]), float(square[0]) ** 0.5
    proven = first_crossing.certify(fb.column(name, "modes").kernel, question, near, 20)
    assert proven.load is not None and first.load[0] < proven.load[0] < proven.load[1] < first.load[1]
    assert first.stability == "lost" and first.kind == proven.kind
    if proven.square is not None:
        assert square[0] < proven.square[1] and proven.square[0] < square[1]


def test_stability_lost_regained_and_lost_again() -> None:
    """Beck's column with η a little below 1/2 buckles, is stable again, and flutters."""
    listed = found("beck", Question(4, own=Own(eta=F("0.4"))), top=F(60))
    assert [(c.kind, c.stability) for c in listed] == [
        ("divergence", "lost"), ("divergence", "regained"), ("flutter", "lost")
    ]  # fmt: skip
    damped = found("beck", Question(4, F("0.01"), own=Own(eta=F("0.4"))), top=F(60))
    for plain, other in zip(listed[:2], damped, strict=False):
        assert plain.load == other.load or (plain.load[0] < other.load[1] and other.load[0] < plain.load[1])


def test_meetings_below_zero_are_no_crossings() -> None:
    """The pinned beam buckles at (nπ)²; its unstable eigenvalues meet at (n² + m²) π², which the list leaves out."""
    listed = found("euler-pinned", Question(6))
    with balls.precision(200):
        for n, c in enumerate(listed, start=1):
            assert c.kind == "divergence" and (c.unstable, c.change) == (n - 1, 1)
            assert balls.exact(c.load[0]) < (n * arb.pi()) ** 2 < balls.exact(c.load[1])
    assert len(listed) == 6


def test_a_restabilised_pair_is_seen() -> None:
    """The load turned round: what was the onset at P is regained at 30 − P."""
    kernel = fb.column("beck", "modes").kernel
    exact = balls.matrices

    def turned(*arguments: Any) -> tuple[arb_mat, arb_mat, arb_mat]:
        M, E, H = exact(*arguments)
        return M, E + 30 * H, -1 * H

    plain = found("beck", Question(3), top=F(30))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(balls, "matrices", turned)
        with pytest.raises(Unproven, match="not known to be stable without load"):
            all_crossings.survey(kernel, Question(3), F(30), 15)
        patch.setattr(all_crossings, "separators_at", lambda *_: ())
        patch.setattr(all_crossings, "holds", lambda *_: True)
        listed = all_crossings.survey(kernel, Question(3), F(30), 15)
    assert [c.change for c in listed] == [-c.change for c in reversed(plain)]
    for one, other in zip(listed, reversed(plain), strict=True):
        assert one.load[0] < 30 - other.load[0] and 30 - other.load[1] < one.load[1]


@pytest.mark.parametrize("question", [Question(4), Question(4, F("0.01"), F("0.5")), Question(4, kappa=F(3))])
def test_enclosures_nest_as_digits_grow(question: Question) -> None:
    for wide, narrow in zip(found("beck", question, 12), found("beck", question, 60), strict=True):
        assert wide.load[0] < narrow.load[0] < narrow.load[1] < wide.load[1]
        assert (narrow.load[1] - narrow.load[0]) * 10**60 < narrow.load[0]
        assert (wide.kind, wide.change, wide.unstable) == (narrow.kind, narrow.change, narrow.unstable)


# --- what cannot be decided -----------------------------------------------------------------------------------


def replaced(patch: pytest.MonkeyPatch, M: Any, E: Any, H: Any) -> None:
    patch.setattr(balls, "matrices", lambda *_: tuple(arb_mat(rows) for rows in (M, E, H)))


ONE = [[1, 0], [0, 1]]


def test_frequencies_that_pass_through_each_other_are_not_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    """s = 1 + 3P and s = 4 are equal at P = 1 and do nothing to each other; balls cannot tell that from flutter."""
    monkeypatch.setattr(all_crossings, "FINEST", 40)
    replaced(monkeypatch, ONE, [[1, 0], [0, 4]], [[3, 0], [0, 0]])
    with pytest.raises(Inseparable, match=r"between the loads (1|0\.99)") as caught:
        all_crossings.survey(fb.column("beck", "modes").kernel, Question(2), F(3), 10)
    assert "Established: up to there stability changes at these loads and no others: none" in str(caught.value)
    settled: list[Any] = [SimpleNamespace(load=arb(load)) for load in (5, 2, 0.5)]
    assert str(Inseparable(F(3), F(4), settled)).endswith("at these loads and no others: 0.5, 2")
    assert all_crossings.survey(fb.column("beck", "modes").kernel, Question(2, F("0.1")), F(3), 10) == []


@pytest.mark.parametrize("apart", [F(1, 10**12), F(1, 10**40)])
def test_two_crossings_close_together(apart: Fraction, monkeypatch: pytest.MonkeyPatch) -> None:
    """det K = (P − 1)(P − 1 − δ): told apart where the halvings reach δ, and else reported with what is below."""
    with balls.precision(3000):
        second = 1 + balls.exact(apart)
    replaced(monkeypatch, ONE, [[1, 0], [0, second]], [[-1, 0], [0, -1]])
    question = Question(2, F("0.5"))
    if apart > F(1, 10**20):
        one, two = all_crossings.survey(fb.column("beck", "modes").kernel, question, F(3), 20)
        assert one.load[1] < two.load[0] and abs(two.load[0] - one.load[0] - apart) < apart / 1000
    else:
        with pytest.raises(Inseparable, match=r"two may lie closer together"):
            all_crossings.survey(fb.column("beck", "modes").kernel, question, F(3), 20)
        # an interval so wide that both are in it is not said to hold one
        with pytest.raises(Unproven, match="a second crossing may lie"):
            first_crossing.certify(fb.column("beck", "modes").kernel, question, (1.0, 0.0), 20)
        monkeypatch.setattr(first_crossing, "holds", lambda *_: True)
        assert first_crossing.certify(fb.column("beck", "modes").kernel, question, (1.0, 0.0), 60).load is not None


@pytest.mark.parametrize("apart", [F(1, 10**3), F(1, 10**9), F(-1, 10**9)])
def test_crossings_at_loads_close_together_are_both_found(apart: Fraction, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two pairs that do not know of each other, s of 1 and 4 and of 9 and 12, meet at the loads 1 and 1 + δ."""
    one, other = F(3, 2), F(3, 2) / (1 + apart)
    H = [[0, one, 0, 0], [-one, 0, 0, 0], [0, 0, 0, other], [0, 0, -other, 0]]
    with balls.precision(5000):
        rows = [[balls.exact(F(v)) for v in row] for row in H]
    unit = [[int(i == j) for j in range(4)] for i in range(4)]
    replaced(monkeypatch, unit, [[v * (1, 4, 9, 12)[i] for v in unit[i]] for i in range(4)], rows)
    kernel = fb.column("beck", "modes").kernel
    first, second = all_crossings.survey(kernel, Question(4), F(3), 20)
    assert (first.change, first.unstable, second.change, second.unstable) == (2, 0, 2, 2)
    for crossing, load in zip((first, second), sorted((F(1), 1 + apart)), strict=True):
        assert abs(crossing.load[0] - load) < F(1, 10**15)


def test_balls_blown_up_yield_no_list(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = balls.matrices
    monkeypatch.setattr(balls, "matrices", lambda *a: tuple(m * arb(1, 1e-3) for m in exact(*a)))
    monkeypatch.setattr(all_crossings, "FINEST", 12)
    with pytest.raises(Unproven):
        all_crossings.survey(fb.column("beck", "modes").kernel, Question(4), F(100), 10)


def test_a_box_with_two_crossings_is_not_said_to_hold_one() -> None:
    """Boxes about a crossing that reach the next one: the contraction must fail on them, and hold on small ones."""
    question = Question(5, F("0.01"), F("0.5"))
    listed = found("beck", question)
    assert len(listed) > 1
    with balls.precision(400):
        polynomials = boundary(fb.column("beck", "modes").kernel, question, 400)
        for one, other in pairwise(listed):
            assert one.square is not None and other.square is not None
            P, x = one.load[0], one.square[0]
            local = polynomials.about(balls.exact(P), balls.exact(x))
            r, rho = other.load[1] - P, abs(other.square[1] - x) + abs(other.square[0] - x)
            assert not first_crossing.alone(local, r, rho)
            assert first_crossing.alone(local, r / 10**6, rho / 10**6)


def test_crossings_at_one_load_are_put_in_no_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """A divergence and a flutter that know nothing of each other, both at the load 1: neither is said to be first."""
    replaced(monkeypatch, [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[1, 0, 0], [0, 9, 0], [0, 0, 12]],
             [[-1, 0, 0], [0, 0, 1.5], [0, -1.5, 0]])  # fmt: skip
    with pytest.raises(Unproven, match=r"two crossings, at loads near 1 that agree to .* whether these are one load"):
        all_crossings.survey(fb.column("beck", "modes").kernel, Question(3), F(3), 10)


@pytest.mark.parametrize("name, kappa, load", [("links", None, F(2)), ("ziegler", F(0), F(41, 28))])
def test_the_highest_load_is_one_of_those_looked_at(name: str, kappa: Any, load: Fraction, monkeypatch: Any) -> None:
    """A divergence of two uncoupled degrees of freedom, 1 − P/2 and 2 − P/2, and a flutter, each at a fraction."""
    column, question = fb.column("ziegler"), Question(2, kappa=kappa)
    if name == "links":
        column, question = fb.column("beck", "modes"), Question(2)
        replaced(monkeypatch, ONE, [[1, 0], [0, 4]], [[-0.5, 0], [0, -0.5]])
    for end, count in ((load * F(9, 10), 0), (load * (1 - F(1, 10**9)), 0), (load, 1), (load * (1 + F(1, 10**9)), 1)):
        listed = all_crossings.survey(column.kernel, question, end, 15)
        assert len(listed) == count and all(c.load[0] <= load <= c.load[1] for c in listed)


def test_a_crossing_that_leaves_its_box_in_refining_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether by its load or by its frequency; there may be another in the box."""
    of: Any = SimpleNamespace(h=SimpleNamespace(rows=[arb_poly([1])]), part=None)
    crossing = all_crossings._Found(arb(2), arb(5), F(1), F(3), F(4), F(6), 2)
    for load, square in product((1, 2, 3), (4, 5, 6)):
        monkeypatch.setattr(all_crossings, "refined", lambda *_, at=(load, square): [arb(v) for v in at])
        monkeypatch.setattr(all_crossings, "_place", lambda *_: None)  # which is for a file
        if (load, square) == (2, 5):
            (found,) = all_crossings._refined([of], [crossing], [of], 10, 64)
            assert found.load[0] <= 2 <= found.load[1] and found.stability == "lost"
            continue
        with pytest.raises(Unproven, match="was lost in refining it"):
            all_crossings._refined([of], [crossing], [of], 10, 64)


@pytest.mark.parametrize(("dip", "common"), [(8, True), (1, False)])
def test_a_common_zero_between_the_ends_of_a_stretch_is_not_passed_over(dip: int, common: bool) -> None:
    """h = g = 1 − c P (1 − P) + x is positive at both ends, for 0 ≤ x ≤ 1; with c = 8 it is not so between them."""
    table = arb_mat([[1, 1], [-dip, 0], [dip, 0]])
    both: Any = SimpleNamespace(table=table)
    them: Any = object.__new__(all_crossings._Survey)
    them.found, them._strips = SimpleNamespace(h=both, g=both), lambda *_: [(F(0), F(1), 0), (F(1), None, 1)]
    assert (them._doubtful(F(0), F(1)) is not None) == common


@pytest.mark.parametrize(
    ("question", "count"),
    [(Question(3), 1), (Question(3, F("0.01"), F("0.5")), 1), (Question(2, F("0.1"), own=Own(eta=F(0))), 2)],
)
def test_each_crossing_is_within_a_box_of_its_own(question: Question, count: int) -> None:
    """Which goes from below it to above it in P, and in x, and meets no other."""
    with balls.precision(400):
        of = boundary(fb.column("beck", "modes").kernel, question, 400)
        listed = all_crossings._Survey(of, F(40), lambda _: None).run()
        assert len(listed) == count
        for c in listed:
            assert balls.exact(c.low) < c.load < balls.exact(c.high) and c.high - c.low < 40
            if c.square is not None:
                assert balls.exact(c.bottom) < c.square < balls.exact(c.top)
                assert of.h(c.load, c.square).contains(0) and of.g(c.load, c.square).contains(0)
        for one, other in pairwise(sorted(listed, key=lambda c: c.low)):
            assert one.high <= other.low or (one.square is None) != (other.square is None)


def test_below_all_crossings_stability_is_asked_for_up_to_near_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """And without any up to the highest load."""
    monkeypatch.setattr(all_crossings, "certify_parts", lambda *given: given[-1])
    loads = [(F(16), F(17)), (F(8), F(9)), (F(40), F(41))]
    every: Any = [SimpleNamespace(load=load) for load in loads]
    first: Any = all_crossings.Crossings(every, TOP, [], 64).below(Question(2))
    assert 7 <= first <= F(15, 2) and all_crossings.Crossings([], TOP, [], 64).below(Question(2)) == TOP


def test_where_motions_rest_crossings_are_looked_for_from_a_load_below_which_there_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The first half, quarter, … of the loads up to which stability is known; where none is, the column is refused."""
    asked: list[Fraction] = []

    def over(of: Any, start: Fraction, end: Fraction) -> Any:
        asked.append(end)
        if end > 4:
            raise Unproven("too far")
        return end if start == 0 and end < 3 else None

    them = all_crossings._Survey(SimpleNamespace(rests=1), F(20), lambda _: None)  # type: ignore[arg-type]
    monkeypatch.setattr(all_crossings, "stretch_over", over)
    assert them._first_stable() == F(5, 2) and asked == [F(20), F(10), F(5), F(5, 2)]
    monkeypatch.setattr(all_crossings, "stretch_over", lambda *_: None)
    with pytest.raises(Unproven, match="stable at small loads"):
        them._first_stable()
