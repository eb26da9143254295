"""The lesson as LaTeX for any installation: amsmath, amssymb, graphicx and hyperref; its drawings are PDFs beside "
"it."""

from __future__ import annotations

import re
from pathlib import Path

from freebeam_sym.lesson.blocks import (
    Block,
    Cell,
    Check,
    Equation,
    Erratum,
    Exercise,
    Figure,
    Folded,
    Heading,
    Lesson,
    Listing,
    Prose,
    Table,
    spans,
)
from freebeam_sym.lesson.pictures import image

__all__ = ["files"]

_ESCAPES = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "“": "``", "”": "''", "—": "---", "…": r"\dots{}",
}  # fmt: skip
_LETTERS = {
    "α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "ε": "varepsilon", "η": "eta", "κ": "kappa", "λ": "lambda",
    "μ": "mu", "ξ": "xi", "π": "pi", "ρ": "rho", "σ": "sigma", "φ": "varphi", "χ": "chi", "ψ": "psi", "ω": "omega",
    "Ψ": "Psi", "Φ": "Phi", "Ω": "Omega", "Δ": "Delta", "Σ": "Sigma", "∫": "int", "∂": "partial", "≥": "ge", "≤": "le",
    "≠": "ne", "±": "pm", "×": "times", "→": "to", "∞": "infty", "·": "cdot", "≈": "approx",
}  # fmt: skip
_SCRIPTS = {
    **{c: f"^{{{k}}}" for k, c in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")}, **{c: f"_{{{k}}}" for k, c in enumerate("₀₁₂₃₄₅₆₇₈₉")},
    "⁻": "^{-}", "ᵀ": r"^{\mathsf{T}}", "ᵢ": "_{i}", "ⱼ": "_{j}", "′": "^{\\prime}", "″": "^{\\prime\\prime}",
    "‴": "^{\\prime\\prime\\prime}", "−": "-", "½": r"\tfrac{1}{2}", "¼": r"\tfrac{1}{4}",
}  # fmt: skip


def text_of(text: str) -> str:
    """Plain text as LaTeX; letters that ASCII lacks as mathematics, one run at a time."""
    marks = {**{c: rf"\{name} " for c, name in _LETTERS.items()}, **_SCRIPTS}
    runs = re.split(f"([{re.escape(''.join(marks))}]+)", text)
    parts = []
    for run in runs:
        if run and run[0] in marks:
            found = re.sub(r"\}\^\{", "", "".join(marks[c] for c in run))
            parts.append(f"${found.strip()}$")
        else:
            parts.append("".join(_ESCAPES.get(c, c) for c in run))
    return "".join(parts).replace("$$", "")


def inline(text: str) -> str:
    """Text with its marks as LaTeX."""
    commands = {"strong": "textbf", "emphasis": "emph"}
    parts = []
    for kind, piece in spans(text):
        if kind == "math":
            parts.append(f"${piece}$")
        elif kind == "display":
            parts.append(rf"\[\fitted{{{piece.strip()}}}\]")
        elif kind == "code":
            parts.append(rf"\texttt{{{text_of(piece)}}}")
        elif kind == "text":
            parts.append(text_of(piece))
        else:
            parts.append(rf"\{commands[kind]}{{{inline(piece)}}}")
    return "".join(parts)


def files(lesson: Lesson, output: Path) -> dict[Path, bytes]:
    """The source, and its drawings in a folder named after it."""
    folder = output.with_name(f"{output.stem}_files")
    page = _Page(folder)
    body = "\n\n".join(page.blocks(lesson.blocks))
    text = rf"""\documentclass[11pt,a4paper]{{article}}
\usepackage[utf8]{{inputenc}}
\usepackage[T1]{{fontenc}}
\usepackage{{amsmath,amssymb,graphicx}}
\usepackage[hidelinks]{{hyperref}}
\allowdisplaybreaks
\setlength{{\parindent}}{{0pt}}
\setlength{{\parskip}}{{0.6em}}
\emergencystretch=3em
% a formula that is wider than the text is shrunk to it
\newsavebox{{\formula}}
\newcommand{{\fitted}}[1]{{\sbox{{\formula}}{{$\displaystyle #1$}}%
  \ifdim\wd\formula>0.9\linewidth\resizebox{{0.9\linewidth}}{{!}}{{\usebox{{\formula}}}}\else\usebox{{\formula}}\fi}}
\title{{{inline(lesson.title)}}}
\author{{}}
\date{{{inline(lesson.subtitle)}}}
\begin{{document}}
\maketitle
\tableofcontents

{body}
\end{{document}}
"""
    return {output: text.encode(), **page.pictures}


class _Page:
    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.pictures: dict[Path, bytes] = {}
        self.exercises = self.figures = 0

    def blocks(self, blocks: tuple[Block, ...]) -> list[str]:
        return [text for block in blocks if (text := self.block(block))]

    def block(self, block: Block) -> str:
        match block:
            case Heading():
                return rf"\{'section' if block.level == 2 else 'subsection'}{{{inline(block.text)}}}"
            case Prose():
                return inline(block.text)
            case Equation():
                tag = rf"\tag{{{block.number}}}" if block.number else ""
                latex = block.latex.replace("{split}", "{aligned}")  # split may not stand in a box
                return rf"\begin{{equation*}}\fitted{{{latex}}}{tag}\end{{equation*}}"
            case Check():
                left = f"{block.residual:.0e}" if block.residual else "nothing"
                return rf"{{\small $\checkmark$ \emph{{checked:}} {inline(block.text)}; leaves {left}\par}}"
            case Folded():
                inner = "\n\n".join(self.blocks(block.blocks))
                return rf"{{\small \emph{{{inline(block.summary)}}}" + f"\n\n{inner}\\par}}"
            case Erratum():
                inner = "\n\n".join(inline(p) for p in block.paragraphs)
                return (
                    r"\begin{quote}\textbf{Erratum of the paper.} " + rf"\textbf{{{inline(block.title)}}}"
                    f"\n\n{inner}\n\\end{{quote}}"
                )
            case Figure():
                self.figures += 1
                path = self.folder / f"{block.key}.pdf"
                self.pictures[path] = image(block, "pdf")
                caption = (
                    rf"{{\small \textbf{{Figure {self.figures}. {inline(block.title)}.}} {inline(block.caption)}}}"
                )
                return (
                    rf"\begin{{center}}\includegraphics[width=0.85\linewidth]{{{self.folder.name}/{path.name}}}\\"
                    f"\n{caption}\\end{{center}}"
                )
            case Table():
                columns = "l" * len(block.header)
                head = " & ".join(inline(cell) for cell in block.header)
                rows = "\\\\\n".join(" & ".join(inline(cell) for cell in row) for row in block.rows)
                return (
                    rf"\begin{{center}}\small\begin{{tabular}}{{{columns}}}\hline {head}\\\hline"
                    f"\n{rows}\\\\\\hline\\end{{tabular}}\\end{{center}}"
                )
            case Exercise():
                self.exercises += 1
                return (
                    rf"\textbf{{Exercise {self.exercises}.}} {inline(block.question)}"
                    f"\n\n{{\\small \\emph{{Answer.}} {inline(block.answer)}\\par}}"
                )
            case Listing():
                return "{\\scriptsize\n\\begin{verbatim}\n" + _ascii(block.code) + "\n\\end{verbatim}}"
            case Cell():
                return "\n\n".join(self.blocks(block.blocks))


def _ascii(code: str) -> str:
    """Source as it is, with what a plain LaTeX cannot set verbatim left out."""
    code = "\n".join(line if len(line) <= 100 else line[:100] + "\n        " + line[100:] for line in code.split("\n"))
    return code.encode("ascii", "replace").decode()
