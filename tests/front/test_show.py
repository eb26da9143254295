"""Pictures of the command line: `freebeam show`, `--plot`, and what is drawn in plain text."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import freebeam as fb
from freebeam import cli
from freebeam.cli.plain_plots import HEIGHT, WIDTH, plotted
from freebeam.figures import curves
from freebeam_sym.question import Question

KINDS = {".svg": b"<?xml", ".png": b"\x89PNG", ".pdf": b"%PDF"}


def run(words: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    status = cli.main(words.split())
    told = capsys.readouterr()
    return status, told.out, told.err


def marks(lines: list[str], mark: str) -> list[tuple[float, float]]:
    """Places of a mark inside the axes, (across, down), each 0 to 1."""
    inside = [line[12:] for line in lines[1 : 1 + HEIGHT]]
    return [
        (j / (WIDTH - 1), i / (HEIGHT - 1)) for i, line in enumerate(inside) for j, c in enumerate(line) if c == mark
    ]


def test_a_mark_stands_where_its_value_is() -> None:
    """Within half a character, on axes that reach from the least to the largest value."""
    x = np.linspace(-3.0, 5.0, WIDTH)
    y = x**2
    lines = plotted([(x, y, "*")], "x", "y")
    found = marks(lines, "*")
    assert len(found) == WIDTH
    for across, down in found:
        value = (-3 + 8 * across) ** 2
        assert abs(25 * (1 - down) - value) <= 25 / (HEIGHT - 1) / 2 + 1e-9
    assert "25" in lines[1] and lines[-1].split() == ["-3", "x", "5"]
    zero = round(3 / 8 * (WIDTH - 1))
    assert {line[12 + zero] for line in lines[1:HEIGHT]} <= {"|", "*"}


def test_what_is_not_finite_is_left_out_and_what_is_constant_has_a_line() -> None:
    lines = plotted([([0.0, 1.0, 2.0], [1.0, np.nan, 1.0], "*")], "x", "y")
    assert len(marks(lines, "*")) == 2


def test_a_column_in_one_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, kind = tmp_path / "beck.png", ".png"
    status, out, err = run(f"show beck --modes 6 --json --output {file}", capsys)
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert file.read_bytes().startswith(KINDS[kind])
    assert found["load"] == fb.critical_load(fb.column("beck"), 6).load and found["kind"] == "flutter"
    before = file.read_bytes()
    assert run(f"show beck --modes 6 --output {file}", capsys)[0] == 2
    assert file.read_bytes() == before


def test_a_column_in_plain_text(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run("show euler-pinned --modes 4", capsys)
    assert (status, err) == (0, "")
    assert f"{fb.critical_load(fb.column('euler-pinned'), 4).load:.10g} by divergence" in out
    for part in (
        "frequency Im λ",
        "root locus, Im λ",
        "deflection that grows",
        "critical load from 9.875 (.) to 9.875",
    ):
        assert part in out
    lines = out.split("\n")
    first = lines.index(next(line for line in lines if line.startswith("deflection that grows")))
    height = {round(across, 2): 1 - down for across, down in marks(lines[first:], "*")}
    assert max(height, key=lambda x: height[x]) == pytest.approx(0.5, abs=0.1)  # half a sine


def test_a_column_that_is_unstable_at_the_smallest_loads(capsys: pytest.CaptureFixture[str]) -> None:
    """Under more than its critical own weight; a follower force holds it upright again."""
    words = "show beck-self-weight --set g=9 --modes 4"
    found = json.loads(run(f"{words} --json", capsys)[1])
    column = fb.column("beck-self-weight")
    values = fb.spectrum(column.system(4, 0.0, g=9.0)).eigenvalues
    assert (found["load"], found["kind"], found["grows"]["load"]) == (None, "unstable", 0.0)
    assert found["grows"]["rate"] == pytest.approx([values.real.max(), 0.0], rel=1e-9)
    status, out, err = run(words, capsys)
    assert (status, err) == (0, "")
    for part in ("none: unstable at the smallest loads", "root locus", "deflection that grows"):
        assert part in out
    locus = curves.locus(Question.of(column, 4, g=9.0), 3.0, count=2)
    assert locus.critical is None and locus.unstable[0, 0] and not locus.unstable[-1].any()
    assert (locus.eigenvalues.imag >= 0).all()


def test_a_column_that_stays_stable_is_shown_up_to_the_largest_load(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run("show beck --modes 4 --load-max 5", capsys)
    assert (status, err) == (0, "")
    assert "none up to 5" in out and "least stable motion" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("show no-such", "column 'no-such' is not known"),
        ("show beck --output beck.jpg", "beck.jpg: the name must end in .svg, .png, .pdf"),
        ("show beck --bending-stiffness 1 --mass-per-length 1 --length 1", "SI units: leave them out"),
        ("critical --column beck --plot x.gif", "x.gif: the name must end in"),
        ("spectrum --column beck --load 0 --plot x.png", "load = 0 must be above 0"),
        (
            "spectrum --column beck --load 1 --plot x.png --bending-stiffness 1 --mass-per-length 1 --length 1",
            "--plot: is",
        ),
    ],
)
def test_mistakes_are_told_in_one_line(words: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run(words, capsys)
    assert (status, out) == (2, "") and message in err and err.count("\n") == 1


@pytest.mark.parametrize(
    "words",
    [
        "critical --column beck --modes 6 --alpha 1e-3",
        "critical --column beck --modes 6 --alpha 0+ --kappa 2",
        "critical --column beck --modes 6 --load-max 5",
        "spectrum --column beck --modes 6 --load 12",
        "respond --column beck --modes 6 --load 12 --duration 1 --step 0.1 --sensor 0.5 1",
    ],
)
def test_an_answer_with_its_picture(words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The answer is that without a picture."""
    file = tmp_path / "picture.svg"
    plain = run(words, capsys)
    for kind, begin in KINDS.items() if "spectrum" in words else [(".svg", KINDS[".svg"])]:
        assert run(f"{words} --plot {file.with_suffix(kind)}", capsys) == plain and plain[0] == 0
        assert file.with_suffix(kind).read_bytes().startswith(begin)


def test_a_spectrum_has_a_line_a_pair_with_its_damping_ratio(capsys: pytest.CaptureFixture[str]) -> None:
    words = "spectrum --column beck --modes 5 --alpha 1e-2 --beta 0.1 --load 19"
    found = json.loads(run(f"{words} --json", capsys)[1])
    values = np.array([complex(*v) for v in found["eigenvalues"]])
    assert found["damping_ratio"] == pytest.approx(-values.real / np.abs(values), rel=1e-12)
    rows = [line.split() for line in run(words, capsys)[1].split("\n") if "±" in line or " 0 " in line]
    assert len(rows) == (values.imag >= 0).sum() < len(values)
    grown = [row for row in rows if "flutters" in row]
    assert len(grown) == (values.real > 0).sum() / 2 == 1
    assert float(grown[0][3]) == pytest.approx(min(found["damping_ratio"]), rel=1e-3)
    undamped = run("spectrum --column beck --modes 5 --load 15", capsys)[1]
    assert "neutral" in undamped and "decays" not in undamped
    assert "diverges" in run("spectrum --column euler-pinned --modes 5 --load 15", capsys)[1]


def test_of_a_pair_that_diverges_the_one_that_grows_is_drawn() -> None:
    found = curves.locus(Question.of(fb.column("euler-pinned"), 16), count=1)
    beyond = found.loads > np.pi**2 * (1 + 1e-9)
    assert found.unstable[beyond, 0].all() and not found.unstable[~beyond, 0].any()
    expected = np.sqrt(np.pi**2 * (found.loads[beyond] - np.pi**2))
    assert found.eigenvalues[beyond, 0].real == pytest.approx(expected, rel=1e-6)


def test_without_a_command_it_says_what_can_be_tried(capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run("", capsys)
    assert (status, err) == (0, "")
    tried = [line.split("#")[0].split()[1:] for line in out.split("Try:")[1].strip().split("\n")]
    assert len(tried) == 3
    for words in tried:  # each is a command with options that it has
        assert run(" ".join([words[0], "--help"]), capsys)[0] == 0


def test_links_have_no_shape_along_a_beam(capsys: pytest.CaptureFixture[str]) -> None:
    """A chain of links moves by its angles; nothing of it is drawn over places of a beam."""
    status, out, err = run("show ziegler", capsys)
    assert (status, err) == (0, "") and "root locus" in out and "place x" not in out
    with pytest.raises(fb.InputError, match="no field along a beam"):
        fb.figures.mode_shape(fb.column("ziegler"))
