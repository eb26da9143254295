"""A proof as a file: what was proven and the data that prove it. `verifier.py` checks it with code of its own.

All numbers are rational and written as text. The bilinear forms, the ends and the damping are in the file, of a column
beyond the textbook's its breaks, fields, coordinates and rigid motions too, so that it speaks for itself: whoever reads
it need not trust the emitted kernels, nor the program that wrote it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import zip_longest
from types import ModuleType
from typing import Any

from flint import acb, arb, fmpq
from flint.utils.flint_exceptions import DomainError

from freebeam_derive.certify.all_crossings import Crossing, Crossings
from freebeam_derive.certify.balls import Exact, Unproven, ends, named_matrices, parameters, precision
from freebeam_derive.certify.beam_crossings import Survey
from freebeam_derive.certify.beam_itself import ExactCrossing
from freebeam_derive.certify.beam_ranges import Piece
from freebeam_derive.certify.beam_stability import BITS, Evidence
from freebeam_derive.certify.boundary_polynomials import Question, functions_of
from freebeam_derive.certify.decimals import written
from freebeam_derive.certify.first_crossing import Enclosure, Stretch
from freebeam_derive.certify.parts import Part, split

FORMAT, GENERAL, ITSELF, LIST, RANGE, SECTIONS, SPECTRUM, OF_SECTIONS, MATRICES, CROSSINGS = (
    f"freebeam certificate {n}" for n in range(1, 11)
)
LARGEST_FILE = 2_000_000  # bytes that the verifier reads
Open = tuple[Fraction, Fraction, str]
Entry = str | list[str]
Table = list[list[Entry]]
MOST_COUNTED, MOST_PLACES = 10_000, 1000  # of what the verifier takes: the bound of |λ|, and digits of an eigenvalue


def write(kernel: ModuleType, found: Enclosure, width: int = 1) -> dict[str, Any]:
    """The certificate of an enclosure whose dampings are rational numbers, as a JSON object.

    width: bits in which the ends of an interval of loads agree that is stated besides. Of a column beyond the
    textbook's with a factor that is no fraction it is one of its matrices, in balls. Raises Unproven where that is
    larger than the verifier reads.
    """
    question = found.question
    own = parameters(kernel, question.own)
    general = bool(kernel.COLUMN.get("general"))
    try:
        stated = _of_any(kernel, question, own) if general else _of_beam(kernel, question, own)
    except Unproven:
        if not general:
            raise
        return _of_matrices(kernel, found, own, width)
    return {
        "format": GENERAL if general else FORMAT,
        "column": kernel.COLUMN["name"],
        "parameters": {name: written(value) for name, value in own.items()},
        "modes": question.modes,
        "alpha": _rational(question.alpha),
        "beta": _rational(question.beta),
        **stated,
        **claimed(found),
    }


def _of_matrices(kernel: ModuleType, found: Enclosure, own: dict[str, Fraction], width: int) -> dict[str, Any]:
    """The same of M, C and K by powers of the load, entries that are no fractions as a middle and a radius."""
    question, limit = found.question, found.question.kappa is not None
    if any(part.turn for part in found.parts):
        raise Unproven("two planes are seen from a frame that turns, which no certificate of matrices in balls holds")
    width = width if found.load is None else _agreeing(found.load)
    bits = 200 + 20 * functions_of(kernel, question.modes) + width  # of the verifier's
    with precision(bits + 100):
        M, C, K, names, letters = named_matrices(kernel, question.modes, own, question.dampings, limit)
        every = {(part.names, part.motion): part for part in split(M, C, K, names, letters, limit, None)}
        whole = Part(tuple(dict.fromkeys(names)), M, C, K, letters=letters)
        parts = [every[of.names, of.motion] for of in found.parts] or [whole]
        each = [[[_entries(X, bits) for X in powers] for powers in (part.M, part.C, part.K)] for part in parts]
        for part, tables in zip(parts, each, strict=True):
            if part.gyroscopic and not limit:  # the same text on both sides: the verifier takes them for one number
                tables[:] = [[_mirrored(X, side) for X in of] for of, side in zip(tables, (1, -1, 1), strict=True)]
    for k, beside in enumerate(found.beside, 1):
        scale = found.parts[0].scale(found.parts[k]) if beside is None else None
        if scale is not None:
            of_M, of_C, of_K = each[0]
            each[k] = [of_M, of_C, [_times(table, Fraction(int(scale.p), int(scale.q))) for table in of_K]]
    rows = [_rows(part, names, len(of[0][0])) for part, of in zip(parts, each, strict=True)]
    claim = claimed(found)
    data = {
        "format": MATRICES,
        "column": kernel.COLUMN["name"],
        "parameters": {name: written(value) for name, value in own.items()},
        "modes": question.modes,
        "alpha": _rational(question.alpha),
        "beta": _rational(question.beta),
        "kappa": _ratio(question.kappa),
        "names": [name for of in rows for name in of],
        **{letter: [_beside(X) for X in zip(*(of[k] for of in each), strict=True)] for k, letter in enumerate("MCK")},
        **claim,
        "parts": [[*dict.fromkeys(of)] for of in rows],
        "beside": claim.get("beside", []),
    }
    if len(json.dumps(data, indent=1)) > LARGEST_FILE:
        raise Unproven(
            f"{kernel.COLUMN['name']} has a factor that is no fraction, and its matrices, in balls, fill more than the "
            f"{LARGEST_FILE // 10**6} MB that the verifier reads; give a lower N"
        )
    return data


def _rows(part: Part, names: Sequence[str], count: int) -> list[str]:
    """What the rows of a part are called: the field or coordinate of each, or which motion of these it is."""
    own = [name for name in names if name in part.names]
    return own if len(own) == count else [f"{'-'.join(part.names)} {part.motion + 1}"] * count


def _beside(tables: Sequence[Table]) -> Table:
    """Tables along a diagonal."""
    size, found = sum(map(len, tables)), list[list[Entry]]()
    for table in tables:
        before = ["0"] * len(found)
        found += [[*before, *row, *["0"] * (size - len(before) - len(row))] for row in table]
    return found


def _mirrored(table: Table, side: int) -> Table:
    """What is above the diagonal below it too, or with the other sign."""

    def below(entry: Entry) -> Entry:
        if isinstance(entry, str):
            return written(side * Fraction(entry))
        return [written(side * Fraction(entry[0])), entry[1]]

    return [[below(table[j][i]) if j < i else table[i][j] for j in range(len(table))] for i in range(len(table))]


def _times(table: Table, factor: Fraction) -> Table:
    def times(text: str) -> str:
        return written(factor * Fraction(text))

    return [[times(v) if isinstance(v, str) else [*map(times, v)] for v in row] for row in table]


def _agreeing(interval: tuple[Fraction, Fraction]) -> int:
    """In how many bits the ends of an interval agree."""
    return int(interval[1] / (interval[1] - interval[0])).bit_length()


def write_crossings(kernel: ModuleType, question: Question, found: Crossings) -> dict[str, Any]:
    """The certificate of all crossings of a series up to a load, as a JSON object. Raises Unproven."""
    below, parts = found.below(question), [of.part for of in found.parts]
    width = max((_agreeing(c.load) for c in found.every), default=1)
    lists = []
    for k, part in enumerate(parts):
        if k and below.beside[k - 1] is None:
            continue
        scales = ((j, other.scale(part)) for j, other in enumerate(parts[:k]) if part and other)
        of, scale = next(((j, scale) for j, scale in scales if scale is not None), (k, fmpq(1)))
        factor = Fraction(int(scale.p), int(scale.q))
        lists.append({
            c.load: {
                "kind": "divergence" if c.place is None else "flutter",
                "load": [written(v) for v in c.load],
                "frequency_squared": None if c.place is None else [written(factor * v) for v in c.place],
            }
            for c in found.every if c.part == of
        })  # fmt: skip
    return {
        "format": CROSSINGS,
        "below": write(kernel, below, width),
        "load_max": written(found.load_max),
        "crossings": [list(of.values()) for of in lists],
    }


def _entries(X: Any, bits: int) -> Table:
    """Entries as text; balls as decimals about their middles of some bits, with a radius that holds all of them."""
    unit = 10 ** (int(0.302 * bits) + 1)

    def entry(value: Any) -> Entry:
        if not isinstance(value, arb) or value == 0:
            return _text(fmpq(0) if isinstance(value, arb) else value)
        low, high = ends(value)
        middle = Fraction(round((low + high) / 2 * unit), unit)
        return [written(middle), written(max(high - middle, middle - low, Fraction(1, unit)))]

    return [[entry(value) for value in row] for row in X.tolist()]


def claimed(found: Enclosure) -> dict[str, Any]:
    """What a certificate of a series claims, and the stretches that prove it."""
    return {
        "kind": found.kind,
        "load": None if found.load is None else [written(v) for v in found.load],
        "frequency_squared": None if found.square is None else [written(v) for v in found.square],
        "load_max": None if found.load_max is None else written(found.load_max),
        "proof": dict(found.proof),
        "stretches": _separated(found.stretches),
        **(
            {
                "parts": [_apart(part) for part in found.parts],
                "beside": [_besides(of) for of in found.beside],
            }
            if found.parts
            else {}
        ),
    }


def _besides(of: Sequence[Stretch] | Enclosure | None) -> list[dict[str, Any]] | dict[str, Any] | None:
    """Of a part beside the first: its stretches; or how it is lost at the same load, with those up to there."""
    if isinstance(of, Enclosure):
        square = None if of.square is None else [written(v) for v in of.square]
        return {"kind": of.kind, "frequency_squared": square, "stretches": _separated(of.stretches)}
    return None if of is None else _separated(of)


def _apart(part: Part) -> dict[str, Any]:
    frame: dict[str, Any] | None = None
    if part.planes:
        frame = {"planes": list(map(list, part.planes)), "turn": written(part.turn)}
        frame |= {"before": True} if part.before else {}
    return {"names": list(part.names), "motion": part.motion, "frame": frame}


def _separated(stretches: Sequence[Stretch]) -> list[dict[str, Any]]:
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
    if kernel.COLUMN.get("general"):
        stated = {"format": SECTIONS, **_sections(kernel, question), **_lines(evidence)}
    else:
        stated = {"format": ITSELF, **_itself(kernel, question), **_basis(evidence)}
    flutter, load_high = crossing.kind == "flutter", ends(crossing.load)[1]
    with precision(crossing.bits):
        square = crossing.frequency * crossing.frequency
    load, of_square = (_around(ends(value), crossing.digits - 2) for value in (crossing.load, square))
    return {
        **stated,
        "kind": crossing.kind,
        "load": load,
        "frequency_squared": of_square if flutter else None,
        "proof": vars(crossing.proof),
        "stretches": _stretches(evidence, load_high),
    }


def _sections(kernel: ModuleType, question: Question) -> dict[str, Any]:
    """A column of variable or stepped section: its forms by segments, with places by their numbers."""
    own = parameters(kernel, question.own)
    stated = _of_any(kernel, question, own)
    numbers = {place: n for n, place in enumerate(stated["breaks"])}
    M, K, opened = stated["forms"]["M"], stated["forms"]["K"], stated["fields"]["y"]["opened"]
    joints = [[numbers[a], p, f] for (_, p, a, side), (*_, across), f in K[0]["points"]
              if [numbers[a], p] in opened and side == across == 1]  # fmt: skip

    def by_segment(form: dict[str, Any]) -> dict[str, Any]:
        return {
            "along": [
                [n, k, p, q, f] for n, _, p, _, q, factors in form["along"] for k, f in enumerate(factors) if f != "0"
            ],
            "points": [
                [numbers[a], p, numbers[b], q, f]
                for (_, p, a, _), (_, q, b, _), f in form["points"]
                if [numbers[a], p] not in opened
            ],
        }

    given = {name: _quotient(value) for name, value in own.items()}
    forms = kernel.forms(fmpq(1), *map(_quotient, question.dampings), **given)["C"]
    damping = by_segment(_form(forms[0])) if forms else {}
    return {
        "column": kernel.COLUMN["name"],
        "parameters": {name: written(value) for name, value in own.items()},
        "ends": list(kernel.COLUMN["ends"]),
        "breaks": stated["breaks"],
        "forms": {letter: by_segment(form) for letter, form in (("M", M[0]), ("E", K[0]), ("H", K[1]))},
        "damping": {"form": damping, "vanishing": question.kappa is not None} if any(damping.values()) else None,
        **({"joints": joints} if joints else {}),
    }


def _lines(evidence: Evidence) -> dict[str, Any]:
    """m, and the line just above all points."""
    top = max(s.separators[-1] for s in evidence.stretches)
    return {"lowest": evidence.lowest, "line": written(top * (1 + Fraction(1, 2**40)))}


def write_list(kernel: ModuleType, question: Question, survey: Survey, found: list[Crossing]) -> dict[str, Any]:
    """The certificate of all crossings of the beam itself up to a load, as a JSON object. Raises Unproven."""
    assert survey.evidence is not None
    (at_rest,) = survey.evidence.stretches
    return {
        "format": LIST,
        **_itself(kernel, question),
        **_basis(survey.evidence),
        "load_max": written(survey.load_max),
        "points": [written(point) for point in at_rest.separators],
        "crossings": [
            {
                "kind": c.kind,
                "load": _around(c.load, survey.digits),
                "frequency_squared": None if c.square is None else _around(c.square, survey.digits),
                "change": c.change,
                "unstable": c.unstable,
            }
            for c in found
        ],
    }


def write_range(
    kernel: ModuleType, questions: tuple[Question, Question], name: str, pieces: list[Piece], left: list[Open]
) -> dict[str, Any]:
    """The certificate over a range of a parameter, as a JSON object. Raises Unproven.

    questions: at both ends of the range. left: the parts that are open, with the reason.
    """
    sections = bool(kernel.COLUMN.get("general"))
    of_column, counted = (_sections, _lines) if sections else (_itself, _basis)
    one, other = (of_column(kernel, question) for question in questions)
    stated = one | {key: [one[key], other[key]] for key in ("forms", "damping", "joints") if key in one}
    if sections and name not in one["parameters"]:
        both = [written(getattr(question, name)) for question in questions]
        stated["parameters"] = one["parameters"] | {name: both}
    elif name in one["parameters"]:
        both = [of["parameters"][name] for of in (one, other)]
        stated["parameters"] = one["parameters"] | {name: both}
    else:
        stated[name] = [one[name], other[name]]
    return {
        "format": OF_SECTIONS if sections else RANGE,
        **stated,
        "range": name,
        "pieces": [
            {
                "low": written(p.low),
                "high": written(p.high),
                **counted(p.evidence),
                "kind": p.kind,
                "load": _widened(p.load),
                "frequency_squared": None if p.kind == "divergence" else _widened(_squared(p.frequency)),
                "stretches": _stretches(p.evidence, p.load[1] + (p.load[1] - p.load[0]) / 4),
            }
            for p in pieces
        ],
        "open": [[written(a), written(b)] for a, b, _ in left],
    }


def write_spectrum(
    kernel: ModuleType, question: Question, load: Fraction, found: Sequence[acb], complete_to: Fraction, digits: int
) -> dict[str, Any]:
    """The certificate of all eigenvalues of the beam itself up to a bound of |λ|, as a JSON object.

    found: enclosures, relative to |λ| narrower than 10^-digits; of a conjugate pair that with Im λ > 0. Those beyond
    the bound are left out.
    """
    with precision(BITS):
        within = [value for value in found if abs(value) < arb(fmpq(complete_to.numerator, complete_to.denominator))]
    return {
        "format": SPECTRUM,
        **_itself(kernel, question),
        "load": written(load),
        "complete_to": written(complete_to),
        "eigenvalues": [_square(value, digits) for value in within],
    }


def _square(value: acb, digits: int) -> dict[str, str]:
    """A square about an enclosure of such a relative width, with room for the rounding of what is computed of it."""
    (re, im), size = (map(ends, (value.real, value.imag))), float(abs(value).mid())
    unit = Fraction(10) ** (math.floor(math.log10(size)) - min(digits, MOST_PLACES))
    middle = (round(sum(part) / 2 / unit * 8) * unit / 8 for part in (re, im))
    return dict(zip(("re", "im", "radius"), map(written, (*middle, 2 * unit)), strict=True))


def _itself(kernel: ModuleType, question: Question) -> dict[str, Any]:
    """A column of which the beam itself is meant, at one value of everything."""
    own = parameters(kernel, question.own)
    stated = _of_beam(kernel, question, own)
    del stated["basis"]
    return {
        "column": kernel.COLUMN["name"],
        "parameters": {name: written(value) for name, value in own.items()},
        "alpha": _rational(question.alpha),
        "beta": _rational(question.beta),
        **stated,
    }


def _basis(evidence: Evidence) -> dict[str, int]:
    return {"modes": evidence.modes, "lowest": evidence.lowest}


def _stretches(evidence: Evidence, up_to: Fraction) -> list[dict[str, Any]]:
    """up_to: an end for the last one, if that is beyond its own; what is said of P = 0 alone stays so."""
    last = evidence.stretches[-1]
    return [
        {
            "start": written(s.start),
            "end": written(max(s.end, up_to) if s is last and s.end > 0 else s.end),
            "points": [written(point) for point in s.separators],
            "moving": None if s.moving is None else s.moving[0],
            "slope": written(Fraction(0) if s.moving is None else s.moving[1]),
        }
        for s in evidence.stretches
    ]


def _around(interval: tuple[Fraction, Fraction], digits: int) -> list[str]:
    """An interval of a relative width of 10^−digits, in the middle of which a value is enclosed."""
    low, high = interval
    middle, width = (low + high) / 2, abs(high) * Fraction(1, 2 * 10 ** max(digits, 15))
    grid = 10 ** (max(digits, 15) + 8)
    return _outward(middle - width, middle + width, grid)


def _widened(interval: tuple[Fraction, Fraction]) -> list[str]:
    """By an eighth of its width on each side, for what the verifier finds may be as much wider: with a sixteenth it
    refuses alpha from 0.02 to 0.022 of Pflüger's column in one piece."""
    low, high = interval
    more, grid = (high - low) / 8, 10**30
    return _outward(low - more, high + more, grid)


def _outward(low: Fraction, high: Fraction, grid: int) -> list[str]:
    return [written(Fraction(int(low * grid), grid)), written(Fraction(int(high * grid) + 1, grid))]


def _squared(interval: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
    return interval[0] ** 2, interval[1] ** 2


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
    """Breaks, fields, coordinates, M, K with what alpha and beta add to it, or where these vanish its parts, the parts
    of C, and rigid motions of any column."""
    given = {name: _quotient(value) for name, value in own.items()}
    try:
        bare, of_alpha, of_beta = (kernel.forms(fmpq(1), *map(fmpq, d), **given) for d in ((0, 0), (1, 0), (0, 1)))
        damped = kernel.forms(fmpq(1), _quotient(question.alpha), _quotient(question.beta), **given)
    except (AttributeError, DomainError, TypeError, ValueError):
        name = kernel.COLUMN["name"]
        raise Unproven(f"{name} has a factor that is no fraction, which a certificate cannot hold") from None
    less = {"C_alpha": (of_alpha, bare, "C"), "C_beta": (of_beta, bare, "C")}
    acts = question.kappa is not None and bool(kernel.COLUMN.get("circulatory"))
    less |= {"K_alpha": (of_alpha, bare, "K"), "K_beta": (of_beta, bare, "K")} if acts else {}
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
            **{
                name: [_form(*pair) for pair in zip(one[letter], other[letter], strict=True)]
                for name, (one, other, letter) in less.items()
            },
            "K": [_form(form) for form in damped["K"]],
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


def _quotient(value: Exact) -> fmpq:
    assert isinstance(value, Fraction)
    return fmpq(value.numerator, value.denominator)


def _text(value: Any) -> str:
    if not isinstance(value, int | fmpq):
        raise Unproven(f"a factor is no fraction, {value!r}, and is not for a file")
    return written(Fraction(int(value)) if isinstance(value, int) else Fraction(int(value.p), int(value.q)))


__all__ = [
    "CROSSINGS",
    "FORMAT",
    "GENERAL",
    "ITSELF",
    "LIST",
    "MATRICES",
    "RANGE",
    "SECTIONS",
    "SPECTRUM",
    "write",
    "write_crossings",
    "write_list",
    "write_of_beam",
    "write_range",
    "write_spectrum",
]
