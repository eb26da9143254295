"""The eigenvalues of Eq. (10), and what a method of many steps is: the step it makes of them, or of the matrices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.checks import InputError
from freebeam_sym.response.double import Double, Fixed
from freebeam_sym.response.inputs import Wave
from freebeam_sym.response.messages import Message
from freebeam_sym.response.modal import Modes, modes_of
from freebeam_sym.response.powers import ModalPowers

if TYPE_CHECKING:
    from freebeam_sym.columns import System

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


class Method(Protocol):
    """What makes a response of steps: x⁺ = A x + B₀ F + B₁ F⁺ of the states x = (q, dq). All else is shared."""

    def __hash__(self) -> int:
        """What is made of a method is kept, by its parameters."""

    @property
    def modal(self) -> bool:
        """Whether A has the eigenvectors of the differential equation: `root`, `gains` and `rate` are A, B₀ and B₁."""

    def errors(self, spectrum: Spectrum, h: float) -> tuple[Complex, Array]:
        """log(root of A) / h − λ of each eigenvalue λ of the spectrum; relative errors of the oscillations' periods.

        Raises InputError for a step that is not stable or loses its digits.
        """

    def root(self, z: Fixed) -> Fixed:
        """The eigenvalue of A where that of the differential equation is λ = z / h."""

    def gains(self, z: Complex, roots: Complex) -> tuple[Complex, Complex]:
        """What B₀ and B₁ are to h B where that of the differential equation is λ = z / h. roots: of z."""

    def rate(self, wave: Wave, h: float) -> tuple[float, float] | None:
        """The angular frequency, as a sum of two floats, at which the differential equation answers a force as the
        method does; None where there is none."""

    def matrix(self, M: Array, C: Array, K: Array, h: float, scale: Array) -> Double:
        """A to 2⁻⁸⁰ or so, of the states x / scale."""

    def pushes(self, M: Array, C: Array, K: Array, Q: Array, h: float, scale: Array, wave: Wave | None) -> Array:
        """What a force adds to x⁺ / scale, (2 n, 2): B₀ and B₁; for a wave, what its real and imaginary part add."""


def acceleration(M: Array, C: Array, K: Array, Q: Array) -> tuple[Array, Array]:
    """ddq = a (q, dq) + f F₀, the equation of motion (10) solved: a of shape (n, 2n), f of shape (n,)."""
    n = len(M)
    solved = np.linalg.solve(M, np.concatenate([-K, -C, Q[:, None]], axis=1))
    return solved[:, : 2 * n], solved[:, 2 * n]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """The exact eigenvalues (2 n,) of the part that is judged, and their vectors."""

    matrices: tuple[Array, Array, Array]
    """M, C, K of that part."""
    part: slice
    """That part of the coordinates: without the rigid ones where these have no share in the elastic spectrum."""
    values: Complex
    vectors: Complex
    decay: float
    """Fastest decay of the part that is not judged."""

    @cached_property
    def modes(self) -> Modes | None:
        """Eigenvalues and vectors to more digits, where they are well conditioned."""
        M, C, K = self.matrices
        return modes_of(M, C, K, self.values, self.vectors, scale_of(M, K))

    @cached_property
    def oscillating(self) -> Complex:
        """Those with Im λ > 0, by their frequency."""
        found: Complex = self.values[self.values.imag > 0]
        found = found[np.argsort(found.imag)]
        found.flags.writeable = False  # their frequencies are shared by responses
        return found

    @cached_property
    def inverse(self) -> Complex:
        """Of the vectors; a pseudoinverse where these are parallel."""
        try:
            return np.linalg.inv(self.vectors).astype(complex)
        except np.linalg.LinAlgError:
            return np.linalg.pinv(self.vectors).astype(complex)

    @cached_property
    def growing(self) -> complex | None:
        """The eigenvalue that grows fastest; None where none grows by more than rounding may have made of it."""
        worst = int(np.argmax(self.values.real))
        if not self.values[worst].real > 0:
            return None
        M, _, K = self.matrices
        scale = scale_of(M, K)
        X, W = self.vectors[:, worst] / scale, self.inverse[worst] * scale
        condition = np.linalg.norm(X) * np.linalg.norm(W)
        # first order in the backward error of the eigenvalues; 10 is generous where a few eps of the norm are usual
        rounding = 10 * np.finfo(float).eps * condition * np.abs(self.values).max()
        return complex(self.values[worst]) if self.values[worst].real > rounding else None


@dataclass(frozen=True, eq=False)
class Steps:
    """What a method makes of a spectrum with steps of one length."""

    spectrum: Spectrum
    method: Method
    step: float
    errors: Complex
    period_errors: Array
    """See `Method.errors`."""

    @cached_property
    def seen(self) -> tuple[Complex, Complex, bool]:
        """The eigenvalues with Im λ ≥ 0, what their motion goes wrong by in a unit of time, relative to the larger of
        what it is and should be (its logarithm), and whether nothing does."""
        half = self.spectrum.values.imag >= 0
        errors = self.errors[half]
        rates = np.maximum(-np.abs(errors.real), -1e300) + 1j * errors.imag  # a root may be zero
        return self.spectrum.values[half], rates, not errors.any()

    @cached_property
    def powers(self) -> ModalPowers | None:
        """Powers of the step's roots, where the step has the eigenvectors of the differential equation."""
        modes = self.spectrum.modes if self.method.modal else None
        return None if modes is None else ModalPowers([self.method.root(z) for z in modes.times(self.step)])


def scale_of(M: Array, K: Array) -> Array:
    """Sizes of q and dq, powers of two, (2 n,), with which the entries of a step's matrix are of one order."""
    stiffness, mass = np.abs(np.diag(K)), np.diag(M)
    rates = np.sqrt(np.where(stiffness > 0, stiffness, mass) / mass)
    return np.concatenate([np.ones(len(M)), np.exp2(np.round(np.log2(rates)))])


def _coupled(M: Array, C: Array, K: Array, r: int) -> bool:
    """Whether the r rigid functions take part in the elastic spectrum; those of the free beam do not."""
    small = 1e-9 * np.abs(K[r:]).max(axis=1, keepdims=True)
    if (np.abs(K[r:, :r]) > small).any() or (np.abs(C[r:, :r]) > small).any():
        return True
    own = np.linalg.solve(M[:r, :r], K[:r, :r])
    return bool(np.abs(np.linalg.eigvals(own)).max() > 1e-6 * max(np.abs(own).max(), 1e-300))


def spectrum_of(system: System) -> Spectrum:
    """The exact spectrum, kept from earlier calls, by value.

    Rigid functions of a free beam make λ = 0 defective, of a size that rounding decides: the elastic part is judged.
    """
    matrices = (np.asarray(part, dtype=float).tobytes() for part in (system.M, system.C, system.K))
    return _spectrum(len(system.M), system.rigid_count, *matrices)


@lru_cache(maxsize=64)
def _spectrum(size: int, r: int, mass: bytes, damping: bytes, elasticity: bytes) -> Spectrum:
    whole = [np.frombuffer(part).reshape(size, size) for part in (mass, damping, elasticity)]
    part = slice(0 if r and _coupled(whole[0], whole[1], whole[2], r) else r, None)
    M, C, K = (matrix[part, part] for matrix in whole)
    n = len(M)
    generator = np.zeros((2 * n, 2 * n))
    generator[:n, n:] = np.eye(n)
    generator[n:] = acceleration(M, C, K, np.zeros(n))[0]
    values, vectors = (found.astype(complex) for found in np.linalg.eig(generator))
    decay = 0.0
    if part.start:
        decay = float(np.abs(np.linalg.eigvals(np.linalg.solve(whole[0][:r, :r], whole[1][:r, :r]))).max())
    return Spectrum((M, C, K), part, values, vectors, decay)


@lru_cache(maxsize=64)
def steps_of(spectrum: Spectrum, method: Method, h: float) -> Steps:
    """Steps of length h. Raises InputError where the method has none, see `Method.errors`."""
    errors, period_errors = method.errors(spectrum, h)
    period_errors.flags.writeable = False  # they are shared by responses
    return Steps(spectrum, method, h, errors, period_errors)


def overflow(t: float, spectrum: Spectrum) -> InputError:
    """What to say of a response that is not finite from t on."""
    worst = spectrum.values[np.argmax(spectrum.values.real)]
    if worst.real * t < 1:
        return InputError(Message(
            "the response passes the range of floats at t = {t:time}: the force or the initial state is too large", t=t
        ))  # fmt: skip
    kind = "flutter" if worst.imag else "divergence"
    return InputError(Message(
        f"the response passes the range of floats at t = {{t:time}}: {kind} grows as exp(r t), r = {{rate:rate}}; "
        "choose a shorter duration or a load below the critical one", t=t, rate=worst.real
    ))  # fmt: skip
