"""The chapters after the derivation of a column of segments: its first loss of stability, and what moves that."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.lesson.blocks import Block, Cell, Table
from freebeam.lesson.eigenvalues import coalescence, divergence
from freebeam.lesson.phrases import arguments, exercise, figure, heading, n, percent, prose, summary, text
from freebeam.lesson.physics import closed, enclosed, work
from freebeam.lesson.resonance import pulsation
from freebeam_sym.checks import InputError, Unstable
from freebeam_sym.question import Question
from freebeam_sym.spectra import spectrum

if TYPE_CHECKING:
    from freebeam.lesson.facts import Facts
    from freebeam.lesson.stages import Chapter
    from freebeam_derive.statement import Column as Statement
    from freebeam_sym.columns import Parameter

__all__ = ["general_physics"]

SMALL = 1.0
"""Load up to which eigenvalues of a column are told that is unstable at once."""
POINTS = 11
"""Values of a parameter along which a curve of critical loads is computed."""


def general_physics(chapter: Chapter, facts: Facts) -> tuple[Block, ...]:
    """From the eigenvalue problem to the cost of the series, of any column; of one that grows at the smallest loads
    that it does, and its spectrum."""
    try:
        found = [*loss(chapter, facts)]
    except Unstable:
        return (*_opening(chapter), prose("loss.unstable"), *_lowest(facts, SMALL), summary("loss.never"))
    if facts.critical.load is not None:
        if facts.undamped and facts.linear:
            name, told = ("coalescence", coalescence) if facts.flutters else ("divergence", divergence)
            found += closed(name, told(chapter, facts))
        found += damping(chapter, facts)
        found += closed("work", work(chapter, facts))
    found += control(chapter, facts)
    if facts.critical.load is not None:
        found += [*parameters(facts), *pulsation(chapter, facts), *truncation(chapter, facts)]
    return tuple(found)


def _settings(facts: Facts) -> str:
    return "".join(f", ${p.latex or p.name} = {facts.values[p.name]:g}$" for p in facts.column.parameters)


def _opening(chapter: Chapter) -> list[Block]:
    return [
        heading("stability"),
        prose("stability.opening"),
        *chapter.named("Let all coordinates move alike", "Write it as an eigenvalue problem of the first order"),
    ]


def loss(chapter: Chapter, facts: Facts) -> list[Block]:
    """The eigenvalue problem, the first loss of stability, the lowest eigenvalues, the root locus."""
    from freebeam import figures

    column, found, own = facts.column, facts.critical, facts.own
    blocks = [*_opening(chapter), prose("loss.how")]
    N, settled = facts.modes, _settings(facts)
    if found.load is None:
        lost = prose("loss.stable", N=N, own=settled, top=found.question.load_max)
    else:
        kind = "divergence" if not facts.flutters else "meet" if facts.undamped else "cross"
        lost = prose(f"loss.{kind}", N=N, own=settled, load=found.load, frequency=facts.frequency)
    code = f"beam = compiled(column)\nfound = fb.critical_load(beam, modes={facts.modes}{arguments(own)})\nprint(found)"
    top = found.load or found.question.load_max / 10
    blocks += [Cell(code, (lost,)), *_error(facts), *_lowest(facts, top)]
    if found.load is None:
        return [*blocks, summary("loss.stays")]
    if facts.undamped:
        blocks.append(
            figure(
                "frequencies", "Frequencies along the load", f"frequency_load(beam{arguments(own)})",
                lambda: figures.frequency_load(column, **own),
                text("loss.curves_meet" if facts.flutters else "loss.curves_fall"),
            )
        )  # fmt: skip
    damped = {"alpha": facts.data.some} if "alpha" in facts.damping else {}
    settings = {**damped, **own}
    blocks.append(
        figure(
            "locus", "The root locus", f"root_locus(beam{arguments(settings)})",
            lambda: figures.root_locus(column, **settings), text("loss.locus", damped=_damped(damped)),
        )
    )  # fmt: skip
    load = facts.data.above * facts.load
    rate = spectrum(facts.question.system(load)).growth_rate
    tiny = 1e-9 * max(abs(facts.frequency), 1.0)
    return [
        *blocks,
        exercise("loss.below", "answer" if abs(rate) < tiny else "decays", load=load, rate=rate),
        exercise("loss.unloaded", lowest=_lowest_frequency(facts)),
        summary("loss.summary", load=facts.load, kind=found.kind),
    ]


def _damped(dampings: dict[str, float]) -> str:
    return "".join(rf", $\{name} = {size:g}$" for name, size in dampings.items())


def _error(facts: Facts) -> list[Block]:
    """What is known of the beam itself, and how far the series is off."""
    beam, error = facts.critical.beam, facts.critical.error
    if beam is None:
        return [prose("loss.unknown")]
    if error is None or facts.critical.load is None:
        return []
    return [prose("loss.error" if facts.critical.converged else "loss.off", kind=beam.kind, error=_size(error))]


def _size(error: float) -> str:
    size = abs(error)
    return n(float(f"{size:.1g}"), 1) if size > 1e-14 else "$10^{-14}$"


def _lowest(facts: Facts, top: float) -> list[Block]:
    """The lowest eigenvalues at some loads up to a load."""
    loads = [share * top for share in (0.0, 0.5, 0.9)]
    columns = []
    for load in loads:
        values = spectrum(facts.question.system(load)).eigenvalues
        upper = values[values.imag >= 0]
        upper[np.abs(upper) < _rounding(values)] = 0.0
        columns.append(upper[np.argsort(np.abs(upper))][:4])
    count = min(map(len, columns))
    header = ("", *(f"$P_0 = {load:.5g}$" for load in loads))
    rows = [(rf"$\lambda_{{{k + 1}}}$", *(_complex(values[k]) for values in columns)) for k in range(count)]
    return [prose("loss.table"), Table(header, tuple(rows))]


def _rounding(values: Any) -> float:
    """Size below which an eigenvalue is zero but for rounding: the root of that of its square, which is of the size of
    the largest."""
    return float(1e-7 * np.abs(values).max())


def _complex(value: complex) -> str:
    small = 1e-9 * max(abs(value), 1.0)
    real, imaginary = (0.0 if abs(part) < small else part for part in (value.real, value.imag))
    if not imaginary:
        return f"${real:.5g}$"
    return (
        f"${real:.4g} {'+' if imaginary > 0 else '-'} {abs(imaginary):.5g}\\,i$" if real else f"${imaginary:.5g}\\,i$"
    )


def _lowest_frequency(facts: Facts) -> float:
    values = spectrum(facts.question.system(0.0)).elastic
    return float(values.imag[values.imag > _rounding(values)].min(initial=math.inf))


def damping(chapter: Chapter, facts: Facts) -> list[Block]:
    """What a little damping does."""
    if not facts.damping or not facts.undamped:
        return [heading("small"), prose("small.own" if not facts.undamped else "small.none")]
    blocks: list[Block] = [heading("small"), prose("small.opening"), *chapter.named("Damp any column a little")]
    answers = _limits(facts)
    if answers:
        rows = tuple((name, f"{load:.6g}", kind) for name, load, kind in answers)
        blocks += [prose("small.limits", undamped=facts.load), Table(("limit", "$P_0$", "kind"), rows)]
    blocks += _tangent(facts)
    values = []
    for name in facts.damping:
        size = facts.data.some if name == "alpha" else 0.1
        found = facts.damped(**{"alpha": 0.0, "beta": 0.0, name: size})
        values.append((rf"\{name}", size, found))
    for letter, size, found in values[:2]:
        lost = "answer" if found.load is not None else "stable"
        blocks.append(
            exercise(
                "small.some", lost, damping=letter, size=size, load=found.load or 0.0, kind=found.kind,
                undamped=facts.load, top=found.question.load_max,
            )
        )  # fmt: skip
    lowest = min((load for _, load, _ in answers), default=facts.load)
    drop = 1 - lowest / facts.load
    return [*blocks, summary("small.lowered" if drop > 1e-6 else "small.kept", drop=percent(drop))]


def _limits(facts: Facts) -> list[tuple[str, float, str]]:
    """Limits of vanishing damping: internal alone, external alone."""
    found: list[tuple[str, float, str]] = []
    for name, words, kappa in (("alpha", "internal damping alone", 0.0), ("beta", "external damping alone", math.inf)):
        if name in facts.damping:
            try:
                limit = facts.limit(kappa)
            except InputError:
                continue
            if limit.load is not None:
                found.append((words, limit.load, limit.kind))
    return found


def _tangent(facts: Facts) -> list[Block]:
    """The tangent construction, where the damping is of the kind that it belongs to."""
    from freebeam import figures
    from freebeam.figures import curves

    try:
        curves.tangent(Question.of(facts.column, facts.modes, kappa=0.0, **facts.own), points=8)
    except InputError:
        return []
    return [
        prose("small.tangent"),
        figure(
            "tangent", "The tangent construction", f"tangent(beam{arguments(facts.own)})",
            lambda: figures.tangent(facts.column, **facts.own), text("small.line"),
        ),
    ]  # fmt: skip


def control(chapter: Chapter, facts: Facts) -> list[Block]:
    """Forces that a sensor elsewhere steers."""
    statement = chapter.derived.column
    steered = _sensors(statement, facts.values)
    if not steered:
        return []
    pairs = "; ".join(text("control.pair", sensor=sensor, force=force) for sensor, force in steered)
    blocks: list[Block] = [heading("control"), prose("control.opening", pairs=pairs)]
    gain = next((p for p in facts.column.parameters if _steers(statement, facts, p)), None)
    if gain is not None:
        blocks += _turned_up(facts, gain)
    else:
        blocks.append(exercise("control.share", share=facts.circulatory))
    return [*blocks, summary("control.summary")]


def _turned_up(facts: Facts, gain: Parameter) -> list[Block]:
    """The critical load along a gain, and without control."""
    from freebeam import figures
    from freebeam.maps.known import answer

    letter = gain.latex or gain.name
    values = np.linspace(*_gains(facts, gain), POINTS)
    own: dict[str, Any] = {name: value for name, value in facts.own.items() if name != gain.name}
    blocks: list[Block] = [
        prose("control.gain", letter=letter),
        figure(
            "gain", "The critical load along the gain",
            f'critical_curve(beam, "{gain.name}", {_listed(values)}{arguments(own)})',
            lambda: figures.critical_curve(facts.column, gain.name, values, **own), text("control.curve"),
        ),
    ]  # fmt: skip
    try:
        without = answer(facts.question.at(**{gain.name: 0.0}))
    except InputError:  # nothing holds a rigid motion then
        return blocks
    lost, top = "answer" if without.load is not None else "stable", without.question.load_max
    load = without.load or 0.0
    return [*blocks, exercise("control.off", lost, letter=letter, load=load, kind=without.kind, top=top)]


def _gains(facts: Facts, gain: Parameter) -> tuple[float, float]:
    """From a tenth of the gain, below which nothing may hold a rigid motion, to four times."""
    value = abs(facts.values[gain.name]) or 0.1
    return max(gain.low, value / 10), min(gain.high, 4 * value)


def _listed(values: Any) -> str:
    return str([round(float(value), 6) for value in values])


def _sensors(statement: Statement, values: Mapping[str, float]) -> list[tuple[float, float]]:
    """Places of sensors, and of the forces that they steer."""
    from freebeam_derive.drawn import parts_of

    return parts_of(statement, {p.symbol: values[p.name] for p in statement.parameters}).sensors


def _steers(statement: Statement, facts: Facts, p: Parameter) -> bool:
    """Whether a parameter is a gain: without it, some sensor steers nothing."""
    if not p.low <= 0.0 <= p.high:
        return False
    without = _sensors(statement, {**facts.values, p.name: 0.0})
    return len(without) < len(_sensors(statement, facts.values))


def parameters(facts: Facts) -> list[Block]:
    """How the load moves with the column's parameters, and a map over both dampings."""
    from freebeam import figures

    column = facts.column
    blocks: list[Block] = []
    if column.parameters:
        slopes = facts.critical.gradient
        rows = tuple(
            (f"${p.latex or p.name}$", f"{facts.values[p.name]:g}", _slope(facts, p.name, slopes))
            for p in column.parameters
        )
        blocks += [prose("parameters.gradient"), Table(("parameter", "value", "rate of the critical load"), rows)]
        p = max(column.parameters, key=lambda p: _moves(slopes.get(p.name, math.nan), p))
        values = np.linspace(*_range(p, facts.values[p.name]), POINTS)
        own: dict[str, Any] = {name: value for name, value in facts.own.items() if name != p.name}
        blocks.append(
            figure(
                "diagram", "The critical load along a parameter",
                f'critical_curve(beam, "{p.name}", {_listed(values)}{arguments(own)})',
                lambda: figures.critical_curve(column, p.name, values, **own), text("parameters.curve"),
            )
        )  # fmt: skip
        slope = slopes.get(p.name, math.nan)
        if math.isfinite(slope):
            change = 0.02 * (abs(facts.values[p.name]) or 1.0)
            exact = _moved(facts, p.name, change)
            if exact is not None:
                blocks.append(
                    exercise(
                        "parameters.change", letter=p.latex or p.name, change=change, guess=slope * change, exact=exact
                    )
                )
    if set(facts.damping) >= {"alpha", "beta"}:
        blocks += _map(facts)
    if not blocks:
        return []
    return [heading("parameters"), prose("parameters.opening"), *blocks, summary("parameters.summary")]


def _range(p: Any, value: float) -> tuple[float, float]:
    """Values of a parameter to draw: its range, but no further than three times its value."""
    high = min(p.high, 3 * abs(value)) if value else p.high
    low = max(p.low, value / 4) if value > 0 else p.low
    return low, high if high > low else p.high


def _slope(facts: Facts, name: str, slopes: dict[str, float]) -> str:
    """A rate to the digits that hold; central differences of matrices leave some 1e-10 of the load."""
    slope = slopes.get(name, math.nan)
    if not math.isfinite(slope):
        return "none: two frequencies meet"
    rounding = 1e-9 * facts.load / max(abs(facts.values[name]), 1e-2)
    return f"{slope:.5g}" if abs(slope) > rounding else "0, but for rounding"


def _moves(slope: float, p: Any) -> float:
    return abs(slope) * (p.high - p.low) if math.isfinite(slope) else -1.0


def _moved(facts: Facts, name: str, change: float) -> float | None:
    """By how much the critical load changes with a parameter, computed again."""
    from freebeam.maps.known import answer

    try:
        moved = answer(facts.question.at(**{name: facts.values[name] + change}))
    except InputError:
        return None
    return moved.load - facts.load if moved.load is not None and moved.kind == facts.critical.kind else None


def _map(facts: Facts) -> list[Block]:
    """Critical loads over both dampings."""
    from freebeam import figures
    from freebeam.maps.arrays import critical_loads

    alpha, beta = np.geomspace(1e-4, 1e-1, 9), np.geomspace(1e-3, 1.0, 9)

    def draw() -> Any:
        found = critical_loads(facts.column, facts.modes, alpha[:, None], beta[None, :], **facts.own)
        return figures.stability_map(found.load, alpha, beta, xlabel=r"$\alpha$", ylabel=r"$\beta$")

    drawing = figure("map", "The map of both dampings", "", draw, text("parameters.map"))
    return [prose("parameters.dampings"), Cell("", drawing.blocks)]


def truncation(chapter: Chapter, facts: Facts) -> list[Block]:
    """The error of the series against the beam itself."""
    from freebeam.maps.known import answer

    least = int(facts.column.kernel.COLUMN["least"])
    counts = [k for k in (2, 3, 4, 6, 8, 12) if k >= least] if facts.column.fields else []
    if not counts:
        return []
    loads = {}
    for k in counts:
        try:
            found = answer(Question.of(facts.column, k, **facts.own))
        except InputError:
            continue
        loads[k] = found.load if found.kind == facts.critical.kind else None
    reference = facts.beam_load or facts.load
    rows = tuple((str(k), *_compared(load, reference)) for k, load in loads.items())
    good = next((k for k, load in loads.items() if load is not None and abs(load / reference - 1) < 1e-6), None)
    found_blocks: list[Block] = [
        heading("truncation"),
        prose("truncation.general"),
        *chapter.named("Leave the series out"),
        enclosed(facts),
        Table(("$N$", "critical load", "error"), rows),
    ]
    if good is not None:
        found_blocks.append(exercise("truncation.millionth", N=good))
    return [*found_blocks, summary("truncation.exponential")]


def _compared(load: float | None, reference: float) -> tuple[str, str]:
    if load is None:
        return "none of this kind", "—"
    error = load / reference - 1
    return f"{load:.9g}", f"{error:+.1e}" if abs(error) > 1e-13 else "rounding"
