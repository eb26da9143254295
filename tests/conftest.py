"""A headless Chromium for the tests of pages, and the order of all."""

import gc
import os
import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.sampled import EVERY

CHROMIUM = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    if CHROMIUM is None:
        pytest.skip("no Chromium on the path: install chromium to open a page")
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright opens pages")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


def pytest_configure() -> None:
    """Thousands of derivations in one process keep what they have in common; a fifth of the suite's time was lost."""
    os.environ.setdefault("SYMPY_CACHE_SIZE", "None")  # read when SymPy is loaded
    gc.set_threshold(50_000, 20, 100)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all-cases", action="store_true", help="all cases of the laws in tests/sampled.py")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """What installs, builds and runs whole programs goes first: at the end one process would wait for it alone."""
    items.sort(key=lambda item: item.path.parent != Path(__file__).parent)
    if not config.getoption("--all-cases"):
        cases = Counter[str]()
        kept, left = list[pytest.Item](), list[pytest.Item]()
        for item in items:
            law = item.nodeid.removeprefix("tests/").split("[")[0]
            (left if cases[law] % EVERY.get(law, 1) else kept).append(item)
            cases[law] += 1
        config.hook.pytest_deselected(items=left)
        items[:] = kept
