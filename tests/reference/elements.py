"""Columns by Hermite's cubic elements in float64: M, C(P), K(P), and the first loss of stability by a plain scan.

Timoshenko's beam has cubics for y and for ψ alike. Errors of Euler's beam's eigenvalues fall as h⁴.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import eig, eigvals, null_space

from tests.reference.systems import At, Beam, Segment

Array = np.ndarray
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)
POINTS, WEIGHTS = (POINTS + 1) / 2, WEIGHTS / 2


@dataclass(frozen=True)
class Matrices:
    """M ü + (C0 + P C1 + P² C2) u̇ + (K0 + P K1 + P² K2) u = 0."""

    M: Array
    C: tuple[Array, Array, Array]
    K: tuple[Array, Array, Array]

    def damping(self, P: float) -> Array:
        return self.C[0] + P * self.C[1] + P**2 * self.C[2]

    def stiffness(self, P: float) -> Array:
        return self.K[0] + P * self.K[1] + P**2 * self.K[2]


@dataclass(frozen=True)
class Loss:
    load: float
    kind: str
    omega: float


def hermite(u: float, h: float) -> Array:
    """The four cubics of one element and two derivatives in x, at u in [0, 1]."""
    return np.array(
        [
            [1 - 3 * u**2 + 2 * u**3, h * (u - 2 * u**2 + u**3), 3 * u**2 - 2 * u**3, h * (u**3 - u**2)],
            [6 * (u * u - u) / h, 1 - 4 * u + 3 * u**2, 6 * (u - u * u) / h, 3 * u**2 - 2 * u],
            [(12 * u - 6) / h**2, (6 * u - 4) / h, (6 - 12 * u) / h**2, (6 * u - 2) / h],
        ]
    )


class Mesh:
    """Nodes, and the number of each degree of freedom: (field, derivative, node, side)."""

    def __init__(self, beam: Beam, count: int):
        self.beam = beam
        stops = {0.0, 1.0} | {float(s.low) for s in beam.segments}
        places = sorted(stops | {float(at.place) for at in beam.sights if at.kind != "q"})
        parts = [np.linspace(a, b, max(1, round(count * (b - a))) + 1)[:-1] for a, b in pairwise(places)]
        self.nodes = np.append(np.concatenate(parts), 1.0)
        if beam.shear is not None and len(places) > 2:
            raise ValueError("elements of Timoshenko's beam hold y' and ψ' continuous: no break or place inside")
        jumps = {(at.kind, self.node(at)) for at in beam.sights if at.kind.startswith("jump")}
        self.number: dict[tuple[str, int, int, int], int] = {}
        self.size = 0
        for node in range(len(self.nodes)):
            for field in ("y",) if beam.shear is None else ("y", "slope"):
                for derivative in (0, 1):
                    seen = "slope" if (field, derivative) == ("y", 1) else field  # y' is the slope of Euler's beam
                    free = (f"jump {seen}", node) in jumps
                    self.number[field, derivative, node, -1] = self.size
                    self.size += free
                    self.number[field, derivative, node, +1] = self.size
                    self.size += 1
        self.coordinates = sorted({at.place for at in beam.sights if at.kind == "q"})
        self.size += len(self.coordinates)

    def node(self, at: At) -> int:
        return int(np.abs(self.nodes - float(at.place)).argmin())

    def row(self, at: At) -> Array:
        """What is seen, as a row over the degrees of freedom."""
        out = np.zeros(self.size)
        if at.kind == "q":
            out[self.size - len(self.coordinates) + self.coordinates.index(at.place)] = 1
            return out
        kind = at.kind.removeprefix("jump ")
        if kind == "dy" or (kind == "slope" and self.beam.shear is None):
            which = ("y", 1, self.node(at))
        else:
            which = (kind, 0, self.node(at))
        if at.kind.startswith("jump"):
            out[self.number[*which, +1]] = 1
            out[self.number[*which, -1]] = -1
        else:
            out[self.number[*which, at.side]] = 1
        return out

    def held(self) -> list[int]:
        out = []
        for end, node, side in ((self.beam.ends[0], 0, -1), (self.beam.ends[1], len(self.nodes) - 1, 1)):
            if end in ("clamped", "pinned"):
                out.append(self.number["y", 0, node, side])
            if end == "clamped":
                out.append(self.number[*(("y", 1) if self.beam.shear is None else ("slope", 0)), node, side])
        return out


def density(beam: Beam, part: Segment, x: float, P: float, H: Array) -> dict[str, Array]:
    """The integrand of each matrix at x; H holds each field's shapes and derivatives as rows over all of an element."""
    y, dy = H[0, 0], H[0, 1]
    out = {"M": part.mass(x) * np.outer(y, y), "C": part.damping(x) * np.outer(y, y)}
    out["K"] = part.spring(x) * np.outer(y, y) - part.axial(x, P) * np.outer(dy, dy)
    if beam.shear is None:
        bending = part.EI(x) * np.outer(H[0, 2], H[0, 2])
        out["M"] += part.rotary(x) * np.outer(dy, dy)
        out["C"] += part.gyro(x, P) * np.outer(y, dy)
        out["K"] += part.flow(x, P) * np.outer(y, dy)
    else:
        gap = dy - H[1, 0]
        bending = part.EI(x) * np.outer(H[1, 1], H[1, 1]) + float(beam.shear) * np.outer(gap, gap)
        out["M"] += part.rotary(x) * np.outer(H[1, 0], H[1, 0])
    out["K"] += bending
    out["C"] += float(beam.alpha) * bending
    return out


def at_load(beam: Beam, mesh: Mesh, P: float) -> dict[str, Array]:
    out = {name: np.zeros((mesh.size, mesh.size)) for name in "MCK"}
    fields = ("y",) if beam.shear is None else ("y", "slope")
    for e, (low, high) in enumerate(pairwise(mesh.nodes)):
        part = next(s for s in beam.segments if float(s.low) < (low + high) / 2 < float(s.high))
        # right of the node at its left, left of the node at its right
        places = [mesh.number[f, d, e + n, 1 - 2 * n] for f in fields for n in (0, 1) for d in (0, 1)]
        for u, weight in zip(POINTS, WEIGHTS, strict=True):
            H = np.zeros((len(fields), 3, 4 * len(fields)))
            for f in range(len(fields)):
                H[f, :, 4 * f : 4 * f + 4] = hermite(u, high - low)
            for name, value in density(beam, part, float(low + u * (high - low)), P, H).items():
                out[name][np.ix_(places, places)] += (high - low) * weight * value
    for term in beam.terms:
        both = np.outer(mesh.row(term.moves), mesh.row(term.sees))
        out["M"] += float(term.mass) * both
        out["C"] += float(term.damping) * both
        out["K"] += float(term.stiffness(P)) * both
    return out


def assemble(beam: Beam, count: int = 24) -> Matrices:
    """The matrices of about `count` elements; the load may enter to the second power."""
    mesh = Mesh(beam, count)
    low, mid, high = (at_load(beam, mesh, P) for P in (-1.0, 0.0, 1.0))
    basis = np.delete(np.eye(mesh.size), mesh.held(), axis=1)
    if beam.rigid:  # the others are M-orthogonal to the rigid motions: then the zero eigenvalues leave, and only those
        motions = np.zeros((mesh.size, 2))
        for node, x in enumerate(mesh.nodes):
            for side in (-1, 1):
                motions[mesh.number["y", 0, node, side], :] = 1.0, x
                motions[mesh.number["y", 1, node, side], :] = 0.0, 1.0
        motions = motions[:, : beam.rigid]
        basis = null_space(motions.T @ mid["M"])

    def form(name: str) -> tuple[Array, Array, Array]:
        minus, none, plus = (basis.T @ one[name] @ basis for one in (low, mid, high))
        return none, (plus - minus) / 2, (plus + minus) / 2 - none

    return Matrices(form("M")[0], form("C"), form("K"))


def state(matrices: Matrices, P: float) -> Array:
    """The matrix with eigenvalues 1/λ: of the inverse, so that low modes keep their digits."""
    M, C, K = matrices.M, matrices.damping(P), matrices.stiffness(P)
    n = len(M)
    return np.vstack([np.hstack([-np.linalg.solve(K, C), -np.linalg.solve(K, M)]), np.eye(n, 2 * n)])


def kept(values: Array) -> Array:
    """Eigenvalues of low modes: the others are the elements', not the beam's."""
    return values[np.abs(values) > 1e-4 * np.abs(values).max()]


def growing(beam: Beam, matrices: Matrices, P: float) -> bool:
    """Whether an eigenvalue grows, beyond rounding, or is zero."""
    try:
        t = kept(eigvals(state(matrices, P) if beam.damped else np.linalg.solve(matrices.stiffness(P), matrices.M)))
    except np.linalg.LinAlgError:
        return True
    if beam.damped:  # 1/λ
        return bool((t.real > 1e-10 * np.abs(t).max()).any())
    # 1/ω²
    return bool((np.abs(t.imag) > 3e-6 * np.abs(t)).any() or (t.real < 0).any())


def bisect(grows: Callable[[float], bool], low: float, high: float, steps: int) -> float:
    for _ in range(steps):
        mid = (low + high) / 2
        low, high = (low, mid) if grows(mid) else (mid, high)
    return high


def first_loss(beam: Beam, top: float, count: int = 24, coarse: int = 10, grid: int = 150) -> Loss | None:
    """The first load up to `top` from which motions grow: a scan of a coarse mesh, then bisection on the fine one."""
    rough, fine = assemble(beam, coarse), assemble(beam, count)
    loads = np.linspace(0, top, grid + 1)[1:]
    low = next((P for P in loads if growing(beam, rough, P)), None)
    if low is None:
        return None
    width = top / grid
    while low > width and growing(beam, fine, low - width):
        low -= width
    while not growing(beam, fine, low):
        low += width
    load = bisect(lambda P: growing(beam, fine, P), low - width, low, 34)
    omega = frequency(beam, fine, load)
    return Loss(load, "flutter" if omega > 1e-3 else "divergence", omega)


def frequency(beam: Beam, matrices: Matrices, P: float) -> float:
    """Of the motion that grows at P."""
    if not beam.damped:
        t = kept(eigvals(np.linalg.solve(matrices.stiffness(P), matrices.M)))
        if t.real.min() < 0 and -t.real.min() > 0.5 * np.abs(t).max():
            return 0.0
        return float(np.sqrt(1 / t[(np.abs(t.imag) / np.abs(t)).argmax()]).real)
    t = kept(eigvals(state(matrices, P)))
    return float(abs((1 / t[t.real.argmax()]).imag))


def lowest(matrices: Matrices, P: float, count: int) -> Array:
    """The `count` lowest ω² without damping."""
    values = eig(matrices.stiffness(P), matrices.M, right=False)
    return np.sort(values.real)[:count]
