"""What the benchmarks share: one claim a group, our way and the peers' ways on the same work, accuracy on all."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest


@pytest.fixture
def contender(benchmark: Any) -> Callable[..., Any]:
    """Time a function as one contender for a claim, and note how far its result is off.

    claim: heading of the group. name: "ours", or the peer's. error: from the result to its error, as text or number.
    bound: the time promised in seconds, for ours. rounds: for work that is too slow to be repeated often.
    """

    def run(
        claim: str,
        name: str,
        function: Callable[[], Any],
        error: Callable[[Any], Any] = lambda _: "",
        bound: float = math.inf,
        rounds: int | None = None,
    ) -> Any:
        benchmark.group = claim
        result = benchmark(function) if rounds is None else benchmark.pedantic(function, rounds=rounds, iterations=1)
        benchmark.extra_info.update(name=name, error=str(error(result)), bound=bound if bound < math.inf else None)
        return result

    return run
