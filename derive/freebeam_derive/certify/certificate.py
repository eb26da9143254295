"""A proof as a file: what was proven and the data that prove it. `verifier.py` checks it with code of its own.

All numbers are rational and written as text. The bilinear forms, the ends and the damping are in the file, so that
it speaks for itself: whoever reads it need not trust the emitted kernels, nor the program that wrote it.
"""

from __future__ import annotations

from fractions import Fraction
from types import ModuleType
from typing import Any

from freebeam_derive.certify.balls import Root, parameters
from freebeam_derive.certify.decimals import written
from freebeam_derive.certify.first_crossing import Enclosure

FORMAT = "freebeam certificate 1"


def write(kernel: ModuleType, found: Enclosure) -> dict[str, Any]:
    """The certificate of an enclosure whose dampings are rational numbers, as a JSON object."""
    question = found.question
    alpha, beta, kappa = question.alpha, question.beta, question.kappa
    assert isinstance(alpha, Fraction) and isinstance(beta, Fraction) and not isinstance(kappa, Root)
    own = parameters(kernel, question.own)
    c_M, c_E = kernel.damping_factors(*((alpha, beta) if kappa is None else (Fraction(1), kappa)), **own)
    forms = {
        letter: {
            "along": [[k, p, q, written(v)] for (k, p, q), v in along.items()],
            "points": [[int(a), p, int(b), q, written(v)] for (a, p, b, q), v in points.items()],
        }
        for letter, (along, points) in kernel.forms(Fraction(1), **own).items()
    }
    return {
        "format": FORMAT,
        "column": kernel.COLUMN["name"],
        "ends": list(kernel.COLUMN["ends"]),
        "parameters": {name: written(value) for name, value in own.items()},
        "basis": kernel.COLUMN.get("basis", "modes"),
        "modes": question.modes,
        "forms": forms,
        "alpha": written(alpha),
        "beta": written(beta),
        "kappa": None if kappa is None else written(kappa),
        "damping": None
        if question.undamped
        else {"of_M": written(c_M), "of_E": written(c_E), "vanishing": kappa is not None},
        "kind": found.kind,
        "load": None if found.load is None else [written(v) for v in found.load],
        "frequency_squared": None if found.square is None else [written(v) for v in found.square],
        "load_max": None if found.load_max is None else written(found.load_max),
        "proof": dict(found.proof),
        "stretches": [
            {
                "start": written(s.start),
                "end": written(s.end),
                "origin": written(s.origin),
                "separators": [[written(point), written(slope)] for point, slope in s.separators],
            }
            for s in found.stretches
        ],
    }


__all__ = ["FORMAT", "write"]
