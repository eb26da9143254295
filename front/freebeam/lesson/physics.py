"""The chapters after the derivation: what the matrices say of flutter, computed and drawn for the column at hand."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from freebeam.lesson.blocks import Block, Cell, Exercise, Heading, Prose, Table
from freebeam.lesson.eigenvalues import coalescence, divergence, eigenvalues, vanishing_damping
from freebeam.lesson.facts import MODES, Facts
from freebeam.lesson.phrases import figure, n, percent, steps

if TYPE_CHECKING:
    from collections.abc import Callable

    from freebeam.lesson.stages import Chapter

__all__ = ["physics_chapters"]


def physics_chapters(chapter: Chapter, facts: Facts, paper: bool) -> tuple[Block, ...]:
    """From the eigenvalue problem to the cost of the series. Eqs. (24)-(26)."""
    if facts.critical.load is None:
        return (*eigenvalues(chapter, facts, paper), *rigid(chapter, facts))
    return (
        *eigenvalues(chapter, facts, paper),
        *(coalescence(chapter, facts) if facts.flutters else divergence(chapter, facts)),
        *vanishing_damping(chapter, facts),
        *work(chapter, facts),
        *rigid(chapter, facts),
        *truncation(chapter, facts),
    )


# --- work ---------------------------------------------------------------------------------------------------


def work(chapter: Chapter, facts: Facts) -> list[Block]:
    from freebeam import figures
    from freebeam.figures import curves

    column = facts.column
    blocks: list[Block] = [
        Heading("Where the energy comes from", 2, "work"),
        Prose(
            "A growing motion needs energy, and only the load can supply it. A dead load cannot: what it gives on the "
            "way out it takes back on the way home. A force that follows the beam can, if the beam moves in the right "
            "way. Add up its work over one period."
        ),
        *steps(chapter, "Add up the work over one cycle", "Keep what does not cancel"),
    ]
    if facts.circulatory < 1e-12:
        blocks += [
            Prose(
                "For this column the difference is zero: its load has a potential and does no work over a cycle, so "
                "it can never make the beam flutter. What it can do is to take the stiffness away: divergence."
            ),
            Exercise(
                "Which share of the largest entry of $H$ is the largest entry of $H - H^{\\mathsf{T}}$?",
                f"{n(facts.circulatory, 2)}: rounding, if anything."
                if facts.circulatory
                else "None of it: exactly zero.",
            ),
            Exercise(
                "A friend claims to have seen this column flutter. What else must have been at work?",
                "Something without a potential: a force that follows the beam, a flow, friction. The largest growth "
                f"rate of a swinging motion at twice the critical load is {n(_swinging(facts, 2 * facts.load), 2)}.",
            ),
        ]
        return blocks
    alpha, beta = (1e-3 if "alpha" in column.damping else 0.0), (0.1 if "beta" in column.damping else 0.0)
    if not facts.flutters:
        blocks.append(Prose("The load could do work over a cycle; but the beam diverges before it does so."))
        return blocks
    if alpha or beta:
        loads = (0.9, 1.0, 1.1)
        critical = facts.damped(alpha, beta).load or facts.load
        cycles = [curves.cycle(column, share * critical, modes=MODES, alpha=alpha, beta=beta) for share in loads]
        rows = tuple(
            (
                f"{share * critical:.5g}",
                f"{float(c.work[-1]):.4g}",
                f"{float(c.dissipated[-1]):.4g}",
                f"{_rounded(c.eigenvalue):.3g}",
            )
            for share, c in zip(loads, cycles, strict=True)
        )
        named = " and ".join(f"$\\{s} = {v:g}$" for s, v in (("alpha", alpha), ("beta", beta)) if v)
        blocks += [
            Prose(
                "The mode must be *travelling*: if all points pass through zero together, $a$ and $b$ are parallel "
                "and the work is nothing, whatever the load. Undamped, the beam has only such standing motions "
                "before the two frequencies meet, and after it the work feeds growth alone. Damping puts a phase "
                "between slope and deflection, and the force begins to work. At the critical load its work and the "
                f"damping's balance. With {named}, one period of the least stable motion at 90, 100 and 110 % of the "
                "critical load:"
            ),
            Table(("$P_0$", "given by the load", "taken by damping", "growth rate"), rows),
            figure(
                "work", "The balance of one period", f"work(beam, alpha={alpha:g}, beta={beta:g})",
                lambda: figures.work(column, alpha=alpha, beta=beta),
                "Energy given by the load and taken by damping through one period at the critical load.",
            ),
        ]  # fmt: skip
        if curves.follower_share(column):
            blocks.append(
                figure(
                    "loop", "The force against the end's deflection", f"work_loop(beam, alpha={alpha:g}, "
                    f"beta={beta:g})",
                    lambda: figures.work_loop(column, alpha=alpha, beta=beta),
                    "The follower force's transversal part against the deflection of its end: the loop's area is the "
                    "work.",
                )
            )  # fmt: skip
    past = curves.cycle(column, 1.02 * facts.load, modes=MODES)
    blocks += [
        Exercise(
            "Without damping, 2 % beyond the meeting: what does the load give in one period, and what becomes of it?",
            f"In shares of the mean energy it gives {n(float(past.work[-1]), 4)}. Nothing takes it, so it is what "
            f"the motion's energy grows by; the growth rate is {n(past.eigenvalue.real, 4)}.",
        ),
        Exercise(
            "Which share of $H$ is not symmetric? Compare the largest entries of $H - H^{\\mathsf{T}}$ and of $H$, "
            "in the basis where $M$ is the identity.",
            f"{n(facts.circulatory, 3)}. It is this part, and no other, that can make the beam flutter.",
        ),
    ]
    if alpha or beta:
        flipped = facts.column.system(MODES, 0.5 * facts.load, alpha, beta)
        c = curves.cycle(column, 0.5 * facts.load, modes=MODES, alpha=alpha, beta=beta)
        blocks.append(
            Exercise(
                "At half the undamped flutter load, does the force give energy to the least stable motion, or take "
                "some?",
                f"It {'gives' if c.work[-1] > 0 else 'takes'} {n(abs(float(c.work[-1])), 3)} in a period, and "
                f"damping takes {n(float(c.dissipated[-1]), 3)}; the motion decays at the rate "
                f"{n(c.eigenvalue.real, 3)} (load {n(flipped.load)}).",
            )
        )
    return blocks


def _rounded(eigenvalue: complex) -> float:
    """The real part, or zero where it is rounding."""
    return eigenvalue.real if abs(eigenvalue.real) > 1e-9 * abs(eigenvalue) else 0.0


def _swinging(facts: Facts, load: float) -> float:
    s = facts.squares(load)
    values = np.append(np.sqrt(-s), -np.sqrt(-s))
    swinging = values[np.abs(values.imag) > 1e-6 * np.abs(values).max()]
    return abs(float(max(swinging.real.max(initial=0.0), 0.0)))


# --- rigid functions ----------------------------------------------------------------------------------------


def rigid(chapter: Chapter, facts: Facts) -> list[Block]:
    column = facts.column
    count = column.rigid_count
    blocks: list[Block] = [Heading("Why the rigid modes stay out", 2, "rigid")]
    if not count:
        blocks += [
            Prose(
                f"Ends that are {column.ends[0]} and {column.ends[1]} let the beam do nothing as a rigid body, so "
                "there is nothing to leave out: every motion bends it, and the elastic spectrum is the whole one."
            ),
            Exercise(
                "How many zero eigenvalues has $E$, and what is the smallest one?",
                f"None; the smallest squared frequency is {n(float(facts.pencil.e[0]), 6)}.",
            ),
            Exercise(
                "Which pairs of ends among free, pinned, sliding and clamped leave a rigid motion?",
                _rigid_pairs(),
            ),
        ]
        return blocks
    M, _, H = column.matrices(MODES, True)
    coupling = float(np.abs(H[count:, :count]).max() / np.abs(H).max())
    back = float(np.abs(H[:count, count:]).max() / np.abs(H).max())
    load = 0.8 * facts.load if facts.critical.load else 10.0
    free = column.system(MODES, load, rigid=True)
    bare = column.system(MODES, load)
    difference = _spectra_apart(free.M, free.K, bare.M, bare.K)
    blocks += [
        Prose(
            "A beam with such ends can also move without bending. The paper leaves these motions out, “as they are "
            "not involved in the instability”. Is that an assumption? Put them in and see."
        ),
        *steps(chapter, "Put the rigid functions in front"),
    ]
    tumbles = np.abs(H[:count, :count]).max() > 1e-12
    blocks.append(
        Prose(
            "It is a theorem. The first line says that a rigid motion, however large, exerts no generalised force on "
            "an elastic one. With the rigid functions in front every matrix is block triangular, external damping "
            "included, so the eigenvalues are those of the two blocks, and the elastic ones are what they were. The "
            "reverse does not hold: elastic motion drives the rigid one, which a sensor on the beam feels. "
            + (
                "And the rigid block is not zero: a beam that has turned is pushed aside, and nothing turns it back. "
                "The free beam tumbles at any load. "
                if tumbles
                else ""
            )
            + "*Stable*, in this lesson, means the elastic spectrum. (A statement for which this fails is refused.)"
        )
    )
    blocks += [
        Exercise(
            f"Compare the elastic eigenvalues with and without the rigid functions at $P_0 = {load:.5g}$.",
            f"The largest relative difference of $\\omega^{{2}}$ is {n(difference, 2)}"
            + (": rounding." if difference < 1e-6 else "."),
        ),
        Exercise(
            "How large is what the rigid motion does to the elastic rows of $H$, and how large is the reverse, "
            "relative to the largest entry?",
            f"{n(coupling, 2) if coupling else 'Zero'} and {n(back, 3)}: the coupling goes one way.",
        ),
    ]
    block = np.linalg.solve(M[:count, :count], H[:count, :count])
    if count == 2 and abs(block[0, 1]) > 1e-12 and not np.abs(block - np.triu(block, 1)).max() > 1e-12:
        blocks.append(
            Exercise(
                "The undamped beam is turning at a constant rate $\\Omega_{0}$ as the load $P_0$ is switched on. How "
                "does its middle move sideways?",
                "The rotation stays what it is, $\\Omega_{0} t$, and the translation obeys $\\ddot{q}_{1} = "
                f"{-block[0, 1]:.4g}\\, P_0\\, \\Omega_{{0}} t$: it drifts as $t^{{3}}$, with the factor "
                f"{n(-block[0, 1] / 6, 4)} $P_0 \\Omega_{{0}}$. The zero eigenvalue is defective.",
            )
        )
    return blocks


def _spectra_apart(M: object, K: object, m: object, k: object) -> float:
    whole = np.linalg.eigvals(np.linalg.solve(M, K))  # type: ignore[call-overload]
    elastic = np.linalg.eigvals(np.linalg.solve(m, k))  # type: ignore[call-overload]
    return float(max(np.abs(whole - s).min() / abs(s) for s in elastic))


def _rigid_pairs() -> str:
    from freebeam_derive.comparison import rigid_functions
    from freebeam_derive.statement import GEOMETRIC

    kinds = tuple(GEOMETRIC)
    pairs = [(a, b) for i, a in enumerate(kinds) for b in kinds[i:]]
    found = [f"{a}-{b} ({len(rigid)})" for a, b in pairs if (rigid := rigid_functions((a, b)))]
    return "With the number of rigid functions: " + ", ".join(found) + "; the others none."


# --- truncation ---------------------------------------------------------------------------------------------


def truncation(chapter: Chapter, facts: Facts) -> list[Block]:
    counts = (2, 4, 8, 16, 32)
    exact = facts.beam_load
    ritz = cache(facts.ritz)
    modes_of = {k: ritz(k, "modes") for k in counts}
    polynomials = {k: ritz(k, "legendre") for k in counts}
    reference = exact if exact is not None else polynomials[16] or facts.load

    def cell(load: float | None) -> tuple[str, str]:
        if load is None:
            return "none of this kind", "—"
        error = load / reference - 1
        return f"{load:.9g}", f"{error:+.1e}" if abs(error) > 1e-13 else "rounding"

    rows = tuple((str(k), *cell(modes_of[k]), *cell(polynomials[k])) for k in counts)
    blocks: list[Block] = [
        Heading("What the series costs", 2, "truncation"),
        Prose(
            "Eight functions stand for infinitely many. How far is the answer from that of the beam itself? The "
            "loaded beam's own equation is needed, without a series in modes:"
        ),
        *steps(chapter, "Leave the series out"),
    ]
    if not isinstance(facts.exact, str) and facts.exact.load is not None:
        low, high = facts.exact.load
        first = facts.exact.proof.get("first")
        blocks.append(
            Prose(
                "Its power series, computed with bounds for what is left out, encloses the critical load of the beam "
                f"between ${low}$ and ${high}$: a proof, in interval arithmetic, that there is such a load in between"
                + (
                    ", and that it is the first one."
                    if first
                    else "; that it is the first of all is not part of the proof."
                )
            )
        )
    else:
        blocks.append(
            Prose(
                f"For this column no enclosure is found ({facts.exact}); the polynomials at $N = 16$ serve as the "
                "reference."
            )
        )
    blocks += [
        Prose("The Ritz values beside it, over modes and over polynomials, with their relative errors:"),
        Table(("$N$", "modes", "error", "polynomials", "error"), rows),
        Prose(
            "The values of such a series are no bounds. For a load with a potential they approach from above, always; "
            "for "
            "a follower load they may come from either side. " + _order(modes_of, reference)
        ),
    ]
    needed = {
        basis: next((k for k in range(1, 33) if _within(ritz, k, basis, reference, 1e-3)), None)
        for basis in ("modes", "legendre")
    }
    blocks += [
        Exercise(
            "What is the error at $N = 8$, in per cent, and is the Ritz value above or below the beam's?",
            f"{n(facts.load, 8)} against {n(reference, 8)}: {percent(facts.load / reference - 1)} "
            f"{'above' if facts.load > reference else 'below'}."
            if facts.load != reference and abs(facts.load / reference - 1) > 1e-14
            else "None that a float can show: the modes of this column are those of the loaded beam.",
        ),
        Exercise(
            "From how many functions on is the error below a thousandth, for modes and for polynomials?",
            f"For modes from $N = {needed['modes'] or '>32'}$ on, for polynomials from $N = "
            f"{needed['legendre'] or '>32'}$ on.",
        ),
        Exercise(
            "At $N = 2$ the critical load can be found by hand. How wrong is it?",
            "; ".join(
                f"{name} give {n(load, 6)}, {percent(load / reference - 1)} off"
                if load is not None
                else f"two {name} do not show this loss of stability at all"
                for name, load in (("modes", modes_of[2]), ("polynomials", polynomials[2]))
            ).capitalize()
            + ".",
        ),
    ]
    code = f"for modes in {counts}:\n    print(modes, fb.critical_load(beam, modes).load)"
    blocks.insert(len(blocks) - 3, Cell(code, ()))
    return blocks


def _order(loads: dict[int, float | None], reference: float) -> str:
    """What the errors at 16 and 32 modes say of the order, and why."""
    errors = [abs((loads[k] or math.nan) / reference - 1) for k in (8, 16, 32)]
    if not all(1e-12 < e < 1 for e in errors):
        return "Here the modes leave no error that a float can show: they are shapes of the loaded beam too."
    order = math.log2(errors[1] / errors[2])
    return (
        f"From 16 to 32 modes the error falls by a factor of {n(errors[1] / errors[2], 3)}, as $N^{{-{order:.2g}}}$ "
        "would. The polynomials converge faster than any power. The modes are held back by their own equation, in "
        "which the "
        r"fourth derivative is $\gamma^{4}$ times the mode: whichever derivative of a mode vanishes at an end, the "
        r"one four "
        "orders higher does too, and that of the loaded beam does not."
    )


def _within(ritz: Callable[[int, str], float | None], count: int, basis: str, reference: float, share: float) -> bool:
    """Whether the error stays below a share from this number of functions to the next three."""
    loads = [ritz(k, basis) for k in range(count, count + 4)]
    return all(load is not None and abs(load / reference - 1) < share for load in loads)
