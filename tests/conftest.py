"""A headless Chromium for the tests of pages, and the order of all."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

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


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What installs, builds and runs whole programs goes first: at the end one process would wait for it alone."""
    items.sort(key=lambda item: item.path.parent != Path(__file__).parent)
