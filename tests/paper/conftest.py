"""The ledger, computed once for all tests of the paper."""

from __future__ import annotations

import pytest

from freebeam.ledger.book import Ledger, ledger


@pytest.fixture(scope="session")
def book() -> Ledger:
    return ledger()
