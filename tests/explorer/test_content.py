"""What a page holds: the kernels' numbers, whatever the column's parameters, and nothing outside itself."""

import inspect
import json
import math
import re
import shlex
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.polynomial import chebyshev

import freebeam as fb
from freebeam import cli
from freebeam.explorer import page
from freebeam.explorer.content import LOAD_MAX, MODES, content
from freebeam_sym import column_names
from freebeam_sym.checks import InputError


class Kernel(SimpleNamespace):
    """A kernel of beck whose own parameter acts as a test wants it."""


def beck_with(change, low=0.0, high=1.5):
    """Beck's column with eta replaced by change(eta), which no series knows."""
    real = fb.column("beck")
    kernel = Kernel(**vars(real.kernel))
    kernel.COLUMN = {
        **real.kernel.COLUMN,
        "parameters": [{**real.kernel.COLUMN["parameters"][0], "low": low, "high": high}],
    }
    kernel.stiffness_load = lambda basis, rigid=False, *, eta=1.0: real.kernel.stiffness_load(
        basis, rigid, eta=change(eta)
    )
    kernel.forms = lambda one=1, *, eta=1.0: real.kernel.forms(one, eta=change(eta))
    return fb.Column(kernel)


def evaluated(held, own):
    """M, E, H, c_M, c_E coefficients and loads from the page's series, by NumPy."""
    weights = np.ones(1)
    for parameter, degree in zip(held["parameters"], held["degrees"], strict=True):
        low, high = parameter["low"], parameter["high"]
        u = (2 * own[parameter["name"]] - low - high) / (high - low)
        weights = np.outer(weights, chebyshev.chebvander(np.array(u), degree)).ravel()
    return weights @ np.array(held["series"])


@pytest.mark.parametrize("basis", [None, "legendre"])
@pytest.mark.parametrize("name", column_names())
def test_series_give_the_kernels_matrices(name, basis):
    column = fb.column(name, basis)
    held = content(column)
    for share in (0.0, 0.37, 1.0):
        own = {p.name: p.low + share * (p.high - p.low) for p in column.parameters}
        found = evaluated(held, own)
        for k, matrix in enumerate(column.matrices(MODES, **own)):
            part = found[k * MODES**2 : (k + 1) * MODES**2].reshape(MODES, MODES)
            assert np.abs(part - matrix).max() <= 4e-15 * np.abs(matrix).max()


def test_leading_blocks_are_the_matrices_of_fewer_functions():
    for basis in (None, "legendre"):
        column = fb.column("free-free", basis)
        for whole, block in zip(column.matrices(MODES), column.matrices(5), strict=True):
            assert np.abs(whole[:5, :5] - block).max() <= 1e-14 * np.abs(block).max()


def test_dependence_on_a_parameter_is_found_not_assumed():
    """Affine: two terms; quadratic: three; transcendental: as many as it takes, exact to rounding."""
    assert content(fb.column("beck"))["degrees"] == [1]
    assert content(beck_with(lambda eta: eta**2))["degrees"] == [2]
    column = beck_with(math.sin)
    held = content(column)
    assert held["degrees"][0] > 4
    H = column.matrices(MODES, eta=0.813)[2]
    found = evaluated(held, {"eta": 0.813})[2 * MODES**2 : 3 * MODES**2].reshape(MODES, MODES)
    assert np.abs(found - H).max() <= 1e-13 * np.abs(H).max()


def test_dependence_that_no_series_holds_is_refused():
    with pytest.raises(InputError, match="eta: the column depends on it"):
        content(beck_with(lambda eta: abs(eta - 0.7)))


def test_shapes_are_the_kernels():
    for basis in (None, "legendre"):
        column = fb.column("free-free", basis)
        x = np.linspace(0, 1, 57)
        found = chebyshev.chebval(2 * x - 1, np.array(content(column)["shapes"]).T)
        exact = column.kernel.shapes(column.basis(MODES), x)
        assert np.abs(found - exact).max() <= 1e-12 * np.abs(exact).max()


@pytest.mark.parametrize("name", column_names())
def test_loads_are_those_of_the_equation_of_motion(name):
    """The axial force is the factor of y″; what follows the end is what the end's shear condition leaves over."""
    column = fb.column(name)
    held = content(column)
    terms = held["axial_terms"]
    own = {p.name: 0.6 for p in column.parameters}
    ends, axial = np.split(evaluated(held, own)[3 * MODES**2 + 6 :][: 2 + terms], [2])
    coefficients = column.kernel.equation(1.0, **own)[2, 0]
    assert axial == pytest.approx([*coefficients, *[0.0] * (terms - len(coefficients))], abs=1e-13)
    shear = next((c for c in column.kernel.end_conditions(1.0, **own)[1] if (3, 0) in c), None)
    if shear is not None:  # y‴ + (N − c) y′ = 0 at a free end under the axial force N and the follower's share c
        assert shear.get((1, 0), 0) / shear[3, 0] == pytest.approx(axial.sum() - ends[1], abs=1e-13)


class References(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.found += [value for name, value in attrs if name in ("src", "href", "srcset", "data", "action", "poster")]
        assert tag not in ("link", "iframe", "object", "embed", "base")


def test_a_page_is_one_file():
    text = page(fb.column("free-free"))
    references = References()
    references.feed(text)
    assert references.found == []
    assert not re.search(r"@import|url\(", text)
    assert len(text.encode()) < 3e6
    assert not re.search(r"@[A-Z]+@", text)
    assert text.count("MIT License") == 2 and "Copyright (c) 2014" in text


def test_html_is_well_formed():
    html5lib = pytest.importorskip("html5lib")
    parser = html5lib.HTMLParser(strict=True)
    parser.parse(page(fb.column("beck")))


def test_words_of_a_column_cannot_break_the_page(monkeypatch):
    real = fb.column("beck")
    kernel = Kernel(**vars(real.kernel))
    kernel.COLUMN = {**real.kernel.COLUMN, "title": "</script><script>alert(1)</script> & @COLUMN@ <!--"}
    text = page(fb.Column(kernel))
    assert "<script>alert" not in text
    held = re.search(r'<script type="application/json" id="column">(.*?)</script>', text, re.DOTALL)
    assert json.loads(held[1])["title"] == kernel.COLUMN["title"]


def test_a_users_column_is_named_by_its_file(own_column, tmp_path, capsys):
    file = tmp_path / "own.html"
    assert cli.main(["explore", "--column", own_column, "--output", str(file)]) == 0
    capsys.readouterr()
    held = re.search(r'<script type="application/json" id="column">(.*?)</script>', file.read_text(), re.DOTALL)
    assert shlex.split(json.loads(held[1])["given"]) == [own_column]


def test_command(tmp_path, capsys):
    file = tmp_path / "beck.html"
    assert cli.main(["explore", "--column", "beck", "--output", str(file), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said == {"output": str(file), "column": "beck", "basis": "legendre", "bytes": file.stat().st_size}
    kept = file.read_bytes()
    assert cli.main(["explore", "--output", str(file)]) == 2
    assert "--force" in capsys.readouterr().err and file.read_bytes() == kept
    assert cli.main(["explore", "--basis", "legendre", "--output", str(file), "--force"]) == 0
    assert file.read_bytes() != kept
    assert cli.main(["explore", "--help"]) == 0
    assert "Example: freebeam explore" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["--column", "becks", "--output", "a.html"], "did you mean beck"),
        (["--basis", "fourier", "--output", "a.html"], "modes, legendre"),
        (["--output", "a.pdf"], "must end in .html"),
        (["--output", "nowhere/a.html"], "cannot be written"),
        ([], "--output"),
    ],
)
def test_bad_input_is_one_line(arguments, said, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["explore", *arguments]) == 2
    line = capsys.readouterr().err
    assert said in line and line.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_limits_are_those_of_the_runtime():
    assert LOAD_MAX == inspect.signature(fb.critical_load).parameters["load_max"].default
    assert content(fb.column("beck"))["load_max"] == LOAD_MAX
