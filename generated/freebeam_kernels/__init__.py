"""Kernels of columns, derived from their energies and emitted by `freebeam generate`; do not edit."""

COLUMNS = {
    "beck": "beck",
    "euler-pinned": "euler_pinned",
    "free-free": "free_free",
}

LEGENDRE = {
    "beck": "beck_legendre",
    "euler-pinned": "euler_pinned_legendre",
    "free-free": "free_free_legendre",
}
