"""Proofs from Python and from the command line: exact inputs, outward decimals, certificates, refusals."""

from __future__ import annotations

import json
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import freebeam_sym as fb
from freebeam_sym.cli import main
from freebeam_sym.proofs import outward, rational


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
        ["--digits", "9", "--bending-stiffness", "1", "--mass-per-length", "1", "--length", "1"],
    ],
)
def test_nonsense_is_refused_in_one_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run(capsys, "critical", "--modes", "3", *arguments)
    assert status == 2 and not out and err.count("\n") == 1
