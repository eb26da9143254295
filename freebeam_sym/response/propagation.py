"""Many steps: outputs at all times from a step's powers, a stretch of steps at a time, by products of matrices.

A stretch is cut into blocks of steps. The states at the blocks' starts come first, then products give all outputs.
Memory beyond the results is bounded by the stretch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from freebeam_sym.response.powers import Powers, orbit

Array = NDArray[np.float64]
Outputs = Mapping[str, Any]
Fill = Callable[[str, Array], None]
Look = Callable[[int], Array]
Store = Callable[[int, int, Fill, bool, range, Look], None]

STRETCH = 20  # 2^20 numbers of a response at a time
CACHE = 18  # 2^18 of a forced one, whose stretches are gone through more than once
GROUP = 3  # 2^3 states are carried at a time, all groups side by side
SMALL = 300_000  # multiplications of a product that BLAS makes at once, without packing


def free(powers: Powers, state: Any, rows: Outputs, count: int, store: Store) -> None:
    """Outputs `rows` (name: (s, d)) of `count` times from states (cases, d) that no force acts on.

    store: called for one stretch after another with its first time, its end, a function that fills an array
    (cases, end − first, s) for one of the names, whether all its numbers are sure to be finite, the
    numbers of steps at which states are at hand, and what gives every so many of these, (cases, times, d), as floats.
    """
    width = sum(len(part) for part in rows.values()) * len(state)
    levels = max(2, min((count - 1).bit_length(), STRETCH, STRETCH + 2 - width.bit_length()))
    while levels and not powers.reach(levels):
        levels -= 1
    inner = min(8, (levels + 1) // 2)
    length = 1 << inner
    tables = {name: np.ascontiguousarray(powers.outputs(part, length).T) for name, part in rows.items()}
    largest = _largest(tables)
    for begin in range(0, count, 1 << levels):
        if begin:
            state = powers.forward(state, levels)
        end = min(count, begin + (1 << levels))
        starts = orbit(state, -(-(end - begin) // length), powers.forward, inner)
        states = powers.floats(starts.swapaxes(0, 1))

        def fill(name: str, part: Array, states: Array = states) -> None:
            _blocks(part, length, lambda at, out: _product(states[:, at], tables[name], out))

        def look(every: int, states: Array = states) -> Array:
            return states[:, ::every]

        store(begin, end, fill, _size(states) * largest < 1e300, range(begin, end, length), look)


def forced(
    powers: Powers,
    state: Any,
    before: Any,
    after: Any,
    rows: Outputs,
    direct: Outputs,
    force: Callable[[int, int], Array],
    count: int,
    store: Store,
) -> None:
    """The same under a force: x⁺ = A x + before F + after F⁺, outputs rows x + direct F.

    force: F of times begin, …, end − 1, shape (cases, end − begin). What is not finite in it makes a stretch unsure.
    """
    # w = x − after F needs the force at the old time only.
    B = powers.forward(after, 0) + before
    cases, d = len(state), len(powers.floats(B))
    inner = min(max(5, (d - 1).bit_length()), max(0, (count - 1).bit_length() - 2))
    while inner and not powers.reach(inner):
        inner -= 1
    length = 1 << inner
    width = sum(len(part) for part in rows.values()) * cases
    levels = max(inner + GROUP, min(inner + 4 * GROUP, CACHE - width.bit_length()))
    while levels > inner and not powers.reach(levels):
        levels -= 1
    free_of, pushed = {}, {}
    for name, part in rows.items():
        table = powers.outputs(part, length)
        at_once = direct[name] + powers.outputs(part, 1) @ powers.floats(after)
        free_of[name] = np.ascontiguousarray(table.T)
        pushed[name] = _responses(table @ powers.floats(B), at_once, length)
    largest = max(_largest(free_of), _largest(pushed))
    drive = np.ascontiguousarray(powers.floats(orbit(B, length, powers.forward)[::-1]))
    w = state - force(0, 1) * after
    for begin in range(0, count, 1 << levels):
        end = min(count, begin + (1 << levels))
        values = force(begin, end)
        if over := -values.shape[1] % length:
            values = np.concatenate([values, np.zeros((cases, over))], axis=1)
        forces = values.reshape(cases, -1, length)
        pushes = _product(forces, drive, np.empty((*forces.shape[:2], d)))
        starts = carried(powers, inner, w, powers.states(pushes))
        states, w = powers.floats(starts[:, :-1]), starts[:, -1]

        def fill(name: str, part: Array, forces: Array = forces, states: Array = states) -> None:
            def both(at: slice, out: Array) -> None:
                _product(forces[:, at], pushed[name], out)
                out += _product(states[:, at], free_of[name], np.empty(out.shape))

            _blocks(part, length, both)

        def look(every: int, forces: Array = forces, states: Array = states) -> Array:
            found: Array = states[:, ::every] + forces[:, ::every, :1] * powers.floats(after)
            return found

        safe = (_size(states) + _size(forces)) * largest < 1e300
        store(begin, end, fill, safe, range(begin, end, length), look)


def _blocks(part: Array, length: int, fill: Callable[[slice, Array], object]) -> None:
    """Fill an array (cases, times, s) by blocks, (cases, blocks, length s): a slice of them at a time. What has no
    room in the last is dropped."""
    cases, times, s = part.shape
    whole, over = divmod(times, length)
    if whole:
        fill(slice(whole), part[:, : whole * length].reshape(cases, whole, length * s))
    if over:
        last = np.empty((cases, 1, length * s))
        fill(slice(whole, whole + 1), last)
        part[:, whole * length :] = last.reshape(cases, length, s)[:, :over]


def _product(a: Array, b: Array, out: Array) -> Array:
    """a @ b into `out`, (cases, m, n), some rows at a time."""
    cases, count, d = a.shape
    rows = 1 << max(0, (SMALL // (d * b.shape[1])).bit_length() - 1)
    whole = count // rows * rows if rows >= 8 else 0
    if whole:
        parts = out[:, :whole].reshape(cases, -1, rows, out.shape[2])
        np.matmul(a[:, :whole].reshape(cases, -1, rows, d), b, out=parts)
    if whole < count:
        np.matmul(a[:, whole:], b, out=out[:, whole:])
    return out


def _largest(tables: Mapping[str, Array]) -> float:
    """Bound of what they make of numbers, a unit of these' norm."""
    return max(float(np.abs(table).max()) * len(table) for table in tables.values())


def _size(states: Array) -> float:
    flat = states.ravel()
    return math.sqrt(np.vdot(flat, flat))


def _responses(impulse: Array, at_once: Array, length: int) -> Array:
    """What a block's forces give to its outputs: (length, length s), the response to an impulse shifted."""
    s = len(at_once)
    impulse = np.concatenate([at_once[None], impulse.reshape(length, s)])
    table = np.zeros((length, length, s))
    for k in range(length):
        table[k, k:] = impulse[: length - k]
    return table.reshape(length, length * s)


def carried(powers: Powers, level: int, w: Any, r: Any) -> Any:
    """All states of w⁺ = A^(2^level) w + r, (cases, r's + 1, d): those at the starts of groups of r's are carried in
    the same way, with what a group adds to them."""
    cases, count, d = r.shape
    group, grows = 1 << GROUP, not powers.reach(level + GROUP)
    number = -(-count // group) if count > group and not grows else 0
    if over := max(0, number * group - count):
        r = np.concatenate([r, np.zeros((cases, over, d), dtype=r.dtype)], axis=1)
    states = np.empty((cases, count + over + 1, d), dtype=r.dtype)
    if number:
        totals, spread = powers.groups(r.reshape(cases, number, group, d), level)
        starts = carried(powers, level + GROUP, w, totals)
        spread(starts[:, :-1], states[:, :-1].reshape(cases, number, group, d))
        states[:, -1] = starts[:, -1]
        return states[:, : count + 1]
    states[:, 0] = w
    if not grows:
        _, spread = powers.groups(r[:, None], level)
        spread(states[:, None, 0], states[:, None, :-1])
    for k in range(0 if grows else count - 1, count):
        states[:, k + 1] = powers.forward(states[:, k], level) + r[:, k]
    return states
