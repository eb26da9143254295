"""Vehicles: tables of stiffness and mass in SI units, and the thrust that they bear. `tabulated` computes.

    import freebeam as fb
    vehicle = fb.vehicle("vehicle.csv")
    vehicle.load, vehicle.kind, vehicle.error

x is in m, the thrust acts at the largest x and pushes towards the smallest; what goes in and what comes out is in SI
units. "Stable" means the elastic spectrum, with a gimbal law also the rotation that it steers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from freebeam.vehicles.tables import SETTINGS, Stations, described, parts_of, quantity, stations_of, tables_of
from freebeam.vehicles.tabulated import Law, Part, Table, tabulated
from freebeam_sym.checks import InputError, count, reals, refusal
from freebeam_sym.columns import column as column_of
from freebeam_sym.stability.convergence import CONVERGED

if TYPE_CHECKING:
    from scipy.signal import StateSpace

    from freebeam_sym.columns import Column, System
    from freebeam_sym.question import Question
    from freebeam_sym.stability.critical import CriticalLoad
    from freebeam_sym.stability.problem import Kind

__all__ = ["Vehicle", "VehicleLoss", "VehicleMap", "VehicleModes", "vehicle"]

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

AGREE = 1e-9
"""Relative difference of two degrees of the trial functions that is taken at once; else the degree grows."""
ACTUATOR = 0.7
"""Damping ratio of an actuator where none is given."""
ASSEMBLY = 1e-12
"""Relative rounding of the assembled matrices' loads: the uniform beam's is off by 6e-14."""
SAFETY = 3.0
"""What the difference of two degrees is multiplied by to be told as an error: of a table of 200 stations with 5 % of
noise the load was off by twice the difference."""
MOST = 90
"""Trial functions up to which the degree grows beyond the first two: with a hundred a search takes some seconds."""
SEARCHED = (1e3, 1e4, 1e5)
"""Largest loads of the search, one after the other, in units of EI/L², where none is named."""
ROUNDING = 1e-9
"""Growth up to this, relative to |λ|, is none."""


OUTPUTS = {
    "y": ("length", "y", 0), "dy": ("velocity", "y", 1), "ddy": ("acceleration", "y", 2),
    "angle": ("", "psi", 0), "rate": ("", "psi", 1),
}  # fmt: skip
"""What a sensor can give: its unit, its field and the order of its derivative by time."""


class VehicleLoss(NamedTuple):
    """First loss of stability as the thrust grows. load: N, and frequency: rad/s, None where `kind` is "none"; error:
    of the load, relative, estimated from two degrees of the trial functions, None where there is no load or they do not
    agree on its kind; agreed: whether they do. load_max: N, up to where was looked; degree: of the trial functions."""

    load: float | None
    kind: Kind
    frequency: float | None
    error: float | None
    load_max: float
    degree: int
    agreed: bool

    @property
    def converged(self) -> bool:
        """Whether the degrees agree, on the load to 1e-3."""
        return self.agreed and (self.error is None or self.error <= CONVERGED)


class VehicleModes(NamedTuple):
    """Modes at a thrust by ascending frequency. frequency (k,) rad/s: |Im λ|; growth (k,) 1/s: Re λ; error (k,): of λ,
    relative, from two degrees of the trial functions. x (places,) m; shape (k, places): deflection, complex, largest
    entry 1, without the rigid motion that bending drives."""

    frequency: Array
    growth: Array
    error: Array
    x: Array
    shape: Complex


class VehicleMap(NamedTuple):
    """gain (n,); thrust (m,) N; growth (n, m) 1/s: largest Re λ, 0 or less where nothing grows; load (n,) N: the first
    loss of stability, nan where there is none up to the largest thrust and 0 where motion grows at the smallest."""

    gain: Array
    thrust: Array
    growth: Array
    load: Array


@dataclass(frozen=True, eq=False)
class Vehicle:
    """A vehicle in SI units: its stations and parts, and settings by the names that a TOML file gives them."""

    name: str
    stations: Stations = field(repr=False)
    parts: tuple[Part, ...] = field(repr=False)
    settings: Mapping[str, float]

    # --- what it is ------------------------------------------------------------------------------------------------

    @property
    def low(self) -> float:
        """The least x, m."""
        return float(self.stations.x[0])

    @property
    def length(self) -> float:
        """m."""
        return float(self.stations.x[-1]) - self.low

    @cached_property
    def mass(self) -> float:
        """Of the table and all parts, kg."""
        return float(np.diff(self.stations.x) @ self.stations.m.mean(axis=1)) + sum(part.mass for part in self.parts)

    @cached_property
    def centre(self) -> float:
        """x of the centre of mass, m."""
        x, m = self.stations.x, self.stations.m
        ends = (2 * m[:, 0] + m[:, 1]) * x[:-1] + (m[:, 0] + 2 * m[:, 1]) * x[1:]
        return (float(np.diff(x) @ ends) / 6 + sum(part.mass * part.x for part in self.parts)) / self.mass

    @cached_property
    def _beam(self) -> tuple[float, float, float]:
        """The uniform beam whose units are used, Eq. (5): EI of the mean compliance, N m², mean m, kg/m, and L, m."""
        x, EI = self.stations.x, self.stations.EI
        nodes, weights = np.polynomial.legendre.leggauss(8)
        compliance = float(np.diff(x) @ (1 / (EI @ [(1 - nodes) / 2, (1 + nodes) / 2]) @ weights)) / 2
        return self.length / compliance, self.mass / self.length, self.length

    @cached_property
    def units(self) -> dict[str, float]:
        """SI size of one nondimensional unit of each quantity, as `Column.scales` has them."""
        return column_of("free-free").scales(*self._beam)

    @cached_property
    def _columns(self) -> dict[bool, Column]:
        return {}

    def column(self, law: bool | None = None) -> Column:
        """The vehicle as a column, nondimensional by `units`, with its gimbal law or without. Raises InputError."""
        law = self.steered if law is None else law
        if law not in self._columns:
            s, (EI, m, L), time = self.stations, self._beam, self.units["time"]
            GA, J = None if s.GA is None else s.GA * L**2 / EI, None if s.J is None else s.J / (m * L**2)
            table = Table((s.x - self.low) / L, s.EI / EI, s.m / m, GA, J)
            parts = []
            for part in self.parts:
                k = EI / L if part.kind == "joint" else EI / L**3
                of_mass = part.mass / (m * L), part.rotary / (m * L**3)
                parts.append(
                    Part(part.kind, self.place(part.x), *of_mass, part.stiffness / k, part.damping / (k * time))
                )
            self._columns[law] = tabulated(table, tuple(parts), self._law if law else None)
        return self._columns[law]

    @property
    def _law(self) -> Law:
        frequency = self.settings.get("gimbal.actuator")
        frequency = None if frequency is None else frequency / self.units["frequency"]
        ratio = self.settings.get("gimbal.actuator_ratio", ACTUATOR)
        return Law(self.place(self.settings["gimbal.sensor"]), frequency, ratio)

    def place(self, x: float) -> float:
        """x in m as a share of the length from the least x."""
        return min(max((x - self.low) / self.length, 0.0), 1.0)

    @property
    def steered(self) -> bool:
        """Whether a gimbal law turns the thrust."""
        return bool(self.settings.get("gimbal.gain"))

    # --- stability -------------------------------------------------------------------------------------------------

    def question(self, degree: int | None = None, load_max: float | None = None, gain: float | None = None) -> Question:
        """What is asked of the column, nondimensional, at its dampings and with its law or another gain.

        degree: of the bending moment on an element. load_max: N. Raises InputError.
        """
        from freebeam_sym.question import Question

        gain = self.settings.get("gimbal.gain", 0.0) if gain is None else gain
        units, s = self.units, self.settings
        own = {"ratio": s.get("damping.ratio", 0.0)}
        if gain:
            own |= {"gain": gain, "rate": s.get("gimbal.rate", 0.0) / units["time"]}
        top = SEARCHED[0] if load_max is None else load_max / units["load"]
        alpha, beta = (s.get(f"damping.C_{x}", 0.0) / units[x] for x in ("alpha", "beta"))
        return Question.of(self.column(bool(gain)), degree, alpha, beta, load_max=top, **own)

    @cached_property
    def loss(self) -> VehicleLoss:
        """The first loss of stability as the thrust grows from 0. Raises InputError where there is none because motion
        grows at the smallest thrusts."""
        unit = self.units["load"]
        given = self.settings.get("load_max")
        tops = [top * unit for top in SEARCHED] if given is None else [given]
        for top in tops:
            found = self._loss(top)
            if found.kind != "none":
                break
        return found

    def _loss(self, top: float) -> VehicleLoss:
        """Up to a thrust in N: the answer of the highest degree, and how it agrees with those before."""
        from freebeam.maps.known import answer

        before: CriticalLoad | None = None
        last = math.inf
        found = VehicleLoss(None, "none", None, None, top, 0, False)
        for degree in self._degrees():
            try:
                now = answer(self.question(degree, top))
            except InputError as error:
                if not self.steered:
                    raise
                gain, place = (self.settings[f"gimbal.{name}"] for name in ("gain", "sensor"))
                raise InputError(f"gimbal law with gain {gain:g} and its sensor at {place:g} m: {error}") from None
            if before is not None and before.kind == now.kind:
                apart = 0.0
                if now.load is not None and before.load is not None:
                    apart = abs(before.load / now.load - 1)
                # two degrees may be close by chance: no more than a tenfold step is believed
                off = SAFETY * max(apart, 0.0 if math.isinf(last) else last / 10)
                off += now.rounding + ASSEMBLY + self._left_out(now)
                found = self._in_si(now, off, top, degree)
                if max(apart, last / 10) <= AGREE:
                    break
                last = apart
            else:
                last, found = math.inf, self._in_si(now, None, top, degree)
            before = now
        return found

    def _left_out(self, found: CriticalLoad) -> float:
        """What the trial functions leave out, relative."""
        if found.load is None:
            return 0.0
        q = found.question
        kernel: Any = q.column.kernel
        T, r = q.column.frame(q.modes, **q.parameters), q.column.rigid_count
        mode: Any = found.mode
        vector = mode if T is None else T[:, r:] @ mode
        return float(kernel.left_out(q.column.basis(q.modes), vector, 1j * (found.frequency or 0.0)))

    def _in_si(self, found: CriticalLoad, error: float | None, top: float, degree: int) -> VehicleLoss:
        if found.load is None or found.frequency is None:
            return VehicleLoss(None, "none", None, None, top, degree, error is not None)
        load, frequency = found.load * self.units["load"], found.frequency * self.units["frequency"]
        return VehicleLoss(load, found.kind, frequency, error, top, degree, error is not None)

    def _degrees(self) -> Iterator[int]:
        """Degrees of the trial functions to compare: two, and more as far as they are few functions."""
        column = self.column()
        first = column.number(None)
        for degree in range(first, first + 8):
            n = len(column.coefficients(first).M[0]) * degree / first
            if degree > first + 1 and n > MOST:
                return
            yield degree

    @property
    def load(self) -> float | None:
        """The thrust at the first loss of stability, N; None where there is none up to `loss.load_max`."""
        return self.loss.load

    @property
    def kind(self) -> Kind:
        """ "flutter", "divergence" or "none"."""
        return self.loss.kind

    @property
    def frequency(self) -> float | None:
        """At the first loss of stability, rad/s; 0 in divergence."""
        return self.loss.frequency

    @property
    def error(self) -> float | None:
        """Estimated error of `load`, relative."""
        return self.loss.error

    @property
    def factor(self) -> float | None:
        """`load` over the thrust that is given; None without one."""
        thrust = self.settings.get("thrust")
        return None if thrust is None or self.load is None else self.load / thrust

    @cached_property
    def unloaded(self) -> VehicleModes:
        """The eight lowest modes without thrust, damping and gimbal law, or those that two degrees agree on to 1e-3."""
        bare = Vehicle(self.name, self.stations, tuple(replace(part, damping=0.0) for part in self.parts), {})
        found = bare.modes(0.0, 8, degree=bare._fine + 3)
        some = max(1, int(np.argmin(np.append(found.error <= 1e-3, False))))
        return VehicleModes(*(x if name == "x" else x[:some] for name, x in found._asdict().items()))

    @property
    def frequencies(self) -> Array:
        """Of `unloaded`, rad/s, ascending."""
        return self.unloaded.frequency

    def modes(
        self, thrust: float | None = None, number: int = 4, x: ArrayLike | None = None, degree: int | None = None
    ) -> VehicleModes:
        """The lowest modes at a thrust in N, by default the given one, at places x in m. Raises InputError."""
        from freebeam_sym.spectra import spectrum

        number = count("number", number, 1, 20, "modes, the lowest")
        places = np.linspace(self.low, self.low + self.length, 201) if x is None else reals("x", x)
        degree = self._fine if degree is None else degree
        several = [spectrum(self.system(thrust, degree=d)) for d in (degree - 1, degree)]
        rates, others = several[1].eigenvalues, several[0].eigenvalues
        upper = np.flatnonzero(rates.imag > -ROUNDING * np.abs(rates).max())
        upper = upper[np.argsort(np.abs(rates[upper]), kind="stable")][:number]
        rates, vectors = rates[upper], several[1].vectors[:, upper]
        off = SAFETY * np.abs(rates[:, None] - others).min(axis=1) / np.maximum(np.abs(rates), 1e-300) + ASSEMBLY
        shapes = vectors.T @ self.system(thrust, degree=degree).shapes([self.place(p) for p in places.tolist()])
        shapes = shapes / shapes[np.arange(len(shapes)), np.abs(shapes).argmax(axis=1)][:, None]
        rates = rates * self.units["frequency"]
        return VehicleModes(np.abs(rates.imag), rates.real, off, places, shapes)

    @property
    def _fine(self) -> int:
        """The usual degree, and one."""
        return self.column().number(None) + 1

    def thrust(self, given: float | None = None) -> float:
        """A thrust in N, by default the one that is given. Raises InputError where there is none."""
        thrust = self.settings.get("thrust") if given is None else quantity("thrust", given, *SETTINGS["thrust"])
        if thrust is None:
            raise InputError("thrust is missing: give the vehicle's thrust in N, or the one to look at")
        return thrust

    def system(self, thrust: float | None = None, rigid: bool = False, degree: int | None = None) -> System:
        """M q̈ + C q̇ + K q = Q F at a thrust in N, nondimensional by `units`. Raises InputError."""
        load = self.thrust(thrust) / self.units["load"]
        return self.question(self._fine if degree is None else degree).system(load, rigid)

    def map(self, gain: ArrayLike, thrust: ArrayLike, progress: Callable[[float], object] | None = None) -> VehicleMap:
        """Stability over gains of the gimbal law and thrusts in N, arrays (n,) and (m,).

        Raises InputError for a vehicle without a sensor."""
        from freebeam.maps.arrays import eigenvalues
        from freebeam.maps.known import answer

        if "gimbal.sensor" not in self.settings:
            raise InputError("gimbal.sensor is missing: a map over the gain needs the place of the sensor, in m")
        gains, thrusts = reals("gain", gain).ravel(), reals("thrust", thrust).ravel()
        growth, load = np.empty((len(gains), len(thrusts))), np.full(len(gains), np.nan)
        for k, g in enumerate(gains.tolist()):
            q = self.question(None, float(thrusts.max()), g)
            rates = eigenvalues(q.column, thrusts / self.units["load"], q.alpha, q.beta, q.modes, **q.parameters)
            size = np.abs(rates)
            grows = rates.real > ROUNDING * np.maximum(size, 1e-4 * size.max(axis=1, keepdims=True))
            most = np.where(grows, rates.real, -np.inf).max(axis=1)
            calm = np.minimum(np.where(grows, -np.inf, rates.real).max(axis=1), 0.0)
            growth[k] = np.where(np.isfinite(most), most, calm) * self.units["frequency"]
            try:
                found = answer(q).load
                load[k] = np.nan if found is None else found * self.units["load"]
            except InputError:  # something grows at the smallest thrusts
                load[k] = 0.0
            if progress is not None:
                progress((k + 1) / len(gains))
        return VehicleMap(gains, thrusts, growth, load)

    # --- control ---------------------------------------------------------------------------------------------------

    def state_space(
        self,
        thrust: float | None = None,
        *,
        input: str = "gimbal",
        outputs: Sequence[str] = ("angle", "rate", "ddy"),
        sensors: ArrayLike | None = None,
        rigid: bool = True,
        degree: int | None = None,
    ) -> StateSpace:
        """The vehicle at a thrust for control engineers, a `scipy.signal.StateSpace` in seconds.

        input: "gimbal", an angle in rad that turns the thrust as a slope does, so that its force across the vehicle is
        −thrust × angle; or "control", a force in N at `control`. It acts beside the gimbal law, where there is one.
        outputs at sensors (m; the IMU where None), in this order, each at all sensors: of "y", "dy", "ddy" (m, m/s,
        m/s² across the vehicle), "angle" and "rate" (rad, rad/s: of the cross-section).
        The states are generalised coordinates and their rates, without unit. rigid: with the rigid motion, which a
        sensor feels too. Raises InputError.
        """
        from scipy.signal import StateSpace

        from freebeam_sym.spectra import state_matrix

        system, time = self.system(thrust, rigid, degree), self.units["time"]
        A = state_matrix(system.M, system.C, system.K)
        push = self._push(system, input, thrust)
        rows, direct = self._outputs(system, outputs, sensors, push)
        B = np.concatenate([0 * push, push])[:, None]
        return StateSpace(
            A / time, B / time, np.concatenate([*rows.values()]), np.concatenate([*direct.values()])[:, None]
        )

    def frequency_response(
        self,
        omega: ArrayLike,
        thrust: float | None = None,
        *,
        input: str = "gimbal",
        outputs: Sequence[str] = ("angle", "rate", "ddy"),
        sensors: ArrayLike | None = None,
    ) -> Complex:
        """Outputs of `state_space` for an input e^(iωt) of unit size, ω in rad/s (m,): complex, (outputs, m)."""
        system = self.system(thrust, True)
        w = reals("omega", omega).ravel()[:, None, None] * self.units["time"]
        G = system.K + 1j * w * system.C - w**2 * system.M
        q = np.linalg.solve(G, system.Q(self._pushed(input))[:, None] * self._force_of(input, thrust))[:, :, 0].T
        seen = self._seen(system, outputs, sensors)
        return np.concatenate([(1j * w.ravel()) ** OUTPUTS[name][2] * (R @ q) for name, R in seen.items()])

    def respond(
        self,
        duration: float,
        step: float,
        force: Callable[[Any], Any] | ArrayLike,
        thrust: float | None = None,
        *,
        input: str = "gimbal",
        outputs: Sequence[str] = ("angle", "rate", "ddy"),
        sensors: ArrayLike | None = None,
    ) -> dict[str, Array]:
        """What the sensors feel from rest: "t" (s) and each output of `state_space`, (times, sensors).

        force: the input, rad or N, as a function of an array of times in s, or one number, or a value at each time.
        Solved by `freebeam.respond`, exactly where the input is linear between the times. Raises InputError.
        """
        from freebeam_sym.response import respond

        system, time = self.system(thrust, True), self.units["time"]
        push = self._push(system, input, thrust)
        rows, direct = self._outputs(system, outputs, sensors, push)
        unit = self._force_of(input, thrust)
        given: Any = (lambda t: np.asarray(force(t * time)) * unit) if callable(force) else reals("force", force) * unit
        found = respond(
            system, duration / time, step / time, force=given, force_position=self._pushed(input),
            sensors=[0.0], outputs=("y",), states=True,
        )  # fmt: skip
        states = np.hstack([found.q, found.dq])
        pushed = np.broadcast_to(given(found.t) if callable(given) else given, found.t.shape) / unit
        return {"t": found.t * time} | {x: states @ rows[x].T + np.outer(pushed, direct[x]) for x in outputs}

    def _push(self, system: System, input: str, thrust: float | None) -> Array:
        """Accelerations of the coordinates by a unit of an input, nondimensional, (n,)."""
        return np.asarray(np.linalg.solve(system.M, system.Q(self._pushed(input)))) * self._force_of(input, thrust)

    def _outputs(
        self, system: System, outputs: Sequence[str], sensors: ArrayLike | None, push: Array
    ) -> tuple[dict[str, Array], dict[str, Array]]:
        """What gives each output in SI units from (q, dq), (sensors, 2n), and from the input, (sensors,)."""
        from freebeam_sym.spectra import state_matrix

        n, rows, direct = len(system.M), {}, {}
        accelerations = state_matrix(system.M, system.C, system.K)[n:]
        for name, R in self._seen(system, outputs, sensors).items():
            order = OUTPUTS[name][2]
            rows[name] = R @ (np.eye(n, 2 * n, order * n) if order < 2 else accelerations)
            direct[name] = R @ push if order == 2 else np.zeros(len(R))
        return rows, direct

    def _seen(self, system: System, outputs: Sequence[str], sensors: ArrayLike | None) -> dict[str, Array]:
        """What gives each output in SI units from the coordinates, or from their rates, (sensors, n)."""
        if isinstance(outputs, str) or not outputs or any(name not in OUTPUTS for name in outputs):
            raise refusal("outputs", outputs, f"must be a sequence of names from {', '.join(OUTPUTS)}")
        if sensors is None and "imu" not in self.settings:
            raise InputError("imu is missing: give the place of the IMU in m, or the sensors to look at")
        places = reals("sensors", self.settings["imu"] if sensors is None else sensors).ravel()
        _on(self, "sensors", places)
        at, found = [self.place(x) for x in places.tolist()], {}
        for name in outputs:
            quantity, field, order = OUTPUTS[name]
            size = self.units[quantity] if quantity else self.units["time"] ** -order
            found[name] = system.shapes(at, 0, field).T * size
        return found

    def _pushed(self, input: str) -> float:
        """Where an input acts, as a share of the length."""
        if input not in ("gimbal", "control"):
            raise refusal("input", input, 'must be "gimbal" or "control"')
        return 1.0 if input == "gimbal" else self.place(self.settings.get("control", self.low + self.length))

    def _force_of(self, input: str, thrust: float | None) -> float:
        """The nondimensional force of a unit of an input."""
        return (-self.thrust(thrust) if input == "gimbal" else 1.0) / self.units["force"]


def _on(vehicle: Vehicle, name: str, places: Array) -> None:
    low, high = vehicle.low, vehicle.low + vehicle.length
    for x in places.ravel().tolist():
        if not low <= x <= high:
            raise InputError(f"{name} = {x:g}: must lie on the vehicle, from {low:g} to {high:g} m")


def vehicle(
    source: Any,
    *,
    parts: Any = None,
    interpolation: str | None = None,
    thrust: float | str | None = None,
    gimbal: Mapping[str, Any] | None = None,
    damping: Mapping[str, Any] | None = None,
    imu: float | str | None = None,
    control: float | str | None = None,
    load_max: float | str | None = None,
) -> Vehicle:
    """A vehicle from its tables, in SI units; the guide "Vehicles" has the format of the files.

    source: the path of a CSV file with the header x,EI,m (m, N m², kg/m; GA in N and J in kg m where there are), or of
    a TOML file that names all; or these columns as arrays by name. The vehicle is free at both ends; the thrust follows
    the end at the largest x. parts: the path of a CSV file with the header kind,x,m,J,k,c, or such columns by name.
    interpolation: "linear" between stations, the default, or "steps". thrust: N, what `factor` refers to. gimbal: gain,
    rate (s), sensor (m), and actuator (rad/s) and actuator_ratio where it does not follow at once. damping: ratio, or
    C_alpha (s) and C_beta (kg/(m s)). imu, control: m. load_max: N. A unit may stand with a number, "1.2 MN", where
    pint is installed.

    >>> import freebeam as fb
    >>> uniform = fb.vehicle({"x": [0, 20], "EI": [2e6, 2e6], "m": [50, 50]})
    >>> round(uniform.load), uniform.kind  # N
    (548446, 'flutter')

    Raises InputError, in one line with row and column, for tables with gaps, out of order or without sense.
    """
    found = described(source)
    given = {"thrust": thrust, "imu": imu, "control": control, "load_max": load_max, "interpolation": interpolation}
    for section, values in (("gimbal", gimbal), ("damping", damping)):
        for name, value in (values or {}).items():
            if f"{section}.{name}" not in SETTINGS:
                names = [x.split(".")[1] for x in SETTINGS if x.startswith(section)]
                raise InputError(f"{section}.{name} is not known; there are {', '.join(names)}")
            given[f"{section}.{name}"] = value
    found |= {name: value for name, value in given.items() if value is not None}
    before = f"{found['file']}, " if "file" in found else ""
    stations = stations_of(found["stations"], found.get("interpolation", "linear"))
    low, high = float(stations.x[0]), float(stations.x[-1])
    tables = [*found.get("parts", ()), *tables_of(parts)]
    settings = {name: quantity(before + name, found[name], *SETTINGS[name]) for name in SETTINGS if name in found}
    made = Vehicle(str(found["name"]), stations, parts_of(tables, low, high), settings)
    _check_settings(made, before)
    return made


def _check_settings(made: Vehicle, before: str) -> None:
    """Raises InputError for settings that contradict one another or the vehicle."""
    s = made.settings
    for name in ("thrust", "load_max"):
        if name in s and s[name] <= 0:
            raise InputError(
                f"{before}{name} = {s[name]:g}: has no direction that compresses the vehicle; give a thrust in N, "
                "greater than zero, which pushes from the largest x to the smallest"
            )
    for name in ("damping.ratio", "damping.C_alpha", "damping.C_beta"):
        if s.get(name, 0.0) < 0:
            raise InputError(f"{before}{name} = {s[name]:g}: must be zero or greater ({SETTINGS[name][1]})")
    if s.get("damping.ratio", 0.0) >= 1:
        raise InputError(f"{before}damping.ratio = {s['damping.ratio']:g}: must be below 1, such as 0.005")
    if s.get("damping.ratio") and (s.get("damping.C_alpha") or s.get("damping.C_beta")):
        raise InputError(f"{before}damping: give a ratio, or C_alpha and C_beta, and not both")
    for name in ("imu", "control", "gimbal.sensor"):
        if name in s:
            _on(made, before + name, np.array([s[name]]))
    for name in ("gimbal.actuator", "gimbal.actuator_ratio"):
        if name in s and s[name] <= 0:
            raise InputError(f"{before}{name} = {s[name]:g}: must be greater than zero ({SETTINGS[name][1]})")
    if s.get("gimbal.gain") and "gimbal.sensor" not in s:
        raise InputError(f"{before}gimbal.sensor is missing: give the place of the sensor, in m")
    if s.get("gimbal.rate") and not s.get("gimbal.gain"):
        raise InputError(f"{before}gimbal.rate = {s['gimbal.rate']:g}: needs a gain too, which restores the rotation")
