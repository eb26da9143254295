"""What several commands take: numbers as they are typed, units, and the options that name a case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

if TYPE_CHECKING:
    from freebeam_sym.columns import Column, System


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


def vanishing_or_number(text: str | Number) -> Number:
    """Read a number, or 0+ for what vanishes."""
    return Number("0+", Fraction(0)) if str(text).strip() == "0+" else number(text)


def assignments(pairs: Sequence[str] | None) -> dict[str, Number]:
    """Read `--set name=value` options."""
    found: dict[str, Number] = {}
    for pair in pairs or ():
        name, equals, text = pair.partition("=")
        name = name.strip()
        if not equals or not name:
            raise typer.BadParameter(f"{pair!r} must be NAME=VALUE, such as eta=0.7", param_hint="'--set'")
        if name in found:
            raise typer.BadParameter(f"{name} is set twice", param_hint="'--set'")
        try:
            found[name] = number(text)
        except typer.BadParameter as error:
            raise typer.BadParameter(f"{name}: {error}", param_hint="'--set'") from None
    return found


@dataclass(frozen=True)
class Units:
    """Sizes in SI units of one nondimensional unit of each quantity, Eq. (5); none: all is nondimensional."""

    sizes: Mapping[str, float] = field(default_factory=dict)

    SYMBOLS: ClassVar = {
        "length": "m", "time": "s", "load": "N", "force": "N", "alpha": "s", "beta": "kg/(m s)", "kappa": "kg/(m s^2)",
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
        return f" {self.SYMBOLS[quantity]}" if self.sizes else ""

    def say(self, quantity: str, value: float, digits: str) -> str:
        """A nondimensional value in the units of the output, for print; a rate is what grows or decays in a unit of
        time, in 1/s where a frequency is in rad/s."""
        if quantity == "rate":
            return f"{self.out('frequency', value):{digits}}" + (" 1/s" if self.sizes else "")
        return f"{self.out(quantity, value):{digits}}{self.of(quantity)}"

    @property
    def name(self) -> str:
        return "SI" if self.sizes else "nondimensional"


def units_of(
    column: Column, bending_stiffness: Number | None, mass_per_length: Number | None, length: Number | None
) -> Units:
    """Units of a command's input and output: SI where the beam's three quantities are given."""
    from freebeam_sym.checks import InputError, positive

    given = {
        "--bending-stiffness": bending_stiffness,
        "--mass-per-length": mass_per_length,
        "--length": length,
    }
    missing = [name for name, value in given.items() if value is None]
    if len(missing) == len(given):
        return Units()
    if missing:
        raise InputError(f"SI units need the beam's three quantities: give {' and '.join(missing)} too")
    sizes = column.scales(*(positive(name, value) for name, value in given.items()))
    return Units({**sizes, "kappa": sizes["beta"] / sizes["alpha"]})


@contextmanager
def nondimensional(units: Units) -> Iterator[None]:
    """Have errors inside speak in SI units where these were typed, or say that their values are nondimensional."""
    from freebeam_sym.checks import InputError

    try:
        yield
    except InputError as error:
        if not units.sizes:
            raise
        told = getattr(error.args[0], "told", None)  # a message that knows its quantities
        raise InputError(told(units.say) if told else f"{error} [nondimensional values]") from None


_BEAM = "Beam in SI units (all three: input and output are SI then)"
ColumnOption = Annotated[
    str,
    typer.Option(
        "--column", metavar="NAME|FILE", help="Name of a column, or a column's file: a Python program, which is run."
    ),
]
ModesOption = Annotated[
    int | None,
    typer.Option("--modes", "-N", help="Number N of elastic functions; the column's own where not given."),
]
AlphaOption = Annotated[Number, typer.Option("--alpha", parser=number, metavar="X", help="Internal damping.")]
BetaOption = Annotated[Number, typer.Option("--beta", parser=number, metavar="X", help="External damping.")]
LoadOption = Annotated[Number, typer.Option("--load", parser=number, metavar="P", help="The load P0.")]
BasisOption = Annotated[
    str | None,
    typer.Option("--basis", metavar="modes|legendre", help="Trial functions: modes of the beam, or polynomials."),
]
RigidOption = Annotated[bool, typer.Option("--rigid", help="With the rigid-body functions.")]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="A parameter of the column's own, of any value; repeatable."),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
StiffnessOption = Annotated[
    Number | None,
    typer.Option(parser=number, metavar="EI", rich_help_panel=_BEAM, help="Bending stiffness EI, N m^2."),
]
MassOption = Annotated[
    Number | None,
    typer.Option(parser=number, metavar="m", rich_help_panel=_BEAM, help="Mass per length, kg/m."),
]
LengthOption = Annotated[
    Number | None, typer.Option(parser=number, metavar="L", rich_help_panel=_BEAM, help="Length, m.")
]
ZERO = Number("0", Fraction(0))


@dataclass(frozen=True)
class Case:
    """A column with the parameters of a command, nondimensional, and the units of its input and output."""

    column: Column
    modes: int
    alpha: float
    beta: float
    own: dict[str, float]
    units: Units
    typed: dict[str, Number]

    def system(self, load: float, rigid: bool) -> System:
        return self.column.system(
            modes=self.modes, load=load, alpha=self.alpha, beta=self.beta, rigid=rigid, **self.own
        )

    def record(self, **more: object) -> dict[str, Any]:
        """What was asked, in the units in which it was asked: the head of each command's JSON object."""
        return {
            "column": self.column.name,
            "basis": self.column.basis_name,
            "modes": self.modes,
            **self.typed,
            "parameters": self.own,
            "units": self.units.name,
            **more,
        }

    def title(self, **more: str) -> str:
        words = {"N": str(self.modes)}
        if self.column.basis_name != "modes":
            words["basis"] = self.column.basis_name
        words |= {k: f"{v}{self.units.of(k)}" for k, v in self.typed.items()} | more
        words |= {name: f"{value:g}" for name, value in self.own.items()}
        return ", ".join([self.column.name, *(f"{key} = {value}" for key, value in words.items())])


def case_of(
    name: str,
    modes: int | None,
    alpha: Number,
    beta: Number,
    pairs: list[str] | None,
    beam: tuple[Number | None, Number | None, Number | None],
    basis: str | None = None,
) -> Case:
    """The column that is named, and a command's parameters for it."""
    import freebeam as fb
    from freebeam_sym.checks import nonnegative

    column = fb.column(name, basis)
    own = column.own_parameters(assignments(pairs))
    units = units_of(column, *beam)
    # Checked as typed, so that a message names the value that the user knows.
    nonnegative("alpha", alpha, "internal damping")
    nonnegative("beta", beta, "external damping")
    return Case(
        column, column.number(modes), units.into("alpha", alpha), units.into("beta", beta), own, units,
        {"alpha": alpha, "beta": beta},
    )  # fmt: skip
