"""The ledger: the page is what is computed, each row has its verdict, and what is proven holds by another route."""

from __future__ import annotations

import dataclasses
import json
import re
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import freebeam as fb
from freebeam import cli
from freebeam.ledger import book as books
from freebeam.ledger import loads, proven, responses
from freebeam.ledger.book import CLAIM_VERDICTS, Ledger, judged
from freebeam.ledger.claims import Claim, claims
from freebeam.ledger.finding import CHECKS, Finding, enclosure
from freebeam.ledger.page import page

PAGE = Path(__file__).parents[2] / "docs" / "ledger.md"


def test_the_page_is_what_is_computed(book: Ledger) -> None:
    assert page(book).encode() == PAGE.read_bytes(), "make it again: freebeam validate --output docs/ledger.md --force"


def test_every_row_has_its_verdict(book: Ledger) -> None:
    assert [row.id for row in book.equations if not row.passed] == []
    assert [row.id for row in book.claims if not row.passed] == []
    assert [row.id for row in book.equations] == [f"({n})" for n in range(1, 27)]
    assert {row.verdict for row in book.claims} == set(CLAIM_VERDICTS)
    ids = [row.id for row in book.claims]
    assert len(set(ids)) == len(ids)


def test_every_section_has_its_claims(book: Ledger) -> None:
    sections = ["abstract", "1", "2", "3", "3.1", "3.2", "4.1", "4.2", "4.3", "4.4", "4.5", "5"]
    assert list(dict.fromkeys(row.section for row in book.claims)) == sections
    for section in sections:
        assert any(row.by for row in book.claims if row.section == section)


def test_what_was_not_checked_says_why(book: Ledger) -> None:
    for row, quote in zip(book.claims, claims(), strict=True):
        assert row.quote == quote.text and row.computed
        assert (row.verdict == "not checkable") == (not quote.check) == (not row.by)
        assert quote.check or quote.note
        assert row.verdict != "erratum" or row.note
        assert (row.verdict == "confirmed to the printed digits") == (row.verdict != "erratum" and bool(row.rule))


@pytest.mark.parametrize("entry", [{"check": "scan", "verdict": "not checkable"}, {"verdict": "not checkable"}, {}])
def test_an_incomplete_claim_is_refused(entry: dict[str, str]) -> None:
    with pytest.raises(ValueError, match=r"claim 4\.1-new"):
        Claim("4.1-new", "words", **entry)


def test_no_check_is_idle() -> None:
    assert {quote.check for quote in claims() if quote.check} == set(CHECKS)


def test_judgement() -> None:
    good, digits, wrong = (Finding(holds, "", "proven", rule) for holds, rule in ((1, ""), (1, "scan"), (0, "scan")))
    assert [judged(found) for found in (good, digits, wrong)] == [
        "confirmed",
        "confirmed to the printed digits",
        "erratum",
    ]


@pytest.mark.parametrize(
    ("id_", "change"),
    [
        ("4.1-load", {"printed": "109.7"}),
        ("4.4-load", {"printed": "90.8"}),
        ("4.2-constant", {"printed": "88.1"}),
        ("4.3-constant", {"printed": "109.72"}),
        ("4.3-constant", {"high": "1"}),
        ("4.2-constant", {"high": "0.1"}),
        ("4.5-decays", {"loads": ("91",)}),
        ("4.5-unstable", {"load": "90"}),
        ("4.5-more-load", {"high": "70"}),
        ("4.5-slow-force", {"frequency": "16"}),
        ("3.2-eight", {"count": 7}),
        ("4.1-beal", {"value": "109.5"}),
        ("4.4-left-to-right", {"loads": ("50", "112", "100")}),
        ("5-damped-out", {"loads": ("5", "110")}),
    ],
)
def test_a_claim_with_another_number_fails(id_: str, change: dict[str, object]) -> None:
    (quote,) = (quote for quote in claims() if quote.id == id_)
    wrong = dataclasses.replace(quote, given={**quote.given, **change})
    row = books._claim(wrong, lambda _: None)
    assert not row.passed and row.verdict in ("erratum", "failed")


def test_a_claim_in_the_wrong_direction_fails() -> None:
    """Along β = 0.1 the load does not rise throughout; nor does it fall and rise where it only rises."""
    assert not loads.falls_then_rises("0.02", "0.03", "0.1").holds
    assert not loads.rises("internal", "0.001", "0.0012", "0.1").holds
    assert not responses.fixed_amplitude(("5",)).holds


# --- what is proven, by another route -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("which", "held", "low", "high", "pieces"),
    [
        ("internal", "0", "0.001", "0.1", 24),
        ("internal", "0.1", "0.000001", "0.1", 40),
        ("external", "0", "0.01", "1", 24),
    ],
)
def test_cells_hold_the_loads_of_the_runtime(which: str, held: str, low: str, high: str, pieces: int) -> None:
    """Cells cover the range without a gap, and hold the runtime's load and frequency at dampings inside them."""
    found = proven.cells("free-free", which, held, low, high, pieces)
    of = proven.line("free-free", which, held).of
    assert (found[0].low, found[-1].high) == (of(Fraction(low)), of(Fraction(high)))
    assert all(a.high == b.low for a, b in pairwise(found))
    beam = fb.column("free-free")
    for cell in found[:: max(1, len(found) // 12)]:
        tau = float(cell.low + (cell.high - cell.low) / 3)
        damping = tau**0.5 if held == "0" else tau
        alpha, beta = (damping, float(held)) if which == "internal" else (float(held), damping)
        at = fb.critical_load(beam, alpha=alpha, beta=beta)
        slack = 1e-9
        assert cell.load[0] - slack * at.load <= at.load <= cell.load[1] + slack * at.load
        assert float(cell.square[0]) * (1 - 1e-7) <= at.frequency**2 <= float(cell.square[1]) * (1 + 1e-7)
        near = [float(cell.low + (cell.high - cell.low) * part) for part in (Fraction(1, 10), Fraction(9, 10))]
        dampings = [t**0.5 if held == "0" else t for t in near]
        pair = [
            fb.critical_load(
                beam, alpha=d if which == "internal" else float(held), beta=float(held) if which == "internal" else d
            )
            for d in dampings
        ]
        if cell.rises and abs(pair[1].load - pair[0].load) > 1e-9:
            assert cell.rises == np.sign(pair[1].load - pair[0].load)


@pytest.mark.parametrize(
    ("load", "alpha", "beta"), [("9", "0.001", "0.1"), ("112", "0.001", "0.1"), ("50", "0", "0.3")]
)
def test_eigenvalues_are_enclosed(load: str, alpha: str, beta: str) -> None:
    found = proven.eigenvalues(load, alpha, beta)
    values = fb.spectrum(fb.column("free-free").system(8, float(load), float(alpha), float(beta))).eigenvalues
    assert len(found) == len(values) == 16
    middles = np.array([float(sum(real) / 2) + 1j * float(sum(imaginary) / 2) for real, imaginary in found])
    gap = np.abs(middles[:, None] - values)
    assert gap.min(axis=0).max() < 1e-9 * np.abs(values).max() and gap.min(axis=1).max() < 1e-9 * np.abs(values).max()
    assert len(set(gap.argmin(axis=1))) == 16


def test_the_amplitude_turns_where_the_proof_has_it() -> None:
    """Its slope, by differences of the transfer function, changes its sign in the piece that is left undecided."""
    rising, turn, falling = proven.amplitude().slope_signs("0", "90.85")
    assert (rising[2], turn[2], falling[2]) == (1, 0, -1) and turn[1] - turn[0] <= Fraction(1, 1000)
    beam = fb.column("free-free")

    def amplitude(load: float) -> float:
        s = beam.system(8, load, 1e-3, 0.1)
        return float(abs(s.shapes(0.1) @ np.linalg.solve(-9 * s.M + 3j * s.C + s.K, s.Q(1.0))))

    low, high = proven.amplitude().at("30")
    assert float(low) == pytest.approx(amplitude(30.0), rel=1e-9) and low <= high
    at = np.array([amplitude(P) for P in np.linspace(0, float(turn[0]) - 0.05, 40)])
    assert (np.diff(at) > 0).all()
    at = np.array([amplitude(P) for P in np.linspace(float(turn[1]) + 0.05, 90.85, 40)])
    assert (np.diff(at) < 0).all()


def test_the_drift_is_that_of_newmark() -> None:
    """The matrix exponential of the driven system against the step-by-step response."""
    s = fb.column("free-free").system(8, 5.0, 1e-3, 0.1, rigid=True)
    force = {"force": fb.Harmonic(1e-3, 3.0), "force_position": 1.0}
    response = fb.respond(s, 40.0, 0.005, sensors=[0.1], method="newmark", **force)
    assert responses.drift()["whole"] == pytest.approx(response.y[-1, 0], rel=1e-4)
    assert responses.drift()["elastic part"] == pytest.approx(response.y_elastic[-1, 0], rel=1e-3)


def test_enclosures_round_outwards() -> None:
    third = Fraction(1, 3)
    for digits in (1, 5, 12):
        low, high = map(Fraction, re.findall(r"-?[\d.]+", enclosure((third, third), digits)))
        assert low < third < high and high - low == Fraction(1, 10**digits)
        low, high = map(Fraction, re.findall(r"-?[\d.]+", enclosure((-third, third), digits)))
        assert low < -third and high > third
    assert enclosure((Fraction(109), Fraction(109)), 5) == "109.00"


# --- on the command line ------------------------------------------------------------------------------------


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    status = cli.main(["validate", *arguments])
    return status, capsys.readouterr().out


def test_json(book: Ledger, capsys: pytest.CaptureFixture[str]) -> None:
    status, out = run(capsys, "--json")
    found = json.loads(out)
    assert status == 0 and found["passed"] is True and len(found["loads"]) == 4
    assert len(found["equations"]) == 26 and len(found["claims"]) == len(book.claims)
    for row in found["equations"]:
        assert {"id", "printed", "computed", "verdict"} <= set(row) and row["computed"] and row["printed"]
    for row in found["claims"]:
        assert {"id", "quote", "computed", "verdict"} <= set(row) and row["computed"] and row["quote"]


def test_the_critical_loads_come_last_on_the_screen(book: Ledger, capsys: pytest.CaptureFixture[str]) -> None:
    status, out = run(capsys)
    assert status == 0
    last = out.rstrip().split("\n")[-4:]
    for line, printed in zip(last, ("109.8", "109.73", "88.2", "90.9"), strict=True):
        assert line.split()[3] == printed and line.split()[-1] == "yes"
    for row in book.equations:
        assert any(line.split()[:1] == [row.id] and row.verdict in line for line in out.split("\n"))


def test_the_page_is_written_and_kept(book: Ledger, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "ledger.md"
    assert run(capsys, "--output", str(file))[0] == 0
    assert file.read_text(encoding="utf-8") == page(book)
    assert run(capsys, "--output", str(file))[0] == 2
    assert run(capsys, "--output", str(file), "--force")[0] == 0


def test_a_row_that_fails_is_exit_1(
    book: Ledger, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = dataclasses.replace(book.claims[0], passed=False)
    monkeypatch.setattr(books, "_kept", [Ledger(book.equations, (wrong, *book.claims[1:]))])
    status, out = run(capsys)
    assert status == 1 and "FAILED" in out
    assert run(capsys, "--json")[0] == 1
    wrong_equation = dataclasses.replace(book.equations[3], passed=False)
    monkeypatch.setattr(books, "_kept", [Ledger((wrong_equation, *book.equations[1:]), book.claims)])
    assert run(capsys, "--json")[0] == 1
