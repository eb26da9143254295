"""Powers of the step, rounded once: the closed form of a free or harmonic response, and the blocks of any other.

A power made by squaring floats drifts with the number of steps. Here it is squared with more digits and then rounded:
as a matrix of twice the digits, which serves every system, or as eigenvalues, which cost less where their vectors are
well conditioned.
"""

from __future__ import annotations

from threading import Lock
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .double import ONE, Double, Fixed, fixed, matmul, rounded, square

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

LARGEST = 1e100  # of a power: beyond it zero times infinity could come in where the response is small


class Powers(Protocol):
    """Powers 2^k of a step."""

    def forward(self, states: Any, k: int) -> Any:
        """States (…, d) after 2^k steps."""

    def backward(self, rows: Any, k: int) -> Any:
        """Outputs (…, d) that give after no step what `rows` give after 2^k."""

    def reach(self, k: int) -> bool:
        """Whether 2^k steps keep below `LARGEST`."""

    def outputs(self, rows: Any, length: int) -> Array:
        """What rows (s, d) of `real` states give after 0, 1, … steps: (length s, d real)."""

    def real(self, states: Any) -> Array:
        """States (…, d) as floats that `outputs` multiplies."""


def orbit(start: Any, length: int, move: Any, first: int = 0) -> Any:
    """start, start moved by 2^first, by 2 · 2^first, …: (length, *start.shape), by doubling."""
    table = np.empty((length, *start.shape), dtype=start.dtype)
    table[0], done, k = start, 1, first
    while done < length:
        more = min(done, length - done)
        table[done : done + more] = move(table[:more], k)
        done, k = done + more, k + 1
    return table


class MatrixPowers:
    """Powers of a matrix known to twice the digits."""

    def __init__(self, step: Double) -> None:
        self._exact = step
        self._rounded = [step.high]
        self._turned = [np.ascontiguousarray(step.high.T)]
        self._within = 0
        self._lock = Lock()  # powers are kept for later responses, in whatever thread

    def __getitem__(self, k: int) -> Array:
        if len(self._turned) <= k:
            with self._lock:
                while len(self._turned) <= k:
                    self._exact = matmul(self._exact, self._exact)
                    self._rounded.append(self._exact.high)
                    self._turned.append(np.ascontiguousarray(self._exact.high.T))
        return self._rounded[k]

    def forward(self, states: Array, k: int) -> Array:
        if len(self._turned) <= k:
            self[k]
        moved: Array = states @ self._turned[k]
        return moved

    def backward(self, rows: Array, k: int) -> Array:
        moved: Array = rows @ self[k]
        return moved

    def reach(self, k: int) -> bool:
        within = self._within
        while within <= k and np.abs(self[within]).max() < LARGEST:
            within += 1
        self._within = max(within, self._within)
        return within > k

    def outputs(self, rows: Array, length: int) -> Array:
        table: Array = orbit(rows, length, self.backward)
        return table.reshape(-1, rows.shape[-1])

    def real(self, states: Array) -> Array:
        return states


class ModalPowers:
    """Powers of the step's eigenvalues; a state is its complex coordinates, of which the real part counts."""

    def __init__(self, roots: list[Fixed]) -> None:
        self._exact = roots
        self._rounded = [np.array([rounded(z) for z in roots])]
        self._within = 0

    def __getitem__(self, k: int) -> Complex:
        while len(self._rounded) <= k:
            self._exact = [square(z) for z in self._exact]
            self._rounded.append(np.array([rounded(z) for z in self._exact]))
        return self._rounded[k]

    def forward(self, states: Complex, k: int) -> Complex:
        return states * self[k]

    backward = forward

    def reach(self, k: int) -> bool:
        while self._within <= k and np.abs(self[self._within]).max() < LARGEST:
            self._within += 1
        return self._within > k

    def outputs(self, rows: Complex, length: int) -> Array:
        table = orbit(rows, length, self.backward).reshape(-1, rows.shape[-1])
        found: Array = np.conj(table).view(np.float64)
        return found

    def real(self, states: Complex) -> Array:
        return np.ascontiguousarray(states).view(np.float64)


def augmented(step: Double, before: Array, after: Array, rotation: Fixed) -> Double:
    """The step of the state and of (cos θn, sin θn), where the force is the first of these. No resonance needs care."""
    exact = [float(part / ONE) for part in rotation]
    rest = [float((part - fixed(value)) / ONE) for part, value in zip(rotation, exact, strict=True)]
    d = len(before)
    whole = [np.zeros((d + 2, d + 2)) for _ in range(2)]
    for matrix, part, (cosine, sine) in zip(whole, step, (exact, rest), strict=True):
        matrix[:d, :d] = part
        matrix[d:, d:] = [[cosine, -sine], [sine, cosine]]
    whole[0][:d, d:] = np.outer(after, whole[0][d, d:])
    whole[0][:d, d] += before
    return Double(*whole)
