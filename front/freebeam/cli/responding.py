"""`freebeam respond`."""

from __future__ import annotations

import io
import json
import math
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Callable
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from freebeam.cli.application import command
from freebeam.cli.options import REQUIRED, CaseOptions, FileOptions, Number, argument, flag, option, refuse
from freebeam.cli.output import plain, print_json, print_table, working, write_picture, written

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from freebeam.cli.outline import Outline
    from freebeam_sym.columns import System
    from freebeam_sym.response.results import Response

ROWS = 200  # a response of more is told by a summary and a plot
QUANTITIES = ("y", "dy", "ddy")
TYPED = {
    "force_amplitude": "force", "force_frequency": "frequency", "force_position": "length",
    "initial_amplitude": "length", "initial_velocity": "velocity",
}  # fmt: skip
"""Options that are numbers, each with its quantity; None where not given."""

Series = dict[str, Any]
"""t (times,) and quantities (times, sensors) by name, in the units of the output; a response or a part of it."""


@command("freebeam respond --load 9 --alpha 1e-3 --beta 0.1 --duration 20 --step 0.01 --sensor 0.1")
class Respond(FileOptions, CaseOptions):
    """Compute the response in time at sensors, from an initial state or to a sinusoidal force.

    Without a force and an initial state, mode 1 starts with q = 0.01.
    Modes are normalised as in Eq. (22), those of polynomials to unit modal mass.
    Without --output, a response of up to 200 rows is printed as a table, a longer one as a summary and a plot.
    """

    load: Number = option("P", "The load P.", default=REQUIRED)
    duration: Number = option("T", "Duration of the response.", default=REQUIRED)
    step: Number = option("H", "Time step.", default=REQUIRED)
    rigid: bool = flag("Include the rigid-body functions.")
    sensor: list[Number] | None = option("X ...", "Positions of sensors along the beam; 0.1 L if not given.")
    more_sensors: list[Number] | None = argument()
    force_amplitude: Number | None = option("F", "Amplitude F of a force F sin(w t).")
    force_frequency: Number | None = option("w", "Angular frequency w of the force.")
    force_position: Number | None = option("X", "Position of the force; at L if not given.")
    initial_mode: int | None = option("K", "Start in mode K; 1 is the lowest elastic mode.")
    initial_amplitude: Number | None = option("A", "Coordinate q of that mode at t = 0.")
    initial_velocity: Number | None = option("V", "Rate dq/dt of that mode at t = 0.")
    quantity: list[str] | None = option("y|dy|ddy", "Displacement, velocity, acceleration; all three if not given.")
    field: str | None = option("NAME", "The field or coordinate that sensors read as y; the deflection if not given.")
    derivative: int = option("D", "Its derivative by x that they read, such as 1 for the slope.", default=0)
    method: str = option(
        "exact|newmark",
        "exact: the step only says how often the response is sampled. newmark: average acceleration, as in the paper; "
        "the step also decides the error, which is estimated.",
        default="exact",
    )
    output: Path | None = option(
        "FILE",
        "Write a .csv or .npz file, part by part, so that the response may be long. A .csv begins with a line of "
        "settings, a comment after #, and then the names of the columns.",
    )

    plot: Path | None = option("FILE.svg|.png|.pdf", "Draw what the sensors read over time.")

    def run(self) -> None:
        self.check()
        if self.plot:
            with working("picture"):
                write_picture(self.plot, self.force, self.drawn, self.title(load=str(self.load)))
        few, record = self.outline.count <= ROWS, self.settings()
        if self.output is None:
            found = self.compute()
            series = self.series(found)
            record |= self.facts(found)
            if few and not self.as_json:
                write_csv(sys.stdout, self, series)
            record_of_all = record | series
        else:
            with written(self.output, self.force) as stream:
                record |= (self.write_npz if self.output.suffix == ".npz" else self.write_csv)(stream)
            record_of_all = {**record, "output": self.output, **self.outline.record()}
        if self.as_json:
            print_json(record_of_all)
            return
        if self.output is not None or not few:
            self.print_outline(record)
        for warning in record["warnings"]:
            print(f"warning: {warning}", file=sys.stderr)

    def check(self) -> None:
        """Refuse options that contradict one another. Raises InputError."""
        from freebeam_sym.checks import positive

        forced, output = self.force_amplitude is not None, self.output
        for word in self.more_sensors or ():
            refuse(not self.sensor, f"{word}: belongs to no option; positions of sensors follow --sensor")
        refuse(output and output.suffix not in (".csv", ".npz"), f"{output}: the name must end in .csv or .npz")
        refuse(self.plot and self.beam, "--plot: is nondimensional; leave out the beam in SI units")
        told = f"{self.measured}: no dimensional statement gives this coordinate an SI unit"
        refuse(self._length is None, f"{told}; leave the beam's SI values out")
        both = "--force-amplitude and --force-frequency"
        refuse(forced != (self.force_frequency is not None), f"a force needs both {both}")
        refuse(not forced and self.force_position, f"--force-position: there is no force; give {both}")
        for name in self.quantity or ():
            refuse(name not in QUANTITIES, f"--quantity {name}: must be one of {', '.join(QUANTITIES)}")
        refuse(self.method not in ("exact", "newmark"), f"--method {self.method}: must be exact or newmark")
        positive("duration", self.duration)
        positive("step", self.step)
        _ = self.system  # whose mistakes are told before a file is begun
        end = self.units.say("length", 1.0, ".6g")
        for name, x in [*(("--sensor", x) for x in self.places), ("--force-position", self.force_position)]:
            outside = x is not None and not 0 <= self.units.into("length", x) <= 1
            refuse(outside, f"{name} {x}: must be from 0 to {end}, the beam's length")

    @property
    def places(self) -> list[Number]:
        return [*(self.sensor or ()), *(self.more_sensors or ())]

    @property
    def sensors(self) -> list[float]:
        return [self.units.into("length", x) for x in self.places] or [0.1]

    @property
    def names(self) -> list[str]:
        return [name for name in QUANTITIES if not self.quantity or name in self.quantity]

    @cached_property
    def columns(self) -> list[tuple[str, str]]:
        """(name, label of a sensor) of each series of numbers."""
        labels = [str(x) for x in self.places] or [f"{self.units.out('length', 0.1):.6g}"]
        return [(name, label) for label in labels for name in self.names]

    @property
    def measured(self) -> str:
        """The field or coordinate that sensors read."""
        return self.field or self.question.column.unknowns[0]

    @property
    def _length(self) -> int | None:
        """The power of a length that is read, 0 of an angle; None of a coordinate of which that is not known."""
        column, read = self.chosen, self.measured
        if read in column.fields or read not in column.unknowns or not self.units.sizes:
            joined = {field["name"]: field["joined"] for field in column.kernel.COLUMN.get("fields", ())}
            return int(read == "y" or joined.get(read) == 2) - self.derivative
        unit = column.kernel.COLUMN.get("quantities", {}).get(read, {}).get("unit")
        return {"m": 1, "1": 0}.get(unit)

    def out(self, name: str, value: Any) -> Any:
        """What is read as y, dy or ddy, in the units of the output."""
        length, time = self.units.out("length", 1.0), self.units.out("time", 1.0)
        return value * length ** (self._length or 0) / time ** QUANTITIES.index(name)

    def unit(self, name: str) -> str:
        """Its unit, for print; empty where nondimensional."""
        power, rate = self._length or 0, QUANTITIES.index(name)
        above = {0: "rad", 1: "m"}.get(power, "1" if power < 0 else f"m^{power}")
        below = [s + (f"^{n}" if n > 1 else "") for s, n in (("m", -power), ("s", rate)) if n > 0]
        under = "" if not below else f"/{below[0]}" if len(below) == 1 else f"/({' '.join(below)})"
        return f" {above}{under}" if self.units.sizes else ""

    def series_name(self, name: str, label: str) -> str:
        """What a column of numbers is called, such as y(0.1); a coordinate has no place."""
        there = self.measured in self.question.column.fields
        return self.read(name) + (f"({label})" if there else "")

    @property
    def span(self) -> tuple[float, float]:
        """Duration and step, nondimensional."""
        return self.units.into("time", self.duration), self.units.into("time", self.step)

    @cached_property
    def system(self) -> System:
        return self.question.system(self.units.into("load", self.load), self.rigid)

    def read(self, name: str) -> str:
        """What sensors read, y, dy or ddy, by its own name, such as dq or y'."""
        return name.replace("y", self.measured + "'" * self.derivative)

    @property
    def most_modes(self) -> int:
        return len(self.system.M) - self.system.rigid_count

    @cached_property
    def outline(self) -> Outline:
        """What the response looks like, of the parts that have been computed."""
        from freebeam.cli.outline import Outline
        from freebeam_sym.response.inputs import times_of

        with self.units.in_errors():
            return Outline(self.step.exact, times_of(*self.span), self.columns)

    @property
    def force_and_start(self) -> dict[str, Any]:
        """The arguments of `fb.respond` for a force and an initial state. Raises InputError."""
        import freebeam as fb
        from freebeam_sym.checks import count

        typed = {name: getattr(self, name) for name in TYPED}
        values = {name: self.units.into(TYPED[name], value) for name, value in typed.items() if value is not None}
        given: dict[str, Any] = {}
        if "force_amplitude" in values:
            given["force"] = fb.Harmonic(values["force_amplitude"], values["force_frequency"])
            given["force_position"] = values.get("force_position", 1.0)
        if self.initial_mode is not None or {"initial_amplitude", "initial_velocity"} & set(values):
            k = count("--initial-mode", 1 if self.initial_mode is None else self.initial_mode, high=self.most_modes)
            # without an amplitude, a mode that is given a velocity starts from its place at rest
            amplitude = values.get("initial_amplitude", 0.0 if "initial_velocity" in values else 0.01)
            given["initial"] = amplitude * self.system.mode(k)
            given["initial_velocity"] = values.get("initial_velocity", 0.0) * self.system.mode(k)
        return given

    def compute(self, target: Callable[[Series], None] | None = None) -> Response:
        """The response; with a target, which is handed its parts one after the other, without its series."""
        import freebeam as fb

        with working("response") as report, self.units.in_errors():
            return fb.respond(
                self.system, *self.span, sensors=self.sensors, outputs=self.names, method=self.method,
                field=self.field or "", derivative=self.derivative,
                target=None if target is None else lambda part: target(self.series(part)),
                progress=lambda share: report(f"{share:.0%}"), **self.force_and_start,
            )  # fmt: skip

    def drawn(self) -> Figure:
        """A row for each quantity, a curve for each sensor."""
        from freebeam import figures
        from freebeam.figures.look import figure
        from freebeam.figures.marks import colour

        found, drawn = self.compute(), figure((7.0, 2.4 * len(self.names)))
        labels = list(dict.fromkeys(f"x = {label}" for _, label in self.columns))
        for ax, name in zip(drawn.subplots(len(self.names), squeeze=False).ravel(), self.names, strict=True):
            for k, label in enumerate(labels):
                figures.history(found, name, sensor=k, label=label, color=colour(k), ax=ax)
            if len(labels) > 1:
                ax.legend(frameon=False)
        return drawn

    def series(self, part: Any) -> Series:
        """A response, or a part of it, in the units of the output; its outline is drawn on."""
        import numpy as np

        from freebeam_sym.response.inputs import moments

        found = {name: self.out(name, getattr(part, name)) for name in self.names}
        self.outline.take(part.begin, np.stack([*found.values()], axis=-1).reshape(part.end - part.begin, -1))
        return {"t": moments(self.step.exact, part.begin, part.end), **found}

    def settings(self) -> dict[str, Any]:
        """What was asked, for JSON and for the head of a file."""
        return self.record(
            load=self.load, rigid=self.rigid, duration=self.duration, step=self.step, method=self.method,
            sensors=self.places or self.sensors, **{name: getattr(self, name) for name in TYPED},
            initial_mode=self.initial_mode, field=self.measured, derivative=self.derivative,
            unit={"t": self.units.of("time").strip()} | {name: self.unit(name).strip() for name in QUANTITIES},
        )  # fmt: skip

    def facts(self, found: Response) -> dict[str, Any]:
        """What the response says of itself, for JSON."""
        kept = {name: getattr(found, name) for name in ("period_error", "phase_error", "samples_per_period")}
        warnings = [warning.told(self.units.say) for warning in found.warnings]
        return {**kept, "growth": self.units.out("frequency", found.growth), "warnings": warnings}

    def write_csv(self, stream: IO[bytes]) -> dict[str, Any]:
        """Write the response as it is computed; what it says of itself comes back."""
        text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
        text.write(f"# freebeam respond {json.dumps(plain(self.settings()), ensure_ascii=False)}\n")
        found = self.compute(lambda part: write_csv(text, self, part))
        text.detach()
        return self.facts(found)

    def write_npz(self, stream: IO[bytes]) -> dict[str, Any]:
        """The same. Each array grows in a file of its own until its length is known, and is not held in memory."""
        import numpy as np

        folder = self.output.parent if self.output else None
        with ExitStack() as stack:
            files = {name: stack.enter_context(tempfile.TemporaryFile(dir=folder)) for name in ("t", *self.names)}

            def keep(part: Series) -> None:
                for name, array in part.items():
                    files[name].write(memoryview(array).cast("B"))

            facts = self.facts(self.compute(keep))
            with zipfile.ZipFile(stream, "w") as archive:
                for name, file in files.items():
                    shape = (self.outline.count,) if name == "t" else (self.outline.count, len(self.sensors))
                    header = {"descr": np.dtype(float).str, "fortran_order": False, "shape": shape}
                    file.seek(0)
                    with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                        np.lib.format.write_array_header_1_0(member, header)
                        shutil.copyfileobj(file, member)
                for name, value in (
                    ("sensors", self.sensors),
                    ("settings", json.dumps(plain(self.settings() | facts))),
                ):
                    with archive.open(f"{name}.npy", "w") as member:
                        np.lib.format.write_array(member, np.asarray(value))
        return facts

    def print_outline(self, record: dict[str, Any]) -> None:
        """Print rows, peaks, settling and what the step does, of what was written or would have been; without a file a
        plot too."""
        outline, units, output = self.outline, self.units, self.output
        end = outline.time(outline.count - 1)
        span = f"{outline.count}, t = 0 to {end:g}{units.of('time')}, step {record['step']}{units.of('time')}"
        rows = [("rows", span)]
        if output is not None:
            rows.append(("written to", str(output)))
        for told in outline.record()["peaks"]:
            name = self.series_name(told["quantity"], told["sensor"])
            unit, time = self.unit(told["quantity"]), units.of("time")
            settled = "no" if told["settled"] is None else f"from t = {told['settled']:.6g}{time} on"
            rows.append(
                (name, f"peak {told['peak']:.6g}{unit} at t = {told['t']:.6g}{time}; below 2 % of it: {settled}")
            )
        step = f"{record['method']}; "
        if record["method"] == "newmark":
            step += f"out of phase by about {record['phase_error']:.2g} rad; "
        samples = record["samples_per_period"]
        step += (
            f"{samples:.3g} samples a period of the fastest mode that carries the motion" if samples < math.inf else ""
        )
        print_table([*rows, ("method", step)], title=self.title(load=f"{self.load}{units.of('load')}"))
        if output is None:
            units_of = {name: unit and f", {unit}" for name, unit in record["unit"].items()}
            units_of["t"] = units.of("time")
            lines = outline.plot(self.series_name(*self.columns[0]) + units_of[self.names[0]], units_of["t"])
            sys.stdout.write("".join(f"{line}\n" for line in lines))


def write_csv(stream: IO[str], asked: Respond, series: Series) -> None:
    """Write a response, or a part of it, as CSV; numbers are written so that they read back as the same floats."""
    import numpy as np

    t, *quantities = series.values()
    if t[0] == 0:
        named = [("t", asked.units.of("time")), *((asked.series_name(n, x), asked.unit(n)) for n, x in asked.columns)]
        heads = (name + (f" [{unit.strip()}]" if unit else "") for name, unit in named)
        stream.write(",".join(heads) + "\n")
    table = np.stack(quantities, axis=-1).reshape(len(t), -1)
    for moment, row in zip(t.tolist(), table, strict=True):
        stream.write(",".join(map(repr, [moment, *row.tolist()])) + "\n")
