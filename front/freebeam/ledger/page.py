"""The ledger as a page of Markdown, the same bytes on every machine."""

from __future__ import annotations

from collections import Counter
from importlib.resources import files
from itertools import groupby

from freebeam.ledger.book import CLAIM_VERDICTS, ClaimRow, EquationRow, Ledger
from freebeam.ledger.claims import sections

__all__ = ["page"]


def page(book: Ledger) -> str:
    """The whole page."""
    head = (files("freebeam.ledger") / "page.md").read_text(encoding="utf-8")
    parts = [head, _counts(book), "## Equations\n", _overview(book.equations)]
    parts += [_equation(row) for row in book.equations]
    parts.append("## Claims\n")
    for section, rows in groupby(book.claims, key=lambda row: row.section):
        parts.append(f"### {sections()[section]}\n")
        parts += [_claim(row) for row in rows]
    return "\n".join(parts)


def _counts(book: Ledger) -> str:
    lines = ["| | " + " | ".join(CLAIM_VERDICTS) + " |", "|---|" + "---|" * len(CLAIM_VERDICTS)]
    for name, rows in (("equations", book.equations), ("claims", book.claims)):
        counted = Counter(row.verdict for row in rows)
        lines.append(f"| {name} | " + " | ".join(str(counted[verdict]) for verdict in CLAIM_VERDICTS) + " |")
    return "\n".join(lines) + "\n"


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
