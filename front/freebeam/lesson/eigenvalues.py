"""The chapters on eigenvalues, on where two of them meet, and on vanishing damping. Eqs. (24)-(26)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from freebeam.lesson.blocks import Block, Cell, Table
from freebeam.lesson.facts import MODES, Facts
from freebeam.lesson.phrases import arguments, at, exercise, figure, heading, percent, prose, summary

if TYPE_CHECKING:
    from freebeam.lesson.stages import Chapter

__all__ = ["coalescence", "divergence", "eigenvalues", "vanishing_damping"]


def eigenvalues(chapter: Chapter, facts: Facts) -> list[Block]:
    """The eigenvalue problem, and the critical load."""
    from freebeam import figures

    column, found = facts.column, facts.critical
    blocks: list[Block] = [
        heading("stability"),
        prose("stability.opening"),
        *chapter.named(
            "Let all coordinates move alike",
            "Write it as an eigenvalue problem of the first order",
            "Measure eigenvalues in units of the first frequency",
            "Divide by 1 + αλ",
        ),
        *chapter.errata("Section 1", "Section 4.1", "Section 4.3"),
    ]
    own = "".join(f", ${p.latex} = {facts.values[p.name]:g}$" for p in column.parameters)
    if found.load is None:
        return [*blocks, prose("stability.stable", N=facts.modes, own=own, top=found.question.load_max)]
    kind = "flutter" if facts.flutters else "divergence"
    lost = prose(f"stability.{kind}", N=facts.modes, own=own, load=found.load, frequency=facts.frequency)
    asked = f"fb.critical_load(beam, modes={facts.modes}{arguments(facts.own)})"
    code = f"beam = compiled(column)\nfound = {asked}\nprint(found)"
    blocks.append(Cell(code, (lost,)))
    if column.name == "free-free" and not (facts.own or chapter.short):
        blocks += _printed()
    blocks.append(
        figure(
            "frequencies", "Frequencies along the load", f"frequency_load(beam{arguments(facts.own)})",
            lambda: figures.frequency_load(column, **facts.own),
            "Squared frequencies of the undamped column along the load. "
            + ("Where two meet, both leave the real axis." if facts.flutters else "At zero lies divergence."),
        )
    )  # fmt: skip
    return blocks


def _printed() -> list[Block]:
    from freebeam.ledger.scanned import validate

    header = ("section", r"$\alpha$", r"$\beta$", f"computed, $N = {MODES}$", "first step of the scan", "printed")
    rows = tuple(
        (r.section, f"{r.alpha:g}", f"{r.beta:g}", f"{r.load or 0:.6f}", str(r.explained), r.printed)
        for r in validate()
    )
    return [prose("stability.scan"), Table(header, rows)]


def coalescence(chapter: Chapter, facts: Facts) -> list[Block]:
    """Where two frequencies meet."""
    from freebeam import figures

    column, load, own = facts.column, facts.load, arguments(facts.own)
    first, second, third = (facts.overlap(load * share) for share in (0.9, 0.99, 0.999))
    motion = figure(
        "shape", "The motion", f"mode_shape(beam{own})", lambda: figures.mode_shape(column, **facts.own),
        "The motion at the critical load, over half a period.",
    )  # fmt: skip
    return [
        heading("coalescence"),
        prose("coalescence.opening"),
        *chapter.named("Look at the place where two frequencies meet", "Look at the shapes there"),
        prose("coalescence.sensitive", first=first, second=second, third=third),
        figure(
            "meeting", "The meeting", f"coalescence(beam{own})", lambda: figures.coalescence(column, **facts.own),
            "The two eigenvalues near the load where they meet, less their common value there; dotted, the square "
            "root.",
        ),
        *([motion] if column.ends else []),  # links have no shape along a beam
        *_gap_exercises(facts),
    ]  # fmt: skip


def _gap_exercises(facts: Facts) -> list[Block]:
    load = facts.load
    shares = (facts.data.near, facts.data.near / 100)
    far, near = (abs(np.sqrt(a) - np.sqrt(b)) for a, b in (facts.pair(load * (1 - s)) for s in shares))
    power = math.log(far / near) / math.log(shares[0] / shares[1])
    growth = facts.growth((1 + facts.data.over) * load)
    doubling = math.log(2) / growth if growth > 0 else math.inf
    periods = doubling * facts.frequency / (2 * math.pi)
    return [
        exercise(
            "coalescence.gap",
            away=percent(shares[0]),
            closer=percent(shares[1]),
            far=far,
            near=near,
            ratio=far / near,
            power=power,
        ),
        exercise(
            "coalescence.doubling", over=percent(facts.data.over), growth=growth, doubling=doubling, periods=periods
        ),
        exercise("coalescence.perturbation", near=_condition(facts, 0.99), nearer=_condition(facts, 0.9999)),
    ]


def _condition(facts: Facts, share: float) -> float:
    """Cosine of the angle between the right and the left vector of the pair that meets, at a share of its load."""
    values, V = np.linalg.eig(facts.operator(share * facts.load))
    k = int(np.abs(values - facts.frequency**2).argmin())
    left = np.linalg.inv(V)[k]
    return float(1 / np.linalg.norm(left) / np.linalg.norm(V[:, k]))


def divergence(chapter: Chapter, facts: Facts) -> list[Block]:
    """Why no two frequencies meet."""
    load = facts.load
    symmetric = facts.circulatory < 1e-12
    share = facts.data.below
    unloaded, half, most = (float(facts.squares(load * part)[0].real) for part in (0.0, share, 0.9))
    rate = math.sqrt(max(-float(facts.squares((1 + facts.data.over) * load)[0].real), 0.0))
    restored = unloaded > 1e-12 * float(np.abs(facts.squares(0.0)).max())  # not a motion that the load alone holds
    curve = "answer" if symmetric else "bent"
    return [
        replace(heading("divergence"), key="coalescence"),
        prose("divergence.conservative" if symmetric else "divergence.other"),
        prose("divergence.imagined"),
        *chapter.named("Look at the place where two frequencies meet"),
        prose("divergence.statics"),
        *(
            [
                exercise(
                    "divergence.curve",
                    curve,
                    share=percent(share),
                    half=half / unloaded,
                    most=most / unloaded,
                    line=1 - share,
                )
            ]
            if restored
            else []
        ),
        exercise("divergence.growth", over=percent(facts.data.over), rate=rate),
    ]


def vanishing_damping(chapter: Chapter, facts: Facts) -> list[Block]:
    """What a little damping does to the critical load."""
    if "alpha" not in facts.column.damping:
        return [heading("damping"), prose("damping.none")]
    blocks: list[Block] = [
        heading("damping"),
        prose("damping.flutter" if facts.flutters else "damping.divergence"),
        *chapter.named("Damp it a little", "Let the damping vanish"),
    ]
    zero = facts.limit(0.0)
    if facts.flutters and zero.load is not None and zero.frequency:
        return blocks + _lowered(facts, zero.load, zero.frequency)
    some, left = facts.damped(facts.data.some, 0.0), _tangent_left(facts, facts.data.below * facts.load)
    return [
        *blocks,
        prose("damping.unchanged", load=zero.load or math.nan, kind=zero.kind),
        exercise(
            "damping.some", alpha=facts.data.some, load=some.load or math.nan, kind=some.kind, undamped=facts.load
        ),
        exercise("damping.sign", share=percent(facts.data.below), left=left),
        summary("damping.summary_kept"),
    ]


def _lowered(facts: Facts, limit: float, frequency: float) -> list[Block]:
    """Where vanishing damping lowers the critical load, to `limit`."""
    from freebeam import figures

    column, undamped = facts.column, facts.load
    drop = percent(1 - limit / undamped)
    blocks: list[Block] = [
        prose("damping.tangent", load=limit, frequency=frequency, drop=drop, meeting=undamped),
        figure(
            "tangent", "The tangent construction", f"tangent(beam{arguments(facts.own)})",
            lambda: figures.tangent(column, **facts.own),
            "The curve of squared frequencies, and the line from the origin that touches it. Vanishing internal "
            "damping moves the critical load from the meeting to the tangent point.",
        ),
    ]  # fmt: skip
    if "beta" in column.damping:
        ratio = facts.data.ratio * float(facts.squares(0.0)[0].real)
        load = facts.limit(ratio).load or math.nan
        blocks += [
            prose("damping.external"),
            exercise(
                "damping.ratio",
                times=at("damping.times")[f"{facts.data.ratio:g}"],
                ratio=ratio,
                load=load,
                drop=percent(1 - load / undamped),
            ),
        ]
    small = facts.damped(facts.data.small, 0.0).load or math.nan
    strong = facts.damped(facts.data.strong, 0.0)
    load = strong.load or math.nan
    answer = "above" if load > undamped else "between" if load > limit else "below" if strong.load else "none"
    return [
        *blocks,
        exercise("damping.small", alpha=facts.data.small, load=small, limit=limit, share=percent(small / limit - 1)),
        exercise(
            "damping.strong", answer, alpha=facts.data.strong, load=load, kind=strong.kind, top=strong.question.load_max
        ),
        summary("damping.summary_lowered", drop=drop),
    ]


def _tangent_left(facts: Facts, load: float) -> float:
    """P s′ − s of the lowest branch."""
    step = 1e-4 * load
    s = [float(facts.squares(load + side * step)[0].real) for side in (-1, 0, 1)]
    return load * (s[2] - s[0]) / (2 * step) - s[1]
