"""A load that pulsates: monodromy.py is a period of it, growth.py where motion grows."""

from freebeam.pulsating.growth import PulsatingRegion, PulsatingRegions, pulse

__all__ = ["PulsatingRegion", "PulsatingRegions", "pulse"]
