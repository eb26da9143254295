"""Hard questions for a search of the first loss of stability, named by what is hard about each.

Every mechanism of the tree is asked each of them: tests/test_gallery.py, and tests/explorer for the page.
"""

from __future__ import annotations

import math

from tests.reference.dense import Case


def _beck(
    modes: int, eta: float, alpha: float, beta: float, kappa: float | None = None, basis: str = "legendre"
) -> Case:
    return Case("beck", basis, modes, {"eta": eta}, alpha, beta, kappa)


GALLERY = {
    "touch of λ = 0 at η = 1/2, no damping": _beck(10, 0.5, 0.0, 0.0),
    "touch at η = 1/2, external damping": _beck(10, 0.5, 0.0, 0.1),
    "touch at η = 1/2, both dampings": _beck(10, 0.5, 1e-4, 1.0),
    "touch at η = 1/2, vanishing damping": _beck(10, 0.5, 0.0, 0.0, 1e4),
    "touch at η = 1/2 that internal damping makes a flutter of frequency 0": _beck(10, 0.5, 1e-3, 0.0),
    "two divergences close together, η = 1/2 − 1e-6": _beck(10, 0.5 - 1e-6, 1e-3, 0.1),
    "divergence and its undoing within 1e-4, η = 1/2 − 1e-9": _beck(10, 0.5 - 1e-9, 0.0, 0.1),
    "no divergence by 1e-9 of η": _beck(10, 0.5 + 1e-9, 0.0, 0.1),
    "α = 10": _beck(8, 1.0, 10.0, 0.0, basis="modes"),
    "α = 10, N = 16": _beck(16, 1.0, 10.0, 0.0, basis="modes"),
    "two crossings of one branch, just before they change order": _beck(8, 1.0, 1.05, 0.0, basis="modes"),
    "two crossings of one branch, just after": _beck(8, 1.0, 1.1, 0.0, basis="modes"),
    "damping that is hardly there": Case("free-free", "modes", 8, {}, 1e-12, 0.0, None),
    "internal damping that is hardly there, none outside": _beck(8, 1.0, 1e-12, 0.0),
    "limit of vanishing internal damping": Case("free-free", "modes", 8, {}, 0.0, 0.0, 0.0),
    "limit of vanishing external damping": Case("free-free", "legendre", 8, {}, 0.0, 0.0, math.inf),
    "limit at a ratio between": _beck(8, 1.0, 0.0, 0.0, 300.0),
    "coalescence with a third branch near": Case("free-free", "modes", 8, {}, 0.0, 0.0, None),
    "coalescence, N = 16": Case("free-free", "legendre", 16, {}, 0.0, 0.0, None),
    "one function, where nothing can flutter": Case("free-free", "modes", 1, {}, 1e-3, 0.1, None),
    "one function of the cantilever, which loses nothing": _beck(1, 1.0, 1e-3, 0.1),
    "two functions": _beck(2, 1.0, 1e-3, 0.1),
    "two functions, no damping": Case("free-free", "legendre", 2, {}, 0.0, 0.0, None),
    "conservative load": Case("euler-pinned", "modes", 8, {}, 1e-3, 0.1, None),
    "conservative load, no damping": _beck(8, 0.0, 0.0, 0.0),
    "strong damping outside": Case("free-free", "modes", 8, {}, 1e-3, 1e3, None),
}
