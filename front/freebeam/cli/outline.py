"""A response in outline: its peaks, whether it settles, and a plot in plain text; from its parts, in little memory."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BINS = 1024  # of times, of which the least and the largest value are kept
SETTLED = 0.02  # of the peak, below which a response has settled: the control engineer's 2 %


class Outline:
    """Of columns (name, label of a sensor); `count` times k · step."""

    def __init__(self, step: Fraction, count: int, columns: Sequence[tuple[str, str]]) -> None:
        self.step, self.count, self.columns = step, count, columns
        self.width = -(-count // BINS)
        shape = (-(-count // self.width), len(columns))
        self.low, self.high = np.full(shape, np.inf), np.full(shape, -np.inf)
        self.peaks, self.peaks_at = np.full(len(columns), -1.0), np.zeros(len(columns), dtype=int)

    def time(self, k: int) -> float:
        return float(k * self.step)

    def take(self, begin: int, values: Array) -> None:
        """Values (times, columns) from the time `begin` on."""
        bins = np.arange(begin, begin + len(values)) // self.width
        first = np.flatnonzero(np.diff(bins, prepend=-1))
        own = bins[first]
        self.low[own] = np.minimum(self.low[own], np.minimum.reduceat(values, first))
        self.high[own] = np.maximum(self.high[own], np.maximum.reduceat(values, first))
        sizes = np.abs(values)
        at = sizes.argmax(axis=0)
        found = sizes[at, np.arange(at.size)]
        larger = found > self.peaks
        self.peaks[larger], self.peaks_at[larger] = found[larger], begin + at[larger]

    def settled(self) -> list[float | None]:
        """Of each column, a time from which on it stays below 2 % of its peak, late by a bin at most; None if none."""
        sizes = np.maximum(np.abs(self.low), np.abs(self.high))
        found: list[float | None] = []
        for column, peak in zip(sizes.T, self.peaks, strict=True):
            above = np.flatnonzero(column > SETTLED * peak)
            k = (int(above[-1]) + 1) * self.width if above.size else 0
            found.append(self.time(k) if k < self.count else None)
        return found

    def record(self) -> dict[str, Any]:
        """For JSON: the peaks and the times of settling of name(sensor)."""
        return {
            "rows": self.count,
            "peaks": [
                {"quantity": name, "sensor": label, "peak": peak, "t": self.time(int(at)), "settled": settled}
                for (name, label), peak, at, settled in zip(
                    self.columns, self.peaks, self.peaks_at, self.settled(), strict=True
                )
            ],
        }

    def plot(self, head: str, time: str, width: int = 64, height: int = 13) -> list[str]:
        """Lines of a plot of the first column over time: all between the least and the largest value is filled. head:
        what it is; time: the unit after the end."""
        groups = np.array_split(np.arange(len(self.low)), min(width, len(self.low)))
        low = np.array([self.low[group, 0].min() for group in groups])
        high = np.array([self.high[group, 0].max() for group in groups])
        low[1:], high[1:] = np.minimum(low[1:], high[:-1]), np.maximum(high[1:], low[:-1])  # neighbours touch
        size = max(float(self.peaks[0]), 1e-300)
        low, high = low / size, high / size
        bottom, top = min(float(low.min()), 0.0), max(float(high.max()), 0.0)
        scale = (height - 1) / ((top - bottom) or 1.0)
        first, last = (np.rint((top - part) * scale).astype(int) for part in (high, low))
        zero = round(top * scale)
        lines = [head]
        for row in range(height):
            edge = {0: top, height - 1: bottom, zero: 0.0}
            text = f"{size * edge[row]:.3g}" if row in edge else ""
            filled = (first <= row) & (row <= last)
            marks = "".join("*" if part else "-" if row == zero else " " for part in filled)
            lines.append(f"{text:>10} |{marks}".rstrip())
        end = f"{self.time(self.count - 1):g}"
        lines.append(f"{'':>10} +" + "-" * len(groups))
        return [*lines, f"{'t = 0':>13}{end + time:>{len(groups) - 1}}"]
