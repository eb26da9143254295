"""What a certificate says, for its verifiers: numbers, forms and dampings read from a file, and statements in full.

All that is given in a file is checked for its type and size before anything is computed, so that a file that no one
wrote is refused at once. Nothing here is mathematics of a proof: that is in `verifier` and `verifier_of_beam`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from importlib import import_module
from pathlib import Path
from typing import Any

from flint import arb, fmpq, fmpq_poly

from freebeam_derive.certify.decimals import read, roots, said, shown
from freebeam_kernels import COLUMNS

ORDERS = {"free": (2, 3), "clamped": (0, 1), "pinned": (0, 2), "sliding": (1, 3)}
Form = tuple[tuple[tuple[int, int, int, Fraction], ...], tuple[tuple[int, int, int, int, Fraction], ...]]

# More than any certificate holds that is written: files that would only use up time and memory are not begun.
LARGEST_FILE = 2_000_000  # bytes; 30,000 or so at N = 8, 300,000 where 10,000 digits are proven
MOST_MODES, MOST_TERMS, HIGHEST_POWER = 200, 100, 100
LASTING = "there stable says that all lambda^2 are real, negative and simple"
NARROWEST = Fraction(1, 10**10_050)  # width of an interval, in parts of its upper end


class Refused(Exception):
    """The certificate does not prove what it claims; the message says where."""


def require(condition: bool, claim: str) -> None:
    if not condition:
        raise Refused(claim)


def ball(value: str | Fraction) -> arb:
    value = Fraction(value)
    return arb(fmpq(value.numerator, value.denominator))


def exact(value: Fraction) -> fmpq:
    return fmpq(value.numerator, value.denominator)


def greatest(values: Iterable[arb]) -> arb:
    """What none of these is above; NaN where one is that. (Floats would take all below 1e-308 for the same.)"""
    return reduce(arb.max, values)


def least(values: Iterable[arb]) -> arb:
    """What none of these is below; NaN where one is that."""
    return reduce(arb.min, values)


# --- statements --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Damping:
    """C = of_M M + of_E E; vanishing: only its direction."""

    of_M: Fraction
    of_E: Fraction
    vanishing: bool


@dataclass(frozen=True)
class Statement:
    """What acceptance of a certificate proves: the theorem at the head of this file, of this column.

    load, square: rational intervals of P* and ω² (None where there is none). All nondimensional.
    """

    column: str
    parameters: dict[str, Fraction]
    modes: int
    alpha: Fraction
    beta: Fraction
    kind: str
    load: tuple[Fraction, Fraction] | None
    square: tuple[Fraction, Fraction] | None
    load_max: Fraction | None

    @property
    def end(self) -> Fraction:
        """The load up to which the column is stable."""
        value = self.load_max if self.load is None else self.load[0]
        assert value is not None
        return value

    @property
    def top(self) -> Fraction:
        """The load up to which nothing else happens."""
        return self.end if self.load is None else self.load[1]

    @property
    def frequency(self) -> tuple[Fraction, Fraction] | None:
        """A rational interval of ω, nondimensional; None where λ = 0 or there is no crossing."""
        return None if self.square is None else roots(*self.square)

    @property
    def of_one(self) -> str:
        """Of which motions frequencies do not meet, in words."""
        return ""

    @property
    def named(self) -> str:
        """The column and its parameters."""
        return self.column + "".join(f", {name} = {said(value)}" for name, value in self.parameters.items())

    @property
    def forms(self) -> str:
        return f"the forms in this file (which names them {self.named}; that they are its is not checked)"

    @property
    def of(self) -> str:
        """What it is a statement of, in words: the forms, the functions and the damping."""
        raise NotImplementedError

    def proven(self, damped: bool, above_zero: bool = False, also: str = "", lasting: bool = False) -> str:
        """The statement in full, in one line. also: what else is lost at that load; lasting: some parts are undamped
        beside others."""
        loads = "every load P above 0 up to" if above_zero else "every load P from 0 to"
        stable = f"proven of {self.of}: stable at {loads}"
        if self.load is None:
            return f"{stable} {said(self.end)}"
        low, high = shown(*self.load)
        lost = f"stability is first lost by {self.kind}, at exactly one load between {low} and {high}"
        where = "where det K = 0"
        if self.frequency is not None:
            where = at_frequency(self.frequency)
        other = f"eigenvalue{self.of_one} has Re = 0" if damped else f"frequencies{self.of_one} meet"
        if lasting:
            other = "eigenvalue of a damped part has Re = 0, and no frequencies of an undamped one meet,"
        return f"{stable} {low}; {lost}, {where}{also}; no other {other} up to {high}"

    def record(self) -> dict[str, Any]:
        """The statement as a JSON object; numbers as text, intervals rounded outwards. What is not proven is null."""
        load, frequency = ((None, None) if v is None else shown(*v) for v in (self.load, self.frequency))
        if self.kind == "divergence":
            frequency = "0", "0"
        return {
            "column": self.column, "modes": self.modes, "kind": self.kind, "load_lower": load[0], "load_upper": load[1],
            "frequency_lower": frequency[0], "frequency_upper": frequency[1], "stable_to": load[0] or said(self.end),
        }  # fmt: skip


@dataclass(frozen=True)
class OfBeam(Statement):
    """A statement of M, E, H over one segment.

    ours: the column is one of this program's, and ends, forms and damping are its; else all is of those in the file.
    """

    ours: bool
    ends: tuple[str, str]
    basis: str
    kappa: Fraction | float | None
    damping: Damping | None

    @property
    def of(self) -> str:
        what = f"column {self.named}" if self.ours else self.forms
        what += f", {self.ends[0]} at x = 0 and {self.ends[1]} at x = 1, N = {self.modes} ({self.basis})"
        return f"{what}, {self.damped}"

    def __str__(self) -> str:
        return self.proven(self.damping is not None)

    def record(self) -> dict[str, Any]:
        return super().record() | {"basis": self.basis} | self.of_column

    @property
    def of_column(self) -> dict[str, Any]:
        """Which column it is of, as a JSON object."""
        ours, factors = self.ours, None
        if self.damping is not None:
            of_M, of_E = said(self.damping.of_M), said(self.damping.of_E)
            factors = {"of_M": of_M, "of_E": of_E, "vanishing": self.damping.vanishing}
        return {
            "of": f"the column {self.column}" if ours else "the forms in this file",
            "ends": list(self.ends),
            "parameters": {name: said(value) for name, value in self.parameters.items()} if ours else None,
            "alpha": said(self.alpha) if ours else None, "beta": said(self.beta) if ours else None,
            "kappa": _said(self.kappa) if ours else None, "damping": factors,
        }  # fmt: skip

    @property
    def damped(self) -> str:
        """The damping in words."""
        if self.damping is None:
            return "undamped"
        factors = f"{said(self.damping.of_M)} M + {said(self.damping.of_E)} E"
        if self.kappa is not None:
            asked = f" ({vanishing(self.kappa)})" if self.ours else ""
            return f"in the limit of vanishing damping in the direction of C = {factors}{asked}"
        asked = f" (alpha = {said(self.alpha)}, beta = {said(self.beta)})" if self.ours else ""
        return f"C = {factors}{asked}"


@dataclass(frozen=True)
class Lost:
    """A part that is lost at the same load as the first: its fields and coordinates, the kind, intervals of ω² (of
    ω + turn where planes whirl) and of ω; turn: the rate of the frame of planes that are seen from rest."""

    names: tuple[str, ...]
    kind: str
    square: tuple[Fraction, Fraction] | None
    omega: tuple[Fraction, Fraction] | None
    turn: fmpq | None = None


@dataclass(frozen=True)
class OfForms(Statement):
    """A statement of the forms in a file, of fields on segments and coordinates.

    modes: polynomials are of degree modes + 1; size: how many functions that makes, without `motions` rigid ones.
    damped: C is not nothing, and not gyroscopic alone; lasting: parts that it does not damp beside others; above_zero:
    but is at P = 0, or K is singular there, and what is said is said of P > 0. scales: of λ² in the parts that are the
    first again, itself counted, but for the unit of time. at_once: other parts that are lost at exactly the same load.
    """

    breaks: tuple[Fraction, ...]
    unknowns: tuple[str, ...]
    kappa: Fraction | float | None
    size: int
    motions: int
    damped: bool
    above_zero: bool
    lasting: tuple[tuple[str, ...], ...] = ()
    gyroscopic: bool = False
    parts: tuple[tuple[str, ...], ...] = ()
    scales: tuple[Fraction, ...] = (Fraction(1),)
    turn: fmpq | None = None
    whirls: bool = False
    at_once: tuple[Lost, ...] = ()

    @property
    def times(self) -> int:
        """How many of the parts are the first."""
        return len(self.scales)

    @property
    def of_one(self) -> str:
        return " of one sense of whirl" if self.whirls else " of one of these" if len(self.parts) > 1 else ""

    @property
    def frequency(self) -> tuple[Fraction, Fraction] | None:
        """As of any statement; where two planes whirl, `square` is an interval of ω + turn."""
        if not self.whirls or self.square is None or self.turn is None:
            return super().frequency
        return whirl(self.square, self.turn)

    @property
    def of(self) -> str:
        what = f"{self.forms}, of {' and '.join(self.unknowns)}, breaks at {', '.join(map(said, self.breaks))}"
        what += f", N = {self.modes} ({self.size} functions)"
        if self.motions:
            what += f", {self.motions} rigid motion{'s' if self.motions > 1 else ''} left out"
        of = f", alpha = {said(self.alpha)}, beta = {said(self.beta)}" if self.damped else ", undamped"
        of += " but for gyroscopic terms" if self.gyroscopic else ""
        if self.kappa is not None:
            of = f", in the limit of vanishing damping{' beside gyroscopic terms' * self.gyroscopic}"
            of += f", {vanishing(self.kappa)}"
        if len(self.parts) > 1:
            of += f", {_motions(self.parts)} leaving each other alone"
        if self.lasting:
            of += f", {_motions(self.lasting)} undamped ({LASTING})"
        if self.times > 1:
            but = " but for the unit of time" if set(self.scales) != {1} else ""
            of += f", {self.times} of them the same{but}, of which each is lost at a load where one is"
        return what + of

    def __str__(self) -> str:
        return self.proven(self.damped, self.above_zero, self._also, bool(self.lasting))

    @property
    def _also(self) -> str:
        """How its frequency is seen, and what else is lost at the same load, in words."""
        text = "" if self.whirls else _from_rest(self.turn)
        for of in self.at_once:
            where = "where det K = 0" if of.omega is None else at_frequency(of.omega)
            where += _from_rest(of.turn)
            text += f", and at exactly that load by {of.kind} of motions of {'-'.join(of.names)}, {where}"
        return text

    def record(self) -> dict[str, Any]:
        return super().record() | {
            "of": "the forms in this file", "parameters": None, "breaks": [*map(said, self.breaks)],
            "unknowns": [*self.unknowns], "functions": self.size, "rigid_motions_left_out": self.motions,
            "alpha": said(self.alpha), "beta": said(self.beta), "damped": self.damped, "gyroscopic": self.gyroscopic,
            "kappa": _said(self.kappa),
            "stable_at_zero_load": None if self.above_zero else True,
            "parts": [*map(list, self.parts)], "lasting": [*map(list, self.lasting)], "times": self.times,
            "turn": None if self.turn is None or self.whirls else str(self.turn),
            "at_once": [
                {"of": [*of.names], "kind": of.kind, "frequency_lower": low, "frequency_upper": high,
                 "turn": None if of.turn is None else str(of.turn)}
                for of in self.at_once for low, high in [shown(*of.omega) if of.omega else ("0", "0")]
            ],
        }  # fmt: skip


def _motions(parts: Sequence[tuple[str, ...]]) -> str:
    """Parts in words, those of the same names counted."""
    named = {names: parts.count(names) for names in parts}
    return " and ".join(f"{n} motions of " * (n > 1) + "-".join(names) for names, n in named.items())


def at_frequency(omega: tuple[Fraction, Fraction]) -> str:
    """Where a pair crosses, in words."""
    if not any(omega):
        return "where a pair of eigenvalues leaves zero"
    return f"with omega between {' and '.join(shown(*omega))}"


def _from_rest(turn: fmpq | None) -> str:
    """How a frequency is seen, in words."""
    return "" if turn is None else f" as seen from rest (in the frame each omega is omega - {turn} and omega + {turn})"


def whirl(square: tuple[Fraction, Fraction], turn: fmpq) -> tuple[Fraction, Fraction]:
    """An interval of |ω| from one of ω + turn."""
    low, high = (v - Fraction(int(turn.p), int(turn.q)) for v in square)
    return (low, high) if low > 0 else (-high, -low) if high < 0 else (Fraction(0), max(-low, high))


def _said(kappa: Fraction | float | None) -> str | None:
    return "inf" if isinstance(kappa, float) else None if kappa is None else said(kappa)


def vanishing(kappa: Fraction | float) -> str:
    """How alpha and beta vanish, in words."""
    return "beta -> 0+ at alpha = 0" if isinstance(kappa, float) else f"alpha -> 0+ at beta = {said(kappa)} alpha"


# --- what is claimed -----------------------------------------------------------------------------------------------


def named(data: dict[str, Any]) -> dict[str, Any]:
    """What a certificate names: column, parameters, functions and damping, each of the type and size it must be."""
    column, N = data["column"], data["modes"]
    require(type(column) is str and len(column) <= 200 and column.isprintable(), "the column has no name")
    require(type(N) is int and 0 < N <= MOST_MODES, f"the number of functions is not from 1 to {MOST_MODES}")
    parameters = data["parameters"]
    known = len(parameters) <= MOST_TERMS and all(name.isidentifier() and len(name) <= 200 for name in parameters)
    require(known, "a parameter has no name, or there are too many")
    return {
        "column": column, "parameters": {name: number(value) for name, value in parameters.items()}, "modes": N,
        "alpha": number(data["alpha"]), "beta": number(data["beta"]),
    }  # fmt: skip


def crossing(data: dict[str, Any], at_zero: bool = False) -> dict[str, Any]:
    """Kind, load and squared frequency of a crossing, or of none, which must fit each other. at_zero: that may be 0, of
    a pair that leaves zero."""
    kind = data["kind"]
    require(kind in ("none", "flutter", "divergence"), "the kind is neither flutter nor divergence")
    given = [data[k] is not None for k in ("load", "frequency_squared")]
    require(given == [kind != "none", kind == "flutter"], "what is given does not fit the kind")
    load = None if data["load"] is None else interval(data["load"])
    square = data["frequency_squared"]
    if square is not None:
        square = (Fraction(0), Fraction(0)) if at_zero and square == ["0", "0"] else interval(square)
    return {"kind": kind, "load": load, "square": square}


def claims_of(data: dict[str, Any], at_zero: bool = False) -> dict[str, Any]:
    """What is claimed of any column, each of the type and size that it must be, and whether it fits each other.
    at_zero: as of `crossing`."""
    claims = named(data) | crossing(data, at_zero)
    crosses = claims["kind"] != "none"
    proof = {"crossing": crosses, "first": crosses, "stable_below": True, "kind": True}
    require(data["proof"] == proof, "what is said to be proven is not what is checked")
    require((data["load_max"] is None) == crosses, "what is given does not fit the kind")
    return claims | {"load_max": None if crosses else number(data["load_max"])}


def ratio(value: object) -> Fraction | float | None:
    """kappa of a file: a number, infinite where beta alone vanishes, or none."""
    return None if value is None else math.inf if value == "inf" else number(value)


def direction(kappa: Fraction | float) -> tuple[Fraction, Fraction]:
    """In which alpha and beta vanish."""
    return (Fraction(0), Fraction(1)) if isinstance(kappa, float) else (Fraction(1), kappa)


def damping_of(data: dict[str, Any], claims: dict[str, Any]) -> tuple[Fraction | float | None, Damping | None]:
    """kappa and the damping c_M M + c_E E of a file, each of which must fit the other, alpha and beta."""
    kappa = ratio(data["kappa"])
    finite, limit = claims["alpha"] != 0 or claims["beta"] != 0, kappa is not None
    require(not (finite and limit), "the damping is finite and vanishes")
    damping = data["damping"]
    require((damping is not None) == (finite or limit), "the damping does not fit alpha, beta and kappa")
    if damping is None:
        return kappa, None
    require(set(damping) == {"of_M", "of_E", "vanishing"}, "the damping is not of_M, of_E and vanishing")
    require(damping["vanishing"] is limit, "the damping does not fit kappa")
    found = Damping(number(damping["of_M"]), number(damping["of_E"]), limit)
    there = found.of_E > 0 or found.of_E == 0 < found.of_M
    require(not limit or there, "no damping is there to vanish")
    return kappa, found


def number(value: object) -> Fraction:
    require(type(value) is str, f"a number is not given as text: {str(value)[:40]}")
    found = read(str(value))
    require(abs(found) < 10**300, "a number is larger than any that is written")
    return found


def interval(values: Any) -> tuple[Fraction, Fraction]:
    low, high = map(number, values)
    require(0 < low < high, "an interval is empty, or not positive")
    require(high - low > high * NARROWEST, "an interval is narrower than any that is written")
    return low, high


def form(data: dict[str, Any]) -> Form:
    """Factors of ∫ xᵏ φᵢ⁽ᵖ⁾ φⱼ⁽ᑫ⁾ dx and of φᵢ⁽ᵖ⁾(a) φⱼ⁽ᑫ⁾(b)."""
    require(set(data) == {"along", "points"}, "a form has other parts than integrals and end values")
    require(len(data["along"]) + len(data["points"]) <= MOST_TERMS, "a form has too many terms")
    along = tuple((k, p, q, number(v)) for k, p, q, v in data["along"])
    points = tuple((a, p, b, q, number(v)) for a, p, b, q, v in data["points"])
    whole = [*((k, HIGHEST_POWER) for k, *_ in along), *((n, 3) for _, p, q, _ in along for n in (p, q))]
    whole += [(n, m) for a, p, b, q, _ in points for n, m in ((a, 1), (p, 3), (b, 1), (q, 3))]
    require(all(type(n) is int and 0 <= n <= most for n, most in whole), "a form has no such power, order or end")
    return along, points


def is_ours(column: str) -> bool:
    """Whether a column is one of this program's."""
    return column in COLUMNS


def check_column(stated: OfBeam, forms: dict[str, Form]) -> None:
    """Ends, forms and damping are those that the emitted kernel of that name states, exactly."""
    kernel = import_module(f"freebeam_kernels.{COLUMNS[stated.column][stated.basis]}")
    own, what = stated.parameters, f"those of the column {stated.column}"
    require(set(own) == {p["name"] for p in kernel.COLUMN["parameters"]}, f"the parameters are not {what}")
    require(stated.ends == tuple(kernel.COLUMN["ends"]), f"the ends are not {what}")
    for name, (along, points) in kernel.forms(Fraction(1), **own).items():
        known = {(*key, Fraction(v)) for key, v in along.items()}, {(*key, Fraction(v)) for key, v in points.items()}
        theirs = forms[name]
        once = all(len(set(part)) == len(part) for part in theirs)
        same = once and (set(theirs[0]), set(theirs[1])) == known
        require(same, f"the form {name} is not {what} at these parameters")
    if stated.damping is not None:
        alpha, beta = (stated.alpha, stated.beta) if stated.kappa is None else direction(stated.kappa)
        factors = stated.damping.of_M, stated.damping.of_E
        asked = "alpha, beta and kappa"
        require(factors == tuple(kernel.damping_factors(alpha, beta, **own)), f"the damping is not {what} at {asked}")


def check_linear(one: OfBeam, name: str) -> None:
    """Of one of this program's columns: forms and damping are linear in the parameter, and so given by those at its two
    ends. Checked with polynomials of it in its place."""
    kernel = import_module(f"freebeam_kernels.{COLUMNS[one.column]['modes']}")
    given = one.parameters | {"alpha": one.alpha, "beta": one.beta}
    if one.kappa is not None:
        given |= dict(zip(("alpha", "beta"), direction(one.kappa), strict=True))
    held = {key: fmpq_poly([exact(value)]) for key, value in given.items()}
    held["beta" if name == "kappa" else name] = fmpq_poly([0, 1])
    alpha, beta = held.pop("alpha"), held.pop("beta")
    factors = [*kernel.damping_factors(alpha, beta, **held)]
    for parts in kernel.forms(fmpq_poly([1]), **held).values():
        factors += [f for part in parts for f in part.values()]
    linear = all(not isinstance(f, fmpq_poly) or f.degree() <= 1 for f in factors)
    require(linear, f"the column {one.column} is not linear in {name}")


# --- files ---------------------------------------------------------------------------------------------------------


def contents(path: Path | str) -> bytes:
    """What stands in a file, and one byte more than any certificate has at most. Raises OSError."""
    with open(path, "rb") as file:
        return file.read(LARGEST_FILE + 1)


def parsed(content: bytes) -> Any:
    """JSON of the kind that certificates are. Raises Refused, ValueError."""
    require(len(content) <= LARGEST_FILE, f"is larger than any certificate, {LARGEST_FILE} bytes")
    return json.loads(content, **STRICT)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    require(len(found) == len(pairs), "a name stands twice in one object")
    return found


def _short(text: str) -> int:
    require(len(text) <= 9, "an integer is too long")
    return int(text)


def _never(text: str) -> None:
    raise Refused(f"a number is given as {text[:20]}, not as text")


STRICT: dict[str, Any] = {
    "object_pairs_hook": _once, "parse_int": _short, "parse_float": _never, "parse_constant": _never,
}  # fmt: skip
