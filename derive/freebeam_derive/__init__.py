"""Derivation of beam stability kernels: from energies and virtual work to verified NumPy code."""
