"""What a page holds: the column's emitted kernel, and nothing outside itself."""

import inspect
import json
import re
import shlex
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import pytest

import freebeam as fb
from freebeam import cli
from freebeam.explorer import kernel_of, page
from freebeam.explorer.content import LOAD_MAX, content
from freebeam_derive import emit
from freebeam_sym.checks import InputError


def test_a_kernel_without_its_statement_is_refused(tmp_path):
    """A page runs what is emitted from the statement."""
    file = tmp_path / "alone.py"
    file.write_text(Path(fb.column("beck", "modes").kernel.__file__).read_text(encoding="utf-8"))
    with pytest.raises(InputError, match=r"alone\.py: a page runs the column's kernel in JavaScript"):
        page(fb.column(file))


def test_no_word_of_a_statement_ends_the_kernels_script(monkeypatch):
    hostile = "</script><!-- <script>alert(1)"
    true = emit.files
    monkeypatch.setattr(emit, "files", lambda *given: {k: f"/* {hostile} */\n{v}" for k, v in true(*given).items()})
    text = kernel_of(fb.column("beck"))
    assert "alert(1)" in text and "</script" not in text and "<!--" not in text


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
    kernel = SimpleNamespace(**vars(real.kernel))
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
