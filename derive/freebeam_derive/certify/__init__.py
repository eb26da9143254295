"""Proofs in ball arithmetic: roots, matrices, critical loads, and the beam itself without a Ritz series."""
