"""Monitors as Functional Mock-up Units, which simulators import: FMI 2.0 and 3.0 for co-simulation."""

from rtamt.fmi.package import export, platform

__all__ = ["export", "platform"]
