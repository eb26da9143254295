"""Limits of vanishing damping where gyroscopic terms stay, or the damping acts on displacements: proven and verified.

Against closed forms, and roots of the determinant at so little damping that its square is below all digits.
"""

from __future__ import annotations

import json
import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from mpmath import det, findroot, matrix, mpc, mpf, workdps

import freebeam as fb
from freebeam_derive.certify import verifier, verifier_lists
from tests.runtime.test_rotors import STATED, column

STATED["unlike turning beck"] = (
    STATED["turning beck"]
    .replace("bent(y) ** 2 + bent(z) ** 2", "bent(y) ** 2 + 3 * bent(z) ** 2 / 2")
    .replace("turning-beck", "unlike-turning-beck")
)
STATED["pinned pipe"] = """
from sympy import sqrt
column = Column(
    "pinned-pipe", "a pipe held at both ends", integral(y.diff(t) ** 2) / 2, integral(bent(y) ** 2) / 2,
    P**2 * integral(y.diff(x) ** 2) / 2,
    -integral(alpha * bent(y).diff(t) * delta(bent(y)) + 2 * sqrt(2) * P * y.diff(x, t) * delta(y)),
    ends=("pinned", "pinned"),
)
"""


@cache
def proven(name: str, modes: int, kappa: str, **own: str) -> fb.Certified:
    return fb.certified_load(column(name), modes, kappa=kappa, digits=12, load_max=100, **own)


def copied(data: Any) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(json.dumps(data))
    return found


def between(ends: Any, value: float, relative: float = 1e-11) -> bool:
    low, high = map(float, ends)
    return low - relative * value < value < high + relative * value


@pytest.mark.parametrize(("name", "kappa", "load", "omega"), [("disc", "3", 8, 2), ("turning disc", "3", 8, 6)])
def test_jeffcotts_rotor_is_proven_to_be_lost_at_twice_one_and_kappa(
    name: str, kappa: str, load: float, omega: float
) -> None:
    """ω = 2; in its own frame the whirl that is lost has passed zero on the way."""
    found = proven(name, 1, kappa)
    assert all(found.proof.values()) and between(found.load, load) and between(found.frequency, omega)
    said = verifier.verify(copied(found.unverified))
    assert said.load is not None and between(said.load, load) and between(said.frequency, omega)
    assert ("beside gyroscopic terms" in str(said)) == (name == "turning disc")


def test_each_mode_of_a_shaft_is_lost_at_its_own_speed_and_at_no_other() -> None:
    """ωₙ + κ/ωₙ of the series' own frequencies, two eigenvalues more each time."""
    kappa = 30.0
    M, _, K = column("shaft").coefficients(3)
    squares = np.unique(np.linalg.eigvals(np.linalg.solve(M[0], K[0])).real.round(6))
    wanted = [math.sqrt(w) + kappa / math.sqrt(w) for w in squares]
    found = fb.certified_crossings(column("shaft"), 3, kappa="30", load_max=math.ceil(wanted[-1]), digits=8)
    assert [float(c.load[0]) for c in found] == pytest.approx(wanted, rel=1e-6)
    said = verifier_lists.verify(copied(found.unverified))
    assert [p.unstable + p.change for p in said.passings] == [c.unstable_above for c in found] == [2, 4, 6]


@pytest.mark.parametrize("kappa", ["0", "5"])
def test_a_limit_beside_rates_is_a_root_of_the_determinant_at_little_damping(kappa: str) -> None:
    """Of two planes that are not alike, under a follower force, by determinants at 50 digits."""
    of, given, size = column("unlike turning beck"), float(kappa), mpf("1e-18")
    found = proven("unlike turning beck", 2, kappa)
    assert verifier.verify(copied(found.unverified)).load is not None and found.load is not None
    parts = [of.coefficients(2, **ones) for ones in ({}, {"alpha": 1.0}, {"beta": 1.0})]

    def both(P: mpf, w: mpf) -> tuple[mpf, mpf]:
        shares = 1 - size - given * size, size, given * size
        M, C, K = (matrix(4, 4) for _ in range(3))
        for share, terms in zip(shares, parts, strict=True):
            for total, powers in zip((M, C, K), terms, strict=True):
                for a, X in enumerate(powers):
                    total += share * P**a * matrix(X.tolist())
        value = det(K + mpc(0, w) * C - w**2 * M)
        return value.real, value.imag / size

    with workdps(50):
        start = [mpf(ends[0]) for ends in (found.load, found.frequency)]
        load, omega = findroot(both, tuple(start), tol=mpf(10) ** -30)
    assert between(found.load, float(load)) and between(found.frequency, float(omega))


def test_a_pipe_that_is_held_is_lost_where_it_buckles() -> None:
    """Its gyroscopic terms hold a root of 2, so that M, K and C are balls: u = π of as many functions as see it."""
    found = proven("pinned pipe", 3, "0")
    assert found.kind == "divergence" and all(found.proof.values()) and between(found.load, math.pi, 1e-3)


def test_forged_limits_are_refused() -> None:
    """What is taken from a file, or put in, that the proof needs."""
    file, unlike = copied(proven("disc", 1, "3").unverified), copied(proven("unlike turning beck", 2, "5").unverified)

    def refused(data: dict[str, Any], why: str) -> None:
        with pytest.raises(verifier.Refused, match=why):
            verifier.verify(data)

    for name in ("K_alpha", "C_alpha"):
        empty = [{"along": [], "points": []} for _ in file["forms"][name]]
        refused(file | {"forms": file["forms"] | {name: empty}}, "root of g|separated")
    refused(file | {"forms": {k: v for k, v in file["forms"].items() if k != "K_beta"}}, "the forms are not")
    refused(file | {"kappa": None, "alpha": "1", "beta": "3"}, "the forms are not")
    refused(file | {"kappa": "2"}, "root of g|separated")
    slow = copied(file)
    slow["parts"][0]["frame"]["turn"] = "1"
    refused(slow, "separated|may vanish at")
    unlike["forms"]["C_1"][0] = unlike["forms"]["C_alpha"][0]
    refused(unlike, "C_1 stays")
