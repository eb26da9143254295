"""The columns that come with freebeam: their reference values, with provenance, against what is proven."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import freebeam as fb
import freebeam_sym
from freebeam import cli
from freebeam.ledger import reference_values
from freebeam.ledger.reference_values import Case, printed, statements, validate
from freebeam_derive import pipeline
from freebeam_derive.references import CLOSED_FORM, FAMILIES, TWO_ROUTES, Reference
from freebeam_derive.statement import Column, StatementError, load_column
from tests.reference import discrete
from tests.reference.values import ISSUE, OWN

STATED = statements()
KINDS = {"coalescence": "flutter", "flutter": "flutter", "divergence": "divergence"}


def test_all_are_known_by_their_names() -> None:
    assert set(STATED) == set(fb.column_names()) == set(pipeline.known()) > set(freebeam_sym.column_names())
    assert len(STATED) > 25


@pytest.mark.parametrize("name", STATED)
def test_each_has_a_family_a_source_and_values_with_provenance(name: str) -> None:
    column = STATED[name]
    assert column.family in FAMILIES and column.source and column.references
    own = {p.name for p in column.parameters}
    assert all(set(reference.own) <= own for reference in column.references)
    assert any(reference.by.startswith("computed") for reference in column.references)


def test_two_routes_have_found_what_is_said_to_be_theirs() -> None:
    """tests/test_references.py computes these values by both."""
    theirs = {(value.printed, KINDS[value.kind]) for value in (*ISSUE, *OWN)}
    ours = {(r.load, r.kind) for column in STATED.values() for r in column.references if r.by == TWO_ROUTES}
    assert ours == theirs


def test_zieglers_values_are_those_of_exact_numbers() -> None:
    undamped, vanishing = (r for r in STATED["ziegler"].references if r.by == CLOSED_FORM)
    exact = discrete.undamped(), discrete.slight_damping()
    assert [printed((str(v), str(v)), r.load, r.rule) for v, r in ((exact[0], undamped), (float(exact[1]), vanishing))]
    assert abs(float(undamped.load) - exact[0]) < 1e-14 and vanishing.load == f"{float(exact[1]):.12f}"


def test_a_foundation_changes_no_undamped_load() -> None:
    """What the value's provenance says: k is added to each squared frequency, at any load."""
    column = fb.column("foundation")
    M, bare, given = (column.matrices(6, k=k)[n] for n, k in ((0, 0.0), (1, 0.0), (1, 70.0)))
    assert given == pytest.approx(bare + 70 * M, rel=1e-12, abs=1e-9)


def test_a_load_of_three_modes_is_that_of_the_cantilevers() -> None:
    """Its modes in closed form, integrated by Gauss's rule, against modes of polynomials: the pipe's printed 7.0."""
    roots = np.array([brentq(lambda s: np.cos(s) * np.cosh(s) + 1, 3.1 * k + 0.6, 3.1 * k + 2.6) for k in range(3)])
    x, w = (part / 2 for part in np.polynomial.legendre.leggauss(60))
    X = roots[:, None] * (x + 0.5)
    ratio = ((np.cosh(roots) + np.cos(roots)) / (np.sinh(roots) + np.sin(roots)))[:, None]
    modes = np.cosh(X) - np.cos(X) - ratio * (np.sinh(X) - np.sin(X))
    slopes, bends = roots[:, None] * (np.sinh(X) + np.sin(X) - ratio * (np.cosh(X) - np.cos(X))), roots[:, None] ** 2
    bends = bends * (np.cosh(X) + np.cos(X) - ratio * (np.sinh(X) + np.sin(X)))
    M, B, H = ((modes * w) @ part.T for part in (modes, slopes, bends))
    (given,) = (r for r in STATED["pipe"].references if r.modes)

    def growth(u: float, b: float) -> float:
        inverse = np.linalg.inv(M)
        K, C = inverse @ (M * roots**4 + u**2 * H), inverse @ (2 * math.sqrt(b) * u * B)
        return float(np.linalg.eigvals(np.block([[np.zeros((3, 3)), np.eye(3)], [-K, -C]])).real.max())

    load = brentq(lambda u: growth(u, given.own["b"]), 6.0, 8.0)
    found = reference_values.in_modes(fb.column("pipe"), Case({**given.own, "k": 0.0}), given.modes or 0)
    assert found is not None and float(found[0]) == pytest.approx(load, rel=1e-8)
    assert printed(found, given.load, given.rule) == given.load


FEW = {name: STATED[name] for name in ("ziegler", "self-weight", "tip-spring")}


def test_values_are_confirmed_to_their_last_digit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference_values, "statements", lambda: FEW)
    rows = validate()
    assert len(rows) == sum(len(column.references) for column in FEW.values()) and all(row.passed for row in rows)
    assert {row.computed.proof for row in rows if row.computed} == {"crossing enclosed"}


@pytest.mark.parametrize(
    "wrong",
    [
        {"load": "24.2240402685"},
        {"load": "24.2241"},
        {"kind": "divergence"},
        {"own": {"k": 11.0}},
        {"own": {"k": -100.0}},  # which is unstable without a load
        {"own": {"stiffness": 11.0}},
        {"alpha": -1.0},
        {"rule": "cut off"},
    ],
)
def test_a_wrong_value_is_seen(
    wrong: dict[str, object], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    reference = replace(STATED["tip-spring"].references[0], load="24.22404026845", rule="rounded")
    column = replace(STATED["tip-spring"], references=(replace(reference, **wrong),))  # type: ignore[arg-type]
    monkeypatch.setattr(reference_values, "statements", lambda: {"tip-spring": column})
    (row,) = validate()
    assert not row.passed
    assert cli.main(["validate", "--gallery", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["passed"] is False


@pytest.mark.parametrize(
    ("load", "rule", "like", "expected"),
    [
        (("7.83734", "7.83735"), "rounded", "7.84", "7.84"),
        (("7.83734", "7.83735"), "cut off", "7.83", "7.83"),
        (("7.83734", "7.83735"), "rounded", "7.8373", "7.8373 to 7.8374"),
    ],
)
def test_a_number_is_printed_by_its_rule(load: tuple[str, str], rule: str, like: str, expected: str) -> None:
    assert printed(load, like, rule) == expected


@pytest.mark.parametrize(
    "bad",
    [
        {"load": "-1"},
        {"load": "about 20"},
        {"kind": "buckling"},
        {"rule": "guessed"},
        {"by": ""},
        {"by": "Beck (1952)"},  # published, but seen nowhere
        {"seen": "somewhere"},  # computed, and seen
    ],
)
def test_a_value_without_sense_or_provenance_is_refused(bad: dict[str, str]) -> None:
    good = {"load": "20.05", "kind": "flutter", "by": TWO_ROUTES}
    Reference(**good)
    with pytest.raises(ValueError, match="reference"):
        Reference(**{**good, **bad})


def test_a_statement_holds_references_and_nothing_else() -> None:
    with pytest.raises(StatementError, match="references: must be a tuple of Reference"):
        replace(STATED["beck"], references=("20.05",))


def test_a_user_may_derive_one_of_them(tmp_path: Path) -> None:
    """As any column's file; and none is put beside the kernels that are checked in."""
    outcome = pipeline.generate(["reut"], tmp_path / "kernels", only=["legendre"])
    assert outcome.columns == ("reut",)
    assert isinstance(load_column(pipeline.known()["reut"]), Column)
    assert cli.main(["generate", "reut"]) == 2


def test_the_list_is_by_family(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["columns"]) == 0
    text = capsys.readouterr().out
    places = [text.index(f"\n{family}\n") if k else text.index(family) for k, family in enumerate(FAMILIES)]
    assert places == sorted(places)
    for column in STATED.values():
        family = FAMILIES.index(column.family)
        later = places[family + 1] if family + 1 < len(places) else len(text)
        assert f" {column.name} " in text[places[family] : later]
