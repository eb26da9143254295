"""Powers of the step, rounded once: the closed form of a free or harmonic response, and the blocks of any other.

A power made by squaring floats drifts with the number of steps. Here it is squared with more digits and then rounded:
as a matrix of twice the digits, which serves every system, or as eigenvalues, which cost less where their vectors are
well conditioned.
"""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.response.double import ONE, Double, Fixed, fixed, matmul, rounded, square

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

LARGEST = 1e100  # of a power: beyond it zero times infinity could come in where the response is small


Spread = Callable[[Any, Any], None]


class Powers(Protocol):
    """Powers 2^k of a step."""

    def forward(self, states: Any, k: int) -> Any:
        """States (…, d) after 2^k steps."""

    def groups(self, r: Any, k: int) -> tuple[Any, Spread]:
        """What the states w of w⁺ = A w + r, A of 2^k steps, have at the ends of groups of r's (cases, groups, group,
        d) that begin with 0, (cases, groups, d); and a function that is given the states at the starts of the groups
        (cases, groups, d) and an array for all of them, as r."""

    def backward(self, rows: Any, k: int) -> Any:
        """Outputs (…, d) that give after no step what `rows` give after 2^k."""

    def reach(self, k: int) -> bool:
        """Whether 2^k steps keep below `LARGEST`."""

    def outputs(self, rows: Any, length: int) -> Array:
        """What rows (s, d) give after 0, 1, … steps, (length s, floats), to be multiplied by states as `floats`."""

    def floats(self, states: Any) -> Array:
        """States (…, d) as floats."""

    def states(self, floats: Array) -> Any:
        """And back."""


def orbit(start: Any, length: int, move: Any, first: int = 0) -> Any:
    """start, start moved by 2^first, by 2 · 2^first, …: (length, *start.shape), by doubling."""
    table = np.empty((length, *start.shape), dtype=start.dtype)
    table[0], done, k = start, 1, first
    while done < length:
        more = min(done, length - done)
        table[done : done + more] = move(table[:more], k)
        done, k = done + more, k + 1
    return table


def _real(matrices: Complex) -> Array:
    """Matrices (…, m, n) that complex rows are multiplied by, for rows of their real and imaginary parts."""
    z = matrices[..., :, None, :, None]
    pairs = np.concatenate(
        [np.concatenate([z.real, z.imag], axis=-1), np.concatenate([-z.imag, z.real], axis=-1)], axis=-3
    )
    return np.ascontiguousarray(pairs.reshape(*matrices.shape[:-2], 2 * matrices.shape[-2], 2 * matrices.shape[-1]))


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

    def _turn(self, k: int) -> Array:
        if len(self._turned) <= k:
            self[k]
        return self._turned[k]

    def forward(self, states: Array, k: int) -> Array:
        moved: Array = states @ self._turn(k)
        return moved

    def groups(self, r: Array, k: int) -> tuple[Array, Spread]:
        step = self._turn(k)
        r = np.ascontiguousarray(r.transpose(2, 0, 1, 3))  # all that is done at a time lies together
        total, spare = r[0].copy(), np.empty_like(r[0])
        for part in r[1:]:
            np.matmul(total, step, out=spare)
            spare += part
            total, spare = spare, total

        def spread(starts: Array, states: Array) -> None:
            own = np.empty_like(r)
            own[0] = starts
            for before, after, part in zip(own[:-1], own[1:], r[:-1], strict=True):
                np.matmul(before, step, out=after)
                after += part
            states[:] = own.transpose(1, 2, 0, 3)

        return total, spread

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

    def floats(self, states: Array) -> Array:
        return states

    def states(self, floats: Array) -> Array:
        return floats


class ModalPowers:
    """Powers of the step's eigenvalues; a state is its complex coordinates, of which the real part counts. `base`:
    powers of others, which come first."""

    def __init__(self, roots: list[Fixed], base: ModalPowers | None = None) -> None:
        self._exact, self._base = roots, base
        self._within = -1
        self._rounded: Complex = np.empty((0, len(roots)), dtype=complex)
        self._kept: dict[tuple[int, int], tuple[Array, Array]] = {}
        self._lock = Lock()

    def __getitem__(self, k: int) -> Complex:
        found: Complex = self._up_to(k)[k]
        return found

    def _up_to(self, k: int) -> Complex:
        """Powers 1, 2, 4, … 2^k at least, a row each."""
        if len(self._rounded) <= k:
            with self._lock:
                known, more = len(self._rounded), []
                for level in range(known, k + 1):
                    if level:
                        self._exact = [square(z) for z in self._exact]
                    more.append([rounded(z) for z in self._exact])
                if more:
                    found = np.array(more)
                    if self._base is not None:
                        found = np.hstack([self._base._up_to(k)[known : k + 1], found])
                    self._rounded = np.vstack([self._rounded, found]) if known else found
        return self._rounded

    def forward(self, states: Complex, k: int) -> Complex:
        return states * self[k]

    backward = forward

    def groups(self, r: Complex, k: int) -> tuple[Complex, Spread]:
        cases, number, group, d = r.shape
        ends, within = self._products(k, group)
        # of each root its group of r's and, later, the state before them: a product of matrices then gives the states
        parts = np.empty((cases, d, number, group + 1), dtype=complex)
        parts[..., :group] = r.transpose(0, 3, 1, 2)
        total = (parts.view(np.float64)[..., : 2 * group] @ ends).view(np.complex128)[..., 0].swapaxes(1, 2)

        def spread(starts: Complex, states: Complex) -> None:
            parts[..., group] = starts.swapaxes(1, 2)
            states[:] = (parts.view(np.float64) @ within).view(np.complex128).transpose(0, 2, 3, 1)

        return total, spread

    def _products(self, k: int, group: int) -> tuple[Array, Array]:
        """For each root ρ of 2^k steps the matrices, of floats, that take r's to their sum Σ ρ^(group − 1 − i) r_i,
        (d, 2 group, 2), and these with a first state to all states, (d, 2 group + 2, 2 group)."""
        found = self._kept.get((k, group))
        if found is None:
            power = orbit(np.ones_like(self[k]), group + 1, self.forward, k)
            shifts = np.arange(group) - 1 - np.arange(group)[:, None]
            table = np.where(shifts >= 0, power[np.maximum(shifts, 0)].transpose(2, 0, 1), 0)
            within = np.concatenate([table, power[:group].T[:, None]], axis=1)
            found = self._kept[k, group] = _real(power[group - 1 :: -1].T[:, :, None]), _real(within)
        return found

    def reach(self, k: int) -> bool:
        if k > self._within and np.abs(self[k]).max() < LARGEST:  # a modulus that grows is largest at the end
            self._within = k
        return k <= self._within

    def outputs(self, rows: Complex, length: int) -> Array:
        table = orbit(rows, length, self.backward).reshape(-1, rows.shape[-1])
        found: Array = np.conj(table).view(np.float64)
        return found

    def floats(self, states: Complex) -> Array:
        return np.ascontiguousarray(states).view(np.float64)

    def states(self, floats: Array) -> Complex:
        return floats.view(np.complex128)


def augmented(step: Double, pushes: Array, rotation: Fixed) -> Double:
    """The step of the state and of a wave's real and imaginary part. No resonance needs care.

    pushes: what these two add to the state, (d, 2)."""
    d = len(pushes)
    whole = [np.zeros((d + 2, d + 2)) for _ in range(2)]
    exact = [float(part / ONE) for part in rotation]
    rest = [float((part - fixed(value)) / ONE) for part, value in zip(rotation, exact, strict=True)]
    for matrix, part, (cosine, sine) in zip(whole, step, (exact, rest), strict=True):
        matrix[:d, :d] = part
        matrix[d:, d:] = [[cosine, -sine], [sine, cosine]]
    whole[0][:d, d:] = pushes
    return Double(*whole)
