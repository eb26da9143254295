"""The chapter on the proof that the load is the first at which the beam itself loses stability."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from freebeam.lesson.blocks import Block, Table
from freebeam.lesson.phrases import arguments, exercise, figure, heading, n, prose, summary, text

if TYPE_CHECKING:
    from freebeam.lesson.facts import Facts

__all__ = ["theorem"]

MODES = 40
"""Of the comparison beam in balls, as the table of docs/theorem.md has them."""
MORE = 3
"""Lines of the table beyond the first that is free."""


def theorem(facts: Facts) -> list[Block]:
    """Statement, proof and numbers, where the first loss of the beam itself is proven in its modes; else nothing."""
    from freebeam_derive.certify.decimals import outward

    exact = facts.exact
    if isinstance(exact, str) or exact.load is None or exact.evidence is None:
        return []
    m, P, reach = int(exact.evidence["lowest"]), float(exact.load[0]), Fraction(exact.evidence["reach"])
    rows = _lines(facts, max(1, m - 1), m + MORE)
    if not rows:
        return []

    def draw() -> Any:
        from freebeam import figures

        own: dict[str, Any] = {name: f"{value:g}" for name, value in facts.own.items()}
        return figures.strips(facts.column, **own)

    call = f"strips(beam{arguments(facts.own)})"
    return [
        heading("theorem"),
        prose("theorem.opening"),
        prose("theorem.statement", low=exact.load[0], high=exact.load[1], kind=exact.kind),
        prose("theorem.modes"),
        prose("theorem.line"),
        prose("theorem.count"),
        Table(
            ("line", "$R_k$", r"$P \lVert D^{-1/2} B D^{-1/2} \rVert$", "free"),
            tuple((f"$R_{{{k}}}$", n(R, 6), norm, "yes" if free else "not known") for k, R, norm, free in rows),
        ),
        prose("theorem.here", m=m, load=P, reach=outward(reach, reach, 7)[0]),
        figure("strips", "Eigenvalues, lines and discs", call, draw, text("theorem.drawn", m=m)),
        prose("theorem.low", m=m, stretches=int(exact.evidence["stretches"])),
        exercise("theorem.norm"),
        summary("theorem.summary"),
    ]


def _lines(facts: Facts, low: int, high: int) -> list[tuple[int, float, str, bool]]:
    """k, R_k, the bound of P‖D^(−1/2) B D^(−1/2)‖ rounded up, whether it is below one; of some lines.

    None where energy holds more than bending.
    """
    from freebeam_derive.certify.balls import ends, exact, precision
    from freebeam_derive.certify.decimals import outward
    from freebeam_derive.certify.strips import Strips

    own = {name: Fraction(f"{value:g}") for name, value in facts.own.items()}
    assert not isinstance(facts.exact, str) and facts.exact.load is not None
    P = exact(Fraction(facts.exact.load[1]))
    with precision(128):
        strips = Strips(facts.column.kernel, own, MODES)
        if not strips.T.nothing:
            return []
        norms = {k: P * strips.B.norm(strips.line(k)) for k in range(low, high + 1)}
        return [(k, float(strips.line(k)), outward(*ends(v), 4)[1], bool(v < 1)) for k, v in norms.items()]
