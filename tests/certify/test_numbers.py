"""Numbers that a kernel's functions run on, fractions and balls, beside Python's own; and a kernel of one kind that is
read as one of the other."""

from __future__ import annotations

import operator
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq, fmpz

import freebeam as fb
import freebeam_kernels.beck as beck
from freebeam_derive.certify.balls import precision
from freebeam_derive.certify.comparison_form import ORDERS
from freebeam_derive.certify.numbers import Inexact, Number, exact_value, plain
from freebeam_derive.certify.textbook import OfAny, of_any
from freebeam_derive.certify.uniform import uniform

F = Fraction
PAIRS = operator.add, operator.sub, operator.mul, operator.truediv
ORDER = operator.lt, operator.le, operator.gt, operator.ge, operator.eq, operator.ne
DYADIC = 2.0**-20


def test_fractions_stay_fractions_on_either_side_of_any_exact_number() -> None:
    with precision(64):
        for a, b in product((fmpq(-3, 7), fmpq(2), fmpq(1, 4)), repeat=2):
            one = Number(a)
            for of in PAIRS:
                assert (found := of(one, Number(b))).value == of(a, b) and type(found) is Number
                assert of(one, b).value == of(a, b) and of(one, arb(b)).overlaps(arb(of(a, b)))
                # as NumPy calls them, with the number on the right
                assert of(arb(b), one).overlaps(arb(of(b, a))) if of is not operator.sub else True
            assert all(of(one, Number(b)) == of(a, b) for of in ORDER)
            assert (-one).value == -a and abs(one).value == abs(a) and (one**3).value == a**3
            assert float(one) == int(a.p) / int(a.q) and hash(one) == hash(Number(a))
        half = Number(fmpq(1, 2))
        for other in (3, 3.0, fmpz(3), fmpq(3)):
            assert (
                (other - half).value == fmpq(5, 2) and (other / half).value == 6 and (half - other).value == fmpq(-5, 2)
            )
            assert (other + half).value == fmpq(7, 2) and (other * half).value == fmpq(3, 2)
        assert (half + DYADIC).value == fmpq(1, 2) + fmpq(1, 2**20)
        for rounded in (0.1, DYADIC / 2):
            with pytest.raises(TypeError):
                half + rounded
            with pytest.raises(Inexact, match="a rounded number"):
                plain(rounded)
        assert plain(DYADIC) == fmpq(1, 2**20) and plain(half) == fmpq(1, 2) and exact_value("1") is None


def test_a_root_is_a_fraction_where_it_can_be_and_functions_are_balls() -> None:
    with precision(64):
        for value, root in ((fmpq(4, 9), fmpq(2, 3)), (fmpq(0), fmpq(0)), (fmpq(25), fmpq(5))):
            assert Number(value).sqrt().value == root  # type: ignore[union-attr]
        for value in (fmpq(2), fmpq(4, 3), fmpq(3, 4)):
            found = Number(value).sqrt()
            assert isinstance(found, arb) and found.overlaps(arb(value).sqrt()) and found.is_finite()
        array = np.array([Number(fmpq(1, 3)), Number(fmpq(2, 5))], dtype=object)
        for name in ("exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "arcsin", "arctan", "arctanh"):
            for number, value in zip(array, getattr(np, name)(array), strict=True):
                assert abs(float(value) - getattr(np, name)(float(number))) < 1e-14


# ------------------------------------------------------------ one kind of kernel as the other


def shifted(own: Any, one: Any) -> Any:
    """Of Beck's column with a mass at its tip and a factor for each of what is stated."""
    forms = beck.forms(one, **own)
    M = {(0, 0, 0): 2}, {(1, 0, 1, 0): 3}
    return forms | {"M": M, "E": ({(0, 2, 2): 5, (2, 1, 1): 7}, {(1, 1, 1, 1): 4})}


def test_a_textbooks_kernel_has_the_same_forms_by_segments() -> None:
    """∫ x^k φ⁽ᵖ⁾ φ⁽ᵠ⁾ dx on the one segment and values at its ends; C = c_M M + c_E E."""
    kernel: Any = SimpleNamespace(
        COLUMN=beck.COLUMN, basis=beck.basis, equation=beck.equation, end_conditions=beck.end_conditions,
        forms=lambda one, **own: shifted(own, one), mass=lambda basis, **own: 2.0, stiffness_load=lambda basis: 11.0,
        stiffness_elastic=lambda basis: 5.0, damping_factors=lambda alpha, beta: (0.25, alpha),
    )  # fmt: skip
    read = of_any(kernel, {})
    assert isinstance(read, OfAny) and of_any(beck, {}) is beck
    one, alpha = F(1), F(3)
    stated = read.forms(one, alpha, F(0))
    assert stated["breaks"] == (0, 1) and read.places(one) == (0, 1) and read.sensors(one) == ()
    inner = {((0,), "y", p, "y", q): {k: f} for (k, p, q), f in {(0, 2, 2): 5, (2, 1, 1): 7}.items()}
    for along, factor in ((stated["K"][0][0], 1), (stated["C"][0][0][1:], alpha)):
        assert {term[:5]: {k: f / factor for k, f in enumerate(term[5]) if f} for term in along} == inner
    assert stated["C"][0][0][0] == ((0,), "y", 0, "y", 0, [F(1, 2)])  # a quarter of 2
    assert stated["M"] == [([((0,), "y", 0, "y", 0, [2])], [(("y", 0, 1, 0), ("y", 0, 1, 0), 3)])]
    assert stated["K"][0][1] == [(("y", 1, 1, 0), ("y", 1, 1, 0), 4)]
    assert stated["C"][0][1] == [(("y", 0, 1, 0), ("y", 0, 1, 0), F(3, 4)), (("y", 1, 1, 0), ("y", 1, 1, 0), 12)]
    assert read.mass(None, 7.0) == 2.0 and read.stiffness(None, 3.0) == 38.0
    assert read.FIELDS["y"][1] == {(0, order) for order in ORDERS["clamped"]}
    kernel.damping_factors = lambda alpha, beta: (0.1, alpha)
    with pytest.raises(ValueError, match="a rounded number"):
        read.forms(one, alpha, F(0))


def test_what_differs_from_the_comparison_beam_is_read_as_of_any_column() -> None:
    plain_forms = {"M": ({(0, 0, 0): 1}, {}), "E": ({(0, 2, 2): 1, (0, 1, 1): 4}, {(1, 0, 1, 0): 5}), "H": ({}, {})}
    for changes, same in (
        ({}, True), ({"M": ({(0, 0, 0): 1, (1, 0, 0): 0}, {(1, 0, 1, 0): 0})}, True),
        ({"M": ({(0, 0, 0): 1}, {(1, 0, 1, 0): 1})}, False), ({"M": ({(0, 0, 0): 2}, {})}, False),
        ({"E": ({(0, 2, 2): 2}, {})}, False), ({"E": ({(0, 2, 2): 1, (1, 2, 2): 1}, {})}, False),
    ):  # fmt: skip
        kernel = SimpleNamespace(**vars(beck) | {"forms": lambda one, f=changes: plain_forms | f})
        assert (of_any(kernel, {}) is kernel) == same
        rigid = SimpleNamespace(**vars(kernel) | {"COLUMN": beck.COLUMN | {"rigid": 1}})
        assert of_any(rigid, {}) is rigid


def test_a_uniform_beam_of_the_general_kind_is_told_by_each_of_its_parts() -> None:
    """Each change alone makes it none of the textbook's kind."""
    kernel = fb.column("beck-dead-load").kernel
    assert uniform(kernel) is not None
    (first, *others), (table,) = kernel.conditions(0, 0, 1), kernel.equations(0, 0, 1)
    forms = kernel.forms(1, 0, 0)
    key = next(iter(first))
    changes: list[dict[str, Any]] = [
        {"FIELDS": {"y": (2, (), ()), "z": (2, (), ())}}, {"FIELDS": {"y": (1, (), ())}},
        {"FIELDS": {"y": (2, (), ((1, 1),))}}, {"COORDINATES": ("q",)},
        *({"COLUMN": kernel.COLUMN | change} for change in (
            {"breaks": ["0", "1/2", "1"]}, {"inexact": "a root"}, {"circulatory": True}
        )),
        {"conditions": lambda *_: (first | {(*key[:4], (0, 1)): 1}, *others)},  # of both ends
        {"conditions": lambda *_: (*others, others[-1])},  # three at one end
        {"equations": lambda *_: (table | {("y", "y", 1, 0, 0): lambda x: x},)},
        {"forms": lambda *_: forms | {"M": [*forms["M"], *forms["M"]]}},
        {"forms": lambda *_: forms | {"K": forms["K"][:1]}},
        {"forms": lambda *_: forms | {"M": [([((0,), "y", 0, "y", 0, [2])], [])]}},
        {"forms": lambda *_: forms | {"C": [([], [(("y", 0, 1, 0), ("y", 0, 1, 0), 1)])]}},
        {"forms": lambda *_: forms | {"K": [forms["K"][0], ([], [(("y", 0, 0.5, 0), ("y", 0, 1, 0), 1)])]}},
    ]  # fmt: skip
    for change in changes:
        assert uniform(SimpleNamespace(**vars(kernel) | change)) is None
