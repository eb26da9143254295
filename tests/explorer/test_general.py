"""Pages of columns with segments, several fields and coordinates, as a site has them, against the runtime."""

import random
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import freebeam as fb
from freebeam import explorer
from freebeam.explorer.content import COORDINATES, content
from freebeam_sym.checks import InputError
from tests.explorer.conftest import Opened
from tests.stated import file_of

# what has no mass: between two springs, where three of four states are decided, and an integrating controller
MASSLESS = {
    "relaxation": {
        "V": "V + k * (at(y, 1) - q) ** 2 / 2 + 3 * p ** 2 / 2",
        "dW_nc": "follower + external + F_0 * at(delta(y), x_F) - c * (q.diff(t) - p.diff(t)) * delta(q - p)",
        "parameters": "(own(k, 5.0), own(c, 0.5))",
    },
    "integral": {
        "dW_nc": "follower + external + F_0 * at(delta(y), x_F)"
        " - g * q * at(delta(y), 1) - (q.diff(t) - at(y, half)) * delta(q)",
        "parameters": "(own(g, 0.5),)",
    },
}
# segments with masses and joints, two fields, a coordinate beside the beam, two alone, control, a flow, free in space
NAMES = ("pflueger", "absorber", "step", "crack", "timoshenko", "follower-inside", "tip-damper", "feedback", "beal",
         "free-free-mass", "pipe", "ziegler", *MASSLESS)  # fmt: skip


@pytest.fixture(scope="module")
def columns(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Any]]:
    """The columns by their names, not verified, which takes longer and is tested elsewhere."""
    from freebeam_derive import pipeline, verify

    derived: dict[str, Any] = {}
    general = pipeline.general

    def once(column: Any) -> Any:  # for the kernel in NumPy and for that in JavaScript
        if column.name not in derived:
            derived[column.name] = general(column)
        return derived[column.name]

    with pytest.MonkeyPatch.context() as changed:
        changed.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        changed.setattr(verify, "verify", lambda *_: ())
        changed.setattr(pipeline, "general", once)
        targets: dict[str, Any] = {name: name for name in NAMES}
        for name, changes in MASSLESS.items():
            targets[name] = file_of(tmp_path_factory.mktemp(name), name, {"name": repr(name), **changes})
        yield {name: fb.column(target) for name, target in targets.items()}


@pytest.fixture(scope="module")
def made(columns: dict[str, Any]) -> dict[str, str]:
    """The site of all of them."""
    return explorer.site(columns.values())


@pytest.fixture(scope="module")
def visited(browser: Any, made: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """The page of a column in the site; nothing is complained of and nothing asked for outside its folder."""
    folder = tmp_path_factory.mktemp("site")
    for name, text in made.items():
        (folder / name).write_text(text, encoding="utf-8")
    page = Opened(browser, folder / f"{NAMES[0]}.html", reduced_motion="reduce")

    def visit(name: str, fragment: str = "") -> Opened:
        page.page.goto((folder / f"{name}.html").as_uri() + fragment)
        page.settle()
        return page

    yield visit
    page.context.close()
    assert page.complaints == []
    inside = (folder.as_uri(), "blob:")
    assert all(url.startswith(inside) for url in page.requests)


def test_a_site_holds_the_script_once(made: dict[str, str]) -> None:
    pages = {f"{name}.html": made[f"{name}.html"] for name in NAMES}
    assert set(made) == {"explorer.js", "explorer.css", *pages}
    assert all("function generalLoss" not in text and len(text) < 60e3 for text in pages.values())


@pytest.mark.parametrize("name", NAMES)
def test_answers_are_those_of_the_runtime(visited: Callable[..., Opened], columns: dict[str, Any], name: str) -> None:
    """Critical loads with their frequencies, eigenvalues below them, and the motion after a step, over random cases."""
    page, column, rng = visited(name), columns[name], random.Random(name)
    for _ in range(3):
        alpha, beta = (
            rng.choice([0.0, 10 ** rng.uniform(low, high)]) if known in column.damping else 0.0
            for known, low, high in (("alpha", -6, -1), ("beta", -3, 1))
        )
        own = {p.name: rng.uniform(p.low, p.high) for p in column.parameters}
        if name == "integral":  # stable for little gain, and with damping
            own, beta = {"g": rng.uniform(0.2, 2.0)}, rng.uniform(0.1, 1.0)
        N = rng.choice([4, 6])
        expected = fb.critical_load(column, N, alpha, beta, **own)
        found = page.ask("(case_) => freebeam.firstLoss(...case_).crossing", [N, alpha, beta, own])
        assert expected.load is not None
        assert found["kind"] == expected.kind, (N, alpha, beta, own)
        assert found["load"] == pytest.approx(expected.load, rel=1e-8), (N, alpha, beta, own)
        assert found["omega"] == pytest.approx(expected.frequency, rel=1e-6, abs=1e-6), (N, alpha, beta, own)
        system = column.system(N, 0.8 * expected.load, alpha, beta, **own)
        values = page.ask("(case_) => freebeam.spectrum(...case_)", [N, system.load, alpha, beta, own])
        exact = fb.spectrum(system).eigenvalues
        low = exact[np.argsort(np.abs(exact))[: min(8, len(exact))]]
        nearest = np.abs((np.array(values) @ [1, 1j])[:, None] - low).min(axis=0)
        assert (nearest <= 1e-8 * (1 + np.abs(low))).all(), (N, alpha, beta, own)
    if column.forced:
        assert_motions_are_those_of_the_runtime(page, column)


@pytest.mark.parametrize("alpha", [1e-8, 2.8e-10, 1e-13])
def test_light_damping_is_as_any(visited: Callable[..., Opened], columns: dict[str, Any], alpha: float) -> None:
    expected = fb.critical_load(columns["pflueger"], 5, alpha)
    found = visited("pflueger").ask("(case_) => freebeam.firstLoss(...case_).crossing", [5, alpha, 0, {}])
    assert found["load"] == pytest.approx(expected.load, rel=1e-9)
    assert found["omega"] == pytest.approx(expected.frequency, rel=1e-9)


def assert_motions_are_those_of_the_runtime(page: Opened, column: Any) -> None:
    """After a step, under a sine and after a pulse."""
    asked = {"sensor": 0.8, "place": 0.6, "rate": 2.5, "N": 5}
    values = page.ask("(values) => { freebeam.set(values); return freebeam.values(); }", asked)
    own = {p.name: values[p.name] for p in column.parameters}
    system = column.system(5, values["P"], values.get("alpha", 0.0), values.get("beta", 0.0), **own)
    seen = """(force) => {
      freebeam.set({ force });
      const { t, y } = freebeam.response();
      return [t[1], [...y].slice(0, 201), freebeam.view().pencil.first];
    }"""
    for force in ("step", "sine", "pulse"):
        h, y, first = page.ask(seen, force)
        given = fb.Harmonic(0.01, 2.5) if force == "sine" else 0.01
        exact = fb.respond(system, (len(y) - 1) * h, h, force=given, force_position=0.6, sensors=[0.8]).y[:, 0]
        if force == "pulse":
            off = round(np.pi / first / h)
            exact = exact - np.concatenate([np.zeros(off), exact[: len(exact) - off]])
        assert np.abs(np.array(y) - exact).max() < 1e-6 * np.abs(exact).max(), force


MAPPED = """(follows) => {
  const even = (low, high) => Array.from({ length: 9 }, (_, k) => low + ((high - low) * k) / 8);
  const axes = [{ key: "alpha", values: even(0, 0.02) }, { key: "own-k", values: even(2, 40) }];
  const [real, loads] = [window.followedLoss, new Float64Array(81).fill(NaN)];
  let count = 0;
  window.followedLoss = (...asked) => {
    const found = follows ? real(...asked) : null;
    count += found ? 1 : 0;
    return found;
  };
  const asked = { N: 3, own: { k: 10, a: 0.4 }, alpha: 0, beta: 0 };
  const cells = mapCells(asked, axes, [{ key: "own-k", name: "k" }], loads);
  while (!cells.next().done);
  window.followedLoss = real;
  return [count, [...loads]];
}"""


def test_points_of_a_map_are_followed_to_what_a_search_finds(visited: Callable[..., Opened]) -> None:
    page = visited("crack")
    (count, found), (_, searched) = page.ask(MAPPED, True), page.ask(MAPPED, False)
    assert count > 40
    assert found == pytest.approx(searched, rel=1e-6)


def test_map_over_two_own_parameters_and_over_the_load(visited: Callable[..., Opened], columns: dict[str, Any]) -> None:
    column, rng = columns["pflueger"], random.Random(3)
    page = visited("pflueger", "#N=3&alpha=0.01&beta=0&across=mu&up=J")
    done = "([x, y]) => freebeam.map()?.done && freebeam.map().axes[0].key === x && freebeam.map().axes[1].key === y"
    page.page.locator("#map").scroll_into_view_if_needed()
    page.page.wait_for_function(done, arg=["mu", "J"])
    told = "[freebeam.map().axes.map(({ values }) => values), [...freebeam.map().loads]]"
    (across, up), cells = page.ask(told)
    for k in rng.sample(range(len(cells)), 8):
        own = {"mu": across[k % len(across)], "J": up[k // len(across)]}
        assert cells[k] == pytest.approx(fb.critical_load(column, 3, 0.01, **own).load, rel=1e-6), own
    page.page.select_option("#box-up", "P")
    page.page.wait_for_function(done, arg=["mu", "P"])
    (across, up), cells = page.ask(told)
    assert page.page.locator("#map-verdicts").is_visible() and page.page.locator("#map-scale").is_hidden()
    for k in rng.sample(range(len(cells)), 25):
        mu, load = across[k % len(across)], up[k // len(across)]
        values = fb.spectrum(column.system(3, load, 0.01, mu=mu)).eigenvalues
        fastest = values[values.real.argmax()]
        assert cells[k] == (0 if fastest.real <= 0 else 1 if fastest.imag != 0 else 2), (mu, load)
    over = page.page.locator("#map .u-over")
    box = over.bounding_box()
    assert box is not None
    over.click(position={"x": 0.5 * box["width"], "y": 0.5 * box["height"]})
    assert page.values()["mu"] == pytest.approx(2.5, abs=0.2)
    assert page.values()["P"] == pytest.approx(up[len(up) // 2], rel=0.1)


def test_what_has_no_mass_takes_no_force(visited: Callable[..., Opened]) -> None:
    """A force on a relation is refused, and one on the beam is not."""
    page = visited("relaxation")
    asked = """(number) => {
      const { pencil, damping } = freebeam.view();
      const Q = number === null ? forceAt(pencil, 0.6, 0) : seenAt(pencil, [0], number)[0];
      const drive = { kind: "step", seen: Q, force: Q, release: null, growth: -1 };
      return responseAt(pencil, damping, 3, drive, 1).y.length;
    }"""
    reads = page.ask("freebeam.view().column.reads")
    assert page.ask(asked, None) == 700
    assert page.ask(asked, reads.index("coordinate q")) == 0


def test_what_nothing_decides_says_why(visited: Callable[..., Opened]) -> None:
    """Without mass, damping and stiffness a coordinate may move as it likes."""
    page = visited("integral")
    bare = "() => { const one = Matrix.diag([1, 0]); try { reduced(one, one, one); } catch (e) { return e.message; } }"
    assert page.ask(bare) == "nothing moves or holds some coordinate without mass"


def test_what_grows_at_once_has_no_first_loss(visited: Callable[..., Opened]) -> None:
    """Nothing of the case before is left standing."""
    page = visited("tip-damper", "#P=5")
    page.ask("(values) => { freebeam.view().damping.grows = true; refuse(freebeam.view()); }", {})
    assert page.text("sentence").startswith("At the smallest loads this column is not stable here")
    assert page.text("critical") == page.text("kind") == ""
    page.type("P", "6")
    assert page.text("sentence").startswith("Stable") and page.text("critical") != ""


def test_in_si_units_a_page_says_what_the_command_line_says(
    visited: Callable[..., Opened], columns: dict[str, Any]
) -> None:
    page = visited("step", "#length=20&bending_stiffness=2e6&mass_per_length=50&N=4")
    size = columns["step"].scales(2e6, 50, 20)
    values = page.values()
    expected = fb.critical_load(columns["step"], 4, values["alpha"], values["beta"])
    number, unit = page.text("critical").split()
    assert unit == "kN" and float(number) * 1e3 == pytest.approx(expected.load * size["load"], rel=1e-5)
    assert f"{expected.frequency * size['frequency']:.4g}"[:4] in page.text("kind") and "rad/s" in page.text("kind")
    assert page.page.get_attribute("#slider-P", "aria-valuetext") == f"{values['P']:g}, {values['P'] * 5:.2f} kN"
    page.type("length", "")
    assert float(page.text("critical")) == pytest.approx(expected.load, rel=1e-8)
    page.type("length", "-3")
    assert "must be from 0" in page.text("why-length") and page.values()["length"] is None


def test_no_si_units_where_the_size_of_the_load_moves_with_a_parameter(visited: Callable[..., Opened]) -> None:
    """A map over the fluid's share would want another size at each point."""
    page = visited("pipe", "#length=3&bending_stiffness=6&mass_per_length=5")
    assert not page.page.is_visible("#units") and "m/s" not in page.text("critical")


@pytest.mark.parametrize("name", ["timoshenko", "ziegler"])
def test_every_control_has_a_name_and_a_tip(visited: Callable[..., Opened], name: str) -> None:
    page = visited(name, "#force=sine")
    unnamed = """[...document.querySelectorAll("input, select, button")].filter((one) => {
      const tip = document.getElementById((one.getAttribute("aria-describedby") ?? "").split(" ")[0]);
      const isNamed = one.labels?.length || one.ariaLabel || one.textContent;
      return !isNamed || !(one.title && (one.tagName === "BUTTON" || tip?.textContent));
    }).map((one) => one.id)"""
    assert page.ask(unnamed) == []
    assert page.page.get_attribute("#sentence", "aria-live") == "polite"


def test_a_page_refuses_what_it_cannot_search(columns: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(content.__globals__, "COORDINATES", 3)
    with pytest.raises(InputError, match=r"step: has 4 coordinates at the least, and a page searches .* up to 3"):
        content(columns["step"])
    assert COORDINATES > 34  # two fields or segments of 16 functions


def test_what_only_the_load_restores_does_not_grow_without_it(visited: Callable[..., Opened]) -> None:
    page = visited("beal", "#P=0")
    assert page.text("sentence").startswith("Stable")
