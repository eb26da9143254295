"""Pictures: their numbers by independent routes, their legibility as measured, and `freebeam figures`."""

import csv
import io
import itertools
import json
import sys
import xml.etree.ElementTree as ET
from functools import cache

import numpy as np
import pytest
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text
from scipy.linalg import expm

import freebeam as fb
from freebeam import cli
from freebeam.figures import curves, look, published
from freebeam.figures.marks import digits, plain
from freebeam.figures.saving import FORMATS, csv_of, image_of
from freebeam.figures.schematic import centre_line

FREE, BECK, EULER = (fb.column(name, "modes") for name in ("free-free", "beck", "euler-pinned"))


@pytest.fixture
def ax():
    """Axes that no window knows of."""
    with look.style():
        yield Figure().subplots()


@pytest.fixture(scope="module")
def pictures():
    return {n: published.picture(n) for n in published.NUMBERS}


@pytest.fixture(scope="module")
def tables(pictures):
    """What the CSV files hold, read back from their text."""
    found = {}
    for n, picture in pictures.items():
        lines = [line for line in csv_of(picture).splitlines() if not line.startswith("#")]
        header, *rows = csv.reader(lines)
        found[n] = dict(zip(header, map(np.array, zip(*rows, strict=True)), strict=True))
    return found


@pytest.fixture(scope="module")
def drawn(pictures):
    """Each figure of the paper, laid out."""
    figures = {}
    with look.style():
        for n, picture in pictures.items():
            figures[n] = picture.draw()
            FigureCanvasAgg(figures[n])
            figures[n].draw_without_rendering()
    return figures


def state_matrix(load, alpha, beta, rigid=False, column=FREE):
    """A of Eq. (25), put together here."""
    s = column.system(8, load, alpha, beta, rigid)
    n = len(s.M)
    inverse = np.linalg.inv(s.M)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ s.K, -inverse @ s.C]])


# --- the paper's figures: numbers ---------------------------------------------------------------------------


@pytest.mark.parametrize(("n", "alpha", "beta"), [(2, 0.0, 0.0), (3, 0.0, 0.0), (7, 1e-3, 0.1)])
def test_loci_are_eigenvalues_of_the_matrix(tables, pictures, n, alpha, beta):
    table = {name: values.astype(float) for name, values in tables[n].items()}
    at_rest = np.linalg.eigvals(state_matrix(0.0, alpha, beta))
    reference = at_rest.imag[at_rest.imag > 0].min()
    assert pictures[n].marks["lambda_0"] == pytest.approx(reference, rel=1e-9)
    followed = np.array([table[f"Re_lambda_{k}"] + 1j * table[f"Im_lambda_{k}"] for k in (1, 2)]) * reference
    growing = np.array([table[f"unstable_{k}"] for k in (1, 2)])
    critical = pictures[n].marks["critical_load"]
    for P, pair, grows in list(zip(table["P"], followed.T, growing.T, strict=True))[::7]:
        expected = np.linalg.eigvals(state_matrix(P, alpha, beta))
        gap = np.abs(expected - pair[:, None]).min(axis=1)
        near = abs(P / critical - 1) < 1e-3 and not alpha  # a double root: half the digits
        assert gap.max() < (1e-5 if near else 1e-9) * 100
        assert grows.any() == (P > critical)
        assert len(set(np.round(pair, 9))) == 2  # two branches, not one twice


def test_a_branch_keeps_its_place(tables):
    """Fig. 7: from row to row each branch goes to the nearer of the next two, a small step."""
    table = {name: values.astype(float) for name, values in tables[7].items()}
    one, two = (table[f"Re_lambda_{k}"] + 1j * table[f"Im_lambda_{k}"] for k in (1, 2))
    stay = np.abs(np.diff(one)) + np.abs(np.diff(two))
    swap = np.abs(two[1:] - one[:-1]) + np.abs(one[1:] - two[:-1])
    assert (stay < swap / 5).all()
    assert one[0].imag == pytest.approx(1.0) and two[0].imag > 2


@pytest.mark.parametrize("n", [4, 5, 6])
def test_critical_loads_are_where_the_first_eigenvalue_crosses(tables, n):
    table = {name: values for name, values in tables[n].items() if name != "kind"}
    table = {name: values.astype(float) for name, values in table.items()}
    rows = len(table["P_cr"])
    pick = np.random.default_rng(n).choice(rows, min(12, rows), replace=False)
    for k in pick:
        alpha, beta = (float(table.get(name, np.zeros(rows))[k]) for name in ("alpha", "beta"))
        load = table["P_cr"][k]
        below, above = (np.linalg.eigvals(state_matrix(load * f, alpha, beta)) for f in (1 - 1e-5, 1 + 1e-5))
        assert below.real.max() < 1e-10 < above.real.max()
        assert abs(above[above.real.argmax()].imag) == pytest.approx(table["omega"][k], rel=1e-2 if not alpha else 1e-3)
        lower = [np.linalg.eigvals(state_matrix(P, alpha, beta)).real.max() for P in np.linspace(1, 0.99 * load, 15)]
        assert max(lower) < 1e-10


def test_the_undamped_load_is_no_limit_of_fig_4(pictures, tables):
    loads = tables[4]["P_cr"].astype(float)
    assert pictures[4].marks["undamped"] - loads[0] > 20
    assert loads[0] == pytest.approx(pictures[4].marks["vanishing_alpha"], abs=1e-6)


@pytest.mark.parametrize(("n", "load"), [(8, 9.0), (9, 112.0)])
def test_free_motion_is_the_matrix_exponential(tables, pictures, n, load):
    A = state_matrix(load, 1e-3, 0.1)
    table = {name: values.astype(float) for name, values in tables[n].items()}
    start = np.eye(16)[0] * published.SETTINGS[n]["q_1"]
    shapes = FREE.system(8).shapes(0.1)
    size = np.abs(table["y"]).max()
    for k in np.linspace(0, min(len(table["t"]) - 1, 400), 9).astype(int):
        state = expm(table["t"][k] * A) @ start
        assert table["y"][k] == pytest.approx(shapes @ state[:8], abs=2e-2 * size)
        assert table["dy"][k] == pytest.approx(shapes @ state[8:], abs=2e-2 * np.abs(table["dy"]).max())
    assert pictures[n].marks["growth_rate"] == pytest.approx(np.linalg.eigvals(A).real.max(), rel=1e-9)
    acceleration = np.gradient(table["dy"], table["t"])[2:-2]
    assert np.abs(acceleration - table["ddy"][2:-2]).max() < 0.05 * np.abs(table["ddy"]).max()


def forced(load, size, rigid=False, transposed=False, t=20.0):
    """State at t from rest under size · sin 3t at x = 1: one matrix exponential with the force as two more states."""
    s = FREE.system(8, load, 1e-3, 0.1, rigid)
    n = len(s.M)
    K = s.K
    if transposed:
        end = np.outer(s.shapes(1.0), s.shapes(1.0, 1))
        K = K + load * (end.T - end)
    inverse = np.linalg.inv(s.M)
    A = np.zeros((2 * n + 2, 2 * n + 2))
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n], A[n : 2 * n, n : 2 * n], A[n : 2 * n, 2 * n] = -inverse @ K, -inverse @ s.C, inverse @ s.Q(1.0)
    A[2 * n, 2 * n + 1], A[2 * n + 1, 2 * n] = 3.0, -3.0
    state = expm(t * A) @ np.append(np.zeros(2 * n + 1), size)
    return s, state[:n]


@pytest.mark.parametrize(("load", "size"), [*itertools.product((5.0, 50.0), (0.001, 0.002))])
def test_forced_motion_is_the_matrix_exponential(tables, load, size):
    table = tables[10]
    for kind, transposed in (("derived", False), ("printed", True)):
        s, q = forced(load, size, transposed=transposed)
        y = table[f"y_{kind}_P{load:g}_F{size:g}"].astype(float)
        assert y[-1] == pytest.approx(s.shapes(0.1) @ q, abs=5e-3 * np.abs(y).max())
    s, q = forced(load, size, rigid=True)
    drift = table[f"y_rigid_P{load:g}_F{size:g}"].astype(float)
    assert drift[-1] == pytest.approx(s.shapes(0.1)[:2] @ q[:2], rel=1e-3)


def test_the_erratum_changes_how_the_amplitude_grows(tables, pictures):
    marks = pictures[10].marks
    late = tables[10]["t"].astype(float) > 20 - 2 * np.pi / 3
    for kind, low, high in (("derived", 1.25, 1.32), ("printed", 2.4, 2.6)):
        found = {load: np.abs(tables[10][f"y_{kind}_P{load}_F0.001"].astype(float)[late]).max() for load in (5, 50)}
        assert low < marks[f"growth_{kind}"] < high
        assert found[50] / found[5] == pytest.approx(marks[f"growth_{kind}"], rel=0.02)


def test_captions_say_what_the_paper_does_not(pictures):
    for picture in pictures.values():
        assert picture.title in picture.caption
    assert all("does not state its initial condition" in pictures[n].caption for n in (8, 9))
    assert "109.8" in pictures[2].caption and "109.73" in pictures[3].caption and "90.9" in pictures[7].caption


# --- the paper's figures: pictures --------------------------------------------------------------------------


def texts(figure):
    """Visible words of a laid-out figure and their boxes, rotated labels on contour lines left out."""
    renderer = figure.canvas.get_renderer()
    unseen = set()  # ticks that matplotlib keeps beyond the ends of an axis
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                if not low <= tick.get_loc() <= high or not axes.axison:
                    unseen |= {tick.label1, tick.label2}
    for text in figure.findobj(Text):
        if text.get_text().strip() and text.get_visible() and text not in unseen and text.get_rotation() % 90 == 0:
            yield text, text.get_window_extent(renderer)


@pytest.mark.parametrize("n", published.NUMBERS)
def test_words_are_whole_and_apart(drawn, n):
    """No word leaves the picture, and no two lie on one another."""
    found = list(texts(drawn[n]))
    frame = drawn[n].bbox.padded(1)
    for text, box in found:
        assert frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1, text
    for (one, a), (two, b) in itertools.combinations(found, 2):
        wide = min(a.x1, b.x1) - max(a.x0, b.x0)
        high = min(a.y1, b.y1) - max(a.y0, b.y0)
        assert not (wide > 2 and high > 3), (one, two)


def test_critical_points_bear_their_values(drawn, pictures):
    for n, value in ((2, "critical_load"), (3, "critical_load"), (4, "greatest_alpha"), (7, "critical_load")):
        words = " ".join(text.get_text() for text, _ in texts(drawn[n]))
        assert digits(pictures[n].marks[value]) in words


@pytest.mark.parametrize("n", [2, 3, 7])
def test_stable_is_solid_and_unstable_dashed_in_one_colour(drawn, tables, n):
    for axes in drawn[n].axes:
        for k in (0, 1):
            lines = [
                x for x in axes.lines if len(x.get_xdata()) > 9 and to_hex(x.get_color()) == look.COLOURS[k].lower()
            ]
            dashed = [line for line in lines if line.is_dashed()]
            points = sum(len(line.get_xdata()) for line in dashed)
            growing = int(tables[n][f"unstable_{k + 1}"].astype(int).sum())
            assert points == (growing + 1 if growing else 0)
            assert sum(len(line.get_xdata()) for line in lines) >= len(tables[n]["P"])


def seen(colour, kind):
    """Colour in Lab as a dichromat sees it; matrices of Machado, Oliveira and Fernandes (2009), severity 1."""
    matrix = {
        "deuteranopia": [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.01182, 0.04294, 0.968881],
        ],
        "protanopia": [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ],
    }[kind]
    rgb = np.array(to_rgb(colour))
    linear = np.clip(np.array(matrix) @ np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4), 0, 1)
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ linear
    f = np.cbrt(xyz / [0.9505, 1.0, 1.089])
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def test_colours_can_be_read_in_grey_and_by_the_colour_blind():
    for one, two in itertools.combinations(look.COLOURS, 2):
        assert abs(look.lightness(one) - look.lightness(two)) > 10
        for kind in ("deuteranopia", "protanopia"):
            assert np.linalg.norm(seen(one, kind) - seen(two, kind)) > 20
    for count in (2, 6, 9):
        tones = [look.lightness(tone) for tone in look.shades(count)]
        assert (np.diff(tones) > 5).all()
    for tone in (*look.COLOURS, look.ACCENT, look.INK, look.MUTED, *look.shades(9)):
        assert look.lightness(tone) < 76  # on white


@pytest.mark.parametrize("n", published.NUMBERS)
def test_lines_of_one_axes_differ_in_grey(drawn, n):
    for axes in drawn[n].axes:
        tones = {to_hex(x.get_color()) for x in axes.lines if len(x.get_xdata()) > 9 and x.get_linestyle() != "None"}
        for one, two in itertools.combinations(sorted(tones), 2):
            assert abs(look.lightness(one) - look.lightness(two)) > 5, (one, two)


@pytest.mark.parametrize("format", FORMATS)
def test_files_are_the_same_bytes_each_time(format):
    found = set()
    for _ in range(2):
        with look.style():
            figure = Figure(figsize=(3, 2))
            figure.subplots().plot([0, 1], [1, 0], clip_on=False)
            found.add(image_of(figure, format, "A beam"))
    assert len(found) == 1 and b"A beam" in found.pop()


def test_svg_stands_alone(drawn):
    root = ET.fromstring(image_of(drawn[3], "svg"))
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    tags = {element.tag.split("}")[1] for element in root.iter()}
    assert not tags & {"image", "script", "date", "text"}
    references = [v for e in root.iter() for k, v in e.attrib.items() if k.endswith("href")]
    assert references and all(value.startswith("#") for value in references)


# --- drawings of any column ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("column", "own", "kappa"), [(FREE, {}, 0.0), (BECK, {}, 0.0), (BECK, {"eta": 0.8}, 5.0)])
def test_the_tangent_touches_the_curve(column, own, kappa):
    found = curves.tangent(fb.Question.of(column, kappa=kappa, **own))
    M, E, H = column.matrices(8, **own)

    def s(P):
        return np.sort(np.linalg.eigvals(np.linalg.solve(M, E + P * H)).real)[0]

    h = 1e-4 * found.load
    assert s(found.load) == pytest.approx(found.square, rel=1e-9)
    assert (s(found.load + h) - s(found.load - h)) / (2 * h) == pytest.approx(found.slope, rel=1e-5)
    assert found.line(0.0) == pytest.approx(-kappa, abs=1e-9 * found.square)
    below = found.load * np.linspace(0.01, 0.999, 50)
    assert all(s(P) > found.line(P) for P in below)  # and not earlier
    alpha = 1e-7
    damped = fb.critical_load(column, alpha=alpha, beta=kappa * alpha, **own).load
    assert damped == pytest.approx(found.load, rel=1e-6)


@pytest.mark.parametrize("column", [FREE, BECK])
def test_frequencies_meet_by_a_square_root(column):
    found = curves.coalescence(fb.Question.of(column))
    away = found.eigenvalues - 1j * found.frequency
    law = found.law(found.loads)[:, None] * [1, -1]
    share = np.abs(found.loads / found.load - 1)
    error = np.abs(away - law).max(axis=1) / np.maximum(np.abs(law[:, 0]), 1e-12)
    near, far = (error[(share > 0.9 * d) & (share < 1.1 * d)].max() for d in (4e-4, 4e-2))
    assert near < 0.02
    assert 5 < far / near < 20  # the next term is linear in the load: a hundredth of the load, a tenth of the error


@pytest.mark.parametrize("column", [FREE, BECK, EULER])
def test_squared_frequencies_add_up_to_the_trace(column):
    found = curves.frequency_load(fb.Question.of(column), 15.0, count=8)
    M, E, H = column.matrices(8)
    trace = [np.trace(np.linalg.solve(M, E + P * H)) for P in found.loads]
    np.testing.assert_allclose(found.squares.sum(axis=1).real, trace, rtol=1e-9)
    assert (np.diff(found.loads) > 0).all()


def test_overdamped_modes_do_not_take_a_branchs_place():
    found = curves.locus(fb.Question.of(BECK, alpha=0.01), 10.0, count=3)
    assert (found.eigenvalues[0].imag > 0).all()
    np.testing.assert_allclose(np.abs(found.eigenvalues[0]), BECK.system(8).gamma[:3] ** 2, rtol=1e-9)


@pytest.mark.parametrize(
    ("column", "load", "own"),
    [(FREE, None, {}), (FREE, 70.0, {}), (FREE, 112.0, {}), (BECK, None, {}), (BECK, 15.0, {"eta": 0.9})],
)
def test_energy_is_what_the_load_gives_less_what_damping_takes(column, load, own):
    found = curves.cycle(fb.Question.of(column, alpha=1e-3, beta=0.1, **own), load)
    balance = found.energy - found.energy[0] - found.work + found.dissipated
    assert np.abs(balance).max() < 1e-10 * max(found.energy)
    rate = found.eigenvalue.real
    if load is None:
        assert found.work[-1] == pytest.approx(found.dissipated[-1], rel=1e-8)
    else:
        assert (found.work[-1] > found.dissipated[-1]) == (rate > 0)


@pytest.mark.parametrize(("column", "own"), [(FREE, {}), (BECK, {}), (BECK, {"eta": 0.8})])
def test_the_work_is_that_of_the_force_at_the_end(column, own, ax):
    """∮ −η P y′(1) dy(1), by quadrature, and the area that the loop is drawn with."""
    found = curves.cycle(fb.Question.of(column, alpha=1e-3, beta=0.1, **own), points=2001)
    share, s = own.get("eta", 1.0), found.system
    assert curves.follower_share(fb.Question.of(column, **own)) == pytest.approx(share)
    turn = np.exp(1j * found.phase)
    y, slope = (np.real(turn * (found.vector @ s.shapes(1.0, k))) for k in (0, 1))
    F = -share * s.load * slope
    work = float(np.sum((F[1:] + F[:-1]) / 2 * np.diff(y)))
    v = found.eigenvalue * found.vector
    assert found.work[-1] * (np.conj(v) @ s.M @ v).real / 2 == pytest.approx(work, rel=1e-5)
    fb.figures.work_loop(column, alpha=1e-3, beta=0.1, ax=ax, **own)
    loop = max(ax.lines, key=lambda line: len(line.get_xdata()))
    x, f = loop.get_xdata(), loop.get_ydata()
    area = np.sum((f[1:] + f[:-1]) / 2 * np.diff(x))
    top = np.abs(found.vector @ s.shapes(np.linspace(0, 1, 401))).max()
    assert area == pytest.approx(work / top**2, rel=1e-3)
    assert any(plain(work / top**2) in text.get_text() for text in ax.texts)


def test_what_follows_the_slope():
    found = [
        curves.follower_share(fb.Question.of(c, **own)) for c, own in ((FREE, {}), (EULER, {}), (BECK, {"eta": 0}))
    ]
    assert found == [1.0, 0.0, 0.0]
    with pytest.raises(fb.InputError, match="does not follow the slope"):
        fb.figures.work_loop(BECK, eta=0.0)


@pytest.mark.parametrize(("column", "own", "share"), [(FREE, {}, 1), (BECK, {}, 1), (BECK, {"eta": 0.5}, 0.5)])
def test_the_load_is_drawn_along_the_slope_that_it_follows(column, own, share, ax):
    ((x, y, slope),) = centre_line(column, 2000, **own)
    np.testing.assert_allclose(np.gradient(y, x)[5:-5], slope[5:-5], atol=1e-5)
    fb.figures.beam(column, ax=ax, **own)
    arrows = [text for text in ax.texts if getattr(text, "arrow_patch", None) is not None]
    (arrow,) = [text for text in arrows if to_hex(text.arrow_patch.get_edgecolor()) == look.ACCENT.lower()]
    dx, dy = np.subtract(arrow.xyann, arrow.xy)
    assert np.arctan2(dy, dx) == pytest.approx(np.arctan(share * slope[-1]), rel=1e-9)


@cache
def response():
    return fb.respond(BECK.system(4, 5.0, 1e-3), 1.0, 0.01)


@cache
def regions():
    return fb.pulse(BECK, 3, beta=0.1, load=12, frequency=np.linspace(3, 40, 75), amplitude=np.linspace(0, 0.8, 9))


GRID = np.outer([1.0, 2.0, 3.0], [10.0, 20.0])
DRAWINGS = {
    "beam": lambda f, ax: f.beam(EULER, ax=ax),
    "coalescence": lambda f, ax: f.coalescence(BECK, eta=0.9, ax=ax),
    "critical_curve": lambda f, ax: f.critical_curve(BECK, "eta", [0.0, 0.3, 0.6, 1.0], ax=ax),
    "eigenvalues": lambda f, ax: f.eigenvalues(EULER, part="real", beta=0.1, ax=ax),
    "frequency_load": lambda f, ax: f.frequency_load(EULER, ax=ax),
    "history": lambda f, ax: f.history(response(), "ddy_elastic", ax=ax),
    "mode_shape": lambda f, ax: f.mode_shape(FREE, alpha=1e-3, rigid=True, ax=ax),
    "proven_range": lambda f, ax: f.proven_range(fb.exact_range(BECK, "eta", 0, "0.01", digits=1), ax=ax),
    "pulsating_regions": lambda f, ax: f.pulsating_regions(regions(), ax=ax),
    "root_locus": lambda f, ax: f.root_locus(BECK, np.linspace(0, 30, 40), alpha=0.01, count=3, ax=ax),
    "stability_map": lambda f, ax: f.stability_map(GRID, [1, 2, 3], [1, 2], xlabel="a", ax=ax),
    "strips": lambda f, ax: f.strips(BECK, eta=0.9, ax=ax),
    "tangent": lambda f, ax: f.tangent(BECK, kappa=5.0, ax=ax),
    "trajectory": lambda f, ax: f.trajectory(response(), ax=ax),
    "work": lambda f, ax: f.work(BECK, 15.0, ax=ax),
    "work_loop": lambda f, ax: f.work_loop(BECK, ax=ax),
}


def test_every_drawing_is_tried():
    assert {*DRAWINGS, "paper", "style"} == set(fb.figures.__all__)


@pytest.mark.parametrize("name", sorted(DRAWINGS))
def test_drawings_take_axes_and_change_no_settings(name):
    before = dict(rcParams)
    axes = Figure().subplots()
    assert DRAWINGS[name](fb.figures, axes) is axes
    assert axes.has_data()
    assert dict(rcParams) == before


def test_what_is_alone_in_a_strip_is_drawn_between_its_lines(ax):
    """Dots are the beam's own eigenvalues at the critical load; each curve right of line m is between two lines."""
    fb.figures.strips(BECK, ax=ax)
    lines = [line for line in ax.lines if to_hex(line.get_color()) in (look.INK, look.MUTED.lower())]
    dots = sorted(line.get_xdata()[0] for line in lines if line.get_marker() == "o")
    places = [complex(*np.transpose(line.get_xydata())[:, 0]) ** 4 for line in lines if line.get_marker() != "o"]
    lines_at = sorted(place.real for place in places)
    assert len(lines_at) == 4
    curves = [line.get_xdata() + 1j * line.get_ydata() for line in ax.lines if line.get_color() == look.COLOURS[0]]
    assert len(curves) == 6
    for curve in curves:
        s = curve**4
        assert sum(low < s.real.min() and s.real.max() < high for low, high in itertools.pairwise(lines_at)) == 1
    found = fb.exact_load(BECK, digits=15)
    beam = fb.exact_spectrum(BECK, found.load[0][:12], modes=5, digits=8)
    wanted = sorted(float(im) ** 0.5 for _, im in beam.lower if float(im) > 0)
    assert dots == pytest.approx(wanted, abs=1e-3)


def test_a_notebooks_first_picture_leaves_it_showing_pictures():
    """The backend of a notebook turns interaction on when the first figure is made, be it within the style."""
    assert not rcParams["interactive"]
    try:
        with look.style():
            rcParams["interactive"] = True
        assert rcParams["interactive"]
    finally:
        rcParams["interactive"] = False


def test_drawings_make_axes_where_none_are_given():
    from matplotlib import pyplot

    found = fb.figures.frequency_load(BECK)
    try:
        assert isinstance(found, Axes)
        np.testing.assert_allclose(found.get_xlim()[0], 0.0)
    finally:
        pyplot.close(found.figure)


def test_a_map_is_drawn_from_an_xarray_too(ax):
    xarray = pytest.importorskip("xarray")
    alphas, betas = np.geomspace(1e-4, 1e-1, 4), np.geomspace(1e-2, 1, 3)
    loads = np.array([[fb.critical_load(BECK, alpha=a, beta=b).load for b in betas] for a in alphas])
    coords = {"alpha": alphas, "beta": betas}
    kinds = np.full(loads.shape, "flutter")
    kinds[0, 0] = "divergence"
    data = xarray.Dataset({"load": (("alpha", "beta"), loads), "kind": (("alpha", "beta"), kinds)}, coords)
    for given in (data, data["load"]):
        fb.figures.stability_map(given, ax=ax)
        assert "alpha" in ax.get_xlabel() and ax.get_xscale() == ax.get_yscale() == "log"
        lines = ax.collections[0]
        np.testing.assert_array_equal(lines.get_array().min() < loads.max(), True)
    newtons = data.copy()
    newtons["load"] = newtons["load"] * 1e5
    newtons["load"].attrs["units"] = "N"
    fb.figures.stability_map(newtons, ax=ax)
    bar = ax.figure.axes[-1]
    assert bar.get_ylabel().endswith(", MN") and loads.max() / 10 <= bar.get_ylim()[1] < 2 * loads.max() / 10
    with pytest.raises(fb.InputError, match="select two of them"):
        fb.figures.stability_map(data["load"].expand_dims("eta"))
    with pytest.raises(fb.InputError, match="no variable 'load'"):
        fb.figures.stability_map(data.drop_vars("load"))


def test_regions_are_told_apart_by_colour_and_name(ax):
    """A rectangle a point, of its kind's colour; a line at each centre of order 1, whose name no other covers."""
    found = regions()
    fb.figures.pulsating_regions(found, ax=ax, size=2.0, unit="rad/s")
    (mesh,) = ax.collections
    colours = mesh.get_facecolor().reshape(9, 75, -1) if mesh.get_array() is None else mesh.get_array()
    names = {text.get_text(): to_hex(patch.get_facecolor()) for text, patch in zip(
        ax.get_legend().get_texts(), ax.get_legend().get_patches(), strict=True)}  # fmt: skip
    assert set(names) == {"principal, period 2T", "principal, period T", "combination"}
    kinds = dict(zip(("principal, period 2T", "principal, period T", "combination"), (1, 2, 3), strict=True))
    for name, colour in names.items():
        here = found.kind.T == kinds[name]
        assert here.any() and {to_hex(c) for c in np.asarray(colours)[here][:, :3]} == {colour}
        assert (np.asarray(colours)[here][:, 3] >= 0.3).all()
    assert (np.asarray(colours)[found.kind.T == 0][:, 3] == 0).all()
    first = [centre for centre in found.centres() if centre.k == 1]
    lines = [line.get_xdata()[0] for line in ax.lines]
    for centre in first:
        assert np.min(np.abs(np.array(lines) - 2 * centre.frequency)) < 1e-9
        assert centre.label in [text.get_text() for text in ax.texts]
    places = sorted(text.get_position()[0] for text in ax.texts)
    assert min(np.diff(places)) > 0.029 * 2 * 37
    assert ax.get_xlabel().endswith("rad/s")


def test_a_map_that_is_even_shows_one_value(ax):
    """Rounding is no structure: one shade, no lines of equal load, one number, the load's, on the bar."""
    noise = np.random.default_rng(1).uniform(-1e-9, 1e-9, (6, 5))
    for unit in (9.8696, 9.8696e6, 0.0):
        fb.figures.stability_map(unit * (1 + noise), np.arange(6.0), np.arange(5.0), ax=ax)
        bar = ax.figure.axes[-1]
        shades, lines = ax.collections
        assert len(shades.get_paths()) == 1 and not any(len(path) for path in lines.get_paths())
        assert [float(tick.get_text()) for tick in bar.get_yticklabels()] == [pytest.approx(unit, rel=1e-4)]
        bar.remove()
        ax.clear()
    fb.figures.stability_map(9.8696 * (1 + 1e4 * noise), np.arange(6.0), np.arange(5.0), ax=ax)  # what labels can tell
    assert len(ax.figure.axes[-1].get_yticklabels()) > 2


def test_what_a_map_hatches_or_leaves_grey_is_explained(ax):
    xarray = pytest.importorskip("xarray")
    loads, kinds = 10.0 + np.arange(20.0).reshape(5, 4), np.full((5, 4), "divergence")

    def said(loads, kinds):
        ax.clear()
        coords = {"alpha": np.arange(5.0), "beta": np.arange(4.0)}
        both = {"load": (("alpha", "beta"), loads), "kind": (("alpha", "beta"), kinds)}
        fb.figures.stability_map(xarray.Dataset(both, coords), ax=ax)
        box = ax.get_legend()
        return [] if box is None else [text.get_text() for text in box.get_texts()]

    assert said(loads, kinds) == ["divergence"] and said(loads, np.full((5, 4), "flutter")) == []
    loads[4, 3] = np.nan
    assert said(loads, np.full((5, 4), "flutter")) == ["none found"]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda f: f.root_locus(FREE, [1.0]), "two or more finite numbers"),
        (lambda f: f.root_locus(FREE, -3.0), "loads = -3.0: must be greater than zero"),
        (lambda f: f.root_locus(FREE, count=9), "count = 9: must be a whole number, 1 to 8"),
        (lambda f: f.root_locus(FREE, 50.0, alpha=0.2, normalised=True), "use normalised=False"),
        (lambda f: f.eigenvalues(FREE, part="both"), "must be 'real' or 'imaginary'"),
        (lambda f: f.tangent(EULER), "does not flutter"),
        (lambda f: f.tangent(FREE, kappa=np.inf), "kappa = inf: must be finite"),
        (lambda f: f.coalescence(EULER), "does not flutter"),
        (lambda f: f.coalescence(FREE, width=2.0), "width = 2.0"),
        (lambda f: f.mode_shape(EULER), "does not oscillate"),
        (lambda f: f.critical_curve(FREE, "gamma", [1.0]), "is no parameter of free-free"),
        (lambda f: f.critical_curve(FREE, "alpha", [1.0], alpha=2.0), "leave it out"),
        (lambda f: f.stability_map([[1.0, 2.0]], [1, 2], [1]), r"map has shape \(1, 2\)"),
        (lambda f: f.stability_map([[1.0, 2.0]]), "x, y: are needed"),
        (lambda f: f.beam(FREE, x_s=1.5), "x_s = 1.5: must lie from 0 to 1"),
        (lambda f: f.paper(11), "figure 11: there is none"),
    ],
)
def test_bad_input_is_one_clear_line(call, message):
    with pytest.raises(fb.InputError, match=message) as caught:
        call(fb.figures)
    assert "\n" not in str(caught.value)


# --- freebeam figures ---------------------------------------------------------------------------------------


def run(capsys, *arguments):
    status = cli.main([str(a) for a in ("figures", *arguments)])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_the_command_writes_pictures_with_their_data(capsys, tmp_path):
    folder = tmp_path / "new" / "folder"
    status, out, err = run(capsys, 1, 5, 5, "--output", folder, "--format", "png", "--json")
    assert (status, err) == (0, "")
    record = json.loads(out)
    assert [found["number"] for found in record["figures"]] == [1, 5]
    assert sorted(file.name for file in folder.iterdir()) == [
        "figure-01.csv", "figure-01.png", "figure-05.csv", "figure-05.png",
    ]  # fmt: skip
    fig5 = record["figures"][1]
    assert (folder / "figure-05.png").read_bytes().startswith(b"\x89PNG")
    text = (folder / "figure-05.csv").read_text(encoding="utf-8")
    assert fig5["caption"] in text.splitlines()[0]
    data = np.genfromtxt(io.StringIO(text), delimiter=",", comments="#", usecols=(0, 1))[1:]
    assert data[-1, 0] == fig5["settings"]["beta"][1] and data[-1, 1] == fig5["marks"]["greatest_beta"]


def test_what_exists_is_kept_unless_forced(capsys, tmp_path):
    (tmp_path / "figure-01.csv").write_text("mine")
    status, out, err = run(capsys, 1, "--output", tmp_path)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1 and "figure-01.csv: exists with other content and is kept" in err
    assert [file.name for file in tmp_path.iterdir()] == ["figure-01.csv"]
    assert run(capsys, 1, "--output", tmp_path, "--force")[0] == 0
    assert (tmp_path / "figure-01.csv").read_text(encoding="utf-8").startswith("# Fig. 1.")


def test_a_folder_that_has_figures_takes_another_kind_of_picture(capsys, tmp_path):
    """The guide's order. Data that are there already stay as they are; each file that would be replaced is named."""
    assert run(capsys, 1, 5, "--output", tmp_path)[0] == 0
    before = {file: (file.read_bytes(), file.stat().st_mtime_ns) for file in tmp_path.iterdir()}
    assert run(capsys, 1, 5, "--output", tmp_path, "--format", "pdf")[0] == 0
    assert {file.name for file in tmp_path.iterdir()} - {file.name for file in before} == {
        "figure-01.pdf", "figure-05.pdf",
    }  # fmt: skip
    assert {file: (file.read_bytes(), file.stat().st_mtime_ns) for file in before} == before
    (tmp_path / "figure-01.csv").write_text("mine")
    (tmp_path / "figure-05.pdf").write_text("mine too")
    here = {file: file.read_bytes() for file in tmp_path.iterdir()}
    status, _, err = run(capsys, "--output", tmp_path, "--format", "pdf", 1, 5, 8)
    assert status == 2 and err.count("\n") == 1 and "figure-01.csv, " in err and "figure-05.pdf: exists" in err
    assert "figure-05.csv" not in err and "figure-01.pdf" not in err and "--force to replace them" in err
    assert {file: file.read_bytes() for file in tmp_path.iterdir()} == here


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((11,), "figure 11: there is none; the paper's figures are 1 to 10"),
        (("two",), "figure two: there is none"),
        ((1, "--format", "gif"), "--format gif: must be one of svg, png, pdf"),
    ],
)
def test_a_wrong_figure_or_format(capsys, tmp_path, arguments, message):
    status, out, err = run(capsys, *arguments, "--output", tmp_path / "folder")
    assert (status, out) == (2, "") and message in err and err.count("\n") == 1
    assert not (tmp_path / "folder").exists()


def test_a_folder_that_cannot_be(capsys, tmp_path):
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "file" / "below"):
        status, _, err = run(capsys, 1, "--output", folder)
        assert status == 2 and "is no folder to write to" in err and err.count("\n") == 1


def test_without_matplotlib_the_cure_is_named(capsys, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    status, _, err = run(capsys, 1, "--output", tmp_path / "folder")
    assert status == 2 and "pip install 'freebeam[pictures]'" in err and err.count("\n") == 1
    assert not (tmp_path / "folder").exists()


def test_an_interruption_leaves_no_half_a_file(capsys, tmp_path, monkeypatch):
    def interrupted(picture):
        raise KeyboardInterrupt

    monkeypatch.setattr("freebeam.figures.saving.csv_of", interrupted)
    status, _, err = run(capsys, 1, "--output", tmp_path)
    assert status == 130 and "interrupted" in err
    assert not list(tmp_path.iterdir())
