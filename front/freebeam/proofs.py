"""Certified critical loads: intervals that are proven to hold them. The way from the runtime to the provers.

The runtime's critical load is the candidate; the proof is ball arithmetic from there, see
`freebeam_derive.certify`. Inputs are exact: fractions as they are, text the decimal that it says, floats the shortest
decimals that stand for them (0.01 is 1/100), defaults of a column's parameters too. `inputs` says what was taken.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from freebeam.certificates import Proven, attempted
from freebeam.maps.known import answer
from freebeam_sym.checks import InputError, count, nonnegative, positive, refusal
from freebeam_sym.columns import is_column
from freebeam_sym.question import Question
from freebeam_sym.stability.convergence import CONVERGED, BeamLoss
from freebeam_sym.stability.critical import CriticalLoad

if TYPE_CHECKING:
    from freebeam_derive.certify.all_crossings import Crossing
    from freebeam_derive.certify.beam_crossings import Survey
    from freebeam_derive.certify.beam_stability import Evidence
    from freebeam_sym.columns import Column

__all__ = [
    "Certified", "CertifiedCrossing", "CertifiedCrossings", "CertifiedPulse", "ExactSpectrum", "Truncation",
    "certified_crossings", "certified_load", "certified_pulse", "exact_crossings", "exact_load", "exact_spectrum",
    "rational", "truncation_error",
]  # fmt: skip

MOST = 1_000_000
"""Size of a load, and of an eigenvalue, up to which the beam's own take seconds: the work grows as its root."""
MOST_DIGITS = 10_000
LOAD_MAX = Fraction(1000)  # nondimensional, where none is given


@dataclass(frozen=True)
class Certified(Proven):
    """A critical load with its proof, nondimensional, or in N and rad/s where a beam in SI units was given.

    load and frequency: (lower, upper) as decimal text, rounded outwards; None where kind is "none". proof: what was
    proven (crossing, first, stable_below, kind). question: what was asked, in floats, and inputs: what each input was
    taken for. certificate: the data that prove it, for a file, which the verifier accepts; None in SI units and where
    missing says why; unverified: the same as the prover wrote them. missing: the step that failed, in words, where
    something of proof is false, or why there is no certificate. evidence: of the
    beam itself, what `first` stands on (docs/theorem.md): lowest, the number m of eigenvalues that were looked at one
    by one; reach, the nondimensional load up to which all others are each alone in a strip; stretches of changes of
    sign; cells of load and frequency. above_zero: stability below is proven of loads above 0 alone, for at 0 a motion
    rests that the load alone restores, or nothing is damped. touches: of the beam itself, loads below at each of which
    an eigenvalue is zero, and on the same side of it below and above: stability below is said of all others. at_once:
    of a series, kind and frequency (lower, upper) of each further loss at exactly the same load, of motions that these
    leave alone, such as those in the other of two planes. lasting: names of motions that nothing damps beside others
    that are damped, and that these leave alone: stable is there that none grows, and elsewhere that all die out.
    """

    load: tuple[str, str] | None
    frequency: tuple[str, str] | None
    kind: str
    proof: Mapping[str, bool]
    digits: int
    question: Question
    inputs: Mapping[str, str]
    unverified: Mapping[str, Any] | None = field(repr=False, default=None)
    missing: str = ""
    evidence: Mapping[str, float] | None = field(repr=False, default=None)
    above_zero: bool = False
    touches: tuple[CertifiedCrossing, ...] = ()
    at_once: tuple[tuple[str, tuple[str, str]], ...] = ()
    lasting: tuple[str, ...] = ()


@dataclass(frozen=True)
class CertifiedCrossing:
    """A load at which an eigenvalue or a pair of them passes the imaginary axis; units as of `Certified`.

    load and frequency: (lower, upper) as decimal text, rounded outwards. unstable_below, unstable_above: how many
    eigenvalues have a positive real part next to it. stability: "lost", "regained", or "unchanged" where the column
    is unstable on either side. kind: "flutter", "divergence", or, of the beam itself, "touch" with the stability
    "touched": an eigenvalue is zero at that load alone, and on the same side of it below and above.
    """

    kind: str
    load: tuple[str, str]
    frequency: tuple[str, str]
    unstable_below: int
    unstable_above: int
    stability: str


class CertifiedCrossings(Proven, tuple[CertifiedCrossing, ...]):
    """All of them, ascending. certificate: the data that prove it, for a file, which the verifier accepts, up to a
    millionth beyond load_max where a crossing cannot be told from it; None in SI units, and where missing says why.
    unverified: the same as the prover wrote them."""

    unverified: Mapping[str, Any] | None = None
    missing: str = ""


@dataclass(frozen=True)
class ExactSpectrum(Proven):
    """Eigenvalues λ of the beam itself at a load, sorted by |Im|, then Re; nondimensional.

    lower, upper: (real part, imaginary part) of each as decimal text, rounded outwards: λ is in that box, and no
    other eigenvalue is. unproven: Ritz values (complex) from which none could be enclosed. complete_to: every
    eigenvalue with |λ| up to it is among these, proven, as decimal text; None where that is not proven, and missing
    says why. inputs: what each input was taken for. certificate: the data that prove that those up to there are all,
    for a file, which the verifier accepts; None where complete_to is, and where missing says why. unverified: the same
    as the prover wrote them.
    """

    lower: tuple[tuple[str, str], ...]
    upper: tuple[tuple[str, str], ...]
    unproven: tuple[complex, ...]
    digits: int
    inputs: Mapping[str, str]
    complete_to: str | None = None
    missing: str = ""
    unverified: Mapping[str, Any] | None = field(repr=False, default=None)


@dataclass(frozen=True)
class Truncation:
    """What a Ritz series is off by: its critical load less the beam's own, (lower, upper) as text; units of its proofs.

    relative: the difference in parts of the beam's load, as a float. series, beam: the two enclosures that it is from.
    """

    difference: tuple[str, str]
    relative: float
    series: Certified
    beam: Certified


@dataclass(frozen=True)
class CertifiedPulse:
    """What is proven of the motion of a Ritz series under the load P (1 + ε cos Ωt): "stable", it dies out, or
    "unstable", it grows; nondimensional.

    growth: (lower, upper) of ln |multiplier| in a period of the largest multiplier, as decimal text rounded outwards;
    the lower one None where none is proven. question: what was asked, in floats, and inputs: what each input was taken
    for.
    """

    kind: str
    growth: tuple[str | None, str]
    question: Question
    inputs: Mapping[str, str]


def rational(name: str, value: object) -> tuple[Fraction, str]:
    """A number as an exact fraction, and what it was taken for. Raises InputError where it is none."""
    from freebeam_derive.certify.decimals import read, said

    try:
        if isinstance(value, bool):
            raise ValueError
        if isinstance(value, str | float) or hasattr(value, "dtype"):
            # floats, of Python or NumPy, print as the shortest decimal that is read as them again
            text = str(value).strip()
            exact, taken = read(text), text
        else:
            exact = Fraction(value)  # type: ignore[call-overload]
            taken = said(exact)
        float(exact)  # the candidate of a proof is one
    except (TypeError, ValueError, ZeroDivisionError):
        raise refusal(name, value, "must be a finite number, a fraction, or a decimal as text") from None
    except OverflowError:
        raise refusal(name, value, "is beyond the range of a float") from None
    return exact, taken


def _ratio(kappa: object) -> tuple[Fraction | float, str]:
    """kappa as `rational` takes it; infinite where external damping alone vanishes."""
    return (math.inf, "inf") if kappa in (math.inf, "inf") else rational("kappa", kappa)


@dataclass(frozen=True)
class _Asked:
    """What is asked of a proof: the question in floats, its exact nondimensional values, and what they were taken for.

    squares: of the SI sizes of one nondimensional unit of each quantity; empty where all is nondimensional.
    """

    question: Question
    exact: Mapping[str, Any]
    own: Mapping[str, Fraction]
    inputs: Mapping[str, str]
    squares: Mapping[str, Fraction]

    @staticmethod
    def of(
        column: Column,
        modes: int | None,
        parameters: Mapping[str, object],
        kappa: object = None,
        beam: tuple[object, object, object] | None = None,
        **given: object,
    ) -> _Asked:
        """The inputs as exact numbers. Raises InputError for bad ones."""
        is_column(column)
        if not hasattr(column.kernel, "complete"):  # from numbers of any kind
            raise InputError(
                f"{column.name}: is assembled from tables in floats, of which nothing can be proven; state the column "
                "in a file, such as with Piecewise"
            )
        left_out = {name for name in ("kappa", "load_max") if (given | {"kappa": kappa}).get(name) is None}
        given = {name: value for name, value in (given | {"kappa": kappa}).items() if name not in left_out}
        taken = {name: _ratio(value) if name == "kappa" else rational(name, value) for name, value in given.items()}
        column.own_parameters(dict.fromkeys(parameters, 0))  # refuses what is not known
        exact = {name: value for name, (value, _) in taken.items()}
        inputs, own = {name: text for name, (_, text) in taken.items()}, {}
        for p in column.parameters:
            own[p.name], text = rational(p.name, parameters.get(p.name, p.default))
            inputs[p.name] = text if p.name in parameters else f"{text} (default)"
        squares: dict[str, Fraction] = {}
        if beam is not None:
            squares = _squares(column, beam, own, inputs)
            exact = _nondimensional(exact, squares)
        exact.setdefault("load_max", LOAD_MAX)
        floats: dict[str, Any] = {name: float(value) for name, value in (exact | own).items() if name != "load"}
        return _Asked(Question.of(column, modes, **floats), exact, own, inputs, squares)

    @property
    def column(self) -> Column:
        return self.question.column

    @property
    def certified(self) -> Any:
        """The question as the provers take it."""
        from freebeam_derive.certify import boundary_polynomials

        exact = self.exact
        return boundary_polynomials.Question(
            self.question.modes, exact["alpha"], exact["beta"], exact.get("kappa"), dict(self.own)
        )

    @property
    def itself(self) -> Any:
        """The beam itself at what is asked. Raises NoSeries."""
        return self._read(self.column.kernel)

    @property
    def by_gaps(self) -> Any:
        """The same for the proof that a crossing is the first: by gaps between frequencies where the comparison beam's
        modes do not serve it. Raises NoSeries."""
        from freebeam_derive.certify.textbook import of_any

        return self._read(of_any(self.column.kernel, self.own))

    def _read(self, kernel: Any) -> Any:
        from freebeam_derive.certify.beam import Beam
        from freebeam_derive.certify.damped_gaps import of_mass_alone
        from freebeam_derive.certify.exact_system import ExactSystem

        if kernel.COLUMN.get("general"):
            if self.exact.get("kappa") == math.inf and of_mass_alone(kernel, self.own):
                return ExactSystem(kernel, self.own)
            alpha, beta = self.certified.dampings
            return ExactSystem(kernel, self.own, alpha, beta, "kappa" in self.exact)
        beam = Beam(kernel, self.own)
        beam.damping(self.exact["alpha"], self.exact["beta"])
        return beam

    def dampings_of(self, beam: Any) -> tuple[Any, Any, Any]:
        """alpha, beta and kappa (or None) for a proof of the beam itself. Raises NoSeries.

        None of them where external damping alone vanishes: C = c_M M damps all motions alike, and the limit is the
        column without damping (docs/theorem.md, Theorem 3).
        """
        from freebeam_derive.certify.beam import Beam, NoSeries

        alpha, beta, kappa = (self.exact.get(name) for name in ("alpha", "beta", "kappa"))
        if not isinstance(beam, Beam):
            return alpha, beta, kappa if beam.vanishing else None
        if kappa != math.inf:
            return alpha, beta, kappa
        c_E, c_M = beam.damping(Fraction(0), Fraction(1))
        if not (c_E.is_zero() and c_M > 0):
            raise NoSeries(f"kappa = inf: what vanishes in {beam.name} is not the mass times a positive number")
        return alpha, beta, None

    def load(self, interval: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
        """An interval of loads in the units asked in: N where a beam was given."""
        return self._scaled(interval, "load")

    def frequency(self, interval: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
        """An interval of frequencies in the units asked in: rad/s where a beam was given."""
        return self._scaled(interval, "frequency")

    def _scaled(self, interval: tuple[Fraction, Fraction], quantity: str) -> tuple[Fraction, Fraction]:
        from freebeam_derive.certify.balls import root
        from freebeam_derive.certify.decimals import roots

        if not self.squares:
            return interval
        size, (low, high) = root(self.squares[quantity]), interval
        if isinstance(size, Fraction):
            return low * size, high * size
        return roots(low**2 * size.square, high**2 * size.square)


def _squares(
    column: Column, beam: tuple[object, object, object], own: Mapping[str, Fraction], inputs: dict[str, str]
) -> dict[str, Fraction]:
    """Squares of the SI sizes for a beam; what its three quantities were taken for is added to the inputs."""
    from freebeam_derive.scaling import squares

    values = []
    for name, value in zip(("bending_stiffness", "mass_per_length", "length"), beam, strict=True):
        exact, inputs[name] = rational(name, value)
        positive(name, float(exact))
        values.append(exact)
    column.scales(*map(float, values), **{name: float(value) for name, value in own.items()})  # refuses what has none
    try:
        return squares(column.kernel.COLUMN, values, own)
    except ValueError as error:
        raise InputError(f"{error}: nothing is proven in SI units; ask in nondimensional quantities") from None


def _nondimensional(given: Mapping[str, Any], squares: Mapping[str, Fraction]) -> dict[str, Any]:
    """SI values as nondimensional ones: roots of rational numbers where the unit of time is one."""
    from freebeam_derive.certify.balls import root

    of = {**squares, "load_max": squares["load"], "kappa": squares["beta"] / squares["alpha"]}
    found: dict[str, Any] = {}
    for name, value in given.items():
        if value == math.inf:
            found[name] = value
            continue
        if value < 0:  # which is refused, by the value as it was given
            nonnegative(name, float(value))
        found[name] = root(value**2 / of[name])
    return found


def _itself(asked: _Asked, modes: int) -> CriticalLoad | BeamLoss:
    """Where to start for the beam itself: from polynomials that agree, else from so many functions of the basis."""
    found = answer(asked.question.over(asked.column, modes))
    return found.beam or found


def _near(found: CriticalLoad | BeamLoss) -> tuple[float, float] | None:
    return None if found.load is None or found.frequency is None else (found.load, found.frequency)


def certified_load(
    column: Column,
    modes: int | None = None,
    alpha: object = 0,
    beta: object = 0,
    *,
    digits: int = 15,
    kappa: object = None,
    load_max: object = None,
    beam: tuple[object, object, object] | None = None,
    progress: Callable[[str], None] | None = None,
    **parameters: object,
) -> Certified:
    """The critical load of the Ritz series in an interval that is proven to hold it, with the proof. Eqs. (24), (25).

    alpha, beta, kappa, load_max, parameters: numbers, fractions, or decimals as text; they are taken exactly, floats as
    their shortest decimals. digits: 1 to 10,000; the relative width of the interval is below 10^-digits. kappa: the
    limit of vanishing damping at beta = kappa alpha, math.inf for beta alone. beam: bending stiffness (N m²), mass per
    length (kg/m) and length (m), all else is in SI units then, alpha (s), beta (kg/(m s)), kappa (kg/(m s²)), load_max
    (N) and the result, and there is no certificate. load_max: 1000 nondimensional where left out. Proven are: the
    crossing, that the column is stable on all of the interval below, and its kind.

    Raises InputError for bad values, and where something could not be proven: the message says what.
    """
    from freebeam_derive.certify import certificate
    from freebeam_derive.certify.decimals import outward

    digits = count("digits", digits, 1, MOST_DIGITS, "certified decimal digits")
    asked = _Asked.of(column, modes, parameters, kappa, beam, alpha=alpha, beta=beta, load_max=load_max)
    enclosure = _first(asked, digits, progress)
    load = frequency = None
    if enclosure.load is not None:
        load = outward(*asked.load(enclosure.load), digits + 3)
        frequency = _frequency(asked, enclosure.frequency, digits)
    data, missing = (None, "") if beam is not None else attempted(lambda: certificate.write(column.kernel, enclosure))
    return Certified(
        load,
        frequency,
        enclosure.kind,
        dict(enclosure.proof),
        digits,
        asked.question,
        asked.inputs,
        data,
        missing=missing,
        above_zero=enclosure.above_zero,
        at_once=tuple((kind, _frequency(asked, omega, digits)) for kind, omega in enclosure.at_once),
        lasting=tuple("-".join(names) for names in enclosure.lasting),
    )


def _first(asked: _Asked, digits: int, progress: Callable[[str], None] | None) -> Any:
    """The first loss of stability of the series, proven. Raises InputError."""
    from freebeam_derive.certify import all_crossings, first_crossing
    from freebeam_derive.certify.balls import Unproven

    kernel, question, load_max = asked.column.kernel, asked.certified, asked.exact["load_max"]
    near = _near(answer(asked.question))
    try:
        try:
            return first_crossing.certify(kernel, question, near, digits, load_max, progress)
        except Unproven as error:
            # floats may take another for the first, where two that all but touch look like none; all are sought
            top = load_max if near is None else min(load_max, Fraction(near[0]) * Fraction(1001, 1000))
            found = all_crossings.survey(kernel, question, top, max(digits, 30), progress)
            lost = [c for c in found if c.unstable == 0]
            if not lost:
                raise error
            square = lost[0].square
            first = lost[0].load[0], 0.0 if square is None else math.sqrt(square[0])
            return first_crossing.certify(kernel, question, first, digits, load_max, progress)
    except Unproven as error:
        raise InputError(f"not proven for {asked.column.name}, N = {asked.question.modes}: {error}") from error


def _frequency(asked: _Asked, omega: tuple[Fraction, Fraction] | None, digits: int) -> tuple[str, str]:
    """An interval of ω as text; zero where there is none."""
    from freebeam_derive.certify.decimals import outward

    return ("0", "0") if omega is None else outward(*asked.frequency(omega), digits + 1)


def certified_crossings(
    column: Column,
    modes: int | None = None,
    alpha: object = 0,
    beta: object = 0,
    *,
    load_max: object = None,
    digits: int = 15,
    kappa: object = None,
    beam: tuple[object, object, object] | None = None,
    progress: Callable[[str], None] | None = None,
    **parameters: object,
) -> CertifiedCrossings:
    """Every load up to load_max at which the Ritz series' stability changes, with the proof that none is left out.

    load_max is one of these loads, and a crossing that balls cannot tell from it is listed too. Ascending. Inputs as in
    `certified_load`; relative widths are below 10^-digits. A restabilisation is one of them, and so is a further
    eigenvalue that turns unstable where others are already. `certificate` of the tuple holds the data of the proof.
    Eqs. (24), (25).

    >>> import freebeam as fb
    >>> [c.kind for c in fb.certified_crossings(fb.column("beck"), 4, eta="0.4", load_max=60)]
    ['divergence', 'divergence', 'flutter']

    Raises InputError for bad values, and where crossings cannot be told apart or one cannot be proven: the message
    says up to which load what is known.
    """
    from freebeam_derive.certify import all_crossings
    from freebeam_derive.certify.balls import Unproven
    from freebeam_derive.certify.certificate import write_crossings

    digits = count("digits", digits, 1, MOST_DIGITS, "certified decimal digits")
    asked = _Asked.of(column, modes, parameters, kappa, beam, alpha=alpha, beta=beta, load_max=load_max)
    try:
        found = all_crossings.survey(column.kernel, asked.certified, asked.exact["load_max"], digits, progress)
    except Unproven as error:
        raise InputError(f"not proven for {column.name}, N = {asked.question.modes}: {error}") from error
    told = CertifiedCrossings(_told(asked, c, digits) for c in found)
    if not asked.squares:
        told.unverified, told.missing = attempted(lambda: write_crossings(column.kernel, asked.certified, found))
    return told


def _told(asked: _Asked, c: Crossing, digits: int) -> CertifiedCrossing:
    """A crossing in the units asked in."""
    from freebeam_derive.certify.decimals import outward, roots

    return CertifiedCrossing(
        c.kind,
        outward(*asked.load(c.load), digits + 3),
        _frequency(asked, None if c.square is None else roots(*c.square), digits),
        c.unstable,
        c.unstable + c.change,
        c.stability,
    )


def exact_crossings(
    column: Column,
    alpha: object = 0,
    beta: object = 0,
    *,
    load_max: object,
    digits: int = 15,
    kappa: object = None,
    beam: tuple[object, object, object] | None = None,
    progress: Callable[[str], None] | None = None,
    **parameters: object,
) -> CertifiedCrossings:
    """Every load up to load_max at which the number of growing eigenvalues of the beam itself changes, ascending, with
    the proof over all of its modes that none is left out. Eqs. (6), (14), (15).

    Of uniform beams, without damping, with it and in its limit; inputs as in `exact_load`, the result as of
    `certified_crossings`. The work grows fast with load_max: seconds up to the first crossing or two. An empty tuple
    is the proof that the column is stable up to there. `certificate` of the tuple holds the data of the proof, up to
    a millionth beyond load_max where a crossing cannot be told from it. docs/theorem.md is the theorem.

    >>> import freebeam as fb
    >>> [c.kind for c in fb.exact_crossings(fb.column("beck"), eta="0.4", load_max=20)]
    ['divergence', 'divergence', 'flutter']

    Raises InputError for bad values, and where a step of the proof failed, with its name.
    """
    from freebeam_derive.certify.balls import Unproven
    from freebeam_derive.certify.beam import Beam, NoSeries
    from freebeam_derive.certify.beam_crossings import Survey
    from freebeam_derive.certify.certificate import write_list

    digits = count("digits", digits, 1, MOST_DIGITS, "certified decimal digits")
    asked = _Asked.of(column, None, parameters, kappa, beam, alpha=alpha, beta=beta, load_max=load_max)
    try:
        itself = asked.itself
        if not isinstance(itself, Beam):
            raise NoSeries(f"{column.name} goes beyond the uniform beam, whose modes the proof needs")
        survey = Survey(itself, *asked.dampings_of(itself), asked.exact["load_max"], digits)
        survey.say = progress or survey.say
        found = survey.run()
    except NoSeries as error:
        raise InputError(f"all crossings of the exact beam are not to be had: {error}") from error
    except Unproven as error:
        raise InputError(f"not proven for {column.name}, the beam itself: {error}") from error
    told = CertifiedCrossings(_told(asked, c, digits) for c in found)
    if not asked.squares:
        stated = column.kernel, asked.certified, survey, survey.crossings
        told.unverified, told.missing = attempted(lambda: write_list(*stated))
    return told


def exact_load(
    column: Column,
    alpha: object = 0,
    beta: object = 0,
    *,
    digits: int = 15,
    kappa: object = None,
    modes: int = 24,
    load_max: object = None,
    beam: tuple[object, object, object] | None = None,
    **parameters: object,
) -> Certified:
    """A critical load of the beam itself, without a Ritz series, in an interval that is proven to hold it. Eq. (6).

    The candidate is that of series of polynomials which agree, else the Ritz value at `modes` functions; otherwise as
    `certified_load`. Proven are the crossing, alone in its interval, and its kind; and, over all of the infinitely many
    modes, that it is the first and that the column is stable below: for a uniform beam, and for one of variable section
    or in uniform parts, with masses and springs; of coordinates alone a series is the system itself. Where these two
    are not proven, `proof` says so and `missing` names the step that failed. docs/theorem.md is the theorem.

    >>> import freebeam as fb
    >>> all(fb.exact_load(fb.column("free-free"), digits=30).proof.values())
    True

    Raises InputError for bad values, where no crossing is up to load_max, and where something could not be proven.
    """
    is_column(column)
    given: dict[str, Any] = {"kappa": kappa, "load_max": load_max, "beam": beam, **parameters}
    if column.kernel.COLUMN.get("general") and not column.kernel.FIELDS:  # coordinates alone have no other modes
        with suppress(InputError):
            found = certified_load(column, modes, alpha, beta, digits=digits, **given)
            if found.load is not None:
                return found
    return enclosed_load(column, alpha, beta, digits=digits, modes=modes, whole=True, **given)


def enclosed_load(
    column: Column,
    alpha: object = 0,
    beta: object = 0,
    *,
    digits: int = 15,
    kappa: object = None,
    modes: int = 24,
    load_max: object = None,
    beam: tuple[object, object, object] | None = None,
    whole: bool = False,
    **parameters: object,
) -> Certified:
    """The same without the proof that it is the first (whole: with it), for those who ask for many."""
    digits = count("digits", digits, 1, MOST_DIGITS, "certified decimal digits")
    asked = _Asked.of(column, modes, parameters, kappa, beam, alpha=alpha, beta=beta, load_max=load_max)
    found = _itself(asked, modes)
    near = _near(found)
    if near is None:
        raise InputError(
            f"load_max = {float(asked.exact['load_max']):.10g}: no series loses stability up to there, which leaves "
            "nothing to start from; nothing is proven of the beam itself; give a larger load_max"
        )
    return _enclosed(asked, near, found.kind, digits, whole)


def _enclosed(asked: _Asked, near: tuple[float, float], kind: str, digits: int, whole: bool = False) -> Certified:
    """The crossing of the beam itself near a candidate; whole: and whether it is the first. Raises InputError where
    there is no proof."""
    from freebeam_derive.certify import beam_crossings, beam_stability, pair_at_rest
    from freebeam_derive.certify import beam_itself as beams
    from freebeam_derive.certify.balls import Unproven, ends
    from freebeam_derive.certify.beam import NoSeries
    from freebeam_derive.certify.certificate import write_list, write_of_beam
    from freebeam_derive.certify.decimals import outward
    from freebeam_derive.certify.exact_system import ExactSystem

    name = asked.column.name
    try:
        beam = asked.by_gaps if whole else asked.itself
        alpha, beta, kappa = asked.dampings_of(beam)
        if kind == "divergence" or beam_stability.keeps_energy(beam):
            crossing = beams.divergence(beam, near[0], digits + 2)
        elif kappa is not None:
            crossing = beams.flutter_limit(beam, kappa, near, digits + 2)
        elif beam.undamped(alpha, beta):
            crossing = beams.flutter_undamped(beam, near, digits + 2)
        elif near[1] == 0 and isinstance(beam, ExactSystem):
            crossing = pair_at_rest.flutter(beam, near[0], digits + 2)
        else:
            crossing = beams.flutter_damped(beam, alpha, beta, near, digits + 2)
        evidence: Evidence | None = None
        missing, certificate = "", None
        survey: Survey | None = None
        if whole:
            crossing, evidence, missing, survey = beam_crossings.complete(beam, crossing, alpha, beta, kappa)
    except NoSeries as error:
        raise InputError(f"the exact beam is not to be had, only its Ritz series: {error}") from error
    except Unproven as error:
        raise InputError(f"not proven for {name}, the beam itself: {error}") from error
    if evidence is not None and not asked.squares:
        stated = beam.kernel, asked.certified
        if survey is not None:
            of_list = *stated, survey, survey.crossings
            certificate, missing = attempted(lambda: write_list(*of_list))
        else:
            of_first = *stated, crossing, evidence
            certificate, missing = attempted(lambda: write_of_beam(*of_first))
    load, frequency = outward(*asked.load(ends(crossing.load)), digits + 2), ("0", "0")
    if crossing.kind == "flutter":
        frequency = outward(*asked.frequency(ends(crossing.frequency)), digits + 2)
    return Certified(
        load,
        frequency,
        crossing.kind,
        vars(crossing.proof),
        digits,
        asked.question,
        asked.inputs,
        certificate,
        missing=missing,
        evidence=None if evidence is None else evidence.numbers,
        touches=() if survey is None else tuple(_told(asked, c, digits) for c in survey.crossings[:-1]),
    )


def truncation_error(
    column: Column,
    modes: int | None = None,
    alpha: object = 0,
    beta: object = 0,
    *,
    digits: int = 15,
    kappa: object = None,
    load_max: object = None,
    beam: tuple[object, object, object] | None = None,
    series: Certified | None = None,
    **parameters: object,
) -> Truncation:
    """By how much the critical load of a Ritz series differs from the beam's own, enclosed. Inputs as `certified_load`.

    series: the certified load of the series where it is known already. Digits are added where the difference is so
    small that it takes more to see it.

    Raises InputError as `certified_load` does, and where no crossing of the beam itself is proven that the series'
    could be a value for: the truncation may have invented it.
    """
    from freebeam_derive.certify.decimals import outward, read

    digits = count("digits", digits, 1, MOST_DIGITS, "certified decimal digits")
    asked = _Asked.of(column, modes, parameters, kappa, beam, alpha=alpha, beta=beta, load_max=load_max)
    N = asked.question.modes
    more = _itself(asked, max(24, N + 8) if column.basis_name == "modes" else max(18, N))
    given: dict[str, Any] = {"kappa": kappa, "load_max": load_max, "beam": beam, **parameters}
    near = _near(more)
    if series is None:
        series = certified_load(column, modes, alpha, beta, digits=digits, **given)
    if series.load is None or near is None or more.kind != series.kind:
        raise InputError(
            f"the truncation error of {column.name} at N = {N} is not known: "
            + (
                "the series does not lose stability"
                if series.load is None
                else "its crossing is gone at more functions"
            )
            + f" up to the load {float(asked.exact['load_max']):.10g}"
        )
    while True:
        itself = _enclosed(asked, near, more.kind, digits)
        assert itself.load is not None and series.load is not None
        led_to = float(asked.load((Fraction(near[0]), Fraction(near[0])))[0])
        if abs(float(itself.load[0]) / led_to - 1) > 10 * CONVERGED:
            raise InputError(
                f"the truncation error of {column.name} at N = {N} is not known: the beam's own crossing at "
                f"{float(itself.load[0]):.10g} is not the one that more functions lead to, {led_to:.10g}"
            )
        ours, theirs = ([read(v) for v in pair] for pair in (series.load, itself.load))
        low, high = ours[0] - theirs[1], ours[1] - theirs[0]
        if (high - low) * 100 < max(abs(low), abs(high)) or digits >= 60:
            return Truncation(outward(low, high, 6), float((low + high) / 2 / theirs[0]), series, itself)
        digits = min(2 * digits, MOST_DIGITS)
        series = certified_load(column, modes, alpha, beta, digits=digits, **given)


def exact_spectrum(
    column: Column,
    load: object,
    alpha: object = 0,
    beta: object = 0,
    *,
    modes: int | None = None,
    digits: int = 15,
    **parameters: object,
) -> ExactSpectrum:
    """The beam's own eigenvalues λ at a load, near the lowest of a Ritz series, each enclosed. Eqs. (6), (15).

    modes: of how many functions' worth, 2 eigenvalues each; the starts are those of a series of many more. Numbers are
    taken exactly, as in `certified_load`. Relative widths, to |λ|, are below 10^-digits. Of uniform beams it is proven
    up to which |λ| the list is complete, with internal damping below 1/α, where it can be shown in some seconds.

    Raises InputError for bad values and for a column whose equation the power series does not serve.
    """
    from freebeam_derive.certify import beam_itself as beams
    from freebeam_derive.certify import beam_stability
    from freebeam_derive.certify.balls import Unproven, ends
    from freebeam_derive.certify.beam import NoSeries
    from freebeam_derive.certify.certificate import MOST_COUNTED, write_spectrum
    from freebeam_derive.certify.decimals import outward, read

    digits = count("digits", digits, 1, MOST_DIGITS, "certified decimal digits")
    asked = _Asked.of(column, modes, parameters, alpha=alpha, beta=beta, load=load)
    values = asked.exact["load"], asked.exact["alpha"], asked.exact["beta"]
    if abs(values[0]) > MOST:
        raise refusal("load", load, f"eigenvalues of the beam itself are enclosed at loads up to {MOST}")
    try:
        beam = asked.itself
    except NoSeries as error:
        raise InputError(f"the exact beam is not to be had, only its Ritz series: {error}") from error
    narrow = max(digits, 15) + 2  # two that are near one another are told apart, however few digits are asked for
    balls: list[Any] = []
    found: list[tuple[complex, tuple[str, str], tuple[str, str]]] = []
    unproven: list[complex] = []
    for start in _lowest(asked):
        if start.imag < 0:
            continue  # found with its conjugate
        pair = [start] if start.imag == 0 else [start, start.conjugate()]
        try:
            if abs(start) > MOST:
                raise Unproven("takes too long")
            (ball,) = beams.frequencies(beam, *values, [start], narrow)
            if any(ball.overlaps(other) for other in balls):
                raise Unproven("two starts lead to one eigenvalue")
        except Unproven:
            unproven += pair
            continue
        balls.append(ball)
        re, im = ends(ball.real), ends(ball.imag)
        for part in (im, (-im[1], -im[0])) if len(pair) == 2 else (im,):
            low, high = zip(_decimals(re, digits), _decimals(part, digits), strict=True)
            found.append((start, low, high))
    found.sort(key=lambda item: (round(abs(item[0].imag), 9), item[0].real))
    pairs = [value for ball in balls for value in ([ball, ball.conjugate()] if ball.imag > 0 else [ball])]
    top, missing = beam_stability.complete_to(beam, *values, pairs)
    complete_to = None if top is None else outward(*ends(top), 8)[0]
    bound, certificate = None if complete_to is None else read(complete_to), None
    if bound is not None and bound <= MOST_COUNTED:
        stated = asked.column.kernel, asked.certified, values[0], balls, bound, narrow
        certificate, missing = attempted(lambda: write_spectrum(*stated))
    elif bound is not None:
        missing = f"the verifier counts eigenvalues up to |λ| = {MOST_COUNTED}; ask for those of fewer modes"
    return ExactSpectrum(
        tuple(low for _, low, _ in found),
        tuple(high for _, _, high in found),
        tuple(unproven),
        digits,
        asked.inputs,
        complete_to,
        missing,
        certificate,
    )


def _lowest(asked: _Asked) -> list[complex]:
    """Ritz values to start from: of many more functions than asked for, polynomials where there are, those of lowest
    |s|, two to a function."""
    from freebeam_sym.spectra import spectrum

    question = asked.question
    more = question.over(question.column.polynomials or question.column, min(2 * question.modes + 8, 120))
    system = more.system(float(asked.exact["load"]))
    values = [complex(v) for v in spectrum(system).eigenvalues]
    if question.column.general:
        return sorted(values, key=abs)[: 2 * asked.question.modes]
    c_M, c_E = question.column.damping_factors(question.alpha, question.beta, **question.parameters)
    return sorted(values, key=lambda v: abs(v * (v + c_M)) / max(abs(1 + c_E * v), 1e-300))[: 2 * asked.question.modes]


def _decimals(interval: tuple[Fraction, Fraction], digits: int) -> tuple[str, str]:
    """A part of an eigenvalue as decimals; exactly zero is zero."""
    from freebeam_derive.certify.decimals import outward

    return ("0", "0") if not any(interval) else outward(*interval, digits + 2)


def certified_pulse(
    column: Column,
    modes: int | None = None,
    alpha: object = 0,
    beta: object = 0,
    *,
    load: object,
    frequency: object,
    amplitude: object,
    **parameters: object,
) -> CertifiedPulse:
    """Whether the elastic motion of the Ritz series dies out or grows under a load P (1 + ε cos Ωt), proven.

    load P, frequency Ω, amplitude ε: numbers, taken exactly, as the rest in `certified_load`; nondimensional. Time
    grows with the frequency of the fastest function: a second at N = 4, some ten at N = 8.

    Raises InputError for bad values, and where nothing could be proven: near a region's edge, and without damping
    wherever the motion does not grow, because its multipliers lie on the unit circle then.
    """
    from freebeam_derive.certify import floquet
    from freebeam_derive.certify.balls import Unproven, ends
    from freebeam_derive.certify.decimals import outward

    given = {"load": load, "frequency": frequency, "amplitude": amplitude}
    taken = {name: rational(name, value) for name, value in given.items()}
    positive("frequency", float(taken["frequency"][0]), "Ω of the load P (1 + ε cos Ωt)")
    nonnegative("amplitude", float(taken["amplitude"][0]), "ε of the load P (1 + ε cos Ωt)")
    asked = _Asked.of(column, modes, parameters, alpha=alpha, beta=beta)
    pulsation = floquet.Pulsation(**{name: value for name, (value, _) in taken.items()})
    try:
        found = floquet.prove(column.kernel, asked.certified, pulsation)
    except Unproven as error:
        raise InputError(f"not proven for {column.name} at N = {asked.question.modes}: {error}") from error
    low, high = found.growth
    lower = None if low is None else outward(*ends(low), 15)[0]
    inputs = {**asked.inputs, **{name: text for name, (_, text) in taken.items()}}
    return CertifiedPulse(found.kind, (lower, outward(*ends(high), 15)[1]), asked.question, inputs)
