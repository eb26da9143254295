"""Kernels of columns, derived from their energies and emitted by `freebeam generate`; do not edit."""

# the module of a column in each basis
COLUMNS: dict[str, dict[str, str]] = {
    "beck": {"modes": "beck", "legendre": "beck_legendre"},
    "euler-pinned": {"modes": "euler_pinned", "legendre": "euler_pinned_legendre"},
    "free-free": {"modes": "free_free", "legendre": "free_free_legendre"},
}
