"""What a verifier does with what it is given: whether it is served, and what it says of forgeries."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from freebeam_derive.certify.verifier_claims import Refused


def served(check: Callable[[], object], *also: type[Exception]) -> bool:
    """Whether a check ends, and does not refuse what it is given. also: what else is a refusal."""
    try:
        check()
    except (Refused, *also):
        return False
    return True


def try_forgeries(case: str, verify: Callable[[Any], object], forged: Iterable[tuple[str, Any]]) -> None:
    """Print what is said of each forgery. Raises SystemExit where one is accepted."""
    for what, data in forged:
        try:
            verify(data)
        except Refused as refusal:
            print(f"  {what}: refused, {refusal}")
        else:
            raise SystemExit(f"{case}: {what} was accepted")
