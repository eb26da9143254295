"""The chapters on eigenvalues, on where two of them meet, and on vanishing damping. Eqs. (24)-(26)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from freebeam.lesson.blocks import Block, Cell, Exercise, Heading, Prose, Table
from freebeam.lesson.facts import MODES, Facts
from freebeam.lesson.phrases import figure, n, percent, steps

if TYPE_CHECKING:
    from freebeam.lesson.stages import Chapter

__all__ = ["coalescence", "divergence", "eigenvalues", "vanishing_damping"]


# --- eigenvalues and the critical load --------------------------------------------------------------------------


def eigenvalues(chapter: Chapter, facts: Facts, paper: bool) -> list[Block]:
    from freebeam import figures

    column, found = facts.column, facts.critical
    blocks: list[Block] = [
        Heading("From matrices to stability", 2, "stability"),
        Prose(
            "Leave the force away and ask which motions the beam has by itself. If one of them grows, the beam is "
            "unstable; the smallest load beyond which one grows is the critical load."
        ),
        *steps(
            chapter,
            "Let all coordinates move alike",
            "Write it as an eigenvalue problem of the first order",
            "Measure eigenvalues in units of the first frequency",
            "Divide by 1 + αλ",
        ),
        *chapter.errata("Section 1", "Section 4.1", "Section 4.3"),
    ]
    own = "".join(f", ${p.latex} = {p.default:g}$" for p in column.parameters)
    if found.load is None:
        top = found.question.load_max
        text = f"With $N = {MODES}$ functions{own} the undamped column stays stable up to $P_0 = {top:g}$."
        blocks.append(Prose(text))
        return blocks
    if facts.flutters:
        text = (
            f"With $N = {MODES}$ functions{own} and without damping, two frequencies meet at $P_0 = "
            f"{found.load:.6g}$, where both are $\\omega = {facts.frequency:.6g}$. That is flutter: past it, one "
            "motion grows while it swings."
        )
    else:
        text = (
            f"With $N = {MODES}$ functions{own} and without damping, the lowest frequency falls to zero at $P_0 = "
            f"{found.load:.6g}$. That is divergence: the beam leaves its straight shape without swinging. No two "
            "frequencies meet before."
        )
    code = f"beam = compiled(column)\nfound = fb.critical_load(beam, modes={MODES})\nprint(found)"
    blocks.append(Cell(code, (Prose(text),)))
    if paper:
        blocks += _printed()
    blocks.append(
        figure(
            "frequencies", "Frequencies along the load", "frequency_load(beam)", lambda: figures.frequency_load(column),
            "Squared frequencies of the undamped column along the load. "
            + ("Where two meet, both leave the real axis." if facts.flutters else "At zero lies divergence."),
        )
    )  # fmt: skip
    return blocks


def _printed() -> list[Block]:
    from freebeam.ledger.scanned import validate

    rows = validate()
    return [
        Prose(
            "The paper raised the load in steps until a real part turned positive, so that it prints the first step "
            "at or above the computed value. The program finds each printed load again, to its last digit:"
        ),
        Table(
            ("section", r"$\alpha$", r"$\beta$", f"computed, $N = {MODES}$", "first step of the scan", "printed"),
            tuple(
                (r.section, f"{r.alpha:g}", f"{r.beta:g}", f"{r.load or 0:.6f}", str(r.explained), r.printed)
                for r in rows
            ),
        ),
    ]  # fmt: skip


# --- coalescence, or divergence -----------------------------------------------------------------------------------


def coalescence(chapter: Chapter, facts: Facts) -> list[Block]:
    from freebeam import figures

    column, load = facts.column, facts.load
    near = [0.9, 0.99, 0.999]
    overlaps = [facts.overlap(load * share) for share in near]
    blocks: list[Block] = [
        Heading("Where two frequencies meet: an exceptional point", 2, "coalescence"),
        Prose(
            "Raise the load. The two lowest of the frequencies that will meet approach each other, slowly, then "
            "faster and faster, and at the meeting the curve stands upright. It is no crossing: not only the "
            "frequencies become one, the two shapes do too, so that at that load a mode is missing. Physicists call "
            "it an exceptional point."
        ),
        *steps(chapter, "Look at the place where two frequencies meet", "Look at the shapes there"),
        Prose(
            "The square root has a practical side: near the meeting everything is infinitely sensitive. At 90, 99 "
            f"and 99.9 % of the load the cosine of the angle between the two shapes is {n(overlaps[0], 4)}, "
            f"{n(overlaps[1], 4)} and {n(overlaps[2], 4)}."
        ),
        figure(
            "meeting", "The meeting", "coalescence(beam)", lambda: figures.coalescence(column),
            "The two eigenvalues near the load where they meet, less their common value there; dotted, the square "
            "root.",
        ),
        figure(
            "shape", "The motion", "mode_shape(beam)", lambda: figures.mode_shape(column),
            "The motion at the critical load, over half a period.",
        ),
        *_gap_exercises(facts),
    ]  # fmt: skip
    return blocks


def _gap_exercises(facts: Facts) -> list[Block]:
    load = facts.load
    shares = (1e-2, 1e-4)
    gaps = [abs(np.sqrt(a) - np.sqrt(b)) for a, b in (facts.pair(load * (1 - s)) for s in shares)]
    power = math.log(gaps[0] / gaps[1]) / math.log(shares[0] / shares[1])
    growth = facts.growth(1.01 * load)
    doubling = math.log(2) / growth if growth > 0 else math.inf
    period = 2 * math.pi / facts.frequency
    return [
        Exercise(
            "How far apart are the two frequencies at 1 % and at 0.01 % below the critical load? Which power of the "
            "distance do they follow?",
            f"{n(gaps[0])} and {n(gaps[1])}: a hundred times closer, the gap is {n(gaps[0] / gaps[1], 3)} times "
            f"smaller. The power is {n(power, 4)}, which tends to one half: the square root.",
        ),
        Exercise(
            "The load is 1 % too large. How long does it take until the motion is twice as large, in periods?",
            f"The growth rate is {n(growth)}, the doubling time $\\ln 2$ over that, {n(doubling)}, which is "
            f"{n(doubling / period, 3)} periods. One per cent too much, and there is hardly time to notice.",
        ),
        Exercise(
            "Why does the perturbation theory of symmetric matrices, where a change of $\\varepsilon$ moves an "
            "eigenvalue by $\\varepsilon$, not hold here? Compute $|u^{\\mathsf{T}} M v|$, with $u$ and $v$ of "
            "length 1 in the mass, at 99 % and at 99.99 % of the load.",
            f"{n(_condition(facts, 0.99), 4)} and {n(_condition(facts, 0.9999), 4)}: the rate of change of $s$ is "
            "something divided by this number, which goes to zero at the meeting. For a symmetric $K$ the two "
            "vectors are the same and it is always 1.",
        ),
    ]


def _condition(facts: Facts, share: float) -> float:
    p = facts.pencil
    A = np.diag(p.e) + share * facts.load * p.H
    values, V = np.linalg.eig(A)
    k = int(np.abs(values - facts.frequency**2).argmin())
    left = np.linalg.inv(V)[k]
    return float(1 / np.linalg.norm(left) / np.linalg.norm(V[:, k]))


def divergence(chapter: Chapter, facts: Facts) -> list[Block]:
    load = facts.load
    symmetric = facts.circulatory < 1e-12
    s = [float(facts.squares(load * share)[0].real) for share in (0.5, 0.9)]
    reason = (
        "The load has a potential, so $K$ is symmetric and every $\\omega^{2}$ is real. A squared frequency can leave "
        "the positive numbers only through zero: there is no coalescence that would turn into flutter, no exceptional "
        "point."
        if symmetric
        else "The load is not conservative here, and two frequencies could meet; but one reaches zero first."
    )
    rate = math.sqrt(max(-float(facts.squares(1.01 * load)[0].real), 0.0))
    blocks: list[Block] = [
        Heading("Why no two frequencies meet", 2, "coalescence"),
        Prose(reason),
        Prose("A load that follows the beam could make two frequencies meet, and this is what it would look like:"),
        *steps(chapter, "Look at the place where two frequencies meet"),
        Prose("At divergence the load is that of an eigenvalue problem of statics: $\\det(E + P_0 H) = 0$."),
        Exercise(
            "What is $\\omega^{2}$ at 50 % and at 90 % of the critical load, in units of its value without load? "
            "Which simple curve is it?",
            f"{n(s[0] / float(facts.squares(0.0)[0].real), 4)} and {n(s[1] / float(facts.squares(0.0)[0].real), 4)}: "
            + ("a straight line falls to 0.5 and 0.1." if symmetric else "compare the straight line's 0.5 and 0.1."),
        ),
        Exercise(
            "The load is 1 % too large. How fast does the deflection grow?",
            f"As $\\mathrm{{e}}^{{rt}}$ with $r$ = {n(rate, 4)}, without swinging.",
        ),
    ]
    return blocks


# --- vanishing damping ------------------------------------------------------------------------------------------------


def vanishing_damping(chapter: Chapter, facts: Facts) -> list[Block]:
    from freebeam import figures

    column = facts.column
    blocks: list[Block] = [Heading("A little damping, a large drop", 2, "damping")]
    if "alpha" not in column.damping:
        blocks.append(
            Prose(
                "This column states no internal damping, so the question does not arise for it. Add `alpha * "
                "y.diff(x, 2, t) * delta(y.diff(x, 2))` to its virtual work and it will."
            )
        )
        return blocks
    blocks += [
        Prose(
            "Damping takes energy from every motion, so it should help. Internal damping does not: the smallest "
            "amount of it lowers the flutter load at once, by a share that does not depend on how small it is. The "
            "reason fits on a page. Follow a branch $\\omega^{2} = s(P_0)$ of the undamped column and damp it a "
            "little."
            if facts.flutters
            else "A damped column can lose its stability at another load than the undamped one, and for follower "
            "forces it does. The rule that says when fits on a page; here it will say that nothing changes."
        ),
        *steps(chapter, "Damp it a little", "Let the damping vanish"),
    ]
    zero = facts.limit(0.0)
    if not facts.flutters or zero.load is None or not zero.frequency:
        blocks.append(
            Prose(
                "No branch of this column becomes that steep before its critical load, and the limit of vanishing "
                f"damping is {n(zero.load or math.nan, 6)}, by {zero.kind}: the undamped load. At divergence nothing "
                "moves, and damping has nothing to act on."
            )
        )
        blocks += [
            Exercise(
                "What is the critical load with $\\alpha = 0.01$?",
                f"{n(facts.damped(0.01, 0.0).load or math.nan, 6)}, by {facts.damped(0.01, 0.0).kind}; without "
                f"damping {n(facts.load, 6)}.",
            ),
            Exercise(
                "Compute $P_0 s' - s$ for the lowest branch at half the critical load. Which sign has the growth rate?",
                f"{n(_tangent_left(facts, 0.5 * facts.load), 4)}: negative, so internal damping damps.",
            ),
        ]
        return blocks
    drop = 1 - zero.load / facts.load
    blocks += [
        Prose(
            "With internal damping alone, $\\kappa = 0$, the rule reads: the logarithmic slope is one. That is where a "
            "straight line from the origin touches the curve $\\omega^{2}(P_0)$. Before that point the branch is so "
            "flat that "
            f"internal damping damps it; beyond it the branch is so steep that the damping feeds it. Here the line "
            f"touches at "
            f"$P_0 = {zero.load:.6g}$, $\\omega = {zero.frequency:.6g}$, which is {percent(drop)} below the meeting at "
            f"{n(facts.load, 6)}. The curve need not know that the two frequencies will meet: at the tangent point "
            f"they are "
            "still far apart."
        ),
        figure(
            "tangent", "The tangent construction", "tangent(beam)", lambda: figures.tangent(column),
            "The curve of squared frequencies, and the line from the origin that touches it. Vanishing internal "
            "damping moves the critical load from the meeting to the tangent point.",
        ),
    ]  # fmt: skip
    if "beta" in column.damping:
        ratio = facts.squares(0.0)[0].real
        half = facts.limit(float(ratio))
        blocks += [
            Prose(
                "External damping of the ratio $\\kappa = \\beta / \\alpha$ moves the line's foot from the origin "
                "down to $-\\kappa$, so the tangent point moves up the curve, towards the meeting. A limit of "
                "vanishing damping has no value until one says at which ratio it is taken."
            ),
            Exercise(
                f"Take $\\beta / \\alpha = {float(ratio):.5g}$, which damps the first mode as much from outside as "
                "from inside. Where is the limit now?",
                f"At {n(half.load or math.nan, 6)}, {percent(1 - (half.load or math.nan) / facts.load)} below the "
                "meeting.",
            ),
        ]
    one = facts.damped(1e-3, 0.0)
    strong = facts.damped(0.05, 0.0)
    blocks += [
        Exercise(
            "How good is the limit for a damping that is small and not vanishing, $\\alpha = 10^{-3}$?",
            f"The critical load is {n(one.load or math.nan, 7)}, the limit {n(zero.load, 7)}: they differ by "
            f"{percent((one.load or math.nan) / zero.load - 1)}.",
        ),
        Exercise(
            "Does internal damping ever help? Compute the critical load at $\\alpha = 0.05$.",
            f"{n(strong.load or math.nan, 6)}, by {strong.kind}: "
            + (
                "above the undamped load. Much of it helps; little of it harms."
                if strong.load and strong.load > facts.load
                else "above the limit of vanishing damping, below the undamped load."
                if strong.load and strong.load > zero.load
                else "below the limit of vanishing damping."
                if strong.load
                else f"none is found up to {strong.question.load_max:g}."
            ),
        ),
    ]
    return blocks


def _tangent_left(facts: Facts, load: float) -> float:
    """P s′ − s of the lowest branch."""
    step = 1e-4 * load
    s = [float(facts.squares(load + side * step)[0].real) for side in (-1, 0, 1)]
    return load * (s[2] - s[0]) / (2 * step) - s[1]
