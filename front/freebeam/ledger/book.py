"""The ledger: equations and claims of the paper, with what is computed and the verdict. Eqs. (1)-(26)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from freebeam.ledger import loads, model, responses
from freebeam.ledger.claims import CONFIRMED, DIGITS, ERRATUM, OPEN, Claim, claims
from freebeam.ledger.finding import CHECKS, Finding
from freebeam.ledger.proven import equations

if TYPE_CHECKING:
    from freebeam.paper.compare import Comparison

__all__ = ["CLAIM_VERDICTS", "ClaimRow", "EquationRow", "Ledger", "ledger"]

CLAIM_VERDICTS = (CONFIRMED, DIGITS, ERRATUM, OPEN)
FAILED = "failed"  # a check that could not be carried through
_CHECKED_BY = (loads, model, responses)  # importing them makes their checks known


@dataclass(frozen=True)
class EquationRow:
    """An equation. printed: the text's own LaTeX. computed: what is derived, and difference: printed minus derived, one
    a statement, as LaTeX. check: what else was shown. repairs: what was read for what, and why."""

    id: str
    section: str
    printed: str
    computed: tuple[str, ...]
    difference: tuple[str, ...]
    check: str
    verdict: str
    passed: bool
    misprint: str
    affects: str
    repairs: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class ClaimRow:
    """A claim. computed: the numbers. by: how it was settled. rule: what maps them to the printed digits."""

    id: str
    section: str
    quote: str
    computed: str
    by: str
    rule: str
    verdict: str
    passed: bool
    note: str


@dataclass(frozen=True)
class Ledger:
    """All rows; `passed` where each has the verdict that the data of the paper expects."""

    equations: tuple[EquationRow, ...]
    claims: tuple[ClaimRow, ...]

    @property
    def passed(self) -> bool:
        return all(row.passed for row in self.equations) and all(row.passed for row in self.claims)


_kept: list[Ledger] = []


def ledger(progress: Callable[[str], None] | None = None) -> Ledger:
    """Compute every row, once in a process. progress: told what is being done."""
    if not _kept:
        say = progress or (lambda _: None)
        rows = tuple(_equation(found) for found in equations(say))
        _kept.append(Ledger(rows, tuple(_claim(claim, say) for claim in claims())))
    return _kept[0]


def _equation(found: Comparison) -> EquationRow:
    p = found.printed
    derived, difference = found.derived_latex, found.difference_latex
    return EquationRow(
        f"({p.number})", p.section, p.latex, derived, difference, found.check, found.verdict, found.passed, p.misprint,
        p.affects, p.repairs,
    )  # fmt: skip


def _claim(claim: Claim, say: Callable[[str], None]) -> ClaimRow:
    if not claim.check:
        return ClaimRow(claim.id, claim.section, claim.text, f"not computed: {claim.note}", "", "", OPEN, True, "")
    say(f"section {claim.section}: {claim.id}")
    try:
        found = CHECKS[claim.check](**claim.given)
        verdict = judged(found)
    except ArithmeticError as error:  # what the prover could not prove
        found, verdict = Finding(False, f"not proven: {error}", ""), FAILED
    passed = verdict == claim.verdict
    return ClaimRow(
        claim.id, claim.section, claim.text, found.computed, found.by, found.rule, verdict, passed, claim.note
    )


def judged(found: Finding) -> str:
    """The verdict of a finding."""
    if not found.holds:
        return ERRATUM
    return DIGITS if found.rule else CONFIRMED
