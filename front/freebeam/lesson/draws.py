"""What a lesson's exercises are about: the usual data, or others for each student, drawn by a seed."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from freebeam_sym.checks import count

if TYPE_CHECKING:
    from freebeam_sym.columns import Column

__all__ = ["USUAL", "Data", "drawn"]


@dataclass(frozen=True)
class Data:
    """Shares and dampings that exercises ask about.

    near: a distance from a meeting; there is another, a hundred times closer. over, past: shares of the load by which
    it is too large. below, above: shares of the critical load. small, some, strong: internal dampings. ratio: external
    over internal damping, in squared first frequencies. amplitude: of a load that pulsates.
    """

    near: float = 1e-2
    over: float = 0.01
    past: float = 0.02
    below: float = 0.5
    above: float = 0.8
    small: float = 1e-3
    some: float = 0.01
    strong: float = 0.05
    ratio: float = 1.0
    amplitude: float = 0.1
    seed: int | None = None


USUAL = Data()


def drawn(column: Column, seed: int | None) -> tuple[Data, dict[str, Any]]:
    """The data of a seed and the column's own parameters, within a fifth of the way from their defaults to the ends of
    their ranges; the usual data and no parameters without one.

    The same seed gives the same data on any machine. Raises InputError for a seed that is no whole number from 0 on.
    """
    if seed is None:
        return USUAL, {}
    draw = random.Random(count("seed", seed, 0, 10**9, "a whole number, one for each student"))
    choose: Any = draw.choice
    data = Data(
        near=choose((0.5e-2, 1e-2, 2e-2)),
        over=choose((0.005, 0.01, 0.015, 0.02)),
        past=choose((0.01, 0.02, 0.03)),
        below=choose((0.4, 0.5, 0.6, 0.7)),
        above=choose((0.7, 0.75, 0.8, 0.85)),
        small=choose((5e-4, 1e-3, 2e-3)),
        some=choose((0.005, 0.01, 0.015)),
        strong=choose((0.04, 0.05, 0.06)),
        ratio=choose((0.5, 1.0, 1.5, 2.0)),
        amplitude=choose((0.05, 0.1, 0.15)),
        seed=seed,
    )
    own: dict[str, Any] = {}
    for p in column.parameters:
        end = draw.choice((p.low, p.high))
        value = p.default + draw.uniform(0.05, 0.2) * (end - p.default)
        own[p.name] = float(f"{value:.2g}") if p.low <= float(f"{value:.2g}") <= p.high else p.default
    return data, own
