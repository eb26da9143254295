"""Pinned-pinned beam under a dead axial load: ends pinned and pinned.

M q̈ + C q̇ + (E + P H) q = F_0 Q with trial functions that are polynomials, Eqs. (10), (11):

    M[i, j] = ∫ φᵢ φⱼ dx
    E[i, j] = ∫ φᵢ″ φⱼ″ dx
    H[i, j] = −∫ φᵢ′ φⱼ′ dx
    C = beta M + alpha E

Each is the polynomial of its degree that meets the geometric conditions and is orthogonal to all of lower degree
that do, in a series of Legendre's polynomials P_k(2x − 1). All quantities are nondimensional, Eq. (5).

The load, the dampings and the column's own parameters may be arrays of shape (..., 1, 1): matrices are then
(..., n, n).

Source: Euler, Methodus inveniendi lineas curvas, Additamentum I (1744).

Derived from the energies and emitted by `freebeam generate euler-pinned`; do not edit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.floating[Any]]  # or an array of another library that follows the Python array API

COLUMN: dict[str, Any] = {
    "name": "euler-pinned",
    "title": "Pinned-pinned beam under a dead axial load",
    "basis": "legendre",
    "default": {"basis": "legendre", "modes": 16},
    "ends": ("pinned", "pinned"),
    "rigid": 0,
    "load": "P",
    "damping": ["alpha", "beta"],
    "force": True,
    "parameters": [],
    "forms": {"M": "∫ φᵢ φⱼ dx", "E": "∫ φᵢ″ φⱼ″ dx", "H": "−∫ φᵢ′ φⱼ′ dx"},
    "latex": {
        "x": "x",
        "t": "t",
        "P": "P_0",
        "alpha": "\\alpha",
        "beta": "\\beta",
        "x_F": "x_F",
        "y": "y",
        "F_0": "F_0",
    },
    "meaning": {
        "x": "place along the beam, 0 to 1",
        "t": "time",
        "P": "load: the axial or follower force",
        "alpha": "internal (Kelvin-Voigt) damping",
        "beta": "external (viscous) damping",
        "x_F": "place of the transversal (controller) force",
        "y": "deflection",
        "F_0": "transversal (controller) force",
    },
    "source": "Euler, Methodus inveniendi lineas curvas, Additamentum I (1744)",
}


def _namespace(array: Any) -> Any:
    """NumPy, or the array API's functions of the library that an array is from."""
    if isinstance(array, np.ndarray):
        return np
    if hasattr(array, "__array_namespace__"):
        return array.__array_namespace__()
    library = __import__(type(array).__module__.partition(".")[0])  # such as PyTorch, whose tensors name no namespace
    return library if hasattr(library, "asarray") else np


def _diagonal(values: Any, order: Any) -> Array:
    """The diagonal matrix of values, one for each of some numbers, all different."""
    if isinstance(values, np.ndarray) and values.ndim == 1:
        return np.diag(values)  # faster
    matrix: Array = _namespace(values).where(order[:, None] == order, values, 0 * values)
    return matrix


def _like(x: Any, array: Any) -> Array:
    """x as an array of the library, the numbers and the device of another."""
    if isinstance(array, np.ndarray):
        return np.asarray(x, dtype=array.dtype)
    xp = _namespace(array)
    found: Array = (
        xp.asarray(x, dtype=array.dtype, device=getattr(array, "device", None))
        if _namespace(x) is not xp
        else x.to(array)  # PyTorch
        if hasattr(x, "to")
        else xp.astype(x, array.dtype)
    )
    return found


class Basis(NamedTuple):
    """The first N elastic functions: polynomials of degree 2, 3, …

    order: orders k of Legendre's polynomials P_k(2x − 1), (2 + N,)
    sigma: (−1)^k, (2 + N,)
    norm: ∫ φ² dx, (N,)
    deflection: φ in P_0, P_1, …, (N, 2 + N)
    slope: φ′ in P_0, P_1, …, (N, 2 + N)
    moment: φ″ in P_0, P_1, …, (N, 2 + N)
    """

    order: Array
    sigma: Array
    norm: Array
    deflection: Array
    slope: Array
    moment: Array


def complete(order: Array, sigma: Array) -> Basis:
    """All that is known of the functions, from the orders 0, 1, …, D − 1 and their signs (−1)^k: N = D − 2. Eq. (9).

    The arrays may hold floats, or any numbers that can be divided, such as fractions or intervals: then so does the
    result.
    """
    xp = _namespace(order)
    degree, zero = order[2:], 0 * order
    weight_1 = 1 / (degree * (degree - 1))
    weight_2 = 1 / (degree * (degree - 1))
    share = sigma[2:, None] * sigma * (weight_1[:, None]) + weight_2[:, None]
    below = -(2 * order + 1) * share
    deflection = xp.where(order < degree[:, None], below, 0 * below)
    deflection = xp.where(order == degree[:, None], zero + 1, deflection)
    derivative = _derivative(order, sigma)
    slope = deflection @ derivative
    moment = slope @ derivative
    norm = ((degree + 1) * (degree + 2)) / (degree * (degree - 1) * (2 * degree + 1))
    return Basis(order, sigma, norm, deflection, slope, moment)


def _derivative(order: Array, sigma: Array) -> Array:
    """What a series is multiplied by, from the right, to give its derivative: P_k′ = Σ 2 (2m + 1) P_m."""
    lower = (1 - sigma[:, None] * sigma) * (2 * order + 1)
    value: Array = _namespace(order).where(order < order[:, None], lower, 0 * lower)
    return value


def basis(N: int, xp: Any = np, dtype: Any = None, device: Any = None) -> Basis:
    """The functions of degree up to N + 1, N of them elastic. Eq. (9), section 3.1.

    xp: the array API's functions in whose arrays the basis comes, such as jax.numpy or torch. dtype: its real
    numbers, float64 unless told. device: where the arrays are kept, as xp names it.
    """
    kind = {"dtype": xp.float64 if dtype is None else dtype, "device": device}
    order = xp.arange(2 + N, **kind)
    return complete(order, 1 - 2 * (order % 2))


def shapes(basis: Basis, x: ArrayLike, derivative: int = 0, rigid: bool = False) -> Array:
    """Trial functions or a derivative of them, shape (N, *x.shape). Eq. (9).

    x: places in units of the length, any shape. derivative: its order, 0 or more.
    rigid: this column has no rigid functions, so it changes nothing.
    """
    xp, places = _namespace(basis.order), _like(x, basis.order)
    series = basis.deflection
    for _ in range(derivative):
        series = series @ _derivative(basis.order, basis.sigma)
    value: Array = series @ _legendre(basis.order.shape[0], xp.reshape(places, (-1,)))
    found: Array = xp.reshape(value, (value.shape[0], *places.shape))
    return found


def _legendre(count: int, x: Array) -> Array:
    """P_k(2x − 1) for k below count, shape (count, x.size).

    By their differences, in the distance from the nearer end, so that nothing cancels there.
    """
    xp = _namespace(x)
    near = xp.minimum(x, 1 - x)
    value = 0 * x + 1
    odd = xp.where(x < 0.5, -value, value)  # sign of the odd ones
    step = -2 * near
    rows = [value]
    for k in range(1, count):
        value = value + step
        step = (k * step - 2 * (2 * k + 1) * near * value) / (k + 1)
        rows.append(value * odd if k % 2 else value)
    found: Array = xp.reshape(xp.concat(rows), (count, x.shape[0]))
    return found


def _integrals_0(order: Array) -> Array:
    """∫ P_m P_n dx, shape (D, D)."""
    value: Array = _diagonal(1 / (2 * order + 1), order)
    return value


def mass(basis: Basis, rigid: bool = False) -> Array:
    """Mass matrix M, shape (N, N), nondimensional. Eq. (11), first line.

    M[i, j] = ∫ φᵢ φⱼ dx
    """
    M: Array = _diagonal(basis.norm, basis.order[: basis.norm.shape[0]])
    return M


def stiffness_elastic(basis: Basis, rigid: bool = False) -> Array:
    """Elastic stiffness matrix E of K = E + P H, shape (N, N), nondimensional. Eq. (11), third line at zero load.

    E[i, j] = ∫ φᵢ″ φⱼ″ dx
    """
    E: Array = basis.moment @ _integrals_0(basis.order) @ basis.moment.T
    E = (E + E.mT) / 2  # to the last bit
    return E


def stiffness_load(basis: Basis, rigid: bool = False) -> Array:
    """Load matrix H of K = E + P H, shape (N, N), nondimensional. Eq. (11), third line, divided by the load;
    Eq. (13).

    H[i, j] = −∫ φᵢ′ φⱼ′ dx
    """
    H: Array = -(basis.slope @ _integrals_0(basis.order) @ basis.slope.T)
    H = (H + H.mT) / 2  # to the last bit
    return H


def damping_factors(alpha: float, beta: float) -> tuple[float, float]:
    """c_M and c_E of C = c_M M + c_E E: the external and the internal damping. Eq. (12)."""
    return beta, alpha


def damping(basis: Basis, alpha: float, beta: float, rigid: bool = False) -> Array:
    """Damping matrix C = c_M M + c_E E with c_M = beta, c_E = alpha, nondimensional. Eqs. (11), (12)."""
    c_M, c_E = damping_factors(alpha, beta)
    return c_M * mass(basis, rigid) + c_E * stiffness_elastic(basis, rigid)


def force(basis: Basis, x_F: float, rigid: bool = False) -> Array:
    """Generalised force Q of Q F_0(t), shape (N,) or with the rigid functions first, nondimensional. Eq. (11), last
    line.

    Q[i] = φᵢ(x_F)

    x_F: place of the transversal force, 0 to 1.
    """
    return shapes(basis, x_F, rigid=rigid)


def forms(one: Any = 1) -> dict[str, Any]:
    """The bilinear forms M, E, H: factors of ∫ xᵏ φᵢ⁽ᵖ⁾ φⱼ⁽ᑫ⁾ dx under (k, p, q), and of φᵢ⁽ᵖ⁾(a) φⱼ⁽ᑫ⁾(b) under
    (a, p, b, q). Eq. (11).

    one: 1 as a number of the kind wanted, such as a fraction or an interval.
    """
    return {"M": ({(0, 0, 0): 1}, {}), "E": ({(0, 2, 2): 1}, {}), "H": ({(0, 1, 1): -1}, {})}


def equation(P: Any, alpha: Any = 0, beta: Any = 0, one: Any = 1) -> dict[tuple[int, int], tuple[Any, ...]]:
    """The equation of motion without force: (p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ, ascending in powers of x. Eq. (6)."""
    return {(0, 1): (beta,), (0, 2): (1,), (2, 0): (P,), (4, 0): (1,), (4, 1): (alpha,)}


def end_conditions(P: Any, alpha: Any = 0, beta: Any = 0, one: Any = 1) -> tuple[Any, Any]:
    """Two conditions at x = 0 and two at x = 1: (p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ there. Eq. (15)."""
    return (({(0, 0): 1}, {(2, 0): -1, (2, 1): -alpha}), ({(0, 0): 1}, {(2, 0): 1, (2, 1): alpha}))


def newmark_step(
    M: Array,
    C: Array,
    K: Array,
    q: Array,
    dq: Array,
    ddq: Array,
    F: Array,
    h: float,
    newmark: tuple[float, float] = (0.25, 0.5),
) -> tuple[Array, Array, Array]:
    """One step of Newmark's method for Eq. (10): q, dq, ddq after a time h.

    M, C, K: (n, n). q, dq, ddq: (n,) or (n, cases), the state before. F: force after the step, like q. Matrices
    (..., n, n) want states (..., n, cases).
    newmark: its two parameters (b, g); (1/4, 1/2) is average acceleration. Order 2 for g = 1/2, else 1.
    """
    b, g = newmark
    q_predicted = h * dq + (h**2 * (0.5 - b)) * ddq + q
    dq_predicted = (h * (1 - g)) * ddq + dq
    effective = (b * h**2) * K + (g * h) * C + M
    right_side = -(C @ dq_predicted) - (K @ q_predicted) + F
    ddq_next = _namespace(M).linalg.solve(effective, right_side)
    q_next = (b * h**2) * ddq_next + q_predicted
    dq_next = (g * h) * ddq_next + dq_predicted
    return q_next, dq_next, ddq_next


def newmark_limit(xi: float, newmark: tuple[float, float] = (0.25, 0.5)) -> float:
    """Largest stable ω h of Newmark's method for damping ratio xi; infinite where every step is stable."""
    b, g = newmark
    bound_1 = 0 if (g >= 0.5) else np.inf if (xi == 0) else -0.25 * (2 * g - 1) / xi
    bound_2 = (
        -0.5 * xi * (2 * g - 1) + np.sqrt(-b + 0.5 * g + 0.25 * xi**2 * (2 * g - 1) ** 2)
        if (-b + 0.5 * g + 0.25 * xi**2 * (2 * g - 1) ** 2 >= 0)
        else 0
    )
    inverse = max(0.0, bound_1, bound_2)
    return float(1 / inverse) if inverse else np.inf


def scales(bending_stiffness: float, mass_per_length: float, length: float) -> dict[str, float]:
    """SI size of one nondimensional unit of each quantity, for a beam in SI units (N m², kg/m, m). Eq. (5).

    length: m
    time: s
    load: N
    force: N
    alpha: s
    beta: kg/(m s)
    frequency: rad/s
    velocity: m/s
    acceleration: m/s^2
    energy: J
    """
    EI, m, L = bending_stiffness, mass_per_length, length
    return {
        "length": float(L),
        "time": float(L**2 * np.sqrt(m) / np.sqrt(EI)),
        "load": float(EI / L**2),
        "force": float(EI / L**2),
        "alpha": float(L**2 * np.sqrt(m) / np.sqrt(EI)),
        "beta": float(np.sqrt(EI) * np.sqrt(m) / L**2),
        "frequency": float(np.sqrt(EI) / (L**2 * np.sqrt(m))),
        "velocity": float(np.sqrt(EI) / (L * np.sqrt(m))),
        "acceleration": float(EI / (L * L * L * m)),
        "energy": float(EI / L),
    }
