from __future__ import annotations

from typing import Any

import pytest

from tests.integration.fmi.instance import Unit
from tests.unit.fmi.conftest import exported

__all__ = ["exported"]


@pytest.fixture
def unit(exported, tmp_path):
    """Make an instance of a unit, which is closed at the end."""
    units = []

    def make(text: str, version: int, **settings: Any) -> Unit:
        units.append(Unit(exported(text, version, **settings), tmp_path / f"unit{version}"))
        return units[-1]

    yield make
    for each in units:
        each.close()
