"""Shafts that turn, with internal damping alone, as they see themselves: both planes are lost at λ = 0 at once.

Against the same as seen from rest, where a whirl crosses at its frequency, closed forms, and forged certificates.
"""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq, fmpq_mat

import freebeam as fb
from freebeam_derive.certify import pair_at_rest, verifier, verifier_lists, verifier_loads
from freebeam_derive.certify.balls import Unproven, precision
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.one_load import zeros_twice
from freebeam_derive.certify.parts import Part
from tests.runtime.test_rotors import HEAD, STATED, column

F = Fraction


@cache
def found(name: str, modes: int) -> fb.Certified:
    return fb.certified_load(column(name), modes, alpha="1/100", digits=12)


@cache
def listed(name: str, modes: int, load_max: int) -> fb.CertifiedCrossings:
    return fb.certified_crossings(column(name), modes, alpha="1/100", load_max=load_max, digits=10)


def copied(certificate: Any) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(json.dumps(certificate))
    return data


def overlap(one: Any, other: Any) -> bool:
    return max(F(one[0]), F(other[0])) < min(F(one[1]), F(other[1]))


@pytest.mark.parametrize(("own", "rest", "modes"), [("turning disc", "disc", 1), ("turning shaft", "shaft", 3)])
def test_a_shaft_is_proven_to_be_lost_at_rest_in_its_own_frame(own: str, rest: str, modes: int) -> None:
    """Seen from rest its whirl is as fast as the shaft turns."""
    lost, whirling = found(own, modes), found(rest, modes)
    assert all(lost.proof.values()) and (lost.kind, lost.frequency) == ("flutter", ("0", "0"))
    assert overlap(lost.load, whirling.load) and overlap(whirling.load, whirling.frequency)
    said = verifier.verify(copied(lost.unverified))
    assert said.frequency == (0, 0) and overlap(said.load, lost.load)
    assert "where a pair of eigenvalues leaves zero" in str(said) and said.record()["frequency_upper"] == "0"


def test_each_mode_of_a_shaft_is_lost_at_its_own_critical_speed() -> None:
    own, rest = (listed(name, 3, 60) for name in ("turning shaft", "shaft"))
    assert len(own) == len(rest) == 2
    for one, other in zip(own, rest, strict=True):
        assert overlap(one.load, other.load) and one.frequency == ("0", "0")
        assert one.unstable_above == other.unstable_above
    passings = verifier_lists.verify(copied(own.unverified)).passings
    assert [p.unstable + p.change for p in passings] == [2, 4]
    assert all(p.square == (0, 0) and "leaves zero" in str(p) for p in passings)


@pytest.mark.parametrize(("own", "critical"), [("turning disc", 2.0), ("turning shaft", np.pi**2)])
def test_of_the_beam_itself_too_a_pair_leaves_zero_at_the_critical_speed(own: str, critical: float) -> None:
    found = fb.exact_load(column(own), alpha="1/100", digits=12)
    assert (found.kind, found.frequency) == ("flutter", ("0", "0")) and found.proof["crossing"] and found.proof["kind"]
    assert found.load is not None and float(found.load[0]) == pytest.approx(critical, rel=1e-11)
    assert found.proof["first"] == (own == "turning disc")  # of coordinates alone a series is the rotor itself
    assert bool(found.missing) == (own == "turning shaft")


def test_a_pair_leaves_zero_at_the_speed_of_the_closed_form() -> None:
    """Of Jeffcott's rotor λ² + (α + 2iP) λ + k − P² = 0, so that dλ/dP = 2P / (α + 2iP) at λ = 0."""
    system = ExactSystem(column("turning disc").kernel, {"k": F(4)}, F(1, 10), F(0))
    with precision(100):
        t = system.taylor(arb(2), arb(0), pair_at_rest.SECOND)
        speed = (t[1, 1] / (2 * t[0, 2]), (4 * t[2, 0] * t[0, 2] - t[1, 1] ** 2).sqrt() / (2 * t[0, 2]))
    slope = 4 / complex(0.1, 4)
    assert [float(v) for v in speed] == pytest.approx([slope.real, abs(slope.imag)], rel=1e-12)


@pytest.mark.parametrize(("beta", "change"), [("1/10", ""), ("0", "y.diff(x, 2) ** 2")])
def test_planes_that_are_not_alike_at_rest_are_refused_with_the_reason(tmp_path: Path, beta: str, change: str) -> None:
    """External damping acts on displacements there and couples them; a stiffer plane is another one."""
    text = (HEAD + STATED["turning shaft"]).replace("V = integral(", f"V = integral({change or 0} + ")
    (tmp_path / "unlike.py").write_text(text)
    system = ExactSystem(fb.column(str(tmp_path / "unlike.py")).kernel, {}, F(1, 100), F(beta))
    with pytest.raises(Unproven, match="not two planes alike at rest"):
        pair_at_rest.flutter(system, np.pi**2, 8)


def test_a_shaft_without_damping_is_not_lost_at_its_critical_speeds() -> None:
    """As it sees itself its frequencies are ω_k + P and ω_k − P: at P = ω_k one is zero, and no motion ever grows. The
    rates that couple its planes grow with the load, so that no frame that turns at one rate rids it of them."""
    for most in (8, 12):  # below the first critical speed, 10.95 of two functions, and above
        assert not fb.certified_crossings(column("turning shaft"), 2, load_max=most, digits=8)
        found = fb.certified_load(column("turning shaft"), 2, load_max=most, digits=8)
        assert found.kind == "none" and verifier.verify(copied(found.unverified)).end == most
    for load in (10.0, 10.9, 11.0, 11.9):
        M, C, K = column("turning shaft").coefficients(2).at(load)
        one, none = np.eye(len(K)), 0 * K
        values = np.linalg.eigvals(np.block([[none, one], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]]))
        assert abs(values.real).max() < 1e-6 * abs(values).max()


@pytest.mark.parametrize("load_max", [5, 12, 1000])
def test_a_frame_is_faster_than_a_whirl_at_the_highest_load(load_max: int) -> None:
    """ω = 2 + P and 2 − P: nothing is lost at any load."""
    found = fb.certified_crossings(column("turning disc"), 2, load_max=load_max, digits=8)
    assert not found and verifier_lists.verify(copied(found.unverified)).load_max == load_max


def test_forged_pairs_at_rest_are_refused() -> None:
    data = copied(found("turning disc", 1).unverified)

    def refused(match: str, **changed: Any) -> None:
        with pytest.raises(verifier.Refused, match=match):
            verifier.verify(data | changed)

    low, high = map(F, data["load"])
    refused("det K does not fall", kind="divergence", frequency_squared=None)
    refused("det K may vanish", frequency_squared=["1/1000000", "1"])
    refused("not positive", frequency_squared=["0", "1"])
    for moved in (low - high, high - low):
        refused("not shown up to the load|not known to rest", load=[str(low + moved), str(high + moved)])
    refused("separated", alpha="-1/100")
    refused("separators", alpha="0")
    for changed, why in (("1e-20", "not known to rest"), ("-1e-20", "not known to rest")):  # the planes differ
        forms = copy.deepcopy(data["forms"])
        point = next(v for v in forms["K"][0]["points"] if v[0][0] == v[1][0] == "p")
        point[2] = str(F(point[2]) + F(changed))
        refused(why, forms=forms)
    forms = copy.deepcopy(data["forms"])
    for one, other, force in (("p", "q", "1e-30"), ("q", "p", "-1e-30")):
        forms["K"][0]["points"].append([[one, 0, None, 0], [other, 0, None, 0], force])
    refused("not symmetric", forms=forms)  # a force across moves the loss off zero
    beck = copied(fb.certified_load(fb.column("beck", "legendre"), 2, alpha="1/10", digits=8).unverified)
    for other, why in ((beck, "not positive"), (copied(found("disc", 1).unverified), "not symmetric")):
        with pytest.raises(verifier.Refused, match=why):
            verifier.verify(other | {"frequency_squared": ["0", "0"]})
    of_list = copied(listed("turning shaft", 3, 60).unverified)
    for changed in ({"frequency_squared": None, "kind": "divergence"}, {"frequency_squared": ["1/100", "1"]}):
        crossings = [[crossing | changed for crossing in of] for of in of_list["crossings"]]
        with pytest.raises(verifier.Refused):
            verifier_lists.verify(of_list | {"crossings": crossings})


def matrices(*rows: list[list[int]]) -> list[Any]:
    return [np.array([[fmpq(v) for v in row] for row in X], dtype=object) for X in rows]


@pytest.mark.parametrize(
    ("K", "loads"),
    [
        (matrices([[4, 0], [0, 4]], [[0, 0], [0, 0]], [[-1, 0], [0, -1]]), [2]),  # two motions rest at 2
        (matrices([[4, 0], [0, 9]], [[0, 0], [0, 0]], [[-1, 0], [0, -1]]), []),  # one at 2 and one at 3
        (matrices([[4, 0], [0, 1]], [[-4, 0], [0, 0]], [[1, 0], [0, 0]]), []),  # one touches zero at 2
        (matrices([[2, 1], [0, 2]], [[-1, 0], [0, -1]]), []),  # at 2 one rests, and no other
    ],
)
def test_a_double_root_of_det_K_is_two_motions_at_rest_where_K_is_symmetric_and_falls(
    K: list[Any], loads: list[int]
) -> None:
    M, C = matrices([[1, 0], [0, 1]]), matrices([[1, 0], [0, 1]])
    told = zeros_twice(Part(("p", "q"), M, C, K, whole=K))
    assert [float(P) for P in told] == pytest.approx(loads)
    given = [[fmpq_mat(X.tolist()) for X in of] for of in (M, C, K)]
    if loads:
        assert verifier_loads.check_pair_at_rest(given, given[2], F(1), F(3)).contains(2)
        with pytest.raises(verifier.Refused, match="not known to rest"):
            verifier_loads.check_pair_at_rest(given, given[2], F(3), F(4))
        return
    with pytest.raises(verifier.Refused):
        verifier_loads.check_pair_at_rest(given, given[2], F(1), F(5, 2))
