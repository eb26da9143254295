"""A slider's step in the explorer's page at N = 8, in headless Chromium: all work until its plots are drawn.

The peer is the driver's own round trip to the page, which every measurement holds. The promise is a frame at 60 Hz.
"""

from __future__ import annotations

import itertools
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import freebeam as fb
from freebeam.explorer import page as page_of

CLAIM = "a slider's step in the explorer at N = 8"
STEP = "(values) => { freebeam.set(values); return new Promise((done) => queueMicrotask(() => done(0))); }"
RATE = """() => new Promise((done) => setTimeout(() => {
  const gaps = freebeam.frames().slice(-120).map((frame) => frame.gap);
  done((1000 * gaps.length) / gaps.reduce((sum, gap) => sum + gap, 0));
}, 2500))"""


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("no Chromium on the path")
    sync_api = pytest.importorskip("playwright.sync_api")
    file: Path = tmp_path_factory.mktemp("explorer") / "free-free.html"
    file.write_text(page_of(fb.column("free-free")), encoding="utf-8")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(file.as_uri())
        page.wait_for_function("window.freebeam && freebeam.settled() && freebeam.map() && freebeam.map().done")
        yield page
        browser.close()


def bench_round_trip(contender: Any, opened: Any) -> None:
    contender(CLAIM, "peer: the driver's round trip alone", lambda: opened.evaluate("0"), rounds=100)


@pytest.mark.parametrize("key, low, high", [("P", 40.0, 130.0), ("alpha", 1e-4, 1e-2), ("beta", 1e-2, 1.0)])
def bench_step(contender: Any, benchmark: Any, opened: Any, key: str, low: float, high: float) -> None:
    values = itertools.cycle([low * (high / low) ** (k / 50) for k in range(51)])
    step = lambda: opened.evaluate(STEP, {key: next(values)})  # noqa: E731
    for _ in range(60):  # compiled by then
        step()

    contender(CLAIM, f"ours, {key}", step, bound=0.016, rounds=150)
    # The page's own clock: the driver's round trip and its wait for a frame are no part of a step.
    steps = sorted(opened.evaluate("freebeam.steps().slice(-150)"))
    benchmark.extra_info["seconds"] = steps[len(steps) // 2] / 1e3
    benchmark.extra_info["error"] = f"least {steps[0]:.1f} ms, greatest {steps[-1]:.1f} ms"


def bench_animation(contender: Any, opened: Any) -> None:
    """Frames of the animated beam; the time is that of drawing one."""
    draw = (
        "() => { const began = performance.now(); drawBeam(freebeam.view().beam); return performance.now() - began; }"
    )
    contender(
        "a frame of the explorer's beam",
        "ours, drawing and the round trip",
        lambda: opened.evaluate(draw),
        error=lambda _: f"{opened.evaluate(RATE):.0f} frames a second",
        bound=1 / 60,
        rounds=100,
    )
