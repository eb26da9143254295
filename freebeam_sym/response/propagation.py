"""Many steps of x⁺ = A x + B₀ F + B₁ F⁺ without a loop over them: by powers of A, and products of matrices.

A response is made in stretches, a stretch in blocks of steps. The states at the blocks' starts come first, then
products give all outputs. Memory beyond the results is bounded by the stretch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.response.digits import Array, Double, Roots

Tables = Mapping[str, Array]

LARGEST = 1e100
"""Of a power that is used: beyond it zero times infinity could come in where the response is small."""
STRETCH = 20
"""A stretch of a response is 2^20 numbers: from 2^18 to 2^20 a response of a million steps takes as long within a
tenth."""
PRODUCT = 300_000
"""Multiplications of a product of matrices that OpenBLAS makes at once, without copying the factors first: a fifth
faster than a product of all."""


class Powers:
    """A^(2^k), squared in more digits than floats have, and each rounded once.

    A is a matrix, (d, d), or the diagonal of one in complex coordinates, of which each is a pair of x, (d / 2,).
    """

    def __init__(self, exact: Double | Roots) -> None:
        self._exact = exact
        self._rounded: list[NDArray[Any]] = [np.ascontiguousarray(exact.high.T)]
        self._within = 0
        self._lock = Lock()  # powers are kept for later responses, in whatever thread

    def _transposed(self, k: int) -> NDArray[Any]:
        if len(self._rounded) <= k:
            with self._lock:
                while len(self._rounded) <= k:
                    self._exact = self._exact.squared()
                    self._rounded.append(np.ascontiguousarray(self._exact.high.T))
        return self._rounded[k]

    def forward(self, x: Array, k: int) -> Array:
        """x, (…, d), after 2^k steps."""
        A = self._transposed(k)
        return np.asarray(x @ A if A.ndim == 2 else (x.view(complex) * A).view(float))

    def backward(self, rows: Array, k: int) -> Array:
        """Outputs of x, (…, d), that give after no step what `rows` give after 2^k."""
        A = self._transposed(k)
        return np.asarray(rows @ A.T if A.ndim == 2 else (rows.view(complex) * np.conj(A)).view(float))

    def carried(self, w: Array, r: Array, level: int) -> Array:
        """All states of w⁺ = A^(2^level) w + r, (cases, r's + 1, d), from w (cases, d) and r's (cases, r's, d)."""
        numbers = complex if self._transposed(0).ndim == 1 else float
        # a coordinate's values lie together, which is quicker to add up
        columns = np.ascontiguousarray(r.view(numbers).swapaxes(1, 2))
        states = self._carried(w.view(numbers)[..., None], columns, level)
        return np.ascontiguousarray(states.swapaxes(1, 2)).view(float)

    def _carried(self, w: NDArray[Any], r: NDArray[Any], level: int) -> NDArray[Any]:
        """The same with the steps along the last axis: every second state so, from pairs of r's, and the others from
        these."""
        cases, d, count = r.shape
        A = self._transposed(level)

        def moved(x: NDArray[Any]) -> NDArray[Any]:
            return np.asarray(A[:, None] * x if A.ndim == 1 else A.T @ np.ascontiguousarray(x))

        states = np.empty((cases, d, count + 1), dtype=r.dtype)
        if count < 4 or self.within(level + 1) <= level:
            states[..., :1] = w
            for k in range(count):
                states[..., k + 1 : k + 2] = moved(states[..., k : k + 1]) + r[..., k : k + 1]
            return states
        even = count // 2 * 2
        pairs = moved(r[..., :even:2])
        pairs += r[..., 1:even:2]
        states[..., : even + 1 : 2] = self._carried(w, pairs, level + 1)
        np.add(moved(states[..., :count:2]), r[..., ::2], out=states[..., 1::2])
        return states

    def within(self, k: int) -> int:
        """The largest of 0, …, k up to which the powers keep below `LARGEST`, or 0."""
        while self._within <= k and np.abs(self._transposed(self._within)).max() < LARGEST:
            self._within += 1
        return max(0, min(k, self._within - 1))

    def table(self, rows: Array, length: int) -> Array:
        """What outputs (s, d) give after 0, 1, … steps, (d, length s): states times this are the outputs."""
        return np.ascontiguousarray(_orbit(rows, length, 0, self.backward).reshape(-1, rows.shape[-1]).T)


def _orbit(first: Array, count: int, level: int, move: Callable[[Array, int], Array]) -> Array:
    """`first`, and it moved by 1, 2, … times 2^level steps, (count, …), by doubling."""
    found = np.empty((count, *first.shape))
    found[0], done = first, 1
    while done < count:
        more = min(done, count - done)
        found[done : done + more] = move(found[:more], level)
        done, level = done + more, level + 1
    return found


@dataclass(eq=False)
class Stretch:
    """Times begin, …, end − 1 of a response in blocks of `length`.

    terms: the outputs are a sum of products of numbers for each block, (cases, blocks, …), with tables for each output.
    The first numbers are the states at the blocks' starts; the second, if any, the forces, of which `after` is B₁.
    """

    begin: int
    end: int
    length: int
    terms: tuple[tuple[Array, Tables], ...]
    after: Array | None = None

    def states(self, every: int) -> Array:
        """x at the starts of every so many blocks, (cases, blocks, d)."""
        x = self.terms[0][0][:, ::every]
        return x if self.after is None else x + self.terms[1][0][:, ::every, :1] * self.after

    def fill(self, name: str, out: Array) -> None:
        """The outputs of one name into (cases, end − begin, s)."""
        cases, times, s = out.shape
        whole, over = divmod(times, self.length)
        if whole:
            self._blocks(name, slice(whole), out[:, : whole * self.length].reshape(cases, whole, -1))
        if over:  # the last block is cut off
            last = np.empty((cases, 1, self.length * s))
            self._blocks(name, slice(whole, whole + 1), last)
            out[:, whole * self.length :] = last.reshape(cases, self.length, s)[:, :over]

    def _blocks(self, name: str, blocks: slice, out: Array) -> None:
        (states, tables), *more = self.terms
        _product(states[:, blocks], tables[name], out)
        for numbers, tables in more:
            out += _product(numbers[:, blocks], tables[name], np.empty(out.shape))

    @property
    def finite(self) -> bool:
        """Whether all outputs are sure to be finite: by bounds of the products."""
        total = 0.0
        for numbers, tables in self.terms:
            largest = max(float(np.abs(table).max()) * len(table) for table in tables.values())
            total += math.sqrt(np.vdot(numbers, numbers)) * largest
        return total < 1e300


def free(powers: Powers, x: Array, rows: Tables, count: int) -> Iterator[Stretch]:
    """`count` times from x (cases, d) with no force. rows: of outputs, (s, d)."""
    width = sum(len(part) for part in rows.values()) * len(x)
    levels = powers.within(max(2, min((count - 1).bit_length(), STRETCH, STRETCH + 2 - width.bit_length())))
    inner = min(8, (levels + 1) // 2)
    length = 1 << inner
    tables = {name: powers.table(part, length) for name, part in rows.items()}
    for begin in range(0, count, 1 << levels):
        if begin:
            x = powers.forward(x, levels)
        end = min(count, begin + (1 << levels))
        states = np.ascontiguousarray(_orbit(x, -(-(end - begin) // length), inner, powers.forward).swapaxes(0, 1))
        yield Stretch(begin, end, length, ((states, tables),))


def forced(
    powers: Powers, x: Array, pushes: tuple[Array, Array], rows: Tables, direct: Tables,
    force: Callable[[int, int], Array], count: int,
) -> Iterator[Stretch]:  # fmt: skip
    """`count` times from x (cases, d) under a force. pushes: B₀ and B₁, (d,). direct: of a force in outputs, (s,).

    force: F at the times begin, …, end − 1, shape (cases, end − begin).
    """
    before, after = pushes
    B = powers.forward(after, 0) + before  # w = x − B₁ F needs the force at the old time only: w⁺ = A w + B F
    cases, d = x.shape
    inner = powers.within(min(max(5, (d - 1).bit_length()), max(0, (count - 1).bit_length() - 2)))
    length, width = 1 << inner, sum(len(part) for part in rows.values()) * cases
    levels = max(inner, powers.within(max(inner + 3, STRETCH - width.bit_length())))
    tables = {name: powers.table(part, length) for name, part in rows.items()}
    pushed = {name: _responses(B @ tables[name], direct[name] + rows[name] @ after, length) for name in rows}
    drive = np.ascontiguousarray(_orbit(B, length, 0, powers.forward)[::-1])
    w = x - force(0, 1) * after
    for begin in range(0, count, 1 << levels):
        end = min(count, begin + (1 << levels))
        values = force(begin, end)
        if over := -values.shape[1] % length:
            values = np.concatenate([values, np.zeros((cases, over))], axis=1)
        forces = values.reshape(cases, -1, length)
        starts = powers.carried(w, _product(forces, drive, np.empty((*forces.shape[:2], d))), inner)
        w = starts[:, -1]
        yield Stretch(begin, end, length, ((starts[:, :-1], tables), (forces, pushed)), after)


def _responses(impulse: Array, at_once: Array, length: int) -> Array:
    """What a block's forces give to its outputs: (length, length s), the response to an impulse shifted."""
    impulse = np.concatenate([at_once[None], impulse.reshape(length, -1)])
    later = np.arange(length) - np.arange(length)[:, None]
    return np.where(later[..., None] < 0, 0.0, impulse[later]).reshape(length, -1)


def _product(a: Array, b: Array, out: Array) -> Array:
    """a @ b into `out`, (cases, m, n), so many rows at a time as make a `PRODUCT`."""
    cases, count, d = a.shape
    rows = 1 << max(0, (PRODUCT // (d * b.shape[1])).bit_length() - 1)
    whole = count // rows * rows if rows >= 8 else 0
    if whole:
        parts = out[:, :whole].reshape(cases, -1, rows, out.shape[2])
        np.matmul(a[:, :whole].reshape(cases, -1, rows, d), b, out=parts)
    if whole < count:
        np.matmul(a[:, whole:], b, out=out[:, whole:])
    return out
