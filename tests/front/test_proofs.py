"""Proofs from Python and from the command line: exact inputs, outward decimals, certificates, refusals."""

from __future__ import annotations

import decimal
import json
import math
import sys
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam.cli import main
from freebeam.proofs import enclosed_load, rational
from freebeam_derive.certify import beam_itself as beams
from freebeam_derive.certify.balls import Unproven
from freebeam_derive.certify.beam import Beam
from freebeam_derive.certify.decimals import outward


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, Any, str]:
    status = main(list(arguments))
    out, err = capsys.readouterr()
    return status, json.loads(out) if out.startswith("{") else out, err


@pytest.mark.parametrize("digits", [1, 5, 12])
@pytest.mark.parametrize(("low", "high"), [("1/3", "1/3"), ("109.7217602376", "109.72176023761"), ("1/700", "1/699")])
def test_decimals_are_rounded_outwards(low: str, high: str, digits: int) -> None:
    below, above = outward(Fraction(low), Fraction(high), digits)
    assert Fraction(Decimal(below)) <= Fraction(low) and Fraction(high) <= Fraction(Decimal(above))
    assert Fraction(Decimal(above)) - Fraction(Decimal(below)) <= Fraction(high) - Fraction(low) + Fraction(
        high
    ) * Fraction(20, 10**digits)


def test_decimals_are_decimals_in_every_type() -> None:
    floats = 0.001, np.float64(0.001), np.float32(0.001), np.array(0.001)
    for value in ("0.001", "1e-3", "1/1000", Fraction(1, 1000), Decimal("0.001"), *floats):
        exact, said = rational("alpha", value)
        assert exact == Fraction(1, 1000) == Fraction(said)


def test_what_is_no_number_is_refused() -> None:
    for bad in (math.nan, math.inf, np.float64("nan"), "x", None, True, np.bool_(True), "1/0", 1j, [1], "1e999999999",
                10**5000, "9" * 5000, np.array([1, 2])):  # fmt: skip
        with pytest.raises(fb.InputError) as caught:
            rational("alpha", bad)
        assert "\n" not in str(caught.value) and len(str(caught.value)) < 200


COLUMN = """
from sympy import Symbol
from freebeam_derive.notation import P, alpha, t, x, y
from freebeam_derive.statement import Column, Parameter, at, delta, integral
mu = Symbol("mu", real=True)
column = Column(
    name="tipped", title="Cantilever with a tip mass under a follower force",
    T=integral(y.diff(t) ** 2) / 2 + mu * at(y.diff(t), 1) ** 2 / 2, V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-alpha * integral(y.diff(x, 2, t) * delta(y.diff(x, 2))) - P * at(y.diff(x), 1) * at(delta(y), 1),
    ends=("clamped", "free"), parameters=(Parameter(mu, "tip mass", 0.1, 0.0, 1.0),),
)
"""


def test_a_default_is_proven_as_the_decimal_that_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A default of 0.1, 0.1 as a float and as text are one question, in every proof; 0.1's binary number is another."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    (tmp_path / "tipped.py").write_text(COLUMN)
    column = fb.column(str(tmp_path / "tipped.py"), "legendre")

    def of_series(**own: Any) -> list[Any]:
        series = fb.certified_load(column, 3, 1e-3, digits=30, **own)
        assert series.unverified is not None
        return [series.load, series.unverified["forms"]]

    def proofs(**own: Any) -> list[Any]:
        beam = enclosed_load(column, 1e-3, digits=30, modes=8, **own)
        crossings = fb.certified_crossings(column, 3, 1e-3, digits=30, load_max=50, **own)
        spectrum = fb.exact_spectrum(column, 2.5, 1e-3, modes=2, digits=30, **own)
        return [*of_series(**own), beam.load, crossings, spectrum.lower, spectrum.upper]

    default = proofs()
    assert default == proofs(mu=0.1)
    assert of_series() == of_series(mu="0.1") == of_series(mu=Fraction(1, 10))
    binary = proofs(mu=Fraction(0.1))
    assert all(a != b for a, b in zip(default, binary, strict=True))
    assert all(fb.exact_load(column, digits=15).proof.values())  # the first: of a mass by gaps between frequencies
    taken = fb.certified_load(column, 3, "1/3", digits=5).inputs
    assert taken["mu"] == "0.1 (default)" and taken["alpha"] == "1/3"
    asked = ["critical", "--column", str(tmp_path / "tipped.py"), "--modes", "3", "--alpha", "0.001", "--digits", "9"]
    assert "mu = 0.1 (default)" in run(capsys, *asked)[1]
    assert run(capsys, *asked, "--json")[1]["inputs"]["mu"] == "0.1 (default)"


# --- SI -------------------------------------------------------------------------------------------------------

SI = {"bending_stiffness": "2.1e7", "mass_per_length": "120.3", "length": "30.1"}
SIZE = {name: Decimal(value) for name, value in SI.items()}
FORCE = SIZE["bending_stiffness"] / SIZE["length"] ** 2  # N in one unit of P


def in_si(*arguments: str) -> list[str]:
    beam = [part for name, value in SI.items() for part in (f"--{name.replace('_', '-')}", value)]
    return ["critical", "--column", "beck", "--json", "--modes", "4", *arguments, *beam]


@pytest.mark.parametrize("of", [(), ("--exact",)])
def test_proofs_in_si_hold_the_nondimensional_ones_scaled(
    of: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    """Undamped, so that both questions are rational: loads by EI/L², frequencies by √(EI/m)/L², rounded outwards."""
    with decimal.localcontext() as context:
        context.prec = 60
        per_second = (SIZE["bending_stiffness"] / SIZE["mass_per_length"]).sqrt() / SIZE["length"] ** 2
        force = SIZE["bending_stiffness"] / SIZE["length"] ** 2
        _, plain, _ = run(capsys, "critical", "--column", "beck", "--json", "--modes", "4", "--digits", "30", *of)
        status, found, _ = run(capsys, *in_si("--digits", "20", *of))
        assert status == 0 and found["units"] == "SI"
        assert (found["kind"], found["proof"]) == (plain["kind"], plain["proof"])
        for name, size in (("load", force), ("frequency", per_second)):
            low, high = Decimal(found[f"{name}_lower"]), Decimal(found[f"{name}_upper"])
            assert low < Decimal(plain[f"{name}_lower"]) * size < Decimal(plain[f"{name}_upper"]) * size < high
            assert high - low < low * Decimal("1e-17")


@pytest.mark.parametrize("of", [(), ("--exact",)])
def test_dampings_in_si_are_irrational_and_proven_all_the_same(
    of: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    """Between the loads of two nondimensional dampings that the true one lies between; the load falls with alpha."""
    with decimal.localcontext() as context:
        context.prec = 60
        time = SIZE["length"] ** 2 * (SIZE["mass_per_length"] / SIZE["bending_stiffness"]).sqrt()
        alpha = Decimal("0.0021") / time
        status, found, _ = run(capsys, *in_si("--digits", "12", "--alpha", "0.0021", *of))
        assert status == 0
        loads = []
        for near in (alpha * (1 + Decimal("1e-20")), alpha * (1 - Decimal("1e-20"))):
            asked = ["critical", "--column", "beck", "--json", "--modes", "4", "--digits", "30", "--alpha", str(near)]
            loads.append(run(capsys, *asked, *of)[1])
        low, high = Decimal(found["load_lower"]), Decimal(found["load_upper"])
        for near in loads:
            assert low < Decimal(near["load_lower"]) * FORCE < high and high - low < low * Decimal("1e-9")


def test_the_limit_and_all_crossings_in_si(capsys: pytest.CaptureFixture[str]) -> None:
    """kappa is in kg/(m s²), by the units of beta and alpha."""
    ratio = SIZE["bending_stiffness"] / SIZE["length"] ** 4  # of one unit of beta by one of alpha
    status, found, _ = run(capsys, *in_si("--digits", "12", "--alpha", "0+", "--kappa", str(3 * ratio)))
    _, plain, _ = run(capsys, "critical", "--column", "beck", "--modes", "4", "--json", "--digits", "15",
                      "--alpha", "0+", "--kappa", "3")  # fmt: skip
    assert status == 0 and math.isclose(found["load"], plain["load"] * float(FORCE), rel_tol=1e-9)
    assert Decimal(found["load_lower"]) < Decimal(plain["load_lower"]) * FORCE < Decimal(found["load_upper"])
    status, found, _ = run(capsys, *in_si("--digits", "9", "--all", "--load-max", str(60 * FORCE), "--set", "eta=0.4"))
    listed = fb.certified_crossings(fb.column("beck"), 4, eta="0.4", load_max=60)
    assert status == 0 and len(found["crossings"]) == len(listed) > 2
    for mine, plain in zip(found["crossings"], listed, strict=True):
        assert Decimal(mine["load_lower"]) < Decimal(plain.load[0]) * FORCE < Decimal(mine["load_upper"])


# --- many digits ------------------------------------------------------------------------------------------------


def test_more_digits_than_python_prints_of_an_integer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """5,000 digits of the series and of the beam begin as 50 do; the limit of the interpreter stays."""
    limit, file = sys.get_int_max_str_digits(), str(tmp_path / "long.json")
    asked = ["critical", "--column", "euler-pinned", "--basis", "legendre", "--modes", "2", "--beta", "0.1", "--json"]
    few = {of: run(capsys, *asked, "--digits", "50", *of)[1] for of in ((), ("--exact",))}
    for of, more in (((), ("--certificate", file)), (("--exact",), ())):
        status, found, _ = run(capsys, *asked, "--digits", "5000", *of, *more)
        assert status == 0 and all(len(found[name]) > 5000 for name in ("load_lower", "load_upper"))
        assert few[of]["load_lower"][:48] == found["load_lower"][:48]
        low, high = (Fraction(Decimal(found[name])) for name in ("load_lower", "load_upper"))
        assert 0 < high - low < low / 10**5000
    status, proven, _ = run(capsys, "verify", file, "--json")
    assert status == 0 and len(proven["load_lower"]) > 5000 and proven["kind"] == "divergence"
    assert sys.get_int_max_str_digits() == limit


# --- a touch ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("modes", [6, 10])
def test_the_touch_of_the_sub_tangential_column(modes: int) -> None:
    """At eta = 1/2 det K of the beam has a double root at π²; in a series it is two roots, which draw together with N.
    The proof of the series is of the first of them, whichever way floats have it; all crossings list both."""
    column = fb.column("beck", "legendre")
    found = fb.certified_load(column, modes, eta=0.5, digits=20)
    assert found.kind == "divergence" and found.load is not None and all(found.proof.values())
    first, second, third = fb.certified_crossings(column, modes, eta=0.5, digits=25, load_max=20)
    assert [c.stability for c in (first, second, third)] == ["lost", "regained", "lost"] and third.kind == "flutter"
    assert Decimal(found.load[0]) < Decimal(first.load[1]) and Decimal(first.load[0]) < Decimal(found.load[1])
    gap = float(Decimal(second.load[0]) - Decimal(first.load[1]))
    assert 0 < gap < {6: 1e-5, 10: 1e-13}[modes] and math.isclose(float(first.load[0]), math.pi**2, rel_tol=1e-8)
    assert math.isclose(float(third.load[0]), 16.0524615772, rel_tol=1e-5)


def test_a_touch_of_the_beam_itself_is_no_divergence() -> None:
    """A double root is not enclosed as a simple one, at any precision; where eta is less it splits, and either is."""
    kernel = fb.column("beck").kernel
    with pytest.raises(Unproven):
        beams.divergence(Beam(kernel, {"eta": Fraction(1, 2)}), math.pi**2, 10)
    below = Fraction(49, 100)
    root = math.acos(-float(below / (1 - below)))
    assert math.isclose(float(beams.divergence(Beam(kernel, {"eta": below}), root**2, 10).load), root**2, rel_tol=1e-9)
    with pytest.raises(beams.NoOnset, match="restabilisation"):
        beams.divergence(Beam(kernel, {"eta": below}), (2 * math.pi - root) ** 2, 10)
    for basis in ("modes", "legendre"):
        found = fb.proofs.enclosed_load(fb.column("beck", basis), eta=0.5)
        assert found.load is not None and found.kind == "flutter" and not found.proof["first"]
        assert math.isclose(float(found.load[0]), 16.0524615772, rel_tol=1e-10)


def test_what_is_proven_stands_before_what_floats_take_for_a_touch(capsys: pytest.CaptureFixture[str]) -> None:
    """Ten polynomials diverge between two loads that are 2e-14 apart: that is the series' load, and it is no beam's."""
    asked = "critical --column beck --basis legendre --modes 10 --set eta=0.5 --digits 20".split()
    status, found, _ = run(capsys, *asked, "--json")
    assert status == 0 and found["kind"] == "divergence" and found["frequency"] == 0 and found["proof"]["first"]
    assert math.isclose(found["load"], float(found["load_lower"]), rel_tol=1e-15) and not found["converged"]
    assert "not known" in found["truncation"]["unknown"] and found["beam"]["kind"] == "flutter"
    text = run(capsys, *asked)[1]
    assert "flutter at 16.05" in text and "stability is not lost" not in text


def test_the_contract_of_critical_with_digits(capsys: pytest.CaptureFixture[str]) -> None:
    status, found, _ = run(
        capsys, "critical", "--digits", "20", "--column", "beck", "--modes", "4", "--alpha", "0.01", "--json"
    )
    assert status == 0
    assert set(found["proof"]) == {"crossing", "first", "stable_below", "kind"} and all(found["proof"].values())
    for name in ("load", "frequency"):
        low, high = Decimal(found[f"{name}_lower"]), Decimal(found[f"{name}_upper"])
        assert low < high and (high - low) / low < Decimal("1e-17")
        assert abs(Decimal(found[name]) - low) < Decimal("1e-9") * low


def test_the_beam_itself_claims_no_more_than_it_proves(capsys: pytest.CaptureFixture[str]) -> None:
    """π² is the divergence load of the pinned beam, and the first; at η = 1/2 ω² touches zero there, and the flutter is
    the first loss; of a cracked column with internal damping nothing is proven below it."""
    status, found, _ = run(capsys, "critical", "--digits", "15", "--exact", "--column", "euler-pinned", "--json")
    assert status == 0 and found["proof"] == {"crossing": True, "first": True, "stable_below": True, "kind": True}
    assert found["missing"] is None and found["evidence"]["reach"] > found["load"]
    squared = Decimal("9.869604401089358618834490999876")
    assert Decimal(found["load_lower"]) < squared < Decimal(found["load_upper"])
    asked = ["critical", "--digits", "15", "--exact", "--column", "beck", "--set", "eta=0.5"]
    _, beyond, _ = run(capsys, *asked, "--json")
    (touch,) = beyond["proven_touches"]
    assert all(beyond["proof"].values()) and beyond["load"] > 16 and touch["stability"] == "touched"
    assert Decimal(touch["load_lower"]) < squared < Decimal(touch["load_upper"])
    asked = ["critical", "--digits", "15", "--exact", "--column", "crack", "--alpha", "0.01"]
    status, found, _ = run(capsys, *asked, "--json")
    assert status == 0 and found["proof"] == {"crossing": True, "first": False, "stable_below": False, "kind": True}
    assert found["evidence"] is None and found["missing"] in " ".join(run(capsys, *asked)[1].split())


def test_all_crossings_up_to_a_load(capsys: pytest.CaptureFixture[str]) -> None:
    """Between the listed loads as many eigenvalues of the spectrum grow as they say."""
    asked = ["--column", "beck", "--set", "eta=0.4", "--modes", "4", "--load-max", "60", "--beta", "0.5"]
    status, found, _ = run(capsys, "critical", "--digits", "12", "--all", *asked, "--json")
    assert status == 0
    listed = found["crossings"]
    assert [c["stability"] for c in listed] == ["lost", "regained", "lost"]
    assert found["load_lower"] <= listed[0]["load_upper"] and listed[0]["load_lower"] <= found["load_upper"]
    column = fb.column("beck")
    for c in listed:
        low, high = float(c["load_lower"]), float(c["load_upper"])
        assert 0 < high - low < 1e-11 * high
        for load, count in ((low - 1e-3, c["unstable_below"]), (high + 1e-3, c["unstable_above"])):
            values = fb.spectrum(column.system(modes=4, load=load, beta=0.5, eta=0.4)).eigenvalues
            assert (values.real > 0).sum() == count
    status, text, _ = run(capsys, "critical", "--digits", "12", "--all", *asked)
    assert status == 0 and text.count("regained") == 1 and "no other" in text


def test_where_nothing_crosses_it_is_stability_that_is_proven(capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["critical", "--digits", "9", "--all", "--load-max", "15", "--column", "beck", "--modes", "3"]
    status, found, _ = run(capsys, *asked, "--json")
    assert status == 0 and found["load_lower"] is None and found["crossings"] == []
    assert found["proof"] == {"crossing": False, "first": False, "stable_below": True, "kind": True}
    assert "stable up to 15" in run(capsys, *asked)[1]


def test_a_limit_says_its_ratio(capsys: pytest.CaptureFixture[str]) -> None:
    _, found, _ = run(capsys, "critical", "--alpha", "0+", "--kappa", "1/2", "--modes", "2", "--json")
    assert found["kappa"] == 0.5
    assert "kappa = 0" in run(capsys, "critical", "--alpha", "0+", "--modes", "2")[1]


def test_the_truncation_error_is_the_difference_of_two_proofs(capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["critical", "--column", "beck", "--modes", "6", "--alpha", "0.001", "--beta", "0.1", "--json"]
    status, found, _ = run(capsys, *asked, "--digits", "25")
    assert status == 0
    _, beam, _ = run(capsys, *asked, "--digits", "25", "--exact")
    low = Decimal(found["load_lower"]) - Decimal(beam["load_upper"])
    high = Decimal(found["load_upper"]) - Decimal(beam["load_lower"])
    off = found["truncation"]
    assert Decimal(off["difference_lower"]) <= low and high <= Decimal(off["difference_upper"])
    assert Decimal(off["difference_upper"]) - Decimal(off["difference_lower"]) < high * Decimal("1e-4")
    status, plain, _ = run(capsys, *asked, "--truncation")
    assert status == 0 and "load_lower" not in plain and "truncation" not in run(capsys, *asked)[1]
    assert plain["truncation"]["difference_lower"] == off["difference_lower"]


def test_a_crossing_that_truncation_invents_has_no_known_error(capsys: pytest.CaptureFixture[str]) -> None:
    """The free-free beam's divergence at 81 for one mode is nowhere in the exact beam."""
    status, found, _ = run(capsys, "critical", "--modes", "1", "--digits", "10", "--json")
    assert status == 0 and found["kind"] == "divergence" and found["proof"]["crossing"]
    assert "not known" in found["truncation"]["unknown"]


@pytest.mark.parametrize("name", ["free-free", "beck"])
def test_ten_digits_of_the_exact_load_with_twenty_polynomials(name: str) -> None:
    modes = 20 - fb.column(name).rigid_count
    found = fb.truncation_error(fb.column(name, "legendre"), modes)
    assert abs(found.relative) < 1e-10 and found.series.proof["first"]


def test_ten_digits_of_the_damped_load_with_fewer() -> None:
    found = fb.truncation_error(fb.column("beck", "legendre"), 10, "0.001", "0.1")
    assert abs(found.relative) < 1e-10 and found.series.proof["first"]


def test_series_converge_to_the_beam_at_their_rates() -> None:
    """Polynomials: the error's logarithm falls faster than linearly; 16 in all, two of them rigid, give 3e-11, and 20
    give 2e-17. Modes: the error falls with N⁻⁴ or so, and 16 are still off by 1e-3."""
    column, polynomials = fb.column("free-free"), fb.column("free-free", "legendre")
    error = {n: abs(fb.truncation_error(polynomials, n).relative) for n in (6, 10, 14, 18)}
    falls = [math.log(a / b) for a, b in pairwise(error.values())]
    assert all(a < b for a, b in pairwise(falls)) and error[14] < 4e-11 and error[18] < 2e-17
    slow = {n: fb.truncation_error(column, n) for n in (8, 16, 24)}
    for n, m in ((8, 16), (16, 24)):
        assert math.log(slow[n].relative / slow[m].relative) / math.log(m / n) == pytest.approx(4.3, abs=0.4)
    assert 1e-3 < float(slow[16].difference[0]) < 1e-2


def test_eigenvalues_of_the_beam_itself(capsys: pytest.CaptureFixture[str]) -> None:
    """Against the series in 30 polynomials, which at this load is good to more digits than a float has."""
    asked = ["spectrum", "--load", "60", "--alpha", "0.001", "--beta", "0.1", "--modes", "3", "--json"]
    status, found, _ = run(capsys, *asked, "--digits", "12", "--exact")
    assert status == 0 and not found["unproven"] and len(found["eigenvalues_lower"]) == 6
    system = fb.column("free-free", "legendre").system(modes=24, load=60.0, alpha=1e-3, beta=0.1)
    near = fb.spectrum(system).eigenvalues
    for low, high in zip(found["eigenvalues_lower"], found["eigenvalues_upper"], strict=True):
        assert all(Decimal(b) - Decimal(a) < Decimal("1e-9") for a, b in zip(low, high, strict=True))
        value = complex(float(low[0]), float(low[1]))
        assert min(abs(near - value)) < 1e-9 * abs(value)


def test_vanishing_damping_is_the_tangent_rule(capsys: pytest.CaptureFixture[str]) -> None:
    """alpha → 0⁺ with kappa = 0 lies at the load of a tiny alpha, to the square of it."""
    status, found, _ = run(capsys, "critical", "--digits", "12", "--alpha", "0+", "--modes", "4", "--json")
    near = fb.critical_load(fb.column("free-free"), modes=4, alpha=1e-6).load
    assert status == 0 and near is not None
    assert abs(float(found["load_lower"]) - near) < 1e-6 * near


def test_certificates_are_written_kept_and_verified(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "certificate.json"
    asked = ["critical", "--digits", "12", "--column", "beck", "--set", "eta=0.25", "--modes", "2"]
    assert main([*asked, "--certificate", str(target)]) == 0
    first = target.read_bytes()
    capsys.readouterr()
    assert main([*asked, "--certificate", str(target)]) == 2 and target.read_bytes() == first
    assert "--force" in capsys.readouterr().err
    status, found, _ = run(capsys, "verify", str(target), "--json")
    assert status == 0 and found["verified"] and "by divergence" in found["proves"]
    assert found["kind"] == "divergence" and found["frequency_lower"] == "0" and found["modes"] == 2
    assert found["of"] == "the column beck" and found["parameters"] == {"eta": "0.25"} and found["damping"] is None
    assert found["load_lower"] in found["proves"] and found["proves"] in run(capsys, "verify", str(target))[1]
    target.write_bytes(first.replace(b'"1/4"', b'"1/5"'))
    assert main(["verify", str(target)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


CRACKED = """
from freebeam_derive.notation import P, alpha, t, x, y
from freebeam_derive.statement import Column, at, delta, integral, jump
column = Column(
    name="cracked", title="Cracked cantilever under a follower force",
    T=integral(y.diff(t) ** 2) / 2, V=integral(y.diff(x, 2) ** 2) / 2 + 5 * jump(y.diff(x), 0.4) ** 2,
    W_c=P * integral(y.diff(x) ** 2) / 2,
    dW_nc=-alpha * integral(y.diff(x, 2, t) * delta(y.diff(x, 2))) - P * at(y.diff(x), 1) * at(delta(y), 1),
    ends=("clamped", "free"),
)
"""


def test_certificates_of_any_column_are_written_and_verified(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    path, target = tmp_path / "cracked.py", tmp_path / "certificate.json"
    path.write_text(CRACKED)
    asked = ["critical", "--column", str(path), "--modes", "3", "--alpha", "0.01", "--digits", "12"]
    status, proven, _ = run(capsys, *asked, "--certificate", str(target), "--json")
    assert status == 0 and proven["kind"] == "flutter"
    status, found, _ = run(capsys, "verify", str(target), "--json")
    assert status == 0 and found["verified"] and found["of"] == "the forms in this file"
    assert found["breaks"] == ["0", "0.4", "1"] and found["damped"] and found["alpha"] == "0.01"
    low, high = (Fraction(found[f"load_{end}"]) for end in ("lower", "upper"))
    assert low <= Fraction(proven["load_upper"]) and Fraction(proven["load_lower"]) <= high
    said = run(capsys, "verify", str(target))[1]
    assert "names them cracked; that they are its is not checked" in said and found["load_lower"] in said
    target.write_text(target.read_text().replace('"10"', '"11"'))
    assert main(["verify", str(target)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ["--digits", "0"],
        ["--digits", "10001"],
        ["--kappa", "1"],
        ["--alpha", "0+", "--beta", "0.1"],
        ["--digits", "9", "--exact", "--load-max", "20"],
        ["--exact", "--all"],
        ["--column", "beck", "--alpha", "0+", "--kappa=-inf", "--digits", "9"],
        ["--exact", "--truncation", "--digits", "9"],
        ["--digits", "9", "--all", "--load-max", "-5"],
        ["--digits", "9", "--certificate", "x", "--bending-stiffness", "1", "--mass-per-length", "1", "--length", "1"],
        ["--digits", "9", "--bending-stiffness", "1"],
    ],
)
def test_nonsense_is_refused_in_one_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run(capsys, "critical", "--modes", "3", *arguments)
    assert status == 2 and not out and err.count("\n") == 1


@pytest.mark.parametrize("asked", [["--exact"], ["--all", "--load-max", "50"]])
def test_a_proof_has_fifteen_digits_where_none_are_named(asked: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    column = "critical", "--column", "beck", "--modes", "3", "--json", *asked
    (status, out, err), named = run(capsys, *column), run(capsys, *column, "--digits", "15")
    assert status == 0 and not err and out == named[1] and out["proof"]["crossing"]
