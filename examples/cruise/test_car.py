"""Tests of the cruise controller against its requirements: `pytest examples/cruise`.

The fixture `stl` comes with rtamt. A failure explains the violation and names the file of a plot.
"""

from __future__ import annotations

from math import sin
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import car
from rtamt.assertions import UnsatisfiedError

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.pytest_plugin import Requirements

REQUIREMENTS = Path("requirements.stl")  # beside this file

ROADS: dict[str, Callable[[float], float]] = {
    "flat": lambda _time: 0.0,
    "rolling": lambda time: 0.03 * sin(time / 4),
    "uphill": lambda time: 0.02 if time > 10 else 0.0,
}


def drive(slope: Callable[[float], float]) -> dict[str, list[float]]:
    """Return the trace of a drive over a road."""
    times, samples = zip(*car.drive(slope), strict=True)
    return {"time": list(times)} | {name: [each[name] for each in samples] for name in samples[0]}


@pytest.mark.parametrize("road", ROADS)
def test_the_controller_meets_its_requirements(stl: Requirements, road: str) -> None:
    """Each road is a test."""
    stl.assert_satisfied(REQUIREMENTS, drive(ROADS[road]))


def test_the_speed_on_a_flat_road_stays_within_one_metre_per_second(stl: Requirements) -> None:
    """A formula without a file, with a margin."""
    stl.assert_satisfied("always(abs(speed - 20) <= 2)", drive(ROADS["flat"]), margin=1)


def test_a_steep_hill_is_more_than_the_engine_can_do(stl: Requirements) -> None:
    """The requirement detects a car that is too slow."""
    with pytest.raises(UnsatisfiedError, match="REQ-1"):
        stl.assert_satisfied(REQUIREMENTS, drive(lambda time: 0.4 if time > 20 else 0.0))
