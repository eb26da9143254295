"""A proof as a file: what was proven and the data that prove it. `verifier.py` checks it with code of its own.

All numbers are rational and written as text. The bilinear forms, the ends and the damping are in the file, so that
it speaks for itself: whoever reads it need not trust the emitted kernels, nor the program that wrote it.
"""

from __future__ import annotations

from fractions import Fraction
from types import ModuleType
from typing import Any

from freebeam_derive.certify.ritz import Enclosure

FORMAT = "freebeam certificate 1"


def write(kernel: ModuleType, found: Enclosure) -> dict[str, Any]:
    """The certificate of an enclosure, as a JSON object."""
    question = found.question
    own = {p["name"]: Fraction(p["default"]) for p in kernel.COLUMN["parameters"]} | dict(question.own or {})
    limit = question.kappa is not None
    alpha, beta = (Fraction(1), question.kappa) if limit else (question.alpha, question.beta)
    c_M, c_E = kernel.damping_factors(alpha, beta, **own)
    forms = {
        letter: {
            "along": [[k, p, q, str(Fraction(v))] for (k, p, q), v in along.items()],
            "points": [[int(a), p, int(b), q, str(Fraction(v))] for (a, p, b, q), v in points.items()],
        }
        for letter, (along, points) in kernel.forms(Fraction(1), **own).items()
    }
    return {
        "format": FORMAT,
        "column": kernel.COLUMN["name"],
        "ends": list(kernel.COLUMN["ends"]),
        "parameters": {name: str(value) for name, value in own.items()},
        "basis": kernel.COLUMN.get("basis", "modes"),
        "modes": question.modes,
        "forms": forms,
        "alpha": str(question.alpha),
        "beta": str(question.beta),
        "kappa": str(question.kappa) if limit else None,
        "damping": None if question.undamped else {"of_M": str(c_M), "of_E": str(c_E), "vanishing": limit},
        "kind": found.kind,
        "load": None if found.load is None else [str(v) for v in found.load],
        "frequency_squared": None if found.square is None else [str(v) for v in found.square],
        "load_max": None if found.load_max is None else str(found.load_max),
        "proof": dict(found.proof),
        "stretches": [
            {
                "start": str(s.start),
                "end": str(s.end),
                "origin": str(s.origin),
                "separators": [[str(point), str(slope)] for point, slope in s.separators],
            }
            for s in found.stretches
        ],
    }


__all__ = ["FORMAT", "write"]
