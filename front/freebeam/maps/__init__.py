"""Maps of critical loads: labelled.py a grid with its names, verdict.py how far it is off, sweeps.py in blocks,
boundaries.py along one parameter."""
