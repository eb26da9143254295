"""Maps of critical loads: labelled.py a grid with its names, sweeps.py in blocks, boundaries.py along one parameter."""
