"""The benchmark of certified values that is checked in: its rows against the program, other routes and exact laws."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest
from mpmath import mp, mpf, workdps

import freebeam as fb
from freebeam import cli
from freebeam.ledger import benchmark, reference_values
from freebeam.ledger.benchmark import DIGITS, FILES, cases, row_of
from freebeam.ledger.reference_values import printed, statements
from freebeam_derive.definition import formulas

FOLDER = Path(__file__).parents[2] / "docs" / "benchmark"
STATED = statements()
RECORD = json.loads((FOLDER / FILES[1]).read_text(encoding="utf-8"))
VALUES: list[dict[str, Any]] = RECORD["values"]
SAMPLE = ("ziegler", "self-weight", "tip-spring", "euler-pinned")  # some of what is quick, of each kind


def of(system: str, **parameters: float) -> dict[str, Any]:
    """The row of a system with these parameters."""
    (found,) = (v for v in VALUES if v["system"] == system and v["parameters"] == parameters)
    return found


def test_both_files_hold_the_same() -> None:
    with (FOLDER / FILES[0]).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    read = [
        {
            **row,
            "digits": int(row["digits"]),
            "parameters": {name: float(value) for name, value in (p.split("=") for p in row["parameters"].split("; "))},
        }
        for row in rows
    ]
    assert read == VALUES
    assert len({json.dumps([v["system"], v["parameters"]]) for v in VALUES}) == len(VALUES)


@pytest.mark.parametrize("name", SAMPLE)
def test_rows_are_what_is_proven(name: str) -> None:
    column = fb.column(name, "legendre")
    found = [row for case in cases(STATED[name], not column.general) if (row := row_of(column, case))]
    assert [vars(row) for row in found] == [v for v in VALUES if v["system"] == name]


def test_every_system_is_there_and_defined() -> None:
    assert set(RECORD["systems"]) == {v["system"] for v in VALUES} == set(STATED)
    for name in SAMPLE:
        told, found = RECORD["systems"][name], formulas(STATED[name])
        assert {key: told[key] for key in found} == found and told["source"] == STATED[name].source


def test_values_that_other_routes_compute_are_in_the_table() -> None:
    """All but limits that are not enclosed."""
    for name, column in STATED.items():
        defaults = {p.name: p.default for p in column.parameters}
        for r in column.references:
            if r.kappa is None:
                row = of(name, **{**defaults, **r.own}, alpha=r.alpha, beta=r.beta)
                assert row["kind"] == r.kind
                assert (printed((row["load"], row["load"]), r.load, r.rule) == r.load) == (r.modes is None)


def test_all_digits_hold_where_a_closed_form_is_known() -> None:
    with workdps(40):
        for name, load in (
            ("euler-pinned", mp.pi**2),
            ("euler-clamped", 4 * mp.pi**2),
            ("euler-cantilever", mp.pi**2 / 4),
        ):
            (row,) = (v for v in VALUES if v["system"] == name and v["parameters"] == {"alpha": 0.0, "beta": 0.0})
            assert row["digits"] == DIGITS and row["frequency"] == "0"
            assert abs(mpf(row["load"]) - load) <= mpf(10) ** (1 - DIGITS) * load


def test_a_foundation_or_the_line_of_the_force_changes_no_undamped_load() -> None:
    loads = {
        v["load"]
        for v in VALUES
        if v["system"] in ("foundation", "reut") and v["parameters"].get("alpha") == v["parameters"].get("beta") == 0.0
    }
    assert loads == {of("beck", eta=1.0, alpha=0.0, beta=0.0)["load"]}


def test_the_first_mode_of_zieglers_pendulum_meets_the_second() -> None:
    """det(K − ω² M), a polynomial of second degree in ω², has a double root there, whatever the ratio of masses."""
    rows = [v for v in VALUES if v["system"] == "ziegler" and v["parameters"].get("alpha") == 0.0]
    assert len(rows) > 2
    for row in rows:
        with workdps(40):
            mu, P, s = mpf(repr(row["parameters"]["mu"])), mpf(row["load"]), mpf(row["frequency"]) ** 2
            # M = [[1 + μ, 1], [1, 1]], K = [[2 − P, P − 1], [−1, 1]]
            a, b, c = mu, -(mu + 1) - (2 - P) + (P - 1) - 1, mpf(1)
            assert abs(b**2 - 4 * a * c) < mpf(10) ** (2 - DIGITS)
            assert abs(s + b / (2 * a)) < mpf(10) ** (2 - DIGITS)


def test_it_is_written_whole_and_nothing_is_overwritten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for module in (reference_values, benchmark):
        monkeypatch.setattr(module, "statements", lambda: {"ziegler": STATED["ziegler"]})
    folder = tmp_path / "made" / "here"
    arguments = ["validate", "--gallery", "--output", str(folder), "--json"]
    assert cli.main(arguments) == 0
    assert sorted(file.name for file in folder.iterdir()) == sorted(FILES)
    assert json.loads((folder / FILES[1]).read_text(encoding="utf-8"))["values"] == [
        v for v in VALUES if v["system"] == "ziegler"
    ]
    before = (folder / FILES[0]).read_bytes()
    capsys.readouterr()
    assert cli.main(arguments) == 2 and "exists" in capsys.readouterr().err
    assert (folder / FILES[0]).read_bytes() == before
    assert cli.main([*arguments, "--force"]) == 0
