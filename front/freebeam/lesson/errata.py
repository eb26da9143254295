"""The paper's misprints, from docs/errata.md: which equations each is about, and what it says."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

__all__ = ["Entry", "entries"]


@dataclass(frozen=True)
class Entry:
    """One erratum. places: "Eq. (11)", "Section 4.1" or "Abstract"."""

    title: str
    places: tuple[str, ...]
    paragraphs: tuple[str, ...]


@lru_cache(maxsize=1)
def entries() -> tuple[Entry, ...]:
    """All errata, in the order of the file."""
    found = []
    for part in re.split(r"^## ", _text(), flags=re.MULTILINE)[1:]:
        title, _, body = part.partition("\n")
        where = title.partition(":")[0]
        numbers = re.findall(r"\((\d+)\)", where)
        places = [f"Eq. ({n})" for n in numbers] or re.findall(r"Abstract|Section \d(?:\.\d)?", where)
        paragraphs = tuple(" ".join(p.split()) for p in re.split(r"\n\s*\n", body.strip()) if p.strip())
        found.append(Entry(title.strip(), tuple(places), paragraphs))
    return tuple(found)


def _text() -> str:
    """The file lies in docs; the package has a link to it, which an installed package holds as a copy."""
    path = Path(__file__).with_name("errata.md")
    text = path.read_text(encoding="utf-8")
    if "\n" not in text.strip():  # a checkout without symbolic links has the link's target as text
        text = (path.parent / text.strip()).read_text(encoding="utf-8")
    return text
