"""Maps of critical loads: grid.py as arrays, labelled.py with names, verdict.py how far they are off, sweeps.py in
blocks, boundaries.py along one parameter."""
