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
from collections.abc import Callable, Iterable
from importlib.resources import files
from typing import TYPE_CHECKING

from freebeam.explorer.content import LOAD_MAX, content, statement_of
from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from freebeam_sym.columns import Column

__all__ = ["page", "site"]

NUMERICS = (
    "pencil", "search", "massless", "general", "losses", "problem", "branches", "motion", "response", "map", "analysis",
    "worker",
)  # fmt: skip
"""Scripts that compute, in the page and in its worker."""
PAGE = ("units", "words", "state", "controls", "colours", "beam", "plots", "mapplot", "showing", "wiring", "app")
"""Scripts that show."""
SHARED = "explorer.js"
"""What the pages of a site share, beside the style."""


def page(column: Column, given: str = "") -> str:
    """The page of a column, as HTML that refers to nothing outside itself.

    given: what a command takes for the column, such as the path of its file; its name where that is enough.
    Raises InputError for a column of too many coordinates, and for a kernel whose statement is not at hand.
    """
    scripts = "\n".join(f'<script id="{name}">\n{text}\n</script>' for name, text in _shared_scripts().items())
    return _page(column, given, f"<style>\n{_style()}\n</style>", scripts)


def site(columns: Iterable[Column], on_progress: Callable[[str], None] = lambda name: None) -> dict[str, str]:
    """Pages of several columns by the names of their files, with the script and the style that they share, once.

    They stand in one folder, and work from files and without a connection. Raises InputError as `page` does.
    """
    # the texts become scripts of the page, so that the worker finds them there
    made = "\n".join(
        (
            f"const texts = {json.dumps(_shared_scripts())};",
            "for (const [id, text] of Object.entries(texts)) {",
            "  document.body.append(Object.assign(document.createElement('script'), { id, textContent: text }));",
            "}",
        )
    )
    found = {SHARED: f"(() => {{\n{made}\n}})();\n", "explorer.css": _style()}
    style = '<link rel="stylesheet" href="explorer.css">'
    for column in columns:
        on_progress(column.name)
        found[f"{column.name}.html"] = _page(column, "", style, f'<script src="{SHARED}"></script>')
    return found


def _page(column: Column, given: str, style: str, scripts: str) -> str:
    if column.kernel.COLUMN.get("circulatory"):
        raise InputError(
            f"{column.name}: a damping that acts on displacements is not drawn in a page; ask with `freebeam critical`"
        )
    held = content(column) | {"given": shlex.quote(given or column.name)}
    title = html.escape(column.title)
    ends = f" · ends {', '.join(column.ends)}" if column.ends else ""
    units = ", or in SI units" if held["si"] else ""
    parts = {
        "TITLE": title,
        "SUBTITLE": html.escape(f"Column {column.name}{ends} · nondimensional{units}"),
        "BASIS": column.basis_name,
        "FORMS": html.escape(_forms(column)),
        "LOADMAX": f"{LOAD_MAX:g}",
        "KEY": _key("mode"),
        "BRANCHKEY": _key("branch"),
        "RIGIDNOTE": _rigid_note(column.rigid_count),
        "BARE": "Without α and β" if column.general else "Undamped",
        "LOADNOTE": _load_note(held["drawn"], held["links"]),
        "SEARCHNOTE": _search_note(column),
        "STYLE": style,
        # a "<" could end the element that the numbers stand in
        "COLUMN": json.dumps(held, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        "SCRIPTS": scripts,
        "KERNEL": kernel_of(column),
    }
    return re.sub("@([A-Z]+)@", lambda found: parts[found[1]], _text("page.html"))


def kernel_of(column: Column) -> str:
    """The column's emitted JavaScript module as a plain script that makes an object `kernel` of what it exports.

    Raises InputError for a column of which only an emitted kernel is at hand.
    """
    from freebeam_derive import emit, pipeline
    from freebeam_derive.statement import StatementError

    statement = statement_of(column)
    try:
        kernel = pipeline.kernels(statement, [column.basis_name])[column.basis_name]
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
    return '"use strict";\n' + "\n".join(_text(f"script/{name}.js") for name in names)


def _shared_scripts() -> dict[str, str]:
    """Everything that runs in a page but the column's kernel, by the names of its elements."""
    return {
        "algebra": _library("ml-matrix"),
        "plotting": _library("uPlot"),
        "numerics": _scripts(NUMERICS),
        "showing": _scripts(PAGE),
    }


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


def _forms(column: Column) -> str:
    if not column.general:
        return "; ".join(f"{name}: {form}" for name, form in column.kernel.COLUMN["forms"].items())
    return "M, C and K by powers of P, in polynomials on segments"


def _rigid_note(rigid: int) -> str:
    return " Elastic part; the rigid motion of this beam drifts at any load." if rigid else ""


def _load_note(drawn: dict[str, object], links: int) -> str:
    if links:
        return "Drawn as a chain of equal links, one for each coordinate, with a force along the last."
    if drawn["flow"]:
        return "The load is a flow along the column and is not drawn."
    if drawn["sensors"]:
        return "The arrow is the load; the angle that the sensor sets is not drawn."
    return "The arrow is the load as it acts: what follows the beam turns with its slope, a dead load does not."


def _search_note(column: Column) -> str:
    if not column.general:
        return ""
    return (
        " Divergences are the roots of det K(P). Flutter is looked for by eigenvalues at loads in steps, 16 up to the "
        "least |P| of these roots and then of 4 %: what begins and ends within a step is not seen. In the map steps "
        "are twice as long, and most points are followed from their neighbours: that nothing grows is then counted at "
        "50, 80 and 99.9 % of the load, and that something does just above it."
    )
