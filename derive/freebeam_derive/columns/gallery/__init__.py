"""Columns of the literature, a file each; their kernels are derived when they are first used."""
