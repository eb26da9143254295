"""`freebeam pulse`."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, ClassVar

from freebeam.cli.application import command
from freebeam.cli.mapping import MOST_PRINTED, Axes, netcdf_of, range_of, refuse_output, table_of
from freebeam.cli.options import REQUIRED, CaseOptions, FileOptions, Number, option, refuse
from freebeam.cli.output import plain, print_json, print_table, working, written

if TYPE_CHECKING:
    from freebeam.pulsating.growth import PulsatingRegion, PulsatingRegions

Range = tuple[str, str, str]


class Ranges(Axes):
    """The command whose axes are frequency and amplitude."""

    words: ClassVar = {"--frequency": "LO HI COUNT", "--amplitude": "LO HI COUNT"}
    examples: ClassVar = {"--frequency": "3 40 100", "--amplitude": "0 0.8 60"}


@command(
    "freebeam pulse --column beck --load 12 --beta 0.1 --frequency 3 40 100 --amplitude 0 0.8 60 --output regions.png",
    Ranges,
)
class Pulse(FileOptions, CaseOptions):
    """Find where motion grows when the load pulsates: P (1 + eps cos(Omega t)).

    For each frequency Omega and amplitude eps: how the motion grows in a period of the load, and the kind of growth.
    principal-2T: one mode, with twice the period of the load (Omega near 2 omega_j). principal-T: one mode, with the
    period of the load (Omega near omega_j). combination: two modes (Omega near omega_i + omega_j or omega_i - omega_j).
    A region that is narrower than the distance of two frequencies may be missed.
    """

    load: Number = option("P", "The mean load P.", default=REQUIRED)
    frequency: Range = option("LO HI COUNT", "Frequency Omega: first, last, how many values.", default=REQUIRED)
    amplitude: Range = option("LO HI COUNT", "Amplitude eps, a share of P: first, last, how many.", default=REQUIRED)
    output: Path | None = option("FILE.csv|.nc|.png", "Write a table, a NetCDF file, or a picture.")

    def run(self) -> None:
        self.check()
        with ExitStack() as stack:
            # The file is begun before the work, so that what is in its way is said then.
            stream = None if self.output is None else stack.enter_context(written(self.output, self.force))
            report = stack.enter_context(working("pulse"))
            found = self.compute(report)
            report("ends of the regions")
            with self.units.in_errors():
                regions = found.at(float(found.amplitude[-1]))
            if stream is not None:
                report("writing")
                stream.write(self.content(found))
        if self.as_json:
            print_json(self.whole(found, regions))
            return
        print_table(self.rows(found), title=self.title(load=f"{self.load}{self.units.of('load')}"))
        if regions:
            unit = self.units.of("frequency")
            header = [f"from{unit}", f"to{unit}", "kind", "largest growth in a period"]
            title = f"Regions at the amplitude {found.amplitude[-1]:g}"
            print_table([self.row(region) for region in regions], header, title)

    @cached_property
    def axes(self) -> dict[str, Any]:
        """Frequencies and amplitudes, in the units of the input. Raises InputError."""
        import numpy as np

        given = {"frequency": self.frequency, "amplitude": self.amplitude}
        axes = {name: range_of(name, words, True) for name, words in given.items()}
        for name, words in given.items():
            zero = "is a share of the load; it must be 0 or greater" if name == "amplitude" else "must be above 0"
            low = axes[name][0]
            refuse(low < 0 or (low == 0 and name == "frequency"), f"{name}: LO = {words[0]}: {zero}")
        return {name: np.linspace(*values) for name, values in axes.items()}

    @property
    def points(self) -> int:
        return len(self.axes["frequency"]) * len(self.axes["amplitude"])

    def check(self) -> None:
        """Refuse what can be known to fail, before the work is done. Raises InputError."""
        counts = [len(axis) for axis in self.axes.values()]
        if self.output is not None:
            refuse_output(self.output, counts)
        elif self.as_json:
            most = f"JSON holds {MOST_PRINTED} at most; give --output FILE.csv or .nc"
            refuse(self.points > MOST_PRINTED, f"{self.points} points: {most}")
        refuse(not float(self.load), f"load = {self.load}: must differ from 0: the amplitude is a share of it")
        _ = self.question  # whose mistakes are told before a file is begun

    def compute(self, report: Callable[[str], None]) -> PulsatingRegions:
        """The regions, nondimensional. Raises InputError."""
        from freebeam.pulsating.growth import grid

        load, frequency = (
            self.units.into(x, v) for x, v in (("load", self.load), ("frequency", self.axes["frequency"]))
        )
        with self.units.in_errors():
            return grid(
                self.question, float(load), frequency, self.axes["amplitude"], lambda share: report(f"{share:.0%}")
            )

    def settings(self, found: PulsatingRegions) -> dict[str, Any]:
        """What was asked, and what holds of all points: for JSON and for the head of a table."""
        return self.record(load=self.load, error=found.error, grows_under_the_constant_load=found.constant_grows)

    def whole(self, found: PulsatingRegions, regions: tuple[PulsatingRegion, ...]) -> dict[str, Any]:
        """All of it for JSON."""
        out = self.units.out
        told = [{**r._asdict(), "low": out("frequency", r.low), "high": out("frequency", r.high)} for r in regions]
        record = self.settings(found) | {"regions": {"amplitude": found.amplitude[-1], "found": told}}
        if self.output is not None:
            return record | {"output": self.output, "points": self.points}
        return record | self.axes | found.table()

    def rows(self, found: PulsatingRegions) -> list[list[str]]:
        """The grid in a few lines."""
        from freebeam.pulsating.growth import KINDS

        rows = [["points", " x ".join(f"{len(values)} {name}" for name, values in self.axes.items())]]
        for number, kind in enumerate(KINDS):
            here = found.kind == number
            if here.any():
                grows = f", growth in a period up to {found.growth[here].max():.4g}" if number else ""
                rows.append([kind, f"{here.sum()} points{grows}"])
        if found.constant_grows:
            rows.append(["without pulsation", f"motion grows at the load {self.load}{self.units.of('load')} too"])
        rows.append(["error", f"{found.error:.1e} of the monodromy matrix, estimated"])
        return rows if self.output is None else [*rows, ["written", str(self.output)]]

    def row(self, region: PulsatingRegion) -> list[str]:
        """A region as a line of the table."""
        ends = (self.units.out("frequency", x) for x in (region.low, region.high))
        told = ["beyond the range" if x is None else f"{x:.10g}" for x in ends]
        return [*told, region.kind, f"{region.growth:.4g}"]

    def content(self, found: PulsatingRegions) -> bytes:
        """The file that is to be written."""
        suffix = self.output and self.output.suffix
        if suffix == ".csv":
            return table_of("pulse", plain(self.settings(found)), self.axes, found.table())
        return self.picture(found) if suffix == ".png" else netcdf_of(self.labelled(found))

    def labelled(self, found: PulsatingRegions) -> Any:
        """The grid with labels, in the units in which it was asked; the column's own parameters stay nondimensional."""
        labelled, units = found.dataset(), self.units
        if not units.sizes:
            return labelled
        labelled = labelled.assign_coords(frequency=labelled["frequency"].copy(data=self.axes["frequency"]))
        labelled["frequency"].attrs["units"] = units.SYMBOLS["frequency"]
        beam = {name: float(size) for name, size in self.beam.items()}
        dampings = {name: float(value) for name, value in self.dampings.items()}
        labelled.attrs |= {"load": float(self.load), "units": units.name, **dampings, **beam}
        return labelled

    def picture(self, found: PulsatingRegions) -> bytes:
        """The regions drawn, as the bytes of a PNG file."""
        from matplotlib.figure import Figure

        from freebeam.figures import pulsating_regions
        from freebeam.figures.saving import image_of

        title = fill(self.title(load=f"{self.load}{self.units.of('load')}"), 80)
        size, unit = self.units.out("frequency", 1.0), self.units.of("frequency").strip()
        drawn = pulsating_regions(found, title=title, size=size, unit=unit).figure
        assert isinstance(drawn, Figure)
        return image_of(drawn, "png")
