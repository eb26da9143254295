"""The references themselves: each listed value by two routes, and laws that hold for either of them."""

from dataclasses import replace
from fractions import Fraction as Q

import numpy as np
import pytest
from mpmath import mp, mpc, mpf, workdps

from tests.reference import discrete, elements, transfer
from tests.reference.systems import At, Beam, Segment, Term, energy
from tests.reference.values import BECK, ISSUE, OWN, PRESSED, TIP, Value, beal, beck, constant, split, timoshenko

TWO_ROUTES = pytest.mark.parametrize("value", ISSUE + OWN, ids=lambda value: value.name)


@TWO_ROUTES
def test_each_value_by_elements_then_by_taylor_steps(value: Value) -> None:
    """A scan of elements finds the first loss to their error; from there the exact system gives all digits printed."""
    found = elements.first_loss(value.beam, 1.1 * float(value.printed))
    assert found is not None
    assert found.kind == ("divergence" if value.kind == "divergence" else "flutter")
    assert found.load == pytest.approx(float(value.printed), rel=3e-5)
    if value.kind == "divergence":
        load = transfer.divergence(value.beam, found.load)
    elif value.kind == "flutter":
        assert value.beam.damped
        load, _ = transfer.flutter(value.beam, found.omega, found.load)
    else:
        assert not value.beam.damped
        load, _ = transfer.coalescence(value.beam, found.omega, found.load)
    with workdps(transfer.DIGITS):
        assert abs(load - mpf(value.printed)) <= mpf("0.5") * mpf(10) ** -value.places


def test_zieglers_pendulum() -> None:
    assert discrete.undamped() == pytest.approx(3.5 - np.sqrt(2), rel=1e-14)
    assert discrete.slight_damping() == Q(41, 28)


@pytest.mark.parametrize("name", ["beck", "pipe", "panel, clamped", "foundation", "rayleigh", "euler, clamped"])
def test_taylor_steps_are_the_matrix_exponential(name: str) -> None:
    value = next(v for v in ISSUE + OWN if v.name == name)
    agree(value.beam, mpc(0.3, 7), mpf("0.8") * mpf(value.printed))


@pytest.mark.parametrize("sees", ["slope", "dy"])
def test_timoshenkos_beam_by_the_matrix_exponential(sees: str) -> None:
    agree(timoshenko(Q(100), Q(1, 100), sees), mpc(0.3, 7), mpf(14))


def agree(beam: Beam, lam: mpc, P: mpf) -> None:
    with workdps(transfer.DIGITS):
        steps = transfer.equation(beam, lam, P)
        assert abs(steps - transfer.exponential(beam, lam, P)) < mpf("1e-30") * abs(steps)


@pytest.mark.parametrize("load", [0.0, 4.0, 8.0])
def test_elements_converge_with_the_fourth_order(load: float) -> None:
    """Second ω² of a column with a step, a mass and a crack, next to the root of the exact F."""
    crack, place = At("jump slope", Q(2, 5)), Q(3, 5)
    beam = split(
        place,
        *energy([(crack, 1)], spring=Q(10)),
        *energy([(At("y", place), 1)], Q(1, 3)),
        right={"EI": constant(Q(1, 2))},
    )
    fine = elements.lowest(elements.assemble(beam, 80), load, 2)[1]
    with workdps(30):
        exact = float(-mp.findroot(lambda s: transfer.of_square(beam, s, mpf(load)), (-fine, -fine * 1.0001)))
    errors = [elements.lowest(elements.assemble(beam, n), load, 2)[1] - exact for n in (5, 10, 20)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx(4, abs=0.2)


def test_a_break_and_an_empty_place_change_nothing() -> None:
    cut = split(Q(1, 3), Term(At("y", Q(3, 4)), At("slope", Q(1, 8))))
    with workdps(transfer.DIGITS):
        lam, P = mpc(0.1, 9), mpf(18)
        whole, parts = transfer.equation(BECK, lam, P), transfer.equation(cut, lam, P)
        assert min(abs(whole - parts), abs(whole + parts)) < mpf("1e-35") * abs(whole)  # an added row may turn the sign


def test_a_stiff_joint_is_none() -> None:
    """The load nears Beck's as 1/k."""
    beck_load = mpf(OWN[0].printed)
    for kind in ("jump slope", "jump y"):
        off = []
        for k in (10**5, 10**6):
            joint = beck(*energy([(At(kind, Q(1, 2)), 1)], spring=Q(k)))
            off.append(transfer.coalescence(joint, 11.01, 20.05)[0] - beck_load)
        assert off[0] / off[1] == pytest.approx(10, rel=0.01)


def test_stiff_in_shear_and_light_in_rotation_is_beck() -> None:
    """The load nears Beck's as 1/s, and Rayleigh's where the rotary inertia stays."""
    rayleigh = mpf(next(v.printed for v in ISSUE if v.name == "rayleigh"))
    for r, limit, omega in ((Q(0), mpf(OWN[0].printed), 11.01), (Q(1, 100), rayleigh, 10.0)):
        off = [transfer.coalescence(timoshenko(Q(s), r, "slope"), omega, limit)[0] - limit for s in (10**5, 10**6)]
        assert off[0] / off[1] == pytest.approx(10, rel=0.01)


def test_a_thrust_that_turns_with_the_slope_or_with_psi_gives_one_spectrum() -> None:
    """S − P(y' or ψ) at the tip is s(y' − ψ) or (s − P)(y' − ψ): the equations differ by the factor (s − P)/s."""
    s, P, lam = Q(100), mpf(14), mpc(0.2, 8)
    with workdps(transfer.DIGITS):
        psi, slope = (transfer.equation(timoshenko(s, Q(1, 100), sees), lam, P) for sees in ("slope", "dy"))
        assert abs(psi / slope - (100 - P) / 100) < mpf("1e-35")


def test_the_only_damper_does_not_change_the_load() -> None:
    """F(iω) = F₀ + iωc F₁ with real F₀ and F₁: both vanish, whatever c is."""
    loads = [transfer.flutter(beck(*energy([(TIP, 1)], damping=c)), 7.06, 16.05)[0] for c in (Q(1, 100), Q(3))]
    assert abs(loads[0] - loads[1]) < 1e-20


def test_beals_divergence_is_first_wherever_the_sensor_is() -> None:
    loads = [elements.first_loss(beal(Q(n, 10)), 30) for n in range(11)]
    assert all(found.kind == "divergence" for found in loads)
    assert np.array([found.load for found in loads]) == pytest.approx(25.6381813768, rel=1e-5)


def test_a_coordinate_held_stiffly_is_a_mass() -> None:
    """With a spring k between them, beam and coordinate move together as k grows: the difference falls as 1/k."""
    mass, place, q = Q(1, 2), Q(1, 2), At("q")
    bound = next(mpf(v.printed) for v in ISSUE if v.name == "mass at mid-span")
    off = []
    for k in (10**5, 10**6):
        spring = energy([(At("y", place), 1), (q, -1)], spring=Q(k))
        off.append(transfer.coalescence(beck(*energy([(q, 1)], mass), *spring), 9.278, bound)[0] - bound)
    assert off[0] / off[1] == pytest.approx(10, rel=0.01)


def test_elements_of_timoshenkos_beam_have_no_places_inside() -> None:
    beam = Beam((replace(PRESSED, high=Q(1, 2)), Segment(low=Q(1, 2))), shear=Q(100))
    with pytest.raises(ValueError, match="no break or place inside"):
        elements.assemble(beam)
