"""Check certificates over a range of a mass, a spring, a joint or a damping (format 8): no code of the prover's.

The column is one of format 6, given at both ends of the range; between them what the file says of it is linear. What
changes stands in one natural condition, so that F(P, s) is linear in the parameter, or is a damping (docs/theorem.md,
Theorem 5); in that of a joint F is linear in 1/k. On each piece all that is shown of one value is shown on balls that
hold those of each.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import flint
from flint import arb, arb_mat

from freebeam_derive.certify import verifier_beam_claims as claims
from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify import verifier_damping_forms
from freebeam_derive.certify.decimals import said
from freebeam_derive.certify.verifier_beam_claims import OverRange, Piece
from freebeam_derive.certify.verifier_claims import Statement, require
from freebeam_derive.certify.verifier_damping import Damped, DampedOver
from freebeam_derive.certify.verifier_damping_forms import Tables, damped, of_all_alike, split, statement
from freebeam_derive.certify.verifier_equations import Equations
from freebeam_derive.certify.verifier_of_beam import ALONE, First
from freebeam_derive.certify.verifier_of_sections import Gaps
from freebeam_derive.certify.verifier_pieces import Pieces
from freebeam_derive.certify.verifier_rates import Rates, RatesOver, RatesOverDamping
from freebeam_derive.certify.verifier_sections import OfSections, Sections, joints_said, stated_of
from freebeam_derive.certify.verifier_shooting import Whole
from freebeam_derive.certify.verifier_signs import BITS

OVER_SECTIONS = "freebeam certificate 8"
FIELDS = {"format", "column", "parameters", "ends", "breaks", "forms", "damping", "joints", "range", "pieces", "open"}


@dataclass(frozen=True)
class OverSections(OverRange, OfSections):
    """A statement of each value of a parameter from low to high but for the parts that are open."""

    def record(self) -> dict[str, Any]:
        return super().record() | {"breaks": [*map(said, self.breaks)]}


@dataclass(frozen=True)
class OfPiece(Piece):
    """line: R_m."""

    line: Fraction


# --- between two columns -------------------------------------------------------------------------------------------


def check_one_condition(one: Sections, other: Sections, *dampings: Damped) -> None:
    """That two columns differ at most in a joint's spring, or in a mass, a spring, what the load does and what is left
    of damping there, all in one natural condition; dampings of one column may differ in all (but see
    `RatesOverDamping`). Raises Refused."""
    alike = {name: getattr(one, name) for name in ("masses", "springs", "forces", "joints")}
    same = replace(other, **alike) == one and other.joints.keys() == one.joints.keys()
    require(same, "the range changes more than masses, springs and forces at places")
    pairs = (one.masses, other.masses), (one.springs, other.springs), (one.joints, other.joints)
    rows = {place for a, b in pairs for place in {**a, **b} if a.get(place, 0) != b.get(place, 0)}
    a, b = one.forces, other.forces
    rows |= {row for row, of in {**a, **b} if a.get((row, of), 0) != b.get((row, of), 0)}
    if dampings and one != other:
        along = [(d.c_E, d.c_M, d.along) for d in dampings]
        require(along[0] == along[1], "the range changes the damping along the beam")
        first, second = (d.points for d in dampings)
        rows |= {place for place in {**first, **second} if first.get(place, 0) != second.get(place, 0)}
    require(len(rows) <= 1, "the range changes more than one condition")


def between(one: Sections, other: Sections, share: Fraction) -> Sections:
    """The column at a share of the way."""

    def mixed(a: dict[Any, Fraction], b: dict[Any, Fraction]) -> dict[Any, Fraction]:
        return {key: (1 - share) * a.get(key, Fraction(0)) + share * b.get(key, Fraction(0)) for key in {**a, **b}}

    return replace(
        one,
        masses=mixed(one.masses, other.masses),
        springs=mixed(one.springs, other.springs),
        forces=mixed(one.forces, other.forces),
        joints=mixed(one.joints, other.joints),
    )


class OverPieces(Pieces):
    """F(p, s) of each column between two: F₀ + F₁ t, |t| ≤ 1."""

    ranged = True

    def __init__(self, ends: Sequence[Pieces]) -> None:
        self._ends, self._known = ends, {}
        order = [[max(e for e, _ in row) for row in F.rows] for F in ends]
        require(order[0] == order[1], "the conditions at both ends of the range are of another order")

    def whole(self, P: arb, s: arb, S: arb, most: int) -> Whole:
        return Between(*(F.whole(P, s, S, most) for F in self._ends))


class Between(Whole):
    """Half of F at both ends, and half of what it grows by; what is left out of both is bounded for each t."""

    def __init__(self, low: Whole, high: Whole) -> None:
        self.P, self.s, self.S = low.P, low.s, low.S
        self.precision, self.rest = max(low.precision, high.precision), low.rest.max(high.rest)
        with flint.ctx.workprec(self.precision):
            sizes = [[f(of.levels[0]) for of in (low, high)] for f in (arb_mat.nrows, arb_mat.ncols)]
            a, b = (_filled(of.levels[0], *map(max, sizes)) for of in (low, high))
            self.levels = [(a + b) / 2, (b - a) / 2]


def _filled(X: arb_mat, rows: int, columns: int) -> arb_mat:
    """With zeros up to a size."""
    wide = [row + [0] * (columns - len(row)) for row in X.tolist()]
    return arb_mat(wide + [[0] * columns] * (rows - len(wide)))


# --- reading and checking ------------------------------------------------------------------------------------------


def read(data: dict[str, Any]) -> tuple[OverSections, tuple[Sections, Sections], list[Tables]]:
    """Of a file: what is claimed, and at both ends of the range the columns and the forms of damping, none where there
    is none, or one that damps all motions alike and vanishes. Raises Refused."""
    claims.fields({"joints": []} | data, FIELDS)
    name = data["range"]
    require(name in data["parameters"], "the parameter of the range is none")
    pieces = claims.pieces_of(data, _piece)
    (one, column), (other, other_column) = (_at_end(data, name, k) for k in (0, 1))
    given = [claims.at_end(data, name, k)["damping"] for k in (0, 1)]
    with flint.ctx.workprec(BITS):
        dampings = [d for d in map(damped, given, (column, other_column)) if d is not None]
    require(len(dampings) != 1, "there is damping at one end of the range alone")
    require(len({d.vanishing for d in dampings}) <= 1, "damping vanishes at one end of the range alone")
    if dampings:
        one, other = (replace(of, **statement(d)) for of, d in zip((one, other), dampings, strict=True))
    if all(map(of_all_alike, dampings)):
        dampings = []
    check_one_condition(column, other_column, *dampings)
    forms = [verifier_damping_forms.stated(of, column) for of in given] if dampings else []
    joints = {"joints": joints_said(column, other_column)}
    whole = OverSections(**vars(one) | joints | claims.in_pieces(data, one, other, pieces))
    return whole, (column, other_column), forms


def _at_end(data: dict[str, Any], name: str, k: int) -> tuple[OfSections, Sections]:
    stated = claims.at_end(data, name, k)
    given = v.named(stated | {"modes": v.MOST_MODES, "alpha": "0", "beta": "0"})
    return stated_of(stated, given | {"kind": "range", "load": None, "square": None, "load_max": None})


def _piece(data: dict[str, Any]) -> OfPiece:
    fewer = {key: value for key, value in data.items() if key != "line"}
    return OfPiece(**vars(claims.piece(fewer | {"modes": v.MOST_MODES})), line=v.number(data["line"]))


def verify_over_sections(data: dict[str, Any]) -> OverSections:
    """Check a certificate over a range of a mass, a spring or a damping; what it proves. Raises Refused."""
    stated, columns, forms = read(data)
    low, high, each_piece = stated.low, stated.high, list[tuple[First, OfPiece]]()
    for piece in stated.pieces:
        assert isinstance(piece, OfPiece)
        shares = [(value - low) / (high - low) for value in (piece.low, piece.high)]
        with flint.ctx.workprec(BITS):
            each = [(column, Pieces(column)) for column in (between(*columns, share) for share in shares)]
            F = OverPieces([F for _, F in each])
            equations, over = Equations(F, 0, ALONE, ALONE, False), None
            if forms:
                vanishing = data["damping"][0]["vanishing"]
                dampings = [split(*verifier_damping_forms.between(forms[0], forms[1], share), vanishing, column)
                            for share, (column, _) in zip(shares, each, strict=True)]  # fmt: skip
                over = DampedOver.of(*dampings)
                if vanishing or columns[0] != columns[1]:
                    equations = RatesOver(F, *(Rates(F, d) for (_, F), d in zip(each, dampings, strict=True)))
                else:
                    equations = RatesOverDamping(each[0][1], *dampings)
            gaps = Gaps(each[: 1 if each[0][0] == each[1][0] else 2], piece.lowest, piece.line, over)
        first = First(equations, gaps, piece, ranged=True)
        first.check_order(piece.stretches)  # of all pieces before any is begun
        each_piece.append((first, piece))
    for first, piece in each_piece:
        first.check(piece.stretches)
    return stated


FORMATS: dict[str, Callable[[dict[str, Any]], Statement]] = {OVER_SECTIONS: verify_over_sections}
