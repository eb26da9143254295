"""The lesson as LaTeX for any installation: amsmath, amssymb, graphicx, hyperref; its drawings are PDFs beside it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import ClassVar

from freebeam.lesson import blocks
from freebeam.lesson.phrases import text
from freebeam.lesson.writer import Writer

__all__ = ["files"]

_ESCAPES = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "“": "``", "”": "''", "—": "---", "…": r"\dots{}",
    "`": r"\textasciigrave{}",
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
    return "".join(parts)


def files(lesson: blocks.Lesson, output: Path) -> dict[Path, bytes]:
    """The source, and its drawings in a folder named after it."""
    page = _Page(output.with_name(f"{output.stem}_files"))
    body = page.joined(lesson.blocks)
    if page.proofs:
        items = "\n".join(rf"\item {proof}" for proof in page.proofs)
        body += (
            rf"\section{{{text('proof.appendix')}}}{text('proof.listed')}{{\small\begin{{enumerate}}"
            + f"\n{items}\n\\end{{enumerate}}}}"
        )
    return {output: page.filled("page.tex", lesson, body=body).encode(), **page.pictures}


class _Page(Writer):
    spans: ClassVar = {
        "text": text_of,
        "math": "${}$".format,
        "display": lambda piece: rf"\[\fitted{{{piece.strip()}}}\]",
        "code": lambda piece: rf"\texttt{{{text_of(piece)}}}",
        "strong": r"\textbf{{{}}}".format,
        "emphasis": r"\emph{{{}}}".format,
    }

    def heading(self, block: blocks.Heading) -> str:
        return rf"\{'section' if block.level == 2 else 'subsection'}{{{self.inline(block.text)}}}"

    def equation(self, block: blocks.Equation) -> str:
        tag = rf"\tag{{{block.number}}}" if block.number else ""
        latex = block.latex.replace("{split}", "{aligned}")  # split may not stand in a box
        if "pmatrix" in latex:  # whose fractions would be small
            latex = latex.replace(r"\frac", r"\dfrac").replace(r"\\", r"\\[4pt] ")
        return rf"\begin{{equation*}}\fitted{{{latex}}}{tag}\end{{equation*}}"

    def check(self, block: blocks.Check) -> str:
        return rf"{{\small $\checkmark$ \emph{{{text('proof.title')} {self.noted(block)}}}\par}}"

    def folded(self, block: blocks.Folded) -> str:
        return rf"{{\small \emph{{{self.inline(block.summary)}}}" + f"\n\n{self.joined(block.blocks)}\\par}}"

    def erratum(self, block: blocks.Erratum) -> str:
        title = rf"\textbf{{Erratum of the paper.}} \textbf{{{self.inline(block.title)}}}"
        inner = "\n\n".join([title, *map(self.inline, block.paragraphs)])
        return rf"\begin{{quote}}{inner}" + "\n\\end{quote}"

    def figure(self, block: blocks.Figure) -> str:
        path = f"{self.folder.name}/{self.picture(block, 'pdf').name}"
        title = rf"\textbf{{Figure {self.count['figure']}. {self.inline(block.title)}.}}"
        return (
            rf"\begin{{center}}\includegraphics[width=0.85\linewidth]{{{path}}}\\"
            f"\n{{\\small {title} {self.inline(block.caption)}}}\\end{{center}}"
        )

    def table(self, block: blocks.Table) -> str:
        head, *rows = (" & ".join(map(self.inline, row)) for row in (block.header, *block.rows))
        body = "\\\\\n".join(rows)
        return (
            rf"\begin{{center}}\small\begin{{tabular}}{{{'l' * len(block.header)}}}\hline {head}\\\hline"
            f"\n{body}\\\\\\hline\\end{{tabular}}\\end{{center}}"
        )

    def exercise(self, block: blocks.Exercise) -> str:
        question = rf"\textbf{{Exercise {self.count['exercise']}.}} {self.inline(block.question)}"
        answer = f"\n\n{{\\small \\emph{{Answer.}} {self.inline(block.answer)}\\par}}"
        return question + (answer if block.answer else "")

    def summary(self, block: blocks.Summary) -> str:
        return rf"\textbf{{In short.}} {self.inline(block.text)}"

    def points(self, block: blocks.Points) -> str:
        items = "\n".join(rf"\item {self.inline(item)}" for item in block.items)
        return rf"\textbf{{{self.inline(block.title)}}}" + f"\n\\begin{{itemize}}\n{items}\n\\end{{itemize}}"

    def listing(self, block: blocks.Listing) -> str:
        return "{\\scriptsize\n\\begin{verbatim}\n" + _ascii(block.code) + "\n\\end{verbatim}}"


def _ascii(code: str) -> str:
    """Source as it is, with what a plain LaTeX cannot set verbatim left out, and what would end it apart."""
    code = "\n".join(line if len(line) <= 100 else line[:100] + "\n        " + line[100:] for line in code.split("\n"))
    return code.replace(r"\end{verbatim}", r"\end {verbatim}").encode("ascii", "replace").decode()
