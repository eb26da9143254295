"""The chapters after the derivation: what the matrices say of flutter, computed and drawn for the column at hand."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from freebeam.lesson.blocks import Block, Cell, Table
from freebeam.lesson.eigenvalues import coalescence, divergence, eigenvalues, vanishing_damping
from freebeam.lesson.facts import Facts
from freebeam.lesson.phrases import exercise, figure, heading, n, percent, prose, summary, text
from freebeam.lesson.resonance import pulsation
from freebeam.lesson.theorem import theorem
from freebeam_sym.question import Question

if TYPE_CHECKING:
    from freebeam.lesson.stages import Chapter

__all__ = ["closed", "enclosed", "physics_chapters", "work"]


def physics_chapters(chapter: Chapter, facts: Facts) -> tuple[Block, ...]:
    """From the eigenvalue problem to the cost of the series. Eqs. (24)-(26)."""
    found = closed("stability", eigenvalues(chapter, facts))
    if facts.critical.load is None:
        return (*found, *rigid(chapter, facts))
    if facts.flutters:
        found += closed("coalescence", coalescence(chapter, facts))
    else:
        found += closed("divergence", divergence(chapter, facts))
    return (
        *found,
        *vanishing_damping(chapter, facts),
        *closed("work", work(chapter, facts)),
        *rigid(chapter, facts),
        *pulsation(chapter, facts),
        *closed("truncation", truncation(chapter, facts)),
        *theorem(facts),
    )


def closed(chapter: str, blocks: list[Block]) -> list[Block]:
    """A chapter's blocks with its summary."""
    return [*blocks, summary(f"{chapter}.summary")]


def work(chapter: Chapter, facts: Facts) -> list[Block]:
    """What the load gives and damping takes over a cycle."""
    blocks: list[Block] = [
        heading("work"),
        prose("work.opening"),
        *chapter.named("Add up the work over one cycle", "Keep what does not cancel"),
    ]
    if facts.circulatory < 1e-12:
        share, rate = facts.circulatory, _swinging(facts, 2 * facts.load)
        return [
            *blocks,
            prose("work.conservative"),
            exercise("work.symmetric", "rounding" if share else "answer", share=share),
            exercise("work.friend", rate=rate),
        ]
    if not facts.flutters:
        return [*blocks, prose("work.unused")]
    damping = {name: size for name, size in (("alpha", facts.data.small), ("beta", 0.1)) if name in facts.damping}
    return [*blocks, *_balance(facts, damping), *_work_exercises(facts, damping)]


def _balance(facts: Facts, damping: dict[str, Any]) -> list[Block]:
    """One period of the least stable motion below, at and above the critical load of some damping."""
    from freebeam import figures
    from freebeam.figures import curves

    if not damping:
        return []
    column = facts.column
    whole: dict[str, Any] = {"alpha": 0.0, "beta": 0.0, **damping}
    critical = facts.damped(whole["alpha"], whole["beta"]).load or facts.load
    rows = []
    for share in (0.9, 1.0, 1.1):
        c = curves.cycle(Question.of(column, facts.modes, **damping, **facts.own), share * critical)
        rate = c.eigenvalue.real if abs(c.eigenvalue.real) > 1e-9 * abs(c.eigenvalue) else 0.0
        rows.append((f"{share * critical:.5g}", f"{c.work[-1]:.4g}", f"{c.dissipated[-1]:.4g}", f"{rate:.3g}"))
    whole |= facts.own
    named = " and ".join(f"$\\{name} = {size:g}$" for name, size in damping.items())
    arguments = ", ".join(f"{name}={size:g}" for name, size in whole.items())
    blocks: list[Block] = [
        prose("work.travelling", dampings=named),
        Table(("$P_0$", "given by the load", "taken by damping", "growth rate"), tuple(rows)),
        figure(
            "work", "The balance of one period", f"work(beam, {arguments})", lambda: figures.work(column, **whole),
            "Energy given by the load and taken by damping through one period at the critical load.",
        ),
    ]  # fmt: skip
    if curves.follower_share(facts.question):
        caption = (
            "The follower force's transversal part against the deflection of its end: the loop's area is the work."
        )
        call = f"work_loop(beam, {arguments})"
        title = "The force against the end's deflection"
        blocks.append(figure("loop", title, call, lambda: figures.work_loop(column, **whole), caption))
    return blocks


def _work_exercises(facts: Facts, damping: dict[str, Any]) -> list[Block]:
    from freebeam.figures import curves

    found: list[Block] = []
    if facts.undamped:  # else something takes energy without alpha and beta too
        past = curves.cycle(facts.question, (1 + facts.data.past) * facts.load)
        given, rate = float(past.work[-1]), past.eigenvalue.real
        found.append(exercise("work.past", over=percent(facts.data.past), given=given, rate=rate))
    found.append(exercise("work.circulatory", share=facts.circulatory))
    if damping:
        load = facts.data.below * facts.load
        c = curves.cycle(Question.of(facts.column, facts.modes, **damping, **facts.own), load)
        given, taken = float(c.work[-1]), float(c.dissipated[-1])
        gives = "gives" if given > 0 else "takes"
        found.append(
            exercise(
                "work.half",
                gives=gives,
                given=abs(given),
                taken=taken,
                rate=c.eigenvalue.real,
                load=load,
                share=percent(facts.data.below),
            )
        )
    return found


def _swinging(facts: Facts, load: float) -> float:
    """Largest growth rate of a motion that swings, at a load."""
    s = facts.squares(load)
    values = np.append(np.sqrt(-s), -np.sqrt(-s))
    swinging = values[np.abs(values.imag) > 1e-6 * np.abs(values).max()]
    return abs(float(max(swinging.real.max(initial=0.0), 0.0)))


def rigid(chapter: Chapter, facts: Facts) -> list[Block]:
    """What rigid functions would change."""
    column = facts.column
    count = column.rigid_count
    if not count:
        return [
            heading("rigid"),
            prose("rigid.none", left=column.ends[0], right=column.ends[1]),
            exercise("rigid.zero", least=float(facts.pencil.e[0])),
            exercise("rigid.pairs", pairs=_rigid_pairs()),
            summary("rigid.summary_none"),
        ]
    M, _, H = column.matrices(facts.modes, True, **facts.own)
    forth = float(np.abs(H[count:, :count]).max() / np.abs(H).max())
    back = float(np.abs(H[:count, count:]).max() / np.abs(H).max())
    load = facts.data.above * facts.load if facts.critical.load else 10.0
    difference = _spectra_apart(facts, load)
    tumbles = np.abs(H[:count, :count]).max() > 1e-12
    blocks: list[Block] = [
        heading("rigid"),
        prose("rigid.opening"),
        *chapter.named("Put the rigid functions in front"),
        prose("rigid.theorem", tumbles=text("rigid.tumbles") + " " if tumbles else ""),
        exercise("rigid.spectra", "rounding" if difference < 1e-6 else "answer", load=load, difference=difference),
        exercise("rigid.coupling", forth=forth or "Zero", back=back),
    ]
    block = np.linalg.solve(M[:count, :count], H[:count, :count])
    if count == 2 and abs(block[0, 1]) > 1e-12 and not np.abs(block - np.triu(block, 1)).max() > 1e-12:
        blocks.append(exercise("rigid.drift", factor=-block[0, 1], sixth=-block[0, 1] / 6))
    return closed("rigid", blocks)


def _spectra_apart(facts: Facts, load: float) -> float:
    """Largest relative difference of the elastic ω² without rigid functions from the nearest with them."""
    whole, elastic = (
        np.linalg.eigvals(np.linalg.solve(s.M, s.K))
        for s in (facts.column.system(facts.modes, load, rigid=rigid, **facts.own) for rigid in (True, False))
    )
    return float(max(np.abs(whole - s).min() / abs(s) for s in elastic))


def _rigid_pairs() -> str:
    from freebeam_derive.comparison import rigid_functions
    from freebeam_derive.statement import GEOMETRIC

    kinds = tuple(GEOMETRIC)
    pairs = [(a, b) for i, a in enumerate(kinds) for b in kinds[i:]]
    return ", ".join(f"{a}-{b} ({len(rigid)})" for a, b in pairs if (rigid := rigid_functions((a, b))))


def truncation(chapter: Chapter, facts: Facts) -> list[Block]:
    """The error of the series against the beam itself."""
    counts = (2, 4, 8, 16, 32)
    ritz = cache(facts.ritz)
    loads = {basis: {k: ritz(k, basis) for k in counts} for basis in ("modes", "legendre")}
    reference = facts.beam_load if facts.beam_load is not None else loads["legendre"][16] or facts.load

    def cell(load: float | None) -> tuple[str, str]:
        if load is None:
            return "none of this kind", "—"
        error = load / reference - 1
        return f"{load:.9g}", f"{error:+.1e}" if abs(error) > 1e-13 else "rounding"

    rows = tuple((str(k), *cell(loads["modes"][k]), *cell(loads["legendre"][k])) for k in counts)
    needed: dict[str, Any] = {
        basis: next((k for k in range(1, 33) if _within(ritz, k, basis, reference, 1e-3)), ">32") for basis in loads
    }
    error = facts.load / reference - 1
    eight = "answer" if abs(error) > 1e-14 else "none"
    return [
        heading("truncation"),
        prose("truncation.opening"),
        *chapter.named("Leave the series out"),
        enclosed(facts),
        prose("truncation.table"),
        Table(("$N$", "modes", "error", "polynomials", "error"), rows),
        prose("truncation.no_bounds", order=_order(loads["modes"], reference)),
        Cell(f"for modes in {counts}:\n    print(modes, fb.critical_load(beam, modes).load)", ()),
        exercise(
            "truncation.eight", eight, load=facts.load, beam=reference, error=percent(error),
            side="above" if error > 0 else "below",
        ),
        exercise("truncation.thousandth", **needed),
        exercise("truncation.two", both=_two({basis: found[2] for basis, found in loads.items()}, reference)),
    ]  # fmt: skip


def enclosed(facts: Facts) -> Block:
    """What is proven of the beam itself."""
    if isinstance(facts.exact, str) or facts.exact.load is None:
        return prose("truncation.unknown", why=facts.exact)
    low, high = facts.exact.load
    first = text("truncation.first" if facts.exact.proof.get("first") else "truncation.some")
    return prose("truncation.enclosed", low=low, high=high, first=first)


def _two(loads: dict[str, float | None], reference: float) -> str:
    """The errors at two functions."""
    names = {"modes": "modes", "legendre": "polynomials"}
    return "; ".join(
        f"two {names[basis]} do not show this loss of stability at all"
        if load is None
        else f"{names[basis]} give {n(load, 6)}, {percent(load / reference - 1)} off"
        for basis, load in loads.items()
    ).capitalize()


def _order(loads: dict[int, float | None], reference: float) -> str:
    """What the errors at 16 and 32 modes say of the order, and why."""
    errors = [abs((loads[k] or math.nan) / reference - 1) for k in (8, 16, 32)]
    if not all(1e-12 < e < 1 for e in errors):
        return text("truncation.exact_modes")
    factor = errors[1] / errors[2]
    return text("truncation.order", factor=factor, order=math.log2(factor))


def _within(ritz: Callable[[int, str], float | None], count: int, basis: str, reference: float, share: float) -> bool:
    """Whether the error stays below a share from this number of functions to the next three."""
    loads = [ritz(k, basis) for k in range(count, count + 4)]
    return all(load is not None and abs(load / reference - 1) < share for load in loads)
