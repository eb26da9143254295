"""Certified critical loads: intervals that are proven to hold them. The way from the runtime to the provers.

The runtime's critical load is the candidate; the proof is ball arithmetic from there, see
`freebeam_derive.certify`. Inputs are exact: fractions as they are, floats the binary numbers that they are, text the
decimal that it says.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from freebeam_sym.checks import InputError, count
from freebeam_sym.critical import critical_load

if TYPE_CHECKING:
    from freebeam_sym.columns import Column

__all__ = ["Certified", "certified_load", "exact_load", "rational", "verify_certificate"]

MOST_DIGITS = 10_000


@dataclass(frozen=True)
class Certified:
    """A critical load with its proof, nondimensional.

    load and frequency: (lower, upper) as decimal text, rounded outwards; None where kind is "none". proof: what was
    proven (crossing, first, stable_below, kind). inputs: what each input was taken for. certificate: the data that
    prove it, for a file.
    """

    load: tuple[str, str] | None
    frequency: tuple[str, str] | None
    kind: str
    proof: Mapping[str, bool]
    digits: int
    inputs: Mapping[str, str]
    certificate: Mapping[str, Any] | None = field(repr=False, default=None)


def rational(name: str, value: object) -> tuple[Fraction, str]:
    """A number as an exact fraction, and what it was taken for. Raises InputError where it is none."""
    try:
        if isinstance(value, str):
            return Fraction(value.strip()), f"the decimal {value.strip()}"
        if isinstance(value, bool):
            raise ValueError
        if isinstance(value, float):
            exact = Fraction(value)
            whole = exact.denominator == 1 or Fraction(repr(value)) == exact
            return exact, str(value) if whole else f"the binary number {exact.numerator}/{exact.denominator}"
        exact = Fraction(value)  # type: ignore[call-overload]
        return exact, str(exact)
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        raise InputError(f"{name} = {value!r}: must be a finite number, a fraction, or a decimal as text") from None


def outward(low: Fraction, high: Fraction, digits: int) -> tuple[str, str]:
    """Decimals of so many significant digits, rounded down and up."""
    places = digits - 1 - math.floor(math.log10(high)) if high > 0 else digits
    unit = Fraction(10) ** places
    return _decimal(math.floor(low * unit), places), _decimal(math.ceil(high * unit), places)


def _decimal(scaled: int, places: int) -> str:
    if places <= 0:
        return str(scaled * 10**-places)
    text = str(scaled).rjust(places + 1, "0")
    return f"{text[:-places]}.{text[-places:]}"


def _root(value: Fraction, up: bool, bits: int) -> Fraction:
    """Square root of a fraction, rounded down or up to so many bits after the point."""
    scaled = value.numerator * 4**bits // value.denominator
    return Fraction(math.isqrt(scaled) + (1 if up else 0), 2**bits)


def certified_load(
    column: Column,
    modes: int = 8,
    alpha: object = 0,
    beta: object = 0,
    *,
    digits: int = 15,
    kappa: object = None,
    load_max: object = 1000,
    progress: Callable[[str], None] | None = None,
    **parameters: object,
) -> Certified:
    """The critical load of the Ritz series in an interval that is proven to hold it, with the proof. Eqs. (24), (25).

    alpha, beta, kappa, load_max, parameters: numbers, fractions, or decimals as text; they are taken exactly. digits:
    1 to 10,000; the relative width of the interval is below 10^-digits. kappa: the limit of vanishing damping at
    beta = kappa alpha. Proven are: the crossing, that the column is stable on the whole interval below, and its kind.

    Raises InputError for bad values, and where something could not be proven: the message says what.
    """
    from freebeam_derive.certify import certificate, ritz
    from freebeam_derive.certify.balls import Unproven

    digits = count("digits", digits, 1, MOST_DIGITS, "certified decimal digits")
    given = {"alpha": alpha, "beta": beta, "load_max": load_max, **parameters}
    if kappa is not None:
        given["kappa"] = kappa
    taken = {name: rational(name, value) for name, value in given.items()}
    exact = {name: value for name, (value, _) in taken.items()}
    own = {name: exact[name] for name in parameters}
    found = critical_load(
        column,
        modes,
        float(exact["alpha"]),
        float(exact["beta"]),
        load_max=float(exact["load_max"]),
        kappa=None if kappa is None else float(exact["kappa"]),
        **{name: float(value) for name, value in own.items()},
    )
    near = None if found.load is None or found.frequency is None else (found.load, found.frequency)
    question = ritz.Question(modes, exact["alpha"], exact["beta"], exact.get("kappa"), own)
    try:
        enclosure = ritz.certify(column.kernel, question, near, digits, exact["load_max"], progress)
    except Unproven as error:
        raise InputError(f"not proven for {column.name}, N = {modes}: {error}") from error
    load = frequency = None
    if enclosure.load is not None:
        load = outward(*enclosure.load, digits + 3)
        frequency = ("0", "0")
        if enclosure.square is not None:
            bits = 4 * digits + 40
            low, high = enclosure.square
            frequency = outward(_root(low, False, bits), _root(high, True, bits), digits + 1)
    return Certified(
        load,
        frequency,
        enclosure.kind,
        dict(enclosure.proof),
        digits,
        {name: text for name, (_, text) in taken.items()},
        certificate.write(column.kernel, enclosure),
    )


def exact_load(
    column: Column,
    alpha: object = 0,
    beta: object = 0,
    *,
    digits: int = 15,
    kappa: object = None,
    modes: int = 24,
    load_max: object = 1000,
    **parameters: object,
) -> Certified:
    """A critical load of the beam itself, without a Ritz series, in an interval that is proven to hold it. Eq. (6).

    The candidate is the Ritz value at `modes` functions; otherwise as `certified_load`. Proven are the crossing, alone
    in its interval, and its kind; that it is the first one, over all modes, is not (proof says so).

    Raises InputError for bad values, where no crossing is up to load_max, and where something could not be proven.
    """
    from freebeam_derive.certify import exact as beams
    from freebeam_derive.certify.balls import Unproven
    from freebeam_derive.certify.beam import Beam, NoSeries

    digits = count("digits", digits, 1, MOST_DIGITS, "certified decimal digits")
    given = {"alpha": alpha, "beta": beta, "load_max": load_max, **parameters}
    taken = {name: rational(name, value) for name, value in given.items()}
    if kappa is not None:
        taken["kappa"] = rational("kappa", kappa)
    exact = {name: value for name, (value, _) in taken.items()}
    own = {name: exact[name] for name in parameters}
    found = critical_load(
        column,
        modes,
        float(exact["alpha"]),
        float(exact["beta"]),
        load_max=float(exact["load_max"]),
        kappa=None if kappa is None else float(exact["kappa"]),
        **{name: float(value) for name, value in own.items()},
    )
    if found.load is None or found.frequency is None:
        raise InputError(f"load_max = {load_max}: no loss of stability is found up to there at N = {modes}")
    near = found.load, found.frequency
    try:
        beam = Beam(column.kernel, own)
        if found.kind == "divergence":
            crossing = beams.divergence(beam, found.load, digits + 2)
        elif kappa is not None:
            crossing = beams.flutter_limit(beam, exact["kappa"], near, digits + 2)
        elif exact["alpha"] == exact["beta"] == 0:
            crossing = beams.flutter_undamped(beam, near, digits + 2)
        else:
            crossing = beams.flutter_damped(beam, exact["alpha"], exact["beta"], near, digits + 2)
    except (Unproven, NoSeries) as error:
        raise InputError(f"not proven for {column.name}, the beam itself: {error}") from error
    load = outward(*_ends(crossing.load), digits + 2)
    frequency = ("0", "0") if crossing.kind == "divergence" else outward(*_ends(crossing.frequency), digits + 2)
    inputs = {name: text for name, (_, text) in taken.items()}
    return Certified(load, frequency, crossing.kind, vars(crossing.proof), digits, inputs)


def _ends(ball: Any) -> tuple[Fraction, Fraction]:
    """Lower and upper end of a ball, as fractions."""
    middle, radius = (Fraction(*map(int, (v.fmpq().p, v.fmpq().q))) for v in (ball.mid(), ball.rad()))
    return middle - radius, middle + radius


def verify_certificate(path: str) -> str:
    """Check a certificate file with the verifier, which shares no code with the prover; what it proves, in a sentence.

    Raises InputError with the reason where the file does not prove what it claims.
    """
    from freebeam_derive.certify.verifier import Refused, verify_file

    try:
        return verify_file(path)
    except Refused as error:
        raise InputError(str(error)) from error
