from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from fmpy.validation import validate_fmu

import rtamt
from rtamt import fmi

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def exported(tmp_path):
    """Export a requirement, return the file."""

    def export(text: str, version: int, **settings: Any) -> Path:
        path = tmp_path / f"unit{version}.fmu"
        fmi.export(rtamt.parse(text), path, version=version, **settings)
        assert validate_fmu(str(path)) == []
        return path

    return export
