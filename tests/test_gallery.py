"""Every mechanism that finds first losses of stability gives one answer to each hard question, or refuses in words.

The page is asked the same in tests/explorer.
"""

from __future__ import annotations

import numpy as np
import pytest

import freebeam as fb
from freebeam_sym.question import Question
from freebeam_sym.stability.crossings import FirstLoss, first_loss
from tests.gallery import GALLERY
from tests.reference.dense import Case, answer, disagreement

every_case = pytest.mark.parametrize("case", GALLERY.values(), ids=GALLERY.keys())
PROVEN = {what: case for what, case in GALLERY.items() if case.modes <= 10}
"""Proofs of more functions take minutes."""
every_proven_case = pytest.mark.parametrize("case", PROVEN.values(), ids=PROVEN.keys())


def searched(case: Case) -> FirstLoss:
    """By the operator, whatever has been asked of the column before."""
    column = fb.column(case.name, case.basis)
    asked = Question.of(column, case.modes, case.alpha, case.beta, kappa=case.kappa, **case.own)
    return first_loss(asked.problem, case.load_max)


def assert_same(case: Case, load: float | None, kind: str) -> None:
    crossing = searched(case).crossing
    assert kind == ("none" if crossing is None else crossing.kind)
    assert load == (None if crossing is None else pytest.approx(crossing.load, rel=1e-8))


@every_case
def test_dense_eigenvalues_and_roots_at_200_bits_agree(case: Case) -> None:
    found = answer(case)
    assert disagreement(case, found) is None
    assert_same(case, found.load, found.kind)


@every_case
def test_a_map_that_is_dense_enough_for_a_surface_agrees(case: Case) -> None:
    if case.kappa is not None:
        pytest.skip("maps are over dampings, not over ratios in a limit")
    around = np.append(1.0, np.geomspace(0.5, 2, 60))
    column = fb.column(case.name, case.basis)
    found = fb.critical_loads(column, case.modes, around * case.alpha, around * case.beta, **case.own)
    load = float(found.load[0])
    assert_same(case, None if np.isnan(load) else load, str(found.kind[0]))


@every_case
def test_a_boundary_that_starts_there_agrees(case: Case) -> None:
    values = {"alpha": case.alpha, "beta": case.beta, **case.own}
    name = next((name for name, value in values.items() if value), None)
    if name is None or case.kappa is not None:
        pytest.skip("no boundary without a damping or parameter to follow, nor in a limit")
    value = values.pop(name)
    column = fb.column(case.name, case.basis)
    found = fb.trace_boundary(column, name, value, value * (1 + 1e-3), modes=case.modes, tolerance=0.1, **values)
    load = float(found.load[0])
    assert_same(case, None if np.isnan(load) else load, str(found.kind[0]))


REFUSALS = ("not proven", "cannot be told apart", "kappa = inf: must be a finite number")


def is_touch(case: Case, load: float | None) -> bool:
    """Whether the search joins what a proof tells apart there: a series of N functions may lose stability and regain it
    within rounding."""
    outcome = searched(case)
    loads = [touch.load for touch in outcome.touches]
    if outcome.crossing is not None and outcome.crossing.frequency == 0:
        loads.append(outcome.crossing.load)
    return load is not None and bool(np.isclose(loads, load, rtol=1e-8, atol=0).any())


@every_proven_case
def test_a_proof_agrees_or_says_that_there_is_none(case: Case) -> None:
    column = fb.column(case.name, case.basis)
    try:
        proof = fb.certified_load(column, case.modes, case.alpha, case.beta, kappa=case.kappa, **case.own)
    except fb.InputError as refusal:
        assert any(words in str(refusal) for words in REFUSALS)
        return
    load = None if proof.load is None else float(proof.load[0])
    if not is_touch(case, load):
        assert_same(case, load, proof.kind)


@every_proven_case
def test_the_first_loss_among_all_proven_crossings_agrees(case: Case) -> None:
    column = fb.column(case.name, case.basis)
    try:
        proven = fb.certified_crossings(column, case.modes, case.alpha, case.beta, kappa=case.kappa, **case.own)
    except fb.InputError as refusal:
        assert any(words in str(refusal) for words in REFUSALS)
        return
    touches = [touch.load for touch in searched(case).touches]
    lost = [(one.kind, float(one.load[0])) for one in proven if one.stability == "lost"]
    lost = [(kind, load) for kind, load in lost if not np.isclose(touches, load, rtol=1e-8, atol=0).any()]
    kind, load = lost[0] if lost else ("none", None)
    if not is_touch(case, load):
        assert_same(case, load, kind)
