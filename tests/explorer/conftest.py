"""Pages of the explorer in a headless Chromium, one page of each column for all tests."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import freebeam as fb
from freebeam import explorer

SETTLED = "() => window.freebeam && freebeam.settled()"


class Opened:
    """A page in the browser, with what it complained of and what it asked for outside itself."""

    def __init__(self, browser: Any, file: Path, fragment: str = "", **context: Any) -> None:
        self.context = browser.new_context(**{"viewport": {"width": 1280, "height": 800}, **context})
        self.page = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(file.as_uri() + fragment)
        self.settle()

    def visit(self, fragment: str) -> None:
        """Go to another case by its address, everything else at its start."""
        visit = """(to) => {
          scrollTo(0, 0);
          history.replaceState(null, '', to);
          dispatchEvent(new HashChangeEvent('hashchange'));
        }"""
        self.ask(visit, fragment or "#")
        self.settle()

    def settle(self) -> None:
        """Wait for what is asked; a map out of view, seconds of computing once the page has rested, is not begun."""
        self.page.wait_for_function(SETTLED)
        self.ask("clearTimeout(freebeam.view().resting)")

    def ask(self, script: str, argument: Any = None) -> Any:
        return self.page.evaluate(script, argument)

    def type(self, key: str, text: str) -> None:
        """Type into a number box and leave it."""
        box = self.page.locator(f"#box-{key}")
        box.fill(text)
        box.press("Enter")
        box.blur()
        self.settle()

    def text(self, name: str) -> str:
        found: str = self.page.inner_text(f"#{name}")
        return found

    def values(self) -> dict[str, float]:
        found: dict[str, float] = self.ask("freebeam.values()")
        return found


@pytest.fixture(scope="package")
def own_column(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A user's own column, with a full mass matrix that depends on a parameter and one of the two dampings.

    Its kernel is derived here once and not verified, which takes longer and is tested elsewhere.
    """
    from freebeam_derive import verify

    with pytest.MonkeyPatch.context() as changed:
        changed.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        file = str(Path(__file__).with_name("tip_mass.py"))
        with pytest.MonkeyPatch.context() as unverified:
            unverified.setattr(verify, "verify", lambda *_: ())
            fb.column(file, "modes")
        yield file


@pytest.fixture(scope="package")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """The file of a column's page, written once; by name, or by the path of a user's own column."""
    folder = tmp_path_factory.mktemp("explorer")
    known: dict[Any, Path] = {}

    def write(column: str | fb.Column, basis: str | None = None) -> Path:
        key = (column, basis)
        if key not in known:
            known[key] = folder / f"{len(known)}.html"
            known[key].write_text(
                explorer.page(column if isinstance(column, fb.Column) else fb.column(column, basis)), encoding="utf-8"
            )
        return known[key]

    return write


@pytest.fixture(scope="module")
def kept(browser: Any, written: Callable[..., Path]) -> Iterator[Callable[..., Opened]]:
    """One open page of each column and basis, with a desk's screen and the beam at rest."""
    pages: dict[Any, Opened] = {}

    def get(column: str | fb.Column, basis: str | None) -> Opened:
        if (column, basis) not in pages:
            pages[column, basis] = Opened(browser, written(column, basis), reduced_motion="reduce")
        return pages[column, basis]

    yield get
    for page in pages.values():
        page.context.close()


@pytest.fixture
def opened(browser: Any, written: Callable[..., Path], kept: Callable[..., Opened]) -> Iterator[Callable[..., Opened]]:
    """A column's page at the case that an address names: the one kept, or a new one where a screen is asked for.

    At the end nothing must have been complained of, and nothing asked for outside the page.
    """
    pages: list[Opened] = []
    new: list[Opened] = []

    def open_page(
        column: str | fb.Column = "free-free", fragment: str = "", basis: str | None = None, **context: Any
    ) -> Opened:
        if context:
            new.append(Opened(browser, written(column, basis), fragment, **context))
            pages.append(new[-1])
        else:
            pages.append(kept(column, basis))
            pages[-1].visit(fragment)
        return pages[-1]

    yield open_page
    for page in new:
        page.context.close()
    for page in pages:
        assert page.complaints == []
        assert all(url.startswith(("file:", "blob:")) for url in page.requests)
