"""What certificates of the beam itself say: their statements in full, and what of them is read from a file.

Of the verifier of certificates of the beam itself (`verifier_of_beam`). Format 3 is of the first crossing, format 4 of
all crossings up to a load, format 5 of the first crossing for each value of a parameter in a range.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from freebeam_derive.certify import verifier_claims as v
from freebeam_derive.certify.decimals import roots, said, shown
from freebeam_derive.certify.verifier_claims import Form, at_frequency, require
from freebeam_derive.certify.verifier_equations import Interval
from freebeam_derive.certify.verifier_signs import Stretch

FIRST, LIST, RANGE = (f"freebeam certificate {n}" for n in (3, 4, 5))
COLUMN = {"format", "column", "parameters", "alpha", "beta", "kappa", "ends", "forms", "damping"}
OF_FIRST = COLUMN | {"modes", "lowest", "kind", "load", "frequency_squared", "proof", "stretches"}
OF_LIST = COLUMN | {"modes", "lowest", "load_max", "points", "crossings"}
OF_RANGE = COLUMN | {"range", "pieces", "open"}
OF_CROSSING = {"kind", "load", "frequency_squared", "change", "unstable"}
OF_PIECE = {"low", "high", "modes", "lowest", "kind", "load", "frequency_squared", "stretches"}
HIGHEST = 10**5  # of a load: F is not computed beyond
MOST_STRETCHES, MOST_CROSSINGS, MOST_PIECES = 10_000, 1000, 2000
NO_CROSSING = f"of the beam itself a crossing is certified, below the load {HIGHEST}"
CHANGES = {"flutter": (2, -2), "divergence": (1, -1), "touch": (0,)}


# --- statements ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class OfBeamItself(v.OfBeam):
    """A statement of the partial differential equation; modes: as many as the bounds took."""

    @property
    def of(self) -> str:
        """The column, its ends and its damping."""
        what = f"column {self.named}" if self.ours else self.forms
        return f"the beam itself, {what}, {self.ends[0]} at x = 0 and {self.ends[1]} at x = 1, {self.damped}"

    def __str__(self) -> str:
        return (
            f"proven of {self.of}: exactly one load {_where(self)}; "
            "it is the first over all modes, and stable is every load from 0 up to it"
        )

    @property
    def of_column(self) -> dict[str, Any]:
        given = super().of_column
        return given | {"of": f"the beam itself: {given['of']}"}


def _where(claim: OfBeamItself | Piece) -> str:
    """Between which loads, of which kind, with which frequency."""
    assert claim.load is not None
    where = f"between {' and '.join(shown(*claim.load))} is one of {claim.kind}, "
    if claim.frequency is None:
        return where + "where s = 0"
    return f"{where}with omega between {' and '.join(shown(*claim.frequency))}"


@dataclass(frozen=True)
class Passing:
    """One of all crossings. load, square: intervals of P and ω² (None at s = 0); unstable: how many eigenvalues are so
    below it, change: how many more above it."""

    kind: str
    load: Interval
    square: Interval | None
    change: int
    unstable: int

    def __str__(self) -> str:
        what = f"{self.kind} between {' and '.join(shown(*self.load))}"
        if self.square is not None:
            what += f" {at_frequency(roots(*self.square))}"
        return f"{what} (unstable below it: {self.unstable}, above it: {self.unstable + self.change})"


@dataclass(frozen=True)
class OfAllCrossings(OfBeamItself):
    """A statement of every load up to load_max at which the number of unstable eigenvalues changes, or zero is touched.

    kind: "all".
    """

    passings: tuple[Passing, ...]

    def __str__(self) -> str:
        assert self.load_max is not None
        those = "those that grow, to first order" if self.kappa is not None else "those with Re > 0"
        touched, passed = ([p for p in self.passings if (p.change == 0) is still] for still in (True, False))
        text = (
            f"proven of {self.of}, over all modes: for P from 0 to {said(self.load_max)} the number of unstable "
            f"eigenvalues, {those}, is 0 at P = 0 and changes "
        )
        text += f"at exactly {len(passed)} of these loads: {'; '.join(map(str, passed))}" if passed else "nowhere"
        if touched:
            text += f"; besides, a simple eigenvalue touches zero and goes back at a {'; '.join(map(str, touched))}"
        return text

    def record(self) -> dict[str, Any]:
        return super().record() | {
            "stable_to": None, "load_max": said(self.load_max or Fraction(0)),
            "crossings": [recorded(p) | {"unstable_below": p.unstable, "unstable_above": p.unstable + p.change}
                          for p in self.passings],
        }  # fmt: skip


@dataclass(frozen=True)
class Piece:
    """Of each value of a parameter from low to high; stretches: over which the m lowest eigenvalues are apart."""

    low: Fraction
    high: Fraction
    modes: int
    lowest: int
    kind: str
    load: Interval
    square: Interval | None
    stretches: tuple[Stretch, ...]

    @property
    def frequency(self) -> Interval | None:
        return None if self.square is None else roots(*self.square)


@dataclass(frozen=True)
class OverRange(OfBeamItself):
    """A statement of each value of a parameter from low to high but for the parts that are open.

    What is inherited is that of the column at the lower end; other: at the upper one. load: that holds the loads of all
    pieces; kind: "range".
    """

    parameter: str
    other: OfBeamItself
    low: Fraction
    high: Fraction
    pieces: tuple[Piece, ...]
    open: tuple[Interval, ...]

    @property
    def named(self) -> str:
        own = {name: value for name, value in self.parameters.items() if name != self.parameter}
        return replace(self.other, parameters=own).named

    def __str__(self) -> str:
        name, of = self.parameter, self.of
        if self.damped != self.other.damped:
            of += f" at one end and {self.other.damped} at the other"
        if not self.ours:
            of += f", linear in {name} between what this file says of its two ends"
        parts = [f"{name} from {said(p.low)} to {said(p.high)}: exactly one load {_where(p)}" for p in self.pieces]
        parts += [f"nothing is said of {name} from {said(a)} to {said(b)}" for a, b in self.open]
        return (
            f"proven of {of}, for each value of {name} from {said(self.low)} to {said(self.high)}: {'; '.join(parts)}; "
            "each is the first over all modes, and stable is every load from 0 up to it"
        )

    def record(self) -> dict[str, Any]:
        stated, other = super().record(), replace(self.other, load=self.load).record()
        both = {key: [stated[key], other[key]] for key in ("parameters", "alpha", "beta", "kappa", "damping")}
        return {key: stated[key] for key in ("column", "of", "ends", "kind")} | {
            **{key: one if one == two else [one, two] for key, (one, two) in both.items()},
            "range": self.parameter, "low": said(self.low), "high": said(self.high),
            "pieces": [{"low": said(p.low), "high": said(p.high)} | recorded(p) for p in self.pieces],
            "open": [[said(a), said(b)] for a, b in self.open],
        }  # fmt: skip


def recorded(claim: Passing | Piece) -> dict[str, Any]:
    load = shown(*claim.load)
    frequency = ("0", "0") if claim.square is None else shown(*roots(*claim.square))
    return {
        "kind": claim.kind, "load_lower": load[0], "load_upper": load[1],
        "frequency_lower": frequency[0], "frequency_upper": frequency[1],
    }  # fmt: skip


# --- reading -------------------------------------------------------------------------------------------------------


Forms = dict[str, Form]


def fields(data: dict[str, Any], names: set[str]) -> None:
    require(set(data) == names, f"fields are missing, or not known: {', '.join(sorted(names ^ set(data)))[:100]}")


def column(data: dict[str, Any], of: type[OfBeamItself] = OfBeamItself, **claims: Any) -> tuple[Any, Forms]:
    """A statement of the column in a file with these claims, and its forms. Raises Refused."""
    left, right = data["ends"]
    require(left in v.ORDERS and right in v.ORDERS, "the ends are not known")
    given = {"load": None, "square": None, "load_max": None} | v.named(data) | claims
    kappa, damping = v.damping_of(data, given)
    if damping is not None:
        require(damping.of_E > 0 or damping.of_E == 0 <= damping.of_M, "the damping is negative")
        require(damping.of_E > 0 or damping.of_M > 0, "there is no damping at all")
    require(set(data["forms"]) == set("MEH"), "the forms are not M, E and H")
    forms = {name: v.form(data["forms"][name]) for name in "MEH"}
    require(forms["M"] == (((0, 0, 0, Fraction(1)),), ()), "the mass is not that of the uniform beam")
    bending = [term for term in forms["E"][0] if term[:3] == (0, 2, 2)]
    require(bending == [(0, 2, 2, Fraction(1))], "the bending stiffness is not that of the uniform beam")
    ours = v.is_ours(given["column"])
    stated = of(**given, ours=ours, ends=(left, right), basis="modes", kappa=kappa, damping=damping)
    if ours:
        v.check_column(stated, forms)
    return stated, forms


def listed(given: Any, most: int, what: str) -> list[Any]:
    require(type(given) is list and len(given) <= most, f"there is no list of {what}, or there are too many")
    assert isinstance(given, list)
    return given


def lowest(data: dict[str, Any]) -> int:
    """m."""
    m = data["lowest"]
    require(type(m) is int and 0 < m < data["modes"], "the number of lowest eigenvalues is none")
    return int(m)


def stretches_of(data: dict[str, Any], m: int) -> tuple[Stretch, ...]:
    return tuple(_stretch(s, m) for s in listed(data["stretches"], MOST_STRETCHES, "stretches"))


def _stretch(data: dict[str, Any], m: int) -> Stretch:
    require(set(data) == {"start", "end", "points", "moving", "slope"}, "a stretch has other parts than it should")
    start, end, slope = (v.number(data[k]) for k in ("start", "end", "slope"))
    moving = data["moving"]
    require(moving is None or (type(moving) is int and 0 <= moving < m), "a point that moves is none")
    return Stretch(start, end, points(data["points"], m), moving, slope)


def points(data: list[str], m: int) -> tuple[Fraction, ...]:
    """m + 1 values of s, the first 0, ascending."""
    require(len(data) == m + 1, "there are too few points, or too many")
    found = tuple(v.number(x) for x in data)
    require(found[0] == 0, "there are too few points, or too many")
    require(all(a < b for a, b in pairwise(found)), "the points do not ascend")
    return found


def first(data: dict[str, Any]) -> tuple[OfBeamItself, Forms, int, tuple[Stretch, ...]]:
    """Of a file of the first crossing: what is claimed, the forms, m, and the stretches. Raises Refused."""
    fields(data, OF_FIRST)
    claims = v.claims_of(data | {"load_max": None})
    require(claims["kind"] != "none" and claims["load"][1] < HIGHEST, NO_CROSSING)
    stated, forms = column(data, **claims)
    m = lowest(data)
    return stated, forms, m, stretches_of(data, m)


def crossings(data: dict[str, Any]) -> tuple[OfAllCrossings, Forms, int, Stretch]:
    """Of a file of all crossings: what is claimed, the forms, m, and the points at P = 0. Raises Refused."""
    fields(data, OF_LIST)
    load_max, m = v.number(data["load_max"]), lowest(data)
    require(0 < load_max < HIGHEST, "the loads end where they begin, or go on for too long")
    found = tuple(_passing(c) for c in listed(data["crossings"], MOST_CROSSINGS, "crossings"))
    unstable, reached = 0, Fraction(0)
    for c in found:
        require(reached < c.load[0], "the crossings do not ascend, or lie on one another")
        require(c.unstable == unstable, "the numbers of unstable eigenvalues do not fit the changes")
        unstable, reached = unstable + c.change, c.load[1]
        require(unstable >= 0, "fewer than no eigenvalue would be unstable")
    require(reached < load_max, "a crossing is not below the end of the loads")
    stated, forms = column(data, OfAllCrossings, kind="all", load_max=load_max, passings=found)
    return stated, forms, m, Stretch(Fraction(0), Fraction(0), points(data["points"], m), None, Fraction(0))


def _passing(data: dict[str, Any]) -> Passing:
    fields(data, OF_CROSSING)
    kind, change, unstable = (data[k] for k in ("kind", "change", "unstable"))
    require(type(change) is int and type(unstable) is int and change in CHANGES.get(kind, ()), "a change is none")
    read = v.crossing(data | {"kind": "divergence" if kind == "touch" else kind})
    return Passing(kind, read["load"], read["square"], change, unstable)


def over_range(data: dict[str, Any]) -> tuple[OverRange, tuple[Forms, Forms]]:
    """Of a file over a range: what is claimed, and the forms at both ends. Raises Refused.

    What the parameter changes is given at both ends, as a list of two: its value, the forms and the damping.
    """
    fields(data, OF_RANGE)
    name = data["range"]
    pieces = pieces_of(data, piece)
    modes = {"modes": max(p.modes for p in pieces)}
    (one, forms), (other, others) = (column(at_end(data, name, k) | modes, kind="range") for k in (0, 1))
    changed = [(d.of_E, d.of_M) for d in (one.damping, other.damping) if d is not None]
    require(len(changed) != 1, "there is damping at one end of the range alone")
    require(len({of_E > 0 for of_E, _ in changed}) <= 1, "internal damping is nothing at one end of the range alone")
    if one.ours:
        v.check_linear(one, name)
    return OverRange(**vars(one) | in_pieces(data, one, other, pieces)), (forms, others)


def pieces_of(data: dict[str, Any], read: Callable[[dict[str, Any]], Any]) -> tuple[Any, ...]:
    pieces = tuple(read(p) for p in listed(data["pieces"], MOST_PIECES, "pieces"))
    require(bool(pieces), "nothing is said of any value")
    return pieces


def in_pieces(data: dict[str, Any], one: OfBeamItself, other: OfBeamItself, pieces: tuple[Any, ...]) -> dict[str, Any]:
    """What a statement over a range says besides that of its lower end. Raises Refused where a value is left out."""
    low, high = (_value(stated, data["range"]) for stated in (one, other))
    left = tuple((v.number(a), v.number(b)) for a, b in listed(data["open"], MOST_PIECES, "open parts"))
    reached = low
    for a, b in sorted([*((p.low, p.high) for p in pieces), *left]):
        require(a == reached < b, "the pieces leave a gap, or lie on one another")
        reached = b
    require(reached == high, "the pieces leave a gap, or lie on one another")
    whole = min(p.load[0] for p in pieces), max(p.load[1] for p in pieces)
    of_range = {"low": low, "high": high, "pieces": pieces, "open": left}
    return of_range | {"load": whole, "parameter": data["range"], "other": other}


def at_end(data: dict[str, Any], name: str, k: int) -> dict[str, Any]:
    """What stands in a file at one end of its range, as that of one value."""
    require(name in ("alpha", "beta", "kappa") or name in data["parameters"], "the parameter of the range is none")

    def end(value: Any) -> Any:
        require(type(value) is list and len(value) == 2, "what a range changes is not given at its two ends")
        return value[k]

    chosen = {key: end(data[key]) for key in ("forms", "damping", "joints") if key in data}
    if name in data["parameters"]:
        return data | chosen | {"parameters": data["parameters"] | {name: end(data["parameters"][name])}}
    return data | chosen | {name: end(data[name])}


def _value(stated: OfBeamItself, name: str) -> Fraction:
    found = stated.parameters[name] if name in stated.parameters else getattr(stated, name)
    assert isinstance(found, Fraction)
    return found


def piece(data: dict[str, Any]) -> Piece:
    fields(data, OF_PIECE)
    modes, m = data["modes"], lowest(data)
    require(type(modes) is int and modes <= v.MOST_MODES, f"the number of functions is not from 1 to {v.MOST_MODES}")
    read = v.crossing(data)
    require(read["kind"] != "none" and read["load"][1] < HIGHEST, NO_CROSSING)
    low, high = (v.number(data[k]) for k in ("low", "high"))
    return Piece(low, high, modes, m, read["kind"], read["load"], read["square"], stretches_of(data, m))
