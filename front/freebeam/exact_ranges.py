"""Critical loads of the beam itself over a range of a parameter, proven for each of its values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from freebeam import proofs
from freebeam.certificates import Proven, attempted
from freebeam.maps.known import answer
from freebeam_sym.checks import InputError, count, refusal

if TYPE_CHECKING:
    from freebeam_derive.certify.balls import Range
    from freebeam_derive.certify.beam_itself import Itself
    from freebeam_derive.certify.beam_ranges import Piece
    from freebeam_sym.columns import Column
    from freebeam_sym.question import Question

__all__ = ["ExactPiece", "ExactRange", "OpenPiece", "exact_range"]

FINEST = 10  # halvings of a range, before a part is left open
GIVE_UP = Fraction(1, 64)  # of a range: where so much of it from its beginning is open, nothing is proven
MOST_DIGITS = 4  # each costs ten times as many pieces


@dataclass(frozen=True)
class ExactPiece:
    """The first loss of stability of the beam itself for each value of a parameter from low to high, nondimensional.

    low, high: exact, as text. load, frequency: (lower, upper) as decimal text, rounded outwards: those of every value
    lie there; the frequency of a divergence is zero. proof: crossing, first, stable_below and kind, all proven.
    """

    low: str
    high: str
    load: tuple[str, str]
    frequency: tuple[str, str]
    kind: str
    proof: Mapping[str, bool]


@dataclass(frozen=True)
class OpenPiece:
    """A part of the range, exact as text, of which nothing is proven; missing: the step that failed, in words."""

    low: str
    high: str
    missing: str


@dataclass(frozen=True)
class ExactRange(Proven):
    """What is proven over a range of a parameter. pieces: side by side, ascending; open: the parts that are left out.

    load: (lower, upper) of all pieces. question: what was asked, in floats, at the middle of the range; inputs: what
    each input was taken for. certificate: the data that prove it, for a file, with intervals of loads a little wider,
    which the verifier accepts; None where missing says why. unverified: the same as the prover wrote them.
    """

    parameter: str
    pieces: tuple[ExactPiece, ...]
    open: tuple[OpenPiece, ...]
    load: tuple[str, str]
    question: Question
    inputs: Mapping[str, str]
    unverified: Mapping[str, Any] | None = field(repr=False)
    missing: str = ""


def exact_range(
    column: Column,
    parameter: str,
    low: object,
    high: object,
    alpha: object = 0,
    beta: object = 0,
    *,
    digits: int = 2,
    kappa: object = None,
    modes: int = 24,
    load_max: object = None,
    progress: Callable[[str], None] | None = None,
    **parameters: object,
) -> ExactRange:
    """The critical load of the beam itself for every value of a parameter from low to high, enclosed and proven to be
    the first, over all modes. Eqs. (6), (14), (15).

    parameter: "alpha", "beta", "kappa" (with kappa given, for the limit), or one of the column's own in which equation
    of motion and end conditions of a uniform column are linear, such as a foundation or a dead load, its bending
    stiffness and mass apart; of a column in uniform parts one that stands in one condition anywhere, such as a mass or
    a spring, or the spring of a joint. digits: 1 to 4; the range is cut until each piece's load is known to
    a relative width below 10^-digits, if ten halvings do. Other inputs as in `exact_load`; nondimensional. A part of
    which a step of the proof failed is left open with the step's name, as is η about 1/2 of the sub-tangential
    cantilever.

    >>> import freebeam as fb
    >>> found = fb.exact_range(fb.column("beck"), "eta", "0.3", "0.31")
    >>> [piece.kind for piece in found.pieces], found.open
    (['divergence', 'divergence', 'divergence', 'divergence'], ())

    Raises InputError for bad values, for a column or a parameter that is not served, and where nothing is proven.
    """
    from freebeam_derive.certify.balls import Range
    from freebeam_derive.certify.certificate import write_range
    from freebeam_derive.certify.decimals import shown

    digits = count("digits", digits, 1, MOST_DIGITS, "digits of the load over a range")
    (start, first), (end, last) = (proofs.rational(parameter, value) for value in (low, high))
    if not start < end:
        raise refusal(parameter, f"{first} to {last}", "the range must go from a number to a greater one")
    if parameter == "alpha" and start <= 0:
        raise refusal(
            "alpha", f"{first} to {last}", "must begin above 0, where the load jumps; ask for alpha = 0 apart"
        )
    given: dict[str, Any] = {"alpha": alpha, "beta": beta, "load_max": load_max}
    if parameter == "kappa":
        kappa = (start + end) / 2
    elif parameter in given:
        given[parameter] = (start + end) / 2
    else:
        parameters = parameters | {parameter: (start + end) / 2}
    asked = proofs._Asked.of(column, modes, parameters, kappa, None, **given)
    asked = replace(asked, inputs={**asked.inputs, parameter: f"{first} to {last}"})
    pieces, left = _pieces(asked, parameter, start, end, digits, progress or (lambda _: None))
    if not pieces:
        raise InputError(f"not proven for {column.name}, the beam itself, anywhere in the range: {left[0][2]}")
    kernel = _uniform(asked, parameter, Range(start, end)) or _of_any(asked, parameter, Range(start, end))
    ends: Any = tuple(replace(asked.certified, **_at(asked, parameter, value)) for value in (start, end))
    certificate, missing = attempted(lambda: write_range(kernel, ends, parameter, pieces, left))
    union = min(p.load[0] for p in pieces), max(p.load[1] for p in pieces)
    return ExactRange(
        parameter,
        tuple(_told(p) for p in pieces),
        tuple(OpenPiece(_number(a), _number(b), why) for a, b, why in left),
        shown(*union),
        asked.question,
        asked.inputs,
        certificate,
        missing,
    )


def _pieces(
    asked: proofs._Asked, name: str, low: Fraction, high: Fraction, digits: int, say: Callable[[str], None]
) -> tuple[list[Piece], list[tuple[Fraction, Fraction, str]]]:
    """Those that are proven, and what is left open."""
    from freebeam_derive.certify.balls import Unproven
    from freebeam_derive.certify.beam import NoSeries

    found: list[Piece] = []
    left: list[tuple[Fraction, Fraction, str]] = []
    waiting = [(low, high, 0)]
    while waiting:
        a, b, depth = waiting.pop()
        say(f"{name} = {float(a):.6g} of {float(high):.6g}, {len(found)} pieces")
        try:
            piece = _piece(asked, name, a, b, None if depth == FINEST else Fraction(1, 10**digits))
        except NoSeries as error:
            raise InputError(f"a range is not to be had of the exact beam: {error}") from error
        except Unproven as error:
            if depth < FINEST:
                middle = (a + b) / 2
                waiting += [(middle, b, depth + 1), (a, middle, depth + 1)]
            elif left and left[-1][1] == a:
                left[-1] = (left[-1][0], b, left[-1][2])
            else:
                left.append((a, b, str(error)))
            if not found and left and left[-1][1] - low > (high - low) * GIVE_UP:
                break
            continue
        found.append(piece)
    return found, left


def _piece(asked: proofs._Asked, name: str, low: Fraction, high: Fraction, width: Fraction | None) -> Piece:
    """What is proven from low to high. Raises Unproven, also where the load is wider, relative to its size."""
    from freebeam_derive.certify.balls import Range, Unproven
    from freebeam_derive.certify.beam_ranges import piece

    values = Range(low, high)
    beam = _over(asked, name, values)
    given = zip(("alpha", "beta", "kappa"), asked.dampings_of(beam), strict=True)
    damping: Any = tuple(values if n == name else value for n, value in given)
    middle = float((low + high) / 2)
    question = replace(asked.question, kappa=middle) if name == "kappa" else asked.question.at(**{name: middle})
    loss = answer(question)
    loss_of_beam = loss.beam or loss
    near = proofs._near(loss_of_beam)
    if near is None or loss_of_beam.kind == "none":
        raise Unproven(f"no series loses stability up to the load {question.load_max:.10g}")
    return piece(beam, values, damping, near, loss_of_beam.kind, width)


def _over(asked: proofs._Asked, name: str, values: Range) -> Itself:
    """The beam over a range of one of its own parameters, or the beam that a damping ranges of. Raises NoSeries."""
    from freebeam_derive.certify.beam import Beam, NoSeries
    from freebeam_derive.certify.beam_ranges import linear_damping, over
    from freebeam_derive.certify.system_ranges import OverSystem

    own, kernel = {**asked.own, name: values}, _uniform(asked, name, values)
    if kernel is None:
        itself = asked.itself
        if itself.kernel.COLUMN.get("circulatory"):
            raise NoSeries(f"{asked.column.name} has a damping that acts on displacements")
        given = dict(zip(("alpha", "kappa" if itself.vanishing else "beta"), itself.dampings, strict=True))
        alpha, beta = (given | ({name: values} if name in given else {})).values()
        return OverSystem(
            _of_any(asked, name, values), own if name in asked.own else asked.own, alpha, beta, itself.vanishing
        )
    if name in asked.own:
        return over(kernel, own)
    linear_damping(beam := Beam(kernel, asked.own), "beta" if name == "kappa" else name)
    return beam


def _uniform(asked: proofs._Asked, name: str, values: Range) -> Any:
    """The kernel of a column that is uniform at both ends of a range; None of another, and where springs alone keep it
    from moving rigidly or there is internal damping, which uniform parts serve."""
    from freebeam_derive.certify.strips import rigid_motions
    from freebeam_derive.certify.uniform import uniform

    kernel: Any = _of_any(asked, name, values)
    if not kernel.COLUMN.get("general"):
        return kernel
    found = [uniform(kernel, **own) for own in _owns(asked, name, values)]
    if (
        None in found
        or asked.certified.dampings[0] != 0
        or (rigid_motions(kernel.COLUMN["ends"]) and not kernel.COLUMN["rigid"])
    ):
        return None
    return found[0]


def _of_any(asked: proofs._Asked, name: str, values: Range) -> Any:
    """The column's kernel, read as of any column where mass or stiffness at an end of the range are not the comparison
    beam's."""
    from freebeam_derive.certify.textbook import of_any

    return of_any(asked.column.kernel, *_owns(asked, name, values))


def _owns(asked: proofs._Asked, name: str, values: Range) -> list[dict[str, Fraction]]:
    """The column's own parameters at both ends of a range."""
    return [{**asked.own, **_at(asked, name, value).get("own", {})} for value in (values.low, values.high)]


def _at(asked: proofs._Asked, name: str, value: Fraction) -> dict[str, Any]:
    """What a question has otherwise at one value of the parameter."""
    return {"own": {**asked.own, name: value}} if name in asked.own else {name: value}


def _told(piece: Piece) -> ExactPiece:
    from freebeam_derive.certify.decimals import shown

    frequency = shown(*piece.frequency) if piece.kind == "flutter" else ("0", "0")
    proof = dict.fromkeys(("crossing", "first", "stable_below", "kind"), True)
    return ExactPiece(_number(piece.low), _number(piece.high), shown(*piece.load), frequency, piece.kind, proof)


def _number(value: Fraction) -> str:
    from freebeam_derive.certify.decimals import said

    return said(value)
