"""The command line, `freebeam`. A command loads what it needs when it runs.

Bad input ends in one line on standard error and exit status 2, a check that fails in status 1. With `--json`
a command prints one JSON object on standard output and nothing else there.
"""

from __future__ import annotations

import io
import json
import math
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from pathlib import Path
from typing import IO, TYPE_CHECKING, Annotated, Any, ClassVar

import typer

if TYPE_CHECKING:
    from freebeam_sym.columns import Column, System

app = typer.Typer(
    name="freebeam",
    help="Stability of columns under follower forces, from kernels derived from their energies.",
    add_completion=False,
    pretty_exceptions_enable=False,
)


# --- what is typed ------------------------------------------------------------------------------------------


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
        "length": "m", "time": "s", "load": "N", "force": "N", "alpha": "s", "beta": "kg/(m s)",
        "frequency": "rad/s", "velocity": "m/s", "acceleration": "m/s^2",
    }  # fmt: skip

    def into(self, quantity: str, value: Number) -> float:
        """A typed value as a nondimensional one."""
        return float(value) / self.sizes[quantity] if self.sizes else float(value)

    def out(self, quantity: str, value: Any) -> Any:
        """A nondimensional value, array or None as one in the units of the output."""
        return value * self.sizes[quantity] if self.sizes and value is not None else value

    def of(self, quantity: str) -> str:
        """The unit, for print; empty where nondimensional."""
        return f" {self.SYMBOLS[quantity]}" if self.sizes else ""

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
    return Units(column.kernel.scales(*(positive(name, value) for name, value in given.items())))


@contextmanager
def nondimensional(units: Units) -> Iterator[None]:
    """Say of errors inside that their values are nondimensional, where SI units were typed."""
    from freebeam_sym.checks import InputError

    try:
        yield
    except InputError as error:
        if not units.sizes:
            raise
        raise InputError(f"{error} [nondimensional values]") from None


# --- what is printed ----------------------------------------------------------------------------------------


def plain(value: Any) -> Any:
    """A value as JSON has it: arrays as lists, complex numbers as [re, im], what is not finite as null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, Number):
        return float(value)
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Path):
        return str(value)
    return value


def print_json(record: Mapping[str, Any]) -> None:
    sys.stdout.write(json.dumps(plain(record), allow_nan=False, ensure_ascii=False) + "\n")


def print_table(rows: Sequence[Sequence[str]], header: Sequence[str] | None = None, title: str = "") -> None:
    """Print rows of cells as a table; a last column that is too wide for the terminal is folded."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD if header else None, show_header=header is not None, pad_edge=False)
    for name in header or [""] * len(rows[0]):
        table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    # Without a terminal there is no width to fit, so that no cell of a file or a pipe is folded.
    console = Console(width=None if sys.stdout.isatty() else 1000, highlight=False)
    with console.capture() as printed:
        if title:
            console.print(Text(title, style="bold"))
        console.print(table)
    sys.stdout.write("".join(f"{line.rstrip()}\n" for line in printed.get().rstrip().split("\n")))


@contextmanager
def working(text: str) -> Iterator[Callable[[str], None]]:
    """Show on a terminal, on standard error, that work goes on, and what it is about."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console

    with Console(stderr=True).status(text) as status:
        yield lambda step: status.update(f"{text}: {step}")


@contextmanager
def written(path: Path, replace: bool) -> Iterator[IO[bytes]]:
    """A file that appears at `path` whole or not at all. Raises InputError where one exists and is kept."""
    from freebeam_sym.checks import InputError

    if path.is_dir():
        raise InputError(f"{path}: is a folder; give the name of a file")
    if path.exists() and not replace:
        raise InputError(f"{path}: exists and is kept; give another name, or --force to replace it")
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-")
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None
    beside = Path(name)
    try:
        with open(handle, "wb") as stream:
            yield stream
        mask = os.umask(0)  # mkstemp lets nobody else read; a result is an ordinary file
        os.umask(mask)
        beside.chmod(0o666 & ~mask)
        os.replace(beside, path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise


# --- options that several commands take ---------------------------------------------------------------------

_BEAM = "Beam in SI units (all three: input and output are SI then)"
ColumnOption = Annotated[
    str, typer.Option("--column", metavar="NAME|FILE", help="Name of a column, or a column's file.")
]
ModesOption = Annotated[int, typer.Option("--modes", "-N", help="Number of elastic modes N.")]
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
    typer.Option("--set", metavar="NAME=VALUE", help="A parameter of the column's own; repeatable."),
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
    modes: int,
    alpha: Number,
    beta: Number,
    pairs: list[str] | None,
    beam: tuple[Number | None, Number | None, Number | None],
    basis: str | None = None,
) -> Case:
    """The column that is named, and a command's parameters for it."""
    import freebeam_sym as fb
    from freebeam_sym.checks import nonnegative

    column = fb.column(name, basis)
    own = column.own_parameters(assignments(pairs))
    units = units_of(column, *beam)
    # Checked as typed, so that a message names the value that the user knows.
    nonnegative("alpha", alpha, "internal damping")
    nonnegative("beta", beta, "external damping")
    return Case(
        column, modes, units.into("alpha", alpha), units.into("beta", beta), own, units,
        {"alpha": alpha, "beta": beta},
    )  # fmt: skip


# --- commands -----------------------------------------------------------------------------------------------


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"freebeam {version('freebeam')}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def front(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command(epilog="Example: freebeam columns")
def columns(as_json: JsonOption = False) -> None:
    """List the columns with their ends and parameters."""
    import freebeam_sym as fb

    found = [fb.column(name) for name in fb.column_names()]
    if as_json:
        keys = ("name", "title", "ends", "damping")
        print_json({
            "columns": [
                {key: getattr(column, key) for key in keys}
                | {"parameters": [asdict(parameter) for parameter in column.parameters]}
                for column in found
            ]
        })  # fmt: skip
        return
    rows = [
        [
            column.name,
            column.title,
            "-".join(column.ends),
            "; ".join(
                f"{p.name} = {p.default:g} ({p.low:g} to {p.high:g}): {p.meaning}" for p in column.parameters
            ),
        ]
        for column in found
    ]
    print_table(rows, ["name", "title", "ends", "parameters"])


@app.command(epilog="Example: freebeam generate path/to/column.py --output kernels")
def generate(
    targets: Annotated[
        list[str] | None,
        typer.Argument(metavar="[COLUMN|FILE]...", help="Columns to derive; freebeam's own by default."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the kernels; freebeam's own by default.")
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; print a diff and exit 1 where the folder differs.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Derive columns from their energies, emit their kernels and verify them."""
    from freebeam_derive import pipeline
    from freebeam_derive.statement import StatementError
    from freebeam_derive.verify import VerificationError
    from freebeam_sym.checks import InputError

    files = [target for target in targets or () if target not in pipeline.columns()]
    if files and output is None:
        raise InputError(f"{files[0]}: is not freebeam's own; name a folder for its kernel with --output")
    try:
        with working("generate") as report:
            outcome = pipeline.generate(targets or (), output, report, check)
    except StatementError as error:
        raise InputError(str(error)) from error
    except VerificationError as error:
        print(f"freebeam: nothing is written: {error}", file=sys.stderr)
        raise typer.Exit(1) from error
    worst = {
        name: max(figures, key=lambda figure: figure.error / figure.bound)
        for name, figures in outcome.figures.items()
    }
    if as_json:
        print_json({
            "columns": outcome.columns,
            "output": outcome.output,
            "check": check,
            "written": outcome.written,
            "difference": outcome.difference,
            "errors": {name: asdict(figure) for name, figure in worst.items()},
        })  # fmt: skip
    elif check:
        sys.stdout.write(outcome.difference or f"{outcome.output}: is what the derivation emits\n")
    else:
        rows = [
            [name, f"{figure.error:.1e}", f"{figure.bound:.1e}", f"{figure.what}, {figure.where}"]
            for name, figure in worst.items()
        ]
        header = ["column", "largest error", "bound", "of"]
        print_table(rows, header, f"Emitted to {outcome.output}, verified")
    if outcome.difference:
        raise typer.Exit(1)


@app.command(epilog="Example: freebeam critical --column beck --set eta=0.7 --alpha 1e-3")
def critical(
    column: ColumnOption = "free-free",
    basis: BasisOption = None,
    modes: ModesOption = 8,
    alpha: Annotated[
        Number,
        typer.Option(parser=vanishing_or_number, metavar="X", help="Internal damping; 0+ for its vanishing limit."),
    ] = ZERO,
    beta: BetaOption = ZERO,
    load_max: Annotated[
        Number | None, typer.Option(parser=number, metavar="P", help="Search up to this load.")
    ] = None,
    own: SetOption = None,
    digits: Annotated[int | None, typer.Option(metavar="D", help="Prove the load to D digits.")] = None,
    exact: Annotated[bool, typer.Option("--exact", help="Of the beam itself, with no series.")] = False,
    kappa: Annotated[
        Number | None, typer.Option(parser=number, metavar="K", help="With --alpha 0+: the limit at beta = K alpha.")
    ] = None,
    certificate: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write what was proven, and the data that prove it.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a certificate that exists.")] = False,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the lowest load at which the column flutters or diverges."""
    import freebeam_sym as fb
    from freebeam_sym.checks import InputError

    vanishing = alpha.text == "0+"
    if kappa is not None and not vanishing:
        raise InputError(f"kappa = {kappa}: is the ratio of vanishing dampings; give --alpha 0+ with it")
    if vanishing and float(beta):
        raise InputError(f"beta = {beta}: vanishes with alpha 0+; give --kappa for the ratio beta/alpha instead")
    if digits is None and (exact or certificate):
        option = "--exact" if exact else "--certificate"
        raise InputError(f"{option}: belongs to a proof; give --digits, such as --digits 20")
    if digits is not None and (bending_stiffness or mass_per_length or length):
        raise InputError("--digits: proofs are nondimensional; leave the beam in SI units out")
    if certificate and exact:
        raise InputError("--certificate: is written for a Ritz series; leave --exact out")
    if certificate and certificate.exists() and not force:
        raise InputError(f"{certificate} exists; choose another file, or --force to replace it")
    case = case_of(column, modes, alpha, beta, own, (bending_stiffness, mass_per_length, length), basis)
    units = case.units
    limit = {} if load_max is None else {"load_max": units.into("load", load_max)}
    if vanishing:
        limit["kappa"] = float(kappa or ZERO)
    proven = None
    if digits is not None:
        asked: dict[str, Any] = {"digits": digits, **({} if load_max is None else {"load_max": load_max.exact})}
        asked |= {"kappa": (kappa or ZERO).exact} if vanishing else {}
        asked |= {name: value.exact for name, value in assignments(own).items()}
        with working("proof") as report:
            if exact:
                proven = fb.exact_load(case.column, alpha.exact, beta.exact, **asked)
            else:
                proven = fb.certified_load(case.column, case.modes, alpha.exact, beta.exact, progress=report, **asked)
        if certificate:
            with written(certificate, force) as file:
                file.write((json.dumps(proven.certificate, indent=1) + "\n").encode())
    with working("critical load") as report, nondimensional(units):
        found = fb.critical_load(
            case.column, modes=case.modes, alpha=case.alpha, beta=case.beta, **limit, **case.own
        )
        report("convergence in the number of modes")
        more = found.convergence
    record = case.record(
        load=units.out("load", found.load),
        kind=found.kind,
        frequency=units.out("frequency", found.frequency),
        converged=more.converged,
        convergence={"modes": more.modes, "load": units.out("load", more.load), "kind": more.kind},
        load_max=units.out("load", found.load_max),
    )
    if proven is not None:
        load, frequency = proven.load or (None, None), proven.frequency or (None, None)
        record |= {"load_lower": load[0], "load_upper": load[1]}
        record |= {"frequency_lower": frequency[0], "frequency_upper": frequency[1]}
        record |= {"proof": dict(proven.proof), "exact": exact, "kind": proven.kind}
    if as_json:
        print_json(record)
        return
    load_unit = units.of("load")
    there: str = more.kind
    if found.load is None:
        rows = [["critical load", f"none up to {record['load_max']:.10g}{load_unit}"]]
    else:
        rows = [["critical load", f"{record['load']:.10g}{load_unit}"], ["kind", found.kind]]
        rows += [["frequency", f"{record['frequency']:.10g}{units.of('frequency')}"]]
    if more.load is not None:
        there += f" at {record['convergence']['load']:.10g}{load_unit}"
    rows += [["converged", f"{'yes' if more.converged else 'no'} (N = {more.modes}: {there})"]]
    if proven is not None:
        what = "the beam itself" if exact else f"N = {case.modes}"
        rows += [[f"proven, {what}", " to ".join(proven.load) if proven.load else "none up to the load given"]]
        rows += [["proven is", ", ".join(name.replace("_", " ") for name, yes in proven.proof.items() if yes)]]
    print_table(rows, title=case.title())


@app.command(epilog="Example: freebeam verify certificate.json")
def verify(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A certificate of `critical --certificate`.")],
    as_json: JsonOption = False,
) -> None:
    """Check a certificate with a program that shares no code with the one that wrote it."""
    import freebeam_sym as fb

    with working("verify"):
        sentence = fb.verify_certificate(str(file))
    if as_json:
        print_json({"file": str(file), "verified": True, "proves": sentence})
        return
    typer.echo(f"{file}: {sentence}")


@app.command(epilog="Example: freebeam spectrum --load 50 --alpha 1e-3 --beta 0.1")
def spectrum(
    load: LoadOption,
    column: ColumnOption = "free-free",
    basis: BasisOption = None,
    modes: ModesOption = 8,
    alpha: AlphaOption = ZERO,
    beta: BetaOption = ZERO,
    rigid: RigidOption = False,
    own: SetOption = None,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
) -> None:
    """Print the eigenvalues at a load, sorted by |Im|, then Re."""
    import freebeam_sym as fb

    case = case_of(column, modes, alpha, beta, own, (bending_stiffness, mass_per_length, length), basis)
    units = case.units
    found = fb.spectrum(case.system(units.into("load", load), rigid))
    record = case.record(
        load=load,
        rigid=rigid,
        eigenvalues=units.out("frequency", found.eigenvalues),
        reference_frequency=units.out("frequency", found.reference_frequency),
    )
    if as_json:
        print_json(record)
        return
    rows = [[f"{value.real:.10g}", f"{value.imag:.10g}"] for value in record["eigenvalues"]]
    unit = units.of("frequency")
    print_table(rows, [f"Re{unit}", f"Im{unit}"], case.title(load=f"{load}{units.of('load')}"))


@app.command(
    epilog="Example: freebeam respond --load 9 --alpha 1e-3 --beta 0.1 --duration 20 --step 0.01 --sensor 0.1"
)
def respond(
    load: LoadOption,
    duration: Annotated[Number, typer.Option(parser=number, metavar="T", help="Length of the response.")],
    step: Annotated[Number, typer.Option(parser=number, metavar="H", help="Time step.")],
    column: ColumnOption = "free-free",
    modes: ModesOption = 8,
    alpha: AlphaOption = ZERO,
    beta: BetaOption = ZERO,
    rigid: RigidOption = False,
    own: SetOption = None,
    sensor: Annotated[
        list[Number] | None,
        typer.Option(parser=number, metavar="X ...", help="Positions of sensors; 0.1 L where not given."),
    ] = None,
    more_sensors: Annotated[list[Number] | None, typer.Argument(parser=number, hidden=True)] = None,
    force_amplitude: Annotated[
        Number | None, typer.Option(parser=number, metavar="F", help="A force F sin(w t).")
    ] = None,
    force_frequency: Annotated[
        Number | None, typer.Option(parser=number, metavar="w", help="Its angular frequency.")
    ] = None,
    force_position: Annotated[
        Number | None, typer.Option(parser=number, metavar="X", help="Where it acts; at L where not given.")
    ] = None,
    initial_mode: Annotated[
        int | None, typer.Option(metavar="K", help="Mode of the initial state: 1 is the lowest elastic one.")
    ] = None,
    initial_amplitude: Annotated[
        Number | None, typer.Option(parser=number, metavar="A", help="Its coordinate q at t = 0.")
    ] = None,
    initial_velocity: Annotated[
        Number | None, typer.Option(parser=number, metavar="V", help="Its rate dq/dt at t = 0.")
    ] = None,
    output: Annotated[Path | None, typer.Option(metavar="FILE", help="A .csv or .npz file to write.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an output that exists.")] = False,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compute the response at sensors in time, from an initial state or to a sinusoidal force.

    Without a force and an initial state, mode 1 starts with q = 0.01 (modes normalised as in Eq. (22)).
    """
    import numpy as np

    import freebeam_sym as fb
    from freebeam_sym.checks import InputError, count, positive

    if more_sensors and not sensor:
        raise InputError(f"{more_sensors[0]}: belongs to no option; positions of sensors follow --sensor")
    if output is not None and output.suffix not in (".csv", ".npz"):
        raise InputError(f"{output}: the name must end in .csv or .npz")
    if (force_amplitude is None) != (force_frequency is None):
        raise InputError("a force needs both --force-amplitude and --force-frequency")
    if force_amplitude is None and force_position is not None:
        raise InputError("--force-position: there is no force; give --force-amplitude and --force-frequency")
    positive("duration", duration)
    positive("step", step)
    case = case_of(column, modes, alpha, beta, own, (bending_stiffness, mass_per_length, length))
    units = case.units
    system = case.system(units.into("load", load), rigid)

    places = [*(sensor or ()), *(more_sensors or ())]
    sensors = [units.into("length", x) for x in places] or [0.1]
    labels = [str(x) for x in places] or [f"{units.out('length', 0.1):.6g}"]
    excitation: dict[str, Any] = {}
    if force_amplitude is not None and force_frequency is not None:
        size, rate = units.into("force", force_amplitude), units.into("frequency", force_frequency)
        excitation = {
            "force": lambda t: size * np.sin(rate * t),
            "force_position": 1.0 if force_position is None else units.into("length", force_position),
        }
    start: dict[str, Any] = {}
    if initial_mode is not None or initial_amplitude is not None or initial_velocity is not None:
        k = count("--initial-mode", 1 if initial_mode is None else initial_mode, high=system.modes) - 1
        mode = np.eye(len(system.M))[system.rigid_count + k]
        velocity = 0.0 if initial_velocity is None else units.into("velocity", initial_velocity)
        amplitude = 0.01 if initial_velocity is None else 0.0
        if initial_amplitude is not None:
            amplitude = units.into("length", initial_amplitude)
        start = {"initial": amplitude * mode, "initial_velocity": velocity * mode}

    record = case.record(load=load, rigid=rigid, duration=duration, step=step, sensors=places or sensors)

    def series() -> dict[str, Any]:
        with working("response") as report, nondimensional(units):
            found = fb.respond(
                system, units.into("time", duration), units.into("time", step), sensors=sensors,
                progress=lambda share: report(f"{share:.0%}"), **start, **excitation,
            )  # fmt: skip
        record["period_error"] = found.period_error
        return {
            "t": units.out("time", found.t),
            "y": units.out("length", found.y),
            "dy": units.out("velocity", found.dy),
            "ddy": units.out("acceleration", found.ddy),
        }

    if output is None:
        found = series()
        if as_json:
            print_json({**record, **found})
        else:
            write_csv(sys.stdout, labels, **found)
        return
    with written(output, replace=force) as stream:
        found = series()
        if output.suffix == ".npz":
            np.savez(stream, sensors=sensors, settings=json.dumps(plain(record)), **found)
        else:
            text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
            write_csv(text, labels, **found)
            text.detach()
    if as_json:
        print_json({**record, "output": output})


def write_csv(stream: IO[str], labels: Sequence[str], t: Any, y: Any, dy: Any, ddy: Any) -> None:
    """Write a response as CSV; numbers are written so that they read back as the same floats."""
    import numpy as np

    stream.write(",".join(["t", *(f"{name}({x})" for x in labels for name in ("y", "dy", "ddy"))]) + "\n")
    table = np.stack([y, dy, ddy], axis=-1).reshape(len(t), -1)
    for moment, row in zip(t.tolist(), table, strict=True):
        stream.write(",".join(map(repr, [moment, *row.tolist()])) + "\n")


@app.command(epilog="Example: freebeam validate")
def validate(as_json: JsonOption = False) -> None:
    """Compute the critical loads that the paper prints; exit 1 if one is not explained to its last digit."""
    from freebeam_sym.validate import validate as validated

    with working("validate") as report:
        rows = validated(report)
    if as_json:
        print_json({"loads": [asdict(row) for row in rows], "passed": all(row.passed for row in rows)})
    else:
        cells = [
            [
                row.section,
                f"{row.alpha:g}",
                f"{row.beta:g}",
                row.printed,
                "none" if row.load is None else f"{row.load:.10f}",
                row.kind,
                "none" if row.explained is None else row.explained,
                "yes" if row.passed else "NO",
            ]
            for row in rows
        ]
        header = ["section", "alpha", "beta", "printed", f"N = {rows[0].modes}", "kind", "scanned", "confirmed"]
        print_table(cells, header, "Critical loads of the paper; a scan prints the first step at or above the load")
    if not all(row.passed for row in rows):
        raise typer.Exit(1)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit status; the entry point."""
    try:
        status = app(args=arguments, prog_name="freebeam", standalone_mode=False)
        sys.stdout.flush()
    except (KeyboardInterrupt, typer.Abort):
        status = 130
    except BrokenPipeError:
        # Python would write to the closed pipe once more as it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:
        line = _line_of(error)
        if line is None:
            raise
        print(f"freebeam: {line}", file=sys.stderr)
        return 2
    if status == 130:
        print("freebeam: interrupted", file=sys.stderr)
    return status if isinstance(status, int) else 0


def _line_of(error: Exception) -> str | None:
    """The one line for a user's mistake; None for a fault of the program."""
    from freebeam_sym.checks import InputError

    show = getattr(error, "format_message", None)  # what every usage error of click has, bundled or not
    if show is not None:
        return " ".join(show().split()).rstrip(".") + "; see freebeam --help"
    if isinstance(error, InputError):
        return " ".join(str(error).split())
    if isinstance(error, MemoryError):
        return "not enough memory; fewer modes, sensors or steps need less"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return None


if __name__ == "__main__":
    sys.exit(main())
