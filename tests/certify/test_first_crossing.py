"""Certified Ritz loads against the runtime, against mpmath, and against candidates that are wrong on purpose."""

from __future__ import annotations

import copy
import math
from fractions import Fraction
from functools import cache
from types import ModuleType, SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
from flint import arb, arb_poly, fmpq_mat
from hypothesis import given, settings
from hypothesis import strategies as st

import freebeam as fb
from freebeam_derive.certify import balls, certificate, first_crossing, verifier
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.boundary_polynomials import Question, boundary
from freebeam_derive.certify.first_crossing import Enclosure, Stretch, check_fast
from freebeam_derive.certify.verifier import Fast
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_sym import column_names

F = Fraction
CASES = {
    "undamped": ("free-free", Question(8)),
    "damped": ("free-free", Question(8, F("0.001"), F("0.1"))),
    "limit": ("free-free", Question(8, kappa=F(0))),
    "limit at a ratio": ("beck", Question(4, kappa=F(2))),
    "beck": ("beck", Question(8, own={"eta": F(1)})),
    "beck, dead load": ("beck", Question(8, own={"eta": F(0)})),
    "beck, heavy damping": ("beck", Question(8, F(10))),
    "euler": ("euler-pinned", Question(8, F(1, 3), F(2))),
    "one mode": ("free-free", Question(1)),
    "polynomials": ("free-free", Question(5)),
    "polynomials, damped": ("beck", Question(4, F("0.001"), F("0.1"))),
}


def column(case: str) -> fb.Column:
    return fb.column(CASES[case][0], "legendre" if "polynomials" in case else "modes")


def candidate(column: fb.Column, question: Question) -> tuple[float, float] | None:
    found = fb.critical_load(
        column,
        question.modes,
        float(question.alpha),
        float(question.beta),
        kappa=None if question.kappa is None else float(question.kappa),
        **{n: float(v) for n, v in (question.own or {}).items()},
    )
    return None if found.load is None or found.frequency is None else (found.load, found.frequency)


@cache
def certified(case: str, digits: int = 30) -> Enclosure:
    question = CASES[case][1]
    return first_crossing.certify(column(case).kernel, question, candidate(column(case), question), digits)


@pytest.mark.parametrize("name", column_names())
def test_roots_are_those_of_an_independent_determinant(name: str) -> None:
    """Roots as balls, Eq. (21), against the verifier's own isolation in another set of functions."""
    kernel = fb.column(name, "modes").kernel
    with balls.precision(300):
        quarter, _, delta = balls.roots(kernel, 6)
        mine = [q * arb.pi() / 4 + d for q, d in zip(quarter, delta, strict=True)]
        theirs = verifier.gammas(list(kernel.COLUMN["ends"]), 6)
        for a, b in zip(mine, theirs, strict=True):
            assert a.overlaps(b) and a.rel_accuracy_bits() > 280 and b.rel_accuracy_bits() > 250


def written(data: dict[str, Any]) -> dict[str, Any]:
    """M, E, H of a certificate, as the verifier has them."""
    forms = {name: verifier.form(parts) for name, parts in data["forms"].items()}
    return verifier.matrices(data["ends"], data["basis"], data["modes"], forms)


@pytest.mark.parametrize("name", column_names())
def test_matrices_overlap_those_of_exponentials(name: str) -> None:
    """M, E, H of Eq. (11) from the closed forms on balls, against the verifier's integrals of exponentials."""
    kernel = fb.column(name, "modes").kernel
    own = {p["name"]: F(p["default"]) for p in kernel.COLUMN["parameters"]}
    question = Question(4, F(1), own=own)
    stub = Enclosure(question, "none", None, None, F(1), (), {})
    data = certificate.write(kernel, stub)
    with balls.precision(250):
        mine, theirs = balls.matrices(kernel, 4, own), written(data)
        for letter, matrix in zip("MEH", mine, strict=True):
            for i in range(4):
                for j in range(4):
                    assert matrix[i, j].overlaps(theirs[letter][i, j])
                    assert theirs[letter][i, j].rad() < 1e-40


@pytest.mark.parametrize("case", CASES)
def test_the_enclosure_holds_the_load_of_an_mpmath_determinant(case: str) -> None:
    """det(λ² M + λ C + K) or its double root, solved by mpmath's own Newton at twice the digits. Eqs. (24), (25)."""
    question = CASES[case][1]
    found = certified(case)
    kernel = column(case).kernel
    assert found.load is not None and all(found.proof.values())
    low, high = found.load
    assert (high - low) / low < F(1, 10**30)
    with balls.precision(400), mpmath.workdps(70):
        M, E, H = (
            mpmath.matrix([[mpmath.mpf(v.mid().str(80, radius=False)) for v in row] for row in m.tolist()])
            for m in balls.matrices(kernel, question.modes, question.own or {})
        )
        alpha, beta = ((mpmath.mpf(v.numerator) / v.denominator) for v in (question.alpha, question.beta))

        def f(P: Any, s: Any) -> Any:
            return mpmath.det(E + P * H - s * M)

        start = candidate(column(case), question)
        assert start is not None
        if found.kind == "divergence":
            load = mpmath.findroot(lambda P: f(P, 0), start[0])
        elif question.undamped or question.kappa is not None:
            kappa = (
                None if question.kappa is None else mpmath.mpf(question.kappa.numerator) / question.kappa.denominator
            )

            def second(P: Any, s: Any) -> Any:
                slope = mpmath.diff(lambda v: f(P, v), s)
                return slope if kappa is None else P * mpmath.diff(lambda v: f(v, s), P) + (s + kappa) * slope

            scale = f(0, 0)
            load = mpmath.findroot(
                lambda P, s: (f(P, s) / scale, second(P, s) / scale), (start[0], start[1] ** 2), tol=1e-50, maxsteps=30
            )[0]
        else:
            C = alpha * E + beta * M

            def both(P: Any, w: Any) -> tuple[Any, Any]:
                d = mpmath.det(E + P * H - w * w * M + 1j * w * C) / mpmath.det(E)
                return d.real, d.imag / w

            load = mpmath.findroot(both, start, tol=1e-50, maxsteps=30)[0]
        value = F(int(mpmath.floor(load * mpmath.mpf(10) ** 50)), 10**50)
        assert low - F(1, 10**38) < value < high + F(1, 10**38)


@pytest.mark.parametrize("case", ["undamped", "damped", "limit", "beck, dead load"])
def test_enclosures_nest_as_digits_grow(case: str) -> None:
    wide, narrow = certified(case, 20), certified(case, 60)
    assert wide.load is not None and narrow.load is not None
    assert wide.load[0] < narrow.load[0] < narrow.load[1] < wide.load[1]


def test_no_loss_of_stability_is_proven_up_to_a_load() -> None:
    found = first_crossing.certify(fb.column("free-free", "modes").kernel, Question(8), None, 10, load_max=F(100))
    assert found.kind == "none" and found.stretches[-1].end == 100
    with pytest.raises(Unproven, match="not known to be stable"):
        first_crossing.certify(fb.column("free-free", "modes").kernel, Question(8), None, 10, load_max=F(120))


@pytest.mark.parametrize(
    ("name", "question", "near"),
    [
        ("free-free", Question(8), (1604.0, 0.0)),  # a divergence root far above the flutter load
        ("free-free", Question(8), (406.01237265, 50.04628115)),  # another pair that begins to flutter
        ("free-free", Question(8, F("0.001"), F("0.1")), (109.72176, 23.08)),  # the undamped load
        ("free-free", Question(3), (399.0, 0.0)),
        ("beck", Question(8, own={"eta": F("0.4")}), (15.98833175, 0.0)),  # where stability is regained
        ("beck", Question(8, own={"eta": F("0.4")}), (16.45615266, 4.47384517)),  # where it is lost again
    ],
)
def test_a_crossing_that_is_not_the_first_is_refused(name: str, question: Question, near: tuple[float, float]) -> None:
    with pytest.raises(Unproven):
        first_crossing.certify(fb.column(name, "modes").kernel, question, near, 20)


def test_a_refusal_says_what_was_established() -> None:
    """Beck's column regains stability at 15.99: a crossing, but not the first."""
    question = Question(8, own={"eta": F("0.4")})
    with pytest.raises(Unproven, match=r"established is that there is a crossing, of divergence, at 15\.98833175"):
        first_crossing.certify(fb.column("beck", "modes").kernel, question, (15.98833175, 0.0), 20)


@pytest.mark.parametrize("case", ["undamped", "damped", "beck, dead load"])
def test_stability_is_not_proven_past_the_crossing(case: str) -> None:
    """The last stretch, moved up by 1e-20 of the load, reaches beyond the loss of stability: no signs prove that."""
    name, question = CASES[case]
    found = certified(case)
    kernel = fb.column(name, "modes").kernel
    last = found.stretches[-1]
    with balls.precision(600):
        polynomials = boundary(kernel, question, 600)
        assert first_crossing.holds(polynomials, last)
        beyond = Stretch(last.start, last.end * (1 + F(1, 10**20)), last.origin, last.separators)
        assert not first_crossing.holds(polynomials, beyond)


def test_balls_blown_up_yield_no_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = balls.matrices

    def blown(*arguments: Any) -> Any:
        return tuple(m * arb(1, 1e-3) for m in exact(*arguments))

    monkeypatch.setattr(balls, "matrices", blown)
    monkeypatch.setattr(first_crossing, "MOST_BITS", 2000)
    with pytest.raises(Unproven):
        first_crossing.certify(fb.column("beck", "modes").kernel, Question(5), (20.05, 11.0), 20)


@settings(derandomize=True, deadline=None, max_examples=15)
@given(
    name=st.sampled_from(column_names()),
    basis=st.sampled_from(["modes", "legendre"]),
    modes=st.integers(1, 6),
    alpha=st.one_of(st.just(0.0), st.floats(-6, 1).map(lambda p: 10**p)),
    beta=st.one_of(st.just(0.0), st.floats(-3, 2).map(lambda p: 10**p)),
)
def test_the_runtimes_load_lies_in_the_certified_interval(
    name: str, basis: str, modes: int, alpha: float, beta: float
) -> None:
    question = Question(modes, F(alpha), F(beta))
    near = candidate(fb.column(name, basis), question)
    if near is None:
        return
    found = first_crossing.certify(fb.column(name, basis).kernel, question, near, 12)
    assert found.load is not None
    assert math.isclose(near[0], float(found.load[0]), rel_tol=1e-9)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_coordinates_without_mass_decay_where_all_roots_are_on_the_left(count: int) -> None:
    """det(μ + A) = 0 by Routh's scheme of the prover and Hurwitz's determinants of the verifier, beside NumPy."""
    draw, seen = np.random.default_rng(count), {True: 0, False: 0}
    one = fmpq_mat([[int(i == j) for j in range(count)] for i in range(count)])
    for _ in range(40):
        A = draw.integers(-3, 4, (count, count)) + np.diag(draw.integers(0, 5, count))
        roots = np.linalg.eigvals(-A)
        if min(abs(roots.real)) < 1e-6:
            continue
        scale = int(draw.choice([-2, 1, 3]))  # of the whole, whose sign is not known
        fast = tuple(arb_poly([scale * round(c)]) for c in np.poly(-A)[::-1])
        with precision(128):
            for decays in (
                lambda fast=fast: check_fast(SimpleNamespace(fast=fast), Fraction(1)),  # type: ignore[arg-type]
                lambda A=A: Fast([one], [fmpq_mat(A.tolist())], count).decay(Fraction(1)),
            ):
                if roots.real.max() < 0:
                    decays()
                else:
                    with pytest.raises((Unproven, Refused), match="without mass"):
                        decays()
        seen[bool(roots.real.max() < 0)] += 1
    assert min(seen.values()) > 3


@pytest.mark.parametrize("least, decays", [("0.1", True), ("-0.1", False)])
def test_coordinates_without_mass_decay_at_each_load(least: str, decays: bool) -> None:
    """μ + (P − 1/2)² + c: a ball of all loads holds roots that none of them has, and halves of it do not."""
    with precision(128):
        c = arb(least) + arb(1) / 4
        found: Any = SimpleNamespace(fast=(arb_poly([c, -1, 1]), arb_poly([1])))
        assert found.fast[0](arb("0.5", "0.5")).contains(0)
        if decays:
            check_fast(found, Fraction(1))
        else:
            with pytest.raises(Unproven, match="without mass"):
                check_fast(found, Fraction(1))


@pytest.mark.parametrize("name", column_names())
def test_polynomials_span_what_the_verifiers_span(name: str) -> None:
    """det(E + P H − s M) / det M in the kernel's basis and in the verifier's null space of conditions."""
    kernel = fb.column(name, "legendre").kernel
    question = Question(5, own={p["name"]: F(p["default"]) for p in kernel.COLUMN["parameters"]})
    data = certificate.write(kernel, Enclosure(question, "none", None, None, F(1), (), {}))
    with balls.precision(400):
        M, E, H = balls.matrices(kernel, 5, question.own)
        other = written(data)
        for P, s in ((3, 50), (-7, 2000)):
            mine = (E + P * H - s * M).det() / M.det()
            theirs = (other["E"] + P * other["H"] - s * other["M"]).det() / other["M"].det()
            assert mine.overlaps(theirs) and mine.rel_accuracy_bits() > 300 < theirs.rel_accuracy_bits()


def test_a_factor_that_is_no_fraction_is_not_proven() -> None:
    """A kernel holds the square root of two as a float: what would be proven is of another column."""
    kernel = copy.copy(vars(fb.column("beck", "legendre").kernel))
    rounded = ModuleType("rounded")
    vars(rounded).update(kernel)
    rounded.forms = lambda one=1, **own: {"M": ({(0, 0, 0): 2**0.5}, {})}  # type: ignore[attr-defined]
    with balls.precision(100), pytest.raises(Unproven, match="no fraction"):
        balls.matrices(rounded, 3)
    rounded.forms = lambda one=1, **own: {"M": ({(0, 0, 0): 0.75}, {})}  # type: ignore[attr-defined]
    balls.stated_exactly(rounded, {})  # a float that is a fraction for all that one can tell


@pytest.mark.parametrize("bad", [F(0), F(1, 3), F(2, 3), F(1)])
def test_a_load_at_which_nothing_can_be_shown_is_told_after_bounded_work(
    bad: Fraction, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever it is, as many halvings are tried as are allowed, and the load is named."""
    tried = []

    def stretch_over(found: Any, a: Fraction, b: Fraction, centre: Any) -> str | None:
        tried.append((a, b))
        return None if a <= bad <= b else "shown"

    monkeypatch.setattr(first_crossing, "stretch_over", stretch_over)
    with pytest.raises(Unproven, match="could not be shown between the loads") as error:
        first_crossing.cover(None, F(0), F(1), 20)  # type: ignore[arg-type]
    assert len(tried) <= 2 * 20 + 1 and all(b - a >= F(1, 2**31) for a, b in tried)
    assert math.isclose(float(str(error.value).split()[-1]), float(bad), abs_tol=1e-4)


@pytest.mark.parametrize(("damped", "lasting"), [("", ""), ("ab", ""), ("a", "b"), ("b", "a")])
def test_what_nothing_damps_is_named_beside_what_is_damped(damped: str, lasting: str) -> None:
    found: Any = object.__new__(first_crossing.Enclosure)
    parts = [SimpleNamespace(names=(n,), damped=lambda limit, n=n: n in damped and limit) for n in "ab"]
    for name, value in (("parts", parts), ("question", Question(2, kappa=F(1)))):
        object.__setattr__(found, name, value)
    assert found.lasting == tuple((n,) for n in lasting)
