"""The limit of vanishing external damping of the beam itself: C = beta M leaves the column without damping; and what is
no multiple of the mass does not."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import pytest
from flint import arb

import freebeam as fb
from freebeam_derive.certify.balls import parameters
from freebeam_derive.certify.beam import Beam, NoSeries
from freebeam_derive.certify.damped_gaps import of_mass_alone
from freebeam_sym.checks import InputError

F = Fraction
OF_M = {"of_M": "1", "of_E": "0", "vanishing": True}


def test_loads_of_little_damping_come_to_the_load_of_none() -> None:
    """(Im s)² = β² Re s where stability is lost, and Im s goes like the root of the load's excess: as β²."""
    column = fb.column("beck", "legendre")
    limit, *loads = (fb.critical_load(column, modes=6, **given).load or 0 for given in
                     ({"kappa": math.inf}, {"beta": 0.2}, {"beta": 0.1}))  # fmt: skip
    excess = [load - limit for load in loads]
    assert excess[1] > 0 and excess[0] / excess[1] == pytest.approx(4, abs=0.01)


def test_the_first_loss_in_the_limit_is_that_without_damping() -> None:
    given: dict[str, Any] = {"eta": "0", "digits": 20}
    found = [fb.exact_load(fb.column("beck"), **given | {"kappa": kappa}) for kappa in (math.inf, None)]
    assert all(found[0].proof.values()) and found[0].load == found[1].load and found[0].kind == found[1].kind
    one, other = (dict(f.unverified or {}) for f in found)
    assert one == other | {"kappa": "inf", "damping": OF_M}


def test_what_is_a_multiple_of_the_mass_is_told_exactly() -> None:
    for name, own, alone in (("tip-spring", {}, True), ("pflueger", {}, False), ("pflueger", {"mu": F(0)}, True)):
        kernel = fb.column(name).kernel
        assert of_mass_alone(kernel, parameters(kernel, own)) is alone, name


def test_another_external_damping_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Beam, "damping", lambda self, alpha, beta: (arb(1), arb(1)))
    with pytest.raises((InputError, NoSeries), match="not the mass times a positive number"):
        fb.exact_load(fb.column("beck"), eta="0", kappa=math.inf)
