"""Many steps: outputs at all times from a step's powers, a stretch of steps at a time, by products of matrices.

A stretch is cut into blocks of steps. The states at the blocks' starts come first, then one product gives all outputs.
Memory beyond the results is bounded by the stretch.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .powers import MatrixPowers, Powers, orbit

Array = NDArray[np.float64]
Outputs = Mapping[str, Any]
Fill = Callable[[str, Array], None]
Store = Callable[[int, int, Fill, bool], None]

STRETCH = 20  # 2^20 numbers of a response at a time
GROUP = 4  # 2^4 blocks are carried side by side


def free(powers: Powers, state: Any, rows: Outputs, count: int, store: Store) -> None:
    """Outputs `rows` (name: (s, d)) of `count` times from states (cases, d) that no force acts on.

    store: called for one stretch after another with its first time, its end, a function that fills an array
    (cases, end − first, s) for one of the names, and whether all its numbers are sure to be finite.
    """
    width = sum(len(part) for part in rows.values()) * len(state)
    levels = max(2, min((count - 1).bit_length(), STRETCH, STRETCH + 2 - width.bit_length()))
    while levels and not powers.reach(levels):
        levels -= 1
    inner = min(10, (levels + 1) // 2)
    length = 1 << inner
    tables = {name: np.ascontiguousarray(powers.outputs(part, length).T) for name, part in rows.items()}
    for begin in range(0, count, 1 << levels):
        if begin:
            state = powers.forward(state, levels)
        end = min(count, begin + (1 << levels))
        starts = orbit(state, -(-(end - begin) // length), powers.forward, inner)
        states = powers.real(starts.swapaxes(0, 1))
        _stored(store, begin, end, states, tables, partial(_fill, states, length))


def forced(
    powers: MatrixPowers,
    state: Array,
    before: Array,
    after: Array,
    rows: Outputs,
    direct: Outputs,
    force: Callable[[int, int], Array],
    count: int,
    store: Store,
) -> None:
    """The same under a force: x⁺ = A x + before F + after F⁺, outputs rows x + direct F.

    force: F of times begin, …, end − 1, shape (cases, end − begin).
    """
    # w = x − after F needs the force at the old time only.
    B = powers[0] @ after + before
    d, cases = len(B), len(state)
    inner = max(5, (d - 1).bit_length())
    while inner and not powers.reach(inner):
        inner -= 1
    length, group = 1 << inner, 1 << GROUP
    width = sum(len(part) for part in rows.values()) * cases
    levels = max(inner + GROUP, min(inner + 3 * GROUP, STRETCH + 2 - width.bit_length()))
    while levels > inner and not powers.reach(levels):
        levels -= 1
    if levels < inner + GROUP:  # growth: blocks one after the other
        group = 1
    tables = {}
    for name, part in rows.items():
        pushed = _responses(powers, part, direct[name] + part @ after, B, length)
        tables[name] = np.ascontiguousarray(np.vstack([powers.outputs(part, length).T, pushed]))
    last = np.ascontiguousarray(orbit(B, length, powers.forward)[::-1])
    w = state - force(0, 1) * after
    whole = np.empty((group, cases, (1 << levels) // (group * length), d + length))
    for begin in range(0, count, 1 << levels):
        end = min(count, begin + (1 << levels))
        number = -(-(end - begin) // (group * length))
        values = force(begin, end)
        if values.shape[1] < number * group * length:
            values = np.pad(values, ((0, 0), (0, number * group * length - values.shape[1])))
        # States and forces of all blocks; block k of each group comes before all blocks k + 1.
        blocks = whole[:, :, :number]
        forces = values.reshape(-1, number, group, length).transpose(2, 0, 1, 3)
        blocks[..., d:] = forces
        drives = np.broadcast_to(forces @ last, (group, cases, number, d))
        total = drives[0]
        for k in range(1, group):
            total = powers.forward(total, inner) + drives[k]
        starts = carried(powers, levels if group == 1 else inner + GROUP, w, total)
        blocks[0, ..., :d] = starts[:, :-1]
        for k in range(1, group):
            np.add(powers.forward(blocks[k - 1, ..., :d], inner), drives[k - 1], out=blocks[k, ..., :d])
        w = starts[:, -1]
        _stored(store, begin, end, blocks, tables, partial(_fill_groups, blocks, length))


def _fill_groups(states: Array, length: int, table: Array, part: Array) -> None:
    group, cases, number, _ = states.shape
    times, s = number * group * length, part.shape[2]
    aligned = part if part.shape[1] == times else np.empty((cases, times, s))
    out = aligned.reshape(cases, number, group, length * s).transpose(2, 0, 1, 3)
    np.matmul(states, table, out=out)
    if aligned is not part:
        part[:] = aligned[:, : part.shape[1]]


def _stored(
    store: Store, begin: int, end: int, states: Array, tables: Mapping[str, Array], fill: Callable[[Array, Array], None]
) -> None:
    flat = states.ravel()
    size = float(np.vdot(flat, flat)) ** 0.5
    largest = max(float(np.abs(table).max()) for table in tables.values()) * states.shape[-1]
    store(begin, end, lambda name, part: fill(tables[name], part), size * largest < 1e300)


def _fill(states: Array, length: int, table: Array, part: Array) -> None:
    cases, count, s = part.shape
    whole = count // length
    if whole:
        np.matmul(states[:, :whole], table, out=part[:, : whole * length].reshape(cases, whole, length * s))
    if count > whole * length:
        rest = (states[:, whole] @ table).reshape(cases, length, s)
        part[:, whole * length :] = rest[:, : count - whole * length]


def _responses(powers: MatrixPowers, rows: Array, direct: Array, B: Array, length: int) -> Array:
    """What a block's forces give to its outputs: (length, length s), the response to an impulse shifted."""
    s = len(rows)
    impulse = np.concatenate([direct[None], (powers.outputs(rows, length) @ B).reshape(length, s)])
    table = np.zeros((length, s, length))
    for k in range(length):
        table[k, :, : k + 1] = impulse[: k + 1][::-1].T
    return table.reshape(length * s, length).T


def carried(powers: MatrixPowers, level: int, w: Array, r: Array) -> Array:
    """All states of w⁺ = A^(2^level) w + r, (cases, r's + 1, d), by doubling the span of what each has of the r's."""
    cases, count, d = r.shape
    states = np.empty((cases, count + 1, d))
    spans = max(0, (count - 1).bit_length())
    if not powers.reach(level + spans):  # growth: one after the other
        states[:, 0] = w
        for k in range(count):
            states[:, k + 1] = powers.forward(states[:, k], level) + r[:, k]
        return states
    states[:] = orbit(w, count + 1, powers.forward, level).swapaxes(0, 1)
    sums = r.copy()
    for k in range(spans):
        sums[:, 1 << k :] += powers.forward(sums[:, : -(1 << k)], level + k)
    states[:, 1:] += sums
    return states
