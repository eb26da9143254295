"""`freebeam map`."""

from __future__ import annotations

import io
import math
from contextlib import ExitStack
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from freebeam_sym.cli.application import app
from freebeam_sym.cli.options import (
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
from freebeam_sym.cli.output import print_json, print_table, working, written

if TYPE_CHECKING:
    import xarray

MOST_PRINTED = 10_000
"""Points of a map up to which it is printed as JSON."""
FORMATS = {".nc": ("NetCDF file", ("h5netcdf", "h5py"), "maps"), ".png": ("picture", ("matplotlib",), "pictures")}
"""What each kind of output is, the packages that write it, and the extra that brings them."""

_RANGE = "LO HI COUNT"


@app.command(
    "map",
    epilog="Example: freebeam map --alpha 1e-6 1e-1 100 --beta 1e-2 1 100 --output map.nc (or map.png, or --json)",
)
def stability_map(
    alpha: Annotated[
        tuple[str, str, str] | None, typer.Option(metavar=_RANGE, help="Internal damping: from, to, how many values.")
    ] = None,
    beta: Annotated[
        tuple[str, str, str] | None, typer.Option(metavar=_RANGE, help="External damping: from, to, how many values.")
    ] = None,
    column: ColumnOption = "free-free",
    modes: ModesOption = 8,
    basis: BasisOption = None,
    linear: Annotated[bool, typer.Option("--linear", help="Space the values evenly, not by a factor.")] = False,
    own: SetOption = None,
    load_max: Annotated[Number | None, typer.Option(parser=number, metavar="P", help="Search up to this load.")] = None,
    no_convergence: Annotated[
        bool, typer.Option("--no-convergence", help="Without the second map, of more modes, that judges convergence.")
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
        Path | None, typer.Option(metavar="FILE.nc|.png", help="Write a NetCDF file, or a picture.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that exists.")] = False,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
    extra: Annotated[list[str] | None, typer.Argument(hidden=True)] = None,
) -> None:
    """Map the critical load over internal and external damping.

    Each point is the first loss of stability, with its kind and frequency and a mark where more modes disagree.
    """
    import numpy as np

    import freebeam_sym as fb
    from freebeam_sym.checks import InputError, positive

    axes = _axes({"alpha": alpha, "beta": beta}, linear)
    if extra:
        raise InputError(f"{extra[0]}: belongs to no option; --alpha and --beta take {_RANGE} each")
    points = math.prod(map(len, axes.values()))
    if output is not None:
        _refuse_output(output, [*map(len, axes.values())])
    if as_json and output is None and points > MOST_PRINTED:
        raise InputError(f"{points} points: JSON is printed of {MOST_PRINTED} at most; give --output FILE.nc")
    chosen = fb.column(column, basis)
    fixed = chosen.own_parameters(assignments(own))
    beam = {"bending_stiffness": bending_stiffness, "mass_per_length": mass_per_length, "length": length}
    units = units_of(chosen, *beam.values())
    settings: dict[str, Any] = {"convergence": not no_convergence, **fixed}
    settings |= {name: units.into(name, axis) for name, axis in axes.items()}
    if load_max is not None:
        positive("load_max", load_max, "largest load to look at")
        settings["load_max"] = units.into("load", load_max)
    if chunks is not None:
        settings |= {"chunks": chunks, "workers": workers, "store": store}
    elif workers is not None or store is not None:
        raise InputError(f"--{'store' if workers is None else 'workers'} needs --chunks K, such as --chunks 100")
    with ExitStack() as stack:
        # The file is begun before the work, so that what is in its way is said then.
        stream = None if output is None else stack.enter_context(written(output, force))
        report = stack.enter_context(working("map"))
        with nondimensional(units):
            found = fb.stability_map(chosen, modes, step=lambda part: report(f"{part:.0%}"), **settings)
        if units.sizes:
            found = _in_si(found, units, axes, {name: float(size) for name, size in beam.items() if size is not None})
        if stream is not None and output is not None:
            report("writing")
            stream.write(_picture(found) if output.suffix == ".png" else _netcdf(found))
    kinds = np.array(found.kind.attrs["flag_meanings"].split())[found.kind.values]
    head: dict[str, Any] = {
        "column": chosen.name,
        "basis": chosen.basis_name,
        "modes": modes,
        "parameters": fixed,
        "load_max": found.attrs["load_max"],
        "units": units.name,
    }
    if as_json:
        if points <= MOST_PRINTED:
            head |= {**axes, "load": found["load"].values, "kind": kinds, "frequency": found.frequency.values}
            if "converged" in found:
                head["converged"] = found.converged.values
        if output is not None:
            head |= {"output": output, "points": points}
        print_json(head)
        return
    rows = [["points", f"{len(axes['alpha'])} x {len(axes['beta'])}"]]
    for name in ("flutter", "divergence", "none"):
        share = kinds == name
        if share.any():
            loads = found["load"].values[share]
            between = "" if name == "none" else f", load {loads.min():.10g} to {loads.max():.10g}{units.of('load')}"
            rows.append([name, f"{share.sum()} points{between}"])
    if "converged" in found:
        rows.append(["not converged in N", f"{int((~found.converged).sum())} points"])
    if output is not None:
        rows.append(["written", str(output)])
    title = ", ".join([chosen.name, f"N = {modes}", *(f"{name} = {value:g}" for name, value in fixed.items())])
    print_table(rows, title=title)


def _axes(ranges: dict[str, tuple[str, str, str] | None], linear: bool) -> dict[str, Any]:
    """The axes of a map, each (COUNT,). Raises InputError."""
    import numpy as np

    from freebeam_sym.checks import InputError
    from freebeam_sym.maps import counted

    read = {name: _range(name, given, linear) for name, given in ranges.items() if given is not None}
    missing = " and ".join(f"--{name} {_RANGE}" for name, given in ranges.items() if given is None)
    if missing:
        raise InputError(f"a map has two axes: give {missing}, such as --alpha 1e-6 1e-1 100 --beta 1e-2 1 100")
    counted([number_of for _, _, number_of in read.values()])
    return {name: (np.linspace if linear else np.geomspace)(*given) for name, given in read.items()}


def _range(name: str, given: tuple[str, str, str], linear: bool) -> tuple[float, float, int]:
    """From, to, how many values, as typed. Raises InputError."""
    from freebeam_sym.checks import InputError, count

    try:
        low, high = (float(number(text)) for text in given[:2])
    except typer.BadParameter as error:
        raise InputError(f"--{name}: {error}") from None
    try:
        number_of = int(given[2])
    except ValueError:
        raise InputError(f"--{name}: COUNT = {given[2]} must be a whole number") from None
    number_of = count(f"--{name} COUNT", number_of, 1, hint="values along the axis")
    if low < 0 or (low == 0 and not linear):
        cure = "damping is zero or greater" if linear else "a logarithmic axis starts above zero; or give --linear"
        raise InputError(f"--{name}: LO = {given[0]}: {cure}")
    if high < low or (high == low and number_of > 1):
        raise InputError(f"--{name}: HI = {given[1]} must be above LO = {given[0]}")
    return low, high, number_of


def _refuse_output(output: Path, counts: list[int]) -> None:
    """What can be known of a file that will not come about, before the work is done. Raises InputError."""
    from freebeam_sym.checks import InputError

    if output.suffix not in FORMATS:
        raise InputError(f"{output}: must end in {' or '.join(FORMATS)}")
    kind, packages, extra = FORMATS[output.suffix]
    missing = [name for name in packages if find_spec(name) is None]
    if missing:
        be = "is" if len(missing) == 1 else "are"
        raise InputError(
            f"a {kind} needs {' and '.join(missing)}, which {be} not installed: pip install 'freebeam[{extra}]'"
        )
    if output.suffix == ".png" and min(counts) < 2:
        raise InputError("a picture needs two values or more along each axis; give a larger COUNT")


def _in_si(found: xarray.Dataset, units: Units, axes: dict[str, Any], beam: dict[str, float]) -> xarray.Dataset:
    """A map in the units in which it was asked; the column's own parameters stay nondimensional."""
    for name, values in axes.items():
        found = found.assign_coords({name: found[name].copy(data=values)})
    for name in ("load", "frequency"):
        found[name] = found[name].copy(data=units.out(name, found[name].values))
    for name in (*axes, "load", "frequency"):
        found[name].attrs["units"] = units.SYMBOLS[name]
    found.attrs |= {"load_max": units.out("load", found.attrs["load_max"]), "units": units.name, **beam}
    return found


def _netcdf(found: xarray.Dataset) -> bytes:
    stream = io.BytesIO()
    found.to_netcdf(stream, engine="h5netcdf")
    return stream.getvalue()


def _picture(found: xarray.Dataset) -> bytes:
    from matplotlib.figure import Figure

    from freebeam_sym.figures import stability_map as draw
    from freebeam_sym.figures.files import image_of
    from freebeam_sym.figures.look import style

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
