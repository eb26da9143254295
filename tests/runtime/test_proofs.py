"""Proofs from Python and from the command line: exact inputs, outward decimals, certificates, refusals."""

from __future__ import annotations

import json
import math
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import freebeam_sym as fb
from freebeam_sym.cli import main
from freebeam_derive.certify.decimals import outward
from freebeam_sym.proofs import rational


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


def test_inputs_are_exact_and_say_what_they_were_taken_for() -> None:
    assert rational("alpha", "0.001") == (Fraction(1, 1000), "the decimal 0.001")
    assert rational("alpha", 0.5) == (Fraction(1, 2), "0.5")
    value, said = rational("alpha", 0.001)
    assert value == Fraction(0.001) != Fraction(1, 1000) and "binary" in said
    assert rational("alpha", Fraction(1, 3))[0] == Fraction(1, 3)
    for bad in (float("nan"), float("inf"), "x", None, True, "1/0"):
        with pytest.raises(fb.InputError):
            rational("alpha", bad)


def test_a_decimal_and_its_float_have_different_loads() -> None:
    """At 25 digits the load of alpha = 0.001 is told from that of the binary number nearest to it."""
    column = fb.column("beck")
    exact, binary = (fb.certified_load(column, 4, alpha, 0, digits=25) for alpha in ("0.001", 0.001))
    assert exact.load is not None and binary.load is not None
    assert Decimal(exact.load[1]) < Decimal(binary.load[0]) or Decimal(binary.load[1]) < Decimal(exact.load[0])
    assert abs(Decimal(exact.load[0]) - Decimal(binary.load[0])) < Decimal("1e-12")


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
    """π² is the divergence load of the pinned beam; that no other load is below is not proven over all modes."""
    status, found, _ = run(capsys, "critical", "--digits", "15", "--exact", "--column", "euler-pinned", "--json")
    assert status == 0 and found["proof"] == {"crossing": True, "first": False, "stable_below": False, "kind": True}
    squared = Decimal("9.869604401089358618834490999876")
    assert Decimal(found["load_lower"]) < squared < Decimal(found["load_upper"])


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
    asked = ["critical", "--modes", "6", "--alpha", "0.001", "--beta", "0.1", "--json"]
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
    assert status == 0 and found["verified"] and "diverges" in found["proves"]
    target.write_bytes(first.replace(b'"1/4"', b'"1/5"'))
    assert main(["verify", str(target)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ["--digits", "0"],
        ["--digits", "10001"],
        ["--exact"],
        ["--certificate", "x.json"],
        ["--kappa", "1"],
        ["--alpha", "0+", "--beta", "0.1"],
        ["--digits", "9", "--exact", "--load-max", "20"],
        ["--all"],
        ["--digits", "9", "--exact", "--all"],
        ["--exact", "--truncation", "--digits", "9"],
        ["--digits", "9", "--all", "--load-max", "-5"],
        ["--truncation", "--bending-stiffness", "1", "--mass-per-length", "1", "--length", "1"],
        ["--digits", "9", "--bending-stiffness", "1", "--mass-per-length", "1", "--length", "1"],
    ],
)
def test_nonsense_is_refused_in_one_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run(capsys, "critical", "--modes", "3", *arguments)
    assert status == 2 and not out and err.count("\n") == 1
