"""Curves as plain text, for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

WIDTH, HEIGHT = 64, 15
"""Characters and lines inside the axes."""


def plotted(curves: Sequence[tuple[Any, Any, str]], across: str, up: str) -> list[str]:
    """Lines of a plot of curves, each x (m,), y (m,) and the character that marks it; zero has a line where it is
    inside. Values that are not finite are left out; of curves that meet the last is seen."""
    points = [(np.asarray(x, dtype=float), np.asarray(y, dtype=float), mark) for x, y, mark in curves]
    known = [(x[np.isfinite(x + y)], y[np.isfinite(x + y)]) for x, y, _ in points]
    (left, right), (low, high) = (_range(np.concatenate([pair[k] for pair in known])) for k in (0, 1))
    grid = [[" "] * WIDTH for _ in range(HEIGHT)]

    def column(x: Any) -> Any:
        return np.rint((x - left) / (right - left) * (WIDTH - 1)).astype(int)

    def row(y: Any) -> Any:
        return np.rint((high - y) / (high - low) * (HEIGHT - 1)).astype(int)

    if low < 0 < high:
        grid[int(row(0.0))] = ["-"] * WIDTH
    if left < 0 < right:
        for line in grid:
            line[int(column(0.0))] = "|"
    for (x, y), (_, _, mark) in zip(known, points, strict=True):
        for i, j in zip(row(y), column(x), strict=True):
            grid[i][j] = mark
    edges = {0: f"{high:.4g}", HEIGHT - 1: f"{low:.4g}"} | ({int(row(0.0)): "0"} if low < 0 < high else {})
    lines = [up, *(f"{edges.get(k, ''):>10} |{''.join(line)}".rstrip() for k, line in enumerate(grid))]
    ends = f"{left:.4g}", f"{right:.4g}"
    between = across.center(WIDTH - len(ends[0]) - len(ends[1]))
    return [*lines, f"{'':>10} +{'-' * WIDTH}", f"{'':>12}{ends[0]}{between}{ends[1]}"]


def _range(values: Any) -> tuple[float, float]:
    """Least and largest value, apart from each other."""
    low, high = float(values.min()), float(values.max())
    room = 1e-6 * max(abs(low), abs(high)) or 1.0
    return (low, high) if high - low > room else (low - room, high + room)
