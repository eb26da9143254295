"""Certificates of damped columns with variable sections, masses and springs: accepted as written, refused where they
claim what is not so; and the verifier's function and constants of damping beside those of the prover and of series.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise, product
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, arb, fmpq_poly
from scipy.linalg import eigh

import freebeam as fb
from freebeam_derive.certify import (
    beam_cells,
    damped_gaps,
    verifier,
    verifier_of_sections,
    verifier_pieces,
    verifier_sections,
)
from freebeam_derive.certify.balls import ends
from freebeam_derive.certify.beam_itself import divergence, flutter_damped
from freebeam_derive.certify.boundary_polynomials import Question
from freebeam_derive.certify.certificate import _around, _sections
from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.damped_gaps import LeftOver, _reach
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.stepped_section import SteppedSection, motion
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_cells import Cells
from freebeam_derive.certify.verifier_claims import Refused, exact
from freebeam_derive.certify.verifier_damping import Damped, DampedOver, _written
from freebeam_derive.certify.verifier_damping_forms import _never_negative, damped, halfway
from freebeam_derive.certify.verifier_load_size import PARTS
from freebeam_derive.certify.verifier_of_sections import FORMATS, Frequencies, Gaps
from freebeam_derive.certify.verifier_pieces import OfPieces, Pieces
from freebeam_derive.certify.verifier_rates import Powers, Rates
from freebeam_derive.certify.verifier_sections import Sections
from tests.certify.test_frequency_gaps import frequencies, system
from tests.certify.test_section_certificates import computed_once  # noqa: F401

Data = dict[str, Any]
BITS = 128
# column, own parameters and damping
CASES: dict[str, tuple[str, dict[str, str]]] = {
    "internal": ("pflueger", {"J": "0.1", "alpha": "0.02"}),
    "mass undamped": ("pflueger", {"J": "0.1", "alpha": "0.02", "beta": "0.1"}),
    "limit, mass undamped": ("pflueger", {"J": "0.1", "kappa": "1"}),
    "limit, spring undamped": ("elastic-root", {"kappa": "1"}),
    "divergence": ("tip-spring", {"k": "38", "beta": "0.1"}),
}


@cache
def found(case: str) -> Any:
    """Proven as a whole; but of some the prover's cells are left out, for the verifier makes its own."""
    name, own = CASES[case]
    with pytest.MonkeyPatch.context() as patch:
        if case != "limit, mass undamped":
            patch.setattr(beam_cells.Cells, "no_other_zero", lambda *_: 1)
        return fb.exact_load(fb.column(name), digits=15, **own)  # type: ignore[arg-type]


def certificate(case: str) -> Data:
    data: Data = json.loads(json.dumps(found(case).unverified))
    return data


def forged(case: str, change: Callable[[Data], Any]) -> Data:
    data = certificate(case)
    change(data)
    return data


def refused(data: Data, match: str) -> None:
    with pytest.raises(Refused, match=match):
        verifier.verify(data, FORMATS)


def shifted(pair: list[str], factor: str) -> list[str]:
    return [str(Fraction(v) * Fraction(factor)) for v in pair]


@pytest.mark.parametrize("case", [*CASES][:-1])
def test_a_certificate_is_accepted_as_it_was_written(case: str) -> None:
    proven = found(case)
    assert all(proven.proof.values()) and proven.missing == ""
    stated = verifier.verify(certificate(case), FORMATS)
    assert stated.kind == proven.kind
    assert stated.load[0] < Fraction(proven.load[1]) and Fraction(proven.load[0]) < stated.load[1]
    said, damping = str(stated), stated.record()["damping"]
    assert "it is the first over all modes" in said and "stable is every load from 0 up to it" in said
    words, beside = {
        "internal": ("C = 0.02 E:", 0),
        "mass undamped": ("C = 0.02 E + the integral of 0.1 v y over 0 < x < 1:", 1),
        "limit, mass undamped": ("direction of C = 1 E + the integral of 1 v y over 0 < x < 1:", 1),
        "limit, spring undamped": ("the integral of 1 v y over 0 < x < 1 + -5 v' y' at x = 0:", 2),
    }[case]
    assert words in said and len(damping["beside"]) == beside and damping["vanishing"] is ("limit" in case)


def test_another_damping_is_refused() -> None:
    """A crossing is that of its damping alone; finite, vanishing and none are three."""
    data = certificate("limit, mass undamped")
    refused(data | {"damping": data["damping"] | {"vanishing": False}}, "no crossing in the interval")
    data = certificate("mass undamped")
    along = data["damping"]["form"]["along"]
    for n, term in enumerate(along):
        changed = [*along[:n], [*term[:-1], str(Fraction(term[-1]) * Fraction(1001, 1000))], *along[n + 1 :]]
        form = data["damping"]["form"] | {"along": changed}
        refused(data | {"damping": data["damping"] | {"form": form}}, "no crossing in the interval")
    spring = certificate("limit, spring undamped")
    form = spring["damping"]["form"] | {"points": [[0, 1, 0, 1, "1/100"]]}
    refused(spring | {"damping": spring["damping"] | {"form": form}}, "no crossing in the interval")
    refused(spring | {"damping": spring["damping"] | {"vanishing": False}}, "where no mass is")
    refused(data | {"damping": None}, "leave a gap")
    refused(data | {"damping": data["damping"] | {"vanishing": True}}, "leave a gap")
    mass = {"along": along, "points": [[1, 0, 1, 0, "1/100"]]}
    refused(data | {"damping": data["damping"] | {"form": mass}}, "no crossing in the interval")


def test_a_claim_that_is_moved_is_refused() -> None:
    data = certificate("internal")
    for name in ("load", "frequency_squared"):
        refused(data | {name: shifted(data[name], "1.0001")}, "no crossing in the interval")
    refused(data | {"load": shifted(data["load"], "8")}, "too narrow|not known to be damped")
    refused(data | {"kind": "divergence", "frequency_squared": None}, "no crossing in the interval")
    refused(data | {"proof": data["proof"] | {"first": False}}, "what is said to be proven")
    refused(data | {"line": str(Fraction(data["line"]) / 20)}, "not known to be free")
    refused(forged("internal", lambda d: d["stretches"][0]["points"].__setitem__(1, "1/2")), "not known to change sign")
    refused(forged("internal", lambda d: d["stretches"].pop()), "not known to be stable at P = 0")

    def one_less(d: Data) -> None:
        d["lowest"], d["line"] = 1, str(Fraction(d["stretches"][0]["points"][1]) * Fraction(11, 10))
        del d["stretches"][0]["points"][1]

    refused(forged("internal", one_less), "too narrow|not known to be (free|damped)")
    for form, where, n, last in (("M", "points", 0, "1.001"), ("M", "along", 0, "1.001"), ("E", "along", 0, "1.001")):
        other = forged("internal", lambda d, f=form, w=where, k=n, v=last: d["forms"][f][w][k].__setitem__(-1, v))
        refused(other, "no crossing in the interval|stiffness times a number|known to be damped")


def test_a_crossing_that_is_not_the_first_is_refused() -> None:
    """Flutter beyond a divergence, and where a frequency comes back to zero; both are crossings, the second no loss."""
    data = certificate("divergence")
    own, a, b = {"k": Fraction(38)}, Fraction(0), Fraction(1, 10)
    it = ExactSystem(fb.column("tip-spring").kernel, own, a, b)
    later = flutter_damped(it, a, b, (39.7, 6.4), 15)
    with flint.ctx.workprec(later.bits):
        claims = [_around(ends(v), 13) for v in (later.load, later.frequency**2)]  # type: ignore[arg-type]
    # with as many lowest eigenvalues as such a load asks for
    squares = [Fraction(float(w)) ** 2 for w in frequencies(system("tip-spring", {"k": "38"}), 8)]
    points = [Fraction(0), *((x + y) / 2 for x, y in pairwise(squares[:7]))]
    data["lowest"], data["line"] = 6, str(points[-1] * Fraction(101, 100))
    data["stretches"][0]["points"] = [*map(str, points)]
    assert verifier.verify(data, FORMATS).kind == "divergence"
    later_one = dict(zip(("kind", "load", "frequency_squared"), ("flutter", *claims), strict=True))
    refused(data | later_one, r"F\(P, 0\) is not known to differ from zero")
    with pytest.raises(Exception, match="restabilisation"):
        divergence(it, 38.44, 15)


def test_an_instability_that_is_not_named_is_not_passed_over() -> None:
    data = certificate("mass undamped")
    _, column, *_ = verifier_sections.read(data)
    top = Fraction(data["load"][1])
    with flint.ctx.workprec(BITS):
        damping = damped(data["damping"], column)
        assert damping is not None
        equations = Rates(Pieces(column), damping)
        box, change = equations.flutter(
            tuple(map(Fraction, data["load"])), tuple(map(Fraction, data["frequency_squared"]))
        )  # type: ignore[arg-type]
        assert change > 0
    with flint.ctx.workprec(64):
        near = Cells(equations, top, [])
        with pytest.raises(Refused, match="another crossing could be near"):
            near.tile((top * Fraction(127, 128), top), (Fraction(2), Fraction(5, 2)), 5)
        Cells(equations, top, [box]).tile((top * Fraction(127, 128), top), (Fraction(2), Fraction(5, 2)), 5)


def damping_of(case: str, change: Callable[[Data], Any]) -> Any:
    data = certificate(case)
    change(data["damping"])
    with flint.ctx.workprec(BITS):
        return damped(data["damping"], verifier_sections.read(data)[1])


def test_damping_that_is_not_served_is_refused() -> None:
    def read(match: str, change: Callable[[Data], Any], case: str = "mass undamped") -> None:
        with pytest.raises(Refused, match=match):
            damping_of(case, change)

    read("couples motions", lambda d: d["form"]["along"].append([0, 0, 0, 1, "1"]))
    read("couples motions", lambda d: d["form"]["points"].append([1, 0, 1, 1, "1"]))
    read("known to take energy", lambda d: d["form"]["along"].append([0, 0, 0, 0, "-1"]))
    read("known to take energy", lambda d: d["form"]["points"].append([1, 0, 1, 0, "-1"]))
    read("bending stiffness times a number", lambda d: d["form"]["along"].append([0, 1, 2, 2, "1"]))
    read("where no mass is", lambda d: d["form"]["points"].append([1, 0, 1, 0, "1"]), "divergence")
    read("no form of its own", lambda d: d.update(vanishing="no"))
    read("no damping at all", lambda d: d["form"].update(along=[], points=[[1, 0, 1, 0, "1"]]))
    assert damping_of("internal", lambda d: None).plain and not damping_of("mass undamped", lambda d: None).plain


# ------------------------------------------------------------ the verifier's own mathematics

LEFT: dict[str, tuple[str, dict[str, Fraction], Fraction, Fraction]] = {
    "mass": ("pflueger", {}, Fraction(1, 100), Fraction(1, 10)),
    "rotary inertia": ("pflueger", {"J": Fraction(1, 10)}, Fraction(1, 100), Fraction(1, 10)),
    "weight": ("beck-self-weight", {"g": Fraction(2)}, Fraction(1, 100), Fraction(1, 10)),
    "mass per length": ("step", {"s": Fraction(1), "r": Fraction(3, 2)}, Fraction(0), Fraction(1, 2)),
    "mass at mid-span": ("point-mass", {}, Fraction(0), Fraction(1, 2)),
}


@cache
def column(case: str) -> tuple[Any, Sections, Damped]:
    name, own, alpha, beta = LEFT[case]
    kernel = fb.column(name).kernel
    stated = _sections(kernel, Question(1, alpha, beta, None, own))
    of = verifier_sections.sections(tuple(stated["ends"]), tuple(map(Fraction, stated["breaks"])), stated["forms"])
    with flint.ctx.workprec(BITS):
        damping = damped(stated["damping"], of)
    assert damping is not None and not damping.plain
    return kernel, of, damping


@pytest.mark.parametrize("case", ["mass", "weight", "mass per length"])
def test_both_functions_have_the_same_zeros(case: str) -> None:
    """Their quotient is a number times a power of 1 + c_E λ, by which the verifier divides each natural condition."""
    name, own, alpha, beta = LEFT[case]
    _, of, damping = column(case)
    it = ExactSystem(fb.column(name).kernel, own, alpha, beta)
    quotients = []
    with flint.ctx.workprec(64):
        F = Pieces(of, damping)
        for P, lam in ((1, acb(0, 3)), (2, acb(1, 2))):
            below = 1 + arb(str(alpha)) * lam if alpha else acb(1)
            p, s = P / below, -(lam * lam + arb(float(damping.c_M)) * lam) / below
            ours = Powers(F, acb(p), acb(s)).value(acb(p), acb(s), 0, 0, lam / below)
            quotients.append(ours * below**2 / it.taylor(acb(P), -lam, ((0, 0),))[0, 0])
    assert all(abs(q / quotients[0] - 1) < 1e-9 for q in quotients) and abs(quotients[0]) > 0


def test_the_slope_by_the_rate_is_that_of_differences() -> None:
    _, of, damping = column("mass")
    p, s, q, step = acb(2), acb(9, 3), acb(1, 2), acb("1e-6")
    with flint.ctx.workprec(64):
        F = Powers(Pieces(of, damping), p, s)
        for i, j in ((0, 0), (1, 0), (0, 1)):
            above, below = (F.value(p, s, i, j, x) for x in (q + step, q - step))
            assert abs(F.value(p, s, i, j, q, 1) / ((above - below) / (2 * step)) - 1) < 1e-6
        with pytest.raises(ArithmeticError, match="outside"):
            F.value(p, s, 0, 0, acb(0, 7))
        # what F lacks may be any function that small where |q| ≤ Q = 8, such as this times (q/Q)^n
        F._boxes[0]._rest = arb("0.01")
        with flint.ctx.workprec(128):
            width = float(F.value(p, s, 0, 0, q, 1).real.rad())
        assert float(F.Q) == 8 and width > 0.01 * max(n * (5**0.5 / 8) ** (n - 1) for n in range(1, 9)) / 8


@pytest.mark.parametrize("case", LEFT)
def test_the_constants_of_damping_are_above_what_they_bound(case: str) -> None:
    """Of a series: R on modes without load, which are orthonormal in mass, and what part of it is at places."""
    kernel, _, damping = column(case)
    _, own, alpha, beta = LEFT[case]
    floats, basis = {key: float(value) for key, value in own.items()}, kernel.basis(24)
    M, E, C = (
        kernel.mass(basis, 0.0, **floats), kernel.stiffness(basis, 0.0, **floats),
        kernel.damping(basis, 0.0, float(alpha), float(beta), **floats),
    )  # fmt: skip
    of_inverse, modes = eigh(M, E)
    omega = of_inverse[::-1][:10] ** -0.5
    modes = modes[:, ::-1][:, :10] * omega
    R = modes.T @ (C - float(damping.c_E) * E - float(damping.c_M) * M) @ modes
    with flint.ctx.workprec(BITS):
        size, turning = float(damping.size), float(damping.turning)
        if turning == 0:
            assert abs(np.linalg.eigvalsh(R)).max() <= size * (1 + 1e-9) and size < 100
            for k in range(len(omega)):
                least = float(damping.least(arb(omega[k]), arb(0)))
                assert least <= np.diag(R)[k:].min() + 1e-9 and least >= -size * (1 + 1e-9)
                blurred = damping.least(arb(omega[k]), arb("0.1"))
                assert blurred < least and blurred > -2 * size
        else:
            felt = np.linalg.norm(R / omega, 2)
            assert felt <= turning * (1 + 1e-9) and turning < 4 * felt and size == 0
        masses = {"mass": "mu", "rotary inertia": "J", "mass at mid-span": "mu"}
        if case in masses:  # the share of one of them falls short of that of all
            at = {key: p["default"] for p in kernel.COLUMN["parameters"] for key in [p["name"]]} | floats
            lighter = kernel.mass(basis, 0.0, **(at | {masses[case]: 0.0}))
            shares = np.diag(modes.T @ (M - lighter) @ modes)
            bounds = [float(damping.share(arb(w))) for w in omega]
            assert all(0 < share <= bound for share, bound in zip(shares, bounds, strict=True)) and bounds[-1] < 0.7


class Given(Damped):
    """With its constants as they are given: least and largest along the beam, at a mass, of a slope, and the share."""

    constants: Any

    density = property(lambda self: (arb(self.constants[0]), arb(self.constants[1])))  # type: ignore[assignment]
    at_masses = property(lambda self: [arb(self.constants[2])])  # type: ignore[assignment]
    turning = property(lambda self: arb(self.constants[3]))  # type: ignore[assignment]

    def share(self, omega: arb) -> arb:
        return arb(self.constants[4])

    def reach(self, place: Any, omega: arb) -> arb:
        return arb(self.constants[5])

    @classmethod
    def of(cls, c_E: float, c_M: float, vanishing: bool, *constants: float) -> Given:
        empty = Sections(("clamped", "free"), (Fraction(0), Fraction(1)), [], [], [], [], {}, {}, {})
        points = {(1, 0): Fraction(constants[6])} if len(constants) > 6 else {}
        found = cls(empty, Fraction(c_E), Fraction(c_M), vanishing, [], points, ([], {}))
        object.__setattr__(found, "constants", constants)
        return found


def margin(c_E: float, c_M: float, limit: bool, R: tuple[float, ...], load: float, g: float, omega_m: float) -> float:
    """What is left of the narrowest inequality of Lemma 11, as docs/theorem.md prints them."""
    low, high, tau, turning, eta, N, f = R
    delta = max(abs(low), abs(high), abs(tau))
    X = load if limit else load + (turning / c_E if c_E else 0) + delta * (1 + g / omega_m) ** 0.5
    omega = omega_m + g
    r = g / omega
    if 2 * X >= g:
        return g - 2 * X
    sigma = X * max((1 + r) / (g * (2 + r) - X), 1 / (g * (2 - r) - X))
    if sigma >= 0.5**0.5:
        return float(0.5**0.5 - sigma)
    eps, k = sigma / (1 - sigma**2) ** 0.5, 1 / (1 - 2 * sigma**2)
    along, of_mode = max(abs(low), abs(high)), max(abs(low), abs(high)) + eta * abs(tau)
    rho = (along**2 + eta * tau**2) ** 0.5
    least = low + eta * min(0, tau - low) - (2 * rho * eps + (delta + of_mode) * eps**2) / (1 - eps**2)
    h = c_E * (omega - X - load * k) - turning * k - abs(f) * N**2 * ((f < 0) + (2 + r) * eps / (1 - eps)) / omega
    return min(h if h < 0 else np.inf, c_M + omega * h + min(0, least))


class Known(LeftOver):
    """The same of the prover."""

    def __init__(self, c_E: float, c_M: float, *constants: float) -> None:
        low, high, at_mass, turning, self._share, _, bare = constants
        self.c_E, self.c_M, self.low, self.high, self.turning = map(arb, (c_E, c_M, low, high, turning))
        self.at, self.bare = {(Fraction(1), 0): arb(at_mass)}, {(Fraction(1), 0): arb(bare)} if bare else {}
        self.forms: Any = [None]

    def share(self, omega: arb) -> arb:
        return arb(self._share)


def test_the_inequality_is_that_of_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """At numbers drawn at random, on both sides of it; of the verifier and of the prover."""
    draw, seen = np.random.default_rng(1), {True: 0, False: 0}
    with flint.ctx.workprec(BITS):
        for _ in range(600):
            c_E, c_M, low, high, tau, turning = draw.uniform(0, 1, 6) * draw.choice([0.01, 0.1, 1], 6)
            c_E, turning = (c_E, turning * draw.choice([0, 1])) if draw.random() < 0.7 else (0.0, 0.0)
            R = (-low, float(high), float(draw.choice([-1, 1]) * tau), float(turning), float(draw.uniform(0, 1)))
            R = *R, *map(float, draw.choice([0, 1]) * draw.uniform(-5, 5, 2))
            g, omega_m, limit = draw.uniform(5, 60), draw.uniform(1, 60) * draw.choice([0.1, 1]), bool(draw.integers(2))
            load = g * draw.uniform(0.05, 0.6)
            wanted = margin(c_E, c_M, limit, R, load, g, omega_m)
            try:
                Given.of(c_E, c_M, limit, *R).check(arb(load), arb(g), arb(omega_m))
            except Refused:
                assert wanted < 1e-9
            else:
                assert wanted > -1e-9
            gaps: Any = SimpleNamespace(gap=lambda m, g=g: arb(g), frequency=lambda m, w=omega_m: arb(w), size=arb(4))
            gaps.count = 3
            monkeypatch.setattr(damped_gaps, "_reach", lambda *_, N=R[5]: arb(N))
            assert damped_gaps._stays(gaps, Known(c_E, c_M, *R), 3, arb(load / 4), limit) == (wanted > 0)
            seen[wanted > 0] += 1
            both = Given.of(c_E, c_M, limit, *R), Known(c_E, c_M, *R)
            ours, theirs = (float(of.least(arb(omega_m), arb("0.3"))) for of in both)
            along, at_mass, share = max(abs(R[0]), abs(R[1])), R[2], R[4]
            rho = (along**2 + share * at_mass**2) ** 0.5
            missed = 0.6 * rho + 0.09 * (max(along, abs(at_mass)) + along + share * abs(at_mass))
            assert ours == pytest.approx(theirs, rel=1e-8)
            assert ours == pytest.approx(R[0] + share * min(0, at_mass - R[0]) - missed / 0.91, rel=1e-8)
    assert min(seen.values()) > 50


def test_both_end_the_frequencies_at_one_place() -> None:
    """Beyond which load and damping leave no eigenvalue of the low ones on the axis: by the line, or by c_E."""
    draw, ways = np.random.default_rng(5), {True: 0, False: 0}
    with flint.ctx.workprec(BITS):
        for _ in range(100):
            c_E, load, size, turning = map(float, 10 ** draw.uniform(-3, [0.5, 2, 0, 0]))
            c_M, R = float(draw.uniform(0, 1)), float(10 ** draw.uniform(1, 4))
            gaps: Any = SimpleNamespace(line=lambda _, R=R: arb(R), size=arb(2))
            left = Known(c_E, c_M, -size, size / 2, size / 3, turning, 0.0, 0.0, 0.0)
            theirs = damped_gaps.DampedGaps(gaps, left, 1, arb(0), arb(load), False).top
            ours = Given.of(c_E, c_M, False, -size, size / 2, size / 3, turning, 0.0).highest(arb(R), arb(2 * load))
            assert abs(ours / theirs - 1) < 1e-12
            rest = 1 - c_E * c_M - c_E**2 * R
            ways[rest > 0 and float(theirs) == pytest.approx((R / rest) ** 0.5)] += 1
        assert min(ways.values()) > 10
        for still in (Known(0.0, 1.0, *[0.0] * 7), Known(1.0, 0.0, *[0.0] * 7)):
            vanishing = not still.c_E == 0
            top = damped_gaps.DampedGaps(gaps, still, 1, arb(0), arb(9), vanishing).top
            assert top.overlaps(arb(R) if vanishing else arb(R).sqrt())
        assert Given.of(0.0, 1.0, False, *[0.0] * 5).highest(arb(R), arb(9)).overlaps(arb(R).sqrt())
        slow: Any = Given.of(1.0, 0.0, False, -1e9, 0.0, 0.0, 0.0, 0.0)
        with pytest.raises(Refused, match="no bound of the frequency"):
            slow.highest(arb(9), arb(1))
        with pytest.raises(NoStrips, match="no frequency is known beyond"):
            _ = damped_gaps.DampedGaps(gaps, Known(1.0, 0.0, -1e9, *[0.0] * 6), 1, arb(0), arb(1), False).top


@pytest.mark.parametrize(("name", "place"), [("elastic-root", (0, 1)), ("tip-spring", (1, 0))])
def test_motions_at_places_without_a_mass_are_those_of_the_prover(name: str, place: tuple[int, int]) -> None:
    kernel = fb.column(name).kernel
    stated = _sections(kernel, Question(1, Fraction(0), Fraction(0), Fraction(1), {}))
    of = verifier_sections.sections(tuple(stated["ends"]), tuple(map(Fraction, stated["breaks"])), stated["forms"])
    with flint.ctx.workprec(BITS):
        damping, theirs = damped(stated["damping"], of), ColumnForms(kernel, {})
        assert damping is not None and [*damping.bare] == [place]
        gaps = Gaps([(of, Pieces(of))], 1, Fraction(1), damping)
        gaps.known = Frequencies(gaps.columns[0][1], arb(8), arb(1)).all()
        for (omega, squares), (_, most) in zip(gaps._motions(damping, arb(8), arb(1)), gaps.known[1:], strict=True):
            other = motion([SteppedSection(theirs)], omega.union(most), place)
            assert squares[place].overlaps(other) and squares[place].rad() < 1e-6 * other < 1e-3 * other
            assert 1 <= damping.reach(place, omega) / _reach(theirs, Fraction(place[0]), place[1], omega) < 1.05
            assert other < damping.reach(place, omega) ** 2


def test_slopes_of_the_equations_are_those_of_differences() -> None:
    """Of both unknowns, with damping and in its limit; and at λ = 0 that by λ."""
    _, of, damping = column("mass")
    h = arb("1e-5")
    with flint.ctx.workprec(64):
        F = Pieces(of)
        for limit in (False, True):
            equations = Rates(F, replace(damping, vanishing=limit))
            X = [arb("1.5"), arb("8" if limit else "2.7")]
            p, s = equations.place(*X)
            box = equations.box(*(side + side * arb(0, 0.001) for side in (p, s)))
            J = equations.system(box.value, *X)[1]
            for j in (0, 1):
                up, down = ([x + sign * h * (n == j) for n, x in enumerate(X)] for sign in (1, -1))
                ends = [equations.system(box.value, *at)[0] for at in (up, down)]
                for i in (0, 1):
                    assert abs(J[i][j] - (ends[0][i] - ends[1][i]) / (2 * h)) < 1e-6 * max(abs(J[i][0]), abs(J[i][1]))
        P, plain = arb("1.5"), Box(F, arb("1.5"), arb(0), 1)
        a, b = equations.alpha, equations.beta
        values = []
        for lam in (h, -h):
            below = 1 + a * lam
            p, s = P / below, -(lam * lam + b * lam) / below
            values.append(Powers(equations.whole, p, s).value(p, s, 0, 0, lam / below))
        rate = equations.rate(plain, P, plain.value(P, arb(0), 1, 0))
        assert abs(-rate / ((values[0] - values[1]) / (2 * h)) - 1) < 1e-6


@pytest.mark.parametrize("case", ["mass", "mass per length"])
def test_no_size_is_below_the_sum_of_the_coefficients(case: str) -> None:
    """Of which rests are bounded, those of powers of q too."""
    _, of, damping = column(case)
    with flint.ctx.workprec(64):
        F = Pieces(of, damping)
        whole = OfPieces(F, arb(1), arb(1))
        parts = [part for line in whole._solutions(F.pieces[0][0][1]) for part in line]
        parts += [whole._linear(factor) for row in F.rows for factor in row.values()]
        assert any(len(part.levels) > 1 for part in parts)
        for part in parts:
            total = sum((abs(c) for rows in part.levels for row in rows for c in row.coeffs()), arb(0))
            assert total.lower() <= part.size


def test_what_the_lemma_is_asked_of_is_below_the_gaps_of_a_series(monkeypatch: pytest.MonkeyPatch) -> None:
    _, of, damping = column("rotary inertia")
    omega = frequencies(system("pflueger", {"J": "0.1"}), 12)
    asked: list[tuple[float, ...]] = []
    monkeypatch.setattr(Damped, "check", lambda self, *given: asked.append(tuple(map(float, given[:3]))))
    with flint.ctx.workprec(BITS):
        F = Pieces(of)
        equations: Any = SimpleNamespace(F=SimpleNamespace(on=lambda *_: None))
        for m, line in ((2, omega[1] * omega[2]), (2, 1.1 * omega[1] ** 2 + 15), (3, 0.9 * omega[3] ** 2)):
            Gaps([(of, F)], m, Fraction(line), damping).check(Fraction(1), equations)
            loaded, gap, frequency = asked.pop()
            a = max(omega[m - 1], line / omega[m])
            assert 1 <= loaded <= 2 and gap <= min(line / a - a, np.diff(omega[m:]).min()) * (1 + 1e-6)
            assert omega[m - 1] * (1 - 1e-6) <= frequency <= omega[m - 1]
        # a gap further on that is narrower than that about the line
        stub = lambda *_: SimpleNamespace(all=lambda: [(arb(w), arb(w)) for w in (2, 16, 80, 120, 220)])  # noqa: E731
        monkeypatch.setattr(verifier_of_sections, "Frequencies", stub)
        Gaps([(of, F)], 2, Fraction(16 * 80), damping).check(Fraction(1), equations)
        assert asked.pop()[1] <= 40


def test_frequencies_beyond_the_bound_are_not_of_the_low_ones() -> None:
    """Re s = R at the first bound, and above it from there on; the second where internal damping is large."""
    none = (0.0,) * 5
    with flint.ctx.workprec(BITS):
        for c_E, c_M in ((1 / 128, 1 / 8), (1 / 64, 20.0)):
            top = float(Given.of(c_E, c_M, False, *none).highest(arb(500), arb(600)))
            for share, beyond in ((0.999, False), (1.001, True), (3.0, True)):
                lam = 1j * share * top
                assert ((-(lam**2 + c_M * lam) / (1 + c_E * lam)).real >= 500) is beyond
        assert float(Given.of(0, 1, False, *none).highest(arb(500), arb(6))) == pytest.approx(500**0.5)
        for loaded, tau, turning in ((6.0, 0.0, 0.0), (600.0, 0.0, 0.0), (6.0, 60.0, 0.0), (6.0, 0.0, 4.0)):
            top = float(Given.of(0.125, 0, False, 0.0, 0.0, tau, turning, 0.0).highest(arb(500), arb(loaded)))
            felt = []
            for omega in (top, top * 8 / 9):  # no larger than it need be, and not without need
                h, s = abs(1 + 0.125j * omega), omega**2 / (1 + 0.125j * omega)
                energy = (2 * (abs(s) - s.real)) ** -0.5
                felt.append((loaded + turning * omega) / h * energy + tau * omega / h / abs(s.imag))
            assert felt[0] < 1 <= felt[1] * (1 + 1e-9)


def test_the_line_is_looked_at_with_damping_too() -> None:
    data = certificate("mass undamped")
    _, of, m, line, _ = verifier_sections.read(data)
    with flint.ctx.workprec(BITS):
        damping, F = damped(data["damping"], of), Pieces(of)
        assert damping is not None
        gaps = Gaps([(of, F)], m, line, damping)
        gaps.check(Fraction(data["load"][1]), Rates(F, damping))
        # the load that Lemma 6 allows is too much for Lemma 11
        widths = [float(b[0] - a[1]) for a, b in zip(gaps.known[m - 1 :], gaps.known[m:], strict=False)]
        most = min(widths) / float(gaps.size.constant)
        with pytest.raises(Refused, match=r"too narrow for such a load and damping|known to be free"):
            gaps.check(Fraction(0.6 * most), Rates(F, damping))


@pytest.mark.parametrize("at_slope", ["nothing", "a mass", "a spring", "held"])
@pytest.mark.parametrize("order", [0, 1])
def test_a_motion_beside_a_mass_moves_nothing_else_at_its_place(order: int, at_slope: str) -> None:
    """Cubics with 1 at the tip and 0 at a length from it; the slope at the tip is free where nothing is there, and of
    a rotary inertia the displacement is 0."""
    breaks = Fraction(0), Fraction(1)
    m, EI, force, foundation, k = 2, 3, 5, 7, 11
    masses = {(1, order): Fraction(1)} | ({(1, 1): Fraction(1)} if at_slope == "a mass" else {})
    springs = {(1, order): Fraction(k)} | ({(1, 1): Fraction(k)} if at_slope == "a spring" else {})
    elastic = {1: fmpq_poly([force]), 0: fmpq_poly([foundation])}
    kinds = ("clamped", "sliding" if at_slope == "held" else "free")
    of = Sections(kinds, breaks, [fmpq_poly([EI])], [fmpq_poly([m])], [elastic], [{}], masses, springs, {})
    free = np.polynomial.Polynomial([1, -1.5, 0, 0.5] if at_slope == "nothing" else [1, 0, -3, 2])
    v = np.polynomial.Polynomial([0, 1, -2, 1]) if order else free
    assert [v(1), v.deriv()(1)] == [0, 0]
    squares = [float((f * f).integ()(1)) for f in (v, v.deriv(), v.deriv(2))]
    found = Damped(of, Fraction(0), Fraction(1), False, [], {}, ([], {}))._bumps((1, order))
    for length, (weight, energy) in zip(map(float, PARTS), found, strict=True):
        assert float(weight) == pytest.approx(m * squares[0] * length ** (1 + 2 * order), rel=1e-12)
        parts = (foundation * length, force / length, EI / length**3)
        along = length ** (2 * order) * sum(f * square for f, square in zip(parts, squares, strict=True))
        assert float(energy) == pytest.approx(k + along, rel=1e-12)


def test_a_damping_is_what_it_is_taken_apart_into() -> None:
    """C = c_E E + c_M M + R along the beam and at the places with masses and springs; also where C leaves one out."""
    EI, m, mu, J, k, c_E, c_M = (Fraction(*v) for v in ((3, 1), (2, 1), (5, 2), (1, 3), (7, 1), (1, 10), (3, 4)))
    of = Sections(
        ("clamped", "free"), (Fraction(0), Fraction(1)), [fmpq_poly([3])], [fmpq_poly([2])], [{}], [{}],
        {(1, 0): mu, (1, 1): J}, {(1, 0): k}, {},
    )  # fmt: skip
    for dampers in ({}, {(1, 0): Fraction(4)}, {(1, 0): Fraction(4), (1, 1): Fraction(9)}):
        form = {
            "along": [[0, 0, 2, 2, str(c_E * EI)], [0, 0, 0, 0, str(c_M * m)]],
            "points": [[node, order, node, order, str(f)] for (node, order), f in dampers.items()],
        }
        found = damped({"form": form, "vanishing": False}, of)
        assert found is not None and (found.c_E, found.c_M) == (c_E, c_M)
        assert not any(f.degree() >= 0 for table in found.along for f in table.values())
        for key, mass in of.masses.items():
            whole = c_E * of.springs.get(key, Fraction(0)) + c_M * mass + found.points[key]
            assert whole == dampers.get(key, 0)


def made(along: dict[int, fmpq_poly], points: dict[Any, Fraction], c_E: int = 1, c_M: int = 2, **of: Any) -> Damped:
    column = Sections(
        ("clamped", "free"), (Fraction(0), Fraction(1)), [fmpq_poly([3])], [fmpq_poly([2])], [{}], [{}],
        {(1, 0): Fraction(4)} | of.get("masses", {}), of.get("springs", {}), {},
    )  # fmt: skip
    return Damped(column, Fraction(c_E), Fraction(c_M), False, [along], points, ([], {}))


def test_halfway_between_two_dampings_is_their_mean_and_a_share_of_it() -> None:
    """R of the first is a share of that in the middle; where it is no number times it, nothing is said."""
    f, place, other = fmpq_poly([3, 1]), (1, 0), (1, 1)
    for first, second in ((1, 3), (3, 1), (2, 2), (0, 4)):
        # a part that is nothing may be left out
        one = made({0: f * first} if first else {}, {place: Fraction(5 * first)} if first else {}, 1, 2)
        middle, share = halfway(one, made({0: f * second}, {place: Fraction(5 * second)}, 4, 3))
        assert (middle.c_E, middle.c_M, share) == (Fraction(5, 2), Fraction(5, 2), Fraction(2 * first, first + second))
        assert middle.along == [{0: f * 2}] and middle.points == {place: Fraction(10)}
        middle, share = halfway(made({0: f * second}, {}), made({0: f * first} if first else {}, {}))
        assert middle.along == [{0: f * 2}] and share == Fraction(2 * second, first + second)
    for mixed in (
        made({0: f}, {place: Fraction(9)}),
        made({0: f}, {other: Fraction(5)}),
        made({1: f}, {place: Fraction(5)}),
    ):
        with pytest.raises(Refused, match="the range changes what is left of damping"):
            halfway(made({0: f}, {place: Fraction(5)}), mixed)
    assert halfway(made({}, {}), made({}, {}))[1] == 1


def test_over_a_range_each_place_has_the_lightest_mass_and_the_stiffest_spring() -> None:
    """And of R there what takes most, of either sign; where one end has none, it has nothing there."""
    a, b = (1, 0), (1, 1)
    one = made({}, {a: Fraction(1)}, springs={a: Fraction(7), b: Fraction(1)})
    two = made({}, {a: Fraction(-3), b: Fraction(1, 2)}, masses={a: Fraction(3)}, springs={a: Fraction(9)})
    for pair in ((one, two), (two, one)):
        found = DampedOver.of(*pair)
        assert found.column.masses == {a: 3} and found.column.springs == {a: 9, b: 1}
        assert found.points == {a: Fraction(-3), b: Fraction(1, 2)}
    with pytest.raises(Refused, match="a mass is nothing at an end"):
        DampedOver.of(one, made({}, {}, masses={b: Fraction(1)}))


def test_a_factor_that_nowhere_takes_energy_is_told_from_others() -> None:
    """By its coefficients, or where one is negative by its values, however small."""
    column = made({}, {}).column
    for f, never in (
        ([1, 2], True),
        ([1, -1], False),
        ([Fraction(1, 9), -0.1], True),
        ([0, -1], False),
        ([1, -3, 3], True),
    ):
        assert _never_negative(column, 0, fmpq_poly([exact(Fraction(c)) for c in f])) == never


def derived(f: Any, order: int) -> Any:
    for _ in range(order):
        f = f.derivative()
    return f


def weak(column: Sections, left: Damped, y: list[Any], v: Any) -> list[Any]:
    """Energies, load, mass and what is left of damping of a motion y and a test function v: the four forms."""
    total, places = [exact(Fraction(0))] * 4, list(map(exact, column.breaks))
    for n, (low, high) in enumerate(pairwise(places)):
        terms = [(0, (2, 2), column.EI[n]), (2, (0, 0), column.m[n])]
        terms += [(which, (o, o), f) for which, of in ((0, column.elastic), (3, left.along)) for o, f in of[n].items()]
        for which, (i, j), f in terms + [(1, pair, f) for pair, f in column.load[n].items()]:
            whole = (f * derived(v, i) * derived(y[n], j)).integral()
            total[which] += whole(high) - whole(low)
    forces = [(1, *pair, f) for pair, f in column.forces.items()]
    for which, table in ((0, column.springs), (2, column.masses), (3, left.points)):
        forces += [(which, place, place, f) for place, f in table.items()]
    for which, (a, i), (b, j), force in forces:
        total[which] += exact(force) * derived(v, i)(places[a]) * derived(y[max(b - 1, 0)], j)(places[b])
    return total


def test_equations_on_pieces_and_conditions_at_breaks_are_the_weak_form() -> None:
    """Σ ∫ v (equation) dξ and what is at breaks, of a motion that bends there and any v: exactly, of all four forms."""
    breaks, one = (Fraction(0), Fraction(2, 5), Fraction(1)), fmpq_poly([1])
    column = Sections(
        ("free", "free"), breaks, [fmpq_poly([5, -3]), fmpq_poly([7, 0, -4])], [fmpq_poly([3, 1]), one * 2],
        [{0: fmpq_poly([2, 5])}, {0: one, 1: fmpq_poly([4, -1])}],
        [{(1, 1): one * -2, (0, 1): fmpq_poly([1, 3])}, {(1, 0): fmpq_poly([0, 2]), (0, 0): one}],
        {(1, 0): Fraction(6), (2, 1): Fraction(3, 7)},
        {(0, 0): Fraction(8), (1, 1): Fraction(9), (2, 0): Fraction(1, 2)},
        {((2, 0), (2, 1)): Fraction(5), ((0, 0), (2, 1)): Fraction(-3), ((2, 1), (0, 0)): Fraction(7),
         ((1, 0), (1, 1)): Fraction(2)},
    )  # fmt: skip
    left = Damped(
        column, Fraction(0), Fraction(0), False, [{0: fmpq_poly([1, 1])}, {1: fmpq_poly([2, -3])}],
        {(1, 0): Fraction(4), (0, 1): Fraction(-2)}, ([], {}),
    )  # fmt: skip
    first, v = fmpq_poly([2, -1, 3, 1]), fmpq_poly([1, 2, -1, 1])
    y = [first, first + fmpq_poly([exact(Fraction(-2, 5)), 1]) ** 2 * fmpq_poly([4, 1])]
    found = [exact(Fraction(0))] * 4
    for n in (0, 1):
        x = breaks[n]
        for h, table in verifier_pieces._cut(column, left, n):
            local = fmpq_poly([exact(x), exact(h)])
            for (d, k), factors in table.items():
                value = (v(local) * derived(y[n](local), d) * fmpq_poly([0] * k + [1])).integral()(1)
                found = [a + exact(f) * value for a, f in zip(found, factors, strict=True)]
            # the solutions' series converges on all of the piece
            assert sum(abs(f[0]) for (d, k), f in table.items() if d == 4 and k) < abs(table[4, 0][0])
            x += h
        assert x == breaks[n + 1]
    for node, order in product(range(3), (0, 1)):
        for (side, d), factors in verifier_pieces._natural(column, left, node, order).items():
            # of an end the other side is the other end
            n, x = ((1, breaks[2]) if side > 0 else (0, breaks[0])) if node != 1 else (int(side < 0), breaks[1])
            value = derived(v, order)(exact(breaks[node])) * derived(y[n], d)(exact(x))
            found = [a + exact(f) * value for a, f in zip(found, factors, strict=True)]
    assert found == weak(column, left, y, v)


@pytest.mark.parametrize("factors", [[2], [0, 3], [1, -2, 5], [0, 0, 0, 1], [Fraction(1, 3), 0, -4, 7]])
def test_a_polynomial_in_words_is_the_polynomial(factors: list[Any]) -> None:
    f = fmpq_poly([exact(Fraction(v)) for v in factors])
    text = _written(f).replace("^", "**").replace(" x", " * x").strip("()")
    for x in (Fraction(0), Fraction(1), Fraction(-3, 2)):
        assert eval(re.sub(r"(\d+)/(\d+)", r"F(\1, \2)", text), {"x": x, "F": Fraction}) == sum(
            c * x**k for k, c in enumerate(factors)
        )
