"""placeholder until the operator for any damping is here"""

from __future__ import annotations


class General:
    def __init__(self, M, C, K, vanishing=None):
        raise NotImplementedError
