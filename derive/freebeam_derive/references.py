"""Reference values of columns: critical loads that others print or another route computes, with their provenance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation

TWO_ROUTES = "computed: Hermite elements find it, Taylor steps at 45 digits refine it (tests/reference)"
CLOSED_FORM = "computed: exact numbers (tests/reference/discrete.py)"
RULES = ("rounded", "cut off")
"""How digits of a load may have been printed."""
FAMILIES = (
    "Tip force",
    "Masses, springs and dampers",
    "Variable section",
    "Joints",
    "Shear and rotary inertia",
    "Distributed follower load",
    "Free in space, with control",
    "Flow",
    "Dead loads",
    "Links",
)
"""Families of the columns that come with freebeam, in the order in which they are listed."""


@dataclass(frozen=True)
class Reference:
    """A first loss of stability, nondimensional.

    load: its digits as they are given, all of which hold by the rule. kind: "flutter" or "divergence". by: who gives
    it, or "computed: …", by which route. own: the column's own parameters, defaults where left out. kappa: of the limit
    of vanishing damping. rule: how digits were printed. seen: where a published number was seen. modes: of a number
    that is no load of the beam, and of no limit, how many modes of the unloaded column explain it. Raises ValueError.
    """

    load: str
    kind: str
    by: str
    own: Mapping[str, float] = field(default_factory=dict)
    alpha: float = 0.0
    beta: float = 0.0
    kappa: float | None = None
    rule: str = "rounded"
    seen: str = ""
    modes: int | None = None

    def __post_init__(self) -> None:
        try:
            positive = Decimal(self.load) > 0
        except (InvalidOperation, TypeError):
            positive = False
        if not positive:
            raise ValueError(f"reference load {self.load!r}: give its digits as text, such as '20.05'")
        if self.kind not in ("flutter", "divergence"):
            raise ValueError(f"reference kind {self.kind!r}: must be 'flutter' or 'divergence'")
        if self.modes is not None and (self.modes < 1 or self.kappa is not None):
            raise ValueError(f"reference modes {self.modes}: must be 1 or more, and of no limit of vanishing damping")
        if self.rule not in RULES:
            raise ValueError(f"reference rule {self.rule!r}: must be one of {', '.join(RULES)}")
        if not self.by or bool(self.seen) == self.by.startswith("computed"):
            raise ValueError(
                f"reference {self.load}: by says who gives it, and seen where; or by is 'computed: …' by which route"
            )

    @property
    def digits(self) -> int:
        """Significant digits that are given."""
        return len(Decimal(self.load).as_tuple().digits)
