"""The explorer: one page, with no server and no connection, in which a column can be played with.

The page holds the column's kernel in JavaScript, emitted from the same graph as the NumPy one, and computes in the
browser what the runtime computes here; see `content.py` for what else it is given, and `script/` for its parts, which
are joined as they are.
"""

from __future__ import annotations

import html
import json
import re
import shlex
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from freebeam.explorer.content import LOAD_MAX, content
from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from freebeam_sym.columns import Column

__all__ = ["page"]

NUMERICS = ("pencil", "search", "branches", "map", "analysis", "worker")
"""Scripts that compute, in the page and in its worker."""
PAGE = ("motion", "words", "state", "controls", "colours", "beam", "plots", "mapplot", "app")
"""Scripts that show."""


def page(column: Column, given: str = "") -> str:
    """The page of a column, as HTML that refers to nothing outside itself.

    given: what a command takes for the column, such as the path of its file; its name where that is enough.
    Raises InputError where the column is not stable without load, and for a kernel whose statement is not at hand.
    """
    held = content(column) | {"given": shlex.quote(given or column.name)}
    title = html.escape(column.title)
    parts = {
        "TITLE": title,
        "SUBTITLE": html.escape(f"Column {column.name} · ends {', '.join(column.ends)}"),
        "BASIS": column.basis_name,
        "FORMS": html.escape("; ".join(f"{name}: {form}" for name, form in column.kernel.COLUMN["forms"].items())),
        "LOADMAX": f"{LOAD_MAX:g}",
        "KEY": _key("mode"),
        "BRANCHKEY": _key("branch"),
        "RIGIDNOTE": _rigid_note(column.rigid_count),
        "STYLE": _style(),
        # a "<" could end the element that the numbers stand in
        "COLUMN": json.dumps(held, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        "ALGEBRA": _library("ml-matrix"),
        "PLOTTING": _library("uPlot"),
        "KERNEL": kernel_of(column),
        "NUMERICS": _scripts(NUMERICS),
        "PAGE": _scripts(PAGE),
    }
    return re.sub("@([A-Z]+)@", lambda found: parts[found[1]], _text("page.html"))


def kernel_of(column: Column) -> str:
    """The column's emitted JavaScript module as a plain script that makes an object `kernel` of what it exports.

    Raises InputError for a column of which only an emitted kernel is at hand.
    """
    from freebeam_derive import emit, pipeline
    from freebeam_derive.statement import StatementError
    from freebeam_sym.kernels import is_kernel, read_source

    target: str | Path = column.name
    if not column.kernel.__name__.startswith("freebeam_kernels."):
        if column.path is None or is_kernel(read_source(column.path)[1]):
            raise InputError(
                f"{column.path or column.name}: a page runs the column's kernel in JavaScript, which is emitted from "
                "its statement; give the file of the statement"
            )
        target = column.path
    try:
        kernel = pipeline.kernels(pipeline.find(target), [column.basis_name])[column.basis_name]
        (text,) = emit.files(kernel, "javascript", kernel.column.module).values()
    except StatementError as error:
        raise InputError(str(error)) from error
    names = re.findall(r"^export (?:function|const) (\w+)", text, re.MULTILINE)
    script = re.sub(r"^export ", "", text, flags=re.MULTILINE)
    # a comment could end the element that the script stands in
    script = script.replace("</", "<\\/").replace("<!--", "<\\!--")
    return f"const kernel = (() => {{\n{script}return {{ {', '.join(names)} }};\n}})();"


def _text(name: str) -> str:
    return files("freebeam.explorer").joinpath(name).read_text(encoding="utf-8")


def _scripts(names: tuple[str, ...]) -> str:
    return "\n".join(_text(f"script/{name}.js") for name in names)


def _library(name: str) -> str:
    """A library with its licence, which goes where it goes."""
    return f"/*\n{_text(f'libraries/{name}.LICENSE')}*/\n{_text(f'libraries/{name}.js')}"


def _style() -> str:
    """The style, with the colour scale of the map as the script has it."""
    numbers = re.search(r"CIVIDIS = (\[.*?\]);", _text("script/colours.js"), re.DOTALL)
    assert numbers is not None
    found: list[list[int]] = json.loads(re.sub(r",(\s*\])", r"\1", numbers[1]))
    scale = ", ".join(f"rgb({r} {g} {b})" for r, g, b in found)
    return _text("libraries/uPlot.css") + _text("page.css").replace("@CIVIDIS@", scale)


def _key(what: str) -> str:
    """Colours of the lines in a plot."""
    lines = "".join(f'<span><i style="background: var(--mode-{k})"></i>{what} {k}</span> ' for k in range(1, 5))
    return f'<span class="key">{lines}</span>'


def _rigid_note(rigid: int) -> str:
    return " Elastic part; the rigid motion of this beam drifts at any load." if rigid else ""
