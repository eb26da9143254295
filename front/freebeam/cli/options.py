"""What several commands take: numbers as they are typed, units, and the options that name a column and a case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import MISSING, dataclass, field
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar

import typer

if TYPE_CHECKING:
    from freebeam_sym.columns import Column
    from freebeam_sym.question import Question


@dataclass(frozen=True, repr=False)
class Number:
    """A number as it was typed, and exactly what that says; its `float` is what computations use."""

    text: str
    exact: Fraction

    def __float__(self) -> float:
        return float(self.exact)

    def __repr__(self) -> str:
        return self.text


def number(text: str | Number) -> Number:
    """Read a decimal such as 1e-3, or a quotient such as 1/3."""
    text = str(text).strip()
    try:
        parts = [Decimal(part) for part in text.split("/", 1)]
    except InvalidOperation:
        raise typer.BadParameter(f"{text!r} is not a number") from None
    if not all(part.is_finite() for part in parts):
        raise typer.BadParameter(f"{text} is not finite")
    # Exponents are checked before an exact number of that many digits is made.
    if any(part and abs(part.adjusted()) > 400 for part in parts):
        raise typer.BadParameter(f"{text} is beyond the range of a float")
    try:
        value = Number(text, Fraction(parts[0]) / (Fraction(parts[1]) if len(parts) > 1 else 1))
        float(value)
    except ZeroDivisionError:
        raise typer.BadParameter(f"{text} divides by zero") from None
    except OverflowError:
        raise typer.BadParameter(f"{text} is beyond the range of a float") from None
    return value


@dataclass(frozen=True, repr=False)
class Rounded(Number):
    """A number whose nondimensional value is not rational: a float's worth of it, of which nothing is proven."""


@dataclass(frozen=True, repr=False)
class Interval(Number):
    """A range as it was typed, such as 0.6..0.7; as a number it is the middle."""

    low: Number
    high: Number


def number_or_range(text: str | Number) -> Number:
    """Read a number, or a range of them such as 0.6..0.7."""
    if isinstance(text, Interval) or ".." not in str(text):
        return text if isinstance(text, Interval) else number(text)
    low, high = (number(part) for part in str(text).split("..", 1))
    return Interval(str(text).strip(), (low.exact + high.exact) / 2, low, high)


def ratio(text: str | Number) -> Number:
    """Read a number, a range, or inf for what only one of two has."""
    exact: Any = math.inf  # which no fraction is
    return Number("inf", exact) if str(text).strip() == "inf" else number_or_range(text)


def vanishing_or_number(text: str | Number) -> Number:
    """Read a number, a range, or 0+ for what vanishes."""
    return Number("0+", Fraction(0)) if str(text).strip() == "0+" else number_or_range(text)


@dataclass(frozen=True)
class Units:
    """Sizes in SI units of one nondimensional unit of each quantity, Eq. (5); none: all is nondimensional."""

    sizes: Mapping[str, float] = field(default_factory=dict)
    load: str = "N"
    """The load's SI unit."""

    SYMBOLS: ClassVar = {
        "length": "m", "time": "s", "force": "N", "alpha": "s", "beta": "kg/(m s)", "kappa": "kg/(m s^2)",
        "frequency": "rad/s", "velocity": "m/s", "acceleration": "m/s^2",
    }  # fmt: skip

    def into(self, quantity: str, value: Any) -> Any:
        """A typed value, or an array of them, as nondimensional ones; a column's own parameters are that already."""
        value = float(value) if isinstance(value, Number) else value
        return value / self.sizes[quantity] if quantity in self.sizes else value

    def out(self, quantity: str, value: Any) -> Any:
        """A nondimensional value, array or None as one in the units of the output."""
        return value * self.sizes[quantity] if self.sizes and value is not None else value

    def of(self, quantity: str) -> str:
        """The unit, for print; empty where nondimensional."""
        unit = self.load if quantity == "load" else self.SYMBOLS[quantity]
        return f" {unit}" if self.sizes and unit != "1" else ""

    def say(self, quantity: str, value: float, digits: str) -> str:
        """A nondimensional value in the units of the output, for print; a rate is what grows or decays in a unit of
        time, in 1/s where a frequency is in rad/s."""
        if quantity == "rate":
            return f"{self.out('frequency', value):{digits}}" + (" 1/s" if self.sizes else "")
        return f"{self.out(quantity, value):{digits}}{self.of(quantity)}"

    @property
    def name(self) -> str:
        return "SI" if self.sizes else "nondimensional"

    @contextmanager
    def in_errors(self) -> Iterator[None]:
        """Have errors inside speak in SI units where these were typed, or say that their values are nondimensional."""
        from freebeam_sym.checks import InputError

        try:
            yield
        except InputError as error:
            if not self.sizes:
                raise
            told = getattr(error.args[0], "told", None)  # a message that knows its quantities
            raise InputError(told(self.say) if told else f"{error} [nondimensional values]") from None


def refuse(mistaken: object, message: str) -> None:
    """Raise InputError with a message where there is a mistake."""
    from freebeam_sym.checks import InputError

    if mistaken:
        raise InputError(message)


REQUIRED: Any = MISSING


def option(metavar: str, help: str, *names: str, default: Any = None, **more: Any) -> Any:
    """A field of a command that is an option, named like the field where no names are given; `more` as typer has it."""
    given = {"kind": typer.Option, "names": names, "metavar": metavar, "help": help, **more}
    return field(default=default, metadata=given)


def flag(help: str, *names: str) -> Any:
    """A field that is an option without a value."""
    return field(default=False, metadata={"kind": typer.Option, "names": names, "help": help})


def argument(metavar: str = "", help: str = "", default: Any = None) -> Any:
    """A field that is given without a name; hidden where it has no help."""
    given = {"kind": typer.Argument, "names": (), "metavar": metavar or None, "help": help, "hidden": not help}
    return field(default=default, metadata=given)


@dataclass(frozen=True, kw_only=True)
class Options:
    """Of every command. A command is a class of such fields, what is asked, and of what is done about it."""

    as_json: bool = flag("Print one JSON object.", "--json")


@dataclass(frozen=True, kw_only=True)
class FileOptions(Options):
    """Of every command that writes files."""

    force: bool = flag("Replace files that exist.")


@dataclass(frozen=True, kw_only=True)
class NameOptions(Options):
    column: str = option(
        "NAME|FILE", "A column's name, or its file: a Python program, which is run.", default="free-free"
    )


@dataclass(frozen=True, kw_only=True)
class BasisOptions(NameOptions):
    basis: str | None = option("modes|legendre", "Trial functions: modes of the beam, or polynomials.")

    @cached_property
    def chosen(self) -> Column:
        """The column with its basis. Raises InputError."""
        import freebeam as fb

        return fb.column(self.column, self.basis)


_of_beam = partial(option, rich_help_panel="Beam in SI units (give all three; input and output are in SI units then)")


@dataclass(frozen=True, kw_only=True)
class ColumnOptions(BasisOptions):
    """A column, its series, its own parameters, and a beam in SI units."""

    modes: int | None = option("N", "Number of elastic functions; the column's default if not given.", "--modes", "-N")
    own: list[str] | None = option("NAME=VALUE", "A parameter of the column, of any value; may be repeated.", "--set")
    bending_stiffness: Number | None = _of_beam("EI", "Bending stiffness EI, N m^2.")
    mass_per_length: Number | None = _of_beam("m", "Mass per length m, kg/m.")
    length: Number | None = _of_beam("L", "Length L, m.")

    READ: ClassVar[Any] = staticmethod(number)

    @cached_property
    def typed(self) -> dict[str, Number]:
        """What is set, by the names as they were typed. Raises BadParameter."""
        found: dict[str, Number] = {}
        for pair in self.own or ():
            name, equals, text = pair.partition("=")
            name = name.strip()
            if not equals or not name:
                raise typer.BadParameter(f"{pair!r} must be NAME=VALUE, such as eta=0.7", param_hint="'--set'")
            if name in found:
                raise typer.BadParameter(f"{name} is set twice", param_hint="'--set'")
            try:
                found[name] = self.READ(text)
            except typer.BadParameter as error:
                raise typer.BadParameter(f"{name}: {error}", param_hint="'--set'") from None
        return found

    @cached_property
    def assigned(self) -> dict[str, Number]:
        """The column's own parameters that are set, to a range where the command has such; from SI quantities where the
        column's dimensional statement has them. Raises BadParameter and InputError."""
        from freebeam_sym.checks import positive

        found, told = {**self.typed}, self.chosen.kernel.COLUMN.get("quantities", {})
        for name in [name for name in self.typed if told.get(name, {}).get("of")]:
            value, of = found.pop(name), told[name]["of"]
            what = f"{name} = {value}: is what {of} is in {told[name]['unit']}"
            refuse(
                len(self.beam) < 3, f"{what}; give the beam's three quantities in SI units too, or {of} nondimensional"
            )
            refuse(of in found, f"{what}, and {of} is set too; leave one of them out")
            refuse(isinstance(value, Interval), f"{what}; a range is nondimensional: give one of {of}")
            for each, size in self.beam.items():
                positive(f"--{each.replace('_', '-')}", size)
            found[of] = self._share(name, value)
        return found

    def _share(self, name: str, value: Number) -> Number:
        """An SI quantity in nondimensional ones: exact where its size is rational."""
        from freebeam_derive.certify.balls import root
        from freebeam_derive.scaling import squares

        beam = [size.exact for size in self.beam.values()]
        with suppress(ValueError):  # of a size such as π m L
            size = root(squares(self.chosen.kernel.COLUMN, beam, names=[name])[name])
            if isinstance(size, Fraction):
                return Number(value.text, value.exact / size)
        return Rounded(value.text, Fraction(float(value) / self.chosen.scales(*map(float, beam))[name]))

    @property
    def beam(self) -> dict[str, Number]:
        """What is given of the beam in SI units, by name."""
        names = ("bending_stiffness", "mass_per_length", "length")
        return {name: value for name in names if (value := getattr(self, name)) is not None}

    @cached_property
    def units(self) -> Units:
        """Of input and output: SI where the beam's three quantities are given. Raises InputError."""
        from freebeam_sym.checks import positive

        given = {f"--{name.replace('_', '-')}": value for name, value in self.beam.items()}
        if not given:
            return Units()
        missing = [x for x in ("--bending-stiffness", "--mass-per-length", "--length") if x not in given]
        refuse(missing, f"SI units need three quantities of the beam: give {' and '.join(missing)} too")
        own = {name: float(value) for name, value in self.assigned.items()}
        sizes = self.chosen.scales(*(positive(name, value) for name, value in given.items()), **own)
        return Units({**sizes, "kappa": sizes["beta"] / sizes["alpha"]}, self.chosen.load_unit)

    @property
    def limit(self) -> dict[str, float]:
        """The largest load of a search, nondimensional, where it is given."""
        return {}


@dataclass(frozen=True, kw_only=True)
class SearchOptions(ColumnOptions):
    load_max: Number | None = option("P", "Largest load of the search; 1000 (nondimensional) if not given.")

    @property
    def limit(self) -> dict[str, float]:
        from freebeam_sym.checks import positive

        if self.load_max is None:
            return {}
        positive("load_max", self.load_max, "largest load to look at")
        return {"load_max": self.units.into("load", self.load_max)}


@dataclass(frozen=True, kw_only=True)
class CaseOptions(ColumnOptions):
    """A column with its dampings."""

    alpha: Number = option("X", "Internal damping alpha.", default="0")
    beta: Number = option("X", "External damping beta.", default="0")

    @property
    def dampings(self) -> dict[str, Number]:
        """As they were typed."""
        return {"alpha": self.alpha, "beta": self.beta}

    @cached_property
    def question(self) -> Question:
        """What is asked of the column, nondimensional. Raises InputError for bad values."""
        from freebeam_sym.checks import nonnegative
        from freebeam_sym.question import Question

        own = self.chosen.own_parameters(dict(self.assigned))
        for name, meaning in (("alpha", "internal damping"), ("beta", "external damping")):
            nonnegative(name, self.dampings[name], meaning)  # as typed, so that a message names what the user knows
        given = {name: self.units.into(name, value) for name, value in self.dampings.items()} | self.limit
        with self.units.in_errors():
            return Question.of(self.chosen, self.modes, **given, **own)

    def record(self, **more: object) -> dict[str, Any]:
        """What was asked, in the units in which it was asked: the head of each command's JSON object."""
        question, column = self.question, self.chosen
        head = {"column": column.name, "basis": column.basis_name, "modes": question.modes, **self.dampings}
        return {**head, "parameters": question.parameters, "units": self.units.name, **more}

    def title(self, **more: str) -> str:
        words = {"N": str(self.question.modes)}
        if self.chosen.basis_name != "modes":
            words["basis"] = self.chosen.basis_name
        words |= {k: f"{v}{self.units.of(k)}" for k, v in self.dampings.items()} | more
        words |= {name: f"{value:g}" for name, value in self.question.parameters.items() if name not in more}
        return ", ".join([self.chosen.name, *(f"{key} = {value}" for key, value in words.items())])
