"""Sentences with quantities in them, for errors and warnings: nondimensional, or in a beam's SI units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Say = Callable[[str, float, str], str]


@dataclass(frozen=True)
class _Quantity:
    value: float
    say: Say

    def __format__(self, spec: str) -> str:
        kind, _, digits = spec.partition(" ")
        return self.say(kind, self.value, digits or ".6g")


class Message(str):
    """A template such as "step = {h:time}: …" with its quantities. As a string, it has them nondimensional, Eq. (5).

    After the colon stands the kind of the quantity (time, length, frequency, rate, …) and, after a blank, the format.
    """

    template: str
    quantities: dict[str, float]

    def __new__(cls, template: str, **quantities: float) -> Message:
        text = super().__new__(cls, _told(template, quantities, lambda _, value, digits: format(value, digits)))
        text.template, text.quantities = template, quantities
        return text

    def told(self, say: Say) -> str:
        """The sentence with each quantity as `say` has it: from its kind, its nondimensional value and the format."""
        return _told(self.template, self.quantities, say)


def _told(template: str, quantities: dict[str, float], say: Say) -> str:
    return template.format(**{name: _Quantity(value, say) for name, value in quantities.items()})
