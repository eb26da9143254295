"""`freebeam vehicle`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from freebeam.cli.application import command
from freebeam.cli.options import REQUIRED, FileOptions, Number, argument, flag, option, refuse
from freebeam.cli.output import print_json, print_table, working, written

if TYPE_CHECKING:
    from freebeam.vehicles import Vehicle as Described


@command("freebeam vehicle rocket.csv --thrust 1.2e6 --damping-ratio 0.005 --report rocket.html")
class Vehicle(FileOptions):
    """Find the thrust at which a vehicle of tabulated stiffness and mass loses stability. All in SI units.

    FILE is a table with the header x,EI,m (m, N m^2, kg/m), and GA (N) and J (kg m) where there are; or a TOML file
    that names it and all else. The vehicle is free at both ends, its thrust follows the end at the largest x.
    """

    file: Path = argument("FILE", "The table, or the TOML file.", default=REQUIRED)
    parts: Path | None = option("FILE", "A table of point masses and springs, with the header kind,x,m,J,k,c.")
    steps: bool = flag("What stands at a station holds up to the next; else linear between stations.")
    thrust: Number | None = option("T", "The vehicle's thrust, N, which the load factor refers to.")
    load_max: Number | None = option("T", "Largest thrust of the search, N.")
    damping_ratio: Number | None = option("X", "Damping ratio of each elastic mode.")
    internal: Number | None = option("X", "Internal damping C_alpha, s.", "--c-alpha")
    external: Number | None = option("X", "External damping C_beta, kg/(m s).", "--c-beta")
    gain: Number | None = option("G", "Gimbal angle a slope at the sensor, rad/rad.")
    rate: Number | None = option("R", "Gimbal angle a rate of that slope, s.")
    sensor: Number | None = option("X", "Place of the sensor of the gimbal law, m.")
    actuator: Number | None = option("W", "Natural frequency of the gimbal's actuator, rad/s; else it follows at once.")
    imu: Number | None = option("X", "Place of the IMU, m.")
    control: Number | None = option("X", "Place of a control force, m.")
    report: Path | None = option("FILE", "Write a report with pictures: .html or .pdf.")

    def run(self) -> None:
        from freebeam.vehicles import report as vehicle_report

        report = self.report
        if report is not None:
            formats = vehicle_report.FORMATS
            refuse(report.suffix.lower() not in formats, f"--report {report}: must end in {' or '.join(formats)}")
            refuse(
                report.exists() and not self.force, f"{report} exists; choose another file, or --force to replace it"
            )
        described = self.described()
        with working("vehicle") as say:
            say("first loss of stability")
            _ = described.loss, described.unloaded
            if report is not None:
                with written(report, self.force) as stream:
                    stream.write(vehicle_report.report(described, report.suffix.lower(), say))
        if self.as_json:
            print_json(record_of(described) | {"report": report})
            return
        print_table(vehicle_report.facts(described), title=described.name)
        if report is not None:
            print(f"{report}: the report")

    def described(self) -> Described:
        """The vehicle of the file, with what the options say of it. Raises InputError."""
        import freebeam as fb

        gimbal = {"gain": self.gain, "rate": self.rate, "sensor": self.sensor, "actuator": self.actuator}
        damping = {"ratio": self.damping_ratio, "C_alpha": self.internal, "C_beta": self.external}
        places = {"thrust": self.thrust, "imu": self.imu, "control": self.control, "load_max": self.load_max}
        return fb.vehicle(
            self.file, parts=self.parts, interpolation="steps" if self.steps else None,
            gimbal=_given(gimbal), damping=_given(damping), **_given(places),
        )  # fmt: skip


def _given(options: dict[str, Number | None]) -> dict[str, Any]:
    return {name: float(value) for name, value in options.items() if value is not None}


def record_of(described: Described) -> dict[str, Any]:
    """All of it for JSON, in SI units."""
    loss, unloaded = described.loss, described.unloaded
    return {
        "vehicle": described.name, "units": "SI", "length": described.length, "mass": described.mass,
        "centre": described.centre, "settings": dict(described.settings),
        "load": loss.load, "kind": loss.kind, "frequency": loss.frequency, "error": loss.error,
        "converged": loss.converged,
        "load_max": loss.load_max, "factor": described.factor,
        "frequencies": unloaded.frequency, "frequencies_error": unloaded.error,
    }  # fmt: skip
