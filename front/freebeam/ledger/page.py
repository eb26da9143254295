"""The ledger as a page of Markdown, the same bytes on every machine."""

from __future__ import annotations

from collections import Counter
from itertools import groupby

from freebeam.ledger.book import ClaimRow, EquationRow, Ledger

__all__ = ["page"]

_HEAD = """# Ledger of the paper

Kavianipour and Sadati, *Effects of damping on the linear stability of a free-free beam subjected to follower and
transversal forces*: every numbered equation, every number and every claim, word for word, with what this program makes
of it. Made by `freebeam validate --output docs/ledger.md --force`; a test holds this page to what is computed. Proofs
of the errata are in [errata.md](errata.md), places in the code in [equations.md](equations.md).

All quantities are nondimensional. N = 8 is the paper's series of eight modes. "Stable" means the elastic spectrum. An
interval [a, b] is proven to hold the number, rounded outwards.

How a claim was settled:

- *identity*: of symbols, or of whole matrices.
- *proven*: in ball arithmetic, at the values named; of a critical load that it is a crossing, the first one, its kind,
  and that the beam is stable below.
- *proven over the range*: in ball arithmetic, for every value of the range, which is covered by cells. Where a critical
  load is followed along a range, its crossing is proven to go on, alone in its place, with the sign of its slope; that
  it is the first crossing is proven at both ends, and, where the row says so, up to a share of the load between them.
- *map*: in floating point, at the points of a dense map; along the lines named it is proven.
- *computed*: in floating point, at the values named.
"""

_SECTIONS = {
    "abstract": "Abstract",
    "1": "Section 1, Introduction",
    "2": "Section 2, Mathematical modeling",
    "3": "Section 3, Ritz method",
    "3.1": "Section 3.1, Admissible functions",
    "3.2": "Section 3.2, Solution",
    "4.1": "Section 4.1, α = 0 and β = 0",
    "4.2": "Section 4.2, α ≠ 0 and β = 0",
    "4.3": "Section 4.3, α = 0 and β ≠ 0",
    "4.4": "Section 4.4, α ≠ 0 and β ≠ 0",
    "4.5": "Section 4.5, Vibration analysis",
    "5": "Section 5, Conclusions",
}


def page(book: Ledger) -> str:
    """The whole page."""
    parts = [_HEAD, _counts(book), "## Equations\n", _overview(book.equations)]
    parts += [_equation(row) for row in book.equations]
    parts.append("## Claims\n")
    for section, rows in groupby(book.claims, key=lambda row: row.section):
        parts.append(f"### {_SECTIONS[section]}\n")
        parts += [_claim(row) for row in rows]
    return "\n".join(parts)


def _counts(book: Ledger) -> str:
    lines = ["| | " + " | ".join(_VERDICTS) + " |", "|---|" + "---|" * len(_VERDICTS)]
    for name, rows in (("equations", book.equations), ("claims", book.claims)):
        counted = Counter(row.verdict for row in rows)
        lines.append(f"| {name} | " + " | ".join(str(counted[verdict]) for verdict in _VERDICTS) + " |")
    return "\n".join(lines) + "\n"


_VERDICTS = ("confirmed", "confirmed to the printed digits", "erratum", "not checkable")


def _overview(rows: tuple[EquationRow, ...]) -> str:
    lines = ["| Eq. | section | verdict | |", "|---|---|---|---|"]
    lines += [f"| {row.id} | {row.section} | {row.verdict} | {row.misprint} |" for row in rows]
    return "\n".join(lines) + "\n"


def _equation(row: EquationRow) -> str:
    lines = [f"### Eq. {row.id}: {row.verdict}", "", "Printed:", "", "```latex", *row.printed.split("\n"), "```", ""]
    for found, meant, why in row.repairs:
        lines += [f"Read with `{found}` as {f'`{meant}`' if meant else 'nothing'}: {why}.", ""]
    lines += ["Derived:", "", *_displayed(row.computed)]
    if row.verdict != "confirmed":
        lines += [
            "Printed minus derived (left sides minus right sides):",
            "",
            *_displayed(tuple(d for d in row.difference if d != "0")),
        ]
    lines += [f"Shown by: {row.check}.", ""]
    if row.misprint:
        lines += [f"Misprint: {row.misprint}.", "", f"What it affects: {row.affects}", ""]
    return "\n".join(lines)


def _displayed(statements: tuple[str, ...]) -> list[str]:
    return [line for statement in statements for line in ("$$", statement, "$$", "")]


def _claim(row: ClaimRow) -> str:
    words = " ".join(row.quote.split())
    computed = row.computed if row.verdict == "not checkable" else f"Computed: {row.computed}"
    settled = f", {row.by}" if row.by else ""
    lines = [f"**{row.id}**: {row.verdict}{settled}", "", f"> {words}", "", f"{computed[0].upper()}{computed[1:]}."]
    if row.rule:
        lines += ["", f"Rule: {row.rule}."]
    if row.note:
        lines += ["", f"Note: {row.note}"]
    return "\n".join(lines) + "\n"
