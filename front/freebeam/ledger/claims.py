"""The claims of the paper, from claims.toml, each with the check that settles it."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files
from typing import Any

__all__ = ["CONFIRMED", "DIGITS", "ERRATUM", "OPEN", "Claim", "claims", "sections"]

CONFIRMED, DIGITS = "confirmed", "confirmed to the printed digits"
ERRATUM, OPEN = "erratum", "not checkable"


@dataclass(frozen=True)
class Claim:
    """A claim: its words, the check and what it is expected to find; a note for the reader. Without a check the note
    says why there is none. Raises ValueError for an entry that is incomplete."""

    id: str
    text: str
    check: str = ""
    given: Mapping[str, Any] = field(default_factory=dict)
    verdict: str = CONFIRMED
    note: str = ""

    def __post_init__(self) -> None:
        allowed = (CONFIRMED, DIGITS, ERRATUM) if self.check else (OPEN,)
        if self.verdict not in allowed:
            raise ValueError(f"claim {self.id}: verdict = {self.verdict!r} must be one of {', '.join(allowed)}")
        if self.verdict in (ERRATUM, OPEN) and not self.note:
            raise ValueError(f"claim {self.id}: an erratum, and what cannot be checked, need a note that says why")

    @property
    def section(self) -> str:
        """Where the paper says it: what the id begins with, such as "4.1" or "abstract"."""
        return self.id.partition("-")[0]


@lru_cache(maxsize=1)
def _data() -> Mapping[str, Any]:
    return tomllib.loads((files("freebeam.ledger") / "claims.toml").read_text(encoding="utf-8"))


def sections() -> Mapping[str, str]:
    """The headings of the paper's sections."""
    return dict(_data()["sections"])


@lru_cache(maxsize=1)
def claims() -> tuple[Claim, ...]:
    """All claims, in the order of the paper."""
    found = []
    for entry in _data()["claim"]:
        given = {name: value for name, value in entry.items() if name != "unchecked"}
        if "unchecked" in entry:
            why = entry["unchecked"]
            given |= {"verdict": OPEN, "note": _data()["reasons"].get(why, why)}
        found.append(Claim(**given))
    return tuple(found)
