"""Columns of tabulated stiffness and mass, such as a launch vehicle: assembled in floats, with what a kernel offers.

A kernel is derived for one layout of a column; tables of hundreds of stations are assembled here instead, from the same
energies and virtual work. With the thrust P at x = 1, the axial force is what accelerates the mass ahead, N = P n(x),

    T = ½ ∫ m ẏ² + J ψ̇² dx + ½ Σ m_k ẏ(x_k)² + J_k ψ̇(x_k)²,    V = ½ ∫ EI ψ′² + GA (y′ − ψ)² dx + springs,
    W_c = ½ P ∫ n y′² dx,    δW = −P (ψ(1) + δ) δy(1),    δ̈/ω_a² + 2 ζ_a δ̇/ω_a + δ = g ψ(x_s) + r ψ̇(x_s),

where δ is the angle of a gimbal by a law, at once where no ω_a of its actuator is given, ψ = y′ without a shear
stiffness, and n(x) the share of the mass that lies ahead of x.

The trial functions have the bending moment EI ψ′ as polynomials on elements between point masses, not the deflection: a
moment is continuous where EI jumps, a curvature is not. Their shear force is that of the moment, −(EI ψ′)′; the share
J ψ̈ of rotary inertia is missing (`left_out` says how much that is), and with it the second spectrum of Timoshenko's
beam. All is integrated along the table by Gauss's rule on panels between stations. Nondimensional, Eq. (5).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from types import ModuleType
from typing import Any, ClassVar, Literal, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.columns import Column

__all__ = ["Law", "Part", "Table", "Tabulated", "tabulated"]

Array = NDArray[np.float64]

NODES = 8
"""Of Gauss's rule on a panel: exact for the energies of any piecewise linear table."""
STEEPEST = 2.0
"""Ratio of EI at the ends of a panel, at most."""
LONGEST = 0.25
"""Of an element."""
MOST_BREAKS = 24
"""Elements begin at the heaviest parts, so many at most, and at half as many of the table's largest steps; at others
the moment's polynomial runs through, which converges more slowly."""
HIGHEST = 1e11
"""Squared frequency, relative to the lowest, up to which modes are kept: with the rotation that a law steers the search
takes no more. Of a vehicle with short elements those above moved the load by 1e-6, those above 1e10 by 2e-6."""
DROPPED = 2e-6
"""Error of a load, relative, that is told where modes are left out."""
FUNCTIONS = 36
"""Bending functions that the usual degree gives, about; of the uniform beam these leave 1e-9 of the load."""


@dataclass(frozen=True)
class Table:
    """Stiffness and mass between stations: x (s + 1,) from 0 to 1, ascending; the others (s, 2), the values at both
    ends of each interval, linear between. shear: GA, None of a beam that is stiff in shear. rotary: J."""

    x: Array
    bending: Array
    mass: Array
    shear: Array | None = None
    rotary: Array | None = None


class Law(NamedTuple):
    """What turns the thrust beside the end's slope: a gimbal angle by the slope at a sensor, by the parameters gain and
    rate; through an actuator of a frequency and damping ratio, or at once where the frequency is None."""

    sensor: float
    frequency: float | None = None
    ratio: float = 0.7


@dataclass(frozen=True)
class Part:
    """Something at a place x. mass, rotary: of a point mass. stiffness, damping: of a "spring" to the ground, of the
    spring and dashpot that a "sprung" mass hangs on across the beam, or against rotation of a "joint" of two parts."""

    kind: Literal["mass", "sprung", "spring", "joint"]
    x: float
    mass: float = 0.0
    rotary: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0


class Functions(NamedTuple):
    """Trial functions: 1, x and the modes of the unloaded beam, then the gimbal's angle where it has an actuator; n in
    all. Before they are modes: 1, x, those with a bending moment, then the sprung masses' motion beside the beam.

    rate (n, panels, NODES): ψ′ at Gauss's nodes; shear: y′ − ψ there; psi, y (n, panels): at the panels' left ends.
    M, E, H, C (n, n): mass, elastic stiffness, the load's matrix, dashpots; material: E of beam and joints alone;
    turn, push (n,): ψ at the sensor and y(1). dropped: whether high modes are left out.
    """

    degree: int
    rate: Array
    shear: Array
    psi: Array
    y: Array
    M: Array
    E: Array
    material: Array
    H: Array
    C: Array
    turn: Array
    push: Array
    dropped: bool = False


class Tabulated:
    """What a kernel's module offers, of a table with parts and a gimbal law, or None."""

    __name__ = "tabulated"
    FIELDS: ClassVar[dict[str, tuple[int, frozenset[Any], frozenset[Any]]]] = {
        name: (1, frozenset(), frozenset()) for name in ("y", "psi")
    }
    """Fields: in how many derivatives they are joined, where they are held, and where they may jump."""

    def __init__(self, table: Table, parts: tuple[Part, ...] = (), law: Law | None = None) -> None:
        self.table, self.parts, self.law = table, parts, law
        self.acts = law is not None and law.frequency is not None
        turned = [part.x for part in parts if _turns(part)]
        # the adjoint motion's moment jumps where the thrust sees a slope; with shear and without rotary inertia the
        # functions for that would move no mass, and decide nothing
        seen = [] if table.shear is not None and table.rotary is None else [1.0, 1.0 if law is None else law.sensor]
        self.edges, self.breaks = _edges(table, parts, seen)
        self.opened = np.isin(self.breaks, [*turned, *seen])
        h = np.diff(self.edges)
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        self.nodes, self.weights = (nodes + 1) / 2, weights / 2
        self.h, self.points = h, self.edges[:-1, None] + h[:, None] * self.nodes
        self.ahead, self.total = self._ahead()
        held = sum(part.kind == "spring" for part in parts)
        if table.shear is not None and table.rotary is None and any(part.kind == "sprung" for part in parts):
            raise InputError("a sprung mass on a beam with a shear stiffness GA needs its rotary inertia J too")
        if held == 1:
            raise InputError("one spring to the ground leaves a rotation about it; give two springs or none")
        self.free = 0 if held else 2
        """Motions that cost no energy."""
        rigid = self.free if law is None else min(self.free, 1)
        gains = [
            {"name": "gain", "latex": "g", "meaning": "gimbal angle a slope at the sensor", "default": 0.1,
             "low": 0.0, "high": 1.0},
            {"name": "rate", "latex": "r", "meaning": "gimbal angle a rate of the slope", "default": 0.0,
             "low": 0.0, "high": 1.0},
        ]  # fmt: skip
        ratio = {"name": "ratio", "latex": r"\zeta", "meaning": "damping ratio of each mode of the unloaded beam",
                 "default": 0.0, "low": 0.0, "high": 0.02}  # fmt: skip
        degree = max(2, -(-FUNCTIONS // (len(self.breaks) - 1)))
        self.COLUMN: dict[str, Any] = {
            "name": "vehicle", "title": "Free-free beam of tabulated stiffness and mass under an end follower force",
            "basis": "elements", "default": {"basis": "elements", "modes": degree}, "general": True, "coupled": [],
            "ends": ("free", "free"), "rigid": rigid, "load": "P", "damping": ["alpha", "beta"], "force": True,
            "parameters": [ratio, *(gains if law is not None else [])], "latex": {"P": "P_0", "x": "x"},
            "fields": [{"name": "y"}, {"name": "psi"}],
        }  # fmt: skip

    # --- what a kernel offers --------------------------------------------------------------------------------------

    def basis(self, N: int) -> Functions:
        """Trial functions whose moments are polynomials of degree N on each element."""
        return _functions(self, N)

    def places(self, one: float = 1.0, **own: float) -> tuple[float, ...]:
        """Where elements begin and end."""
        return tuple((one * self.breaks).tolist())

    def mass_terms(self, basis: Functions, **own: float) -> tuple[Array, ...]:
        return (basis.M,)

    def stiffness_terms(self, basis: Functions, gain: float = 0.0, **own: float) -> tuple[Array, ...]:
        E, H = self._steered(basis, gain)
        return basis.E + E, basis.H + H

    def rate_terms(
        self, basis: Functions, alpha: float, beta: float, ratio: float = 0.0, rate: float = 0.0, **own: float
    ) -> tuple[Array, ...]:
        C = basis.C + alpha * basis.material
        n = len(C) - self.acts  # without an actuator, which has its own damping
        C[:n, :n] += beta * basis.M[:n, :n]
        elastic = np.arange(self.free, n)
        C[elastic, elastic] += 2 * ratio * np.sqrt(basis.M[elastic, elastic])  # modes with E = 1: 1/ω² is their mass
        E, H = self._steered(basis, rate)
        return C + E, H

    def _steered(self, basis: Functions, gain: float) -> tuple[Array, Array]:
        """What a gain of the slope adds, or of its rate, without load and by the load."""
        if not self.acts:
            return np.zeros_like(basis.M), gain * np.outer(basis.push, basis.turn)
        E, H = np.zeros_like(basis.M), np.zeros_like(basis.M)
        E[-1] = -gain * basis.turn
        return E, H

    def rigid_motions(self, basis: Functions, **own: float) -> Array:
        """1, and x where nothing restores it, as the first of the functions, (n, rigid)."""
        return np.eye(len(basis.M))[:, : self.COLUMN["rigid"]]

    def force(self, basis: Functions, x: float, **own: float) -> Array:
        return self.rows(basis, x)[0]

    def shapes(self, basis: Functions, x: Array, field: str, derivative: int = 0, side: int = 0, **own: float) -> Array:
        """y or ψ at places, or a derivative of them: of y the first two, of ψ the first; (n, *x.shape)."""
        which = {("y", 0): 0, ("y", 1): 1, ("psi", 0): 2, ("psi", 1): 3}.get((field, derivative))
        if which is None:
            raise ValueError(f"the derivative of order {derivative} of {field} is not continuous along a table")
        found = np.array([self.rows(basis, place, side)[which] for place in x.ravel().tolist()])
        return found.reshape(*x.shape, len(basis.M)).transpose(-1, *range(x.ndim))

    def left_out(self, basis: Functions, vector: NDArray[np.complex128], rate: complex) -> float:
        """The relative error of λ² for what the functions have not, about: the energy of the shear force J ψ̈, relative
        to the elastic one of a motion of rate λ in their coordinates, (n,), and `DROPPED` for the highest modes."""
        dropped = DROPPED * basis.dropped
        if self.table.shear is None or self.table.rotary is None:
            return dropped
        GA, J = self.values(self.table.shear), self.values(self.table.rotary)
        slope = np.tensordot(vector, self.slopes(basis), 1)
        missing = np.abs(rate**2 * J * slope) ** 2 / GA
        energy = float((vector.conj() @ basis.E @ vector).real)
        return float((self.h[:, None] * self.weights * missing).sum()) / energy + dropped

    def slopes(self, basis: Functions) -> Array:
        """ψ at Gauss's nodes, (n, panels, NODES)."""
        once = np.array([_integrated(node)[1] for node in self.nodes])
        return np.asarray(basis.psi[:, :, None] + self.h[:, None] * (basis.rate @ once.T))

    def scales(self, bending_stiffness: float, mass_per_length: float, length: float) -> dict[str, float]:
        from freebeam_kernels.free_free import scales

        return scales(bending_stiffness, mass_per_length, length)

    def newmark_step(self, *state: Any) -> Any:
        from freebeam_kernels.free_free import newmark_step

        return newmark_step(*state)

    # --- along the beam --------------------------------------------------------------------------------------------

    def rows(self, basis: Functions, x: float, side: int = -1) -> tuple[Array, Array, Array, Array]:
        """y, y′, ψ and ψ′ of the functions at x, each (n,); by default just ahead of a place where they jump."""
        panel = int(np.searchsorted(self.edges, x, "left" if side < 0 else "right")) - 1
        panel = min(max(panel, 0), len(self.h) - 1)
        h = self.h[panel]
        at, once, twice = _integrated((x - self.edges[panel]) / h)
        rate, shear = basis.rate[:, panel], basis.shear[:, panel]
        psi = basis.psi[:, panel] + h * (rate @ once)
        y = (
            basis.y[:, panel]
            + (x - self.edges[panel]) * basis.psi[:, panel]
            + h * (shear @ once)
            + h**2 * (rate @ twice)
        )
        return y, psi + shear @ at, psi, rate @ at

    def values(self, of: Array) -> Array:
        """A quantity of the table, (s, 2), at Gauss's nodes, (panels, NODES)."""
        x = self.table.x
        k = np.searchsorted(x, (self.edges[:-1] + self.edges[1:]) / 2) - 1
        share = (self.points - x[k][:, None]) / np.diff(x)[k][:, None]
        return np.asarray(of[k, :1] * (1 - share) + of[k, 1:] * share)

    def _ahead(self) -> tuple[Array, float]:
        """The share of the mass ahead of Gauss's nodes, (panels, NODES), and the mass of all."""
        m = self.values(self.table.mass)
        whole = np.concatenate([[0.0], np.cumsum(self.h * (m @ self.weights))])
        once = np.array([_integrated(node)[1] for node in self.nodes])
        ahead = whole[:-1, None] + self.h[:, None] * (m @ once.T)
        total = float(whole[-1])
        for part in self.parts:
            ahead += part.mass * (self.points > part.x)
            total += part.mass
        return ahead / total, total


def tabulated(table: Table, parts: tuple[Part, ...] = (), law: Law | None = None) -> Column:
    """The column of a table with parts, its thrust at x = 1, turned by a law where one is given. `modes` is the degree
    of the bending moment on an element.

    Raises InputError where one spring alone holds it.
    """
    return _TabulatedColumn(cast(ModuleType, Tabulated(table, parts, law)))


class _TabulatedColumn(Column):
    """A column that goes to another process as its tables."""

    def __reduce__(self) -> tuple[Any, ...]:
        kernel = cast(Tabulated, self.kernel)
        return tabulated, (kernel.table, kernel.parts, kernel.law)


def _turns(part: Part) -> bool:
    """Whether it turns the beam with a couple, over which the bending moment jumps."""
    return part.rotary > 0 or part.kind == "sprung"


def _edges(table: Table, parts: tuple[Part, ...], seen: list[float]) -> tuple[Array, Array]:
    """Ends of the panels, and of the elements among them."""
    weight: dict[float, tuple[bool, bool, float]] = {}
    for part in parts:
        own = _turns(part), part.kind != "mass", part.mass
        weight[part.x] = max(own, weight.get(part.x, own))
    places = sorted(weight, key=lambda x: weight[x], reverse=True)
    heaviest = places[:MOST_BREAKS]
    steps = np.zeros(len(table.x) - 2)
    for of in (table.bending, table.mass, table.shear):
        if of is not None:
            left, right = of[:-1, 1], of[1:, 0]
            steps = np.maximum(steps, np.abs(right - left) / np.maximum(np.maximum(left, right), 1e-300))
    largest = np.argsort(-steps, kind="stable")[: MOST_BREAKS // 2]
    jumps = table.x[1:-1][largest[steps[largest] > 0.05]]
    coarse = _distinct([0.0, 1.0, *seen, *heaviest, *jumps], 1e-6)
    breaks = _distinct([x for a, b in pairwise(coarse) for x in np.linspace(a, b, int(np.ceil((b - a) / LONGEST)) + 1)])
    panels = [*breaks, *table.x, *places]
    for a, b in pairwise(breaks):
        panels += np.linspace(a, b, 9).tolist()
    for (a, b), (low, high) in zip(pairwise(table.x), table.bending, strict=True):
        count = int(np.ceil(abs(np.log(high / low)) / np.log(STEEPEST)))
        if count > 1:
            stiffness = low * (high / low) ** (np.arange(1, count) / count)
            panels += (a + (b - a) * (stiffness - low) / (high - low)).tolist()
    return _distinct(panels), breaks


def _distinct(places: Any, apart: float = 1e-12) -> Array:
    """Ascending, without those closer than `apart` to the one before; the last one stays."""
    found = np.unique(np.asarray(places, dtype=float))
    kept: Array = found[np.concatenate([[True], np.diff(found) > apart])]
    kept[-1] = found[-1]
    return kept


def _integrated(xi: float) -> tuple[Array, Array, Array]:
    """What gives a polynomial's value at ξ, its integral from 0 to ξ and the integral of that, from its values at
    Gauss's nodes on 0 to 1: (NODES,) each."""
    k = np.arange(float(NODES))
    at = xi**k
    return at @ _VANDERMONDE, (at * xi / (k + 1)) @ _VANDERMONDE, (at * xi**2 / ((k + 1) * (k + 2))) @ _VANDERMONDE


_VANDERMONDE = np.linalg.inv(np.vander((np.polynomial.legendre.leggauss(NODES)[0] + 1) / 2, increasing=True))


def _moments(kernel: Tabulated, N: int, x: Array) -> tuple[Array, Array]:
    """The moments at places within the elements and their derivatives, (functions, *x.shape): hats, and integrals of
    Legendre's polynomials. A hat for either side stands at a break that is opened, none at an end that is not."""
    breaks, flat = kernel.breaks, x.ravel()
    elements = np.arange(len(breaks) - 1)
    first = elements * N + np.cumsum(kernel.opened[:-1] & (elements > 0))
    value, slope = np.zeros((2, int(first[-1]) + N + 1, len(flat)))
    element = np.clip(np.searchsorted(breaks, flat, "right") - 1, 0, len(breaks) - 2)
    half = np.diff(breaks)[element] / 2
    xi = (flat - breaks[element]) / half - 1
    P = np.polynomial.legendre.legvander(xi, max(N, 1)).T
    each, first = np.arange(len(flat)), first[element]
    for place, sign in ((first, -1), (first + N, 1)):
        value[place, each], slope[place, each] = (1 + sign * xi) / 2, sign / (2 * half)
    for k in range(1, N):
        value[first + k, each], slope[first + k, each] = P[k + 1] - P[k - 1], (2 * k + 1) * P[k] / half
    kept = slice(int(not kernel.opened[0]), len(value) - int(not kernel.opened[-1]))
    value, slope = value[kept], slope[kept]
    return value.reshape(len(value), *x.shape), slope.reshape(len(value), *x.shape)


def _functions(kernel: Tabulated, N: int) -> Functions:
    table, h, w = kernel.table, kernel.h, kernel.weights
    EI = kernel.values(table.bending)
    moments, slopes = _moments(kernel, N, kernel.points)
    joints = [part for part in kernel.parts if part.kind == "joint"]
    sprung = [part for part in kernel.parts if part.kind == "sprung"]
    at_joints = _moments(kernel, N, np.array([part.x for part in joints]))[0]
    GA = None if table.shear is None else kernel.values(table.shear)
    J = None if table.rotary is None else kernel.values(table.rotary)
    b = len(moments)
    n = 2 + b + len(sprung)
    rate, shear = np.zeros((n, *EI.shape)), np.zeros((n, *EI.shape))
    rate[2 : 2 + b] = moments / EI
    if GA is not None:
        shear[2 : 2 + b] = -slopes / GA
    # ψ and y at the left ends of the panels, then at Gauss's nodes
    once, twice = (np.array([_integrated(node)[k] for node in kernel.nodes]) for k in (1, 2))
    turned = (rate @ w) * h
    for k, joint in enumerate(joints):
        turned[2 : 2 + b, int(np.abs(kernel.edges - joint.x).argmin()) - 1] += at_joints[:, k] / joint.stiffness
    psi = np.concatenate([np.zeros((n, 1)), np.cumsum(turned, axis=1)[:, :-1]], axis=1)
    psi[1] = 1.0
    across = h * psi + h * (shear @ w) + h**2 * (rate @ (w * (1 - kernel.nodes)))
    y = np.concatenate([np.zeros((n, 1)), np.cumsum(across, axis=1)[:, :-1]], axis=1)
    y[0], y[1] = 1.0, kernel.edges[:-1]
    slope = psi[:, :, None] + h[:, None] * (rate @ once.T)
    deflection = y[:, :, None] + (h[:, None] * kernel.nodes) * psi[:, :, None]
    deflection += h[:, None] * (shear @ once.T) + h[:, None] ** 2 * (rate @ twice.T)
    weights = h[:, None] * w

    def integral(f: Array, density: Array) -> Array:
        flat = f.reshape(n, -1)
        whole = (flat * (weights * density).ravel()) @ flat.T
        return np.asarray((whole + whole.T) / 2)  # symmetric to the last bit, which tells the search so

    M = integral(deflection, kernel.values(table.mass))
    if J is not None:
        M += integral(slope, J)
    E = integral(rate, EI)
    if GA is not None:
        E += integral(shear, GA)
    for k, joint in enumerate(joints):
        E[2 : 2 + b, 2 : 2 + b] += np.outer(at_joints[:, k], at_joints[:, k]) / joint.stiffness
    H = -integral(slope + shear, kernel.ahead)
    functions = Functions(N, rate, shear, psi, y, M, E, E.copy(), H, np.zeros((n, n)), np.zeros(n), np.zeros(n))
    for k, joint in enumerate(joints):
        turn = at_joints[:, k] / joint.stiffness
        functions.C[2 : 2 + b, 2 : 2 + b] += joint.damping * np.outer(turn, turn)
    own = iter(range(2 + b, n))
    for part in kernel.parts:
        if part.kind != "joint":
            _add(kernel, functions, part, next(own) if part.kind == "sprung" else -1)
    end, _, thrust, _ = kernel.rows(functions, 1.0)
    functions.H[:] += np.outer(end, thrust)
    return _steered(kernel, _in_modes(functions, kernel.free))


def _in_modes(f: Functions, rigid: int) -> Functions:
    """The same in the rigid motions and the modes of the unloaded beam, each of elastic energy 1/2; but for the
    highest, which short elements bring and which would only be rounded."""
    r, e = slice(0, rigid), slice(rigid, None)
    along = np.linalg.solve(f.M[r, r], f.M[r, e])
    # from the side of the energy, so that the low frequencies are not rounded beside the highest
    try:
        L = np.linalg.cholesky(f.E[e, e])
    except np.linalg.LinAlgError:
        raise InputError("the springs and joints leave the beam without stiffness, but for rounding") from None
    half = np.linalg.solve(L, np.linalg.solve(L, f.M[e, e] - f.M[e, r] @ along).T)
    inverse, Y = np.linalg.eigh((half + half.T) / 2)
    kept = inverse > inverse[-1] / HIGHEST
    inverse, modes = inverse[kept][::-1], np.linalg.solve(L.T, Y[:, kept][:, ::-1])
    T = np.block([[np.eye(rigid), -along @ modes], [np.zeros((len(modes), rigid)), modes]])
    M, E = np.zeros((2, T.shape[1], T.shape[1]))
    M[r, r], M[e, e], E[e, e] = f.M[r, r], np.diag(inverse), np.eye(len(inverse))
    rate, shear, psi, y = (np.tensordot(T.T, of, 1) for of in (f.rate, f.shear, f.psi, f.y))
    material, H, C = (T.T @ of @ T for of in (f.material, f.H, f.C))
    material, C = (material + material.T) / 2, (C + C.T) / 2
    none = np.zeros(T.shape[1])
    return Functions(f.degree, rate, shear, psi, y, M, E, material, H, C, none, none, not kept.all())


def _steered(kernel: Tabulated, f: Functions) -> Functions:
    """With what the thrust acts on and the sensor sees, and the actuator's angle as a last coordinate."""
    if kernel.acts:
        M, E, material, H, C = (np.pad(of, (0, 1)) for of in (f.M, f.E, f.material, f.H, f.C))
        rate, shear = (np.pad(of, ((0, 1), (0, 0), (0, 0))) for of in (f.rate, f.shear))
        psi, y = (np.pad(of, ((0, 1), (0, 0))) for of in (f.psi, f.y))
        f = Functions(f.degree, rate, shear, psi, y, M, E, material, H, C, f.turn, f.push, f.dropped)
    push = kernel.rows(f, 1.0)[0]
    if kernel.law is None:
        return f._replace(push=push, turn=np.zeros_like(push))
    if kernel.law.frequency is not None:
        w, zeta = kernel.law.frequency, kernel.law.ratio
        f.M[-1, -1], f.C[-1, -1], f.E[-1, -1] = 1 / w**2, 2 * zeta / w, 1.0
        f.H[:, -1] += push
    return f._replace(turn=kernel.rows(f, kernel.law.sensor)[2], push=push)


def _add(kernel: Tabulated, f: Functions, part: Part, own: int) -> None:
    """A part's share of the matrices; own: the coordinate of a sprung mass, its motion w beside the beam."""
    y, _, psi, _ = kernel.rows(f, part.x)
    f.M[:] += part.rotary * np.outer(psi, psi)
    moved = y.copy()
    if part.kind == "sprung":
        w = np.zeros(len(y))
        w[own] = 1.0
        moved += w
        # what accelerates the mass along the beam acts at w beside it, and turns with it
        f.H[:] += part.mass / kernel.total * (np.outer(w, psi) + np.outer(psi, w))
    f.M[:] += part.mass * np.outer(moved, moved)
    held = y if part.kind == "spring" else moved - y
    f.E[:] += part.stiffness * np.outer(held, held)
    f.C[:] += part.damping * np.outer(held, held)
