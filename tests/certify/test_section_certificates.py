"""Certificates of columns of variable or stepped section, with masses and springs: accepted as written, refused where
they claim what is not so; and the verifier's function, frequencies and bounds beside those of the prover and of series.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import flint
import numpy as np
import pytest
from flint import acb, acb_poly, arb, arb_mat, arb_poly, arb_series, fmpq_poly
from scipy.linalg import expm

import freebeam as fb
from freebeam_derive.certify import verifier, verifier_of_sections, verifier_sections, verifier_waves
from freebeam_derive.certify.boundary_polynomials import Question
from freebeam_derive.certify.certificate import _sections
from freebeam_derive.certify.verifier_boxes import Box
from freebeam_derive.certify.verifier_claims import ORDERS, Refused
from freebeam_derive.certify.verifier_load_size import load_size
from freebeam_derive.certify.verifier_of_sections import FORMATS, Frequencies
from freebeam_derive.certify.verifier_pieces import Pieces
from freebeam_derive.certify.verifier_sections import Sections, sections
from freebeam_derive.certify.verifier_waves import Apart, _norm
from tests.certify.test_frequency_gaps import frequencies, matrices, system
from tests.front.test_proofs import run

Data = dict[str, Any]
BITS = 128
KEPT: dict[str, Any] = {}  # F and frequencies of a column
CASES: dict[str, tuple[str, dict[str, str]]] = {
    "a mass that turns": ("pflueger", {"J": "0.1"}),
    "a spring, divergence": ("tip-spring", {"k": "40"}),
    "dead load": ("beck-dead-load", {}),
}
COLUMNS: dict[str, tuple[str, dict[str, str]]] = {
    "tip mass": ("pflueger", {"J": "0.1"}),
    "spring": ("tip-spring", {"k": "30"}),
    "hanging": ("beck-self-weight", {"g": "-5"}),
    "step and mass": ("step", {"a": "0.6", "r": "0.5", "mu": "0.3"}),
    "wedge": ("wedge", {"tau": "0.1"}),
    "cone": ("cone", {"tau": "0.15"}),
}


@cache
def found(case: str) -> Any:
    name, own = CASES[case]
    return fb.exact_load(fb.column(name), digits=15, **own)  # type: ignore[arg-type]


def certificate(case: str) -> Data:
    data: Data = json.loads(json.dumps(found(case).unverified))
    return data


@cache
def column(case: str) -> tuple[Any, Sections]:
    it = system(*COLUMNS[case])
    stated = _sections(it.kernel, Question(1, Fraction(0), Fraction(0), None, dict(it.own)))
    return it, sections(tuple(stated["ends"]), tuple(map(Fraction, stated["breaks"])), stated["forms"])


@pytest.fixture(autouse=True)
def computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """F and the frequencies of a column, for all the forgeries that leave it."""

    def pieces(of: Sections) -> Pieces:
        if repr(of) not in KEPT:
            KEPT[repr(of)] = Pieces(of)
        known: Pieces = KEPT[repr(of)]
        return known

    class Once(Frequencies):
        def all(self, count: int = 1) -> list[tuple[arb, arb]]:
            key = repr((self.beyond, self.F, count))
            if key not in KEPT:
                KEPT[key] = super().all(count)
            known: list[tuple[arb, arb]] = KEPT[key]
            return known

    monkeypatch.setattr(verifier_of_sections, "Pieces", pieces)
    monkeypatch.setattr(verifier_of_sections, "Frequencies", Once)


def verify(data: Data) -> Any:
    return verifier.verify(data, FORMATS)


def refused(data: Data, match: str) -> None:
    with pytest.raises(Refused, match=match):
        verify(data)


def forged(case: str, change: Callable[[Data], Any]) -> Data:
    data = certificate(case)
    change(data)
    return data


def shifted(pair: list[str], factor: str) -> list[str]:
    return [str(Fraction(v) * Fraction(factor)) for v in pair]


# ------------------------------------------------------------ whole certificates


@pytest.mark.parametrize("case", CASES)
def test_a_certificate_is_accepted_as_it_was_written(case: str) -> None:
    proven = found(case)
    assert all(proven.proof.values()) and proven.missing == "" and proven.evidence["reach"] > float(proven.load[0])
    stated = verify(certificate(case))
    assert stated.kind == proven.kind
    assert stated.load[0] < Fraction(proven.load[1]) and Fraction(proven.load[0]) < stated.load[1]
    text = str(stated)
    assert "the beam itself, the forms in this file (which names them" in text and "undamped" in text
    assert "it is the first over all modes" in text and "stable is every load from 0 up to it" in text
    assert stated.record()["of"] == "the beam itself: the forms in this file"


def test_a_claim_that_is_moved_is_refused() -> None:
    data = certificate("a mass that turns")
    for name in ("load", "frequency_squared"):
        refused(data | {name: shifted(data[name], "1.0001")}, "no crossing in the interval")
    refused(data | {"load": shifted(data["load"], "2")}, "no crossing in the interval")
    refused(data | {"load": shifted(data["load"], "6")}, "too narrow|not known to be free|no crossing")
    refused(data | {"kind": "divergence", "frequency_squared": None}, "no crossing in the interval")
    refused(data | {"proof": data["proof"] | {"first": False}}, "what is said to be proven")
    refused(data | {"ends": ["clamped", "pinned"]}, "no crossing|not known to be free|known to be apart")
    refused(data | {"ends": ["free", "free"]}, "held by springs alone|not known")
    spring = certificate("a spring, divergence")
    refused(spring | {"kind": "flutter", "frequency_squared": ["100", "101"]}, "no crossing in the interval")


def test_another_column_is_refused() -> None:
    """A mass, its rotary inertia, the stiffness and the load a little other than what was proven."""
    for form, where, n, last in (("M", "points", 0, "1.001"), ("M", "points", 1, "0.1001"),
                                 ("M", "along", 0, "1.001"), ("E", "along", 0, "1.001")):  # fmt: skip
        data = certificate("a mass that turns")
        assert Fraction(data["forms"][form][where][n][-1]) != Fraction(last)
        data["forms"][form][where][n][-1] = last
        refused(data, "no crossing in the interval")
    data = certificate("a mass that turns")
    data["forms"]["H"]["points"] = []
    refused(data, "no crossing in the interval")


def test_lines_that_are_not_free_are_refused() -> None:
    """A line moved over an eigenvalue, to either side, or next to one; and m with it."""
    case = "a mass that turns"
    data = certificate(case)
    line, points = Fraction(data["line"]), data["stretches"][0]["points"]
    second, third = frequencies(system(*CASES[case]), 3)[1:] ** 2
    assert second < line < third
    for moved in (second * 0.999, second * 1.001, third * 0.999, third * 1.001, 20 * float(line)):
        refused(data | {"line": str(Fraction(moved))}, "not known to be free|beyond the line that is free")

    def one_less(d: Data) -> None:
        d["lowest"], d["line"] = 1, str(Fraction(points[1]) * Fraction(11, 10))
        for stretch in d["stretches"]:
            del stretch["points"][1]
            stretch["moving"] = None if stretch["moving"] is None else 0

    def one_more(d: Data) -> None:
        d["lowest"], d["line"] = 3, str(line * 20)
        for stretch in d["stretches"]:
            stretch["points"].append(str(line * 19))

    refused(forged(case, one_less), "too narrow|not known to be free|beyond the line")
    # with a third eigenvalue told by signs the same is proven, without its change of sign it is not
    more = forged(case, one_more)
    assert verify(more).load == verify(data).load
    for stretch in more["stretches"]:
        stretch["points"][-1] = str(line * Fraction(101, 100))
    refused(more, "not known to change sign")
    refused(data | {"lowest": 40}, "too few points")


def test_stretches_and_points_that_are_altered_are_refused() -> None:
    def altered(change: Callable[[Any], Any]) -> Data:
        return forged("a mass that turns", lambda d: change(d["stretches"]))

    line = certificate("a mass that turns")["line"]
    refused(altered(lambda s: s.pop(0)), "leave a gap")
    refused(altered(lambda s: s.pop()), "moves that should not, or does not")
    refused(altered(lambda s: s[0]["points"].__setitem__(1, "1/2")), "not known to change sign")
    refused(altered(lambda s: s[0]["points"].__setitem__(2, str(2 * Fraction(line)))), "beyond the line that is free")
    refused(altered(lambda s: s[-1].update(slope="100")), "not known on the line|does not stay")


def test_what_is_no_such_column_is_refused() -> None:
    def form(name: str, part: str, term: list[Any]) -> Data:
        return forged("a mass that turns", lambda d: d["forms"][name][part].append(term))

    refused(form("M", "along", [0, 1, 1, 1, "1"]), "the mass is none of the displacement")
    refused(form("M", "along", [0, 1, 0, 0, "-2"]), "not known to be positive")
    refused(form("E", "along", [0, 1, 2, 2, "-1"]), "not known to be positive")
    refused(form("E", "along", [0, 0, 1, 1, "-3"]), "elastic energy is not known to be positive")
    refused(form("E", "along", [0, 0, 0, 1, "1"]), "elastic energy is not symmetric")
    refused(form("H", "along", [0, 0, 2, 2, "1"]), "acts on curvatures")
    for p, q in ((3, 0), (0, 3), (3, 3)):
        refused(form("H", "along", [0, 0, p, q, "1"]), "no such segment, power, order or place")
    refused(form("M", "points", [1, 0, 1, 1, "1"]), "couples two places, or is negative")
    refused(form("E", "points", [1, 0, 1, 0, "-1"]), "couples two places, or is negative")
    refused(form("E", "points", [2, 0, 2, 0, "1"]), "no such segment, power, order or place")
    refused(form("H", "points", [1, 1, 1, 0, "1"]), "too narrow|no crossing|not known")
    refused(certificate("a mass that turns") | {"breaks": ["0", "1/2"]}, "do not ascend from 0 to 1")
    refused(certificate("a mass that turns") | {"more": 1}, "fields are missing, or not known")


def test_a_load_on_a_place_without_a_mass_counts() -> None:
    """A dead load, whose form is of y' and v' alone, at a tip that carries no mass."""
    refused(forged("dead load", lambda d: d["forms"]["H"].update(points=[])), "too narrow for such a load")


def test_of_sections_the_mass_alone_is_such_a_damping() -> None:
    data = certificate("a spring, divergence")
    form = data["forms"]["M"]
    half = [[*term[:-1], str(Fraction(term[-1]) / 2)] for term in form["along"]]
    assert "C = 0.5 M" in str(verify(data | {"damping": {"form": form | {"along": half}, "vanishing": True}}))
    stated = verify(data | {"damping": {"form": form, "vanishing": True}})
    assert "in the limit of vanishing damping in the direction of C = 1 M" in str(stated)


def test_the_command_line_writes_what_it_verifies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "proof.json"
    asked = ["critical", "--column", "pflueger", "--digits", "12", "--exact", "--certificate", str(file)]
    assert run(capsys, *asked, "--set", "J=0.1")[0] == 0
    status, text, _ = run(capsys, "verify", str(file))
    assert status == 0 and "which names them pflueger, mu = 1, J = 0.1" in " ".join(text.split())


# ------------------------------------------------------------ the verifier's own mathematics


@pytest.mark.parametrize("case", [*COLUMNS][:-1])  # a cone takes ten seconds
def test_both_functions_have_the_same_zeros(case: str) -> None:
    """Their quotient is one number for all p and s."""
    it, of = column(case)
    quotients = []
    with flint.ctx.workprec(BITS):
        F = Pieces(of)
        for p, s in ((1, 50), (2, 90)):
            ours = Box(F, arb(p), arb(s), 0).value(arb(p), arb(s))
            quotients.append(ours / it.taylor(arb(p), arb(s), ((0, 0),))[0, 0])
    assert all(q.overlaps(quotients[0]) and q.rad() < 1e-12 for q in quotients) and abs(quotients[0]) > 0


def test_what_is_left_out_at_one_s_is_known_as_far_as_F_is() -> None:
    """Its slope by Cauchy's estimate: the rest is bounded for |s| ≤ S, and so from s on by S − |s|."""
    with flint.ctx.workprec(32):
        box = Box(Pieces(column("tip mass")[1]), arb(0), arb(200), 1)
        assert box.rest(0, 1) >= box.whole.rest / (box.whole.S - 200) > 0


@pytest.mark.parametrize("case", COLUMNS)
def test_the_loads_size_is_above_that_in_a_series(case: str) -> None:
    it, of = column(case)
    M, E, K = matrices(it, 16)
    left, right = (np.linalg.inv(np.linalg.cholesky(part)) for part in (M, E))
    size = np.linalg.norm(left @ (K - E) @ right.T, 2)
    with flint.ctx.workprec(BITS):
        bound = float(load_size([of]).constant)
    assert size * (1 - 1e-12) <= bound < 2 * size  # rounding of the series


@pytest.mark.parametrize("case", COLUMNS)
def test_no_frequency_is_left_out_and_high_ones_are_apart(case: str) -> None:
    it, of = column(case)
    omega = frequencies(it, 12)
    with flint.ctx.workprec(BITS):
        apart = Apart(of)
        known = Frequencies(Pieces(of), arb(7), apart.whole).all()
        assert known[-1][0] > 49 and (len(known) < 2 or known[-2][1] < 49.01)
        for (low, high), value in zip(known, omega, strict=False):
            assert float(low) * (1 - 1e-9) <= value <= float(high) * (1 + 1e-9)
        G, gap = map(float, apart.gap(lambda *_: arb(3)))
    high = omega[omega > G**2]
    assert len(high) > 2 and 3 < gap < np.diff(high).min()


@pytest.mark.parametrize("case", ["tip mass", "hanging", "step and mass", "wedge"])
def test_waves_and_a_rest_are_the_characteristic_function(case: str) -> None:
    """Beside the prover's F, up to a factor that is a power of γ times e^(θ); and the slope's bound by differences."""
    it, of = column(case)

    def exact(g: float) -> Any:
        return it.taylor(arb(0), arb(g) ** 4, ((0, 0),))[0, 0] * (-arb(g) * apart.whole.mid()).exp()

    def main(g: float) -> Any:
        total = acb(0)
        for wave, (B,) in apart.stages[-1].items():
            turn = sum((s * L.mid() for s, L in zip(wave, apart.lengths, strict=True)), arb(0))
            total += B(arb(1) / g) * acb(0, turn * arb(g)).exp()
        assert abs(total.imag) < 1e-20
        return total.real

    with flint.ctx.workprec(2 * BITS):
        apart = Apart(of)
        # where waves are large, to find the factor; its power is a whole number
        far = [max((40.0, 40.3, 40.7), key=lambda g: abs(float(main(g))))]
        far += [max((20.0, 20.4, 20.8), key=lambda g: abs(float(main(g))))]
        c, d = (float(exact(g) / main(g)) for g in far)
        power = round(np.log(c / d) / np.log(far[0] / far[1]))
        scale = c / far[0] ** power
        rest = apart.rest(arb(far[0]), arb(0))
        assert rest is not None
        unsure = 1.1 * float(rest / abs(main(far[0])))
        for g in (4.0, 5.5, 7.0, 12.0):
            bound = apart.rest(arb(g), arb(0))
            wide = apart.rest(arb(g) - 1 / apart.whole, 1 / apart.whole)
            off = [float(exact(x) / (scale * x**power) - main(x)) for x in (g, g + 0.01)]
            slack = unsure * abs(float(exact(g) / (scale * g**power)))
            if bound is not None:
                assert abs(off[0]) <= float(bound) + slack
            if wide is not None:
                assert abs(off[1] - off[0]) / 0.01 <= float(wide * apart.whole) + 10 * slack
        assert bound is not None and wide is not None and abs(off[0]) > 1e-5 * float(bound)


def test_what_is_left_out_of_waves_is_no_less_than_where_all_is_coupled_as_much_as_it_may_be() -> None:
    """w' = (5/8 ε A + ε³ H) w + E v, v' = −(γ − E) v + E w, E = ε A + ε³ H: the waves and the others on a segment."""
    other = verifier_waves._wedge(*([acb(k) ** d / 2 for d in range(4)] for k in (1, -1)))
    same = [[acb_poly([int(i == j)]) for j in range(6)] for i in range(6)]
    L, g = 2.0, 7.0
    for A, H, w, v in product((0.0, 0.8), (0.0, 60.0), (0.0, 1.0), (0.0, 1.0)):
        them: Any = object.__new__(Apart)
        them.segments = [SimpleNamespace(length=arb(L), A=(arb(A), arb(A * L)), H=(arb(H), arb(H * L)))]
        z = [acb_poly([w * u + v * x]) for u, x in zip(verifier_waves.UNITS[1], other, strict=True)]
        them.joints, them.stages = [None, same], [{(): z}]
        E = A / g + H / g**3
        end = expm(L * np.array([[5 / 8 * A / g + H / g**3, E], [E, E - g]])) @ [w, v]
        truth = end[0] - w + end[1]
        with flint.ctx.workprec(BITS):
            rest = them.rest(arb(g), arb(0))
            assert rest is not None and truth <= float(rest) * (1 + 1e-12) <= 3 * truth + 1e-9


def test_the_inverse_of_what_carries_waves_is_one() -> None:
    """With nothing above the diagonal either."""
    draw = np.random.default_rng(6)
    rows = [[arb(int(draw.integers(1, 9))) if i == k else arb(int(v)) if i > k else arb(0) for k, v in enumerate(line)]
            for i, line in enumerate(draw.integers(-9, 9, (4, 4)))]  # fmt: skip
    with flint.ctx.workprec(BITS):
        found = verifier_waves._inverse(rows)
        for one, other in ((rows, found), (found, rows)):
            product = arb_mat(one) * arb_mat(other)
            assert all(abs(product[i, k] - int(i == k)) < 1e-30 for i in range(4) for k in range(4))
            assert all(v == 0 for i, line in enumerate(found) for v in line[i + 1 :])


@pytest.mark.parametrize("mass", [0, 1, 2, 3])
def test_a_joint_does_to_minors_what_its_springs_and_masses_do(mass: int) -> None:
    """EI y'' jumps by (c − J ω²) y' and −(EI y'')' by (k − μ ω²) y, of units γ^i, times γ^−3 for J and γ^−1 for μ."""
    k, c, mu, J = Fraction(7), Fraction(-2), Fraction(3 * (mass & 1)), Fraction(5 * (mass >> 1))
    column = Sections(
        ("free", "free"), (Fraction(0), Fraction(1)), [fmpq_poly([1])], [fmpq_poly([1])], [{}], [{}],
        {(1, 0): mu, (1, 1): J}, {(1, 0): k, (1, 1): c}, {},
    )  # fmt: skip
    found = verifier_waves._joint([column], 1)
    for gamma in (0.5, 3.0):
        jump = np.eye(4)
        jump[2, 1], jump[3, 0] = (float(c) - float(J) * gamma**4) / gamma, (float(k) - float(mu) * gamma**4) / gamma**3
        factor = gamma ** -(3.0 * (J != 0) + (mu != 0))
        for i, rows in enumerate(verifier_waves.MINORS):
            for j, columns in enumerate(verifier_waves.MINORS):
                wanted = factor * np.linalg.det(jump[np.ix_(rows, columns)])
                assert float(found[i][j](arb(1) / gamma)) == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def test_minors_of_a_triangle_have_the_powers_of_its_places() -> None:
    """Row i, column k of what carries waves is a factor of ε^(i−k)."""
    draw = np.random.default_rng(7)
    rows = np.tril(draw.integers(1, 9, (4, 4))).astype(float)
    found = verifier_waves._of_minors([[arb(v) for v in line] for line in rows])
    for e in (0.5, 3.0):
        whole = np.array([[rows[i, k] * e ** (i - k) for k in range(4)] for i in range(4)])
        for i, pair in enumerate(verifier_waves.MINORS):
            for j, columns in enumerate(verifier_waves.MINORS):
                wanted = np.linalg.det(whole[np.ix_(pair, columns)])
                assert float(found[i][j](arb(e))) == pytest.approx(wanted, rel=1e-12, abs=1e-9)


@pytest.mark.parametrize("turned", [False, True])
def test_what_couples_waves_is_known_to_within_the_width_of_a_piece(turned: bool) -> None:
    """The largest |A| and |H| on a segment and their integrals over z: no less than those of values at many points."""
    along = fmpq_poly([1, -1] if turned else [0, 1])
    EI, m, k, n = (fmpq_poly(f)(along) for f in ([5, -3, 1], [4, -2, -1], [2, 1], [1, -3]))
    column = Sections(
        ("clamped", "free"), (Fraction(0), Fraction(1)), [EI], [m], [{0: k, 1: n}], [{}], {}, {}, {},
    )  # fmt: skip
    with flint.ctx.workprec(BITS):
        segment, points = verifier_waves.Segment(column, 0), (np.arange(400) + 0.5) / 400
        A, H, rates = np.array([[float(v) for v in verifier_waves._local(column, 0, arb(x))] for x in points]).T
    assert float(segment.length) == pytest.approx(rates.mean(), rel=1e-3)
    for (largest, whole), values in ((segment.A, A), (segment.H, H)):
        for bound, value in ((largest, abs(values).max()), (whole, (abs(values) * rates).mean())):
            assert value * 0.999 < float(bound) < 1.25 * value


def test_waves_have_the_equation_and_the_end_values_of_the_section() -> None:
    """With y = ρ w and the load at rest, at places: m ρ (w'''' − (A w')' + H w) in z is the equation of y in x, and
    (w, w', w'', w''' − A w') gives y, y', moment and shear force."""
    m, EI, N, k = (fmpq_poly(f) for f in ([2, -1], [3, 1, -1], [5, 2, 7], [4, -3]))
    of = Sections(("clamped", "free"), (Fraction(0), Fraction(1)), [EI], [m], [{0: k, 1: N}], [{}], {}, {}, {})
    with flint.ctx.workprec(400):
        h, polynomial = arb(2) ** -100, fmpq_poly([1, -2, 3, 1, -4, 2])
        for x in (arb("0.2"), arb("0.7")):
            y, mass, bend, axial, spring = (
                arb_series(arb_poly(f)(arb_poly([x, 1])).coeffs(), prec=8) for f in (polynomial, m, EI, N, k)
            )
            rate = (mass / bend).sqrt().sqrt()
            rho = (rate / mass).sqrt()
            w = [y / rho]
            for _ in range(4):
                w.append(w[-1].derivative() / rate)
            A, H, _ = verifier_waves._local(of, 0, x)
            above, below = (verifier_waves._local(of, 0, x + side)[0] for side in (h, -h))
            slope = (above - below) / (2 * h) / rate[0]  # of A, in z
            moment = bend * y.derivative().derivative()
            force = axial * y.derivative() - moment.derivative()
            felt = w[4][0] - A * w[2][0] - slope * w[1][0] + H * w[0][0]
            assert abs((spring * y - force.derivative())[0] - mass[0] * rho[0] * felt) < 1e-40
            u = [w[0][0], w[1][0], w[2][0], w[3][0] - A * w[1][0]]
            wanted = [y[0], y[1], moment[0], force[0]]
            for row, value in zip(verifier_waves._turned(of, 0, x), wanted, strict=True):
                assert abs(sum((a * b for a, b in zip(row, u, strict=True)), arb(0)) - value) < 1e-40


def test_a_wave_and_its_slope_are_not_both_small() -> None:
    """2 b cos(L γ + φ) and its slope: at any phase one is larger than what is left out, if that is in their ellipse."""
    b, L = 0.5, 3
    for value, slope in ((0.9, 0.3), (0.2, 0.9), (0.9, 0.5), (0.6, 0.9)):
        them: Any = object.__new__(Apart)
        them.stages = [{(sign,): [acb_poly([acb(0, sign).exp() * b])] for sign in (1, -1)}]
        them.lengths, them.whole, them.same = [arb(L)], arb(L), [0]
        of_slope = 2 * b * slope  # of L times it, by Cauchy's estimate on a circle of 1/L
        them.rest = lambda G, eta, value=value, of_slope=of_slope: arb(of_slope if eta > 0 else 2 * b * value)
        assert them._cells_apart(arb(0), arb(9), arb("0.001")) == (value**2 + slope**2 < 1)


def test_a_gap_that_is_too_wide_is_not_claimed() -> None:
    """With the rest of the waves left out two zeros would seem further apart than they are."""
    _, of = column("step and mass")
    with flint.ctx.workprec(BITS):
        apart = Apart(of)
        epsilon, G = arb("0.0125").union(arb("0.0126")), arb(79)
        assert apart._cells_apart(epsilon, G, arb("0.15"))
        assert not apart._cells_apart(epsilon, G, arb.pi() / apart.whole)
        fewer = {wave: B for wave, B in apart.stages[-1].items() if wave[0] == wave[1]}
        apart.stages[-1] = fewer
        assert apart._cells_apart(epsilon, G, arb("0.9") * arb.pi() / 2 / apart.whole)


def test_the_norm_of_a_matrix_is_no_less_than_it_makes_a_vector_larger() -> None:
    """And no more than Frobenius's norm, and than the mean of those of its rows and its columns."""
    random = np.random.default_rng(1)
    for size in (1e-3, 1.0, 1e3):
        X = random.normal(0, size, (6, 6)) + 1j * random.normal(0, size, (6, 6))
        X[0] *= random.choice([1, 100])
        bound = float(_norm([[acb(v) for v in row] for row in X]))
        rows, columns = (np.abs(X).sum(axis=k).max() for k in (1, 0))
        assert np.linalg.norm(X, 2) <= bound <= (1 + 1e-6) * min(np.linalg.norm(X), np.sqrt(rows * columns))


def test_slopes_of_waves_are_those_of_differences() -> None:
    """Each wave with its phase, by γ, at 1/γ = ε."""
    _, of = column("step and mass")
    with flint.ctx.workprec(4 * BITS):
        apart, h = Apart(of), arb(2) ** -BITS

        def wave_of(k: int, gamma: arb) -> Any:
            wave, value, _ = apart.waves(1 / gamma)[k]
            turn = sum((sign * L.mid() for sign, L in zip(wave, apart.lengths, strict=True)), arb(0))
            return value.mid() * (acb(0, 1) * turn * gamma).exp()

        for gamma in (arb("2.5"), arb(11)):
            for k, (_, value, slope) in enumerate(apart.waves(1 / gamma)):
                unit = wave_of(k, gamma) / value.mid()
                found = (wave_of(k, gamma + h) - wave_of(k, gamma - h)) / (2 * h)
                assert abs(found - slope.mid() * unit) < 1e-20 * abs(found)


def test_a_polynomial_on_a_ball_is_known_as_well_as_its_bend_lets_it() -> None:
    """Of 3 − 2x + 5x² the enclosure reaches the value at the upper end, where all that is added has one sign."""
    with flint.ctx.workprec(BITS):
        for middle, radius in ((arb(1), "0.25"), (arb(2), "0.5"), (arb(1), "0.001")):
            start, end = (middle + side * arb(radius) for side in (-1, 1))
            found = verifier_sections.at(fmpq_poly([3, -2, 5]), start.union(end))
            assert abs(found.upper() - (3 - 2 * end + 5 * end * end)) < 1e-7
            assert found.contains(3 - 2 * start + 5 * start * start)


def test_pieces_are_all_of_a_segment_and_no_more() -> None:
    of = Sections(("free", "free"), (Fraction(0), Fraction(1, 3), Fraction(1)), [], [], [], [], {}, {}, {})
    with flint.ctx.workprec(BITS):
        for n, (low, high) in enumerate(((0.0, 1 / 3), (1 / 3, 1.0))):
            at = low
            for x, width in of.pieces(n):
                ends = float(x.lower()), float(x.upper())
                assert ends == pytest.approx((at, at + float(width)), abs=1e-9)
                at += float(width)
            assert at == pytest.approx(high, abs=1e-9)


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("kinds", list(product(ORDERS, ORDERS)))
def test_a_column_that_springs_alone_hold_is_told(kinds: tuple[str, str], count: int) -> None:
    """Where the ends allow a line a + b x the curvature bounds nothing; κ is then not given."""
    breaks, one = tuple(Fraction(k, count) for k in range(count + 1)), fmpq_poly([1])
    of = Sections(kinds, breaks, [one] * count, [one] * count, [{}] * count, [{}] * count, {}, {}, {})
    held = [[(1.0, float(e)), (0.0, 1.0)][d] for e, kind in enumerate(kinds) for d in (0, 1) if d in ORDERS[kind]]
    assert of.held((1, 0)) == (count == 1 and 0 in ORDERS[kinds[1]])
    if np.linalg.matrix_rank(np.array(held).reshape(-1, 2)) < 2:
        with pytest.raises(Refused, match="held by springs alone"):
            of.reach(0)
    else:
        assert all(0 < k <= 1 for order in (0, 1) for k in of.reach(order))


def test_a_load_at_a_place_is_of_that_place_or_of_the_two_ends() -> None:
    """Of two segments, free at both ends so that no place is held."""
    breaks = (Fraction(0), Fraction(1, 2), Fraction(1))
    along = {name: {"along": [[n, 0, p, p, "1"] for n in (0, 1)], "points": []} for name, p in (("M", 0), ("E", 2))}
    for a, p, b, q in product(range(3), range(2), range(3), range(2)):
        forms = along | {"H": {"along": [], "points": [[a, p, b, q, "1"]]}}
        if a == b or {a, b} == {0, 2}:
            assert sections(("free", "free"), breaks, forms).forces == {((a, p), (b, q)): 1}
            continue
        with pytest.raises(Refused, match="depends on another one"):
            sections(("free", "free"), breaks, forms)


@pytest.mark.parametrize(("at", "of"), [*product((0, 2), (0, 2))])
def test_a_moment_may_follow_the_slope_of_either_end(at: int, of: int) -> None:
    """On a pinned beam, with s = 0: y is a cubic, and bends over without more where the moment is 6 or −3 times it."""
    along = {name: {"along": [[n, 0, p, p, "1"] for n in (0, 1)], "points": []} for name, p in (("M", 0), ("E", 2))}
    forms = along | {"H": {"along": [], "points": [[at, 1, of, 1, "1"]]}}
    static = 6 if at != of else -3
    with flint.ctx.workprec(BITS):
        F = Pieces(sections(("pinned", "pinned"), (Fraction(0), Fraction(1, 2), Fraction(1)), forms))
        below, there, above = (
            Box(F, p, arb(0), 0).value(p, arb(0))
            for p in (arb(static) - arb("0.01"), arb(static), arb(static) + arb("0.01"))
        )
    assert there.contains(0) and below * above < 0


def frequencies_of(F: arb_poly, rest: str) -> Frequencies:
    """Those of a function of u = ω², known but for a rest."""
    them = object.__new__(Frequencies)
    them.F, them.rest, them.scale = F, arb(rest), arb(1)
    return them


def test_a_sign_is_none_where_the_rest_is_larger() -> None:
    for sign in (1, -1):
        them = frequencies_of(sign * arb_poly([arb(-1) / 16, 1]), "0.001")
        for off, seen in (("-0.002", -1), ("-0.0009", 0), ("0.0009", 0), ("0.002", 1)):
            gamma = Fraction((1 / 16 + float(off)) ** 0.25)
            assert them._sign(gamma) == sign * seen


def test_of_the_rest_no_slope_is_known_beyond_half_of_its_disc() -> None:
    """Cauchy's estimate of what is bounded for u ≤ 1 is 1/(1 − u): no more than twice it up to u = 1/2."""
    them = frequencies_of(arb_poly([arb(1), 1]), "0.001")
    for u, known in ((0.3, True), (0.49, True), (0.51, False), (0.9, False), (1.5, False)):
        gamma = Fraction(u**0.25)
        for asked in (lambda g=gamma: them._sign(g), lambda g=gamma: them._between(g * Fraction(15, 16), g, 0)):
            if known:
                asked()
            else:
                with pytest.raises(Refused, match="too far"):
                    asked()


def test_frequencies_close_together_are_each_found_once() -> None:
    """In a stretch that has to be cut for them, within which they are near one side, the middle or the other."""
    high = Fraction(3, 4)
    for place in (0.05, 0.3, 0.42, 0.7, 0.74):
        roots = [place, place + 1e-3, place + 3e-3]
        F = arb_poly([1])
        for root in roots:
            F *= arb_poly([-(arb(root) ** 4), 1])
        with flint.ctx.workprec(BITS):
            found = frequencies_of(F, "1e-30")._between(Fraction(0), high, 0)
        assert len(found) == 3
        assert all(low < root < top and top - low < 1e-4 for root, (low, top) in zip(roots, found, strict=True))
