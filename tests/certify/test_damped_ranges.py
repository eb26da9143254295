"""Ranges of a mass, a spring or a damping of damped columns beyond the uniform beam: proven,
accepted as written, forgeries refused, and the constants of a range above those of each value in it.

    PYTHONPATH=. python -m tests.certify.test_damped_ranges

proves and verifies these and some more, prints how long each took, and tries every forgery; with cases as arguments
those alone.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import flint
import pytest
from flint import acb, arb

import freebeam as fb
from freebeam_derive.certify import beam_cells, verifier, verifier_damping_forms
from freebeam_derive.certify.balls import Range, precision
from freebeam_derive.certify.boundary_polynomials import Question
from freebeam_derive.certify.certificate import _sections
from freebeam_derive.certify.column_forms import ColumnForms
from freebeam_derive.certify.damped_gaps import LeftOver, over_range
from freebeam_derive.certify.exact_system import ExactSystem
from freebeam_derive.certify.local_series import Local
from freebeam_derive.certify.strips import NoStrips
from freebeam_derive.certify.system_ranges import OverSystem
from freebeam_derive.certify.verifier_claims import Refused
from freebeam_derive.certify.verifier_damping import Damped, DampedOver
from freebeam_derive.certify.verifier_damping_forms import halfway, split
from freebeam_derive.certify.verifier_over_sections import FORMATS, OverPieces, between
from freebeam_derive.certify.verifier_pieces import Pieces
from freebeam_derive.certify.verifier_rates import Rates, RatesOver, RatesOverDamping
from freebeam_derive.certify.verifier_sections import Sections, sections
from tests.certify.test_range_certificates import assert_within, report

F = Fraction
Data = dict[str, Any]
CASE, LIMIT, DAMPING = "rotary inertia", "direction of the limit", "internal damping, narrow"
CASES: dict[str, tuple[str, tuple[str, str, str], dict[str, str]]] = {
    CASE: ("pflueger", ("J", "0.1", "0.101"), {"alpha": "0.02", "beta": "0.1"}),
    LIMIT: ("pflueger", ("kappa", "1", "1.2"), {"J": "0.1"}),
    DAMPING: ("pflueger", ("alpha", "0.02", "0.0201"), {"beta": "0.1", "J": "0.1"}),
    "internal damping": ("pflueger", ("alpha", "0.02", "0.022"), {"beta": "0.1", "J": "0.1"}),
    "external damping": ("pflueger", ("beta", "0.5", "0.6"), {}),
    "weight, internal damping": ("beck-self-weight", ("alpha", "0.01", "0.011"), {"beta": "0.1", "g": "2"}),
    "tip mass": ("pflueger", ("mu", "0.9", "0.92"), {"alpha": "0.01", "beta": "0.1"}),
    "tip mass, external damping": ("pflueger", ("mu", "0.9", "1"), {"beta": "0.5"}),
    "tip mass, limit": ("pflueger", ("mu", "0.9", "0.95"), {"kappa": "1"}),
    "root, limit": ("elastic-root", ("c", "5", "5.1"), {"kappa": "1"}),
    "root, direction of the limit": ("elastic-root", ("kappa", "1", "1.1"), {}),
    "weight, direction of the limit": ("beck-self-weight", ("kappa", "1", "1.1"), {}),
}


@cache
def found(case: str) -> Any:
    name, ranged, given = CASES[case]
    return fb.exact_range(fb.column(name), *ranged, **given)  # type: ignore[arg-type]


@cache
def written(case: str) -> Data:
    """Proven as a whole but for the prover's cells; the verifier makes its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(beam_cells.Cells, "no_other_zero", lambda *_: 1)
        data: Data = json.loads(json.dumps(found(case).unverified))
    return data


@pytest.mark.parametrize("case, value", [(CASE, "0.1007"), (DAMPING, "0.02007")])
def test_a_range_is_accepted_as_it_was_written(case: str, value: str) -> None:
    data, (name, (parameter, low, high), given) = written(case), CASES[case]
    stated = verifier.verify(data, FORMATS)
    assert (stated.parameter, stated.low, stated.high, stated.open) == (parameter, F(low), F(high), ())
    assert_within(stated, name, given | {parameter: value})
    text = str(stated)
    if case == DAMPING:
        return
    assert "C = 0.02 E + the integral of 0.1 v y over 0 < x < 1, linear in J between" in text
    assert "for each value of J from 0.1 to 0.101" in text and "the first over all modes" in text


def forgeries(data: Data) -> Iterator[tuple[Data, str]]:
    """The same certificate of something that is not so, and the step that is to fail."""
    (piece, *others), dampings, name = data["pieces"], data["damping"], data["range"]
    low, _ = data["parameters"][name]
    crossing = "no crossing in the interval"

    def with_dampings(*given: Any) -> Data:
        return data | {"damping": [*given]}

    def changed(end: int, part: str, n: int, factor: str) -> Data:
        given = deepcopy(dampings)
        given[end]["form"][part][n][-1] = str(F(factor) * F(given[end]["form"][part][n][-1]))
        return with_dampings(*given)

    vanishing = dampings[0]["vanishing"]
    ranged = crossing if vanishing else "the range changes the damping along the beam"
    yield changed(1, "along", 0, "3/2"), ranged  # of a direction, a wider interval
    yield changed(0, "along", 0, "2/3"), ranged
    yield with_dampings(dampings[0], None), "at one end of the range alone"
    turned = dampings[1] | {"vanishing": not vanishing}
    yield with_dampings(dampings[0], turned), "vanishes at one end of the range alone|where no mass is"
    yield with_dampings(None, None), crossing + "|leave a gap"
    yield data | {"pieces": [piece | {"high": str((F(low) + F(piece["high"])) / 2)}, *others]}, "gap|on one another"
    for factor in ("0.97", "1.03"):
        load = [str(F(v) * F(factor)) for v in piece["load"]]
        yield data | {"pieces": [piece | {"load": load}, *others]}, crossing
    load = [str(F(v) + s * (F(piece["load"][1]) - F(piece["load"][0])) / 4)
            for v, s in zip(piece["load"], (1, -1), strict=True)]  # fmt: skip
    yield data | {"pieces": [piece | {"load": load}, *others]}, crossing
    if not vanishing:
        damper = deepcopy(dampings)
        damper[1]["form"]["points"].append([1, 0, 1, 0, "1/1000"])
        yield with_dampings(*damper), "more than one condition|where no mass is|" + crossing


def forged_dampings(data: Data) -> Iterator[tuple[Data, str]]:
    """The same of a range of alpha or beta in one piece."""
    (piece,), dampings, name = data["pieces"], data["damping"], data["range"]
    low, high = data["parameters"][name]
    crossing, gap = "no crossing in the interval", "leave a gap|lie on one another"
    middle, beyond = (str(F(low) + share * (F(high) - F(low))) for share in (F(1, 2), F(40)))

    def with_piece(**changes: Any) -> Data:
        return data | {"pieces": [piece | changes]}

    halves = [piece | {"high": middle}, piece | {"low": middle}]
    for left in (halves[:1], halves[1:], [piece, piece]):
        yield data | {"pieces": left}, gap
    wider = data | {"parameters": data["parameters"] | {name: [low, beyond]}}
    yield wider, gap
    grown = deepcopy(dampings)
    for part in ("along", "points"):  # linear in the parameter, so that at its end it is as far beyond
        terms = zip(dampings[0]["form"][part], grown[1]["form"][part], strict=True)
        for before, term in terms:
            term[-1] = str(F(before[-1]) + 40 * (F(term[-1]) - F(before[-1])))
    yield wider | {"damping": grown, "pieces": [piece | {"high": beyond}]}, crossing
    yield data | {"damping": grown}, crossing
    yield data | {"damping": [dampings[0], dampings[0] | {"vanishing": True}]}, "vanishes at one end"
    yield with_piece(load=[str(F(v) * F("1.03")) for v in piece["load"]]), crossing
    a, b = map(F, piece["load"])
    yield with_piece(load=[str(a + (b - a) / 4), str(b - (b - a) / 4)]), crossing
    free = "not known to be free|too narrow|beyond the line|not known to change sign|not known to be damped"
    for factor in (F(1, 2), F(3)):
        yield with_piece(line=str(factor * F(piece["line"]))), free
    if piece["lowest"] > 1:
        fewer = [s | {"points": s["points"][:-1]} for s in piece["stretches"]]
        yield with_piece(lowest=piece["lowest"] - 1, stretches=fewer), free


@pytest.mark.parametrize("case", [CASE, DAMPING])
def test_ranges_of_what_is_not_so_are_refused(case: str) -> None:
    for forged, match in (forged_dampings if case == DAMPING else forgeries)(written(case)):
        with pytest.raises(Refused, match=match):
            verifier.verify(forged, FORMATS)


# ------------------------------------------------------------ what is said of a range holds of each value


def sides(case: str) -> tuple[list[Sections], list[Damped], Any]:
    """Columns and dampings at both ends, and what makes those between."""
    name, (parameter, *values), given = CASES[case]
    files = []
    for value in values:
        own = {key: F(v) for key, v in (given | {parameter: value}).items()}
        a, b, kappa = (own.pop(key, None) for key in ("alpha", "beta", "kappa"))
        files.append(_sections(fb.column(name).kernel, Question(1, a or F(0), b or F(0), kappa, own)))
    columns = [sections(tuple(of["ends"]), tuple(map(F, of["breaks"])), of["forms"]) for of in files]
    forms = [verifier_damping_forms.stated(of["damping"], column) for of, column in zip(files, columns, strict=True)]

    def at(share: Fraction) -> tuple[Sections, Damped]:
        of = between(*columns, share)
        return of, split(*verifier_damping_forms.between(forms[0], forms[1], share), parameter == "kappa", of)

    each = [at(F(n)) for n in (0, 1)]
    return [of for of, _ in each], [damping for _, damping in each], at


@pytest.mark.parametrize("case", [CASE, LIMIT])
def test_equations_between_two_columns_are_linear(case: str) -> None:
    with flint.ctx.workprec(64):
        columns, dampings, at = sides(case)
        ends = [Rates(Pieces(of), damping) for of, damping in zip(columns, dampings, strict=True)]
        over = RatesOver(OverPieces([of.F for of in ends]), *ends)  # type: ignore[list-item]
        P, x = arb(3), arb(5) if over.limit else arb("2.2")
        near = tuple(v + abs(v) * (acb(arb(0, 0.01), arb(0, 0.01)) if isinstance(v, acb) else arb(0, 0.01))
                     for v in ends[0].place(P, x))  # fmt: skip
        (middle, _), (half, _) = over.at(P, x, near)
        whole, J = over.system(over.box(*near).value, P, x)
        for share in (F(0), F(1, 3), F(1)):
            one = Rates(*(f(v) for f, v in zip((Pieces, lambda d: d), at(share), strict=True)))
            value, slopes = one.system(one.box(*near).value, P, x)
            for i in (0, 1):
                apart = value[i] - middle[i] - half[i] * float(2 * share - 1)
                assert apart.overlaps(arb(0)) and apart.rad() < 1e-9 * (abs(middle[i]) + abs(half[i]))
                assert whole[i].overlaps(value[i]) and all(J[i][j].overlaps(slopes[i][j]) for j in (0, 1))
        assert any(abs(v) > 1e-6 * abs(m) for v, m in zip(half, middle, strict=True))


DAMPINGS = ("internal damping", "external damping")


@pytest.mark.parametrize("case", DAMPINGS)
def test_equations_of_a_range_of_damping_hold_those_of_each(case: str) -> None:
    """Of the verifier: all of R is one form times a number. Of the prover: F is that of the middle and its slope."""
    name, (parameter, low, high), given = CASES[case]
    own = {key: F(v) for key, v in given.items() if key not in ("alpha", "beta")}
    rates = {key: F(given.get(key, "0")) for key in ("alpha", "beta")}
    ranged = OverSystem(fb.column(name).kernel, own, **(rates | {parameter: Range(F(low), F(high))}))
    with flint.ctx.workprec(64):
        local = Local(ranged, acb(arb(3, 0.1)), acb(0, arb(-2.2, 0.1)), degree=8)
        columns, dampings, at = sides(case)
        over = RatesOverDamping(Pieces(columns[0]), *dampings)
        P, x = arb(3), arb("2.2")
        near = tuple(v + abs(v) * acb(arb(0, 0.01), arb(0, 0.01)) for v in over.place(P, x))
        total = [arb(0), arb(0)]
        for value, weight in over.at(P, x, near):
            total = [a + b * weight for a, b in zip(total, value, strict=True)]
        whole, J = over.system(over.box(*near).value, P, x)
        for held, summed in zip(over.centre(over.box(*near).value, P, x), total, strict=True):
            assert held.overlaps(summed) and abs((held - summed).mid()) < 1e-6 * abs(summed)
        for share in (F(0), F(1, 3), F(1)):
            one = Rates(Pieces(columns[0]), at(share)[1])
            value, slopes = one.system(one.box(*near).value, P, x)
            for i in (0, 1):
                assert total[i].overlaps(value[i]) and whole[i].overlaps(value[i])
                assert all(J[i][j].overlaps(slopes[i][j]) for j in (0, 1))
            damping = F(low) + share * (F(high) - F(low))
            it = ExactSystem(fb.column(name).kernel, own, *(rates | {parameter: damping}).values())
            held, near_by, right = (of.taylor(acb(P), acb(0, -x), ((0, 0), (0, 1))) for of in (ranged, local, it))
            assert all(of[order].overlaps(right[order]) for order in right for of in (held, near_by))
            assert near_by[0, 0].real.rad() < 3 * held[0, 0].real.rad()
        ends = [Rates(Pieces(columns[0]), at(F(n))[1]).system(over.box(*near).value, P, x)[0] for n in (0, 1)]
        assert max(float(t.rad()) for t in total) < 2 * max(abs(float(a - b)) for a, b in zip(*ends, strict=True))
        other = ExactSystem(fb.column(name).kernel, own, *(rates | {parameter: 2 * F(high)}).values())
        far = other.taylor(acb(P), acb(0, -x), ((0, 0),))[0, 0]
        assert not held[0, 0].overlaps(far)


def test_a_range_of_damping_that_leaves_another_form_is_refused() -> None:
    """Of a rotary inertia without damping in the medium at one end alone."""
    with flint.ctx.workprec(64):
        _, (one, other), _ = sides("internal damping")
        middle, share = halfway(one, other)
        assert share == 1 and middle.c_E == F("0.021") and middle.points == one.points
        with pytest.raises(Refused, match="changes what is left of damping"):
            halfway(one, replace(other, points=other.points | {(1, 1): F(0)}))
        _, (one, other), _ = sides("external damping")
        middle, share = halfway(one, other)
        assert share == F(10, 11) and middle.c_M == F("0.55") and middle.points[1, 0] == -F("0.55")


@pytest.mark.parametrize("case", [CASE, LIMIT])
def test_constants_of_a_range_hold_those_of_each_value(case: str) -> None:
    """Of the verifier and of the prover."""
    name, (parameter, low, high), given = CASES[case]
    kernel, omega, blur = fb.column(name).kernel, arb(60), arb("0.1")
    still = {key: F(value) for key, value in given.items() if key not in ("alpha", "beta", "kappa")}
    with flint.ctx.workprec(64):
        _, dampings, at = sides(case)
        over = DampedOver.of(*dampings)

        def left(share: Fraction) -> LeftOver:
            value = F(low) + share * (F(high) - F(low))
            own = still if parameter == "kappa" else still | {parameter: value}
            rates = (F(1), value) if parameter == "kappa" else (F(given["alpha"]), F(given["beta"]))
            return LeftOver(ColumnForms(kernel, own), kernel, own, *rates, parameter == "kappa")

        both = over_range([left(F(0)), left(F(1))])
        for share in (F(0), F(1, 3), F(1)):
            for whole, one in ((over, at(share)[1]), (both, left(share))):
                assert whole.size >= one.size and whole.share(omega) >= one.share(omega)  # type: ignore[attr-defined]
                assert whole.least(omega, blur) <= one.least(omega, blur)  # type: ignore[attr-defined]
            assert over.of_M.contains(at(share)[1].of_M) and both.c_M.contains(left(share).c_M)
        assert (over.of_M.rad() > 0.01) is (parameter == "kappa") and (over.of_M.rad() > 1e-9) is (parameter == "kappa")


def test_a_mass_that_is_nothing_at_one_end_is_refused_with_damping() -> None:
    """Its share of a mode, and what is left of damping there over it, are not between those at the ends."""
    kernel = fb.column("pflueger").kernel
    with precision(64):
        ends = [LeftOver(ColumnForms(kernel, own), kernel, own, F(0), F(1, 2)) for own in ({"J": F(0)}, {"J": F(1)})]
        with pytest.raises(NoStrips, match="a mass that is nothing at an end"):
            over_range(ends)
    columns, dampings, _ = sides(CASE)
    column = columns[0]
    lighter = Damped(
        type(column)(**(vars(column) | {"masses": {}})), dampings[0].c_E, F(1), False, dampings[0].along, {}, ([], {})
    )
    with flint.ctx.workprec(64), pytest.raises(Refused, match="nothing at an end of the range"):
        DampedOver.of(lighter, dampings[1])


def test_f_of_a_damped_system_over_a_range_is_between_those_at_its_ends() -> None:
    """And in the limit so is the growth rate, in the mass and in the direction."""
    kernel, J = fb.column("pflueger").kernel, Range(F(1, 10), F(1, 5))
    ranges: tuple[tuple[Any, ...], ...] = (
        ({"J": J}, F(1, 50), F(1, 10), False), ({"J": J}, F(1), F(1), True), ({"J": F(1, 10)}, F(1), J, True),
    )  # fmt: skip
    for own, alpha, beta, vanishing in ranges:
        over = OverSystem(kernel, own, alpha, beta, vanishing)
        third = F(2, 15)
        one = ExactSystem(
            kernel, {"J": third if own["J"] is J else own["J"]}, alpha, third if beta is J else beta, vanishing
        )
        place = (arb(5), arb(6)) if vanishing else (acb(5), acb(0, -2))
        order = (0, 0, 1) if vanishing else (0, 0)
        with precision(64):
            low, high, value, whole = (of.taylor(*place, (order,))[order] for of in (over.low, over.high, one, over))
        assert abs(value - (2 * low + high) / 3) < 1e-9 * abs(high - low) and whole.overlaps(value)


def main(*cases: str) -> None:
    for case in cases or CASES:
        of_damping = CASES[case][1][0] in ("alpha", "beta")

        def forged(data: Data, of_damping: bool = of_damping) -> Iterator[tuple[Data, str]]:
            return forged_dampings(data) if of_damping and len(data["pieces"]) == 1 else forgeries(data)

        report(case, lambda case=case: json.loads(json.dumps(found(case).unverified)),
               lambda data: verifier.verify(data, FORMATS), forged)  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
