"""The emitted module of a column on segments against an independent route; to be filled."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType
from typing import Any

from freebeam_derive.kernel import Figure, Progress

MODES = 16
BOUND = 1e-14


def figures(kernel: Any, module: ModuleType, say: Progress) -> Iterator[Figure]:
    """Measured errors of the emitted module."""
    return iter(())
