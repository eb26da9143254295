"""Columns of the literature, from their statement to the critical load, against independent codes. Section 3.2."""

from __future__ import annotations

from pathlib import Path

import pytest

import freebeam as fb
from tests.reference.values import ISSUE, OWN, Value
from tests.stated import STATED, stated

KINDS = {"coalescence": "flutter", "flutter": "flutter", "divergence": "divergence"}


@pytest.mark.parametrize("value", [v for v in (*ISSUE, *OWN) if v.name in STATED], ids=lambda value: value.name)
def test_a_column_as_it_is_stated_has_its_critical_load(value: Value, tmp_path: Path) -> None:
    """With sixteen functions a segment, to ten digits at least, of the right kind, and it is said to be converged."""
    path, asked = stated(tmp_path, value.name)
    found = fb.critical_load(fb.column(path), 16, **asked)
    assert found.kind == KINDS[value.kind]
    assert found.load == pytest.approx(float(value.printed), rel=2e-10)
    assert found.converged and found.error is not None and found.error < 1e-8


def test_every_value_is_asked() -> None:
    assert {v.name for v in (*ISSUE, *OWN)} <= set(STATED) | {"ziegler", "ziegler, damped"}
