from __future__ import annotations

import shutil
import sys
from typing import TYPE_CHECKING

import pytest

from tests.integration.matlab.octave import ROOT, run_octave

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="session")
def installed(tmp_path_factory) -> Path:
    """Install a copy as a user does, with the Python that runs the tests; a name with a space must do."""
    home = tmp_path_factory.mktemp("user s")
    sources = shutil.ignore_patterns("*.mex*", "*.so", "python.txt")
    shutil.copytree(ROOT / "matlab", home / "matlab", ignore=sources)
    said = run_octave(f"install_rtamt('{sys.executable}');", home, home / "matlab")
    assert said.splitlines()[0] == "rtamt is ready. For the next session, put this into startup.m:"
    return home / "matlab"
