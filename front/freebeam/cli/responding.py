"""`freebeam respond`."""

from __future__ import annotations

import io
import json
import math
import sys
import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import MISSING, dataclass
from functools import cached_property
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from freebeam.cli.application import command
from freebeam.cli.options import (
    Case,
    CaseOptions,
    FileOptions,
    Number,
    Units,
    argument,
    flag,
    number,
    option,
    quantity,
    refuse,
)
from freebeam.cli.output import plain, print_json, print_table, working, written

if TYPE_CHECKING:
    from freebeam.cli.outline import Outline
    from freebeam_sym.columns import System
    from freebeam_sym.response.results import Response

ROWS = 200  # a response of more is told by a summary and a plot
QUANTITIES = {"y": "length", "dy": "velocity", "ddy": "acceleration"}
TYPED = {
    "force_amplitude": "force", "force_frequency": "frequency", "force_position": "length",
    "initial_amplitude": "length", "initial_velocity": "velocity",
}  # fmt: skip
"""Options that are numbers, each with its quantity; None where not given."""

Series = dict[str, Any]
"""t (times,) and quantities (times, sensors) by name, in the units of the output; a response or a part of it."""


@dataclass(frozen=True, kw_only=True)
class Respond(FileOptions, CaseOptions):
    """The question, force and initial state, and what is told of the response."""

    load: Number = quantity("P", "The load P.", default=MISSING)
    duration: Number = quantity("T", "Duration of the response.", default=MISSING)
    step: Number = quantity("H", "Time step.", default=MISSING)
    rigid: bool = flag("Include the rigid-body functions.")
    sensor: list[Number] | None = quantity("X ...", "Positions of sensors along the beam; 0.1 L if not given.")
    more_sensors: list[Number] | None = argument(parser=number, hidden=True)
    force_amplitude: Number | None = quantity("F", "Amplitude F of a force F sin(w t).")
    force_frequency: Number | None = quantity("w", "Angular frequency w of the force.")
    force_position: Number | None = quantity("X", "Position of the force; at L if not given.")
    initial_mode: int | None = option("K", "Start in mode K; 1 is the lowest elastic mode.")
    initial_amplitude: Number | None = quantity("A", "Coordinate q of that mode at t = 0.")
    initial_velocity: Number | None = quantity("V", "Rate dq/dt of that mode at t = 0.")
    quantity: list[str] | None = option("y|dy|ddy", "Displacement, velocity, acceleration; all three if not given.")
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


@dataclass(frozen=True)
class Run:
    """What is computed: a system's response at sensors, with what `fb.respond` takes for its force and its start."""

    asked: Respond
    case: Case
    system: System
    places: list[Number]
    given: dict[str, Any]

    @property
    def names(self) -> list[str]:
        return [name for name in QUANTITIES if not self.asked.quantity or name in self.asked.quantity]

    @property
    def sensors(self) -> list[float]:
        return [self.case.units.into("length", x) for x in self.places] or [0.1]

    @property
    def columns(self) -> list[tuple[str, str]]:
        """(name, label of a sensor) of each series of numbers."""
        labels = [str(x) for x in self.places] or [f"{self.case.units.out('length', 0.1):.6g}"]
        return [(name, label) for label in labels for name in self.names]

    @cached_property
    def outline(self) -> Outline:
        """What the response looks like, of the parts that have been computed."""
        from freebeam.cli.outline import Outline
        from freebeam_sym.response.inputs import times_of

        with self.case.units.in_errors():
            times = times_of(*self.duration_and_step)
        return Outline(self.asked.step.exact, times, self.columns)

    @property
    def duration_and_step(self) -> tuple[float, float]:
        into = self.case.units.into
        return into("time", self.asked.duration), into("time", self.asked.step)

    def record(self) -> dict[str, Any]:
        """What was asked, for JSON and for the head of a file."""
        asked, units = self.asked, self.case.units
        return self.case.record(
            load=asked.load, rigid=asked.rigid, duration=asked.duration, step=asked.step, method=asked.method,
            sensors=self.places or self.sensors, **{name: getattr(asked, name) for name in TYPED},
            initial_mode=asked.initial_mode,
            unit={name: units.of(kind).strip() for name, kind in {"t": "time", **QUANTITIES}.items()},
        )  # fmt: skip

    def series(self, part: Any) -> Series:
        """A response, or a part of it, in the units of the output; its outline is drawn on."""
        import numpy as np

        from freebeam_sym.response.inputs import moments

        found = {name: self.case.units.out(QUANTITIES[name], getattr(part, name)) for name in self.names}
        self.outline.take(part.begin, np.stack([*found.values()], axis=-1).reshape(part.end - part.begin, -1))
        return {"t": moments(self.asked.step.exact, part.begin, part.end), **found}

    def facts(self, found: Response) -> dict[str, Any]:
        """What the response says of itself, for JSON."""
        units = self.case.units
        return {
            "period_error": found.period_error,
            "phase_error": found.phase_error,
            "samples_per_period": found.samples_per_period,
            "growth": units.out("frequency", found.growth),
            "warnings": [warning.told(units.say) for warning in found.warnings],
        }


@command(Respond, "freebeam respond --load 9 --alpha 1e-3 --beta 0.1 --duration 20 --step 0.01 --sensor 0.1")
def respond(asked: Respond) -> None:
    """Compute the response in time at sensors, from an initial state or to a sinusoidal force.

    Without a force and an initial state, mode 1 starts with q = 0.01 (modes normalised as in Eq. (22)).
    Without --output, a response of up to 200 rows is printed as a table, a longer one as a summary and a plot.
    """
    run = _ask(asked)
    few = run.outline.count <= ROWS
    record = run.record()
    if asked.output is None:
        found = _compute(run)
        record |= run.facts(found)
        if asked.as_json:
            print_json(record | run.series(found))
        elif few:
            write_csv(sys.stdout, run, run.series(found))
        else:
            run.series(found)
    else:
        with written(asked.output, asked.force) as stream:
            record |= (_write_npz if asked.output.suffix == ".npz" else _write_csv)(stream, run, record)
        if asked.as_json:
            print_json({**record, "output": asked.output, **run.outline.record()})
    if asked.as_json:
        return
    if asked.output is not None or not few:
        print_outline(run, record)
    for warning in record["warnings"]:
        print(f"warning: {warning}", file=sys.stderr)


def _ask(asked: Respond) -> Run:
    """What is to be computed; options that contradict one another are refused. Raises InputError."""
    from freebeam_sym.checks import positive

    forced, output, strays = asked.force_amplitude is not None, asked.output, asked.more_sensors or []
    if not asked.sensor:
        refuse(strays, f"{[*strays, ''][0]}: belongs to no option; positions of sensors follow --sensor")
    refuse(output and output.suffix not in (".csv", ".npz"), f"{output}: the name must end in .csv or .npz")
    both = "--force-amplitude and --force-frequency"
    refuse(forced != (asked.force_frequency is not None), f"a force needs both {both}")
    refuse(not forced and asked.force_position, f"--force-position: there is no force; give {both}")
    for name in asked.quantity or ():
        refuse(name not in QUANTITIES, f"--quantity {name}: must be one of {', '.join(QUANTITIES)}")
    refuse(asked.method not in ("exact", "newmark"), f"--method {asked.method}: must be exact or newmark")
    positive("duration", asked.duration)
    positive("step", asked.step)
    case = asked.case()
    units = case.units
    system = case.question.system(units.into("load", asked.load), asked.rigid)
    places = [*(asked.sensor or ()), *strays]
    end = units.say("length", 1.0, ".6g")
    for name, x in [*(("--sensor", x) for x in places), ("--force-position", asked.force_position)]:
        outside = x is not None and not 0 <= units.into("length", x) <= 1
        refuse(outside, f"{name} {x}: must be from 0 to {end}, the beam's length")
    return Run(asked, case, system, places, _force_and_start(asked, units, system))


def _force_and_start(asked: Respond, units: Units, system: System) -> dict[str, Any]:
    """The arguments of `fb.respond` for a force and an initial state. Raises InputError."""
    import freebeam as fb
    from freebeam_sym.checks import count

    typed = {name: getattr(asked, name) for name in TYPED}
    values = {name: units.into(TYPED[name], value) for name, value in typed.items() if value is not None}
    given: dict[str, Any] = {}
    if "force_amplitude" in values:
        given["force"] = fb.Harmonic(values["force_amplitude"], values["force_frequency"])
        given["force_position"] = values.get("force_position", 1.0)
    if asked.initial_mode is not None or {"initial_amplitude", "initial_velocity"} & set(values):
        k = count("--initial-mode", 1 if asked.initial_mode is None else asked.initial_mode, high=system.modes)
        mode = system.mode(k)
        # without an amplitude, a mode that is given a velocity starts from its place at rest
        amplitude = values.get("initial_amplitude", 0.0 if "initial_velocity" in values else 0.01)
        given |= {"initial": amplitude * mode, "initial_velocity": values.get("initial_velocity", 0.0) * mode}
    return given


def _compute(run: Run, target: Callable[[Series], None] | None = None) -> Response:
    """The response; with a target, which is handed its parts one after the other, without its series."""
    import freebeam as fb

    with working("response") as report, run.case.units.in_errors():
        return fb.respond(
            run.system, *run.duration_and_step, sensors=run.sensors, outputs=run.names, method=run.asked.method,
            target=None if target is None else lambda part: target(run.series(part)),
            progress=lambda share: report(f"{share:.0%}"), **run.given,
        )  # fmt: skip


def _write_csv(stream: IO[bytes], run: Run, record: dict[str, Any]) -> dict[str, Any]:
    """Write the response as it is computed; what it says of itself comes back."""
    text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
    text.write(f"# freebeam respond {json.dumps(plain(record), ensure_ascii=False)}\n")
    found = _compute(run, lambda part: write_csv(text, run, part))
    text.detach()
    return run.facts(found)


def _write_npz(stream: IO[bytes], run: Run, record: dict[str, Any]) -> dict[str, Any]:
    """As `_write_csv`. Each array grows in a file of its own until its length is known, and is not held in memory."""
    import numpy as np

    folder = run.asked.output.parent if run.asked.output else None
    with ExitStack() as stack:
        files = {name: stack.enter_context(tempfile.TemporaryFile(dir=folder)) for name in ("t", *run.names)}

        def keep(part: Series) -> None:
            for name, array in part.items():
                files[name].write(memoryview(array).cast("B"))

        facts = run.facts(_compute(run, keep))
        for file in files.values():
            file.flush()
        arrays: Series = {name: np.memmap(file, dtype=float, mode="r") for name, file in files.items()}
        arrays |= {name: arrays[name].reshape(-1, len(run.sensors)) for name in run.names}
        np.savez(stream, sensors=run.sensors, settings=json.dumps(plain(record | facts)), **arrays)
    return facts


def print_outline(run: Run, record: dict[str, Any]) -> None:
    """Print what was written, or would have been: rows, peaks, settling, what the step does; and a plot, unless there
    is a file."""
    outline, units, output = run.outline, run.case.units, run.asked.output
    end = outline.time(outline.count - 1)
    span = f"{outline.count}, t = 0 to {end:g}{units.of('time')}, step {record['step']}{units.of('time')}"
    rows = [("rows", span)]
    if output is not None:
        rows.append(("written to", str(output)))
    for told in outline.record()["peaks"]:
        name = f"{told['quantity']}({told['sensor']})"
        unit, time = units.of(QUANTITIES[told["quantity"]]), units.of("time")
        settled = "no" if told["settled"] is None else f"from t = {told['settled']:.6g}{time} on"
        rows.append((name, f"peak {told['peak']:.6g}{unit} at t = {told['t']:.6g}{time}; below 2 % of it: {settled}"))
    step = f"{record['method']}; "
    if record["method"] == "newmark":
        step += f"out of phase by about {record['phase_error']:.2g} rad; "
    samples = record["samples_per_period"]
    step += f"{samples:.3g} samples a period of the fastest mode that carries the motion" if samples < math.inf else ""
    print_table([*rows, ("method", step)], title=run.case.title(load=f"{run.asked.load}{units.of('load')}"))
    if output is None:
        units_of = {name: unit and f", {unit}" for name, unit in record["unit"].items()}
        units_of["t"] = units.of("time")
        sys.stdout.write("".join(f"{line}\n" for line in outline.plot(units_of)))


def write_csv(stream: IO[str], run: Run, series: Series) -> None:
    """Write a response, or a part of it, as CSV; numbers are written so that they read back as the same floats."""
    import numpy as np

    t, *quantities = series.values()
    if t[0] == 0:
        units = run.case.units
        kinds = [("t", "time"), *((f"{name}({x})", QUANTITIES[name]) for name, x in run.columns)]
        heads = (name + (f" [{units.of(kind).strip()}]" if units.sizes else "") for name, kind in kinds)
        stream.write(",".join(heads) + "\n")
    table = np.stack(quantities, axis=-1).reshape(len(t), -1)
    for moment, row in zip(t.tolist(), table, strict=True):
        stream.write(",".join(map(repr, [moment, *row.tolist()])) + "\n")
