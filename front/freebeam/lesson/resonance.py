"""The chapter on a load that pulsates: multipliers, the principal region by hand, all regions by the program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.lesson.blocks import Block, Cell, Figure
from freebeam.lesson.phrases import exercise, heading, prose, summary, text
from freebeam_sym.question import Question
from freebeam_sym.spectra import spectrum

if TYPE_CHECKING:
    from freebeam.lesson.facts import Facts
    from freebeam.lesson.stages import Chapter

__all__ = ["pulsation"]

GRID = {True: (28, 10), False: (48, 12)}
"""Frequencies and amplitudes of the picture, of several segments or one: two seconds for four segments."""


def pulsation(chapter: Chapter, facts: Facts) -> list[Block]:
    """Parametric resonance about twice the lowest frequency, at half the critical load."""
    from freebeam.pulsating import growth as pulse

    segments = len(facts.column.kernel.COLUMN["breaks"]) - 1 if facts.column.general else 1
    modes = max(2 if segments > 1 else 4, int(facts.column.kernel.COLUMN.get("least", 1)))
    question = Question.of(facts.column, modes, **facts.own)
    load = facts.data.below * facts.load
    frequency, slope = _branch(question, load)
    blocks: list[Block] = [
        heading("pulsation"),
        prose("pulsation.opening"),
        *chapter.named("Follow one mode while the load pulsates", "Find the edges of the principal region"),
    ]
    if frequency is None:
        return [*blocks, prose("pulsation.none", load=load)]
    across, up = GRID[segments > 1]
    Omega = np.linspace(1.3 * frequency, 2.7 * frequency, across)
    eps = np.linspace(0.0, min(1.0, 0.9 / facts.data.below - 0.9), up)

    def draw() -> Any:
        from freebeam import figures

        ax = figures.pulsating_regions(pulse.grid(question, load, Omega, eps))
        for drawn_ in ax.collections:  # few rectangles, which follow the page's colours as no image does
            drawn_.set_rasterized(False)
        return ax

    drawn = Figure("regions", draw, text("pulsation.drawn", load=load), "Regions in which motion grows")
    code = (
        f"regions = fb.pulse(beam, {modes}, load={load:.6g}, frequency={_values(Omega)}, amplitude={_values(eps)})\n"
        "draw(fb.figures.pulsating_regions, regions)"
    )
    blocks += [*chapter.named("Multiply the multipliers"), prose("pulsation.all"), Cell(code, (drawn,))]
    amplitude = facts.data.amplitude
    low, high = (2 * np.sqrt(frequency**2 + sign * amplitude * load * slope / 2) for sign in (1, -1))
    low, high = sorted((float(low), float(high)))
    found = pulse.grid(question, load, np.linspace(low - 0.3 * (high - low), high + 0.3 * (high - low), 7), [amplitude])
    region = next((r for r in found.at(amplitude) if r.kind == "principal-2T" and r.low and r.high), None)
    if region is not None:
        blocks.append(
            exercise("pulsation.edges", amplitude=amplitude, load=load, low=low, high=high, left=region.low,
                     right=region.high)
        )  # fmt: skip
    blocks.append(exercise("pulsation.product", load=load))
    return [*blocks, summary("pulsation.summary", double=2 * frequency)]


def _branch(question: Question, load: float) -> tuple[float | None, float]:
    """ω of the lowest swinging mode at a load, and the slope of ω² by the load; None where it does not swing."""

    def lowest(at: float) -> float:
        values = spectrum(question.system(at)).elastic
        swinging = values[values.imag > 1e-6 * np.abs(values).max()]
        return float(np.abs(swinging).min()) if len(swinging) else np.nan

    step = 1e-4 * load
    before, here, after = (lowest(load + side * step) for side in (-1, 0, 1))
    return (here if np.isfinite(here) else None), (after**2 - before**2) / (2 * step)


def _values(values: Any) -> str:
    return str([round(float(value), 5) for value in values])
