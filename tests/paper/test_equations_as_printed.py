"""The printed equations: each string reads to its typed form, misprints kept, and what is not as derived is found."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
import sympy as sp
from sympy import Derivative, Eq, Function, Integral, Symbol

from freebeam.paper import compare as comparison
from freebeam.paper.printed import EQUATIONS, FIELDS, WITH_DIMENSIONS, Printed
from freebeam.paper.reader import Names, ReadingError, misprinted, read
from freebeam.paper.typeset import latex
from freebeam_derive.latex import Printer
from freebeam_derive.notation import alpha, t, x, y


@pytest.mark.parametrize("printed", EQUATIONS, ids=lambda printed: f"({printed.number})")
def test_the_string_reads_to_the_typed_form(printed: Printed) -> None:
    assert printed.read() == printed.typed


def test_all_numbers_are_there() -> None:
    assert [printed.number for printed in EQUATIONS] == list(range(1, 27))


SIGNED = [printed for printed in EQUATIONS if re.search(r"[-+]", printed.reading)]


@pytest.mark.parametrize("printed", SIGNED, ids=lambda printed: f"({printed.number})")
def test_every_sign_counts(printed: Printed) -> None:
    """A string with any one of its signs turned round reads to something else, or not at all."""
    text = printed.reading
    for match in re.finditer(r"[-+]", text):
        turned = "+" if match[0] == "-" else "-"
        changed = f"{text[: match.start()]}{turned}{text[match.end() :]}"
        try:
            assert read(changed, printed.names) != printed.typed
        except ReadingError:
            assert match[0] == "-" and text[: match.start()].rstrip().endswith(("{", "=", "&", r"\\"))


def test_derivatives_are_read_as_printed_not_as_meant() -> None:
    u, v = (FIELDS.values[name] for name in ("y_bar", "alpha_bar"))
    bar = r"\frac{\partial^%d \overline{y}}{\partial \overline{t} \partial \overline{x}^4} = \overline{\alpha}"
    (right,), (wrong,) = (read(bar % order, FIELDS) for order in (5, 3))
    assert right == Eq(Derivative(u, t, (x, 4)), v)
    assert wrong == Eq(misprinted(3, Derivative(u, t, (x, 4))), v) and wrong != right
    assert latex(wrong.lhs) == latex(right.lhs).replace("^5", "^3", 1)


@pytest.mark.parametrize("number", [11, 12, 13, 18, 20, 21, 25])
def test_the_ledger_prints_as_the_lesson_does(number: int) -> None:
    """But for its fractions of ∂, which these equations have not."""
    for form in EQUATIONS[number - 1].typed:
        assert latex(form) == Printer().doprint(form) and r"\partial" not in latex(form)


def test_a_derivative_of_a_product_has_its_brackets() -> None:
    assert latex(Derivative(x * Derivative(y, x), x)).endswith(r"\left(x \frac{\partial y}{\partial x}\right)")


def test_what_the_reader_knows() -> None:
    a, b, c = sp.symbols("a b c")
    names = Names({"a": a, "b": b, "c": c, "t_bar": t, "y": y, "x": x, "t": t})
    assert read(r"a, b = c \pm \frac{a}{2}", names) == (Eq(a, c + a / 2), Eq(b, c - a / 2))
    assert read(r"a = b = -c^{2}", names) == (Eq(a, b), Eq(b, -(c**2)))
    assert read(r"\begin{cases} a = b\\ b = c \end{cases} \quad \text{at} \quad a = 0", names) == (
        Eq(a, b),
        Eq(b, c),
        Eq(a, 0),
    )
    assert read(r"\int_{0}^{1} a y(x,t) d\overline{t} = \sqrt{b}", names) == (
        Eq(Integral(a * y, (t, 0, 1)), sp.sqrt(b)),
    )
    assert read(r"\frac{\partial y}{\partial x}\Big|_{x = 1} = a", names)[0].lhs == sp.Subs(Derivative(y, x), x, 1)


@pytest.mark.parametrize("text", [r"\overline{z} = 0", "M(x,t) + 1", r"\frac{x}{L = 1", r"P(x) = \unknown", "x = = 1"])
def test_what_it_does_not_know_is_refused(text: str) -> None:
    with pytest.raises(ReadingError):
        read(text, WITH_DIMENSIONS)


def test_a_repair_must_find_its_place() -> None:
    with pytest.raises(ValueError, match="does not find its place"):
        _ = replace(EQUATIONS[0], repairs=((r"\vec", "", "nowhere"),)).reading


@pytest.fixture(scope="module")
def rows() -> tuple[comparison.Comparison, ...]:
    from freebeam.ledger.proven import equations

    return tuple(equations())


def test_verdicts(rows: tuple[comparison.Comparison, ...]) -> None:
    """Nine misprints: docs/errata.md has a proof of each."""
    assert all(row.passed for row in rows)
    assert [row.printed.number for row in rows if row.verdict == "erratum"] == [4, 6, 7, 8, 10, 11, 13, 17, 26]


def test_differences_are_what_was_misprinted(rows: tuple[comparison.Comparison, ...]) -> None:
    found = {row.printed.number: [part for part in row.difference if part != 0] for row in rows}
    fifth = Derivative(y, t, (x, 4))
    assert found[6] == [alpha * misprinted(3, fifth) - alpha * fifth]
    assert found[10] == [Symbol("Q_i") - Symbol("Q_j")]
    phi_i, phi_j = Function("phi_i", real=True), Function("phi_j", real=True)
    (difference,) = found[11]
    # vanishes for i = j, changes its sign with the indices: the antisymmetric part of the follower term
    assert difference.replace(phi_j, phi_i) == 0
    other = Function("other", real=True)
    swapped = difference.replace(phi_i, other).replace(phi_j, phi_i).replace(other, phi_j)
    assert sp.expand(difference + swapped) == 0
    assert found[13] == [difference]


@pytest.mark.parametrize("number", [2, 12, 14, 15, 18, 19, 21, 23, 25])
def test_a_confirmed_equation_with_a_fault_put_in_is_none(
    rows: tuple[comparison.Comparison, ...], number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    printed = EQUATIONS[number - 1]
    first = printed.typed[0]
    if number == 25:
        fault = Eq(first.lhs, -first.rhs, evaluate=False)
    else:
        fault = Eq(first.lhs + alpha * x * first.lhs, first.rhs, evaluate=False)
    wrong = replace(printed, typed=(fault, *printed.typed[1:]))
    monkeypatch.setattr(comparison, "EQUATIONS", (*EQUATIONS[: number - 1], wrong, *EQUATIONS[number:]))
    row = comparison.row(wrong, comparison.derived_context())
    assert row.verdict != "confirmed" and not row.passed
