"""`freebeam respond`."""

from __future__ import annotations

import io
import json
import math
import shutil
import sys
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import IO, TYPE_CHECKING, Annotated, Any

import typer

from freebeam.cli.application import app
from freebeam.cli.options import (
    ZERO,
    AlphaOption,
    BetaOption,
    ColumnOption,
    JsonOption,
    LengthOption,
    LoadOption,
    MassOption,
    ModesOption,
    Number,
    RigidOption,
    SetOption,
    StiffnessOption,
    case_of,
    nondimensional,
    number,
)
from freebeam.cli.output import plain, print_json, print_table, working, written

if TYPE_CHECKING:
    from freebeam.cli.options import Units
    from freebeam.cli.outline import Outline

ROWS = 200  # a response of more is told by a summary and a plot
QUANTITIES = {"y": "length", "dy": "velocity", "ddy": "acceleration"}


@app.command(epilog="Example: freebeam respond --load 9 --alpha 1e-3 --beta 0.1 --duration 20 --step 0.01 --sensor 0.1")
def respond(
    load: LoadOption,
    duration: Annotated[Number, typer.Option(parser=number, metavar="T", help="Length of the response.")],
    step: Annotated[Number, typer.Option(parser=number, metavar="H", help="Time step.")],
    column: ColumnOption = "free-free",
    modes: ModesOption = None,
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
    quantity: Annotated[
        list[str] | None,
        typer.Option(metavar="y|dy|ddy", help="Displacement, velocity or acceleration; all three where not given."),
    ] = None,
    method: Annotated[
        str,
        typer.Option(
            metavar="exact|newmark",
            help="Exact: the step is how often the response is sampled. Newmark's average acceleration, as in the "
            "paper: the step decides the error too, which is estimated.",
        ),
    ] = "exact",
    output: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="A .csv or .npz file to write, part by part, however long the response is. A .csv begins with one "
            "line of settings, a comment after #, and the names of the columns.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an output that exists.")] = False,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
) -> None:
    """Compute the response at sensors in time, from an initial state or to a sinusoidal force.

    Without a force and an initial state, mode 1 starts with q = 0.01 (modes normalised as in Eq. (22)).
    Without an output, a response of more than 200 rows is told by a summary and a plot; a shorter one is a table.
    """
    import numpy as np

    import freebeam as fb
    from freebeam.cli.outline import Outline
    from freebeam_sym.checks import InputError, count, positive
    from freebeam_sym.response.inputs import moments, times_of

    if more_sensors and not sensor:
        raise InputError(f"{more_sensors[0]}: belongs to no option; positions of sensors follow --sensor")
    if output is not None and output.suffix not in (".csv", ".npz"):
        raise InputError(f"{output}: the name must end in .csv or .npz")
    if (force_amplitude is None) != (force_frequency is None):
        raise InputError("a force needs both --force-amplitude and --force-frequency")
    if force_amplitude is None and force_position is not None:
        raise InputError("--force-position: there is no force; give --force-amplitude and --force-frequency")
    for name in quantity or ():
        if name not in QUANTITIES:
            raise InputError(f"--quantity {name}: must be one of {', '.join(QUANTITIES)}")
    if method not in ("exact", "newmark"):
        raise InputError(f"--method {method}: must be exact or newmark")
    positive("duration", duration)
    positive("step", step)
    case = case_of(column, modes, alpha, beta, own, (bending_stiffness, mass_per_length, length))
    units = case.units
    system = case.system(units.into("load", load), rigid)

    places = [*(sensor or ()), *(more_sensors or ())]
    for option, x in [("--sensor", x) for x in places] + [("--force-position", force_position)]:
        if x is not None and not 0 <= units.into("length", x) <= 1:
            raise InputError(f"{option} {x}: must be from 0 to {units.say('length', 1.0, '.6g')}, the beam's length")
    sensors = [units.into("length", x) for x in places] or [0.1]
    labels = [str(x) for x in places] or [f"{units.out('length', 0.1):.6g}"]
    excitation: dict[str, Any] = {}
    if force_amplitude is not None and force_frequency is not None:
        size, rate = units.into("force", force_amplitude), units.into("frequency", force_frequency)
        excitation = {
            "force": fb.Harmonic(size, rate),
            "force_position": 1.0 if force_position is None else units.into("length", force_position),
        }
    start: dict[str, Any] = {}
    if initial_mode is not None or initial_amplitude is not None or initial_velocity is not None:
        number = count("--initial-mode", 1 if initial_mode is None else initial_mode, high=system.modes)
        mode = system.mode(number)
        velocity = 0.0 if initial_velocity is None else units.into("velocity", initial_velocity)
        amplitude = 0.01 if initial_velocity is None else 0.0
        if initial_amplitude is not None:
            amplitude = units.into("length", initial_amplitude)
        start = {"initial": amplitude * mode, "initial_velocity": velocity * mode}

    names = [name for name in QUANTITIES if not quantity or name in quantity]
    columns = [(name, label) for label in labels for name in names]
    record = case.record(
        load=load, rigid=rigid, duration=duration, step=step, method=method, sensors=places or sensors,
        force_amplitude=force_amplitude, force_frequency=force_frequency, force_position=force_position,
        initial_mode=initial_mode, initial_amplitude=initial_amplitude, initial_velocity=initial_velocity,
        unit={name: units.of(kind).strip() for name, kind in {"t": "time", **QUANTITIES}.items()},
    )  # fmt: skip
    with nondimensional(units):
        times = times_of(units.into("time", duration), units.into("time", step))
    outline = Outline(step.exact, times, columns)

    def values(part: Any) -> dict[str, Any]:
        found = {name: units.out(QUANTITIES[name], getattr(part, name)) for name in names}
        outline.take(part.begin, np.stack([*found.values()], axis=-1).reshape(part.end - part.begin, -1))
        return {"t": moments(step.exact, part.begin, part.end), **found}

    def series(target: Callable[[dict[str, Any]], None] | None) -> dict[str, Any]:
        with working("response") as report, nondimensional(units):
            found = fb.respond(
                system, units.into("time", duration), units.into("time", step), sensors=sensors, outputs=names,
                method=method, target=None if target is None else lambda part: target(values(part)),
                progress=lambda share: report(f"{share:.0%}"), **start, **excitation,
            )  # fmt: skip
        record["period_error"], record["phase_error"] = found.period_error, found.phase_error
        record["samples_per_period"] = found.samples_per_period
        record["growth"] = units.out("frequency", found.growth)
        record["warnings"] = [warning.told(units.say) for warning in found.warnings]
        return {} if target else values(found)

    if output is None:
        found = series(None)
        if as_json:
            print_json({**record, **found})
        elif times <= ROWS:
            write_csv(sys.stdout, columns, units, **found)
    else:
        with written(output, replace=force) as stream:
            if output.suffix == ".npz":
                # Each array has a file of its own until its length is known; the members of the archive follow.
                with ExitStack() as stack:
                    beside: dict[str, IO[bytes]] = {
                        name: stack.enter_context(tempfile.TemporaryFile(dir=output.parent)) for name in ("t", *names)
                    }

                    def keep(part: dict[str, Any]) -> None:
                        for name, array in part.items():
                            beside[name].write(memoryview(array).cast("B"))

                    series(keep)
                    settings = json.dumps(plain(record))
                    write_npz(stream, beside, len(sensors), {"sensors": sensors, "settings": settings})
            else:
                text = io.TextIOWrapper(stream, encoding="utf-8", newline="")
                text.write(f"# freebeam respond {json.dumps(plain(record), ensure_ascii=False)}\n")
                series(lambda part: write_csv(text, columns, units, **part))
                text.detach()
        if as_json:
            print_json({**record, "output": output, **outline.record()})
    if as_json:
        return
    if output is not None or times > ROWS:
        print_outline(case.title(load=f"{load}{units.of('load')}"), outline, record, units, output)
    for warning in record["warnings"]:
        print(f"warning: {warning}", file=sys.stderr)


def print_outline(title: str, outline: Outline, record: dict[str, Any], units: Units, output: Path | None) -> None:
    """Print what was written, or would have been: rows, peaks, settling, what the step does; and a plot, unless there
    is a file."""
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
    print_table([*rows, ("method", step)], title=title)
    if output is None:
        units_of = {name: unit and f", {unit}" for name, unit in record["unit"].items()}
        units_of["t"] = units.of("time")
        sys.stdout.write("".join(f"{line}\n" for line in outline.plot(units_of)))


def write_csv(stream: IO[str], columns: Sequence[tuple[str, str]], units: Units, t: Any, **quantities: Any) -> None:
    """Write a response, or a part of it, as CSV; numbers are written so that they read back as the same floats."""
    import numpy as np

    if t[0] == 0:
        kinds = [("t", "time"), *((f"{name}({x})", QUANTITIES[name]) for name, x in columns)]
        heads = (name + (f" [{units.of(kind).strip()}]" if units.sizes else "") for name, kind in kinds)
        stream.write(",".join(heads) + "\n")
    table = np.stack([*quantities.values()], axis=-1).reshape(len(t), -1)
    for moment, row in zip(t.tolist(), table, strict=True):
        stream.write(",".join(map(repr, [moment, *row.tolist()])) + "\n")


def write_npz(stream: IO[bytes], files: dict[str, IO[bytes]], sensors: int, arrays: dict[str, Any]) -> None:
    """Write files of floats, t of shape (times,) and others (times, sensors), and arrays, as NumPy's archive."""
    import numpy as np

    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED, allowZip64=True) as archive:
        for name, file in files.items():
            times = file.tell() // (8 if name == "t" else 8 * sensors)
            shape = (times,) if name == "t" else (times, sensors)
            file.seek(0)
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                header = {
                    "descr": "<f8" if sys.byteorder == "little" else ">f8",
                    "fortran_order": False,
                    "shape": shape,
                }
                np.lib.format.write_array_header_1_0(member, header)
                shutil.copyfileobj(file, member)
        for name, value in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.asarray(value))
