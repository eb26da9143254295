"""placeholder"""

BOUND = 1e-14


def figures(system, module, N, say):
    return iter(())
