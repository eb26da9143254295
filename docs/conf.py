"""The documentation's settings. `make docs` makes the pictures, lessons and pages that it shows, then builds it."""

from __future__ import annotations

import re
from importlib.metadata import version as installed
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

from freebeam.lesson.mathematics import mathml

project = "freebeam"
copyright = "2026, the freebeam developers"
author = "the freebeam developers"
release = version = installed("freebeam")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinx_design",
]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
smartquotes_action = "qe"  # options keep their two hyphens
exclude_patterns = ["made/**"]
# Two classes are called Column, a statement and what the runtime makes of it.
suppress_warnings = ["ref.python"]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_use_legacy_class_based = True
python_use_unqualified_type_names = True

html_theme = "furo"
html_title = "freebeam"
html_static_path = ["style", "../front/freebeam/lesson/font"]
html_css_files = ["site.css"]
html_extra_path = ["made"]
html_math_renderer = "mathml"
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b5394", "color-brand-content": "#0b5394"},
    "dark_css_variables": {"color-brand-primary": "#8ab8e6", "color-brand-content": "#8ab8e6"},
}
copybutton_prompt_text = r">>> |\$ "
copybutton_prompt_is_regexp = True


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    translator.body.append(f'<div class="math">{mathml(node.astext(), True)}</div>')
    raise nodes.SkipNode


def _prose(text: str) -> str:
    """Plain prose as reStructuredText: names in backticks are code, all else is said as it stands."""
    parts = text.split("`")
    parts[::2] = [re.sub(r"([*|_\\])", r"\\\1", part) for part in parts[::2]]
    return "``".join(parts)


def _docstring(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]) -> None:
    """Docstrings are plain text: paragraphs, indented blocks that stay as they are, items with indented ends."""
    made: list[str] = []
    for paragraph in "\n".join(lines).strip("\n").split("\n\n"):
        rows = paragraph.split("\n")
        indented = [row.startswith(" ") for row in rows]
        if rows[0].startswith(">>>"):
            made += [*rows, ""]
        elif all(indented):
            made += ["::", "", *(f"    {row}" for row in rows), ""]
        elif any(indented):
            items = re.sub(r"\n +", " ", paragraph).split("\n")
            made += [*(f"- {_prose(item)}" for item in items), ""]
        else:
            made += [_prose(paragraph.replace("\n", " ")), ""]
    lines[:] = made


def _commands(app: Sphinx, page: str, source: list[str]) -> None:
    """The command line's reference: what each command says of itself."""
    if page != "reference/command-line":
        return
    import typer.main

    from freebeam.cli.application import app as freebeam

    group = typer.main.get_command(freebeam)
    for name in group.list_commands(None):
        command = group.commands[name]
        source[0] += f"\n## freebeam {name}\n\n{command.help}\n\n"
        source[0] += f"```console\n$ {command.epilog.removeprefix('Example: ')}\n```\n\n"
        rows = []
        for option in command.params:
            if getattr(option, "hidden", False) or option.name == "help":
                continue
            names = ", ".join(f"`{spelling}`" for spelling in option.opts) if option.param_type_name == "option" else ""
            what = option.metavar if not getattr(option, "is_flag", False) else None
            default = option.default
            plain = isinstance(default, (str, int, float)) and not isinstance(default, bool)
            said = (getattr(option, "help", None) or "") + (f" Default: `{default}`." if plain else "")
            told = f"`{what}`".replace("|", r"\|") if what else ""
            rows.append(f"| {names} {told} | {said} |")
        source[0] += "\n".join(["| option | |", "|---|---|", *rows, ""])


def setup(app: Sphinx) -> None:
    app.connect("source-read", _commands)
    app.connect("autodoc-process-docstring", _docstring)
    # MathML is read by every browser without a script or a network.
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))
