"""`freebeam map`."""

from __future__ import annotations

import io
import json
import math
import re
from collections.abc import Sequence
from contextlib import ExitStack
from importlib.util import find_spec
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

from freebeam.cli.application import app
from freebeam.cli.options import (
    BasisOption,
    ColumnOption,
    JsonOption,
    LengthOption,
    MassOption,
    ModesOption,
    Number,
    SetOption,
    StiffnessOption,
    Units,
    assignments,
    nondimensional,
    number,
    units_of,
)
from freebeam.cli.output import plain, print_json, print_table, working, written

if TYPE_CHECKING:
    import xarray

MOST_PRINTED = 10_000
"""Points of a map up to which it is printed as JSON."""
FORMATS: dict[str, tuple[str, tuple[str, ...], str]] = {
    ".csv": ("table", (), ""),
    ".nc": ("NetCDF file", ("h5netcdf", "h5py", "xarray"), "maps"),
    ".png": ("picture", ("matplotlib", "xarray"), "pictures,maps"),
}
"""What each kind of output is, the packages that write it, and the extra that brings them."""

WORDS = {"--alpha": "LO HI COUNT", "--beta": "LO HI COUNT", "--axis": "NAME LO HI COUNT"}
"""What the options that are axes take."""


class Axes(TyperCommand):
    """The command with `--axis`, four words and repeatable, and told where one of the words is missing."""

    def __init__(self, *given: Any, **more: Any) -> None:
        super().__init__(*given, **more)
        next(option for option in self.params if option.name == "axis").nargs = 4

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        from freebeam_sym.checks import InputError

        for k, word in enumerate(args):
            option, equals, _ = word.partition("=")
            wanted = WORDS.get(option, "").split()
            following = list(takewhile(lambda text: not re.match(r"--?[a-zA-Z]", text), args[k + 1 :]))
            if wanted and len(following) + bool(equals) < len(wanted):
                missing = " ".join(wanted[len(following) + bool(equals) :])
                example = "--axis eta 0.4 0.6 20" if option == "--axis" else f"{option} 1e-6 1e-1 100"
                raise InputError(f"{option} {' '.join(wanted)}: {missing} is missing; for example {example}")
        return list(super().parse_args(ctx, args))


@app.command(
    "map",
    cls=Axes,
    epilog="Example: freebeam map --alpha 1e-6 1e-1 100 --beta 1e-2 1 100 --output map.nc (.csv, .png, or --json)",
)
def stability_map(
    alpha: Annotated[
        tuple[str, str, str] | None,
        typer.Option(metavar=WORDS["--alpha"], help="Internal damping: from, to, how many values."),
    ] = None,
    beta: Annotated[
        tuple[str, str, str] | None,
        typer.Option(metavar=WORDS["--beta"], help="External damping: from, to, how many values."),
    ] = None,
    axis: Annotated[
        list[str] | None,
        typer.Option(
            metavar=WORDS["--axis"], help="Any parameter: alpha, beta or one of the column's own; repeatable."
        ),
    ] = None,
    column: ColumnOption = "free-free",
    modes: ModesOption = None,
    basis: BasisOption = None,
    linear: Annotated[bool, typer.Option("--linear", help="Space dampings evenly too, not by a factor.")] = False,
    own: SetOption = None,
    load_max: Annotated[Number | None, typer.Option(parser=number, metavar="P", help="Search up to this load.")] = None,
    no_convergence: Annotated[
        bool, typer.Option("--no-convergence", help="Without the polynomials that tell the error.")
    ] = False,
    chunks: Annotated[
        int | None,
        typer.Option(metavar="K", help="Compute in blocks of K x K points, by processes on Dask."),
    ] = None,
    workers: Annotated[int | None, typer.Option(metavar="W", help="Processes; one a core where not given.")] = None,
    store: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Keep finished blocks here; a stopped run goes on from it.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE.csv|.nc|.png", help="Write a table, a NetCDF file, or a picture.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
    extra: Annotated[list[str] | None, typer.Argument(hidden=True)] = None,
) -> None:
    """Map the critical load over one parameter or more: dampings, or the column's own.

    Each point is the first loss of stability, with its kind and frequency and its error against the beam itself.
    Values of a damping are spaced by a factor, those of another parameter evenly.
    """
    import numpy as np

    import freebeam as fb
    from freebeam_sym.checks import InputError, positive
    from freebeam_sym.stability.grids import KINDS
    from freebeam_sym.stability.maps import dataset, solved, split

    if extra:
        raise InputError(f"{extra[0]}: belongs to no option; the axes take {', '.join(map(' '.join, WORDS.items()))}")
    any_of_them: Any = axis or ()  # four words each, as `Axes` has it
    axes = _axes([("alpha", alpha), ("beta", beta), *((name, given) for name, *given in any_of_them)], linear)
    points = math.prod(map(len, axes.values()))
    if output is not None:
        _refuse_output(output, [*map(len, axes.values())])
    if as_json and output is None and points > MOST_PRINTED:
        raise InputError(f"{points} points: JSON is printed of {MOST_PRINTED} at most; give --output FILE.csv or .nc")
    chosen = fb.column(column, basis)
    own_values = assignments(own)
    for name in axes:
        if name in own_values:
            raise InputError(f"--set {name}={own_values[name]}: {name} is an axis of this map; leave one of them out")
    beam = {"bending_stiffness": bending_stiffness, "mass_per_length": mass_per_length, "length": length}
    units = units_of(chosen, *beam.values())
    fixed = {name: value for name, value in chosen.own_parameters(own_values).items() if name not in axes}
    limit = {}
    if load_max is not None:
        positive("load_max", load_max, "largest load to look at")
        limit = {"load_max": units.into("load", load_max)}
    with nondimensional(units):
        values_of = {name: units.into(name, axis) for name, axis in axes.items()}
        question, values_of = split(chosen, modes, fixed | values_of, **limit)
    if chunks is None and (workers is not None or store is not None):
        raise InputError(f"--{'store' if workers is None else 'workers'} needs --chunks K, such as --chunks 100")
    blocks: dict[str, Any] = {} if chunks is None else {"chunks": chunks, "workers": workers, "store": store}
    with ExitStack() as stack:
        # The file is begun before the work, so that what is in its way is said then.
        stream = None if output is None else stack.enter_context(written(output, force))
        report = stack.enter_context(working("map"))
        with nondimensional(units):
            found = solved(question, values_of, not no_convergence, lambda part: report(f"{part:.0%}"), **blocks)
        kinds = np.array(KINDS)[found.answers.kind]
        values = {
            "load": units.out("load", found.answers.load),
            "kind": kinds,
            "frequency": units.out("frequency", found.answers.frequency),
        }
        if found.error is not None:
            values |= {"error": found.error, "converged": found.converged}
        head: dict[str, Any] = {
            **question.record(),
            "parameters": fixed,
            **{name: 0.0 for name in ("alpha", "beta") if name not in axes},
            "load_max": units.out("load", question.load_max),
            "units": units.name,
        }
        if stream is not None and output is not None:
            report("writing")
            if output.suffix == ".csv":
                stream.write(_csv(head, axes, values))
            else:
                labelled = dataset(found)
                if units.sizes:
                    sizes = {name: float(size) for name, size in beam.items() if size is not None}
                    labelled = _in_si(labelled, units, axes, sizes)
                stream.write(_picture(labelled) if output.suffix == ".png" else _netcdf(labelled))
    if as_json:
        head |= axes | values if points <= MOST_PRINTED else {}
        print_json(head if output is None else {**head, "output": output, "points": points})
        return
    rows = [["points", " x ".join(f"{len(values)} {name}" for name, values in axes.items())]]
    for name in ("flutter", "divergence", "none"):
        share = kinds == name
        if share.any():
            loads = values["load"][share]
            between = f" up to {head['load_max']:.10g}{units.of('load')}" if name == "none" else (
                f", load {loads.min():.10g} to {loads.max():.10g}{units.of('load')}"
            )  # fmt: skip
            rows.append([name, f"{share.sum()} points{between}"])
    if found.converged is not None:
        rows.append(["not converged", f"{int((~found.converged).sum())} points"])
    if output is not None:
        rows.append(["written", str(output)])
    title = ", ".join([chosen.name, f"N = {question.modes}", *(f"{name} = {value:g}" for name, value in fixed.items())])
    print_table(rows, title=title)


def _axes(ranges: Sequence[tuple[str, Sequence[str] | None]], linear: bool) -> dict[str, Any]:
    """The axes of a map, each (COUNT,), by name. Raises InputError."""
    import numpy as np

    from freebeam_sym.checks import InputError
    from freebeam_sym.stability.maps import counted

    read: dict[str, tuple[float, float, int]] = {}
    for name, given in ranges:
        if given is not None:
            if name in read:
                raise InputError(f"{name}: is an axis twice; leave one of them out")
            read[name] = _range(name, given, linear)
    if not read:
        raise InputError("a map needs an axis, such as --alpha 1e-6 1e-1 100 or --axis eta 0.4 0.6 20")
    counted([number_of for _, _, number_of in read.values()])
    by_factor = {name for name in read if name in ("alpha", "beta") and not linear}
    return {name: (np.geomspace if name in by_factor else np.linspace)(*given) for name, given in read.items()}


def _range(name: str, given: Sequence[str], linear: bool) -> tuple[float, float, int]:
    """From, to, how many values, as typed. Raises InputError."""
    from freebeam_sym.checks import LARGEST, InputError, count

    try:
        low, high = (float(number(text)) for text in given[:2])
    except typer.BadParameter as error:
        raise InputError(f"{name}: {error}") from None
    try:
        number_of = int(given[2])
    except ValueError:
        raise InputError(f"{name}: COUNT = {given[2]} must be a whole number") from None
    number_of = count(f"{name}: COUNT", number_of, 1, hint="values along the axis")
    if name in ("alpha", "beta") and (low < 0 or (low == 0 and not linear)):
        cure = "damping is zero or greater" if linear else "a logarithmic axis starts above zero; or give --linear"
        raise InputError(f"{name}: LO = {given[0]}: {cure}")
    if high < low or (high == low and number_of > 1):
        raise InputError(f"{name}: HI = {given[1]} must be above LO = {given[0]}")
    if max(-low, high) >= LARGEST:
        raise InputError(f"{name}: {given[0]} to {given[1]}: must be below 1e60 in size to be computed with")
    return low, high, number_of


def _refuse_output(output: Path, counts: list[int]) -> None:
    """What can be known of a file that will not come about, before the work is done. Raises InputError."""
    from freebeam_sym.checks import InputError

    if output.suffix not in FORMATS:
        raise InputError(f"{output}: must end in {', '.join(FORMATS)}")
    kind, packages, extra = FORMATS[output.suffix]
    missing = [name for name in packages if find_spec(name) is None]
    if missing:
        be = "is" if len(missing) == 1 else "are"
        raise InputError(
            f"a {kind} needs {' and '.join(missing)}, which {be} not installed: pip install 'freebeam[{extra}]'"
        )
    if output.suffix == ".png" and (len(counts) != 2 or min(counts) < 2):
        raise InputError("a picture needs two axes, and two values or more along each; or write a .csv or .nc file")


def _in_si(found: xarray.Dataset, units: Units, axes: dict[str, Any], beam: dict[str, float]) -> xarray.Dataset:
    """A map in the units in which it was asked; the column's own parameters stay nondimensional."""
    for name, values in axes.items():
        found = found.assign_coords({name: found[name].copy(data=values)})
    for name in ("load", "frequency"):
        found[name] = found[name].copy(data=units.out(name, found[name].values))
    for name in (*(x for x in axes if x in units.SYMBOLS), "load", "frequency"):
        found[name].attrs["units"] = units.SYMBOLS[name]
    found.attrs |= {"load_max": units.out("load", found.attrs["load_max"]), "units": units.name, **beam}
    return found


def _csv(head: dict[str, Any], axes: dict[str, Any], values: dict[str, Any]) -> bytes:
    """A line of settings, a comment after #, then a row a point; numbers read back as the same floats."""
    import numpy as np

    places = [mesh.ravel().tolist() for mesh in np.meshgrid(*axes.values(), indexing="ij")]
    columns = [*places, *(array.ravel().tolist() for array in values.values())]
    rows = (",".join(x if isinstance(x, str) else repr(x) for x in row) for row in zip(*columns, strict=True))
    settings = json.dumps(plain(head), ensure_ascii=False)
    return "\n".join([f"# freebeam map {settings}", ",".join([*axes, *values]), *rows, ""]).encode()


def _netcdf(found: xarray.Dataset) -> bytes:
    stream = io.BytesIO()
    found.to_netcdf(stream, engine="h5netcdf")
    return stream.getvalue()


def _picture(found: xarray.Dataset) -> bytes:
    from matplotlib.figure import Figure

    from freebeam.figures import stability_map as draw
    from freebeam.figures.look import style
    from freebeam.figures.saving import image_of

    axes = draw(found)
    drawn = axes.figure
    assert isinstance(drawn, Figure)
    fixed = [f", {x} = {found.attrs[x]:g}" for x in found.attrs["fixed"].split()]
    title = f"{found.attrs['column']}, N = {found.attrs['modes']}" + "".join(fixed)
    if "length" in found.attrs:
        of_beam = {"EI": ("bending_stiffness", "N m²"), "m": ("mass_per_length", "kg/m"), "L": ("length", "m")}
        sizes = [f"{letter} = {found.attrs[name]:g} {unit}" for letter, (name, unit) in of_beam.items()]
        title += "\n" + ", ".join(sizes)
    with style():
        axes.set_title(title)
    return image_of(drawn, "png")
