"""A proof as a file: what was proven and the data that prove it. `verifier.py` checks it with code of its own.

All numbers are rational and written as text. The bilinear forms, the ends and the damping are in the file, of a column
beyond the textbook's its breaks, fields, coordinates and rigid motions too, so that it speaks for itself: whoever reads
it need not trust the emitted kernels, nor the program that wrote it.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import zip_longest
from types import ModuleType
from typing import Any

from flint import arb, fmpq
from flint.utils.flint_exceptions import DomainError

from freebeam_derive.certify.balls import Exact, Unproven, ends, parameters, precision
from freebeam_derive.certify.beam_itself import ExactCrossing
from freebeam_derive.certify.beam_stability import Evidence
from freebeam_derive.certify.boundary_polynomials import Question
from freebeam_derive.certify.decimals import written
from freebeam_derive.certify.first_crossing import Enclosure, Stretch

FORMAT, GENERAL, ITSELF = (f"freebeam certificate {n}" for n in (1, 2, 3))


def write(kernel: ModuleType, found: Enclosure) -> dict[str, Any]:
    """The certificate of an enclosure whose dampings are rational numbers, as a JSON object.

    Raises Unproven for a column with a factor that is no fraction.
    """
    question = found.question
    own = parameters(kernel, question.own)
    general = bool(kernel.COLUMN.get("general"))
    return {
        "format": GENERAL if general else FORMAT,
        "column": kernel.COLUMN["name"],
        "parameters": {name: written(value) for name, value in own.items()},
        "modes": question.modes,
        "alpha": _rational(question.alpha),
        "beta": _rational(question.beta),
        **(_of_any(kernel, found.question, own) if general else _of_beam(kernel, question, own)),
        "kind": found.kind,
        "load": None if found.load is None else [written(v) for v in found.load],
        "frequency_squared": None if found.square is None else [written(v) for v in found.square],
        "load_max": None if found.load_max is None else written(found.load_max),
        "proof": dict(found.proof),
        "stretches": _stretches(found.stretches),
        **(
            {"parts": list(map(list, found.parts)), "beside": list(map(_stretches, found.beside))}
            if found.parts
            else {}
        ),
    }


def _stretches(stretches: Sequence[Stretch]) -> list[dict[str, Any]]:
    return [
        {
            "start": written(s.start),
            "end": written(s.end),
            "origin": written(s.origin),
            "separators": [[written(point), written(slope)] for point, slope in s.separators],
        }
        for s in stretches
    ]


def write_of_beam(
    kernel: ModuleType, question: Question, crossing: ExactCrossing, evidence: Evidence
) -> dict[str, Any]:
    """The certificate that a crossing of the beam itself is the first, as a JSON object. Raises Unproven."""
    own = parameters(kernel, question.own)
    flutter, load_high = crossing.kind == "flutter", ends(crossing.load)[1]
    last = len(evidence.stretches) - 1 if question.undamped or (question.kappa is not None and not flutter) else None
    with precision(crossing.bits):
        square = crossing.frequency * crossing.frequency
    around = [_around(value, crossing.digits - 2) for value in (crossing.load, square)]
    stated = {k: v for k, v in _of_beam(kernel, question, own).items() if k != "basis"}
    return {
        "format": ITSELF,
        "column": kernel.COLUMN["name"],
        "parameters": {name: written(value) for name, value in own.items()},
        "modes": evidence.modes,
        "lowest": evidence.lowest,
        "alpha": _rational(question.alpha),
        "beta": _rational(question.beta),
        **stated,
        "kind": crossing.kind,
        "load": [written(v) for v in around[0]],
        "frequency_squared": [written(v) for v in around[1]] if flutter else None,
        "proof": vars(crossing.proof),
        "stretches": [
            {
                "start": written(s.start),
                "end": written(max(s.end, load_high) if k == last else s.end),
                "points": [written(point) for point in s.separators],
                "moving": None if s.moving is None else s.moving[0],
                "slope": written(Fraction(0) if s.moving is None else s.moving[1]),
            }
            for k, s in enumerate(evidence.stretches)
        ],
    }


def _around(value: arb, digits: int) -> tuple[Fraction, Fraction]:
    """An interval of a relative width of 10^−digits, in the middle of which a value is enclosed."""
    low, high = ends(value)
    middle, width = (low + high) / 2, abs(high) * Fraction(1, 2 * 10 ** max(digits, 15))
    grid = 10 ** (max(digits, 15) + 8)
    return Fraction(int((middle - width) * grid), grid), Fraction(int((middle + width) * grid) + 1, grid)


def _ratio(kappa: Exact | float | None) -> str | None:
    return "inf" if isinstance(kappa, float) else None if kappa is None else _rational(kappa)


def _rational(value: Exact) -> str:
    assert isinstance(value, Fraction)
    return written(value)


def _of_beam(kernel: ModuleType, question: Question, own: dict[str, Fraction]) -> dict[str, Any]:
    """Ends, basis, M, E, H and damping of a textbook's column."""
    kappa = question.kappa
    c_M, c_E = kernel.damping_factors(*question.dampings, **own)
    return {
        "ends": list(kernel.COLUMN["ends"]),
        "basis": kernel.COLUMN.get("basis", "modes"),
        "forms": {
            letter: {
                "along": [[k, p, q, written(v)] for (k, p, q), v in along.items()],
                "points": [[int(a), p, int(b), q, written(v)] for (a, p, b, q), v in points.items()],
            }
            for letter, (along, points) in kernel.forms(Fraction(1), **own).items()
        },
        "kappa": _ratio(kappa),
        "damping": None
        if question.undamped
        else {"of_M": written(c_M), "of_E": written(c_E), "vanishing": kappa is not None},
    }


def _of_any(kernel: ModuleType, question: Question, own: dict[str, Fraction]) -> dict[str, Any]:
    """Breaks, fields, coordinates, M, K, the parts of C, and rigid motions of any column."""
    given = {name: fmpq(value.numerator, value.denominator) for name, value in own.items()}
    try:
        bare, of_alpha, of_beta = (kernel.forms(fmpq(1), *map(fmpq, d), **given) for d in ((0, 0), (1, 0), (0, 1)))
    except (AttributeError, DomainError, TypeError, ValueError):
        name = kernel.COLUMN["name"]
        raise Unproven(f"{name} has a factor that is no fraction, which a certificate cannot hold") from None
    segments = len(bare["breaks"]) - 1
    motions = []
    for motion in bare["rigid"]:
        stated: dict[str, Any] = {}
        for name, where, factors in motion:
            if where is None:
                stated[name] = _text(factors[0])
                continue
            for segment in where:
                stated.setdefault(name, [["0"]] * segments)[segment] = [_text(v) for v in factors]
        motions.append(stated)
    return {
        "breaks": [_text(place) for place in bare["breaks"]],
        "fields": {
            name: {"joined": joined, "held": sorted(map(list, held)), "opened": sorted(map(list, opened))}
            for name, (joined, held, opened) in kernel.FIELDS.items()
        },
        "coordinates": list(kernel.COORDINATES),
        "kappa": _ratio(question.kappa),
        "forms": {
            "M": [_form(form) for form in bare["M"]],
            "C_1": [_form(form) for form in bare["C"]],
            "C_alpha": [_form(*pair) for pair in zip(of_alpha["C"], bare["C"], strict=True)],
            "C_beta": [_form(*pair) for pair in zip(of_beta["C"], bare["C"], strict=True)],
            "K": [_form(form) for form in bare["K"]],
        },
        "rigid": motions,
    }


def _form(form: tuple[Any, Any], less: tuple[Any, Any] | None = None) -> dict[str, Any]:
    """A form, or what it has more than another of the same terms; terms of nothing are left out."""
    along, points = form
    no_along, no_points = less or ([], [])
    written_along, written_points = [], []
    for term, other in zip_longest(along, no_along):
        *where, factors = term
        factors = [v - w for v, w in zip_longest(factors, other[-1] if other else [], fillvalue=0)]
        if any(factors):
            segments, *rest = where
            written_along += [[segment, *rest, [_text(v) for v in factors]] for segment in segments]
    for term, other in zip_longest(points, no_points):
        test, trial, factor = term
        if factor := factor - (other[-1] if other else 0):
            written_points.append([_value(test), _value(trial), _text(factor)])
    return {"along": written_along, "points": written_points}


def _value(value: tuple[str, int, Any, int]) -> list[Any]:
    name, order, place, side = value
    return [name, order, None if place is None else _text(place), side]


def _text(value: Any) -> str:
    if not isinstance(value, int | fmpq):
        raise Unproven(f"a factor is no fraction, {value!r}, and is not for a file")
    return written(Fraction(int(value)) if isinstance(value, int) else Fraction(int(value.p), int(value.q)))


__all__ = ["FORMAT", "GENERAL", "ITSELF", "write", "write_of_beam"]
