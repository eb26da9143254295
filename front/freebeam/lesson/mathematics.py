"""LaTeX as MathML, and that as Typst: the one language of the lesson's mathematics in the others."""

from __future__ import annotations

import re
from functools import lru_cache
from xml.etree import ElementTree

from freebeam_sym.checks import InputError

__all__ = ["mathml", "typst", "width"]

_FUNCTIONS = {"sin", "cos", "sinh", "cosh", "ln", "det"}
_PRIMES = {"′": 1, "″": 2, "‴": 3, "⁗": 4}
"""Signs for so many primes; each is written for itself, because ‴ and ⁗ can hardly be told apart."""
_PRIME = {"lspace": "0", "rspace": "0", "class": "prime"}


@lru_cache(maxsize=4096)
def mathml(latex: str, block: bool = False) -> str:
    """MathML of a formula, without a namespace, as HTML has it. Raises InputError without latex2mathml."""
    try:
        from latex2mathml.converter import convert_to_element
    except ImportError:
        raise InputError("lessons need latex2mathml, which is not installed: pip install 'freebeam[lesson]'") from None
    # of primes over a letter with an index latex2mathml raises all but the first once more
    latex = re.sub(r"(_(?:\w|{\w+}))('{2,})(?!\^)", lambda m: m[1] + "^{" + r"\prime" * len(m[2]) + "}", latex)
    root = convert_to_element(latex, display="block" if block else "inline")
    for parent in root.iter():
        if parent.tag == "mtable" and parent.get("columnspacing") != "0em":
            parent.set("displaystyle", "true")  # fractions in a matrix are as large as outside
        if parent.tag == "mi" and re.fullmatch("&#x0*[0-7][0-9A-F];", parent.text or ""):
            parent.set("mathvariant", "normal")  # a single letter in roman, which a browser would slant
        primes = "".join(_text(child) for child in parent if child.tag == "mi" and _text(child) in _PRIMES)
        if primes and len(primes) == len(parent):
            for child in list(parent):
                parent.remove(child)
            parent.tag, parent.text = "mi", primes
        if parent.tag == "mi" and _text(parent) and set(_text(parent)) <= set(_PRIMES):
            parent.tag = "mo"
            parent.text = "".join("′" * _PRIMES[sign] for sign in _text(parent))
            parent.attrib.update(_PRIME)
        for k in reversed(range(len(parent) - 1)):  # a function and its argument stand apart
            function = parent[k].tag == "mi" and _text(parent[k]) in _FUNCTIONS
            if function and parent[k + 1].tag in ("mi", "mn"):
                parent.insert(k + 1, ElementTree.Element("mspace", {"width": "0.167em"}))
    root.attrib.pop("xmlns", None)
    text = ElementTree.tostring(root, encoding="unicode")
    return re.sub(r"&amp;(#x?[0-9A-Fa-f]+;)", r"&\1", text)


def width(line: str) -> int:
    """Roughly how many letters a line of LaTeX takes."""
    from freebeam_derive.latex import width as letters

    return letters(line)


def _text(element: ElementTree.Element) -> str:
    """Characters of an element; latex2mathml keeps some as references."""
    text = element.text or ""
    return re.sub(r"&#x([0-9A-Fa-f]+);", lambda m: chr(int(m[1], 16)), text)


_ACCENTS = {"˙": "dot", "¨": "dot.double", "^": "hat", "¯": "macron", "ˉ": "macron", "_": "macron", "‾": "overline"}
_OPERATORS = {
    "−": "-", "-": "-", "∫": "integral", "∑": "sum", "∂": "partial", "∞": "infinity", "≥": ">=", "≤": "<=",
    "≠": "!=", "→": "->", "∮": "integral.cont", "⋅": "dot.op",
    "/": "\\/", "×": "times", "≈": "approx", "∈": "in", "±": "plus.minus", "…": "dots.h", "\u2061": "",
}  # fmt: skip


@lru_cache(maxsize=4096)
def typst(latex: str) -> str:
    """Typst's mathematics of a formula, by way of MathML."""
    root = ElementTree.fromstring(_unreferenced(mathml(latex)))
    return re.sub(r"\s+", " ", _typst(root)).strip()


def _unreferenced(text: str) -> str:
    return text.replace("&nbsp;", " ")


def _children(element: ElementTree.Element) -> str:
    found, rest = [], list(element)
    while rest:
        child = rest.pop(0)
        if child.tag == "mo" and rest and rest[0].tag == "mtable" and (child.text or "").strip() in ("(", "{"):
            rows = [[_children(cell) for cell in row] for row in rest.pop(0)]
            if (child.text or "").strip() == "(":
                cells_ = "; ".join(", ".join(f"display({c})" if c else '""' for c in cells) for cells in rows)
                found.append(f'mat(delim: "(", row-gap: #0.5em, {cells_})')
                rest.pop(0)
            else:
                found.append("cases(" + ", ".join(" & ".join(cells) for cells in rows) + ")")
        else:
            found.append(_typst(child))
    return " ".join(found)


def _group(element: ElementTree.Element) -> str:
    inner = _typst(element)
    return f"({inner})" if inner else '""'


def _letter(text: str, upright: bool) -> str:
    if not text:
        return ""
    if len(text) > 1 and text.isascii():
        return f'op("{text}")'
    if len(text) > 1:
        return f'"{text}"'
    if text in "#$\\\"/_^&~@;,:'|":
        return f'"{text}"'
    return f"upright({text})" if upright and text.isascii() else text


def _typst(element: ElementTree.Element) -> str:
    text = (element.text or "").strip()
    match element.tag:
        case "mi" | "mo" | "mn" | "mtext" | "mspace":
            return _sign(element, text)
        case "mfrac":
            above, below = element
            return f"frac({_typst(above)}, {_typst(below)})"
        case "msqrt":
            return f"sqrt({_children(element)})"
        case "msup" | "msub" | "munder" | "msubsup" | "munderover":
            return _indexed(element)
        case "mover":
            base, accent = element
            name = _ACCENTS.get((accent.text or "").strip())
            return f"{name}({_typst(base)})" if name else f"{_base(base)}^{_group(accent)}"
        case "mtable":
            rows = [[_children(cell) for cell in row] for row in element]
            if element.get("columnspacing") == "0em":  # lines that are aligned
                return " \\ ".join(" & ".join(cells) for cells in rows)
            return "mat(delim: #none, " + "; ".join(", ".join(cell or '""' for cell in cells) for cells in rows) + ")"
    return _children(element)


def _sign(element: ElementTree.Element, text: str) -> str:
    """A letter, a number, an operator, words or a space."""
    match element.tag:
        case "mi" if element.get("mathvariant") == "sans-serif":
            return f"sans({text})"
        case "mi":
            return _letter(text, element.get("mathvariant") == "normal")
        case "mtext":
            return '"' + (element.text or "").replace("\xa0", " ").replace('"', "") + '"'
        case "mspace":
            return {"1em": "quad", "0.167em": "thin"}.get(element.get("width", ""), "space")
        case "mo":
            return _operator(text)
    return text


def _operator(text: str) -> str:
    if text.strip("′") == "":
        return "'" * len(text)
    if text in _OPERATORS:
        return _OPERATORS[text]
    if text in ("(", ")", "[", "]", "{", "}"):
        return "\\" + text
    if len(text) > 1 and text.isalpha():
        return f'op("{text}")'
    return _letter(text, False) if text in ",;:" else text


def _indexed(element: ElementTree.Element) -> str:
    """A base with what stands below and above it; primes stand for themselves."""
    base, *scripts = element
    below = scripts[0] if element.tag != "msup" else None
    above = scripts[-1] if element.tag not in ("msub", "munder") else None
    down = f"_{_group(below)}" if below is not None else ""
    raised = _typst(above) if above is not None else ""
    if raised and raised.strip("'") == "":
        return f"{_base(base)}{raised}{down}"
    return f"{_base(base)}{down}" + (f"^{_group(above)}" if above is not None else "")


def _base(element: ElementTree.Element) -> str:
    inner = _typst(element)
    return inner if element.tag in ("mi", "mn", "mo", "mover") and inner else f"attach({inner})" if inner else '""'
