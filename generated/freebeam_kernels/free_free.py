"""Free-free beam under an end follower force and a transversal force: ends free and free.

M q̈ + C q̇ + (E + P H) q = F_0 Q with trial functions that are the modes of the unloaded beam, Eqs. (10), (11):

    M[i, j] = ∫ φᵢ φⱼ dx
    E[i, j] = ∫ φᵢ″ φⱼ″ dx
    H[i, j] = −∫ x φᵢ′ φⱼ′ dx + φᵢ(1) φⱼ′(1)
    C = beta M + alpha E

Roots of cos(γ) cosh(γ) = 1. All quantities are nondimensional, Eq. (5).

The load, the dampings and the column's own parameters may be arrays of shape (..., 1, 1): matrices are then
(..., n, n).

Source: Kavianipour and Sadati, Effects of damping on the linear stability of a free-free beam subjected to follower
and transversal forces, Eq. (8).

Derived from the energies and emitted by `freebeam generate free-free`; do not edit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.floating[Any]]  # or an array of another library that follows the Python array API

COLUMN: dict[str, Any] = {
    "name": "free-free",
    "title": "Free-free beam under an end follower force and a transversal force",
    "basis": "modes",
    "default": {"basis": "modes", "modes": 8},
    "ends": ("free", "free"),
    "rigid": 2,
    "load": "P",
    "damping": ["alpha", "beta"],
    "force": True,
    "parameters": [],
    "forms": {"M": "∫ φᵢ φⱼ dx", "E": "∫ φᵢ″ φⱼ″ dx", "H": "−∫ x φᵢ′ φⱼ′ dx + φᵢ(1) φⱼ′(1)"},
    "latex": {
        "x": "x",
        "t": "t",
        "P": "P_0",
        "alpha": "\\alpha",
        "beta": "\\beta",
        "x_F": "x_F",
        "gamma": "\\gamma",
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
        "gamma": "root of the characteristic equation",
        "y": "deflection",
        "F_0": "transversal (controller) force",
    },
    "source": (
        "Kavianipour and Sadati, Effects of damping on the linear stability of a free-free beam "
        "subjected to follower and transversal forces, Eq. (8)"
    ),
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
    """The first N modes: each field of shape (N,), but for `turn`.

    gamma: root of the characteristic equation, Eq. (21)
    quarter: asymptote of the root in units of π/4
    delta: root less its asymptote
    sigma: sign (−1)^(n−1)
    cosine: coefficient of cos γx
    left: coefficient of e^(−γx)
    right: coefficient of e^(−γ(1−x))
    deflection_0: φ(0)
    turn: π/4
    """

    gamma: Array
    quarter: Array
    delta: Array
    sigma: Array
    cosine: Array
    left: Array
    right: Array
    deflection_0: Array
    turn: Any


def characteristic(delta: Array, asymptote: Array, sigma: Array) -> tuple[Array, Array]:
    """cos(γ) cosh(γ) = 1 at γ = asymptote + delta, written so that no digits cancel, and its slope in delta.
    Eq. (21).
    """
    xp = _namespace(delta)
    epsilon = xp.exp(-asymptote - delta)
    sine, cosine = xp.sin(delta), xp.cos(delta)
    shared_1 = 2 * sigma
    shared_2 = epsilon**2 + 1
    value = -epsilon * shared_1 + shared_2 * sine
    slope = cosine * shared_2 - epsilon * (2 * epsilon * sine - shared_1)
    return value, slope


def complete(quarter: Array, sigma: Array, delta: Array, turn: Any) -> Basis:
    """All that is known of the modes, from their roots γ = quarter · turn + delta. Eq. (22).

    The arrays may hold floats, or any numbers that know `exp`, such as intervals: then so does the result.
    """
    gamma = quarter * turn + delta
    xp = _namespace(gamma)
    tail = sigma * xp.exp(-gamma)
    shared_1 = 1 / (tail - 1)
    shared_2 = shared_1 * (tail + 1)
    cosine = shared_2
    left = shared_1
    right = shared_1 * sigma
    deflection_0 = 2 * shared_2
    return Basis(gamma, quarter, delta, sigma, cosine, left, right, deflection_0, turn)


def basis(N: int, xp: Any = np, dtype: Any = None, device: Any = None) -> Basis:
    """The first N modes of the unloaded, undamped beam. Eqs. (19)-(22).

    Roots of cos(γ) cosh(γ) = 1: asymptotes, corrected by Newton's method, so that there is no table to run out of.

    xp: the array API's functions in whose arrays the basis comes, such as jax.numpy or torch. dtype: its real
    numbers, float64 unless told. device: where the arrays are kept, as xp names it.
    """
    kind = {"dtype": xp.float64 if dtype is None else dtype, "device": device}
    n = xp.arange(N, **kind)
    quarter = 6 + 4 * n
    sigma = 1 - 2 * (n % 2)
    asymptote = quarter * (np.pi / 4)
    epsilon = xp.exp(-asymptote)
    delta = 2 * epsilon * sigma
    for _ in range(2):
        value, slope = characteristic(delta, asymptote, sigma)
        delta = delta - value / slope
    return complete(quarter, sigma, delta, np.pi / 4)


def shapes(basis: Basis, x: ArrayLike, derivative: int = 0, rigid: bool = False) -> Array:
    """Modes or a derivative of them, shape (N, *x.shape). Eq. (22).

    x: places in units of the length, any shape. derivative: its order, 0 or more.
    rigid: put the 2 rigid functions first, shape (2 + N, *x.shape).

    sinh and cosh are written in decaying exponentials, and whole turns are struck off γ x exactly, so that no digits
    cancel in high modes.
    """
    xp = _namespace(basis.gamma)
    places = _like(x, basis.gamma)
    place = xp.reshape(places, (1, -1))
    gamma, quarter = basis.gamma[:, None], basis.quarter[:, None]
    half = 2.0 ** (26 if place.dtype == xp.float64 else 12)  # of the digits: quarter * coarse is exact
    coarse = xp.round(place * half) / half
    turns = quarter * coarse
    turns = turns - 8 * xp.round(turns / 8)
    phase = (turns + quarter * (place - coarse)) * basis.turn + basis.delta[:, None] * place
    sine, cosine = xp.sin(phase), xp.cos(phase)
    rotated = ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))[derivative % 4]
    value: Array = rotated[0] + basis.cosine[:, None] * rotated[1]
    value = value + (-1) ** (derivative % 2) * basis.left[:, None] * xp.exp(-gamma * place)
    value = value + basis.right[:, None] * xp.exp(-gamma * (1 - place))
    value = value * gamma**derivative if derivative else value
    if rigid:
        value = xp.concat([_rigid_shapes(place, derivative), value])
    found: Array = xp.reshape(value, (value.shape[0], *places.shape))
    return found


def _rigid_shapes(place: Array, derivative: int) -> Array:
    """The 2 rigid functions, roots γ = 0, or a derivative of them; place (1, n), result (R, n)."""
    zero = 0 * place
    rows = [[zero + 1, place - 0.5], [zero, zero + 1]]
    found = rows[derivative] if derivative < 2 else [zero] * 2
    value: Array = _namespace(place).concat(found)
    return value


def _bordered(matrix: Array, corner: dict[tuple[int, int], Any], rows: tuple[Array, ...] = ()) -> Array:
    """An elastic matrix with the corner and the rows of the 2 rigid functions before it; what stands under the
    corner is zero, for rigid motion does not act on the elastic one.
    """
    N, xp = matrix.shape[-1], _namespace(matrix)
    if xp is np and matrix.ndim == 2:  # in place, which is faster
        whole = np.zeros((2 + N, 2 + N), dtype=matrix.dtype)
        whole[2:, 2:] = matrix
        for place, entry in corner.items():
            whole[place] = entry
        for n, row in enumerate(rows):
            whole[n, 2:] = row
        return whole
    batch = matrix.shape[:-2]
    kind = {"dtype": matrix.dtype, "device": getattr(matrix, "device", None)}
    cell, wide = xp.zeros((*batch, 1, 1), **kind), xp.zeros((*batch, 1, N), **kind)
    above = []
    for i in range(2):
        cells = [cell + corner.get((i, j), 0.0) for j in range(2)]
        above.append(xp.concat([*cells, wide + rows[i] if rows else wide], axis=-1))
    below = xp.concat([xp.zeros((*batch, N, 2), **kind), matrix], axis=-1)
    value: Array = xp.concat([*above, below], axis=-2)
    return value


def _apart(basis: Basis) -> Array:
    """1 / (γᵢ⁴ − γⱼ⁴), shape (N, N); 1 for i = j, where it has no part.

    The roots are subtracted before they are rounded: asymptotes and corrections apart.
    """
    gamma, quarter = basis.gamma, basis.quarter
    squares = gamma * gamma
    apart = quarter[:, None] - quarter
    difference = apart * basis.turn + (basis.delta[:, None] - basis.delta)
    difference = difference * (gamma[:, None] + gamma) * (squares[:, None] + squares)
    inverse: Array = 1 / _namespace(gamma).where(apart == 0, 1.0, difference)
    return inverse


def mass(basis: Basis, rigid: bool = False) -> Array:
    """Mass matrix M, shape (N, N), or (2 + N, 2 + N) with the rigid functions first, nondimensional. Eq. (11), first
    line.

    M[i, j] = ∫ φᵢ φⱼ dx
    """
    quarter = basis.quarter
    deflection_0 = basis.deflection_0
    M: Array = _diagonal(0.25 * deflection_0**2, quarter)
    if rigid:
        one = 0 * basis.turn + 1  # in the numbers at hand
        M = _bordered(M, {(0, 0): one, (1, 1): one / 12})
    return M


def stiffness_elastic(basis: Basis, rigid: bool = False) -> Array:
    """Elastic stiffness matrix E of K = E + P H, shape (N, N), or (2 + N, 2 + N) with the rigid functions first,
    nondimensional. Eq. (11), third line at zero load.

    E[i, j] = ∫ φᵢ″ φⱼ″ dx
    """
    quarter = basis.quarter
    gamma = basis.gamma
    deflection_0 = basis.deflection_0
    gamma2 = gamma**2
    gamma4 = gamma2**2
    E: Array = _diagonal(0.25 * deflection_0**2 * gamma4, quarter)
    if rigid:
        E = _bordered(E, {})
    return E


def stiffness_load(basis: Basis, rigid: bool = False) -> Array:
    """Load matrix H of K = E + P H, shape (N, N), or (2 + N, 2 + N) with the rigid functions first, nondimensional.
    Eq. (11), third line, divided by the load; Eq. (13).

    H[i, j] = −∫ x φᵢ′ φⱼ′ dx + φᵢ(1) φⱼ′(1)

    Row i is the test function. The end term is transposed in the paper as printed: docs/errata.md.
    """
    quarter = basis.quarter
    gamma = basis.gamma
    sigma = basis.sigma
    deflection_0 = basis.deflection_0
    gamma2 = gamma**2
    gamma3 = gamma * gamma2
    gamma4 = gamma2**2
    deflection_0_sigma_times_2 = 2 * deflection_0 * sigma
    gamma_sigma = gamma * sigma
    gamma_sigma_times_2 = 2 * gamma * sigma
    deflection_0_gamma3 = deflection_0 * gamma3
    deflection_0_gamma4_times_4 = 4 * deflection_0 * gamma4
    deflection_0_gamma4 = deflection_0 * gamma4
    apart = _apart(basis)
    H: Array = -deflection_0_gamma4 * deflection_0_gamma4_times_4[:, None] * (sigma[:, None] * sigma - 1)
    H = H * apart - gamma_sigma * gamma_sigma_times_2[:, None] * (-deflection_0_gamma3[:, None] + deflection_0_gamma3)
    H = H * apart - deflection_0_sigma_times_2[:, None] * gamma_sigma
    H = _namespace(quarter).where(quarter[:, None] == quarter, -0.5 * gamma * (deflection_0 + gamma), H)
    if rigid:
        one = 0 * basis.turn + 1  # in the numbers at hand
        rows = (-2 * gamma * sigma, -sigma * (deflection_0 + gamma))
        H = _bordered(H, {(0, 1): one}, rows)
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
    return {"M": ({(0, 0, 0): 1}, {}), "E": ({(0, 2, 2): 1}, {}), "H": ({(1, 1, 1): -1}, {(1, 0, 1, 1): 1})}


def equation(P: Any, alpha: Any = 0, beta: Any = 0, one: Any = 1) -> dict[tuple[int, int], tuple[Any, ...]]:
    """The equation of motion without force: (p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ, ascending in powers of x. Eq. (6)."""
    return {(0, 1): (beta,), (0, 2): (1,), (1, 0): (P,), (2, 0): (0, P), (4, 0): (1,), (4, 1): (alpha,)}


def end_conditions(P: Any, alpha: Any = 0, beta: Any = 0, one: Any = 1) -> tuple[Any, Any]:
    """Two conditions at x = 0 and two at x = 1: (p, r) -> factor of ∂ᵖ⁺ʳy/∂xᵖ∂tʳ there. Eq. (15)."""
    return (
        ({(3, 0): 1, (3, 1): alpha}, {(2, 0): -1, (2, 1): -alpha}),
        ({(3, 0): -1, (3, 1): -alpha}, {(2, 0): 1, (2, 1): alpha}),
    )


def frequencies(gamma: Array, alpha: float = 0.0, beta: float = 0.0) -> tuple[Any, Any]:
    """Both eigenvalues λ₀ of each mode of the unloaded beam, complex, each (N,), nondimensional. Eq. (23).

    The imaginary part is the damped frequency; where it vanishes the mode is overdamped. The first comes from the
    product of both, so that no digits cancel in heavy damping.
    """
    xp = _namespace(gamma)
    gamma = gamma.astype(np.complex128) if isinstance(gamma, np.ndarray) else gamma + 0j
    shared_1 = (gamma**2) ** 2
    half = 0.5 * alpha * shared_1 + 0.5 * beta
    product = shared_1
    second = -half - xp.sqrt(half * half - product)
    return product / second, second


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
