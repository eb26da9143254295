"""Certificates of columns with joints, and with loads where no mass is: what the verifier computes, and forgeries.

`python -m tests.certify.test_joint_certificates` proves, verifies and forges those of CASES, in a minute and a half.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, arb
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss

import freebeam as fb
from freebeam_derive.certify import verifier
from freebeam_derive.certify.boundary_polynomials import Question
from freebeam_derive.certify.certificate import _sections
from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.damped_gaps import damped_gaps
from freebeam_derive.certify.load_size import load_size as size_of_prover
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_damping_forms import damped
from freebeam_derive.certify.verifier_load_size import load_size, most, value
from freebeam_derive.certify.verifier_of_sections import FORMATS, Gaps
from freebeam_derive.certify.verifier_pieces import Pieces
from freebeam_derive.certify.verifier_sections import Sections, sections
from freebeam_derive.certify.verifier_waves import Apart
from tests.certify.refusals import try_forgeries
from tests.certify.test_frequency_gaps import frequencies, system
from tests.stated import file_of

Data = dict[str, Any]
BITS = 128
CASES: dict[str, tuple[str, dict[str, str]]] = {
    "crack": ("crack", {"k": "2", "a": "0.5"}),
    "shear": ("shear-joint", {"k": "50", "a": "0.5"}),
    "short": ("crack", {"k": "1", "a": "0.5"}),
    "external damping": ("crack", {"k": "1", "a": "0.5", "beta": "0.3"}),
}


@cache
def column(case: str) -> tuple[Any, Sections]:
    name, own = CASES[case]
    it = system(name, own)
    stated = _sections(it.kernel, Question(1, Fraction(0), Fraction(0), None, dict(it.own)))
    ends = stated["ends"][0], stated["ends"][1]
    return it, sections(ends, tuple(map(Fraction, stated["breaks"])), stated["forms"], stated.get("joints", []))


@cache
def found(case: str) -> Any:
    name, own = CASES[case]
    return fb.exact_load(fb.column(name), digits=4, **own)  # type: ignore[arg-type]


def certificate(case: str) -> Data:
    data: Data = json.loads(json.dumps(found(case).unverified))
    return data


def test_a_certificate_of_a_crack_is_accepted_and_names_it() -> None:
    proven = found("short")
    assert all(proven.proof.values()) and proven.missing == ""
    stated = verifier.verify(certificate("short"), FORMATS)
    assert stated.load[0] < Fraction(proven.load[1]) and Fraction(proven.load[0]) < stated.load[1]
    assert "y' jumps at x = 0.5, held by a spring of 1, clamped at x = 0" in str(stated)
    assert stated.record()["joints"] == ["y' jumps at x = 0.5, held by a spring of 1"]


def test_joints_that_are_none_are_refused() -> None:
    data = _sections(
        column("crack")[0].kernel, Question(1, Fraction(0), Fraction(0), None, dict(column("crack")[0].own))
    )
    breaks, forms = tuple(map(Fraction, data["breaks"])), data["forms"]
    assert data["joints"] == [[1, 1, "2"]]
    for joints, why in (
        ([[1, 1, "0"]], "has no spring"), ([[1, 1, "-2"]], "has no spring"), ([[0, 1, "2"]], "is at an end"),
        ([[2, 1, "2"]], "no such segment"), ([[1, 2, "2"]], "no such segment"), ([[1, 1, "2"]] * 2, "named twice"),
        ([[1, 1, "2"]] * 9, "too many joints"),
    ):  # fmt: skip
        with pytest.raises(Refused, match=why):
            sections(("clamped", "free"), breaks, forms, joints)
    for letter in "MEH":
        acting = forms | {letter: forms[letter] | {"points": [[1, 1, 1, 1, "1"]]}}
        with pytest.raises(Refused, match="acts on what jumps at a joint"):
            sections(("clamped", "free"), breaks, acting, [[1, 1, "2"]])


@pytest.mark.parametrize("case", ["crack", "shear"])
def test_both_functions_have_the_same_zeros(case: str) -> None:
    """Their quotient is one number for all p and s, and is none with the joint a little stiffer."""
    it, of = column(case)
    spread = []
    with flint.ctx.workprec(64):
        for k in (1, Fraction(1001, 1000)):
            F = Pieces(replace(of, joints={place: k * c for place, c in of.joints.items()}))
            quotients = [Box(F, arb(p), arb(s), 0).value(arb(p), arb(s)) / it.taylor(arb(p), arb(s), ((0, 0),))[0, 0]
                         for p, s in ((1.5, 5), (2, 9))]  # fmt: skip
            spread.append(abs(float(quotients[1] / quotients[0] - 1)))
    assert spread[0] < 1e-12 < 1e-6 < spread[1]


def test_a_series_that_is_ready_serves_all_that_is_within_it() -> None:
    """And no more: another one is made beyond, which has the same values."""
    _, of = column("crack")
    with flint.ctx.workprec(64):
        F, p, s = Pieces(of), arb(3), arb(40)
        F.ready(p, s)
        (whole,) = F._known.values()
        assert F.on(p, s) is whole is F.on(p / 2, s / 3) is F.at(p, s - 1, 0)
        assert whole.P >= p and whole.S >= s and whole.P < 3.001 and whole.S < 40.001
        assert F.on(2 * p, s) is not whole is not F.at(p, 2 * s, 0)
        values = (Box(of_p, arb(1), arb(9), 0).value(arb(1), arb(9)) for of_p in (F, Pieces(of)))
        assert next(values).overlaps(next(values))


@pytest.mark.parametrize("case", ["crack", "shear"])
def test_waves_vanish_at_frequencies_up_to_the_rest(case: str) -> None:
    """f is known up to the rest, and is nothing at each frequency; between two it is not."""
    it, of = column(case)
    omega = frequencies(it, 14)[6:]

    def waves(g: float) -> float:
        total = acb(0)
        for wave, (B,) in apart.stages[-1].items():
            turn = sum((s * L for s, L in zip(wave, apart.lengths, strict=True)), arb(0))
            total += B(1 / arb(g)) * acb(0, turn.mid() * g).exp()
        return float(total.real)

    with flint.ctx.workprec(BITS):
        apart = Apart(of)
        rests = [apart.rest(arb(g), arb(0)) for g in np.sqrt(omega)]
        for g, after, rest in zip(np.sqrt(omega), np.sqrt(omega)[1:], rests, strict=False):
            assert rest is not None
            slope = abs(waves(g + 1e-4) - waves(g - 1e-4)) / 2e-4
            assert abs(waves(g)) <= float(rest) + 1e-6 * slope < abs(waves((g + after) / 2)) / 10


@pytest.mark.parametrize(("order", "where"), [*product((0, 1), ("jump", "end", "middle"))])
def test_a_value_at_a_place_is_below_its_bound_and_not_far(order: int, where: str) -> None:
    """The largest of polynomials with ‖w''‖²/u² + ‖w‖²/v² = 1. In the middle both parts hold it, which the bound uses
    in part alone."""
    _, of = column("crack")
    basis = [Polynomial.basis(n, domain=[0, 1], window=[-1, 1]) for n in range(12)]
    x, weight = leggauss(20)
    gram: dict[tuple[int, int], Any] = {}
    for part, d in product((0, 1), (0, 2)):
        points = np.array([f.deriv(d)((part + (x + 1) / 2) / 2) if d else f((part + (x + 1) / 2) / 2) for f in basis])
        gram[part, d] = points * weight / 4 @ points.T
    place = 1.0 if where == "end" else 0.5
    at = np.array([f.deriv(order)(place) if order else f(place) for f in basis])
    for u, v in ((30.0, 1.0), (300.0, 2.0)):
        sides = [gram[part, 2] / u**2 + gram[part, 0] / v**2 for part in (0, 1)]
        largest = sum(at @ np.linalg.solve(S, at) for S in (sides if where == "jump" else [sides[0] + sides[1]])) ** 0.5
        with flint.ctx.workprec(BITS):
            factors = {1: Fraction(1), -1: Fraction(-1)} if where == "jump" else {0: Fraction(1)}
            bound = float(most(value(of, (2 if where == "end" else 1, order), factors), arb(u), arb(v)))
        assert largest * (1 - 1e-6) <= bound < (3 if where == "middle" else 2) * largest


def test_a_joint_is_served_with_external_damping_alone() -> None:
    it, of = column("crack")
    unused: Any = None
    with flint.ctx.workprec(64), pytest.raises(NoStrips, match=r"has a joint.* other than external damping alone"):
        damped_gaps(it, arb(5), Fraction(1, 100), Fraction(1, 10), False)
    form = _sections(it.kernel, Question(1, Fraction(0), Fraction(0), None, dict(it.own)))["forms"]["M"]
    for factor, alike in (("3", True), ("4", False)):  # the mass of both parts times 3, or of one times 4
        along = [[*form["along"][0][:-1], "3"], [*form["along"][1][:-1], factor]]
        with flint.ctx.workprec(64):
            given = damped({"form": form | {"along": along}, "vanishing": False}, of)
            assert given is not None and given.of_mass == alike
            if not alike:
                with pytest.raises(Refused, match=r"there are joints.* other than external damping alone"):
                    Gaps([(of, Pieces(of))], 2, Fraction(100), given).check(Fraction(5), unused)


@pytest.mark.parametrize("case", ["crack", "shear"])
def test_both_programs_find_about_one_size_of_a_load(case: str) -> None:
    """The constant is the same; at places the verifier may choose among more bounds."""
    it, of = column(case)
    with flint.ctx.workprec(BITS):
        ours, theirs = load_size([of]), size_of_prover(ColumnForms(it.kernel, it.own))
        assert float(ours.constant) == pytest.approx(float(theirs.constant), rel=1e-9) and ours.places
        for low, high in ((30, 60), (200, 260)):
            pair = arb(low), arb(high)
            assert 0.7 < float(ours.at(*pair) / theirs.at(*pair)) < 1.01


def forgeries(case: str) -> dict[str, Callable[[Data], Any]]:
    """What is to be refused: of each a change of the file."""
    name, given = CASES[case]
    own = {key: v for key, v in given.items() if key != "beta"}
    beyond = Fraction(frequencies(system(name, own), found(case).evidence["lowest"] + 1)[-1] ** 2)
    all_of: dict[str, Callable[[Data], Any]] = {
        "a load that is moved": lambda d: d.update(load=[str(Fraction(v) * Fraction("1.001")) for v in d["load"]]),
        "twice the load": lambda d: d.update(load=[str(2 * Fraction(v)) for v in d["load"]]),
        "a line half as high": lambda d: d.update(line=str(Fraction(d["line"]) / 2)),
        "a line at the next eigenvalue": lambda d: d.update(line=str(beyond)),
        "a stretch left out": lambda d: d["stretches"].pop(0),
        "one eigenvalue less": lambda d: (
            d.update(lowest=d["lowest"] - 1),
            [s["points"].pop() for s in d["stretches"]],
        ),
        "a load without its follower": lambda d: d["forms"]["H"].update(points=[]),
    }
    if "joints" in certificate(case):
        all_of |= {
            "a joint that is stiffer": lambda d: d["joints"][0].__setitem__(2, str(Fraction(d["joints"][0][2]) * 2)),
            "a jump left out": lambda d: d.update(joints=[]),
            "a jump of the other kind": lambda d: d["joints"][0].__setitem__(1, 1 - d["joints"][0][1]),
            "a joint with damping": lambda d: d.update(damping={"form": d["forms"]["E"], "vanishing": True}),
        }  # fmt: skip
    return all_of


def main(folder: Path) -> None:
    changes = {"V": "integral(Piecewise((1, x < half), (half, True)) * y.diff(x, 2) ** 2) / 2", "dW_nc": "follower / 2"}
    CASES["load on a tip without a mass"] = str(file_of(folder, "load on a tip", changes)), {}
    for case in CASES:
        print(case, "accepted:", str(verifier.verify(certificate(case), FORMATS))[-90:])
        forged = {what: certificate(case) for what in forgeries(case)}
        for what, change in forgeries(case).items():
            change(forged[what])
        try_forgeries(case, lambda data: verifier.verify(data, FORMATS), forged.items())


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        main(Path(folder))
