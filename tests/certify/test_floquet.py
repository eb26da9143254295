"""Monodromy matrices in balls: enclosures of what floats compute, proofs of stability, and what is not proven."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import acb, acb_mat, arb, arb_mat

import freebeam as fb
from freebeam.pulsating.growth import judged
from freebeam.pulsating.monodromy import Pulsating, monodromy
from freebeam_derive.certify import floquet
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.boundary_polynomials import Question
from freebeam_derive.certify.floquet import Motion, Pulsation, decide
from freebeam_sym import question as floats

BECK = fb.column("beck", "legendre")


def enclosed(modes: int, alpha: str, beta: str, pulsation: Pulsation, basis: str = "legendre") -> arb_mat:
    kernel = fb.column("beck", basis).kernel
    with precision(128):
        moving = floquet.motion(kernel, Question(modes, Fraction(alpha), Fraction(beta)), pulsation)
        return moving.monodromy(128)[0]


@pytest.mark.parametrize(("basis", "modes"), [("modes", 3), ("legendre", 4)])
@pytest.mark.parametrize("frequency", ["5", "25/2"])
@pytest.mark.parametrize("amplitude", ["0", "1/3", "3/2"])
def test_the_enclosure_is_narrow_and_holds_the_multipliers(
    basis: str, modes: int, frequency: str, amplitude: str
) -> None:
    """The runtime's own coordinates have other signs of the modes, so that multipliers are compared."""
    pulsation = Pulsation(Fraction(12), Fraction(amplitude), Fraction(frequency))
    U = enclosed(modes, "1/100000", "1/10", pulsation, basis)
    assert max(x.rad() for x in U.entries()) < arb("1e-25")
    question = floats.Question.of(fb.column("beck", basis), modes, 1e-5, 0.1)
    V, logarithm = monodromy(
        Pulsating.of(question), 12.0, float(Fraction(frequency)), np.array([float(Fraction(amplitude))])
    )
    ours = np.linalg.eigvals(V[0] * math.exp(logarithm[0]))
    with precision(128):
        exact = [complex(value) for value in acb_mat(U).eig()]
    for value in exact:
        assert np.abs(ours - value).min() < 1e-10


def test_a_constant_load_is_the_exponential() -> None:
    pulsation = Pulsation(Fraction(12), Fraction(0), Fraction(7))
    with precision(128):
        moving = floquet.motion(BECK.kernel, Question(4, Fraction(0), Fraction(1, 10)), pulsation)
        U, _ = moving.monodromy(128)
        expected = (moving.terms[0] * (2 * arb.pi() / 7)).exp()
    assert all(a.overlaps(b) for a, b in zip(U.entries(), expected.entries(), strict=True))


def test_the_determinant_is_liouvilles() -> None:
    U = enclosed(3, "1/100", "1/10", Pulsation(Fraction(12), Fraction(1, 2), Fraction(9)))
    with precision(128):
        moving = floquet.motion(
            BECK.kernel,
            Question(3, Fraction(1, 100), Fraction(1, 10)),
            Pulsation(Fraction(0), Fraction(0), Fraction(9)),
        )
        assert U.det().overlaps((moving.terms[0].trace() * 2 * arb.pi() / 9).exp())


def test_loads_of_any_degree() -> None:
    """Ẍ + (1 + a P + b P²) X = 0: cos² enters, and the enclosure holds what floats compute."""
    one, a, b, c = (arb_mat([[x]]) for x in (arb(1), arb(0.5), arb(0.25), arb(0.125)))
    pulsation = Pulsation(Fraction(2), Fraction(1, 2), Fraction(3))
    with precision(128):
        U, _ = Motion(one, [c, c], [one, a, b], pulsation).monodromy(128)
    problem = Pulsating(*([np.array([[float(x[0, 0].mid())]]) for x in part] for part in ([one], [c, c], [one, a, b])))
    V, logarithm = monodromy(problem, 2.0, 3.0, np.array([0.5]))
    floating = V[0] * math.exp(logarithm[0])
    for k in range(4):
        assert (
            abs(float(U.entries()[k].mid()) - abs(floating.ravel()[k]) * np.sign(float(U.entries()[k].mid()))) < 1e-11
        )


def test_remainders_cover_what_is_left_out() -> None:
    """At a coarse tolerance the balls are wide, and hold those of a fine one."""
    pulsation = Pulsation(Fraction(12), Fraction(1, 2), Fraction(9))
    with precision(200):
        moving = floquet.motion(BECK.kernel, Question(2, Fraction(0), Fraction(1, 10)), pulsation)
        fine, _ = moving.monodromy(200)
        for bits in (30, 60, 90):
            coarse, _ = moving.monodromy(bits)
            assert all(a.contains(b) for a, b in zip(coarse.entries(), fine.entries(), strict=True))
            assert max(x.rad() for x in coarse.entries()) > 1e10 * max(x.rad() for x in fine.entries())


def test_a_step_takes_hardly_more_terms_than_its_exponential_needs() -> None:
    """‖B‖h < 16: the exponential alone takes the m for which 16^m/m! falls below the tolerance."""
    with precision(128):
        pulsation = Pulsation(Fraction(12), Fraction(1, 2), Fraction(9))
        moving = floquet.motion(BECK.kernel, Question(4, Fraction(0), Fraction(1, 10)), pulsation)
        h = floquet.REACH / sum(moving.norms, arb(0))
        least = next(m for m in range(1, 1000) if arb(floquet.REACH) ** m / arb(m + 1).gamma() < arb(2) ** -128)
        assert least < moving._rest(h, arb(9), 128)[1] < 2 * least


@pytest.mark.parametrize(
    ("frequency", "amplitude", "kind"), [(5, "3/10", "stable"), (12, "3/10", "unstable"), (12, "1/50", "stable")]
)
def test_what_is_proven_is_what_floats_find(frequency: int, amplitude: str, kind: str) -> None:
    found = fb.certified_pulse(BECK, 4, "1e-3", "0.1", load=12, frequency=frequency, amplitude=amplitude)
    assert found.kind == kind
    question = floats.Question.of(BECK, 4, 1e-3, 0.1)
    (growth,) = judged(Pulsating.of(question), 12.0, float(frequency), np.array([float(Fraction(amplitude))])).growth
    low, high = found.growth
    assert low is not None and float(low) - 1e-10 <= growth <= float(high) + 1e-10
    assert float(high) - float(low) < 1e-4 * abs(growth)
    assert (growth > 0) == (kind == "unstable") and (float(high) < 0) == (kind == "stable")
    assert found.inputs["amplitude"] == amplitude and found.inputs["frequency"] == str(frequency)


def test_stability_is_not_proven_when_the_damping_is_taken_away() -> None:
    given = {"load": 12, "frequency": 5, "amplitude": "0.1"}
    assert fb.certified_pulse(BECK, 3, 0, "1e-4", **given).kind == "stable"
    with pytest.raises(fb.InputError, match="without damping none can be proven to die out"):
        fb.certified_pulse(BECK, 3, **given)


def test_what_a_step_is_bounded_by_is_the_integral_of_its_norms() -> None:
    """∫ ‖B₁‖ e^(Ωτ) + ‖B₂‖ e^(2Ωτ) dτ by Gauss's nodes."""
    them: Any = object.__new__(Motion)
    them.norms = [arb(7), arb(3), arb(5)]
    nodes, weights = np.polynomial.legendre.leggauss(20)
    for r, omega in ((0.5, 3.0), (2.0, 0.5)):
        tau = r * (nodes + 1) / 2
        wanted = r / 2 * (weights @ (3 * np.exp(omega * tau) + 5 * np.exp(2 * omega * tau)))
        assert float(them._majorant(arb(r), arb(omega))) == pytest.approx(wanted, rel=1e-12)


def test_growth_is_proven_without_damping() -> None:
    found = fb.certified_pulse(BECK, 3, load=12, frequency=12, amplitude="0.3")
    assert found.kind == "unstable" and found.growth[0] is not None and float(found.growth[0]) > 0.4


def test_powers_decide_by_the_largest_multiplier() -> None:
    """Of a matrix far from normal, and of a rotation, whose multipliers lie on the circle."""
    with precision(128):
        for size, kind in (("0.999", "stable"), ("1.001", "unstable")):
            m = arb(size)
            found = decide(arb_mat([[m, arb(1000)], [arb(0), m]]))
            assert found is not None and found[0] == kind
            low, high = found[1]
            assert low is not None and low <= m.log() <= high
        turn = acb(0, 1).exp()
        assert decide(arb_mat([[turn.real, -turn.imag], [turn.imag, turn.real]])) is None


def test_what_no_verdict_is_of_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mass that is not definite or hangs on the load; multipliers too near the circle, with as many bits as there
    are tried, or on it, without damping."""
    one, pulsation = arb_mat([[1]]), Pulsation(Fraction(1), Fraction(0), Fraction(5))
    with pytest.raises(Unproven, match="mass matrix is not positive definite"):
        Motion(-1 * one, [], [one], pulsation)
    question = Question(2, Fraction(0), Fraction(1, 10))
    monkeypatch.setattr(floquet, "decide", lambda U: None)
    tried = []
    exact = Motion.monodromy
    monkeypatch.setattr(Motion, "monodromy", lambda self, bits: tried.append(bits) or exact(self, 128))
    with pytest.raises(Unproven, match="too near the unit circle"):
        floquet.prove(BECK.kernel, question, pulsation)
    assert tried == [128, 256, 512, 1024]
    with pytest.raises(Unproven, match="without damping none can be proven to die out"):
        floquet.prove(BECK.kernel, Question(2, Fraction(0), Fraction(0)), pulsation)
    monkeypatch.setattr(floquet, "coefficients", lambda *_: ([one, one], [], [one]))
    with pytest.raises(Unproven, match="its mass hangs on the load"):
        floquet.motion(BECK.kernel, question, pulsation)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"frequency": 0}, "frequency = 0.0: must be greater than zero"),
        ({"amplitude": "-1/2"}, "amplitude = -0.5: must be zero or greater"),
        ({"amplitude": "x"}, "amplitude = 'x': must be a finite number"),
        ({"frequency": "1e-300"}, "a period takes more than"),
        ({"load": 1e300}, "a period takes more than"),
    ],
)
def test_what_makes_no_sense_is_refused(given: dict, message: str) -> None:
    with pytest.raises(fb.InputError, match=message):
        fb.certified_pulse(BECK, 2, 0, "0.1", **{"load": 12, "frequency": 5, "amplitude": "0.1", **given})
