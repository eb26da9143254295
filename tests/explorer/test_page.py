"""The page, driven as its readers drive it, and its numbers against the runtime."""

import json
import random
import re
import shlex
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import freebeam as fb
from freebeam import cli
from freebeam.maps.surface import first_crossing
from freebeam_sym import column_names
from freebeam_sym.stability.pencil import Pencil
from tests.gallery import GALLERY
from tests.reference import dense

FULL = "#P=42.5&alpha=0.02&beta=0&N=11&sensor=0.35"


def test_sentence_says_the_state(opened):
    page = opened()
    page.type("P", "80")
    assert re.match(r"Stable; least damped mode 1, ω = \d", page.text("sentence"))
    assert "flutter" not in page.text("sentence").lower()
    page.type("P", "120")
    assert re.match(r"Flutter since P = 90\.85; mode \d grows", page.text("sentence"))
    assert "stable" not in page.text("sentence").lower()
    assert "linear model holds only for small motion" in page.text("remark")


def test_critical_load_is_that_of_the_command(opened, capsys):
    page = opened("free-free", "#P=80&alpha=0.001&beta=0.1&N=8")
    assert cli.main(["critical", "--alpha", "0.001", "--beta", "0.1", "--json"]) == 0
    load = json.loads(capsys.readouterr().out)["load"]
    assert float(page.page.get_attribute("#critical", "data-value")) == pytest.approx(load, abs=1e-8)
    assert float(page.text("critical")) == pytest.approx(load, abs=1e-7)


def cases_of(column, count, seed):
    rng = random.Random(seed)
    for k in range(count):
        alpha = rng.choice([0.0, 10 ** rng.uniform(-6, 0), 10 ** rng.uniform(-11, -6)]) if k else 0.0
        beta = rng.choice([0.0, 10 ** rng.uniform(-3, 2)]) if k else 0.0
        known = {"alpha": alpha, "beta": beta}
        alpha, beta = (known[name] if name in column.damping else 0.0 for name in ("alpha", "beta"))
        own = {p.name: rng.uniform(p.low, p.high) for p in column.parameters}
        yield rng.choice([2, 4, 8, 8, 16]), alpha, beta, own


@pytest.mark.parametrize(
    "name, basis", [("free-free", None), ("beck", None), ("euler-pinned", None), ("own", None), ("beck", "legendre")]
)
def test_numbers_are_those_of_the_runtime(opened, own_column, name, basis):
    """Critical loads and eigenvalues over random cases, the undamped coalescence among them."""
    name = own_column if name == "own" else name
    page, column = opened(name, basis=basis), fb.column(name, basis)
    cases = list(cases_of(column, 10, 4))
    found = page.ask("(all) => all.map((case_) => freebeam.firstLoss(...case_).crossing)", cases)
    for case, crossing in zip(cases, found, strict=True):
        N, alpha, beta, own = case
        expected = fb.critical_load(column, N, alpha, beta, **own)
        if expected.load is None:
            assert crossing is None, case
            continue
        assert crossing["kind"] == expected.kind, case
        assert crossing["load"] == pytest.approx(expected.load, abs=1e-8), case
        assert crossing["omega"] == pytest.approx(expected.frequency, abs=1e-7), case
    loads = [0.85 * (crossing["load"] if crossing else 100.0) for crossing in found]  # away from coalescence
    asked = [[N, P, alpha, beta, own] for (N, alpha, beta, own), P in zip(cases, loads, strict=True)]
    spectra = page.ask("(all) => all.map((case_) => freebeam.spectrum(...case_))", asked)
    for (N, P, alpha, beta, own), values in zip(asked, spectra, strict=True):
        exact = fb.spectrum(column.system(N, P, alpha, beta, **own)).eigenvalues
        nearest = np.abs((np.array(values) @ [1, 1j])[:, None] - exact).min(axis=0)
        assert (nearest <= 1e-8 * (1 + np.abs(exact))).all(), (N, P, alpha, beta, own)


def assert_as_the_runtime(page, asked):
    """First loss and touches of each question, load by load."""
    question = [[case.modes, case.alpha, case.beta, case.own, case.kappa] for case in asked]
    found = page.ask(
        "(all) => all.map(([N, a, b, own, kappa]) => freebeam.firstLoss(N, a, b, own, kappa ?? undefined))", question
    )
    for case, one in zip(asked, found, strict=True):
        expected = dense.answer(case)
        touches = [touch["load"] for touch in one["touches"]]
        assert touches == pytest.approx([touch.load for touch in expected.touches], rel=1e-8), case
        if expected.load is None:
            assert one["crossing"] is None, case
            continue
        assert one["crossing"]["kind"] == expected.kind, case
        assert one["crossing"]["load"] == pytest.approx(expected.load, rel=1e-8), case


@pytest.mark.parametrize("basis", ["modes", "legendre"])
@pytest.mark.parametrize("name", column_names())
def test_first_losses_and_touches_are_those_of_the_runtime(opened, name, basis):
    """Random questions: all N of the page, all damping and its limits, many next to the touch at η = 1/2."""
    known = {p.name: (p.low, p.high) for p in fb.column(name).parameters}
    asked = [
        replace(case, own={key: min(max(value, known[key][0]), known[key][1]) for key, value in case.own.items()})
        for case in dense.cases(450, 5, most=16)
        if (case.name, case.basis) == (name, basis)
    ]
    assert len(asked) > 40
    assert_as_the_runtime(opened(name, basis=basis), asked)


@pytest.mark.parametrize("basis", ["modes", "legendre"])
@pytest.mark.parametrize("name", column_names())
def test_hard_questions_are_answered_as_by_the_runtime(opened, name, basis):
    asked = [case for case in GALLERY.values() if (case.name, case.basis) == (name, basis)]
    if asked:
        assert_as_the_runtime(opened(name, basis=basis), asked)


ASK = """([M, E, H, size, shape]) => {
  const problem = problemOf(M, E, H);
  return firstLoss(problem, { size, ratio: size / problem.root[0], shape, limit: false });
}"""


def test_two_modes_of_one_frequency_are_not_computed_without_damping(opened):
    """Two equal columns side by side: with damping every flutter is double and is found, without it none is told."""
    one = np.array([[1.0, 0.6], [-0.6, -0.5]])
    M, E, H = np.eye(4), np.diag([1.0, 4.0, 1.0, 4.0]), np.kron(np.eye(2), one)
    shape = (0.01 * np.array([1.0, 1.0, 4.0, 4.0]) + 0.02) / 0.03
    ask = opened().ask
    found = ask(ASK, [M.tolist(), E.tolist(), H.tolist(), 0.03, shape.tolist()])["crossing"]
    assert found["load"] == pytest.approx(first_crossing(Pencil(M, E, H), 0.01, 0.02).load, rel=1e-7)
    bare = [M.tolist(), E.tolist(), H.tolist(), 0, [1] * 4]
    assert ask(f"(all) => ({ASK})(all).crossing === undefined", bare)
    assert ask("criticalOf(undefined, 1000)").startswith("not computed")


def test_the_last_resort_finds_what_the_operator_finds(opened):
    """Equal steps and bisection, for damping, hardly any, and none."""
    page = opened("beck")
    for alpha, beta in ((1e-3, 0.1), (1e-9, 0.0), (0, 0)):
        sought, scanned = page.ask(
            """([alpha, beta]) => {
              const pencil = pencilOf(6, { eta: 1 });
              const damping = dampingOf(pencil, alpha, beta);
              return [firstLoss(pencil, damping).crossing, scan(pencil, damping, 1, 30)];
            }""",
            [alpha, beta],
        )
        assert scanned["kind"] == sought["kind"] == "flutter"
        assert scanned["load"] == pytest.approx(sought["load"], rel=1e-8)
        assert scanned["omega"] == pytest.approx(sought["omega"], rel=1e-3)


@pytest.mark.parametrize("basis", ["modes", "legendre"])
@pytest.mark.parametrize("name", column_names())
def test_the_pages_kernel_is_the_columns(opened, name, basis):
    """Matrices, functions and loads that the page computes with, at other values of the parameters than its own."""
    page, column = opened(name, basis=basis), fb.column(name, basis)
    own = {p.name: p.low + 0.37 * (p.high - p.low) for p in column.parameters}
    found, shapes, load, factors = page.ask(
        """([N, own, x]) => {
          const functions = kernel.basis(N);
          const matrices = [kernel.mass, kernel.stiffness_elastic, kernel.stiffness_load];
          return [
            matrices.map((of) => [...of(functions, false, own)]), [...kernel.shapes(functions, x)], loadOf(own),
            [...kernel.damping_factors(0.2, 0.7, own)],
          ];
        }""",
        [16, own, np.linspace(0, 1, 57).tolist()],
    )
    for values, matrix in zip(found, column.matrices(16, False, **own), strict=True):
        assert np.abs(np.reshape(values, (16, 16)) - matrix).max() <= 4e-15 * np.abs(matrix).max()
    exact = column.kernel.shapes(column.basis(16), np.linspace(0, 1, 57))
    assert np.abs(np.reshape(shapes, (16, 57)) - exact).max() <= 1e-13 * np.abs(exact).max()
    assert factors == list(column.damping_factors(0.2, 0.7, **own))
    # the axial force is the factor of y″; what follows the end is what the end's shear condition leaves over
    coefficients = column.kernel.equation(1.0, **own)[2, 0]
    assert load["axial"] == pytest.approx([*coefficients, *[0.0] * (len(load["axial"]) - len(coefficients))], abs=1e-13)
    shear = next((c for c in column.kernel.end_conditions(1.0, **own)[1] if (3, 0) in c), None)
    if shear is not None:  # y‴ + (N − c) y′ = 0 at a free end under the axial force N and the follower's share c
        left = sum(load["axial"]) - load["ends"][1]
        assert shear.get((1, 0), 0) / shear[3, 0] == pytest.approx(left, abs=1e-13)


def test_map_is_right_for_each_number_of_functions(opened):
    """Cells of the map, strips without damping among them, after N has changed."""
    page = opened("beck", "#N=2")
    column = fb.column("beck")
    page.page.locator("#map").scroll_into_view_if_needed()
    for N in (2, 3):
        page.type("N", str(N))
        page.page.wait_for_function(
            "N => freebeam.map() && freebeam.map().done && JSON.parse(freebeam.map().id)[0] === N", arg=N
        )
        axes, loads = page.ask(
            "[freebeam.map().axes, [...freebeam.map().loads].map(x => Number.isFinite(x) ? x : null)]"
        )
        alphas, betas = (axis["values"] for axis in axes)
        n = len(alphas)
        rng = random.Random(N)
        for k in [0, 5, 7 * n, *rng.sample(range(len(loads)), 60)]:
            expected = fb.critical_load(column, N, alphas[k % n], betas[k // n]).load
            assert loads[k] == (None if expected is None else pytest.approx(expected, abs=1e-8))


def test_tangent_rule_is_the_limit_of_vanishing_damping(opened):
    page = opened("free-free", "#alpha=0.01&beta=0.3")
    tangent = page.ask("freebeam.analysis().tangent")
    assert tangent["kappa"] == pytest.approx(30)
    assert tangent["load"] == pytest.approx(
        fb.critical_load(fb.column("free-free"), kappa=tangent["kappa"]).load, abs=1e-8
    )
    assert page.ask("freebeam.analysis().undamped.load") == pytest.approx(
        fb.critical_load(fb.column("free-free")).load, abs=1e-8
    )


def test_curves_and_locus_are_eigenvalues(opened):
    page = opened("beck", "#alpha=0.01&beta=0.2&N=6&eta=0.9")
    analysis = page.ask("freebeam.analysis()")
    column = fb.column("beck")
    for branch in analysis["locus"]:
        for k in range(0, len(branch["load"]), 12):
            exact = fb.spectrum(column.system(6, branch["load"][k], 0.01, 0.2, eta=0.9)).eigenvalues
            assert np.abs(exact - complex(branch["re"][k], branch["im"][k])).min() < 2e-3 * np.abs(exact[0])
    for k in range(0, len(analysis["curves"][0]["load"]), 12):
        P = analysis["curves"][0]["load"][k]
        s = -(fb.spectrum(column.system(6, P, eta=0.9)).eigenvalues ** 2)
        for curve in analysis["curves"]:
            assert np.abs(s - complex(curve["re"][k], curve["im"][k])).min() < 2e-3 * np.abs(s).min() + 0.2


@pytest.mark.parametrize("fragment", ["#P=80&sensor=0.3", "#P=100&alpha=0&beta=0&N=5&sensor=1"])
def test_response_is_that_of_the_runtime(opened, fragment):
    page = opened("free-free", fragment)
    values = page.values()
    found = page.ask("({ t: [...freebeam.response().t], y: [...freebeam.response().y] })")
    system = fb.column("free-free").system(int(values["N"]), values["P"], values["alpha"], values["beta"])
    q = np.zeros(int(values["N"]))
    q[0] = 0.01
    end = found["t"][150]
    fine, coarse = (
        fb.respond(system, end, end / n, initial=q, sensors=[values["sensor"]], method="newmark").y[:: n // 150, 0]
        for n in (24000, 12000)
    )
    error = np.abs(fine - np.array(found["y"][:151])).max()
    assert error < 2 * np.abs(fine - coarse).max() < 1e-2 * np.abs(fine).max()


def test_link_reopens_the_case(opened):
    page = opened("free-free", FULL)
    stated = {"P": 42.5, "alpha": 0.02, "beta": 0, "N": 11, "sensor": 0.35}
    assert {key: page.values()[key] for key in stated} == stated
    page.type("P", "77.7")
    page.page.wait_for_function("location.hash.includes('P=77.7')")
    again = opened("free-free", page.ask("location.hash"))
    assert again.values() == page.values()
    assert again.text("sentence") == page.text("sentence")
    assert again.text("critical") == page.text("critical")
    again.ask("location.hash = '#P=150&N=4'")
    again.page.wait_for_function("freebeam.values().N === 4")
    assert again.values()["P"] == 150


def test_address_that_makes_no_sense_says_so(opened):
    page = opened("free-free", "#P=nonsense&N=2.5&zeta=1&beta=0.2&alpha=%E0%A4%A")
    said = page.text("address")
    assert all(
        part in said for part in ("P = “nonsense”: is not a number", "N = “2.5”: must be a whole number", "zeta")
    )
    assert page.values()["beta"] == 0.2 and page.values()["N"] == 8


@pytest.mark.parametrize(
    "key, text, why",
    [
        ("P", "abc", "is not a number"),
        ("P", "", "nothing"),
        ("P", "-1", "must be from 0 to 1000"),
        ("P", "1e999", "must be from 0 to 1000"),
        ("alpha", "1e-", "is not a number"),
        ("alpha", "NaN", "is not a number"),
        ("N", "2.5", "must be a whole number from 1 to 16"),
        ("N", "17", "must be from 1 to 16"),
        ("sensor", "1.01", "must be from 0 to 1"),
        ("beta", "<b>", "is not a number"),
    ],
)
def test_nonsense_leaves_the_last_good_state(opened, key, text, why):
    page = opened()
    before = page.values(), page.text("sentence"), page.text("critical")
    page.type(key, text)
    assert why in page.page.inner_text(f"#why-{key}")
    assert page.page.get_attribute(f"#box-{key}", "aria-invalid") == "true"
    assert (page.values(), page.text("sentence"), page.text("critical")) == before
    assert float(page.page.input_value(f"#box-{key}")) == before[0][key]
    page.type(key, str(before[0][key]))
    page.page.locator(f"#slider-{key}").press("ArrowRight")
    page.page.locator(f"#slider-{key}").press("ArrowLeft")
    assert page.page.inner_text(f"#why-{key}") == ""


def test_keyboard_moves_sliders_and_reaches_everything(opened):
    page = opened()
    before = page.values()
    page.page.locator("#slider-P").focus()
    page.page.keyboard.press("ArrowRight")
    assert page.values()["P"] > before["P"]
    page.page.locator("#slider-alpha").press("Home")
    page.settle()
    assert page.values()["alpha"] == 0
    page.page.locator("#box-N").press("ArrowUp")
    assert page.values()["N"] == before["N"] + 1
    page.page.locator("#slider-P").focus()
    reached = set()
    for _ in range(40):
        reached.add(page.ask("document.activeElement.id"))
        page.page.keyboard.press("Tab")
    controls = {f"{kind}-{key}" for kind in ("box", "slider") for key in ("alpha", "beta", "N", "sensor")}
    assert controls | {"slider-P", "near", "box-across", "box-up", "box-force"} <= reached
    assert page.ask("[...document.querySelectorAll('input')].every(i => i.labels.length || i.ariaLabel)")


@pytest.mark.parametrize("basis", [None, "legendre"])
def test_command_of_the_footer_computes_what_the_page_shows(opened, capsys, basis):
    page = opened("beck", "#alpha=0.02&beta=0.3&N=6&eta=0.83", basis=basis)
    words = shlex.split(page.text("command"))
    assert words[0] == "freebeam" and cli.main([*words[1:], "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert float(page.page.get_attribute("#critical", "data-value")) == pytest.approx(said["load"], abs=1e-8)
    page.page.click("#reset")
    page.settle()
    assert "--alpha 0.001 --beta 0.1" in page.text("command") and "--set eta=1" in page.text("command")


def test_keyboard_reaches_a_parameters_start_again(opened):
    """Even steps from the low end miss it; the place nearest to it is taken for it, and no value is passed over."""
    page = opened("beck")
    for away, back in (("ArrowRight", "ArrowLeft"), ("ArrowLeft", "ArrowRight")):
        for key in ("eta", "P", "alpha", "beta"):
            start = page.values()[key]
            page.page.locator(f"#slider-{key}").focus()
            for press in (away, away, away, back, back):
                page.page.keyboard.press(press)
            assert page.values()[key] != start
            for _ in range(2):
                page.page.keyboard.press(back)
                if page.values()[key] == start:
                    break
            assert page.values()[key] == start, key
    page.page.locator("#slider-eta").press("Home")
    assert page.values()["eta"] == 0
    page.page.locator("#slider-eta").press("End")
    assert page.values()["eta"] == 1.5


def test_reset_takes_back_what_was_complained_of(opened):
    page = opened("free-free", "#P=nonsense")
    page.type("alpha", "much")
    assert page.text("address") and page.text("why-alpha")
    page.page.click("#reset")
    page.settle()
    assert page.text("address") == page.text("why-alpha") == ""
    assert page.page.get_attribute("#box-alpha", "aria-invalid") == "false"


def test_words_of_a_column_are_shown_as_they_are(opened):
    """No mark in a title or a meaning acts in the page."""
    real = fb.column("beck")
    hostile = (
        "</script><script>document.title='ran'</script><img src=x onerror=alert(1)> $x$ `b` & &lt; ]]> \"q\" @COLUMN@\\"
    )
    (eta,) = real.kernel.COLUMN["parameters"]
    more = {"title": f"{hostile}\n\nmore", "parameters": [{**eta, "meaning": hostile}]}
    kernel = SimpleNamespace(**{**vars(real.kernel), "COLUMN": {**real.kernel.COLUMN, **more}})
    page = opened(fb.Column(kernel))
    assert page.page.text_content("h1") == f"{hostile} more"
    assert page.page.title() == f"{hostile} more · freebeam explorer"
    assert page.page.get_attribute("label[for=box-eta]", "title") == hostile
    assert page.ask("document.images.length") == 0


def test_map_is_a_control(opened):
    """A click sets both dampings, and the cross-hair's case is what the sliders then show."""
    page = opened("free-free", "#N=2")
    page.page.locator("#map").scroll_into_view_if_needed()
    page.page.wait_for_function("freebeam.map() && freebeam.map().done")
    over = page.page.locator("#map .u-over")
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    over.click(position={"x": 0.75 * box["width"], "y": 0.25 * box["height"]})
    values = page.values()
    assert 1e-2 < values["alpha"] < 1e-1 and 1 < values["beta"] < 1e2
    over.click(position={"x": 2, "y": box["height"] - 2})
    assert (page.values()["alpha"], page.values()["beta"]) == (0, 0)


def test_columns_own_parameter_acts(opened):
    """Beck's column diverges under a dead load, eta = 0, and flutters under a follower force."""
    page = opened("beck", "#P=30&eta=0&alpha=0&beta=0")
    load = fb.critical_load(fb.column("beck"), eta=0.0).load
    assert page.text("sentence").startswith(f"Divergence since P = {load:.3f}")
    page.type("eta", "1")
    load = fb.critical_load(fb.column("beck"), eta=1.0).load
    assert page.text("sentence").startswith(f"Flutter since P = {load:.2f}")


def test_users_own_column(opened, own_column):
    page = opened(own_column)
    assert page.page.locator("#slider-beta").count() == 0  # it states no external damping
    assert page.page.locator("#slider-mu").count() == 1
    page.page.locator("#map").scroll_into_view_if_needed()
    page.page.wait_for_function("freebeam.map()?.axes.map(({ key }) => key).join() === 'alpha,P'")


def test_column_without_damping(opened):
    """No sliders of damping, a map over what there is, and nothing that fails for want of them."""
    real = fb.column("beck")
    kernel = SimpleNamespace(**vars(real.kernel))
    kernel.COLUMN = {**real.kernel.COLUMN, "damping": []}
    page = opened(fb.Column(kernel))
    assert {"alpha", "beta"}.isdisjoint(page.values())
    page.page.locator("#map").scroll_into_view_if_needed()
    page.page.wait_for_function("freebeam.map()?.axes.map(({ key }) => key).join() === 'eta,P'")
    page.type("P", "18")
    assert page.text("undamped") == page.text("critical")


def test_column_of_the_load_alone_has_no_map(opened):
    real = fb.column("euler-pinned")
    kernel = SimpleNamespace(**vars(real.kernel))
    kernel.COLUMN = {**real.kernel.COLUMN, "damping": []}
    page = opened(fb.Column(kernel))
    assert page.page.locator("#map-panel").is_hidden()
    page.type("P", "5")
    assert page.text("critical") == page.text("undamped")


ARROWS = """(values) => {
  // what the page draws: the force at the end, and the slope of the beam there
  const drawn = [];
  const real = window.drawArrow;
  window.drawArrow = (context, at, force, ...rest) => {
    drawn.push([at.slope, force.x, force.y]);
    real(context, at, force, ...rest);
  };
  freebeam.set(values);
  window.drawArrow = real;
  return drawn;
}"""


@pytest.mark.parametrize(
    "name, eta, share", [("free-free", None, 1), ("beck", 1, 1), ("beck", 0.4, 0.4), ("euler-pinned", None, 0)]
)
def test_force_turns_as_the_column_states(opened, name, eta, share):
    page = opened(name)
    drawn = page.ask(ARROWS, {"P": 5} if eta is None else {"P": 5, "eta": eta})
    assert drawn
    for slope, x, y in drawn:
        assert x < 0
        assert y == pytest.approx(share * slope * x, abs=1e-12)
    assert any(abs(slope) > 1e-3 for slope, _, _ in drawn)


def test_animation_moves_and_rests_for_those_who_ask(opened):
    moving = opened(reduced_motion="no-preference")
    moving.page.wait_for_function("freebeam.frames().length > 3")
    assert moving.text("motion") == "Pause"
    moving.page.click("#motion")
    seen = moving.ask("freebeam.frames().length")
    moving.page.wait_for_timeout(150)
    assert moving.ask("freebeam.frames().length") <= seen + 1
    still = opened()
    assert still.text("motion") == "Play" and still.ask("freebeam.frames().length") == 0


@pytest.mark.parametrize("width", [390, 1280, 1600])
def test_fits_the_screen(opened, width):
    page = opened()
    page.page.set_viewport_size({"width": width, "height": 800})
    page.page.wait_for_function(
        "[...document.querySelectorAll('.plot')].every(p => Math.abs(p.clientWidth - p.firstChild.clientWidth) <= 1)"
    )
    assert page.ask("document.documentElement.scrollWidth") <= width
    page.page.set_viewport_size({"width": 1280, "height": 800})


def test_words_beside_a_point_lie_within_the_plot(opened):
    """On a phone there is room on neither side of the meeting for its words."""
    page = opened("beck", "#P=16&alpha=0.001&beta=0.1")
    page.ask("""() => {
      window.told = [];
      const draw = window.draw = CanvasRenderingContext2D.prototype.fillText;
      CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
        const plot = this.canvas.parentElement.querySelector(".u-over");
        const { actualBoundingBoxLeft: left, actualBoundingBoxRight: right } = this.measureText(text);
        if (plot && /coalescence|tangent/.test(text)) {
          const start = plot.offsetLeft * devicePixelRatio;
          told.push([x - left - start, start + plot.clientWidth * devicePixelRatio - x - right]);
        }
        return draw.call(this, text, x, y);
      };
    }""")
    page.page.set_viewport_size({"width": 390, "height": 800})
    page.page.wait_for_function("told.length >= 2")
    rooms = page.ask("() => { CanvasRenderingContext2D.prototype.fillText = draw; return told; }")
    page.page.set_viewport_size({"width": 1280, "height": 800})
    assert min(min(room) for room in rooms) >= 0


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out(opened, scheme):
    page = opened()
    page.page.emulate_media(color_scheme=scheme)
    contrast = page.ask("""() => {
      const level = (text) => text.match(/[\\d.]+/g).slice(0, 3).map(Number).map((c) => c / 255)
        .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
        .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
      const behind = (element) => {
        const colour = getComputedStyle(element).backgroundColor;
        return colour === "rgba(0, 0, 0, 0)" && element.parentElement ? behind(element.parentElement) : colour;
      };
      const texts = "h1, h2, .sub, label, figcaption, .sentence, .remark, dt, th, td, button";
      return Math.min(...[...document.querySelectorAll(texts)].map((element) => {
          const [a, b] = [level(getComputedStyle(element).color), level(behind(element))].sort((x, y) => y - x);
          return (a + 0.05) / (b + 0.05);
        }));
    }""")
    assert contrast >= 4.5


def test_works_without_workers(browser, written):
    """Where a browser gives the page no worker, the same is computed in slices in the page."""
    context = browser.new_context()
    page = context.new_page()
    page.add_init_script("delete window.Worker; window.Worker = undefined;")
    page.goto(written("free-free").as_uri() + "#N=4")
    page.wait_for_function("window.freebeam && freebeam.settled()")
    load = page.evaluate("freebeam.analysis().critical.load")
    assert load == pytest.approx(fb.critical_load(fb.column("free-free"), 4, 1e-3, 0.1).load, abs=1e-8)
    context.close()
