"""`freebeam map`."""

from __future__ import annotations

import io
import json
import math
import re
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import cached_property
from importlib.util import find_spec
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import typer
from typer.core import TyperCommand

from freebeam.cli.application import command
from freebeam.cli.options import FileOptions, SearchOptions, argument, flag, number, option, refuse
from freebeam.cli.output import plain, print_json, print_table, working, written

if TYPE_CHECKING:
    import xarray

    from freebeam.maps.labelled import Solved
    from freebeam_sym.question import Question

MOST_PRINTED = 10_000
"""Points of a map up to which it is printed as JSON."""
FORMATS: dict[str, tuple[str, tuple[str, ...], str]] = {
    ".csv": ("table", (), ""),
    ".nc": ("NetCDF file", ("h5netcdf", "h5py", "xarray"), "maps"),
    ".png": ("picture", ("matplotlib", "xarray"), "pictures"),
}
"""What each kind of output is, the packages that write it, and the extra that brings them."""

WORDS = {"--alpha": "LO HI COUNT", "--beta": "LO HI COUNT", "--axis": "NAME LO HI COUNT"}
"""What the options that are axes take."""
EXAMPLES = {"--alpha": "1e-6 1e-1 100", "--beta": "1e-6 1e-1 100", "--axis": "eta 0.4 0.6 20"}
BETWEEN = "\x1f"
"""Between the words of an axis, where these are one: no keyboard has it."""


class Axes(TyperCommand):
    """The command with `--axis`, whose four words are made one, and told where a word of an axis is missing."""

    words: ClassVar = WORDS
    examples: ClassVar = EXAMPLES

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        from freebeam_sym.checks import InputError

        joined, k = [], 0
        while k < len(args):
            option, equals, first = args[k].partition("=")
            wanted = self.words.get(option, "").split()
            following = takewhile(lambda text: not re.match(r"--?[a-zA-Z]", text), args[k + 1 :])
            given = [*([first] if equals else ()), *following][: len(wanted)]
            if len(given) < len(wanted):
                missing = " ".join(wanted[len(given) :])
                example = f"{option} {self.examples[option]}"
                raise InputError(f"{option} {' '.join(wanted)}: {missing} is missing; for example {example}")
            whole = option == "--axis"
            joined.append(f"{option}={BETWEEN.join(given)}" if whole else args[k])
            k += len(wanted) + (not equals) if whole else 1
        return list(super().parse_args(ctx, joined))


@command("freebeam map --alpha 1e-6 1e-1 100 --beta 1e-2 1 100 --output map.nc (.csv, .png, or --json)", Axes)
class Map(FileOptions, SearchOptions):
    """Compute the critical load over a grid of one parameter or more: dampings, or the column's own.

    Each point is the first loss of stability, with its kind, its frequency, and its error against the beam itself.
    Values of a damping have a constant ratio, values of another parameter a constant difference.
    """

    alpha: tuple[str, str, str] | None = option(WORDS["--alpha"], "Internal damping: first, last, how many values.")
    beta: tuple[str, str, str] | None = option(WORDS["--beta"], "External damping: first, last, how many values.")
    axis: list[str] | None = option(WORDS["--axis"], "Any parameter: alpha, beta or the column's own; may be repeated.")
    linear: bool = flag("Space the values of a damping evenly, not by a constant ratio.")
    no_convergence: bool = flag("Leave out the error against the beam itself, which takes most of the time.")
    chunks: int | None = option("K", "Compute in blocks of K values along each axis, in parallel (Dask).")
    workers: int | None = option("W", "With --chunks: number of processes; one a core if not given.")
    store: Path | None = option("FOLDER", "With --chunks: keep finished blocks here; a stopped run goes on from it.")
    output: Path | None = option("FILE.csv|.nc|.png", "Write a table, a NetCDF file, or a picture.")
    extra: list[str] | None = argument()

    def run(self) -> None:
        self.check()
        with ExitStack() as stack:
            # The file is begun before the work, so that what is in its way is said then.
            stream = None if self.output is None else stack.enter_context(written(self.output, self.force))
            report = stack.enter_context(working("map"))
            found = self.compute(report)
            arrays = self.arrays(found)
            if stream is not None:
                report("writing")
                stream.write(self.content(found, arrays))
        if self.as_json:
            record = self.record() | (self.axes | arrays if self.points <= MOST_PRINTED else {})
            print_json(record if self.output is None else {**record, "output": self.output, "points": self.points})
        else:
            fixed = (f"{name} = {value:g}" for name, value in self.fixed.items())
            title = ", ".join([self.chosen.name, f"N = {self.question.modes}", *fixed])
            print_table(self.rows(arrays), title=title)

    @cached_property
    def axes(self) -> dict[str, Any]:
        """The axes, each (COUNT,), by name, in the units of the input. Raises InputError."""
        named = [(name, given) for name, *given in (words.split(BETWEEN) for words in self.axis or ())]
        return _axes([("alpha", self.alpha), ("beta", self.beta), *named], self.linear)

    @property
    def points(self) -> int:
        return math.prod(map(len, self.axes.values()))

    @cached_property
    def question_and_axes(self) -> tuple[Question, dict[str, Any]]:
        """What is mapped, and over which values, nondimensional. Raises InputError."""
        from freebeam.maps.labelled import split

        own, limit = self.chosen.own_parameters(dict(self.assigned)), self.limit
        fixed = {name: value for name, value in own.items() if name not in self.axes}
        with self.units.in_errors():
            scaled = {name: self.units.into(name, axis) for name, axis in self.axes.items()}
            return split(self.chosen, self.modes, fixed | scaled, **limit)

    @property
    def question(self) -> Question:
        return self.question_and_axes[0]

    @property
    def fixed(self) -> dict[str, float]:
        """The column's own parameters that are no axes."""
        return {name: value for name, value in self.question.parameters.items() if name not in self.axes}

    def check(self) -> None:
        """Refuse what can be known to fail, before the work is done. Raises InputError."""
        takes = ", ".join(map(" ".join, WORDS.items()))
        for word in self.extra or ():
            refuse(True, f"{word}: belongs to no option; the axes are {takes}")
        if self.output is not None:
            refuse_output(self.output, [*map(len, self.axes.values())])
        elif self.as_json:
            most = f"JSON holds {MOST_PRINTED} at most; give --output FILE.csv or .nc"
            refuse(self.points > MOST_PRINTED, f"{self.points} points: {most}")
        for name in self.axes:
            given = f"--set {name}={self.assigned.get(name)}"
            refuse(name in self.assigned, f"{given}: {name} is an axis of this map; leave one of them out")
            sized = bool(self.beam) and name in (self.chosen.kernel.scales.__kwdefaults__ or ())
            why = f"{name}: is an axis on which the size of the load depends"
            refuse(sized, f"{why}; leave out the beam in SI units")
        for name in ("workers", "store"):
            alone = self.chunks is None and getattr(self, name) is not None
            refuse(alone, f"--{name} needs --chunks K, such as --chunks 100")
        _ = self.question  # whose mistakes are told before a file is begun

    def compute(self, report: Callable[[str], None]) -> Solved:
        """The map, nondimensional. Raises InputError."""
        from freebeam.maps.labelled import solved

        blocks: dict[str, Any] = {"chunks": self.chunks, "workers": self.workers, "store": self.store}
        with self.units.in_errors():
            return solved(
                *self.question_and_axes, not self.no_convergence, lambda share: report(f"{share:.0%}"), **blocks
            )

    def arrays(self, found: Solved) -> dict[str, Any]:
        """The map's values by name, in the units of the output."""
        import numpy as np

        from freebeam_sym.stability.convergence import KINDS

        load, frequency = (self.units.out(name, getattr(found.answers, name)) for name in ("load", "frequency"))
        arrays = {"load": load, "kind": np.array(KINDS)[found.answers.kind], "frequency": frequency}
        return arrays | ({} if found.error is None else {"error": found.error, "converged": found.converged})

    def record(self) -> dict[str, Any]:
        """What was asked, for JSON and for the head of a table."""
        from freebeam.maps.arrays import record

        return {
            **record(self.question),
            "parameters": self.fixed,
            **{name: 0.0 for name in ("alpha", "beta") if name not in self.axes},
            "load_max": self.units.out("load", self.question.load_max),
            "units": self.units.name,
        }

    def rows(self, arrays: dict[str, Any]) -> list[list[str]]:
        """The map in a few lines."""
        unit, load_max = self.units.of("load"), self.record()["load_max"]
        rows = [["points", " x ".join(f"{len(values)} {name}" for name, values in self.axes.items())]]
        for kind in ("flutter", "divergence", "none"):
            here = arrays["kind"] == kind
            if here.any():
                loads = arrays["load"][here]
                told = f", load {loads.min():.10g} to {loads.max():.10g}{unit}"
                rows.append([kind, f"{here.sum()} points{f' up to {load_max:.10g}{unit}' if kind == 'none' else told}"])
        if "converged" in arrays:
            rows.append(["not converged", f"{(~arrays['converged']).sum()} points"])
        return rows if self.output is None else [*rows, ["written", str(self.output)]]

    def content(self, found: Solved, arrays: dict[str, Any]) -> bytes:
        """The file that is to be written."""
        from freebeam.maps.labelled import dataset

        suffix = self.output and self.output.suffix
        if suffix == ".csv":
            return table_of("map", self.record(), self.axes, arrays)
        labelled = dataset(found)
        if self.units.sizes:
            labelled = self.in_si(labelled)
        return _picture(labelled) if suffix == ".png" else netcdf_of(labelled)

    def in_si(self, found: xarray.Dataset) -> xarray.Dataset:
        """A map in the units in which it was asked; the column's own parameters stay nondimensional."""
        units = self.units
        for name, values in self.axes.items():
            found = found.assign_coords({name: found[name].copy(data=values)})
        for name in ("load", "frequency"):
            found[name] = found[name].copy(data=units.out(name, found[name].values))
        for name in (*(x for x in self.axes if x in units.sizes), "load", "frequency"):
            found[name].attrs["units"] = units.of(name).strip()
        beam = {name: float(size) for name, size in self.beam.items()}
        found.attrs |= {"load_max": units.out("load", found.attrs["load_max"]), "units": units.name, **beam}
        return found


def _axes(ranges: Sequence[tuple[str, Sequence[str] | None]], linear: bool) -> dict[str, Any]:
    """The axes of a map, each (COUNT,), by name. Raises InputError."""
    import numpy as np

    from freebeam.maps.labelled import counted

    read: dict[str, tuple[float, float, int]] = {}
    for name, given in ranges:
        if given is not None:
            refuse(name in read, f"{name}: is an axis twice; leave one of them out")
            read[name] = range_of(name, given, linear)
    refuse(not read, "a map needs an axis, such as --alpha 1e-6 1e-1 100 or --axis eta 0.4 0.6 20")
    counted([number_of for _, _, number_of in read.values()])
    by_factor = {name for name in read if name in ("alpha", "beta") and not linear}
    return {name: (np.geomspace if name in by_factor else np.linspace)(*given) for name, given in read.items()}


def range_of(name: str, given: Sequence[str], linear: bool) -> tuple[float, float, int]:
    """First value, last value, how many, as typed. Raises InputError."""
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
    too_low = name in ("alpha", "beta") and (low < 0 or (low == 0 and not linear))
    cure = "damping is zero or greater" if linear else "a logarithmic axis starts above zero; or give --linear"
    refuse(too_low, f"{name}: LO = {given[0]}: {cure}")
    refuse(high < low or (high == low and number_of > 1), f"{name}: HI = {given[1]} must be above LO = {given[0]}")
    too_large = max(-low, high) >= LARGEST
    refuse(too_large, f"{name}: {given[0]} to {given[1]}: must be below 1e60 in size to be computed with")
    return low, high, number_of


def refuse_output(output: Path, counts: list[int]) -> None:
    """What can be known of a file that will not come about, before the work is done. Raises InputError."""
    refuse(output.suffix not in FORMATS, f"{output}: must end in {', '.join(FORMATS)}")
    kind, packages, extra = FORMATS[output.suffix]
    missing = [name for name in packages if find_spec(name) is None]
    are = f"{' and '.join(missing)}, which {'is' if len(missing) == 1 else 'are'} not installed"
    refuse(missing, f"a {kind} needs {are}: pip install 'freebeam[{extra}]'")
    drawn = output.suffix != ".png" or (len(counts) == 2 and min(counts) > 1)
    refuse(not drawn, "a picture needs two axes, and two values or more along each; or write a .csv or .nc file")


def table_of(command: str, head: dict[str, Any], axes: dict[str, Any], values: dict[str, Any]) -> bytes:
    """A line of settings, a comment after #, then a row a point; numbers read back as the same floats."""
    import numpy as np

    places = [mesh.ravel().tolist() for mesh in np.meshgrid(*axes.values(), indexing="ij")]
    columns = [*places, *(array.ravel().tolist() for array in values.values())]
    rows = (",".join(x if isinstance(x, str) else repr(x) for x in row) for row in zip(*columns, strict=True))
    settings = json.dumps(plain(head), ensure_ascii=False)
    return "\n".join([f"# freebeam {command} {settings}", ",".join([*axes, *values]), *rows, ""]).encode()


def netcdf_of(found: xarray.Dataset) -> bytes:
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
